"""JSON documents of every command, for every model: valid, complete, in agreement with the library and with one another."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from flexstage.analysis.dynamics.modes import modes
from flexstage.analysis.dynamics.random_response import Rate, Spectrum, random_response
from flexstage.analysis.linear_statics.lost_motion import lost_motion
from flexstage.base.storage.digest import digest
from flexstage.cases.double_triangle import double_triangle
from flexstage.cases.registry import CASES
from flexstage.mechanism.store import load
from flexstage.models.ideal import ideal
from flexstage.models.lumped import lumped
from flexstage.show.document import FORMAT
from tests.apps.command import Command, Ended, design_in
from tests.hygiene.source import ROOT
from tests.show.stages import seldom
from tools.json_page import PAGE, written

MODELS = ("ideal", "mapped", "lumped")
_SAID: dict[tuple[str, ...], Ended] = {}


@pytest.fixture
def flexstage(flexstage: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Command:
    """Runs commands in a folder that holds the shipped stage; a document on stdout, which is of that stage, is asked for once."""
    monkeypatch.chdir(tmp_path)

    def ended(*words: str) -> Ended:
        if words[-2:] != ("--json", "-"):
            return flexstage(*words)
        if words not in _SAID:
            _SAID[words] = flexstage(*words)
        return _SAID[words]

    return ended


WITH_MODEL = ("mapping", "stiffness", "lost-motion", "modes", "response", "workspace", "analyse")
LUMPED_ONLY = ("drift", "sensitivities", "budget")
WITHOUT_ELASTICITY = {"mapping", "workspace", "analyse"}


def matrices(value: Any) -> list[dict[str, Any]]:
    """Every matrix in a document."""
    if isinstance(value, dict):
        own = [value] if {"rows", "columns", "unit", "values"} <= set(value) else []
        return own + [found for item in value.values() for found in matrices(item)]
    return [found for item in value for found in matrices(item)] if isinstance(value, list) else []


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("name", WITH_MODEL)
def test_every_command_gives_a_document_for_every_model(flexstage: Command, name: str, model: str) -> None:
    ended = flexstage(name, "stage.toml", "--model", model, "--json", "-")
    if model == "ideal" and name not in WITHOUT_ELASTICITY:
        assert ended.code == 2
        assert ended.out == ""
        assert "--model ideal" in ended.err
        return
    assert ended.code == 0, ended.err
    document = ended.document
    assert document["format"] == FORMAT
    assert (document["kind"], document["model"], document["name"]) == (name, model, "double triangle")
    assert document["physics_digest"] == digest(load("stage.toml"), physics=True)
    assert matrices(document) or name == "response"
    for matrix in matrices(document):
        shape = (len(matrix["rows"]), len(matrix["columns"]))
        assert np.shape(np.array(matrix["values"], dtype=object)) == shape
        assert isinstance(matrix["unit"], str) or np.shape(matrix["unit"]) == shape


@pytest.mark.parametrize("name", LUMPED_ONLY)
def test_commands_of_the_lumped_reading_give_a_document(flexstage: Command, name: str) -> None:
    arguments = ["--parameters", "parts.neck.thickness"] if name == "sensitivities" else []
    document = flexstage(name, "stage.toml", *arguments, "--json", "-").document
    assert (document["kind"], document["model"]) == (name, "lumped")


def test_parameters_are_separated_by_commas_or_options(flexstage: Command) -> None:
    words = (("parts.neck.thickness, parts.neck.width",), ("parts.neck.thickness", "--parameters", "parts.neck.width"))
    one, two = (flexstage("sensitivities", "stage.toml", "--parameters", *each, "--json", "-").document for each in words)
    assert one == two


def test_mapping_is_that_of_the_paper(flexstage: Command) -> None:
    document = flexstage("mapping", "stage.toml", "--json", "-").document
    assert document["R_a"]["rows"] == ["B1", "B2", "B3", "B4", "B5", "B6"]
    assert document["R_a"]["columns"] == ["x", "y", "z", "rx", "ry", "rz"]
    assert document["R_a"]["unit"][0] == ["1", "1", "1", "m/rad", "m/rad", "m/rad"]
    assert np.linalg.det(document["R_a"]["values"]) == pytest.approx(-3.06e-4, rel=1e-5)
    assert np.linalg.det(document["R_s"]["values"]) == pytest.approx(-0.01482975, rel=1e-5)
    assert (document["mobility"], len(document["idle"]), document["actuated"]) == (6, 6, True)
    assert np.array(document["jacobian"]["values"]) @ np.array(document["R_a"]["values"]) == pytest.approx(np.eye(6), abs=1e-12)


def test_stiffness_and_compliance_are_inverse(flexstage: Command) -> None:
    document = flexstage("stiffness", "stage.toml", "--model", "mapped", "--json", "-").document
    assert np.array(document["compliance"]["values"]) @ np.array(document["stiffness"]["values"]) == pytest.approx(np.eye(6), abs=1e-9)
    assert document["held"]["tensor"]["values"] == pytest.approx(np.diag([15.4499e6] * 2), rel=1e-5, abs=1.0)
    assert document["held"]["tensor"]["unit"] == "N/m"
    assert document["centre_m"] == pytest.approx([0.0, 0.0, -0.025], abs=1e-9)


def test_mapped_modes_are_those_of_equation_28(flexstage: Command) -> None:
    document = flexstage("modes", "stage.toml", "--model", "mapped", "--json", "-").document
    frequencies = [mode["frequency_hz"] for mode in document["modes"]]
    assert frequencies == pytest.approx([110.910, 110.910, 135.148, 145.505, 176.690, 176.690], rel=1e-5)
    assert [mode["in_plane"] for mode in document["modes"]] == [False, False, False, True, True, True]
    assert document["platform"] == [0, 1, 2, 3, 4, 5]


def test_lumped_modes_are_limited_and_say_so(flexstage: Command) -> None:
    document = flexstage("modes", "stage.toml", "--json", "-").document
    found = modes(lumped(load("stage.toml")))
    assert document["computed"] == len(found.names) > document["listed"] == len(document["modes"]) >= 24
    assert [mode["frequency_hz"] for mode in document["modes"]] == pytest.approx(
        found.frequencies[: document["listed"]].tolist(), rel=1e-12
    )
    assert document["modes"][document["listed"] - 1]["frequency_hz"] < document["limit_hz"] < found.frequencies[document["listed"]]
    assert [mode["number"] - 1 for mode in document["modes"] if mode["platform"]] == document["platform"]
    assert [mode["number"] - 1 for mode in document["modes"] if mode["local"]] == document["local"]


def test_budgets_add_up_to_the_losses(flexstage: Command) -> None:
    document = flexstage("lost-motion", "stage.toml", "--json", "-").document
    stage = load("stage.toml")
    loss = lost_motion(ideal(stage), lumped(stage)).loss
    for name, actuator in document["actuators"].items():
        assert actuator["loss"] == pytest.approx(loss.at(name, name), rel=1e-12)
        assert actuator["gain"] == pytest.approx(1.0 - actuator["loss"], rel=1e-12)
        assert sum(actuator["budget"].values()) == pytest.approx(actuator["loss"], abs=1e-12)
        assert sum(actuator["budget_by_link"].values()) == pytest.approx(actuator["loss"], abs=1e-12)
    largest = max(document["actuators"]["B4"]["budget"], key=document["actuators"]["B4"]["budget"].get)
    assert largest == "B4/pivot.rz"


def test_response_tends_to_the_static_gain(flexstage: Command) -> None:
    document = flexstage(
        "response", "stage.toml", "--input", "B4", "--output", "platform.z", "--band", "1 mHz", "10 mHz", "--json", "-"
    ).document
    assert (document["rows"], document["columns"], document["unit"]) == (["platform.z"], ["B4"], [["1"]])
    gain = flexstage("lost-motion", "stage.toml", "--json", "-").document["gain"]
    assert document["real"][0][0][0] == pytest.approx(gain["values"][2][3], rel=1e-6)
    assert document["damping"] == {"law": "modal", "ratio": 0.01}


def test_transmissibility_is_one_at_low_frequency(flexstage: Command) -> None:
    document = flexstage(
        "response", "stage.toml", "--input", "ground", "--output", "platform", "--band", "1 mHz", "2 mHz", "--json", "-"
    ).document
    assert np.array(document["real"][0]) == pytest.approx(np.eye(6), abs=1e-6)


def test_random_inputs_give_rms_values(flexstage: Command) -> None:
    named = ("--output", "platform.z", "--band", "1 Hz", "1 kHz", "--json", "-")
    document = flexstage(
        "response", "stage.toml", "--input-asd", "ground.z=1e-5 m/s^2/Hz^0.5", "--input-asd", "B4=1 nm/Hz^0.5", *named
    ).document
    found = document["random"]
    spectra = {"ground.z": Spectrum(1e-10, rate=Rate.ACCELERATION), "B4": Spectrum(1e-18)}
    expected = random_response(lumped(load("stage.toml")), ("platform.z",), spectra, (1.0, 1000.0))
    assert found["inputs"] == ["ground.z", "B4"]
    assert found["rms"] == pytest.approx(expected.rms.tolist(), rel=1e-9)


def test_analyse_nests_the_documents_of_the_commands(flexstage: Command) -> None:
    whole = flexstage("analyse", "stage.toml", "--json", "-").document
    for name in ("mapping", "stiffness", "lost-motion", "modes", "workspace", "drift", "budget"):
        alone = flexstage(name, "stage.toml", "--json", "-").document
        common = {key: value for key, value in alone.items() if key in whole[name]}
        assert whole[name] == common, name
        beside = {"format", "kind", "version", "name", "model", "physics_digest", "warnings", "defaults", "loaded", "second_order"}
        assert set(alone) - set(common) <= beside
        assert alone.get("loaded", whole["loaded"]) == whole["loaded"]
        assert ("second_order" in alone) == (name in ("workspace", "budget"))
        assert alone.get("second_order", whole["second_order"]) == whole["second_order"]
    assert [line["passed"] for line in whole["requirements"]] == [True] * 8
    assert list(whole).index("requirements") < list(whole).index("mapping")


def test_what_a_reading_does_not_give_is_null_with_a_reason(flexstage: Command) -> None:
    document = flexstage("analyse", "stage.toml", "--model", "ideal", "--json", "-").document
    for name in ("stiffness", "lost-motion", "modes", "response", "transmissibility", "drift", "budget"):
        assert document[name] is None
        assert document["reasons"][name]
    assert document["workspace"]["stress"] is None
    assert "lumped" in document["workspace"]["reasons"]["stress"]


def test_numbers_that_are_not_finite_are_null_with_a_reason(flexstage: Command) -> None:
    document = flexstage("workspace", "stage.toml", "--json", "-").document
    assert document["loads"]["actuators"]["B1"]["preload_n"] is None
    assert document["reasons"]["loads.actuators.B1.preload_n"] == "not a number"


ALIKE = ("double-triangle", "double-triangle-a", "double-triangle-refitted", "tip-tilt-four")
MOUNTS = ("mirror-mount", "telescope-mount")
"""Cases in which nothing is meant to move."""


@pytest.mark.parametrize("name", [pytest.param(name, marks=pytest.mark.full) if name in ALIKE else seldom(name) for name in sorted(CASES)])
def test_every_case_is_analysed(flexstage: Command, tmp_path: Path, name: str) -> None:
    design_in(tmp_path, name)
    ended = flexstage("analyse", "stage.toml", "--full", "--json", "out.json")
    assert ended.code == 0, ended.err
    assert json.loads((tmp_path / "out.json").read_text())["mapping"]["mobility"] >= (0 if name in MOUNTS else 1)
    assert "Mobility" in ended.out


def test_changes_are_told_old_new_and_relative(flexstage: Command) -> None:
    document = flexstage("analyse", "stage.toml", "--set", "horizontal/front.thickness=1.4mm", "--json", "-").document
    (value,) = document["changes"]["set"]
    assert (value["old"], value["new"]) == (0.00154, 0.0014)
    figures = {figure["name"]: figure for figure in document["changes"]["figures"]}
    yaw = figures["frequency.platform.4"]
    assert yaw["old"] > yaw["new"] == pytest.approx(document["modes"]["modes"][3]["frequency_hz"], rel=1e-12)
    assert yaw["relative"] == pytest.approx(yaw["new"] / yaw["old"] - 1.0, rel=1e-9)
    assert document["physics_digest"] != digest(double_triangle(), physics=True)


ENVELOPE = {"format", "kind", "version", "name", "model", "physics_digest", "warnings", "defaults", "method", "provenance", "reasons"}
ENVELOPE |= {"loaded", "second_order"}  # sections of their own


def page_section(kind: str) -> str:
    """The section of docs/json.md about one command."""
    text = (ROOT / "docs" / "json.md").read_text(encoding="utf-8")
    return text.partition(f"\n## {kind}\n")[2].partition("\n## ")[0]


@pytest.mark.parametrize("name", [*WITH_MODEL, *LUMPED_ONLY, "check", "catalogue"])
def test_every_key_is_documented(flexstage: Command, name: str) -> None:
    extra = {"analyse": ["--set", "horizontal/front.thickness=1.4mm"], "sensitivities": ["--parameters", "parts.neck.thickness"]}
    extra |= {"mapping": ["--model", "lumped"]}
    design = [] if name == "catalogue" else ["stage.toml"]
    document = flexstage(name, *design, *extra.get(name, []), "--json", "-").document
    section = page_section(name)
    assert [key for key in document if key not in ENVELOPE and not re.search(rf"`{key}[`.\[]", section)] == []


def test_lists_of_fields_are_those_of_the_results() -> None:
    page = PAGE.read_text(encoding="utf-8")
    assert page == written(page), "python -m tools.json_page writes them anew"
