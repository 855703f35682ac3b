"""Plain technical English on every surface: numbers of private words, and the share of long sentences, may only fall."""

import ast
import re
from collections.abc import Iterator
from itertools import chain

import pytest

from tests.hygiene.source import ROOT

_GENERATED = re.compile(r"docs/(_build|api|archive|decisions|validation)/|docs/(changelog|commands|json|map)\.md")
_PAGES = (ROOT / "README.md", ROOT / "CONTRIBUTING.md", *(ROOT / "docs").rglob("*.md"))
_NOT_PROSE = (
    (re.compile(r"```.*?```", re.DOTALL), "\n"),
    (re.compile(r"<[^>]+>"), " "),
    (re.compile(r"`[^`]*`"), "Code"),
    (re.compile(r"\[([^\]]*)\]\([^)]*\)"), r"\1"),
)

LIMITS = {
    r"told|tells?|telling": (0, 0, 0, 0, 0),
    r"anew|nought|besides|alike": (0, 0, 0, 0, 0),
    r"beside": (0, 0, 0, 1, 0),
    r"felt|feels?|borne|bears?": (0, 0, 0, 0, 0),
    r"g(?:ives?|ave|iving) way": (1, 0, 0, 0, 0),
    r"work(?:s|ed|ing)? out|once more|of a processor": (1, 0, 0, 0, 0),
    r"as far as|by (?:itself|themselves)": (1, 0, 0, 3, 0),
    r"(?:goes|go|going|went) on": (0, 0, 0, 0, 0),
    r"stands?|stood": (4, 0, 1, 3, 0),
    r"lies|lay": (0, 5, 1, 2, 0),
    r"asked|asks|wish(?:es)?": (1, 0, 2, 1, 0),
    r"shall|of which": (1, 0, 0, 0, 0),
    r"what (?:is|are|was|it|they|the|a|no|[a-z]+s)": (20, 3, 10, 7, 1),
}
"""Words to avoid, and how often each may occur in pages, changelog, messages, docstrings and the studio. Numbers only fall."""

LONG = (0.006, 0.0, 0.005, 0.01)
"""Share of sentences of more than 30 words in pages, changelog, messages and docstrings (strings of the studio include style sheets)."""


def _prose(text: str) -> str:
    """Text without code, tags and addresses."""
    for pattern, instead in _NOT_PROSE:
        text = pattern.sub(instead, text)
    return text


def _strings() -> Iterator[tuple[bool, str]]:
    """Docstrings (true) and strings of at least three words (false) in the source; f-strings are one, with X for values."""
    for path in (ROOT / "src").rglob("*.py"):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        known = set[ast.AST]()
        for node in ast.walk(tree):
            if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef) and (text := ast.get_docstring(node)):
                yield True, re.sub(r"^\s*(?:>>>|\.\.\.).*$", "", text, flags=re.MULTILINE)
                known.add(getattr(node.body[0], "value"))  # noqa: B009 - the docstring, an expression
            if isinstance(node, ast.JoinedStr):
                known.update(each for each in ast.walk(node) if each is not node)
        yield from ((False, text) for node in ast.walk(tree) if node not in known and _is_prose(text := _text(node)))


def _text(node: ast.AST) -> str:
    """Text of a string or f-string, with X for values; empty of other nodes."""
    if isinstance(node, ast.JoinedStr):
        return "".join(str(each.value) if isinstance(each, ast.Constant) else " X " for each in node.values)
    return node.value if isinstance(node, ast.Constant) and isinstance(node.value, str) else ""


def _is_prose(text: str) -> bool:
    """Whether a string has three words or more."""
    return " " in text and len(re.findall(r"[A-Za-z]{2,}", text)) >= 3


@pytest.fixture(scope="module")
def texts() -> tuple[list[str], ...]:
    """Prose of the pages that people write, of the changelog, messages, docstrings and the studio."""
    pages = [path for path in _PAGES if not _GENERATED.match(path.relative_to(ROOT).as_posix())]
    strings = list(_strings())
    scripts = (path.read_text(encoding="utf-8") for path in (ROOT / "web" / "src").rglob("*.ts"))
    quoted = (pair for text in scripts for pair in re.findall(r'"((?:[^"\\\n]|\\.)*)"|`((?:[^`\\]|\\.)*)`', text))
    areas = (
        (path.read_text(encoding="utf-8") for path in pages),
        [(ROOT / "CHANGELOG.md").read_text(encoding="utf-8")],
        (text for is_docstring, text in strings if not is_docstring),
        (text for is_docstring, text in strings if is_docstring),
        filter(_is_prose, chain.from_iterable(quoted)),
    )
    return tuple(list(map(_prose, area)) for area in areas)


def _lengths(text: str) -> list[int]:
    """Words of each sentence; headings, rows of tables and items of lists are none or begin one."""
    text = re.sub(r"^\s*\|.*$|^#+ .*$", "\n", text, flags=re.MULTILINE)
    text = re.sub(r"^\s*(?:[-*]|\d+\.) ", "\n\n", text, flags=re.MULTILINE)
    sentences = chain.from_iterable(re.split(r"(?<=[.!?])\s+(?=[A-Z0-9(])", part) for part in re.split(r"\n\s*\n", text))
    counts = (len(re.findall(r"[A-Za-z0-9][\w'^*/.-]*", sentence)) for sentence in sentences)
    return [count for count in counts if count >= 4]


def test_private_words_only_become_fewer(texts: tuple[list[str], ...]) -> None:
    counts = {word: tuple(len(re.findall(rf"\b(?:{word})\b", "\n".join(area), re.IGNORECASE)) for area in texts) for word in LIMITS}
    assert {word: each for word, each in counts.items() if any(map(int.__gt__, each, LIMITS[word]))} == {}


def test_long_sentences_only_become_fewer(texts: tuple[list[str], ...]) -> None:
    lengths = [list(chain.from_iterable(map(_lengths, area))) for area in texts[: len(LONG)]]
    shares = [sum(count > 30 for count in each) / len(each) for each in lengths]
    assert all(share <= most for share, most in zip(shares, LONG, strict=True)), shares
