"""Plain technical English in pages and changelog: numbers of private words, and the share of long sentences, may only fall."""

import re
from itertools import chain

import pytest

from tests.hygiene.source import ROOT

_GENERATED = re.compile(r"docs/(_build|api|archive|decisions|validation)/|docs/(changelog|commands|json|map)\.md")
_PAGES = (ROOT / "README.md", ROOT / "CONTRIBUTING.md", *(ROOT / "docs").rglob("*.md"))
_NOT_PROSE = (
    (re.compile(r"^(`{3,}).*?^\1\s*$", re.DOTALL | re.MULTILINE), "\n"),
    (re.compile(r"<[^>]+>"), " "),
    (re.compile(r"`[^`]*`"), "code"),
    (re.compile(r"\[([^\]]*)\]\([^)]*\)"), r"\1"),
)

LIMITS = {
    r"told|tells?|telling": (0, 0),
    r"anew|nought|besides|alike": (0, 0),
    r"beside": (5, 0),
    r"felt|feels?|borne|bears?": (0, 0),
    r"g(?:ives?|ave|iving) way": (0, 0),
    r"work(?:s|ed|ing)? out|once more|of a processor": (0, 0),
    r"as far as|by (?:itself|themselves)": (2, 0),
    r"(?:goes|go|going|went) on": (0, 0),
    r"stands?|stood": (5, 0),
    r"lies|lay": (15, 5),
    r"asked|asks|wish(?:es)?": (3, 0),
    r"shall|of which": (2, 0),
    r"what (?:is|are|was|it|they|the|a|no|[a-z]+s)": (40, 3),
}
"""Words to avoid, and how often each may occur in pages and in the changelog. Numbers only fall."""

LONG = (0.02, 0.0)
"""Share of sentences of more than 30 words in pages and in the changelog."""


def _prose(text: str) -> str:
    """Text without code, tags and addresses."""
    for pattern, instead in _NOT_PROSE:
        text = pattern.sub(instead, text)
    return text


@pytest.fixture(scope="module")
def texts() -> tuple[list[str], list[str]]:
    """Prose of the pages that people write, and of the changelog."""
    pages = [path for path in _PAGES if not _GENERATED.match(path.relative_to(ROOT).as_posix())]
    return [_prose(path.read_text(encoding="utf-8")) for path in pages], [_prose((ROOT / "CHANGELOG.md").read_text(encoding="utf-8"))]


def _lengths(text: str) -> list[int]:
    """Words of each sentence; headings, rows of tables and items of lists are none or begin one."""
    text = re.sub(r"^\s*\|.*$|^#+ .*$", "\n", text, flags=re.MULTILINE)
    text = re.sub(r"^\s*(?:[-*]|\d+\.) ", "\n\n", text, flags=re.MULTILINE)
    sentences = chain.from_iterable(re.split(r"(?<=[.!?])\s+(?=[A-Z0-9(])", part) for part in re.split(r"\n\s*\n", text))
    counts = (len(re.findall(r"[A-Za-z0-9][\w'^*/.-]*", sentence)) for sentence in sentences)
    return [count for count in counts if count >= 4]


def test_private_words_only_become_fewer(texts: tuple[list[str], list[str]]) -> None:
    counts = {word: tuple(len(re.findall(rf"\b(?:{word})\b", "\n".join(area), re.IGNORECASE)) for area in texts) for word in LIMITS}
    assert {word: each for word, each in counts.items() if any(map(int.__gt__, each, LIMITS[word]))} == {}


def test_long_sentences_only_become_fewer(texts: tuple[list[str], list[str]]) -> None:
    lengths = [list(chain.from_iterable(map(_lengths, area))) for area in texts]
    shares = [sum(count > 30 for count in each) / len(each) for each in lengths]
    assert all(share <= most for share, most in zip(shares, LONG, strict=True)), shares
