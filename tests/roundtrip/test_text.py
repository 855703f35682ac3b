"""Foreign text is shown with nothing in it that steers, and nothing else changed."""

from __future__ import annotations

import unicodedata
from xml.etree import ElementTree

from hypothesis import given
from hypothesis import strategies as st

from flexstage.base.text import printable
from flexstage.control.export.code.text import comment, identifier

DIRECTIONS = ("LRE", "RLE", "LRO", "RLO", "PDF", "LRI", "RLI", "FSI", "PDI")


def test_every_character_that_steers_is_escaped_and_no_other() -> None:
    every = [chr(number) for number in range(0x110000)]
    escaped = {letter for letter in every if printable(letter) != letter}
    steering = {letter for letter in every if unicodedata.category(letter) in ("Cc", "Cs", "Zl", "Zp") or ord(letter) & 0xFFFE == 0xFFFE}
    steering |= {letter for letter in every if unicodedata.bidirectional(letter) in DIRECTIONS}
    assert steering <= escaped
    assert {unicodedata.category(letter) for letter in escaped - steering} <= {"Cf", "Cn"}
    assert all(printable(letter).isascii() and printable(letter).isprintable() for letter in escaped)


@given(st.text(st.characters()))
def test_what_is_shown_can_stand_in_xml_and_two_lines_stay_two(text: str) -> None:
    shown = printable(text)
    assert printable(shown) == shown
    assert ElementTree.fromstring(ElementTree.tostring(ElementTree.Element("a", name=shown))).get("name") == shown  # noqa: S314
    assert printable(text, keep="\n").split("\n") == [printable(line) for line in text.split("\n")]


@given(st.text(st.sampled_from("*/?\\ \n\u202e\x1ba")))
def test_a_comment_of_c_ends_where_it_should(text: str) -> None:
    whole = "\n".join(comment(text))
    assert whole.startswith("/*")
    assert whole.index("*/", 2) == len(whole) - 2
    assert "/*" not in whole[2:]
    assert "??" not in whole


@given(st.text())
def test_identifiers_are_those_of_c_and_stay_what_they_are(text: str) -> None:
    name = identifier(text)
    assert name.isascii()
    assert name.isidentifier()
    assert name[0] != "_"
    assert identifier(name) == name
