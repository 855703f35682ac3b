"""Names before the first release are refused with the names that replaced them, and a page lists them."""

from importlib import import_module

import pytest

from flexstage.apps.cli.commands import COMMANDS, LazyCommand
from flexstage.base.finding import suggest_nearest
from flexstage.base.renamed import RENAMED
from tests.hygiene.source import ROOT

PACKAGES = [
    import_module(name) for name in ("flexstage", "flexstage.control", "flexstage.experiment", "flexstage.solid", "flexstage.studies")
]


def test_the_page_lists_all_pairs() -> None:
    page = (ROOT / "docs" / "renamed.md").read_text(encoding="utf-8")
    assert [pair for pair in RENAMED if f"| `{pair[0]}` | `{pair[1]}` |" not in page] == []


def test_an_old_key_is_refused_with_the_new_one() -> None:
    assert suggest_nearest("mode_limit", ["name", "max_mode_frequency"]) == "It is called max_mode_frequency"


@pytest.mark.parametrize(("old", "new"), [pair for pair in RENAMED if pair[0].startswith("--")])
def test_some_command_has_the_new_option_and_not_the_old_one(old: str, new: str) -> None:
    options = [{option for each in LazyCommand(command).load().params for option in each.opts} for command in COMMANDS]
    assert any(new in each and old not in each for each in options)


@pytest.mark.parametrize(("old", "new"), [pair for pair in RENAMED if any(pair[1] in dir(package) for package in PACKAGES)])
def test_an_old_public_name_is_refused_with_the_new_one(old: str, new: str) -> None:
    (package,) = (each for each in PACKAGES if new in dir(each))
    getattr(package, new)
    with pytest.raises(AttributeError, match=f"it is called '{new}'"):
        getattr(package, old)
