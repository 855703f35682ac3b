"""Names before the first release are refused with the names that replaced them, and a page lists them."""

from importlib import import_module

import pytest

from flexstage.apps.cli.commands import COMMANDS, LazyCommand
from flexstage.base.finding import DesignError, suggest_nearest
from flexstage.base.renamed import RENAMED
from flexstage.cases.parallelogram import parallelogram
from flexstage.control.study.file import loads_setup
from flexstage.mechanism.addresses.address import set_text
from flexstage.mechanism.store import dumps, loads
from flexstage.studies.form import study_file
from tests.hygiene.source import ROOT

PACKAGES = [
    import_module(name) for name in ("flexstage", "flexstage.control", "flexstage.experiment", "flexstage.solid", "flexstage.studies")
]


def test_the_page_lists_all_pairs() -> None:
    page = (ROOT / "docs" / "renamed.md").read_text(encoding="utf-8")
    assert [pair for pair in RENAMED if f"| `{pair[0]}` | `{pair[1]}` |" not in page] == []


def test_an_old_key_is_refused_with_the_new_one() -> None:
    assert suggest_nearest("mode_limit", ["name", "max_mode_frequency"]) == "Use max_mode_frequency"


OLD_KEYS = {
    "design": {
        "place = {}": "placements",
        "[place.B1]": "placements",
        "[require]": "requirements",
        "[change]": "overrides",
        'mode_limit = "1 kHz"': "max_mode_frequency",
        'parts.a = { kind = "given" }': "compliance_matrix",
        'parts.a = { kind = "compliance_matrix", stands_for = "b" }': "replaces",
        'stops.a = { gap_back = "1 mm" }': "gap_negative",
        'parts.a = { kind = "leaf", warmth = "1 K" }': "face_temperature_difference",
        'bodies.a.solids.b = { shape = "sphere", removes = true }': "subtract",
    },
    "loop": {
        'amplifier = { kind = "charge", left = 0.2 }': "residual_hysteresis",
        'follow = { by = "inverse" }': "method",
        'trajectory = { kind = "step", by = { x = "1 um" } }': "amplitude",
        'trajectory = { kind = "sine", by = { x = "1 um" } }': "amplitude",
        'controller.loops = [{ of = ["x"] }]': "axes",
        'controller.goal = { aim = "balance" }': "objective",
    },
    "study": {
        'variables.a = { of = "b" }': "address",
        'scatter.a = { of = "b" }': "address",
        "scatter.a = { each = true }": "independent",
        "optimise.require = false": "requirements",
        "tolerance.require = false": "requirements",
    },
}
READERS = {"design": loads, "loop": loads_setup, "study": study_file}


@pytest.mark.parametrize(("kind", "line", "new"), [(kind, line, new) for kind, lines in OLD_KEYS.items() for line, new in lines.items()])
def test_a_file_with_an_old_key_is_refused_with_file_line_and_new_key(kind: str, line: str, new: str) -> None:
    text = f'format = "flexstage{"" if kind == "design" else f" {kind}"} 1"\n\n{line}\n'
    with pytest.raises(DesignError, match=rf"a\.toml:3: .*Use {new}\b"):
        READERS[kind](text, where="a.toml")


def test_an_old_table_next_to_the_new_one_is_refused_with_its_name() -> None:
    with pytest.raises(DesignError, match=r":\d+: place: .* Use placements"):
        loads(dumps(parallelogram()) + '[place.C]\nunit = "strut"\n')


@pytest.mark.parametrize(
    ("address", "new"),
    [("place.B.pose.at.x", "placements"), ("change.B/front.thickness", "overrides"), ("require.mass", "requirements")],
)
def test_an_old_address_is_refused_with_the_new_one(address: str, new: str) -> None:
    with pytest.raises(DesignError, match=rf"\b{new}\b"):
        set_text(parallelogram(), address, "1 mm")


@pytest.mark.parametrize(("old", "new"), [pair for pair in RENAMED if pair[0].startswith("--")])
def test_some_command_has_the_new_option_and_not_the_old_one(old: str, new: str) -> None:
    options = [
        {option for each in LazyCommand(command).load().params for option in (*each.opts, *each.secondary_opts)} for command in COMMANDS
    ]
    assert any(new in each and old not in each for each in options)


@pytest.mark.parametrize(("old", "new"), [pair for pair in RENAMED if any(pair[1] in dir(package) for package in PACKAGES)])
def test_an_old_public_name_is_refused_with_the_new_one(old: str, new: str) -> None:
    (package,) = (each for each in PACKAGES if new in dir(each))
    getattr(package, new)
    with pytest.raises(AttributeError, match=f"it is called '{new}'"):
        getattr(package, old)
