"""Calibration: hinges' 6x6 in a design file's text. What is put in is known here, so that nothing needs finite elements."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import flexstage as fs
from flexstage.analysis.caveats import defaults
from flexstage.analysis.linear_statics.units import units
from flexstage.analysis.trust import TheoryCheck
from flexstage.base.finding import DesignError
from flexstage.base.record import walk
from flexstage.base.storage.digest import digest
from flexstage.beams.compliance import compliance
from flexstage.cases.double_triangle import double_triangle
from flexstage.cases.parallelogram import parallelogram
from flexstage.mechanism.assembly.expand import expand
from flexstage.mechanism.drawn import calibrated_parts, with_drawn_parts
from flexstage.mechanism.restrict import isolate
from flexstage.solid.fea.geometry.piece import span
from flexstage.solid.fea.hinges.hinge_form import HingeForm, HingeSolid
from flexstage.solid.fea.hinges.roots import Roots
from flexstage.solid.results.calibration import stand_ins, substitute_parts
from flexstage.solid.results.hinges import distinct_hinges, solid_hinges
from flexstage.solid.results.resolution import Converged
from flexstage.solid.results.verification import Row, Verification, departures, hinge_rows, unit_rows, verdict
from flexstage.solid.show.tables import calibration_table, verification_table
from flexstage.spatial.frame import transport
from tests.models.solid_studies import softened


def test_every_hinge_is_found_once() -> None:
    found = distinct_hinges(double_triangle())
    assert list(found) == ["neck-back", "neck-front", "foot_notch-back", "foot_notch-front", "lever_notch", "pole_neck"]
    assert found["neck-back"].links == ("horizontal/back",)
    assert found["pole_neck"].links == ("vertical/lower", "vertical/upper")


def test_a_hinge_has_the_roots_that_its_link_has() -> None:
    found = distinct_hinges(double_triangle())
    roots = {name: (hinge.form.roots.first, hinge.form.roots.second) for name, hinge in found.items()}
    assert roots["neck-back"] == (False, True)
    assert roots["neck-front"] == (True, True)
    assert roots["lever_notch"] == (True, False)  # from the lever to the ground
    alone = distinct_hinges(isolate(double_triangle(), "B1"))
    assert alone["neck-front"].form.roots == Roots(True, False)  # its output has no outline


def test_a_copy_that_departs_is_a_hinge_of_its_own() -> None:
    stage = replace(double_triangle(), overrides={"B2/front.thickness": 1.55e-3})
    assert "B2/front" in distinct_hinges(stage)


@pytest.mark.parametrize("stage", [parallelogram(), double_triangle()])
def test_a_file_calibrated_with_its_own_theory_is_read_alike(stage: fs.Mechanism) -> None:
    after = fs.loads(fs.solid.calibrate(fs.dumps(stage), softened(1.0)).text)
    first, second = (fs.statics(fs.lumped(each)).stiffness.values for each in (stage, after))
    scale = np.sqrt(np.diag(first))
    np.testing.assert_allclose(second / np.outer(scale, scale), first / np.outer(scale, scale), atol=1e-5)


@pytest.mark.parametrize("stage", [parallelogram(), double_triangle()])
def test_mass_stays(stage: fs.Mechanism) -> None:
    after = fs.loads(fs.solid.calibrate(fs.dumps(stage), softened(1.0)).text)
    masses = [np.abs(fs.lumped(each).base_inertia[:, :3].sum()) for each in (stage, after)]
    assert masses[1] == pytest.approx(masses[0], rel=1e-6)
    frequencies = [fs.modes(fs.lumped(each)).frequencies[:2] for each in (stage, after)]
    np.testing.assert_allclose(frequencies[1], frequencies[0], rtol=2e-3)  # a given part has its mass at its centre


@pytest.mark.parametrize("stage", [parallelogram(), double_triangle()])
def test_calibrated_hinges_grow_and_lose_energy_as_the_drawn_ones(stage: fs.Mechanism) -> None:
    materials = {name: replace(each, loss_factor=0.003, expansion=1e-5) for name, each in stage.materials.items()}
    drawn_stage = replace(stage, materials=materials, damping=fs.StructuralDamping(), ground="none")
    after = fs.loads(fs.solid.calibrate(fs.dumps(drawn_stage), softened(1.0)).text)
    first, second = (fs.lumped(each) for each in (drawn_stage, after))
    assert {name: part.loss_factor for name, part in second.stiffness.items()} == {
        name: part.loss_factor for name, part in first.stiffness.items()
    }
    moved = [fs.drift(*each).of().values for each in ((drawn_stage, first), (after, second))]
    np.testing.assert_allclose(moved[1], moved[0], atol=1e-4 * np.abs(moved[0]).max())  # six digits of the file, over lever arms
    assert not [each for each in defaults(after) if "loss factor" in each.what]
    bare = replace(
        after,
        parts={name: replace(part, replaces="") if isinstance(part, fs.ComplianceMatrix) else part for name, part in after.parts.items()},
    )
    assert len([each for each in defaults(bare) if "loss factor" in each.what]) == len(calibrated_parts(bare))


def test_softer_hinges_are_read_softer() -> None:
    stage = parallelogram()
    after = fs.loads(fs.solid.calibrate(fs.dumps(stage), softened(1.2)).text)
    neck = compliance(after.parts["neck-front"], None)
    np.testing.assert_allclose(np.diag(neck) / np.diag(compliance(stage.parts["neck"], stage.materials["steel"])), 1.2, rtol=1e-5)
    assert fs.statics(fs.lumped(after)).held.principal[1] < fs.statics(fs.lumped(stage)).held.principal[1]


def rooted(forms: Mapping[str, HingeForm]) -> dict[str, HingeSolid]:
    """Hinges of beam theory with a spring in series at the second end where that alone has a root: what turns end for end shows."""
    found = softened(1.0)(forms)
    for name, form in forms.items():
        assert form.roots.second or not form.roots.first
        if form.roots == Roots(False, True):
            end = transport(np.array([-0.5 * span(form.part), 0.0, 0.0]))  # from the second end to the centre
            more = found[name].compliance + 0.1 * end @ np.diag(np.diag(found[name].compliance)) @ end.T
            found[name] = replace(found[name], compliance=more, stiffness=np.linalg.inv(more), whole=more)
    return found


def test_a_root_yields_at_its_own_end() -> None:
    stage = double_triangle()
    after = fs.loads(fs.solid.calibrate(fs.dumps(stage), rooted).text)
    assert {link.part for link in after.units["horizontal"].links.values()} == {"neck-back", "stack_horizontal", "neck-front"}
    links = expand(after).links
    for name, side in (("back", -1.0), ("pivot", 1.0)):
        copy = "B1" if name == "back" else "B4"
        part = links[f"{copy}/{name}"].part
        assert isinstance(part, fs.ComplianceMatrix)
        matrix = np.array(part.compliance)
        centre = matrix[1, 5] / matrix[5, 5]  # where a moment turns without shifting, seen from the centre
        assert centre == pytest.approx(side * 0.1 / 1.1 * 0.5 * span(expand(stage).links[f"{copy}/{name}"].part), rel=1e-6)


def test_comments_stay_and_the_drawn_hinges_are_kept() -> None:
    text = fs.dumps(parallelogram(), {"parts.neck": "The neck of the prototype.", "units.drive": "The drive."})
    after = fs.solid.calibrate(text, softened(1.1)).text
    assert "# The neck of the prototype." in after
    assert "# The drive." in after
    stage = fs.loads(after)
    assert with_drawn_parts(stage).parts["neck-front"] == parallelogram().parts["neck"]
    assert set(calibrated_parts(stage)) == {"leaf", "neck-back", "neck-front"}
    assert stage.tags["parts.neck-front.compliance"].startswith("derived FEA")


def test_the_error_of_a_calibrated_file_is_that_of_its_worst_hinge() -> None:
    """Each part states its own, to two digits as its source has it; the file's tags the largest."""
    errors = iter([0.02, 0.05, 0.01])

    def compute(forms: Mapping[str, HingeForm]) -> dict[str, HingeSolid]:
        return {name: replace(found, error=next(errors)) for name, found in softened(1.0)(forms).items()}

    found = fs.solid.calibrate(fs.dumps(parallelogram()), compute)
    assert {tag for tag in fs.loads(found.text).tags.values() if tag.startswith("derived FEA")} == {"derived FEA within 5 %"}
    assert sorted(part.source.rpartition("error ")[2] for part in found.parts.values()) == ["1 %", "2 %", "5 %"]


def test_tags_of_the_drawn_hinge_follow_it() -> None:
    stage = double_triangle()
    after = fs.loads(fs.solid.calibrate(fs.dumps(stage), softened(1.0)).text)
    own = {key: tag for key, tag in stage.tags.items() if key.startswith("parts.neck.")}
    assert own
    assert {key.replace("parts.neck.", "parts.neck-drawn."): tag for key, tag in own.items()}.items() <= after.tags.items()


def test_a_calibrated_hinge_has_the_symmetry_of_the_drawn_one() -> None:
    """What a mesh adds at random goes: reflected across y and z a hinge is itself, so that only y and rz, and z and ry, may be coupled."""
    random = np.random.default_rng(5)

    def uneven(forms: Mapping[str, HingeForm]) -> Mapping[str, HingeSolid]:
        found = softened(1.0)(forms)
        scale = {name: np.sqrt(np.diag(each.compliance)) for name, each in found.items()}
        rough = {name: 1e-3 * np.outer(each, each) * random.standard_normal((6, 6)) for name, each in scale.items()}
        return {name: replace(each, compliance=each.compliance + rough[name] + rough[name].T) for name, each in found.items()}

    apart = np.ones((6, 6), dtype=bool)
    apart[range(6), range(6)] = apart[[1, 5, 2, 4], [5, 1, 4, 2]] = False
    parts = stand_ins(solid_hinges(double_triangle(), uneven))
    assert len(parts) == 6
    assert not any(np.any(np.array(each.compliance)[apart]) for each in parts.values())


def test_what_cannot_be_told_from_the_blocks_keeps_beam_theory() -> None:
    found = fs.solid.calibrate(fs.dumps(parallelogram()), softened(1.1, stubs=0.95))
    np.testing.assert_allclose(found.over_beam_theory["leaf"], [0.1, 0.1, 0.1, np.nan, 0.1, 0.1], atol=1e-6)
    assert calibration_table(found).texts()[1][5].startswith("-")
    assert "rx by beam theory" in found.parts["leaf"].source
    rows = list(hinge_rows(parallelogram(), found.hinges))
    assert not any(row.figure == "compliance rx" for row in rows)


def test_refusals() -> None:
    text = fs.dumps(parallelogram())
    once = fs.solid.calibrate(text, softened(1.0)).text
    with pytest.raises(DesignError, match="its compliance matrix is from FEA already"):
        fs.solid.calibrate(once, softened(1.0))
    with pytest.raises(DesignError, match="leaf: the error of its compliance matrix by FEA is 30 %"):
        fs.solid.calibrate(text, softened(1.0, error=0.3))
    departing = replace(parallelogram(), overrides={"B/front.thickness": 2.1e-3})
    with pytest.raises(DesignError, match="B/front: overrides its part neck"):
        fs.solid.calibrate(fs.dumps(departing), softened(1.0))


def test_rows_that_calibrated_parts_touch_are_not_independent() -> None:
    stage = fs.loads(fs.solid.calibrate(fs.dumps(parallelogram()), softened(1.1)).text)
    rows = list(hinge_rows(stage, solid_hinges(stage, softened(1.1))))
    assert {row.trust for row in rows} == {TheoryCheck.DEPENDENT}
    assert max(abs(row.difference) for row in rows) < 1e-5
    assert verdict(tuple(rows)).startswith("Not independent")


@pytest.mark.parametrize("stage", [parallelogram(), double_triangle()])
def test_with_matrices_is_what_the_file_says(stage: fs.Mechanism) -> None:
    same = substitute_parts(stage, solid_hinges(stage, softened(1.1)))
    read = fs.loads(fs.solid.calibrate(fs.dumps(stage), softened(1.1)).text)
    assert digest(same, physics=True) == digest(read, physics=True)


@pytest.mark.parametrize(
    ("theory", "calibrated_value", "error", "trust"),
    [
        (101.0, None, 0.001, TheoryCheck.THEORY),
        (101.0, None, 0.015, TheoryCheck.EITHER),
        (101.0, None, 0.2, TheoryCheck.UNCLEAR),
        (110.0, None, 0.001, TheoryCheck.FEA),
        (110.0, 101.0, 0.001, TheoryCheck.CALIBRATED),
        (110.0, 102.5, 0.01, TheoryCheck.CALIBRATED),
        (110.0, 108.0, 0.001, TheoryCheck.FEA),
        (110.0, 101.0, 0.06, TheoryCheck.UNCLEAR),
    ],
)
def test_trust(theory: float, calibrated_value: float | None, error: float, trust: TheoryCheck) -> None:
    row = Row("stage", "mode 1", "Hz", theory, 100.0, error, calibrated=calibrated_value)
    assert row.trust is trust
    assert replace(row, calibration=("neck",)).trust is TheoryCheck.DEPENDENT


def test_a_loss_is_known_as_well_as_the_gain_that_it_is_the_rest_of() -> None:
    """1 - g to 1 % of g, which is 24 % of a loss of 0.04."""
    theory = units(double_triangle(), omissions=False)
    found = SimpleNamespace(figures={"gain": 0.96}, loss=0.04)
    gain, loss = unit_rows(double_triangle(), theory, Converged({"vertical": found}, {"vertical: gain": 0.01}, 3))  # pyright: ignore[reportArgumentType]
    assert (gain.figure, gain.fea_error, loss.figure) == ("gain", 0.01, "loss")
    assert loss.fea_error == pytest.approx(0.24, rel=1e-9)


@pytest.mark.parametrize(
    ("unit", "theory", "calibrated_value", "words"),
    [
        ("N/m", 4.4, 4.3, "theory 4.4 times too stiff (its bodies are rigid)"),
        ("N/m", 1.1, 1.1, "theory 10 % too stiff (its bodies are rigid)"),
        ("N/m", 1.1, 1.0, "theory 10 % too stiff"),
        ("N m/rad", 0.25, 0.3, "theory 4 times too soft"),
        ("m/N", 0.25, None, "theory 4 times too stiff"),
        ("rad/(N m)", 2.0, None, "theory 2 times too soft"),
        ("Hz", 2.0, 2.0, "theory 2 times too high (its bodies are rigid)"),
        ("Hz", 0.9, None, "theory 10 % too low"),
        ("N/m", 1.01, 1.0, ""),
    ],
)
def test_headlines_say_in_words_where_theory_and_finite_elements_differ(
    unit: str, theory: float, calibrated_value: float | None, words: str
) -> None:
    """The worst figure of each unit, also where another is too coarse to tell."""
    row = Row("stage", "figure", unit, theory, 1.0, 0.001, calibrated=calibrated_value)
    better = replace(row, figure="better", theory=1.0 + 0.5 * (theory - 1.0))
    coarse = replace(row, figure="coarse", theory=1.1, fea_error=0.75)
    assert departures((better, row, coarse)) == (f"figure: {words}" if words else "")
    found = Verification(parallelogram(), (better, row, coarse), {}, None, None, {})
    suffices = f"Theory suffices for {0 if words else 2} of 3 figures of the stage."
    assert found.headline == (f"Figure: {words}. {suffices}" if words else suffices)
    assert verdict((better, row, coarse)).startswith(f"Figure: {words}. " if words else "Lumped theory")


def test_what_is_not_known_gets_no_verdict() -> None:
    known = Row("stage", "mode 1", "Hz", 101.0, 100.0, 0.001)
    without_error = replace(known, fea_error=None, reason="the error of FEA is unknown")
    without_partner = replace(known, figure="mode 2", theory=None, reason="theory has no mode like it")
    assert {row.trust for row in (without_error, without_partner)} == {None}
    for row in (without_error, without_partner):
        said = verdict((row,))
        assert said.startswith("No verdict.")
        assert row.reason in said
        assert "trust" not in said
        body = walk(row)
        assert body["trust"] is None
        assert body["reason"] == row.reason
        assert body["fea_error"] is row.fea_error
        assert body["theory"] is row.theory
        table = verification_table((row,))
        assert table is not None
        assert "0 %" not in table.texts()[1]
        assert any(row.reason in note for note in table.notes)
    both = verdict((known, without_partner))
    assert both.startswith("Lumped theory is up to 1 % off")
    assert "No verdict on 1 of 2 figures. mode 2: theory has no mode like it." in both
