"""Laws of load cases and stroke ends: what the stage bears at a place is where its stiffness there vanishes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import flexstage as fs
from flexstage.analysis.assessment.judge import judge
from flexstage.analysis.complete import analyse
from flexstage.analysis.loaded.load_cases import REST, LoadCase, buckling_factors, case_critical, load_cases
from flexstage.base.finding import LowerBoundError
from flexstage.models.nonlinear.paths.critical_load import STATED, WEIGHT
from flexstage.models.nonlinear.stage import Nonlinear
from flexstage.show.tables.overview import closing_text

STAGE = fs.case("long-travel-xy")
AWAY = LoadCase(WEIGHT, "away", {WEIGHT: 1.0}, at={"platform.x": 5e-3})


@pytest.fixture(scope="module")
def model() -> Nonlinear:
    return fs.nonlinear(STAGE)


def test_where_the_free_stage_gives_way_its_stiffness_against_the_drive_vanishes(model: Nonlinear) -> None:
    """The load's share of a place's stiffness: 2e-3 less than the factor some is left, 2e-3 more and the stage pushes on."""
    factor = case_critical(model, AWAY, tolerance=1e-6).factor
    place = fs.equilibrium(model).displacement()[0] + 5e-3

    def slope(share: float) -> float:
        held = fs.equilibrium(model, hold={"platform.x": place + np.array([-1e-5, 1e-5])}, weight=share * factor)
        return float(np.diff(held.reactions[:, 0])[0])

    assert slope(1.0 - 2e-3) > 0.0 > slope(1.0 + 2e-3)


@pytest.mark.full
def test_a_locked_drive_bears_more_than_a_free_one_and_none_at_rest_is_as_asked_alone(model: Nonlinear) -> None:
    """A constraint more never takes stability; the case at rest is that of the weight alone, an imperfect bifurcation."""
    free, locked = (case_critical(model, each).factor for each in (AWAY, replace(AWAY, locked=("platform.x",))))
    with pytest.raises(LowerBoundError, match="imperfect bifurcation, where motion per unit of load becomes") as rest:
        case_critical(model, LoadCase(WEIGHT, REST, {WEIGHT: 1.0}))
    assert locked > 2.0 * free
    assert rest.value.bound == pytest.approx(2.6, rel=0.01)


def test_less_than_the_load_that_it_has_is_a_factor_below_one(model: Nonlinear) -> None:
    """A load twice the critical one has the factor one half; a stage that it has pressed down bears nothing besides."""
    away = LoadCase("pressed", "away", {"platform.fz": -9.80665}, at={"platform.x": 5e-3})
    borne = case_critical(model, away, tolerance=1e-6).factor
    pressed = replace(away, grows={"platform.fz": -9.80665 * 2.0 * borne})
    assert case_critical(model, pressed, tolerance=1e-6).factor == pytest.approx(0.5, rel=1e-3)
    with pytest.raises(fs.DesignError, match=r"not stable, or has no equilibrium|no equilibrium found"):
        case_critical(model, replace(pressed, grows={"platform.fx": 1.0}, stays=pressed.grows))


def test_stated_forces_grow_as_the_same_wrench(model: Nonlinear) -> None:
    """All stated forces, scaled, are the wrench that they are, scaled."""
    pushed = replace(STAGE, forces={"push": fs.Force("platform", (0.0, 0.0, 0.0), (0.0, 0.0, -5.0))}, paths={})
    own = case_critical(fs.nonlinear(pushed), LoadCase(STATED, "away", {STATED: 1.0}, at={"platform.x": 5e-3}), tolerance=1e-6)
    wrench = case_critical(model, LoadCase("push", "away", {"platform.fz": -5.0}, at={"platform.x": 5e-3}), tolerance=1e-6)
    assert own.factor == pytest.approx(wrench.factor, rel=1e-5)
    assert own.kind == wrench.kind
    assert [(each.load, each.place) for each in load_cases(pushed)][:2] == [(WEIGHT, REST), (STATED, REST)]


OUT = replace(STAGE, paths={"out": fs.StrokePath("platform.x", ("0 mm", "5 mm"), hold={"platform.z": "-2 N"})})
PUSH = "platform.fz = -2 N"


def test_every_end_of_a_path_is_a_case_with_what_the_path_holds() -> None:
    """The weight at rest without it; at both ends the weight beside it, and what it holds beside the weight."""
    cases = {(each.load, each.place): each for each in load_cases(OUT)}
    ends = ("platform.x = 0 mm", "platform.x = 5 mm")
    assert set(cases) == {(WEIGHT, REST), *((PUSH, end) for end in ends), *((WEIGHT, end) for end in ends)}
    assert cases[WEIGHT, ends[1]].stays == {"platform.fz": -2.0}
    assert cases[PUSH, ends[1]].shares == (1.0, 1.0)


def test_a_requirement_asks_for_what_a_path_bears() -> None:
    """The weight beside what the path holds; that it bears less than what is asked for is told with the bound."""
    (verdict,) = judge(replace(OUT, requirements={"out.buckling at 0 mm": "at least 3"}))
    assert verdict.value is None
    assert "stable up to 2.4" in verdict.reason


@pytest.mark.full
def test_a_requirement_that_a_path_meets_is_met_and_what_is_demanded_beyond_is_warned_of() -> None:
    """The same end, asked for less than it bears, and for more than it does; of a column always, below."""
    (met,) = judge(replace(OUT, requirements={"out.buckling at 0 mm": "at least 2"}))
    assert met.passed
    told = buckling_factors(OUT, [load_cases(OUT)[1]], most=3.0, demand=3.0).warnings
    assert [each.where for each in told] == ["platform.x = 0 mm"]
    assert "stable up to 2.4" in told[0].what


@pytest.mark.full
def test_the_verdict_of_an_analysis_warns_of_ends_that_bear_too_little() -> None:
    """The least of them is told beside the requirements, at the end that it has."""
    found = analyse(replace(OUT, requirements={"buckling.factor": "at least 3"}))
    assert found.ends is not None
    assert found.ends.demand == 3.0
    assert found.ends.least is not None
    said = found.ends.warnings[0]
    assert said.where == found.ends.least.place
    assert f"warning: {said.where}: {said.what}" in closing_text(found, whole=True)


def test_what_hangs_bears_any_weight() -> None:
    """Nothing gives way: the factor is infinite, requirements on it are met, and nothing is warned of."""
    hangs = replace(STAGE, gravity=(0.0, 0.0, -1e-9), paths={}, requirements={"buckling.factor": "at least 3"})
    assert np.isinf(buckling_factors(hangs, load_cases(hangs)[:1], most=100.0).cases[0].factor)
    assert not buckling_factors(hangs, load_cases(hangs)[:1], most=100.0).warnings


@pytest.mark.parametrize("gravity", ["on", "off"])
def test_a_path_without_gravity_bears_its_load_without_the_weight(gravity: str) -> None:
    """A clamped column with a heavy top bears load and weight up to P = pi^2 E I / 4 L^2; a path with gravity off has no weight."""
    euler, weight = np.pi**2 * 200e9 * np.pi * 2e-3**4 / 64.0 / (4.0 * 0.2**2), 5.0
    column = fs.Mechanism(
        "column",
        {"steel": fs.Material(young=200e9, poisson=0.3, density=0.0)},
        parts={"rod": fs.Rod("steel", 0.2, 2e-3)},
        bodies={
            "platform": fs.Body(mass=weight / 9.80665, inertia=fs.Inertia(1e-4, 1e-4, 1e-4), centre=(0, 0, 0.2), reference=(0, 0, 0.2))
        },
        links={"rod": fs.Link(("ground", "platform"), "rod", (0.0, 0.0, 0.1), (0.0, 0.0, 1.0), bends=(1.0, 0.0, 0.0))},
        gravity=(0.0, 0.0, -9.80665),
        paths={"out": fs.StrokePath("platform.x", ("0 mm", "1 mm"), hold={"platform.z": "-1 N", "gravity": gravity})},
    )
    loaded = next(each for each in load_cases(column) if each.load == "platform.fz = -1 N")
    (found,) = buckling_factors(column, [loaded]).cases
    assert found.place == "platform.x = 0 mm"
    assert found.factor == pytest.approx(euler - (weight if gravity == "on" else 0.0), rel=2e-3)


def test_a_preload_is_a_load_that_grows() -> None:
    """A cantilever pressed by a spring whose force turns by half the tip's angle buckles at P = pi^2 E I / L^2, whatever its preload."""
    rod, soft = fs.Rod("steel", 0.2, 2e-3), fs.Spring(stiffness=1e-3, preload=0.5)
    column = fs.Mechanism(
        "column",
        {"steel": fs.Material(young=200e9, poisson=0.3, density=0.0)},
        parts={"rod": rod, "spring": soft},
        bodies={"platform": fs.Body(reference=(0.2, 0.0, 0.0))},
        links={
            "rod": fs.Link(("ground", "platform"), "rod", (0.1, 0.0, 0.0), (1.0, 0.0, 0.0), bends=(0.0, 0.0, 1.0)),
            "spring": fs.Link(("platform", "ground"), "spring", (0.2, 0.0, 0.0), (1.0, 0.0, 0.0), bends=(0.0, 0.0, 1.0)),
        },
        gravity=(0.0, 0.0, 0.0),
    )
    (found,) = buckling_factors(column).cases
    assert (found.load, found.place, found.kind) == (STATED, REST, "bifurcation")
    assert 0.5 * found.factor == pytest.approx(np.pi**2 * 200e9 * np.pi * 2e-3**4 / 64.0 / 0.2**2, rel=1e-3)
    (told,) = buckling_factors(column, demand=80.0).warnings
    assert told.where == REST
