"""An option has one meaning in all commands: one metavar, type and multiplicity, and the same sentence in every help."""

import re
from collections import defaultdict

import pytest

from flexstage.apps.cli.commands import COMMANDS, LazyCommand

SEVERAL = {
    "--output": "a file, of the kind that the command writes; in `response` a signal, as `--input`",
    "--delay": "of the recorded gauges in `rig`, from sampling to the new output in `loop`",
}
"""Options with several meanings, and why. The table only shrinks."""


@pytest.fixture(scope="module")
def meanings() -> dict[str, set[tuple[object, ...]]]:
    """Metavar, type, multiplicity and help up to its default, of every option in every command."""
    found = defaultdict[str, set[tuple[object, ...]]](set)
    for each in (option for command in COMMANDS for option in LazyCommand(command).load().params if option.param_type_name == "option"):
        about = each.help.partition("Default:")[0].strip()
        found[each.opts[0]].add((each.metavar, each.type_descriptor.annotation, each.multiple, each.nargs, about))
    return found


def test_an_option_has_one_meaning_and_one_sentence(meanings: dict[str, set[tuple[object, ...]]]) -> None:
    assert len(meanings) > 100
    assert {name for name, each in meanings.items() if len(each) > 1} == set(SEVERAL)


def test_help_has_short_sentences(meanings: dict[str, set[tuple[object, ...]]]) -> None:
    sentences = [(name, text) for name, each in meanings.items() for *_, about in each for text in re.split(r"[.:;] ", str(about))]
    assert [(name, text) for name, text in sentences if len(text.split()) > 20 or "several times" in text] == []
