"""Laws of studies: plans do not depend on how they are cut, batches not on how they are computed, failures stay in their places."""

from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from flexstage.analysis.assessment.judge import measure_all
from flexstage.analysis.assessment.requirements import measure
from flexstage.analysis.assessment.sensitivities import step_parameters
from flexstage.analysis.loaded.standing import load_factors
from flexstage.cases.double_triangle import double_triangle
from flexstage.cases.registry import case
from flexstage.mechanism.addresses.address import get, set_value
from flexstage.mechanism.mechanism import Mechanism
from flexstage.models.lumped import lumped
from flexstage.studies.sweeps.definition import Study
from flexstage.studies.sweeps.execution.evaluate import _bisect, piece
from flexstage.studies.sweeps.file import load_study, loads_study
from flexstage.studies.sweeps.loaded import loaded_findings
from flexstage.studies.sweeps.plan import Plan, Sampling, shares
from flexstage.studies.sweeps.variable import apply

STUDY = """
format = "flexstage study 1"
case = "parallelogram"
responses.f = "frequency.1"
responses.k = "stiffness.x"
sweep = { sampling = "sobol", designs = 12, seed = 4 }
[variables]
young = { address = "materials.aluminium.young", from = "-10 %", to = "10 %" }
leaf = { address = "parts.leaf.thickness", from = "0.8 mm", to = "1.2 mm" }
"""


@given(
    st.sampled_from([Sampling.SOBOL, Sampling.LATIN_HYPERCUBE, Sampling.SALTELLI, Sampling.GRID, Sampling.MONTE_CARLO]),
    st.integers(1, 4),
    st.integers(0, 5),
    st.lists(st.integers(0, 48), max_size=4),
)
def test_plans_do_not_depend_on_how_they_are_cut(sampling, dimensions, seed, cuts):
    levels = tuple(range(2, 2 + dimensions)) if sampling is Sampling.GRID else ()
    plan = Plan(sampling, dimensions, 0 if levels else 8, levels, seed)
    whole = shares(plan, 0, plan.designs)
    edges = sorted({0, plan.designs, *(min(cut, plan.designs) for cut in cuts)})
    np.testing.assert_array_equal(np.concatenate([shares(plan, *pair) for pair in pairwise(edges)]), whole)
    assert np.all((whole >= 0.0) & (whole <= 1.0))
    assert len(np.unique(whole, axis=0)) == plan.designs or sampling is Sampling.SALTELLI


@given(st.integers(1, 5), st.integers(1, 60), st.integers(0, 9))
def test_a_latin_hypercube_takes_every_stratum_once(dimensions, count, seed):
    at = shares(Plan(Sampling.LATIN_HYPERCUBE, dimensions, count, seed=seed), 0, count)
    np.testing.assert_array_equal(np.sort(np.floor(at * count).astype(int), axis=0), np.arange(count)[:, None].repeat(dimensions, axis=1))


def test_a_batch_is_its_designs_one_by_one():
    study = loads_study(STUDY)
    found = piece(study, 0, 12)
    for values, responses in zip(found.variables, found.responses, strict=True):
        alone = measure_all(apply(study.design, study.variables, values), tuple(study.columns.values()))
        np.testing.assert_allclose(responses, [float(value) for value in alone], rtol=1e-12)


MASS = """
format = "flexstage 1"
name = "upright leaves"
damping = { law = "modal", ratio = 0.01 }
materials.steel = { young = "200 GPa", poisson = 0.0, density = "8000 kg/m^3", yield_stress = "1000 MPa" }
parts.leaf = { kind = "leaf", material = "steel", length = "60 mm", thickness = "0.3 mm", width = "20 mm" }
parts.stack = { kind = "piezo", stroke = "10 um", stiffness = "0.001 N/um", length = "10 mm", diameter = "5 mm" }
bodies.platform.mass = "2.5 kg"
bodies.platform.centre = ["0 mm", "0 mm", "60 mm"]
bodies.platform.inertia = { xx = "1e-3 kg*m^2", yy = "1e-3 kg*m^2", zz = "1e-3 kg*m^2" }
[links]
a = { joins = ["ground", "platform"], part = "leaf", at = ["-50 mm", "0 mm", "30 mm"], along = "z", bends = "y" }
b = { joins = ["ground", "platform"], part = "leaf", at = ["50 mm", "0 mm", "30 mm"], along = "z", bends = "y" }
push = { joins = ["ground", "platform"], part = "stack", at = ["-60 mm", "0 mm", "60 mm"], along = "x" }
"""


HEAVIER = 'variables.mass = { address = "bodies.platform.mass", from = "1 kg", to = "14 kg", levels = 6 }'
FALLING = 'variables.gravity = { address = "gravity.z", from = "-9 m/s^2", to = "3 m/s^2", levels = 3 }'


def upright(tmp_path: Path, responses: str, variable: str = HEAVIER) -> Study:
    """Upright leaves under 1 to 14 kg: four of six designs hold, as the leaves' critical load and the stack's stiffness bear 97.1 N."""
    (tmp_path / "stage.toml").write_text(MASS)
    head = f'format = "flexstage study 1"\ndesign = "stage.toml"\n{variable}\nsweep = {{ sampling = "grid" }}\n'
    (tmp_path / "study.toml").write_text(head + responses)
    return load_study(tmp_path / "study.toml")


@pytest.mark.parametrize(("variable", "count"), [(HEAVIER, 4), (FALLING, 3)], ids=["mass", "gravity"])
def test_designs_that_differ_in_their_load_alone_are_those_one_by_one(tmp_path: Path, variable: str, count: int):
    """The stiffness is that of one design then, stresses, loads and load factors are those of many."""
    study = upright(tmp_path, 'responses = { b = "buckling", s = "safety", z = "deflection.z", f = "frequency.1" }', variable)
    found = piece(study, 0, count)
    for values, responses in zip(found.variables, found.responses, strict=True):
        alone = measure_all(apply(study.design, study.variables, values), tuple(study.columns.values()))
        np.testing.assert_allclose(responses, [float(value) for value in alone], rtol=1e-9)


@pytest.mark.parametrize("address", ["materials.steel.yield_stress", "parts.stack.stroke"])
def test_designs_that_differ_in_their_limits_alone_are_those_one_by_one(address: str):
    """Stiffness and loads are those of one design then."""
    varied = f'variables.limit = {{ address = "{address}", from = "-40 %", to = "10 %", levels = 3 }}'
    asked = 'responses = { b = "buckling", s = "safety", x = "stroke.x" }\nsweep = { sampling = "grid" }'
    study = loads_study(f'format = "flexstage study 1"\ncase = "parallelogram"\n{varied}\n{asked}\n')
    found = piece(study, 0, 3)
    for values, responses in zip(found.variables, found.responses, strict=True):
        alone = measure_all(apply(study.design, study.variables, values), tuple(study.columns.values()))
        np.testing.assert_allclose(responses, [float(value) for value in alone], rtol=1e-9)


def test_without_strokes_there_is_no_error_of_their_map() -> None:
    stage = case("tilt-stage")
    assert "no stroke actuators" in str(measure_all(stage, (measure(stage, "map_error.x", "requirements"),))[0])


@pytest.mark.parametrize("responses", ['responses.f = "frequency.platform.1"', 'responses.k = "stiffness.x"'], ids=["engine", "dense"])
def test_designs_that_fall_under_their_weight_have_no_values(tmp_path: Path, responses: str):
    study = upright(tmp_path, responses)
    found = piece(study, 0, 6)
    assert np.isfinite(found.responses[:, 0]).tolist() == [True] * 4 + [False] * 2
    for row, factor in {4: 0.868, 5: 0.707}.items():
        assert f"unstable under weight, payloads and forces (load factor {factor})" in found.failures[row]
    assert "0.707 (mass 14 kg)" in loaded_findings(study)[0].what


def test_designs_fall_also_if_only_the_study_has_gravity(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of 2.5 kg without gravity in the design file, 50 m/s^2 and 100 m/s^2 are 1.29 and 2.58 times what the leaves bear."""
    monkeypatch.setattr("tests.laws.test_studies.MASS", 'gravity = ["0 m/s^2", "0 m/s^2", "0 m/s^2"]\n' + MASS.lstrip())
    varied = 'variables.gravity = { address = "gravity.z", from = "-100 m/s^2", to = "0 m/s^2", levels = 3 }'
    study = upright(tmp_path, 'responses.f = "frequency.platform.1"', varied)
    assert np.isfinite(piece(study, 0, 3).responses[:, 0]).tolist() == [False, False, True]
    assert "smallest load factor 0.388 (gravity -100 m/s^2)" in loaded_findings(study)[0].what


@pytest.mark.parametrize(("most", "words"), [(0.05, ""), (0.3, "measures over a path"), (1.0, "Add to [limits]")])
def test_a_study_warns_from_one_per_cent_of_stiffness(tmp_path: Path, most: float, words: str):
    """The load factor is about 9.9 kg over the mass."""
    mass = f'variables.mass = {{ address = "bodies.platform.mass", from = "1 g", to = "{most} kg", levels = 2 }}'
    study = upright(tmp_path, 'responses.k = "stiffness.x"', mass)
    assert words in " ".join(str(each) for each in loaded_findings(study))
    assert bool(loaded_findings(study)) == bool(words)


def test_a_study_warns_of_the_corner_of_its_ranges_with_the_least_load_factor(tmp_path: Path):
    """A heavier platform on softer leaves: less than any single end, named with both values."""
    mass = 'variables.mass = { address = "bodies.platform.mass", from = "1 kg", to = "4 kg", levels = 2 }\n'
    young = 'variables.young = { address = "materials.steel.young", from = "150 GPa", to = "250 GPa", levels = 2 }'
    study = upright(tmp_path, 'responses.k = "stiffness.x"', mass + young)
    (finding,) = loaded_findings(study)
    corner = load_factors(apply(study.design, study.variables, np.array([4.0, 150e9])))
    assert corner is not None
    assert f"smallest load factor {float(corner.worst):.3g} (mass 4 kg, young 150 GPa)" in finding.what


def test_variables_reach_the_numbers_they_name():
    study = loads_study(STUDY)
    changed = apply(study.design, study.variables, np.array([1.05, 0.9e-3]))
    assert get(changed, "materials.aluminium.young") == pytest.approx(1.05 * get(study.design, "materials.aluminium.young"), rel=1e-15)
    assert get(changed, "parts.leaf.thickness") == 0.9e-3


def test_designs_that_fail_keep_their_place_and_reason():
    study = loads_study(STUDY)
    leaf = replace(study.variables[1], low=-0.4e-3)  # thickness below nought in a quarter of the range
    found = piece(replace(study, variables=(study.variables[0], leaf)), 0, 12)
    negative = np.flatnonzero(found.variables[:, 1] <= 0.0)
    assert 0 < len(negative) < 12
    assert sorted(found.failures) == negative.tolist()
    assert all("thickness" in reason for reason in found.failures.values())
    assert np.all(np.isnan(found.responses[negative]))
    assert np.all(np.isfinite(np.delete(found.responses, negative, axis=0)))


def test_a_design_without_one_of_its_values_has_no_value(monkeypatch):
    """A failed design violates every limit, also those on measures that are finite."""
    study = loads_study(STUDY.replace("frequency.1", "mass"))
    monkeypatch.setattr(Study, "evaluate", lambda *_: (np.array([1.0, 2.0]), np.array([np.inf, 3.0])))
    found = piece(study, 0, 2)
    assert found.failures == {0: "stiffness.x: no finite value"}
    np.testing.assert_array_equal(found.responses, [[np.nan, np.nan], [2.0, 3.0]])


@pytest.mark.parametrize(
    "key",
    [
        *("stroke.x", "corner", "safety", "buckling", "stiffness.rz", "stiffness.(1,2,3)", "stiffness.least", "deflection.z", "force.z"),
        *("loss", "loss.B4", "crosstalk", "drift.z", "mass", "mass.total", "load"),
    ],
)
def test_measures_are_analytic(key):
    """A step of 1e-20 in the imaginary direction is the derivative that central differences find, extrapolated (Richardson).

    Elimination of n freedoms rounds by about sqrt(n) eps times the condition of the equilibrated stiffness (Higham & Mary 2019): of a
    measure, or of 1 where it is a share, what is left of 1. A difference divides that by its step; what extrapolation left is far below
    what it took. The plate grows sideways, where nothing touches it: upwards it would grow into what stands on it, and weigh that less.
    """
    stage, step = double_triangle(), 1e-3
    names = ("parts.neck.thickness", "bodies.platform.solids.plate.size.x", "parts.lever_notch.thickness")
    asked = (measure(stage, key, "here"),)
    slopes = np.imag(measure_all(replace(step_parameters(stage, names), requirements=stage.requirements), asked)[0]) / 1e-20
    for slope, name in zip(np.broadcast_to(slopes, 3), names, strict=True):
        value = get(stage, name)
        values = measure_all(set_value(stage, name, value * (1.0 + step * np.array([-1.0, -0.5, 0.5, 1.0]))), asked)[0] * np.ones(4)
        coarse, fine = (values[3] - values[0]) / (2.0 * step), (values[2] - values[1]) / step
        found = (4.0 * fine - coarse) / 3.0
        size = 1.0 if key.partition(".")[0] in {"loss", "crosstalk", "load"} else abs(values[1])
        assert slope * value == pytest.approx(found, rel=0.0, abs=_rounding(stage) * size / step + 0.01 * abs(found - fine)), name


def _rounding(stage: Mechanism) -> float:
    stiffness = lumped(stage).stiffness_matrix
    scale = np.sqrt(np.diag(stiffness))
    return float(np.sqrt(len(scale)) * np.linalg.cond(stiffness / np.outer(scale, scale)) * np.finfo(float).eps)


def test_what_fails_along_a_path_is_taken_apart_at_once():
    sizes: list[int] = []

    def batch(part: np.ndarray) -> np.ndarray | str:
        sizes.append(len(part))
        return "it has no equilibrium" if np.any(part < 0.0) else 2.0 * part

    found, failures = _bisect(np.array([[1.0], [-1.0], [2.0], [3.0]]), 1, batch, apart=True)
    assert found == pytest.approx(np.array([[2.0], [np.nan], [4.0], [6.0]]), nan_ok=True)
    assert failures == {1: "it has no equilibrium"}
    assert sizes == [4, 1, 1, 1, 1]
