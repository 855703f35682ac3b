"""Laws of tolerance studies: first order in the limit, moments of cubes, averaging, yields of linear responses, what is allowed."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
import scipy
from scipy.special import ndtr, ndtri

from flexstage.analysis.assessment.judge import bench_of
from flexstage.base.finding import DesignError
from flexstage.cases.double_triangle import double_triangle
from flexstage.mechanism.addresses.address import get, set_value
from flexstage.mechanism.assembly.expand import copies
from flexstage.spatial.frame import COMPONENTS
from flexstage.studies.sweeps.execution.evaluate import piece
from flexstage.studies.sweeps.execution.store import Results
from flexstage.studies.tolerances.allowance import allowance
from flexstage.studies.tolerances.crosstalk import command, pose_measures, poses
from flexstage.studies.tolerances.distribution import Distribution, Shape
from flexstage.studies.tolerances.file import loads_tolerance
from flexstage.studies.tolerances.run import Toleranced
from flexstage.studies.tolerances.show.figures import distributions_figure
from flexstage.studies.tolerances.show.tables import allowance_table, crosstalk_table
from flexstage.studies.tolerances.slopes import Slopes, slopes
from flexstage.studies.tolerances.summary import binomial, summary

LEAVES = 4
GUIDE = """
format = "flexstage 1"
name = "guide"
materials = { steel = { young = "200 GPa", poisson = 0.3, density = "7800 kg/m^3" } }
parts = { leaf = { kind = "leaf", material = "steel", length = "60 mm", thickness = "0.5 mm", width = "10 mm" } }
bodies = { platform = { mass = "1 kg", reference = ["0 mm", "0 mm", "0 mm"] } }
[links]
""" + "\n".join(
    f'l{n} = {{ joins = ["ground", "platform"], part = "leaf", at = ["{40 * n - 20 * (LEAVES - 1)} mm", "0 mm", "{30 * (-1) ** n} mm"],'
    ' along = "y", bends = "z" }'
    for n in range(LEAVES)
)


ASKED = """
format = "flexstage study 1"
design = "guide.toml"
responses.k = "stiffness.x"
tolerance = { crosstalk = false }
scatter.w = { address = "leaf.thickness", normal = "1 um" }
"""


def told(study, count=None):
    """Results of a study, computed here."""
    count = study.plan.designs if count is None else count
    found = piece(study, 0, count)
    return Results(np.arange(count), found.variables, found.responses, found.failures, ((), ()), ((), ()), count, {}, "")


@pytest.fixture(scope="module")
def guide(tmp_path_factory):
    folder = tmp_path_factory.mktemp("guide")
    (folder / "guide.toml").write_text(GUIDE)

    def study(text, copies=256, sampling="sobol", wishes=""):
        head = 'format = "flexstage study 1"\ndesign = "guide.toml"\nresponses.k = "stiffness.x"\n'
        section = f'tolerance = {{ copies = {copies}, sampling = "{sampling}", crosstalk = false {wishes} }}\n'
        return loads_tolerance(head + section + text, folder=folder)

    study.folder = folder
    return study


def test_a_response_that_does_not_vary_has_no_deviation_and_a_figure(guide):
    """Rounding errors are no distribution."""
    study = guide('scatter.young = { address = "materials.steel.young", normal = "2 %", within = "5 %" }\nresponses.m = "mass"')
    results, slope = told(study), slopes(study)
    found = Toleranced(study, results, slope, summary(study, results, slope), None)
    spread = found.summary.spread
    column = spread.names.index("m")
    assert spread.deviation[column] == 0.0
    assert np.isnan(spread.by_sample[:, column]).all()
    assert distributions_figure(found) is not None
    assert [each.text(0.05) for each in study.variables] == ["+5 %"]
    assert [each.nominal(study.design) for each in study.variables] == [0.0]


def test_stiffness_has_the_moments_of_a_cube(guide):
    """E[(1 + s)^3] = 1 + 3 v, Var = 9 v + 36 v^2 + 15 v^3 for normal s of variance v; shear of these leaves takes less than 1e-3."""
    study = guide('scatter.wire = { address = "hinges.thickness", normal = "8 %" }', copies=512)
    found = piece(study, 0, 512).responses[:, 0] / slopes(study).values[0]
    v = 0.08**2
    assert found.mean() == pytest.approx(1.0 + 3.0 * v, rel=2e-3)
    assert found.var() == pytest.approx(9.0 * v + 36.0 * v**2 + 15.0 * v**3, rel=0.02)


def test_single_errors_average_out_and_common_ones_do_not(guide):
    common = guide('scatter.wire = { address = "hinges.thickness", normal = "2 um" }')
    each = guide('scatter.wire = { address = "hinges.thickness", normal = "2 um", independent = true }')
    one, many = (slopes(study) for study in (common, each))
    sizes = [np.linalg.norm(found.gradient[0] * 2e-6) for found in (one, many)]
    assert len(each.variables) == LEAVES
    assert sizes[1] == pytest.approx(sizes[0] / np.sqrt(LEAVES), rel=1e-9)
    deviations = [piece(study, 0, 256).responses[:, 0].std() for study in (common, each)]
    assert deviations == pytest.approx(sizes, rel=0.05)


def test_common_and_single_errors_of_one_number_add_up(guide):
    both = guide('[scatter]\na = { address = "leaf.thickness", normal = "2 um" }\nb = { address = "links.l0.thickness", uniform = "5 um" }')
    values = np.array([1e-6, 3e-6])
    changed = both.mechanism_for(values)
    assert get(changed, "links.l0.thickness") == pytest.approx(0.504e-3, rel=1e-12)
    assert get(changed, "links.l1.thickness") == pytest.approx(0.501e-3, rel=1e-12)


def test_first_order_holds_for_small_scatter():
    study = loads_tolerance(
        """
format = "flexstage study 1"
case = "parallelogram"
responses = { k = "stiffness.rz", f = "frequency.2", m = "mass", s = "safety" }
tolerance = { copies = 256, requirements = false, crosstalk = false }
[scatter]
wire = { address = "hinges.thickness", normal = "0.2 um" }
hinge = { address = "hinges.thickness", uniform = "0.2 um", independent = true }
placements = { address = "units.shift", normal = "2 um" }
steel = { address = "materials", normal = "0.02 %" }
""".replace('"materials"', '["materials.young", "materials.steel.young"]')
    )
    slope = slopes(study)
    size = np.array([each.deviation for each in study.deviations])
    values = piece(study, 0, 256).responses
    linear = np.linalg.norm(slope.gradient * size, axis=1)
    moved = linear > 0.0
    assert moved.tolist() == [True, True, False, True]
    assert slope.smooth.all()
    assert values[:, moved].std(axis=0) == pytest.approx(linear[moved], rel=4.0 / np.sqrt(2 * 256))
    for column, variable in enumerate(study.deviations):
        step = np.zeros((2, len(size)))
        step[:, column] = variable.deviation * np.array([1.0, -1.0])
        there = np.stack([np.broadcast_to(found, 2) for found in study.evaluate(study.mechanism_for(step))], axis=-1)
        wanted = (there[0] - there[1]) / (2.0 * variable.deviation)
        np.testing.assert_allclose(slope.gradient[:, column], wanted, rtol=1e-4, atol=1e-4 * linear.max() / size[column])


def test_the_yield_of_a_linear_response_is_that_of_its_distribution():
    """Mass is proportional to density: the share below a limit is the normal distribution's."""
    text = """
format = "flexstage study 1"
case = "parallelogram"
limits.mass = "at most {} kg"
scatter.density = {{ address = "materials.aluminium.density", normal = "2 %" }}
tolerance = {{ copies = 2000, requirements = false, crosstalk = false }}
"""
    nominal = float(slopes(loads_tolerance(text.format(1.0))).values[0])
    study = loads_tolerance(text.format(nominal * 1.02))
    slope, results = slopes(study), told(study)
    found = summary(study, results, slope)
    wanted = float(ndtr(1.0))
    error = np.sqrt(wanted * (1.0 - wanted) / 2000)
    assert found.together.share == pytest.approx(wanted, abs=4.0 * error)
    assert found.together.low < wanted < found.together.high
    allowed = allowance(study, results, slope, found)
    assert allowed.together == pytest.approx(1.0 / ndtri(0.99), rel=1e-9)
    assert allowed.then.share == pytest.approx(0.99, abs=4.0 * np.sqrt(0.99 * 0.01 / 2000))
    shares = np.array([int(name) for name in Toleranced(study, results, slope, found, None).responses[0].percentiles]) / 100.0
    assert shares.tolist() == [0.01, 0.05, 0.5, 0.95, 0.99]
    assert found.spread.percentiles[:, 0] == pytest.approx(nominal * (1.0 + 0.02 * ndtri(shares)), abs=2e-3 * nominal)


@pytest.mark.parametrize("copies", [100, 1000])
def test_the_usual_crosstalk_of_normal_errors_is_that_of_nineteen_in_twenty_copies(copies):
    """Normal errors of deviation s: 95 % are within 1.96 s; the quantile's standard error is (p (1 - p) / n)^1/2 over the density there."""
    study = loads_tolerance(
        f"""
format = "flexstage study 1"
case = "double-triangle"
tolerance = {{ copies = {copies} }}
scatter.hole = {{ address = "parts.neck.thickness", normal = "1 um" }}
"""
    )
    own = [float(name.split(".")[1:2] == name.split(".")[2:3]) for name in study.columns]
    rng = np.random.default_rng(copies)
    errors = 1e-3 * rng.standard_normal((copies, len(own)))
    results = Results(np.arange(copies), np.zeros((copies, 1)), own + errors, {}, ((), ()), ((), ()), copies, {}, "")
    flat = np.zeros((len(own), 1))
    found = summary(study, results, Slopes(np.array(own), flat, np.ones(len(own), bool))).crosstalk
    assert [each.kind for each in found] == ["open", "held"]
    density = 2.0 * np.exp(-0.5 * ndtri(0.975) ** 2) / np.sqrt(2.0 * np.pi)
    error = np.sqrt(0.95 * 0.05 / copies) / density
    for each in found:
        scatter = each.usual / 1e-3 - ndtri(0.975)
        assert abs(np.mean(scatter)) < 4.0 * error / np.sqrt(scatter.size) + 0.01
        assert np.std(scatter) == pytest.approx(error, rel=0.5)
        assert np.all(each.worst >= each.usual)
        places = [[list(study.columns).index(f"{each.kind}.{row}.{column}") for column in each.coordinates] for row in COMPONENTS]
        mean_square = np.mean((errors - np.mean(errors, axis=0)) ** 2, axis=0)[np.array(places)]
        np.testing.assert_allclose(each.deviation**2, mean_square * copies / (copies - 1), rtol=1e-9)  # unbiased


def test_contributions_are_shares_of_the_variance(guide):
    """k ~ E t^3: deviations of 6 % of E and 1 % of t have variances 36 : 9, by derivatives and by copies that scatter in one alone."""
    study = guide(
        '[scatter]\nsteel = { address = "materials.steel.young", normal = "6 %" }\nwire = { address = "leaf.thickness", normal = "1 %" }',
        copies=512,
    )
    slope, results = slopes(study), told(study)
    found = summary(study, results, slope).spread
    assert found.by_slope[:, 0] == pytest.approx([0.8, 0.2], abs=1e-3)
    assert found.by_sample[:, 0] == pytest.approx([0.8, 0.2], abs=0.02)


@pytest.mark.parametrize(
    ("entry", "reach", "by_slope"),
    [('normal = "30 %", within = "90 %"', 1.0 - (1.0 - 0.3 * ndtri(0.9)) ** 3, False), ('uniform = "3 %"', 3.0 * 0.8 * 0.03, True)],
)
def test_the_reach_of_a_response_is_its_one_sided_quantile(guide, entry, reach, by_slope):
    """k ~ t^3 of nine copies in ten falls no further: from the sample where it is not linear in t, else by the deviations' distribution."""
    limit = 'limits."stiffness.x" = "at least 1 N/mm"\n'
    study = guide(f'{limit}scatter.wire = {{ address = "leaf.thickness", {entry} }}', copies=1024, wishes=', yield = "90 %"')
    slope, results = slopes(study), told(study)
    found = allowance(study, results, slope, summary(study, results, slope))
    assert found.by_slope.tolist() == [by_slope]
    assert found.reach[0] / slope.values[0] == pytest.approx(reach, rel=0.02)


def test_what_is_allowed_keeps_what_is_wanted(guide):
    study = guide(
        'limits."stiffness.x" = "at least 4.5 N/mm"\n[scatter]\n'
        'wire = { address = "leaf.thickness", normal = "4 um" }\n'
        'hinge = { address = "leaf.thickness", normal = "8 um", independent = true }',
        copies=600,
        sampling="monte carlo",
        wishes=', yield = "90 %"',
    )
    slope, results = slopes(study), told(study)
    found = allowance(study, results, slope, summary(study, results, slope))
    error = 4.0 * np.sqrt(0.9 * 0.1 / 600)
    size = np.array([each.deviation for each in study.deviations])
    for factors in ((found.together,) * 2, (found.alone[0], 1.0), (1.0, found.alone[1]), tuple(found.equal)):
        assert 0.1 < min(factors) < 10.0
        reach = ndtri(0.9) * np.linalg.norm(slope.gradient[1] * size * np.array(factors)[list(study.owners)])
        assert reach == pytest.approx(found.margin[0], rel=1e-9)
        again = study.scale(tuple(float(each) for each in factors))
        passed = piece(again, 0, 600).responses[:, 1] >= 4.5e3
        assert passed.mean() == pytest.approx(0.9, abs=error + 0.02), factors
    assert found.then.share == pytest.approx(0.9, abs=error + 0.02)


def test_copies_do_not_depend_on_how_they_are_cut(guide):
    for sampling in ("monte carlo", "latin hypercube", "sobol"):
        study = guide(
            '[scatter]\na = { address = "leaf.thickness", normal = "2 um" }\nb = { address = "leaf.width", uniform = "1 %" }', 64, sampling
        )
        whole = study.sample(0, study.plan.designs)
        edges = [0, 5, 64, 70, 97, study.plan.designs]
        np.testing.assert_array_equal(np.concatenate([study.sample(*pair) for pair in pairwise(edges)]), whole)
        assert np.all(whole[64:96, 1] == 0.0)
        assert np.all(whole[96:, 0] == 0.0)
        assert np.all(np.any(whole[:64] != 0.0, axis=1))


def test_copies_of_a_symmetric_stage_scatter_alike_and_competing_ones_have_no_derivative():
    study = loads_tolerance("""
format = "flexstage study 1"
case = "double-triangle"
responses = { a = "loss.B4", b = "loss.B5", c = "loss.B6", worst = "loss", f = "frequency.platform.1" }
tolerance = { copies = 16, requirements = false, crosstalk = false }
scatter.pivot = { address = "vertical/pivot.thickness", normal = "5 um", independent = true }
""")
    found = slopes(study)
    sizes = np.linalg.norm(found.gradient, axis=1)
    assert sizes[:3] == pytest.approx(sizes[0], rel=1e-9)
    assert found.smooth.tolist() == [True, True, True, False, False]
    assert found.gradient[4].std() < 1e-6 * abs(found.gradient[4].mean())  # each lifts the mean of the pair alike


def test_a_drawn_stage_has_no_crosstalk_and_turned_copies_that_of_their_lines_of_action():
    """Open: -R_a^-1 dR_a for a direct unit turned about z, of stiff stacks; held: -R_s^-1 dR_s for a gauge turned so, exactly."""
    angle = 1e-5
    stage = double_triangle()
    for name in ("stack_horizontal", "stack_vertical"):
        stage = set_value(stage, f"parts.{name}.stiffness", 1e12)
    bench = bench_of(stage)
    asked = command(bench, "platform")
    names = list(pose_measures(asked))
    at_rest = dict(zip(names, poses(bench, asked), strict=True))
    reference = bench.assembly.bodies["platform"].reference

    def matrix(kind, values):
        return np.array([[float(values[f"{kind}.{row}.{column}"]) for column in COMPONENTS] for row in COMPONENTS])

    assert matrix("open", at_rest) == pytest.approx(np.eye(6), abs=1e-9)
    assert matrix("held", at_rest) == pytest.approx(np.eye(6), abs=1e-9)
    unit = next(frame for name, _, frame in copies(stage) if name == "B1")
    ways = {"open": ("B1", unit), "held": ("S1", bench.assembly.gauges["S1"].sights[0].frame)}
    for kind, (name, frame) in ways.items():
        turned = set_value(stage, f"{name}.rotation.z", angle)
        found = matrix(kind, dict(zip(names, poses(bench_of(turned), asked), strict=True))) - np.eye(6)
        mapping = bench.kinematics.mapping.values if kind == "open" else bench.kinematics.sensing
        own = mapping[0, :3]
        arm = frame.position - reference
        swung = angle * np.cross([0.0, 0.0, 1.0], own)
        change = np.zeros((6, 6))
        change[0] = np.concatenate([swung, np.cross(arm, swung)])
        wanted = -np.linalg.solve(mapping, change)
        np.testing.assert_allclose(found, wanted, atol=(0.01 if kind == "open" else 1e-3) * np.abs(wanted).max())


def test_a_drawn_stage_has_no_crosstalk_at_a_named_point_wherever_its_reference_is():
    """Commands move the nominal point alone; the pose at the point of a stage with scatter is independent of the platform's reference."""
    stage = double_triangle()
    platform = stage.bodies["platform"]

    def with_platform(**changes):
        return replace(stage, bodies={**stage.bodies, "platform": replace(platform, points={"tip": (0.03, -0.02, 0.05)}, **changes)})

    first, second = with_platform(), with_platform(reference=(0.01, 0.04, -0.02))
    asked = command(bench_of(first), "tip")
    one = np.array([float(value) for value in poses(bench_of(first), asked)])
    assert one.reshape(2, 6, 6) == pytest.approx(np.stack([np.eye(6)] * 2), abs=1e-9)
    ours, theirs = (
        np.array([float(value) for value in poses(bench_of(set_value(each, "B1.rotation.z", 1e-3)), asked)]) for each in (first, second)
    )
    assert np.abs(ours - one).max() > 1e-4
    assert theirs == pytest.approx(ours, abs=1e-9)


def test_volts_of_a_stack_that_reaches_farther_move_the_stage_farther():
    """Of a drawn stage T C = 1; with the first stack's stroke 3 % larger C^-1 diag(1.03, 1, ...) C."""
    stage = double_triangle()
    asked = command(bench_of(stage), "platform")
    longer = set_value(stage, "B1/pzt.stroke", 1.03 * get(stage, "B1/pzt.stroke"))
    found = np.array(poses(bench_of(longer), asked)[:36], dtype=float).reshape(6, 6)
    wanted = np.linalg.solve(asked.gains, np.diag([1.03, 1.0, 1.0, 1.0, 1.0, 1.0]) @ asked.gains)
    np.testing.assert_allclose(found, wanted, atol=1e-9 * np.abs(wanted).max())


def test_an_asymmetric_tolerance_shifts_the_mean(guide):
    """Between limits a and b the mean deviation is (a + b) / 2."""
    for text, spread in (("", 6.0 / 12.0**0.5), ('normal = "1 um", ', Distribution(Shape.NORMAL, 1.0, 3.0).deviation)):
        study = guide(f'scatter.w = {{ address = "leaf.thickness", {text}interval = ["-1 um", "5 um"] }}', copies=512)
        values = piece(study, 0, 512).variables[:, 0]
        assert values.min() >= -1e-6
        assert values.max() <= 5e-6
        assert values.mean() == pytest.approx(2e-6, rel=0.01)
        assert values.std() == pytest.approx(spread * 1e-6, rel=0.02)


@pytest.mark.parametrize(
    "shape", [Distribution(Shape.NORMAL, 2.0), Distribution(Shape.NORMAL, 2.0, 3.0), Distribution(Shape.UNIFORM, 2.0, offset=1.0)]
)
def test_distributions_have_the_deviation_they_say(shape):
    values = shape.quantile((np.arange(20000) + 0.5) / 20000)
    assert values.mean() == pytest.approx(shape.offset, abs=1e-9)
    assert values.std() == pytest.approx(shape.deviation, rel=2e-3)
    assert shape.ends is None or shape.ends[0] <= values.min() <= values.max() <= shape.ends[1]
    assert shape.times(3.0).deviation == pytest.approx(3.0 * shape.deviation, rel=1e-12)


def test_intervals_cover_the_truth_as_often_as_they_say():
    kept = np.random.default_rng(1).random((400, 200)) < 0.93
    covered = [found.low <= 0.93 <= found.high for found in map(binomial, kept)]
    assert np.mean(covered) >= 0.95 - 3.0 * np.sqrt(0.05 * 0.95 / 400)


@pytest.mark.parametrize(("kept", "copies"), [(0, 20), (1, 20), (13, 40), (19, 20), (20, 20)])
def test_the_ends_of_an_interval_leave_a_fortieth_on_either_side(kept, copies):
    """At the low end as many kept as there were have a chance of 2.5 %, at the high end as few; nothing lies beyond 0 and 1."""
    found = binomial(np.arange(copies) < kept)
    assert (found.low == 0.0) == (kept == 0)
    assert (found.high == 1.0) == (kept == copies)
    if kept:
        assert scipy.stats.binom.sf(kept - 1, copies, found.low) == pytest.approx(0.025, rel=1e-9)
    if kept < copies:
        assert scipy.stats.binom.cdf(kept, copies, found.high) == pytest.approx(0.025, rel=1e-9)


def test_copies_that_fail_are_kept_and_count_against_the_yield(guide):
    study = guide(
        'limits."stiffness.x" = "at least 1 N/mm"\nscatter.wire = { address = "leaf.thickness", normal = "5 %" }',
        copies=32,
        sampling="monte carlo",
    )
    study = study.scale((20.0,))  # wider than a file may say: some leaves are thinner than nought
    results, slope = told(study), slopes(study)
    negative = np.flatnonzero(results.variables[:, 0] <= -1.0)
    found = summary(study, results, slope)
    assert 0 < len(negative) < 16
    assert set(negative) <= set(results.failures)
    assert found.failed == len(results.failures)
    assert found.together.copies == 32
    assert found.together.kept <= 32 - found.failed


def test_a_response_with_the_name_of_a_requirement_does_not_replace_its_measure(guide):
    """The limit on the mass is judged on the mass, also if the response `mass` is a stiffness; equal measures have one column."""
    text = 'limits.mass = "at least 100 kg"\nlimits."stiffness.x" = "at least 1 N/mm"\nresponses."stiffness.x" = "stiffness.x"\n'
    study = guide(text + 'responses.mass = "stiffness.x"\nscatter.wire = { address = "leaf.thickness", normal = "1 um" }', copies=32)
    found = summary(study, told(study), slopes(study))
    assert [(line.column, line.kept.share) for line in found.lines] == [("limit mass", 0.0), ("stiffness.x", 1.0)]
    assert found.lines[0].nominal == pytest.approx(1.0, rel=0.1)


@pytest.mark.parametrize(("interval", "known"), [('["-9.8 um", "-9.6 um"]', False), ('["-9.8 um", "9.8 um"]', True)])
def test_shares_of_the_margin_are_unknown_for_asymmetric_intervals(guide, interval, known):
    """Thickness falls by 9.7 um +- 0.1 um: little of the variance, but most of the change; a tenfold deviation misses the limit."""
    study = guide(
        f'limits."stiffness.x" = "at least 4 N/mm"\n[scatter]\nwire = {{ address = "leaf.thickness", interval = {interval} }}\n'
        'young = { address = "materials.steel.young", uniform = "2 %" }',
        copies=64,
    )
    slope, results = slopes(study), told(study)
    found = Toleranced(study, results, slope, statistics := summary(study, results, slope), allowance(study, results, slope, statistics))
    allowed = found.allowance
    assert np.isfinite([*allowed.alone, *allowed.equal]).tolist() == 4 * [known]
    assert 1.0 < allowed.together < 10.0
    assert allowance_table(found).texts()[1][2].startswith("-") is not known
    assert np.all(piece(study.scale((allowed.together, allowed.together)), 0, 64).responses[:, 0] >= 0.98 * 4e3)


def test_failed_samples_that_leave_no_tolerance_are_no_violation_of_the_nominal_design(guide):
    limit = 'limits."stiffness.x" = "at least 1 N/mm"\n'
    study = guide(f'{limit}scatter.wire = {{ address = "leaf.thickness", normal = "30 %", within = "90 %" }}', copies=1024)
    slope, results = slopes(study), told(study)
    results.responses[:20] = np.nan
    found = Toleranced(study, results, slope, statistics := summary(study, results, slope), allowance(study, results, slope, statistics))
    assert found.allowance.together == 0.0 < found.allowance.margin[0]
    assert (
        "stiffness.x leaves no tolerance: the nominal design has no margin to it, or too many samples" in allowance_table(found).notes[-1]
    )


def test_unknown_crosstalk_is_not_shown_as_zero():
    study = loads_tolerance("""
format = "flexstage study 1"
case = "parallelogram"
tolerance = { copies = 2 }
scatter.wire = { address = "hinges.thickness", normal = "1 um" }
""")
    results, slope = told(study), slopes(study)
    results.responses[:] = np.nan
    found = Toleranced(study, results, slope, summary(study, results, slope), None)
    assert {row[1] for row in crosstalk_table(found, found.crosstalk[0]).texts()[1:7]} == {"-"}


def test_one_sided_intervals_reach_one_side(guide):
    """Poisson's ratio of 0.3 less up to 0.25 stays within its bounds; 0.3 more does not."""
    entry = 'scatter.nu = {{ address = "materials.steel.poisson", interval = ["{}", "{}"] }}'
    (deviation,) = guide(entry.format(-0.25, 0)).deviations
    assert (deviation.low, deviation.high) == (-0.25, 0.0)
    with pytest.raises(DesignError, match=r"is 0.3, and deviations reach 0.3: it would be 0.6, and must be"):
        guide(entry.format(0, 0.3))


BAD = {
    'w = { address = "hinge.thickness", normal = "1 um" }': 'unknown name "hinge". Use hinges.',
    'w = { address = "leaf.thicknes", normal = "1 um" }': "Use thickness",
    'w = { address = "leaf.thickness", normal = "-1 um" }': "must be greater than 0",
    'w = { address = "leaf.thickness", normal = "0 um" }': "must be greater than 0",
    'w = { address = "leaf.thickness", normal = "0.2 mm" }': "parts.leaf.thickness is 0.5 mm, and deviations reach 1 mm (5 standard",
    'w = { address = "leaf.thickness", normal = "1e308 m" }': "deviations reach inf mm (5 standard deviations)",
    'w = { address = "leaf.thickness", uniform = "120 %" }': "it would be -0.1 mm, and must be greater than 0",
    'v = { address = "leaf.thickness", uniform = "60 %" }\nw = { address = "hinges.thickness", uniform = "60 %" }': "reach 0.6 mm: it",
    'w = { address = "leaf.thickness" }': "deviation missing",
    'w = { address = "leaf.thickness", normal = "1 um", uniform = "1 um" }': "must be normal or uniform, not both",
    'w = { address = "leaf.thickness", normal = "1 mrad" }': "mrad",
    'w = { address = "materials.steel.young", normal = "1 %", independent = true }': "is a single number",
    'w = { address = ["leaf.thickness", "materials.steel.young"], normal = "1 %" }': "different quantities",
    'w = { address = "leaf.thickness", normal = "1 um", evry = true }': "unknown key",
    'w = { address = "stacks.stroke", normal = "1 %" }': "the design has no such part",
    'w = { address = "leaf.thickness", interval = ["5 um", "-1 um"] }': "the lower limit must be below the upper limit",
    'w = { address = "leaf.thickness", uniform = "5 um", interval = ["-1 um", "5 um"] }': "limits specified twice",
    'w = { address = "leaf.thickness", interval = ["-1 um", "5 %"] }': "some amounts are relative (%), others are not",
    'w = { address = "links.l0.at.z", normal = "1 um", within = "3 %" }': "some amounts are relative (%), others are not",
}


@pytest.mark.parametrize("line", BAD)
def test_entries_that_cannot_be(guide, line):
    with pytest.raises(DesignError) as caught:
        guide(f"[scatter]\n{line}")
    assert BAD[line] in str(caught.value)


def test_sections_that_cannot_be(guide):
    for text, said in {
        "": "no scatter",
        'scatter.w = { address = "leaf.thickness", normal = "1 um" }\nlimits."stifness.x" = "at least 1 N/m"': "stiffness.x",
    }.items():
        with pytest.raises(DesignError) as caught:
            guide(text)
        assert said in str(caught.value)
    with pytest.raises(DesignError, match="do not determine the platform"):
        loads_tolerance(ASKED.replace("false", "true"), folder=guide.folder)
    assert loads_tolerance(ASKED.replace("crosstalk = false", ""), folder=guide.folder).commanded is None


@pytest.mark.parametrize(("copies", "allowed"), [(64, 4.0 / np.sqrt(128.0)), (4096, 0.1)])
def test_first_order_is_trusted_to_a_tenth_or_four_standard_errors(guide, copies, allowed):
    """A sample that deviates by just less than is allowed from what derivatives say keeps their trust, by just more loses it."""
    study = guide('scatter.w = { address = "leaf.thickness", normal = "1 um" }\n', copies=copies)
    slope = slopes(study)
    linear = float(abs(slope.gradient[0, 0]) * study.deviations[0].deviation)
    shape = np.linspace(-1.0, 1.0, copies)[:, None]
    for sign in (1.0, -1.0):
        for part, trusted in ((0.98, True), (1.02, False)):
            values = shape / np.std(shape, ddof=1) * linear / (1.0 + sign * part * allowed)
            results = Results(np.arange(copies), np.zeros((copies, 1)), values, {}, ((), ()), ((), ()), copies, {}, "")
            assert summary(study, results, slope).spread.trusted.tolist() == [trusted]
