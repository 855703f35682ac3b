"""docs/design-file.md tells every key of a design file, and every unit, alternative and requirement there is."""

from __future__ import annotations

import re

from flexstage.analysis.assessment.measures import MEASURES
from flexstage.mechanism.grammar.grammar import TAGS, ListNode, RecordNode, TableNode, UnionNode, node_of
from flexstage.mechanism.grammar.node import ChoiceNode
from flexstage.mechanism.mechanism import Mechanism
from tests.hygiene.source import ROOT, expect_none

PAGE = (ROOT / "docs" / "design-file.md").read_text(encoding="utf-8")
ALONE = re.compile(r"`[^`\n]+`|```.*?```", re.DOTALL)


def _words(node, seen):
    """Keys and words that may stand in a file under a node."""
    if isinstance(node, RecordNode) and node.record not in seen:
        seen.add(node.record)
        for slot in node.fields.values():
            if not (isinstance(slot.node, UnionNode) and slot.node.told_by is None):
                yield slot.key
            yield from _words(slot.node, seen)
    elif isinstance(node, UnionNode):
        if node.told_by is not None:
            yield node.told_by
        for name, option in node.options:
            yield name
            yield from _words(option, seen)
    elif isinstance(node, (TableNode, ListNode)):
        yield from _words(node.item, seen)
    elif isinstance(node, ChoiceNode):
        yield from (choice.value for choice in node.choices)


def _told(page):
    """The words that stand in code on a page."""
    return set(re.findall(r"[\w.-]+", " ".join(ALONE.findall(page))))


def test_every_key_and_alternative_is_told():
    words = {"format", "like", TAGS, *_words(node_of(Mechanism), set())}
    told = _told(PAGE)
    expect_none(sorted(word for word in words if not set(word.split()) <= told), "tell it in docs/design-file.md")


def test_every_requirement_is_told():
    told = {word.partition(".")[0] if "platform" not in word else word for word in _told(PAGE)}
    expect_none((form for form in MEASURES.own if form.partition(".")[0].strip("<>") not in told), "tell it under Requirements")
