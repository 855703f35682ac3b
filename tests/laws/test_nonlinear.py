"""Laws of large displacements: what holds of any stage, in any frame, under any load."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace

import numpy as np
import pytest

from flexstage.base.number import Number
from flexstage.base.processes.native import SWITCH
from flexstage.base.units.scale import Z
from flexstage.beams.flexure.law import Resolution, leaf_law
from flexstage.beams.leaf import leaf_diagonal, torsional_compliance
from flexstage.cases.double_triangle import double_triangle
from flexstage.cases.parallelogram import parallelogram
from flexstage.cases.registry import case
from flexstage.mechanism.mechanism import Force, Link, Mechanism
from flexstage.models.lumped import lumped
from flexstage.models.nonlinear.compiled import kernel, tables
from flexstage.models.nonlinear.elements.condense import condense, relax_fields
from flexstage.models.nonlinear.elements.element import energy, shape, tangent
from flexstage.models.nonlinear.equilibrium import State, equilibrium
from flexstage.models.nonlinear.graph import assemble
from flexstage.models.nonlinear.stage import Nonlinear, nonlinear
from flexstage.models.nonlinear.state import SolverOptions, Status
from flexstage.parts.body import Body, Inertia
from flexstage.parts.compliance_matrix import ComplianceMatrix as Matrix
from flexstage.parts.leaf import Leaf, LeafEnds, LeafSection
from flexstage.parts.material import Material
from flexstage.parts.rod import Rod
from flexstage.parts.section import Rectangle
from flexstage.spatial.frame import spatial_rotation
from flexstage.spatial.rotation import exponential, exponential_rate, magnus

STEEL = Material(young=200e9, poisson=0.3, density=7800.0)
LEAF = Leaf("steel", length=0.1, thickness=0.5e-3, width=0.02)
UNIT = 200e9 * 0.02 * 0.5e-3**3 / 12.0 / 0.1**2
"""E I / L^2 of `LEAF` [N]."""
FINE = Resolution(10, 10, 14, (8, 6), 20)
SPACE = np.array([3.0, 12.0, 2.0, 0.02, 0.03, -0.1])
"""A load in all directions on a guide, over `UNIT`."""


Given = Mapping[str, Number]


NONE = (0.0, 0.0, 0.0)
AWAY = (0.03, 0.02, -0.04)
"""Where a platform's weight is, from its reference [m]."""


def guide(
    turn: np.ndarray | None = None,
    *,
    swap: bool = False,
    gravity: tuple[float, float, float] = NONE,
    mass: float = 1.0,
    centre: tuple[float, float, float] = NONE,
) -> Mechanism:
    """Two leaves 50 mm apart between ground and platform, perhaps turned in space, or one of them drawn from its other end."""
    turn = np.eye(3) if turn is None else turn
    joins = {"left": ("ground", "platform"), "right": ("platform", "ground") if swap else ("ground", "platform")}
    sides = {"left": -0.025, "right": 0.025}
    signs = {"left": 1.0, "right": -1.0 if swap else 1.0}
    links = {
        name: Link(joins[name], "leaf", tuple(turn @ [0.05, sides[name], 0.0]), tuple(signs[name] * turn[:, 0]), bends=tuple(turn[:, 2]))
        for name in joins
    }
    place = turn @ [0.1, 0.0, 0.0]
    body = Body(mass=mass, inertia=Inertia(1e-3, 1e-3, 1e-3), centre=tuple(place + turn @ centre), reference=tuple(place))
    return Mechanism("", materials={"steel": STEEL}, parts={"leaf": LEAF}, bodies={"platform": body}, links=links, gravity=gravity)


def loads(values: np.ndarray) -> dict[str, np.ndarray]:
    return dict(zip([f"platform.{name}" for name in ("fx", "fy", "fz", "mx", "my", "mz")], np.moveaxis(values, -1, 0), strict=True))


def stiffness(state: State) -> np.ndarray:
    return assemble(state.model, state.pose, state.loads, state.hold).stiffness


@pytest.mark.parametrize("name", ["double-triangle", "hexapod"])
def test_at_rest_it_is_the_lumped_model(name: str):
    """Stacks, notches, necks and joints are exactly what they are at small displacements."""
    stage = case(name)
    model, small = nonlinear(stage), lumped(stage)
    found = stiffness(equilibrium(model, weight=0.0, stated=0.0))[0]
    expected = small.stiffness_matrix[: model.freedoms, : model.freedoms]
    scale = np.sqrt(np.diag(expected))
    assert np.max(np.abs(found - expected) / scale / scale[:, None]) < 1e-9


@pytest.mark.parametrize("name", ["parallelogram", "tilt-stage"])
def test_leaves_at_rest_differ_by_the_shear_of_their_clamps(name: str):
    stage = case(name)
    model, small = nonlinear(stage), lumped(stage)
    found = stiffness(equilibrium(model, weight=0.0, stated=0.0))[0]
    expected = small.stiffness_matrix[: model.freedoms, : model.freedoms]
    values = np.linalg.eigvals(np.linalg.solve(expected, found[: model.freedoms, : model.freedoms])).real
    assert values == pytest.approx(1.0, abs=3e-3)


@pytest.mark.parametrize(("width", "factor"), [(0.1, 1.0511), (0.2, 1.1073), (0.5, 1.3191), (2.0, 4.0195)])
def test_a_leaf_twists_as_plate_elements_do(width: float, factor: float):
    """Factors on G b t^3 / (3 L) by plate elements, nu = 0.3 (reference B6); the lumped model's one decay is up to 6 % too soft."""
    leaf = replace(LEAF, length=1.0, thickness=1e-4 * width, width=width)
    law = leaf_law(leaf, STEEL)
    still = np.zeros((1, law.form.shape[-1])), np.zeros((1, 3))
    moved = condense(tangent(law, *still, shape(law, *still)), np.zeros((1, 6))).moved[0, -6:]
    assert law.rigidity * moved[3, 3] == pytest.approx(factor * STEEL.shear * width * leaf.thickness**3 / 3.0, rel=2e-3)
    assert 1.0 < law.rigidity * moved[3, 3] * torsional_compliance(leaf, STEEL) < 1.07


@pytest.mark.parametrize(("ends", "section"), [(LeafEnds.FREE, LeafSection.PLATE), (LeafEnds.CLAMPED, LeafSection.BEAM)])
def test_ends_that_may_warp_twist_by_the_rigidity_alone(ends: LeafEnds, section: LeafSection):
    """L / (G J), at large displacements as in the lumped model; the plate bends as before."""
    free = replace(LEAF, ends=ends, section=section)
    small = lumped(replace(guide(), parts={"leaf": free}))
    found = stiffness(equilibrium(nonlinear(replace(guide(), parts={"leaf": free})), weight=0.0))[0]
    expected = small.stiffness_matrix[:6, :6]
    scale = np.sqrt(np.diag(expected))
    assert np.max(np.abs(found - expected) / scale / scale[:, None]) < 3e-3
    torsion = leaf_diagonal(free, STEEL)[3] * STEEL.shear * Rectangle(LEAF.thickness, LEAF.width).torsion
    assert torsion == pytest.approx(LEAF.length, rel=1e-12)
    bends = leaf_diagonal(replace(free, ends=LeafEnds.CLAMPED), STEEL)
    assert np.delete(leaf_diagonal(free, STEEL), 3) == pytest.approx(np.delete(bends, 3), rel=1e-15)


def test_the_steps_of_rotation_are_of_order_six():
    def turned(steps: int) -> np.ndarray:
        nodes = 0.5 + np.array([-1.0, 0.0, 1.0]) * np.sqrt(0.15)
        total = np.eye(3)
        for start in np.arange(steps) / steps:
            values = [np.array([np.sin(3 * s), 2 * s * s, np.cos(5 * s)]) * 2.0 for s in start + nodes / steps]
            total = total @ exponential(magnus(np.array(1.0 / steps), *values))
        return total

    exact = turned(64)
    coarse, fine = (np.max(np.abs(turned(steps) - exact)) for steps in (4, 8))
    assert 5.5 < np.log2(coarse / fine) < 6.6


def test_the_frame_does_not_matter():
    turn = exponential(np.array([0.7, -1.1, 0.4]))
    here = equilibrium(nonlinear(guide()), loads(SPACE * UNIT)).twist()
    there = equilibrium(nonlinear(guide(turn)), loads(spatial_rotation(turn) @ SPACE * UNIT)).twist()
    assert spatial_rotation(turn).T @ there == pytest.approx(here, abs=1e-13)


@pytest.mark.parametrize("swap", [False, pytest.param(True, marks=pytest.mark.full)])
def test_tangents_are_the_slopes_of_reactions(swap: bool):
    model = nonlinear(guide(swap=swap, gravity=(40.0, -90.0, 30.0), mass=0.1, centre=AWAY))
    held = {f"platform.{name}": value for name, value in zip(("x", "y", "z"), (-1e-3, 0.02, 4e-5), strict=True)}
    step = 1e-6
    moved = {name: value + step * np.eye(3)[:, [place]] * [[1, -1]] for place, (name, value) in enumerate(held.items())}
    found = equilibrium(model, loads(np.array([0, 0, 0, 0.1, 0.01, 0.02])), hold=moved).reactions
    slope = (found[:, 0] - found[:, 1]) / (2.0 * step)
    matrix = stiffness(equilibrium(model, loads(np.array([0, 0, 0, 0.1, 0.01, 0.02])), hold=held))[0]
    free, place = matrix[3:6, 3:6], slice(0, 3)
    condensed = matrix[place, place] - matrix[place, 3:6] @ np.linalg.solve(free, matrix[3:6, place])
    scale = np.sqrt(np.diag(condensed))
    assert np.max(np.abs(slope - condensed) / scale / scale[:, None]) < 1e-5


def on_matrices(*, swap: bool = False) -> Nonlinear:
    """The guide on two given 6x6 in place of leaves, on which its platform turns far, its weight off its reference."""
    part = Matrix(tuple(map(tuple, np.diag(1.0 / np.array([4e3, 9e2, 2e3, 0.4, 0.9, 0.6])))), free=())
    return nonlinear(replace(guide(swap=swap, gravity=(2.0, -4.0, 1.0), centre=AWAY), parts={"leaf": part}))


def test_what_holds_a_rotation_is_the_moment_of_its_component():
    """T^-T e times the reaction, fixed in space, brings the stage where holding a component of its rotation vector does."""
    model, wrench = on_matrices(), np.array([20.0, 45.0, 30.0, 0.1, -0.2, 0.0])
    held = equilibrium(model, loads(wrench), hold={"platform.rz": 0.3})
    assert np.linalg.norm(held.rotation()[:2]) > 0.1
    wrench[3:] += np.linalg.inv(exponential_rate(held.rotation())).T[:, 2] * held.reactions[0]
    assert equilibrium(model, loads(wrench)).twist() == pytest.approx(held.twist(), abs=1e-9)


def test_links_about_centres_are_alike_from_both_ends_and_have_an_energy():
    """Bodies turned by half a radian and more: the same from either end, and symmetric without dead couples."""
    force = np.array([20.0, 45.0, 30.0, 0.0, 0.0, 0.0])
    one, other = (equilibrium(on_matrices(swap=swap), loads(force)) for swap in (False, True))
    assert np.linalg.norm(one.rotation()) > 0.5
    assert other.twist() == pytest.approx(one.twist(), abs=1e-10)
    assert asymmetry(on_matrices(swap=False), force / UNIT) < 1e-9


def asymmetry(model: Nonlinear, wrench: np.ndarray) -> float:
    matrix = stiffness(equilibrium(model, loads(wrench * UNIT)))[0]
    scale = np.sqrt(np.abs(np.diag(matrix)))
    return float(np.max(np.abs(matrix - matrix.T) / scale / scale[:, None]))


def test_stiffness_is_symmetric_without_dead_couples():
    force = SPACE * [1, 1, 1, 0, 0, 0]
    assert asymmetry(nonlinear(guide()), force) < 1e-6
    assert asymmetry(nonlinear(guide(), resolution=FINE), force) < 1e-9
    assert asymmetry(nonlinear(guide()), SPACE) > 1e-6


def test_asymmetry_falls_with_points():
    force = SPACE * [1, 1, 1, 0, 0, 0]
    coarse, middle, fine = (asymmetry(nonlinear(guide(), resolution=Resolution(points=points)), force) for points in (10, 14, 18))
    assert coarse > 10.0 * middle > 100.0 * fine


@pytest.mark.parametrize(("resolution", "most"), [(Resolution(), 2e-6), pytest.param(FINE, 5e-8, marks=pytest.mark.full)])
def test_energy_is_the_work_of_forces(resolution: Resolution, most: float):
    model = nonlinear(guide(), resolution=resolution)
    nodes, weights = np.polynomial.legendre.leggauss(12)
    share = np.concatenate([0.5 * (nodes + 1.0), [1.0]])
    force = SPACE[:3] * UNIT
    found = equilibrium(model, loads(np.concatenate([share[:, None] * force, np.zeros((len(share), 3))], axis=1)))
    path = found.displacement() @ force
    (group,) = model.flexures
    lies = shape(group.law, found.pose.strain[0], found.pose.wrench[0][..., :3])
    stored = energy(group.law, found.pose.strain[0], lies)
    whole = np.sum(stored[:, -1] * group.law.rigidity / group.law.length)
    complementary = 0.5 * weights @ path[:-1]
    assert path[-1] - complementary == pytest.approx(whole, rel=most)


def test_the_order_of_ends_does_not_matter():
    wrench = loads(SPACE * UNIT)
    assert equilibrium(nonlinear(guide(swap=True)), wrench).twist() == pytest.approx(
        equilibrium(nonlinear(guide()), wrench).twist(), abs=1e-8
    )


def test_weight_hangs_where_masses_do():
    """A leaf's own weight, in a frame that turns with its first body, is found alike from either end."""
    heavy = [guide(swap=swap, gravity=(400.0, 600.0, -100.0), mass=1e-4) for swap in (False, True)]
    one, other = (equilibrium(nonlinear(each), loads(SPACE * UNIT)) for each in heavy)
    assert one.status == Status.CONVERGED
    assert one.iterations < 12
    assert other.twist() == pytest.approx(one.twist(), abs=1e-7)


def taken_at_once(thickness: float, counts: tuple[int, int, int]) -> None:
    """Forces up to 20, -10 to 10 and moments -3 to 3 in units of E I / L^2, on leaves whose stretching is weak or strong."""
    model = nonlinear(replace(guide(), parts={"leaf": replace(LEAF, thickness=thickness)}))
    ranges = [np.linspace(low, high, count) for (low, high), count in zip([(-10, 10), (0, 20), (-3, 3)], counts, strict=True)]
    grid = np.stack(np.meshgrid(*ranges, indexing="ij"), -1).reshape(-1, 3)
    wrench, unit = np.zeros((len(grid), 6)), UNIT * (thickness / LEAF.thickness) ** 3
    wrench[:, :2], wrench[:, 5] = grid[:, :2] * unit, grid[:, 2] * unit * LEAF.length
    at_once = SolverOptions(halvings=0, arcs=0)  # some of them lie beyond a limit point
    found = equilibrium(model, loads(wrench), options=at_once)
    assert found.converged.all()
    assert found.iterations.mean() < 6.2
    alone = equilibrium(model, loads(wrench[37]), options=at_once)
    assert alone.twist() == pytest.approx(found.twist()[37], abs=1e-12)


@pytest.fixture
def plain(monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[[Callable[[], State]], State]]:
    """What numpy finds, without the kernel in C."""

    def without(search: Callable[[], State]) -> State:
        with monkeypatch.context() as context:
            context.setenv(SWITCH, "off")
            kernel.cache_clear()
            assert kernel() is None
            found = search()
        kernel.cache_clear()
        return found

    yield without
    kernel.cache_clear()


def same(one: State, other: State, share: float) -> bool:
    """Whether poses agree, and amplitudes and forces of flexures, as a share of the largest."""
    inside = zip((*one.pose.strain, *one.pose.wrench), (*other.pose.strain, *other.pose.wrench), strict=True)
    near = all(np.max(np.abs(a - b), initial=0.0) <= share * np.max(np.abs(b), initial=1.0) for a, b in inside)
    return (
        near
        and bool(np.max(np.abs(one.pose.position - other.pose.position)) <= share * one.model.size)
        and bool(np.max(np.abs(one.pose.turn - other.pose.turn)) <= share)
    )


RANDOM = np.random.default_rng(3).uniform(-1.0, 1.0, (11, 6)) * [5.0, 15.0, 3.0, 0.05, 0.05, 0.2] * UNIT


@pytest.mark.parametrize(
    ("stage", "given", "held"),
    [
        pytest.param(guide(swap=True), loads(RANDOM), {}, marks=pytest.mark.full),
        (guide(gravity=(400.0, 600.0, -100.0), mass=1e-4), loads(RANDOM[:3]), {}),
        (guide(gravity=(4.0, -9.0, 3.0)), {}, {"platform.y": np.linspace(0.0, 0.02, 5), "platform.rx": 0.02}),
        (replace(guide(), parts={"leaf": replace(LEAF, curvature=2.0)}), loads(RANDOM[:3]), {}),
        (parallelogram(), {"B": [1e-5, 2e-5]}, {}),
        (double_triangle(), {"B1": [1e-5, -1e-5]}, {}),
    ],
)
def test_the_kernel_is_numpy(stage: Mechanism, given: Given, held: Given, plain: Callable[[Callable[[], State]], State]):
    model = nonlinear(stage)
    if kernel() is None:
        pytest.skip("no compiler")
    assert tables(model) is not None
    fast, reference = equilibrium(model, given, hold=held), plain(lambda: equilibrium(model, given, hold=held))
    assert fast.iterations.tolist() == reference.iterations.tolist()
    assert fast.status.tolist() == reference.status.tolist()
    assert same(fast, reference, 1e-11)


def test_a_batch_is_its_cases_to_the_bit():
    """All of the stage in C, more cases than lanes; and one with a stack and hinges, and a held coordinate."""
    if kernel() is None:
        pytest.skip("no compiler")
    along = np.linspace(-2e-4, 3e-4, len(RANDOM))
    for stage, given, held in (
        (guide(gravity=(4.0, -9.0, 3.0)), loads(RANDOM), {}),
        (parallelogram(), {"B": 0.05 * along}, {}),
        (parallelogram(), {}, {"platform.x": along}),
    ):
        model = nonlinear(stage)
        together = equilibrium(model, given, hold=held)
        for place in range(len(RANDOM)):
            one = equilibrium(model, _at_one(given, place), hold=_at_one(held, place))
            assert np.array_equal(one.pose.position[0], together.pose.position[place])
            assert np.array_equal(one.pose.wrench[0][:, 0], together.pose.wrench[0][:, place])
            assert one.residual == together.residual[place]


def _at_one(values: dict[str, np.ndarray], place: int) -> dict[str, Number]:
    return {name: each[place] for name, each in values.items()}


def test_a_batch_is_its_cases_in_numpy(plain: Callable[[Callable[[], State]], State]):
    model = nonlinear(guide())
    together = plain(lambda: equilibrium(model, loads(RANDOM)))
    alone = plain(lambda: equilibrium(model, loads(RANDOM[7])))
    assert alone.twist() == pytest.approx(together.twist()[7], abs=1e-12)


def test_a_law_that_the_kernel_does_not_know_is_left_to_numpy():
    model = nonlinear(guide())
    (group,) = model.flexures
    coupled = np.array(group.law.form)
    coupled[:, 0, 12] = coupled[:, 12, 0] = 1e-3
    strange = replace(model, flexures=(replace(group, law=replace(group.law, form=coupled)),))
    assert tables(model) is not None
    assert tables(strange) is None
    assert equilibrium(strange, loads(SPACE * UNIT)).converged


@pytest.mark.parametrize("thickness", [2e-3, 0.5e-3, 0.2e-3])
def test_a_batch_is_its_cases_and_the_whole_load_is_taken_at_once(thickness: float):
    taken_at_once(thickness, (5, 6, 3))


@pytest.mark.full
@pytest.mark.parametrize("thickness", [2e-3, 0.5e-3, 0.2e-3])
def test_all_of_a_fine_grid_is_taken_at_once(thickness: float):
    taken_at_once(thickness, (10, 15, 10))


def test_plate_fields_have_the_least_energy_at_their_curvatures():
    model = nonlinear(guide())
    (group,) = model.flexures
    strain = relax_fields(group.law, 0.5 * np.random.default_rng(5).normal(size=(2, 3, group.law.form.shape[-1])))
    found = tangent(group.law, strain, np.zeros((2, 3, 3)), shape(group.law, strain, np.zeros((2, 3, 3))))
    count = group.law.modes.shape[-1]
    assert np.max(np.abs(found.gradient[..., count:])) < 1e-12 * np.max(np.abs(found.gradient))


def test_a_flexure_without_load_answers_with_its_compliance():
    """The element by itself: rods of any proportions by beam theory."""
    stage = Mechanism(
        "",
        materials={"steel": STEEL},
        parts={"rod": Rod("steel", length=0.05, diameter=0.002)},
        bodies={"platform": Body(mass=1.0, inertia=Inertia(1.0, 1.0, 1.0), reference=(0.05, 0.0, 0.0))},
        links={"rod": Link(("ground", "platform"), "rod", (0.025, 0.0, 0.0), (1.0, 0.0, 0.0), bends=Z)},
    )
    (group,) = nonlinear(stage).flexures
    none = np.zeros((1, 1, group.law.form.shape[-1])), np.zeros((1, 1, 3))
    found = condense(tangent(group.law, *none, shape(group.law, *none)), np.zeros((1, 1, 6)))
    stiff = found.moved[0, 0, -6:]
    area = np.pi * 1e-6
    assert stiff[0, 0] == pytest.approx(0.05**2 * area / (np.pi / 4.0 * 1e-12), rel=1e-12)
    assert stiff[3, 3] == pytest.approx(1.0 / 1.3, rel=1e-12)
    assert np.allclose(stiff, stiff.T, atol=1e-9)


def sized(size: float) -> Mechanism:
    """A loaded guide drawn `size` times as large, its masses, modulus and forces the same; loads act off the reference of its platform."""
    drawn = guide(mass=2.0)
    place = size * np.array([0.1, 0.0, 0.0])
    inertia = Inertia(*(each * size**2 for each in (1e-3, 2e-3, 3e-3)))
    body = Body(mass=2.0, inertia=inertia, centre=tuple(place + size * np.array(AWAY)), reference=tuple(place))
    force = UNIT * np.array([6.0, 30.0, -9.0])
    return replace(
        drawn,
        materials={"steel": replace(STEEL, density=STEEL.density / size**3, expansion=1e-3)},
        parts={"leaf": replace(LEAF, length=size * LEAF.length, thickness=size * LEAF.thickness, width=size * LEAF.width)},
        bodies={"platform": body},
        links={name: replace(link, at=tuple(size * np.array(link.at))) for name, link in drawn.links.items()},
        forces={"push": Force("platform", tuple(size * np.array([0.13, 0.03, 0.05])), tuple(force))},
        gravity=(0.0, -9.80665, 0.0),
    )


def test_a_stage_that_is_warm_all_over_is_one_drawn_larger():
    """Of one material: places and tangent under weight and a force off the reference are those of a stage 1 + alpha T times as large."""
    warm, larger = nonlinear(sized(1.0), temperature=20.0, ground="steel"), nonlinear(sized(1.02))
    states = [equilibrium(model) for model in (warm, larger)]
    places = [state.pose.position[0, 0] for state in states]
    assert np.linalg.norm(places[1] - larger.reference[0]) > 1e-3
    np.testing.assert_allclose(places[0], places[1], atol=1e-9)
    matrices = [stiffness(state)[0] for state in states]
    scale = np.sqrt(np.abs(np.diag(matrices[1])))
    assert np.max(np.abs(matrices[0] - matrices[1]) / scale / scale[:, None]) < 1e-7


def test_what_does_not_converge_is_not_a_number():
    model = nonlinear(guide())
    (group,) = model.flexures
    broken = replace(model, flexures=(replace(group, law=replace(group.law, rigidity=np.array([np.nan, 1.0]))),))
    found = equilibrium(broken, loads(SPACE * UNIT))
    assert found.status == Status.SINGULAR
    assert np.isnan(found.twist()).all()
