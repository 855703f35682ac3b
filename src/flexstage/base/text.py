"""Safe display of foreign text: terminal controls and invisible characters are escaped."""

from __future__ import annotations

import re

_CONTROLS = r"\x00-\x1f\x7f-\x9f\u2028\u2029\ud800-\udfff"
_DIRECTIONS = r"\u061c\u200e\u200f\u202a-\u202e\u2066-\u2069"
_UNSEEN = r"\xad\u180e\u200b-\u200d\u2060-\u2065\u206a-\u206f\ufeff\ufff9-\ufffb\U0001bca0-\U0001bca3\U0001d173-\U0001d17a"
_TAGS = r"\U000e0000-\U000e007f"
_NO_CHARACTERS = r"\ufdd0-\ufdef" + "".join(rf"\U{plane:04x}fffe\U{plane:04x}ffff" for plane in range(17))
_STEERING = re.compile(f"[{_CONTROLS}{_DIRECTIONS}{_UNSEEN}{_TAGS}{_NO_CHARACTERS}]")


def printable(text: str, keep: str = "") -> str:
    r"""Escape control characters, bidirectional overrides, invisible formats, line separators and lone surrogates.

    Escapes have the form of Python (`\x1b`, `\u202e`). Characters that XML forbids, such as U+FFFE, are escaped too. Letters, marks and
    spaces of any script are unchanged. Characters in `keep` are also unchanged ("\n" for text of several lines).

    >>> printable("a\x1b[31m\u202e b\u00e9\n"), printable("two\nlines", keep="\n")
    ('a\\x1b[31m\\u202e bé\\n', 'two\nlines')
    """
    return _STEERING.sub(lambda result: result[0] if result[0] in keep else result[0].encode("unicode_escape").decode("ascii"), text)
