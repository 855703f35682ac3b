"""Bad input: every class ends with exit code 2, its object, key, numbers and remedy; no traceback, no output, no half-written file."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from tests.apps.command import Command, Ended

Broken = tuple[Callable[[str], str], tuple[str, ...]]

NECK = 'thickness = "1.54 mm"'
FRONT = 'front = { joins = ["tip", "platform"]'
PIVOTED = """format = "flexstage 1"
name = "pivoted"
[parts.pin]
kind = "joint"
free = ["rz"]
[bodies.platform]
mass = "1 kg"
centre = ["10 mm", "0 mm", "0 mm"]
inertia = { xx = "1e-3 kg m^2", yy = "1e-3 kg m^2", zz = "1e-3 kg m^2" }
[links]
pin = { joins = ["ground", "platform"], part = "pin", at = ["0 mm", "0 mm", "0 mm"], along = "x", bends = "y" }
"""


def swapped(old: str, new: str) -> Callable[[str], str]:
    def change(text: str) -> str:
        assert old in text
        return text.replace(old, new, 1)

    return change


BROKEN: dict[str, Broken] = {
    "unknown key": (swapped(NECK, f'{NECK}\nthicknes = "1 mm"'), ("parts.neck.thicknes", "unknown key", "thickness")),
    "missing unit": (swapped(NECK, "thickness = 1.54"), ("parts.neck.thickness", "unit missing (got 1.54)", '"2 mm"')),
    "wrong dimension": (swapped(NECK, 'thickness = "1.54 N"'), ("parts.neck.thickness", "a force", "must be a length")),
    "negative thickness": (swapped(NECK, 'thickness = "-1.54 mm"'), ("parts.neck.thickness", "-1.54 mm", "greater than 0")),
    "thicker than wide": (swapped('width = "14.9 mm"', 'width = "0.5 mm"'), ("parts.foot_notch.thickness", "0.85 mm", "0.5 mm")),
    "unconnected body": (
        lambda text: text + '\n[bodies.loose]\nreference = ["0 mm", "0 mm", "0 mm"]\n',
        ("loose", "not connected to the ground", "Join it"),
    ),
    "misspelt part": (swapped('part = "neck"', 'part = "nek"'), ("nek", "neck")),
    "misspelt body": (swapped('joins = ["tip", "platform"]', 'joins = ["tip", "plattform"]'), ("plattform", "platform")),
    "duplicate name": (swapped("[parts.foot_notch]", "[parts.neck]"), ("twice",)),
    "not a number": (swapped(NECK, 'thickness = "nan mm"'), ("parts.neck.thickness", "must be finite")),
    "infinite": (swapped("poisson = 0.3", "poisson = inf"), ("poisson", "must be finite")),
    "not TOML": (lambda _: "stage = {", ("stage.toml", "not TOML")),
    "other format": (swapped("flexstage 1", "flexstage 99"), ("format", "flexstage 99", "flexstage 1")),
    "unreadable requirement": (swapped('"at least 100 Hz"', '"some 100 Hz"'), ("frequency.platform.1", "at least")),
    "unknown requirement": (swapped('"stroke.x"', '"stroke.q"'), ("stroke.q", "stroke.x")),
}


def expect_refusal(ended: Ended, *texts: str) -> None:
    assert ended.code == 2, ended.err
    assert ended.out == ""
    assert "Traceback" not in ended.err
    for text in texts:
        assert text in ended.err


@pytest.mark.parametrize("command", ["check", "analyse"])
@pytest.mark.parametrize("kind", sorted(BROKEN))
def test_bad_designs_are_refused(flexstage: Command, tmp_path: Path, kind: str, command: str) -> None:
    change, texts = BROKEN[kind]
    design = tmp_path / "stage.toml"
    design.write_text(change(design.read_text()))
    outputs = ["--report", "report.html", "--mat", "out.mat", "--json", "out.json"] if command == "analyse" else []
    expect_refusal(flexstage(command, "stage.toml", *outputs), *texts)
    assert [path.name for path in tmp_path.iterdir()] == ["stage.toml"]


@pytest.mark.parametrize("command", ["check", "modes", "analyse"])
def test_mechanisms_are_refused(flexstage: Command, tmp_path: Path, command: str) -> None:
    (tmp_path / "stage.toml").write_text(PIVOTED)
    expect_refusal(flexstage(command, "stage.toml"), "singular", "platform")


def test_actuators_without_a_path_are_refused(flexstage: Command, tmp_path: Path) -> None:
    design = tmp_path / "stage.toml"
    lines = design.read_text().splitlines()
    left = [line for line in lines if not line.startswith(FRONT)]
    assert len(left) == len(lines) - 1
    design.write_text("\n".join(left))
    for command in ("check", "mapping", "analyse"):
        expect_refusal(flexstage(command, "stage.toml"), "B1/pzt", "B1/tip", "is not in a chain of links from ground to platform")


@pytest.mark.parametrize("joins", ['["tip", "ground"]', '["tip", "base"]'])
def test_actuators_looped_back_are_refused(flexstage: Command, tmp_path: Path, joins: str) -> None:
    """Both ends of the chain on the ground, or the stack between the ends of one loop: it pushes nothing."""
    design = tmp_path / "stage.toml"
    design.write_text(swapped('joins = ["tip", "platform"]', f"joins = {joins}")(design.read_text()))
    for command in ("check", "mapping", "analyse"):
        expect_refusal(flexstage(command, "stage.toml"), "B1/pzt", "B1/tip", "is not in a chain of links from ground to platform")


def test_an_assignment_is_named_once(flexstage: Command) -> None:
    ended = flexstage("modes", "stage.toml", "--set", "neck=2mm")
    expect_refusal(ended, "--set neck=2mm: it has several values: thickness, profile.", '"neck.thickness=..."')


def test_all_findings_are_told_at_once(flexstage: Command, tmp_path: Path) -> None:
    design = tmp_path / "stage.toml"
    text = swapped(NECK, "thickness = 1.54")(design.read_text())
    design.write_text(swapped('part = "pole_neck"', 'part = "pole_nek"')(swapped("poisson = 0.3", "poisson = 0.7")(text)))
    expect_refusal(flexstage("check", "stage.toml"), "parts.neck.thickness")
    found = flexstage("check", "stage.toml", "--json", "-")
    assert found.code == 2
    assert found.document["sound"] is False
    assert len(found.document["errors"]) == found.err.count("error: ")


def test_large_files_are_refused_at_once(flexstage: Command, tmp_path: Path) -> None:
    with (tmp_path / "stage.toml").open("wb") as file:
        file.truncate(100_000_000)
    expect_refusal(flexstage("analyse", "stage.toml"), "stage.toml", "5 MB")


def test_missing_files_are_refused(flexstage: Command) -> None:
    expect_refusal(flexstage("analyse", "nowhere.toml"), "nowhere.toml", "file not found")


def test_binary_files_are_refused(flexstage: Command, tmp_path: Path) -> None:
    (tmp_path / "stage.toml").write_bytes(bytes(range(256)))
    expect_refusal(flexstage("analyse", "stage.toml"), "stage.toml", "UTF-8")


SETS = {
    "horizontal/front.thicknes=1 mm": ("thicknes", "thickness"),
    "horizontal/front.thickness": ("equals sign",),
    "horizontal/front.thickness=1.4": ("unit missing",),
    "horizontal/front.thickness=1.4 N": ("force",),
    "horizontal/front.thickness=-1 mm": ("greater than 0",),
    "horizontal/front.thickness=nan mm": ("must be finite",),
}


@pytest.mark.parametrize("change", sorted(SETS))
def test_bad_changes_are_refused(flexstage: Command, change: str) -> None:
    expect_refusal(flexstage("analyse", "stage.toml", "--set", change), *SETS[change])


@pytest.mark.parametrize(
    ("arguments", "texts"),
    [
        (("response", "stage.toml", "--input", "B9"), ("B9",)),
        (("response", "stage.toml", "--band", "1 Hz", "1 mm"), ("--band", "frequency")),
        (("response", "stage.toml", "--band", "10 Hz", "1 Hz"), ("--band", "10 Hz")),
        (("response", "stage.toml", "--input-asd", "ground.z=1 m"), ("--input-asd ground.z=1 m", "amplitude spectral density")),
        (("response", "stage.toml", "--input-asd", "B9=1 nm/Hz^0.5"), ("B9", "B1")),
        (("stiffness", "stage.toml", "--point", "chuk"), ("--point", "chuk")),
        (("stiffness", "stage.toml", "--load-point", "chuk"), ("--load-point", "chuk")),
        (("stiffness", "stage.toml", "--at", "chuk"), ("--at chuk", "Use --point chuk")),
        (("workspace", "stage.toml", "--command", "x=50"), ("--command x=50", "unit missing")),
        (("workspace", "stage.toml", "--command", "q=50um"), ("--command q=50um", "x, y, z")),
        (("budget", "stage.toml", "--temperature", "1 mm"), ("--temperature", "length")),
        (("budget", "stage.toml", "--point", "chuck"), ("chuck", "platform")),
        (("drift", "stage.toml", "--ground", "stel"), ("stel", "steel")),
        (("sensitivities", "stage.toml", "--parameters", "parts.nek.thickness"), ("nek", "neck")),
        (("plan", "stage.toml", "-o", "plan.gif"), (".gif", ".svg")),
        (("catalogue", "screws"), ("screws", "materials")),
        (("new", "other.toml", "--case", "double-triangel"), ("double-triangel", "double-triangle")),
        (("new", "stage.toml"), ("stage.toml", "--force")),
    ],
)
def test_bad_options_are_refused(flexstage: Command, arguments: tuple[str, ...], texts: tuple[str, ...]) -> None:
    expect_refusal(flexstage(*arguments), *texts)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (
            ("analyse", "stage.toml", "--model", "solid"),
            "--model: must be ideal, mapped or lumped (got solid). For solids, use flexstage solid or flexstage verify.",
        ),
        (("modes", "stage.toml", "--model", "lumpd"), "--model: must be ideal, mapped or lumped (got lumpd)."),
        (("solid", "stage.toml", "--scope", "hinges"), "--scope: must be hinge, unit or stage (got hinges)."),
    ],
)
def test_words_that_are_no_choice_are_told_in_one_line(flexstage: Command, arguments: tuple[str, ...], said: str) -> None:
    ended = flexstage(*arguments)
    assert ended.code == 2
    assert ended.out == ""
    assert ended.err == f"error: {said}\n"


@pytest.mark.parametrize("model", ["ideal", "mapped", "lumped"])
def test_words_that_are_a_choice_are_taken(flexstage: Command, model: str) -> None:
    assert flexstage("mapping", "stage.toml", "--model", model, "--json", "-").document["model"] == model


OLD_OPTIONS = """
modes --reading --model, stiffness --load-at --load-point, budget --at --point, stroke --points --steps, misalign --points --steps
loop --hold --fixed, buckle --beyond --post-buckling, buckle --side --branch, misalign --copy --instance, misalign --size --amount
misalign --about --rotation, misalign --along --translation, rig --inputs --input-quantity, rig --tap --input-signal
response --noise --input-asd, rig --noise --drive-rms, identify --allow --accept-fault, compare --only --channels
loop --command --amplitude, loop --sensitivity --max-sensitivity, loop --follow --tracking, loop --compensate --feedforward
loop --damping --force-feedback, loop --goal --tune-for, loop --single --float32, loop --allow --accept-fault, serve --fast --no-realtime
update --free --parameters, sensitivities --parameter --parameters, new --parameters --list-parameters, new --parameter --case-parameter
solid --what --scope, update --resolution --frequency-resolution
"""


@pytest.mark.parametrize("case", OLD_OPTIONS.strip().replace("\n", ", ").split(", "))
def test_an_option_by_its_old_name_is_refused_with_the_new_one(flexstage: Command, case: str) -> None:
    command, old, new = case.split()
    for words in ((old, "x"), (f"{old}=x",)):
        expect_refusal(flexstage(command, "stage.toml", *words), f"{old}: unknown option. Use {new}.")


def test_an_option_that_became_an_argument_is_refused_with_the_argument(flexstage: Command) -> None:
    expect_refusal(flexstage("schema", "--of", "study"), "--of: unknown option. Use schema KIND.")


@pytest.mark.parametrize(("spelled", "command"), [("analyze", "analyse"), ("optimize", "optimise")])
def test_american_spelling_is_taken(flexstage: Command, spelled: str, command: str) -> None:
    first, second = (flexstage(name, "--help") for name in (spelled, command))
    assert first.code == second.code == 0
    assert first.out.replace(spelled, command) == second.out
    assert spelled not in flexstage("--help").out


USAGE = {
    "analyst stage.toml": "analyst: unknown command. Use analyse.",
    "xyz": "xyz: unknown command. Use 'flexstage --help' to list all commands.",
    "modes": "STAGE.TOML: missing. Use e.g. 'flexstage modes stage.toml --model mapped --json modes.json'.",
    "new": "STAGE.TOML: missing. Use e.g. 'flexstage new stage.toml --case hexapod'.",
    "plan stage.toml": "--output: missing. Use e.g. 'flexstage plan stage.toml -o plan.svg'.",
    "modes a.toml b.toml": "b.toml: unexpected argument. Use e.g. 'flexstage modes stage.toml --model mapped --json modes.json'.",
    "analyse stage.toml --ful": "--ful: unknown option. Use --full.",
    "analyse stage.toml --full=1": "--full: takes no value. Use e.g. 'flexstage analyse stage.toml",
    "modes stage.toml --temp 5K": "--temp: unknown option. Use --temperature.",
    "modes stage.toml --mod mapped": "--mod: unknown option. Use --model",
    "loop stage.toml --max-sens 2": "--max-sens: unknown option. Use --max-sensitivity.",
    "catalog": "catalog: unknown command. Use catalogue.",
    "buckle --xyz": "--xyz: unknown option. Use 'flexstage buckle --help' to list all options.",
    "stroke stage.toml --steps 1": "--steps: must be at least 2 (got 1).",
    "stroke stage.toml --steps=x": "--steps: must be an integer (got x).",
    "loop stage.toml --seconds x": "--seconds: must be a number (got x).",
    "buckle stage.toml --branch up": "--branch: must be one of along, against (got up).",
}


@pytest.mark.parametrize(("line", "said"), USAGE.items())
def test_a_usage_error_has_the_form_of_all_messages(flexstage: Command, line: str, said: str) -> None:
    ended = flexstage(*line.split())
    expect_refusal(ended)
    assert ended.err.startswith(f"error: {said}")
    assert ended.err.count("\n") == 1
