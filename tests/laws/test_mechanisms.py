"""Laws of stages, on random ones: what must hold whatever is built."""

from __future__ import annotations

from dataclasses import fields, is_dataclass, replace

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from flexstage.analysis.dynamics.response import transmissibility
from flexstage.analysis.linear_statics.statics import centre_of_stiffness
from flexstage.analysis.loaded.stability import stability
from flexstage.base.number import stack
from flexstage.beams.compliance import law
from flexstage.beams.mass import mass
from flexstage.mechanism.addresses.path import replace_member
from flexstage.mechanism.assembly.expand import expand
from flexstage.mechanism.assembly.incidence import deformation, layout, twist_at
from flexstage.mechanism.mechanism import GROUND, PLATFORM, Mechanism, ModalDamping
from flexstage.models.linear.eigen import eigen
from flexstage.models.linear.model import Contribution, assemble
from flexstage.models.linear.port import ports
from flexstage.models.linear.static import displacement, part_deformation, static_gain
from flexstage.parts.body import Body
from flexstage.parts.compliance_matrix import ComplianceMatrix, Joint
from flexstage.parts.freedom import Freedom, others
from flexstage.parts.part import Restricted, is_actuator
from flexstage.parts.piezo import Piezo
from flexstage.spatial.frame import COMPONENTS, FORCES, rigid_inertia, spatial_rotation, transport
from tests.conftest import examples
from tests.laws.shared import ideal, lumped
from tests.laws.strategies import actuated_platforms, mechanisms, moved, platforms, rosettes, turns

TWIST = tuple(f"{PLATFORM}.{name}" for name in COMPONENTS)
WRENCH = tuple(f"{PLATFORM}.{name}" for name in FORCES)
METRE = np.array([1.0, 1.0, 1.0, 0.1, 0.1, 0.1])
"""Makes twists (rotations times 0.1 m) and wrenches (moments over 0.1 m) comparable."""


def near(actual, expected, tolerance):
    """Equal within a tolerance relative to the largest entry."""
    assert np.max(np.abs(actual - expected), initial=0.0) <= tolerance * np.max(np.abs(expected), initial=1e-300)


def platform_compliance(model):
    """6x6 of the platform in comparable units."""
    return static_gain(model, TWIST, WRENCH).values * METRE[:, None] * METRE


def scaled(matrix):
    root = np.sqrt(np.diag(matrix))
    return matrix / root / root[:, None]


def rounding(model):
    """What rounding may do to solutions of K q = f, relative to the largest motion: 4 n eps cond(H) + 1e-12, with K = D H D and H_ii = 1.

    Cholesky's solve meets |D dq| <= 3 n^2 u cond(H) |D q|, whatever D is, that is however differently the coordinates are scaled (Demmel
    1989; Higham, Accuracy and Stability of Numerical Algorithms, 2002, section 10.1; u = eps/2). That is for errors that all add up; of
    random signs they add up to some n eps cond(H). So do those of Gauss's elimination here, and those of K's own entries: they are
    relative to d_i d_j, as K is a sum of positive parts. On a thousand random stages besides those of these tests the largest error of
    any law was 0.27 of this bound. The floor 1e-12 is for what no stiffness matrix causes, the turning of frames and loads.
    """
    stiffness = model.stiffness_matrix
    return 4.0 * len(stiffness) * np.finfo(float).eps * np.linalg.cond(scaled(stiffness)) + 1e-12


@given(mechanisms())
def test_stiffness_is_symmetric_and_positive(mechanism):
    model = lumped(mechanism)
    K, M = model.stiffness_matrix, model.inertia_matrix
    assert np.array_equal(K, K.T)
    assert np.array_equal(M, M.T)
    assert np.linalg.eigvalsh(scaled(K))[0] > 0.0
    assert np.linalg.eigvalsh(M)[0] >= -1e-12 * np.abs(M).max()
    for name, part in model.stiffness.items():
        assert np.linalg.eigvalsh(scaled(part.law))[0] > 0.0, name


def floating(mechanism):
    """The same stage with the ground as a body that can move."""
    links = {
        name: replace(link, joins=tuple("floor" if body == GROUND else body for body in link.joins))
        for name, link in mechanism.links.items()
    }
    return replace(mechanism, links=links, bodies={**mechanism.bodies, "floor": Body()}, gauges={})


@given(mechanisms())
def test_rigid_motion_strains_nothing(mechanism):
    """K (rigid motion of everything, ground included) = 0, and no gauge feels it."""
    stage = expand(floating(mechanism))
    order = layout(stage)
    centre = stage.bodies[PLATFORM].reference
    rigid = np.concatenate([transport(stage.bodies[body].reference - centre) for body in order.bodies])
    parts = {}
    for name, link in stage.links.items():
        operator = deformation(stage, order, link)
        assert np.abs(operator @ rigid).max() < 1e-12
        parts[name] = Contribution(operator, law(link.part, link.material).stiffness)
    K = assemble(parts, order.size)
    assert np.abs(K @ rigid).max() < 1e-11 * np.abs(K).max()
    model = lumped(mechanism)
    feels = [index for index, channel in enumerate(model.outputs) if channel.name in mechanism.gauges or channel.unit[0] == "N"]
    assert not model.rigid_output[feels].any()


@given(mechanisms(), st.floats(0.05, 0.95) | st.floats(1.05, 3.0))
def test_transmissibility_is_that_of_a_moved_floor(mechanism, ratio):
    """With the floor's motion prescribed: (K_qq - w^2 M_qq) q = -(K_qf - w^2 M_qf) x_f, all inertia of links included.

    Rounding relative to K counts 1 + ratio^2 times, as w^2 M <= ratio^2 K, and 1/gap times: K - w^2 M = K^(1/2) (1 - w^2 A) K^(1/2), where
    1 - w^2 A has the least eigenvalue gap = min |1 - w^2/lambda|. It is relative to the motion of the whole stage, |D x|, and not to the
    platform's own: that may all but stand still while a body on it resonates.
    """
    stage = expand(floating(mechanism))
    order = layout(stage)
    parts, masses = {}, {}
    for name, link in stage.links.items():
        parts[name] = Contribution(deformation(stage, order, link), law(link.part, link.material).stiffness)
        ends = np.concatenate([twist_at(stage, order, body, link.frame) for body in link.joins])
        masses[name] = Contribution(ends, mass(link.part, link.material))
    for name, placed in stage.bodies.items():
        if placed.mass is not None:
            inertia = rigid_inertia(placed.mass.mass, placed.mass.inertia, placed.mass.centre, placed.reference)
            masses[f"body {name}"] = Contribution(np.eye(order.size)[order.columns(name)], inertia)
    model = lumped(mechanism)
    natural = eigen(model).values
    frequency = ratio * np.sqrt(natural[0]) / (2.0 * np.pi)
    gap = np.min(np.abs(1.0 - ratio**2 * natural[0] / natural))
    static = assemble(parts, order.size)
    dynamic = static - (2.0 * np.pi * frequency) ** 2 * assemble(masses, order.size)
    floor = range(*order.columns("floor").indices(order.size))
    free = [index for index in range(order.size) if index not in floor]
    moved_ = -np.linalg.solve(dynamic[np.ix_(free, free)], dynamic[np.ix_(free, floor)])
    carry = transport(stage.bodies["floor"].reference - stage.bodies[PLATFORM].reference)
    expected = moved_[:6] @ carry * METRE[:, None] / METRE
    weight = np.sqrt(np.diag(static))
    size = np.linalg.norm(weight[:, None] * np.concatenate([moved_ @ carry, carry]) / METRE, axis=0)
    found = transmissibility(model, frequencies=np.array([frequency]), damping=ModalDamping(0.0)).values[0] * METRE[:, None] / METRE
    tolerance = rounding(model) * (1.0 + ratio**2) / gap
    assert np.all(np.abs(found - expected) <= tolerance * size * (METRE / weight[:6])[:, None])


def rounding_of_values(model):
    """What rounding may do to eigenvalues, relative to each: that of the solutions, and 4 n eps lambda_i / lambda_1.

    They are the inverse of the eigenvalues of L^-1 M L^-T, which a backward stable solver gives to n eps of their largest, 1/lambda_1
    (Golub and Van Loan, Matrix Computations, 2013, section 8.1): the highest modes are the least accurate ones.
    """
    values = eigen(model).values[:6]
    return rounding(model) + 4.0 * len(model.stiffness_matrix) * np.finfo(float).eps * values / values[0]


def rounding_per_stroke(model, rows):
    """What rounding may do to these rows of the motion per stroke: from |D dq| <= rounding |D q| follows |r dq| <= rounding |r/D| |D q|.

    A platform on soft hinges moves by more of it than stiff parts elsewhere.
    """
    weight = np.sqrt(np.diag(model.stiffness_matrix))
    motion = displacement(model, model.input_matrix[:, model.input_index(model.strokes)])
    reach = np.linalg.norm(rows / weight, axis=1)[:, None] * np.linalg.norm(weight[:, None] * motion, axis=0)
    return rounding(model) * reach


@given(mechanisms(), turns())
def test_moving_an_elastic_stage_changes_only_frames(mechanism, move):
    turn, shift = move
    here, there = lumped(mechanism), lumped(moved(mechanism, turn, shift))
    carry = spatial_rotation(turn)
    near(platform_compliance(there), carry @ platform_compliance(here) @ carry.T, rounding(here))
    values = eigen(here).values[:6]
    assert np.all(np.abs(eigen(there).values[:6] - values) <= rounding_of_values(here) * values)
    gauges, strokes = tuple(mechanism.gauges), here.strokes
    difference = static_gain(there, gauges, strokes).values - static_gain(here, gauges, strokes).values
    assert np.all(np.abs(difference) <= rounding_per_stroke(here, here.output[here.output_index(gauges)]))


@examples(8)
@given(mechanisms(), turns())
def test_moving_a_loaded_stage_leaves_its_load_factors(mechanism, move):
    """Gravity turns with the stage; the shares of stiffness that its loads take or add, against the largest of them."""
    here, there = (stability(stage, lumped(stage)) for stage in (mechanism, moved(mechanism, *move)))
    bound = 100.0 * rounding(lumped(mechanism)) * max(1.0 / here.dead, here.stiffens)
    assert abs(1.0 / here.dead - 1.0 / there.dead) <= bound
    assert abs(here.stiffens - there.stiffens) <= bound


@given(actuated_platforms(), turns())
def test_moving_an_ideal_stage_changes_only_frames(mechanism, move):
    turn, shift = move
    here, there = ideal(mechanism), ideal(moved(mechanism, turn, shift))
    carry = spatial_rotation(turn)
    assert there.mobility == here.mobility
    assert len(there.redundant) == len(here.redundant)
    assert len(there.idle) == len(here.idle)
    near(there.jacobian.values, carry @ here.jacobian.values, 1e-9)
    near(there.sensing @ there.jacobian.values, here.sensing @ here.jacobian.values, 1e-9)
    if here.mobility == 6:
        near(there.mapping.values, here.mapping.values @ carry.T, 1e-9)


CYCLE = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])


@given(mechanisms())
def test_relabelling_axes_commutes_with_compliance(mechanism):
    """x, y, z renamed y, z, x: the same numbers in other places."""
    model = lumped(mechanism)
    there = platform_compliance(lumped(moved(mechanism, CYCLE, np.zeros(3))))
    order = [2, 0, 1, 5, 3, 4]
    near(there, platform_compliance(model)[np.ix_(order, order)], rounding(model))


@given(mechanisms())
def test_reciprocity(mechanism):
    """Maxwell and Betti: motions per wrench are symmetric over all bodies; a stroke's motion is the dual of its stack's force."""
    model = lumped(mechanism)
    bodies = tuple(mechanism.bodies)
    chosen = ports(model, bodies, [f"{body}.{name}" for body in bodies for name in FORCES])
    flexibility = chosen.output @ displacement(model, chosen.force)
    weight = np.tile(METRE, len(bodies))
    flexibility = flexibility * weight[:, None] * weight
    near(flexibility, flexibility.T, rounding(model))
    forces = tuple(f"{link}.fx" for link in mechanism.links if is_actuator(mechanism.parts[mechanism.links[link].part]))
    forward = static_gain(model, TWIST, model.strokes).values * METRE[:, None]
    backward = static_gain(model, forces, WRENCH).values * METRE
    rows = model.output[model.output_index(TWIST)] * METRE[:, None]
    assert np.all(np.abs(forward - backward.T) <= rounding_per_stroke(model, rows))


def respond(model, inputs, size):
    """Load vector (m, 1) of these inputs at that size, motion, and every part's deformation."""
    load = np.zeros((len(model.inputs), 1))
    load[model.input_index(inputs), 0] = size
    motion = displacement(model, model.input_matrix @ load)
    return load, motion, part_deformation(model, motion, load)


def strain_energy(model, strains):
    return sum(0.5 * (strain.T @ model.stiffness[name].law @ strain).item() for name, strain in strains.items())


@given(mechanisms())
def test_work_of_a_wrench_is_strain_energy(mechanism):
    model = lumped(mechanism)
    _, motion, strains = respond(model, WRENCH, 1.0)
    work = 0.5 * (model.output[model.output_index(TWIST)] @ motion).sum()
    near(strain_energy(model, strains), work, rounding(model))


@given(mechanisms())
def test_work_of_strokes_is_strain_energy(mechanism):
    """Half of minus the stacks' forces times their strokes is the energy in all parts, against that of the blocked stacks."""
    model, size = lumped(mechanism), 1e-6
    load, motion, strains = respond(model, model.strokes, size)
    forces = model.output_index(tuple(f"{link}.fx" for link in model.imposed))
    tension = model.output[forces] @ motion + model.feedthrough[forces] @ load
    blocked = sum(0.5 * model.stiffness[link].law[0, 0] * size**2 for link in model.imposed)
    assert abs(strain_energy(model, strains) + 0.5 * size * tension.sum()) < rounding(model) * blocked


@given(mechanisms())
def test_stress_resultants_balance(mechanism):
    """On every body the links' forces add up to nothing when strokes act alone (against the blocking forces)."""
    model = lumped(mechanism)
    _, _, strains = respond(model, model.strokes, 1.0)
    forces = [part.operator.T @ part.law @ strains[name] for name, part in model.stiffness.items()]
    blocked = max(model.stiffness[link].law[0, 0] for link in model.imposed)
    assert np.abs(sum(forces)).max() < rounding(model) * blocked


def jointed(mechanism):
    """Hinges become ideal joints, stacks keep their axial spring: what the ideal model knows."""
    parts = {
        name: Restricted(part, (Freedom.X,)) if isinstance(part, Piezo) else Joint(part.intended) for name, part in mechanism.parts.items()
    }
    return replace(mechanism, parts=parts)


@given(actuated_platforms())
def test_ideal_is_lumped_with_ideal_joints(mechanism):
    """With rigid ideal joints nothing is lost: strokes the platform can follow move it as the ideal model says."""
    kinematics, model = ideal(mechanism), lumped(jointed(mechanism))
    feasible = kinematics.actuation @ kinematics.inverse
    gain = static_gain(model, TWIST, kinematics.actuators).values @ feasible
    near(gain * METRE[:, None], kinematics.jacobian.values @ feasible * METRE[:, None], 1e-8)


def towards_ideal(mechanism, step):
    """Locked freedoms of hinges stiffer, free ones softer, by the factor `step`."""
    parts = {}
    for name, part in mechanism.parts.items():
        if isinstance(part, Piezo):
            parts[name] = Restricted(part, (Freedom.X,))
            continue
        size = {freedom: 1e-8 if freedom in others((Freedom.RX, Freedom.RY, Freedom.RZ)) else 1e-3 for freedom in Freedom}
        entries = [size[freedom] * (1.0 / step if freedom in part.intended else step) for freedom in Freedom]
        parts[name] = ComplianceMatrix(tuple(map(tuple, np.diag(entries).tolist())), part.intended)
    return replace(mechanism, parts=parts)


@given(actuated_platforms())
def test_ideal_is_the_limit_of_lumped(mechanism):
    """Stacks as they are, hinges stiffer and softer: the distance d = c s/(1 + c s) falls with the step s, ever more in proportion."""
    kinematics = ideal(mechanism)
    feasible = kinematics.actuation @ kinematics.inverse
    expected = kinematics.jacobian.values @ feasible * METRE[:, None]
    distances = []
    for step in (1e-3, 1e-4):
        gain = static_gain(lumped(towards_ideal(mechanism, step)), TWIST, kinematics.actuators).values @ feasible * METRE[:, None]
        distances.append(np.abs(gain - expected).max() / np.abs(expected).max())
    assert distances[0] < 0.2
    assert distances[1] < 0.1 * distances[0] * (1.0 + 4.0 * distances[0]) + 1e-8


@given(rosettes())
def test_threefold_symmetry_is_isotropic_in_plane(mechanism):
    """Three or more equal units around z: the in-plane stiffness has no direction, and x, y do not couple with z and yaw."""
    model = lumped(mechanism)
    compliance = platform_compliance(model)
    tolerance = rounding(model) * np.abs(compliance).max()
    x, y, z, rx, ry, rz = range(6)
    pairs = [(compliance[x, x], compliance[y, y]), (compliance[rx, rx], compliance[ry, ry])]
    pairs += [(compliance[x, ry], -compliance[y, rx]), (compliance[x, rx], compliance[y, ry])]
    zeros = [compliance[row, column] for row in (x, y, rx, ry) for column in (z, rz)] + [compliance[x, y], compliance[rx, ry]]
    for first, second in pairs:
        assert abs(first - second) < tolerance
    assert max(map(abs, zeros)) < tolerance


def numbers(value, path=()):
    """Paths of all numbers of a description that may be varied one by one: not Poisson's ratio, directions, or a stated matrix."""
    if isinstance(value, float):
        yield path
    elif is_dataclass(value):
        for field in fields(value):
            if field.name not in {"poisson", "along", "bends", "up", "compliance", "gravity", "damping"}:
                yield from numbers(getattr(value, field.name), (*path, field.name))
    elif isinstance(value, tuple):
        for index, item in enumerate(value):
            yield from numbers(item, (*path, str(index)))
    elif hasattr(value, "items"):
        for name, item in value.items():
            yield from numbers(item, (*path, name))


def at(value, path):
    for name in path:
        value = value[int(name)] if isinstance(value, tuple) else value[name] if hasattr(value, "items") else getattr(value, name)
    return value


def varied(mechanism, changes):
    """The stage with the numbers at these paths replaced."""
    for path, value in changes.items():
        mechanism = replace_member(mechanism, path, value)
    return mechanism


any_stage = st.one_of(mechanisms(), platforms().map(lambda drawn: drawn[0]), rosettes())
picks = st.lists(st.integers(0, 10**6), min_size=1, max_size=12)


@given(any_stage, picks, st.lists(st.floats(-0.02, 0.02), min_size=3, max_size=3))
def test_a_batch_is_a_loop(mechanism, picked, steps):
    """Arrays in place of numbers give, design by design, what single numbers give."""
    paths = list(numbers(mechanism))
    chosen = {paths[number % len(paths)] for number in picked}
    factors = {path: 1.0 + np.roll(steps, number) for number, path in enumerate(sorted(chosen))}
    batch = lumped(varied(mechanism, {path: at(mechanism, path) * factor for path, factor in factors.items()}))
    for design in range(3):
        single = lumped(varied(mechanism, {path: at(mechanism, path) * float(factor[design]) for path, factor in factors.items()}))
        for name in ("stiffness_matrix", "inertia_matrix", "input_matrix", "output", "base_inertia"):
            found, expected = getattr(batch, name), getattr(single, name)
            near(found[design] if found.ndim == 3 else found, expected, 1e-12)


@given(actuated_platforms(), picks, st.lists(st.floats(-0.02, 0.02), min_size=3, max_size=3))
def test_an_ideal_batch_is_a_loop(mechanism, picked, steps):
    """Where a small change of one number may break a closed loop's fit, only the platform's own numbers and poses are varied."""
    paths = [path for path in numbers(mechanism) if path[0] in {"placements", "bodies"} or path[-2:-1] == ("at",)]
    chosen = {paths[number % len(paths)] for number in picked}
    factors = {path: 1.0 + np.roll(steps, number) for number, path in enumerate(sorted(chosen))}
    batch = ideal(varied(mechanism, {path: at(mechanism, path) * factor for path, factor in factors.items()}))
    for design in range(3):
        single = ideal(varied(mechanism, {path: at(mechanism, path) * float(factor[design]) for path, factor in factors.items()}))
        for found, expected in ((batch.jacobian.values, single.jacobian.values), (batch.sensing, single.sensing)):
            near(found[design] if found.ndim == 3 else found, expected, 1e-9)


@given(any_stage, st.integers(0, 10**6))
def test_complex_step_is_the_finite_difference(mechanism, picked):
    """dK/dp and dM/dp by complex step against central differences of one part in ten thousand."""
    paths = list(numbers(mechanism))
    path = paths[picked % len(paths)]
    value = at(mechanism, path)
    length = 1e-4 * max(abs(value), 1e-3)
    slope = lumped(varied(mechanism, {path: value + 1e-30j * length}))
    above, below = (lumped(varied(mechanism, {path: value + sign * length})) for sign in (1.0, -1.0))
    for name in ("stiffness_matrix", "inertia_matrix", "input_matrix"):
        exact = np.imag(getattr(slope, name)) / 1e-30
        difference = 0.5 * (getattr(above, name) - getattr(below, name))
        assert np.abs(exact - difference).max() <= 1e-5 * np.abs(difference).max() + 1e-10 * np.abs(getattr(above, name)).max()


def test_the_helpers_reach_every_kind_of_number():
    """Paths into parts, bodies, links, units, places and gauges are among what is varied."""
    from flexstage.cases.double_triangle import double_triangle

    paths = set(numbers(double_triangle()))
    for path in (
        ("parts", "neck", "thickness"),
        ("parts", "neck", "profile", "length"),
        ("materials", "steel", "young"),
        ("bodies", "platform", "solids", "plate", "size", "2"),
        ("units", "vertical", "links", "pivot", "at", "0"),
        ("placements", "B1-B3", "pattern", "radius"),
        ("gauges", "S1-S3", "pattern", "height"),
    ):
        assert path in paths
    assert isinstance(varied(double_triangle(), {("parts", "neck", "thickness"): 1e-3}), Mechanism)
    assert stack((1.0, 2.0)).shape == (2,)


@given(st.integers(0, 2**32 - 1))
def test_forces_through_the_centre_of_stiffness_turn_nothing(seed):
    """Springs that uncouple at a point have their centre there, in all three coordinates, however unlike they are."""
    random = np.random.default_rng(seed)
    halves = random.normal(size=(2, 3, 3))
    own = np.zeros((6, 6))
    own[:3, :3], own[3:, 3:] = (half @ half.T + np.eye(3) for half in halves)
    centre = random.normal(size=3)
    carry = transport(centre)
    stiffness = carry.T @ own @ carry
    np.testing.assert_allclose(centre_of_stiffness(stiffness), centre, atol=1e-11)
    force = random.normal(size=3)
    moved = np.linalg.solve(stiffness, np.concatenate([force, np.cross(centre, force)]))
    np.testing.assert_allclose(moved[3:], 0.0, atol=1e-11)
