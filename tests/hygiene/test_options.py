"""An option has one meaning in all commands: one metavar, type and multiplicity, and the same sentence in every help."""

import re
from collections import defaultdict

import pytest
from typer import Context

from flexstage.apps.cli.commands import COMMANDS, LazyCommand
from tests.hygiene.test_prose import LIMITS

SEVERAL = {
    "--output": "a file, of the kind that the command writes; in `response` a signal, as `--input`",
    "--model": "the models that the command accepts, with one sentence",
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


def test_help_begins_with_an_imperative_and_has_no_private_words() -> None:
    loaded = [(command, LazyCommand(command).load()) for command in COMMANDS]
    assert [command.name for command, each in loaded if each.help.partition("\n")[0] != command.help or len(command.help) > 60] == []
    helps = "\n".join(each.get_help(Context(each, info_name=command.name)) for command, each in loaded)
    assert [word for word in LIMITS if re.search(rf"\b(?:{word})\b", helps, re.IGNORECASE)] == []


def test_many_options_are_listed_in_groups() -> None:
    loaded = {command.name: LazyCommand(command).load() for command in COMMANDS}
    loop, mapping = (loaded[name].get_help(Context(loaded[name], info_name=name)) for name in ("loop", "mapping"))
    heads = [line for line in loop.splitlines() if re.fullmatch(r"\S.*:", line)]
    assert heads[:3] == ["Arguments:", "Model and operating point:", "Controller:"]
    assert loop.count("--max-sensitivity") == 1
    assert [line for line in mapping.splitlines() if re.fullmatch(r"\S.*:", line)] == ["Arguments:", "Options:"]
