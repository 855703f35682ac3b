"""How text that others wrote is shown: what would steer a terminal, a reader's eye or a parser stands as its escape."""

from __future__ import annotations

import unicodedata

_STEERING = frozenset({"Cc", "Cf", "Cs", "Zl", "Zp"})
"""Categories of Unicode: controls, formats (bidirectional overrides, zero widths), lone surrogates, separators of lines and paragraphs."""


def printable(text: str, keep: str = "") -> str:
    r"""Text in which control characters, bidirectional overrides, invisible formats, line separators and lone surrogates are escaped.

    Each stands as Python writes it (`\x1b`, `\u202e`), so that it is seen and two names do not become one; so do U+FFFE, U+FFFF and their
    like, which XML forbids. Letters, marks and spaces of any script stay, and what is in `keep` ("\n" for text of several lines).

    >>> printable("a\x1b[31m\u202e b\u00e9\n"), printable("two\nlines", keep="\n")
    ('a\\x1b[31m\\u202e bé\\n', 'two\nlines')
    """
    if text.isascii() and text.isprintable():
        return text
    return "".join(each if each in keep or not _steers(each) else each.encode("unicode_escape").decode("ascii") for each in text)


def _steers(letter: str) -> bool:
    return unicodedata.category(letter) in _STEERING or ord(letter) & 0xFFFE == 0xFFFE
