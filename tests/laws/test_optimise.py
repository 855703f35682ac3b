"""Laws of optimisation: exact derivatives, optima known in closed form, modes that cross, prices, contradictions, rounding, fronts."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pytest

from flexstage.analysis.assessment.judge import measure_all
from flexstage.analysis.assessment.measures import Extreme
from flexstage.analysis.assessment.requirements import Sense, measure
from flexstage.base.number import Table
from flexstage.base.storage.document import plain
from flexstage.cases.registry import CASES, case
from flexstage.mechanism.addresses.address import addresses, get, set_values
from flexstage.mechanism.checks import check
from flexstage.show.display import format_value
from flexstage.studies.optimisation.result import Binding
from flexstage.studies.optimisation.search.front import pareto_front
from flexstage.studies.optimisation.search.optimum import optimise
from flexstage.studies.optimisation.search.problem import Problem, Side
from flexstage.studies.optimisation.search.quadratic import quadratic
from flexstage.studies.optimisation.search.search import Trace, run_searches, search
from flexstage.studies.optimisation.setting import setting
from flexstage.studies.optimisation.show.report import _headline
from flexstage.studies.optimisation.show.tables import _notes, optimise_tables
from flexstage.studies.optimisation.values import Point, Scalars, Values
from tests.conftest import FULL
from tests.laws.optima import BLADES, POST, TRIPOD, case_of, post_variables, study_of

DEMANDS = ("stroke.z", "safety", "frequency.platform.1", "frequency.platform.6", "frequency.7", "envelope.x", "mass", "loss.B4")
MORE = ("corner", "buckling", "stiffness.rz", "force.z", "crosstalk", "drift.z", "resolution.x", "gauge.range", "load", "load.B1")
MIXED = """
[variables]
foot = { address = "parts.foot_notch.thickness", from = "0.6 mm", to = "1.2 mm", logarithmic = true }
arm = { parameter = "short_arm", from = "24 mm", to = "29 mm" }
poles = { address = "placements.B4-B6.pattern.radius", from = "-4 %", to = "6 %" }
[responses]
f1 = "frequency.platform.1"
[optimise]
maximise = "f1"
"""


def worst_error(values, shares, step):
    """Largest error of the gradient against central differences, relative to the measure or the largest slope, by measure."""
    exact = values(shares[None])[0]
    size = len(shares)
    moves = step * np.vstack([np.eye(size), -np.eye(size)])
    around = np.array([point.values for point in values.evaluate(shares + moves)])
    differences = (around[:size] - around[size:]).T / (2.0 * step)
    scale = np.maximum(np.max(np.abs(differences), axis=1), np.abs(exact.values))
    return np.max(np.abs(exact.gradient - differences), axis=1) / scale


def test_gradients_agree_with_differences():
    study, _ = case_of("double-triangle", MIXED)
    keys = (*DEMANDS, *MORE) if FULL else DEMANDS
    values = Values(study, tuple(measure(study.design, key, "here") for key in keys))
    assert np.all(worst_error(values, np.array([0.37, 0.61, 0.45]), 1e-4) < 1e-6)


def test_differenced_measures_have_gradients_too():
    """A parallelogram shortens by s^2 / (2 L): the slope of its map's error over the leaves' length is known."""
    text = 'variables.leaf = { address = "parts.leaf.length", from = "20 mm", to = "30 mm" }\nresponses.e = "map_error.y"'
    study, _ = case_of("parallelogram", text + '\n[optimise]\nminimise = "e"')
    point = Values(study, (study.responses["e"],))(np.array([[0.4]]))[0]
    np.testing.assert_allclose(point.gradient[0, 0], -point.values[0] * 10.0 / 24.0, rtol=1e-5)


def test_values_are_those_of_the_judge():
    study, _ = case_of("double-triangle", MIXED)
    measures = tuple(measure(study.design, key, "here") for key in DEMANDS)
    shares = np.array([0.2, 0.7, 0.9])
    point = Values(study, measures)(shares[None])[0]
    design = study.mechanism_for(np.array([each.at(share) for each, share in zip(study.variables, shares, strict=True)]))
    np.testing.assert_allclose(point.values, np.array(measure_all(design, measures), dtype=float), rtol=1e-9)
    twice = Values(study, (*measures[:2], measures[0]))(shares[None])[0]  # an objective that is a limit, too
    assert twice.values.tolist() == [*point.values[:2], point.values[0]]
    assert twice.gradient.tolist() == point.gradient[[0, 1, 0]].tolist()


@pytest.mark.parametrize("name", CASES if FULL else ("double-triangle", "bridge", "voice-coil-xy"))
def test_errors_of_a_design_are_those_of_its_complex_step(name):
    stage, rng = case(name), np.random.default_rng(3)
    numbers = {each: get(stage, each) for each in addresses(stage)}
    varied = [each for each, value in numbers.items() if isinstance(value, float) and value]
    for address in rng.choice(varied, 12, replace=False).tolist():
        for factor in (0.7, -1.0, 30.0):
            value = np.full(2, factor * numbers[address])
            real, stepped = (
                check(replace(set_values(stage, [(address, each)]), formulas=Table({}))) for each in (value, value + 1e-30j * np.eye(2)[0])
            )
            assert [each.where for each in stepped] == [each.where for each in real], (address, factor)


@pytest.mark.parametrize("seed", range(20 if FULL else 5))
def test_quadratic_programs_meet_their_optimality_conditions(seed):
    generator = np.random.default_rng(seed)
    size, count = generator.integers(1, 8), generator.integers(1, 25)
    half = generator.normal(size=(size, size))
    hessian, linear = half @ half.T + 0.1 * np.eye(size), generator.normal(size=size)
    normals = generator.normal(size=(count, size))
    normals = np.vstack([normals, normals[:3]])  # some twice: dependent constraints
    bounds = normals @ generator.normal(size=size) + np.tile(generator.random(1), len(normals))
    bounds[count:] = bounds[: len(normals) - count]
    found = quadratic(hessian, linear, normals, bounds)
    slack = bounds - normals @ found.at
    assert np.all(slack > -1e-9)
    assert np.all(found.multipliers >= 0.0)
    np.testing.assert_allclose(hessian @ found.at + linear + normals.T @ found.multipliers, 0.0, atol=1e-8)
    np.testing.assert_allclose(found.multipliers * slack, 0.0, atol=1e-8)


def test_matrices_of_slopes_foretell_modes_that_meet(tmp_path):
    """Near equal blades the two sway modes turn as they please: the matrix says what each will be, each mode's own slope does not."""
    study, _ = study_of(tmp_path, TRIPOD, BLADES + '[optimise]\nmaximise = "f1"')
    values = Values(study, (study.responses["f1"],))
    way = np.array([0.8, -0.5, 0.3])
    errors = []
    for size in (1e-3, 5e-4):
        start = np.full(3, 0.6) + np.array([0.0, 0.2 * size, 0.0])
        here, there = values(start[None])[0].found[0], values((start + size * way)[None])[0].found[0]
        foretold = np.linalg.eigvalsh(np.diag(here.spectrum.frequencies) + np.tensordot(size * way, here.spectrum.slopes, axes=1))
        errors.append(np.max(np.abs(foretold - there.spectrum.frequencies)[:2]))
        alone = here.spectrum.frequencies + size * way @ np.diagonal(here.spectrum.slopes, axis1=1, axis2=2)
        assert np.max(np.abs(alone - there.spectrum.frequencies)[:2]) > 10.0 * errors[-1]
    assert 3.0 < errors[0] / errors[1] < 5.0  # of second order


def test_modes_that_cross_are_equal_at_the_optimum(tmp_path):
    """A post of given area is stiffest both ways where it is square: the two bending modes cross there, whichever was the lower one."""
    study, wanted = study_of(
        tmp_path, POST, post_variables() + '[limits]\n"stiffness.z" = "at most 100 N/um"\n[optimise]\nmaximise = "f1"\nstarts = 4'
    )
    found = optimise(study, wanted)
    side = np.sqrt(100e6 * 0.03 / 200e9)
    sizes = [float(each.at(share)) for each, share in zip(study.variables, found.point.shares, strict=True)]
    np.testing.assert_allclose(sizes, side, rtol=1e-6)
    assert found.agreeing == 4
    lowest = found.point.found[0].spectrum.frequencies[:2]
    assert lowest[1] / lowest[0] - 1.0 < 1e-6
    ratios = [start.begun[0] - start.ended[0] for start in found.starts]
    assert min(ratios) < 0.0 < max(ratios)  # from both sides of the crossing


def test_modes_that_turn_into_each_other_are_no_obstacle(tmp_path):
    """Three blades of given yaw stiffness carry the lowest sway best where they are equal: there the modes repeat, and have no gradient."""
    study, wanted = study_of(
        tmp_path, TRIPOD, BLADES + '[limits]\n"stiffness.rz" = "at most 1e5 N m/rad"\n[optimise]\nmaximise = "f1"\nstarts = 3'
    )
    found = optimise(study, wanted)
    np.testing.assert_allclose(found.point.shares, found.point.shares[0], atol=1e-4)
    assert found.agreeing == 3
    assert all(start.evaluated < 25 for start in found.starts)
    spectrum = found.point.found[0].spectrum
    assert spectrum.frequencies[1] / spectrum.frequencies[0] - 1.0 < 1e-4
    own = spectrum.slopes[:, :2, :2]  # stationary: a matrix of trace 1 weighs the slopes into the limit's own gradient
    limit = found.point.found[1].gradient[0]
    mean = 0.5 * np.trace(own, axis1=1, axis2=2)
    np.testing.assert_allclose(mean / mean[0], limit / limit[0], rtol=1e-3)


def test_curved_limits_are_followed():
    """Along the edge of a disc a search comes to the end in a few steps, not in many short ones."""
    trace = Trace()
    problem = Problem((Side(0, Sense.AT_MOST, 0.0, 1.0),), (Side(1, Sense.AT_MOST, 1.0, 1.0),))
    run_searches([search(problem, np.array([0.95, 0.2]), trace)], lambda shares: [_on_a_circle(share) for share in shares])
    np.testing.assert_allclose(trace.point.shares, [np.sqrt(0.5), np.sqrt(0.5)], atol=1e-4)
    assert trace.converged
    assert trace.evaluated < 25


def _on_a_circle(share):
    """The sum of two numbers, to be made large, on the unit disc: its edge is curved all the way."""
    objective = Scalars(np.array([-np.sum(share)]), -np.ones((1, 2)), Extreme.LEAST)
    return Point(share, (objective, Scalars(np.array([share @ share]), 2.0 * share[None], Extreme.LEAST)))


def test_prices_are_what_moved_limits_bring():
    """Optimised anew with limits and ends of ranges moved by a little, the objective moves by the price."""
    text = """
[variables]
leaf = {{ address = "parts.leaf.thickness", from = "0.6 mm", to = "2 mm" }}
length = {{ address = "parts.leaf.length", from = "{end} mm", to = "26 mm" }}
[responses]
f1 = "frequency.platform.1"
[limits]
"stroke.x" = "at least {stroke} um"
[optimise]
maximise = "f1"
starts = 1
"""

    def best(end=20.0, stroke=18.0):
        return optimise(*case_of("parallelogram", text.format(end=end, stroke=stroke)))

    found = best()
    prices = {each.name: each.price for each in found.binding}
    moved = {"stroke.x at least 18.0 um": (best(stroke=18.05), best(stroke=17.95), 0.1e-6)}
    assert prices
    for name, price in prices.items():
        upper, lower, apart = moved.get(name) or (best(end=20.05), best(end=19.95), 0.1e-3)
        assert (upper.value(upper.point) - lower.value(lower.point)) / apart == pytest.approx(price, rel=2e-3)


def test_the_price_of_a_limit_above_is_what_more_of_it_buys():
    text = """
[variables]
leaf = {{ address = "parts.leaf.thickness", from = "0.6 mm", to = "2 mm" }}
[responses]
k = "stiffness.x"
[limits]
"frequency.platform.1" = "at most {most} Hz"
[optimise]
maximise = "k"
starts = 1
"""
    middle, upper, lower = (optimise(*case_of("parallelogram", text.format(most=most))) for most in (1000.0, 1002.0, 998.0))
    (limit,) = middle.binding
    assert limit.price > 0.0
    assert (upper.value(upper.point) - lower.value(lower.point)) / 4.0 == pytest.approx(limit.price, rel=2e-3)


@pytest.mark.parametrize("scale", ["", ", logarithmic = true"])
@pytest.mark.parametrize(("way", "end"), [("maximise", 8e-3), ("minimise", 1e-3)])
def test_the_price_of_the_end_of_a_range_is_the_slope_at_the_end(tmp_path, scale, way, end):
    """The stiffness E w t / L of a post is proportional to its thickness: one metre more of thickness has the price k / t."""
    text = f"""
[variables]
t = {{ address = "parts.post.thickness", from = "1 mm", to = "8 mm"{scale} }}
[responses]
k = "stiffness.z"
[optimise]
{way} = "k"
starts = 1
"""
    found = optimise(*study_of(tmp_path, POST, text))
    (limit,) = found.binding
    assert limit.limit == pytest.approx(end)
    assert limit.price == pytest.approx(found.value(found.point) / end, rel=1e-6)


def test_of_several_contradictions_as_many_are_found_as_are_asked_for(tmp_path):
    limits = '[limits]\n"stiffness.z" = "at most 50 N/um"\n"frequency.platform.1" = "at least 40 Hz"\nheight = "at most 1 mm"\n'
    study, wanted = study_of(tmp_path, POST, post_variables() + limits + '[optimise]\nmaximise = "f1"\nstarts = 2')
    every = optimise(study, wanted).contradictions
    assert len(every) > 1
    (first,) = optimise(study, wanted, contradictory=1).contradictions
    assert (first.limits, first.violation) == (every[0].limits, every[0].violation)
    (one,) = optimise(replace(study, limits=first.limits), wanted).contradictions
    assert one.overall == pytest.approx(first.violation, rel=1e-3)
    assert first.overall >= max(each.violation for each in every) * (1.0 - 1e-3)


def test_relaxed_by_the_least_violation_all_limits_are_met(tmp_path):
    """The overall violation is the smallest factor for all limits: with a little more a design meets them, with a little less none."""
    texts = {"stiffness.z": (50.0, "N/um"), "frequency.platform.1": (40.0, "Hz"), "height": (1.0, "mm")}

    def best(relaxed: float):
        signs = {"stiffness.z": 1.0, "frequency.platform.1": -1.0, "height": 1.0}
        lines = [
            f'"{key}" = "at {"most" if signs[key] > 0.0 else "least"} {value * (1.0 + signs[key] * relaxed):.9g} {unit}"'
            for key, (value, unit) in texts.items()
        ]
        text = post_variables() + "[limits]\n" + "\n".join(lines) + '\n[optimise]\nmaximise = "f1"\nstarts = 2'
        return optimise(*study_of(tmp_path, POST, text))

    overall = best(0.0).contradictions[0].overall
    assert best(1.001 * overall).point is not None
    assert best(0.99 * overall).point is None


def test_contradicting_limits_are_named_and_nothing_else(tmp_path):
    limits = '[limits]\n"stiffness.z" = "at most 50 N/um"\n"frequency.platform.1" = "at least 40 Hz"\nheight = "at most 200 mm"\n'
    study, wanted = study_of(tmp_path, POST, post_variables() + limits + '[optimise]\nmaximise = "f1"\nstarts = 2')
    found = optimise(study, wanted)
    assert found.point is None
    assert [{each.key for each in one.limits} for one in found.contradictions] == [{"stiffness.z", "frequency.platform.1"}]
    problem = setting(study, wanted).problem
    grid = np.array(list(itertools.product(np.linspace(0.0, 1.0, 13), repeat=2)))
    least = min(problem.excess(point) for point in setting(study, wanted).values.evaluate(grid))
    assert 0.0 < found.contradictions[0].violation <= least
    for left_out in ("stiffness.z", "frequency.platform.1"):
        rest = tuple(each for each in study.limits if each.key != left_out)
        assert optimise(replace(study, limits=rest), wanted).point is not None


def test_rounded_designs_are_on_their_steps_and_the_best_around(tmp_path):
    limits = '[limits]\n"stiffness.z" = "at most 100 N/um"\n'
    study, wanted = study_of(tmp_path, POST, post_variables(', step = "0.25 mm"') + limits + '[optimise]\nmaximise = "f1"\nstarts = 1')
    found = optimise(study, wanted)
    counts = found.rounded.values / 0.25e-3
    np.testing.assert_allclose(counts, np.round(counts), atol=1e-9)
    assert found.rounded.loss == pytest.approx(found.value(found.point) - found.value(found.rounded.point))
    assert found.rounded.loss > 0.0
    assert f"{format_value(found.value(found.rounded.point), 'Hz')} in the final design" in _headline(found).text
    values = setting(study, wanted)
    logs = [np.log(0.25e-3 * count / 1e-3) / np.log(8.0) for count in range(4, 33)]
    shares = np.array([((0.25 * count - 1.0) / 7.0, log) for count in range(4, 33) for log in logs])
    kept = [point for point in values.values.evaluate(shares) if isinstance(point, Point) and values.problem.excess(point) <= 1e-8]
    assert found.value(found.rounded.point) == pytest.approx(max(point.values[0] for point in kept), rel=1e-9)
    told = plain(found)
    values, objective = (told["rounded"][key] for key in ("variables", "objectives"))
    mechanism = study.mechanism_for(np.array([values[each.name] for each in study.variables]))
    measured_again = [float(each) for each in measure_all(mechanism, (*(each.measure for each in wanted.objectives), *found.limits))]
    assert [*objective.values(), *(each["value"] for each in told["rounded"]["limits"])] == pytest.approx(measured_again, rel=1e-6)
    assert all(each["passed"] and each["margin"] >= 0.0 for each in told["rounded"]["limits"])


def test_steps_that_leave_no_design_are_said_to(tmp_path):
    limits = '[limits]\n"stiffness.z" = "at most 100 N/um"\n"frequency.platform.1" = "at least 39.6 Hz"\n'
    study, wanted = study_of(tmp_path, POST, post_variables(', step = "0.5 mm"') + limits + '[optimise]\nmaximise = "f1"\nstarts = 1')
    found = optimise(study, wanted)
    assert found.rounded.point is None
    assert "none of the 4 nearest designs at multiples of the steps is feasible; use finer steps" in found.rounded.reason
    assert found.final is found.point


def test_a_range_without_a_multiple_of_the_step_leaves_no_rounded_design(tmp_path):
    """Between 1 mm and 1.7 mm is no multiple of 0.9 mm."""
    text = post_variables(', step = "0.9 mm"').replace('"8 mm"', '"1.7 mm"') + '[optimise]\nmaximise = "f1"\nstarts = 1'
    study, wanted = study_of(tmp_path, POST.replace('"5 mm"', '"1.5 mm"').replace('"2 mm"', '"1.5 mm"'), text)
    found = optimise(study, wanted)
    assert found.rounded.point is None
    assert found.on_steps is None


def test_one_per_cent_of_a_limit_of_zero_brings_no_gain():
    """A range that begins at 0 mm: 1 % of its end is nothing, not 10 mm."""
    assert Binding("at", 0.0, "m", 100.0, of_range=True, objective_unit="Hz").gain == 0.0
    assert Binding("at", -0.02, "m", 100.0, of_range=True, objective_unit="Hz").gain == pytest.approx(0.02)


def test_the_margin_to_a_limit_of_zero_is_a_length(tmp_path):
    """30 mm above at least 0 mm are 30 mm, not 3 %."""
    text = post_variables() + '[limits]\n"envelope.x" = "at least 0 mm"\n[optimise]\nmaximise = "f1"\nstarts = 1'
    found = optimise(*study_of(tmp_path, POST, text))
    (row,) = optimise_tables(found)[2].texts()[1:]
    assert row[4] == "50 mm"


def test_variables_without_effect_at_the_nominal_design_may_have_one_elsewhere(tmp_path):
    """A cube centred on its post: a small offset to either side does not change the lowest frequency, a larger one does."""
    text = post_variables().replace(
        "[responses]", 'aside = { address = "bodies.platform.solids.cube.at.y", from = "-9 mm", to = "9 mm" }\n[responses]'
    )
    study, wanted = study_of(tmp_path, POST, text + '[optimise]\nmaximise = "f1"\nstarts = 1')
    found = setting(study, wanted)
    assert found.idle == ("aside",)
    shares = np.array([found.before.shares, found.before.shares])
    shares[1, -1] = 1.0
    centred, aside = (point.values[0] for point in found.values.evaluate(shares))
    assert aside < 0.999 * centred
    assert "at the nominal design: aside" in _notes(interrupted=False, idle=found.idle)[0]


def test_fronts_are_undominated_and_end_at_the_single_optima(tmp_path):
    study, wanted = study_of(
        tmp_path, POST, post_variables() + '[optimise]\nmaximise = "f1"\nminimise = "k"\nstarts = 1\npareto_points = 5'
    )
    found = pareto_front(study, wanted)
    assert len(found.points) == 5
    frequency, stiffness = found.values.T
    assert np.all(np.diff(frequency) < 0.0)
    assert np.all(np.diff(stiffness) < 0.0)
    for point in found.points[:-1]:  # square all along: the closed form, whatever the level
        sizes = [float(each.at(share)) for each, share in zip(study.variables, point.shares, strict=True)]
        assert sizes[0] == pytest.approx(sizes[1], rel=1e-5)
    for number, end in enumerate((found.points[0], found.points[-1])):
        alone = optimise(study, replace(wanted, objectives=wanted.objectives[number : number + 1]))
        assert end.values[number] == pytest.approx(alone.value(alone.point), rel=1e-5)


def test_frequencies_may_be_bounded_above_and_mass_made_least(tmp_path):
    """The lightest load on the post's foundation that still keeps its frequencies between bounds: minimise, and `at most` on a mode."""
    limits = '[limits]\n"frequency.platform.1" = "at least 30 Hz"\n"frequency.platform.2" = "at most 31 Hz"\n'
    study, wanted = study_of(tmp_path, POST, post_variables() + limits + '[optimise]\nminimise = "k"\nstarts = 3')
    found = optimise(study, wanted)
    frequencies = found.point.found[1].spectrum.frequencies
    assert frequencies[0] == pytest.approx(30.0, rel=1e-6)
    assert frequencies[1] == pytest.approx(30.0, rel=1e-5)  # square again: least area for both bending modes
    assert [each.sense for each in found.limits] == [Sense.AT_LEAST, Sense.AT_MOST]


def test_the_same_seed_gives_the_same_optimum():
    study, wanted = case_of("parallelogram", 'variables.leaf = { address = "parts.leaf.thickness", from = "0.6 mm", to = "2 mm" }\n'
                            'responses.f1 = "frequency.platform.1"\noptimise = { maximise = "f1", seed = 5 }')  # fmt: skip
    first, second = optimise(study, wanted), optimise(study, wanted)
    np.testing.assert_array_equal(first.point.shares, second.point.shares)
    np.testing.assert_array_equal([start.begun for start in first.starts], [start.begun for start in second.starts])


def test_an_interrupt_leaves_the_best_design_so_far(tmp_path):
    study, wanted = study_of(
        tmp_path, POST, post_variables() + '[limits]\n"stiffness.z" = "at most 100 N/um"\n[optimise]\nmaximise = "f1"\nstarts = 2'
    )
    told = []

    def enough(text):
        told.append(text)
        if len(told) == 4:
            raise KeyboardInterrupt

    found = optimise(study, wanted, enough)
    assert found.interrupted
    assert not found.binding  # prices are those of an optimum
    assert found.point is not None
    assert found.value(found.point) >= found.value(found.before)
    assert found.value(found.point) <= found.value(optimise(study, wanted).point)


def test_variables_that_move_nothing_are_named(tmp_path):
    text = post_variables() + 'density = "mass"\n'
    text = text.replace("[responses]", 'yield = { address = "materials.steel.yield_stress", from = "-10 %", to = "10 %" }\n[responses]')
    study, wanted = study_of(tmp_path, POST, text + '[optimise]\nmaximise = "f1"\nstarts = 1')
    assert optimise(study, wanted).idle == ("yield",)


def test_designs_that_cannot_be_are_stepped_around():
    """A search whose evaluations fail beyond a wall ends at the wall's near side, not in an error."""

    def walled(shares):
        return [_parabola(share) if share[0] < 0.6 else "beyond the wall" for share in shares]

    def _parabola(share):
        value = np.array([(share[0] - 0.9) ** 2 + 1.0])
        return Point(share, (Scalars(value, np.array([[2.0 * (share[0] - 0.9)]]), Extreme.LEAST),))

    trace = Trace()
    run_searches([search(Problem((Side(0, Sense.AT_MOST, 0.0, 1.0),), ()), np.array([0.1]), trace)], walled)
    assert 0.59 < trace.point.shares[0] < 0.6
    assert not trace.converged
