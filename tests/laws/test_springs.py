"""Laws of springs on random stages: they are their stiffness, negative ones too, as long as the sum of all holds."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

import flexstage as fs
from flexstage.analysis.linear_statics.deflection import deflection
from flexstage.analysis.linear_statics.statics import statics
from flexstage.analysis.loaded.load_effect import load_effect
from flexstage.analysis.loaded.stability import prestress, stability
from flexstage.base.finding import DesignError
from flexstage.beams.compliance import stiffness
from flexstage.beams.mass import mass
from flexstage.mechanism.assembly.expand import expand
from flexstage.mechanism.checks import check
from flexstage.mechanism.mechanism import Link, Mechanism
from flexstage.mechanism.store import dumps, loads
from flexstage.models.batch.engine import Status, plan, platform_modes
from flexstage.models.ideal import ideal
from flexstage.models.linear.eigen import eigen
from flexstage.models.lumped import lumped
from flexstage.models.nonlinear.elements.hinge import Ends, _nudge, deform  # pyright: ignore[reportPrivateUsage]
from flexstage.models.nonlinear.equilibrium import equilibrium
from flexstage.models.nonlinear.linearise import linearise
from flexstage.models.nonlinear.stage import nonlinear
from flexstage.parts.body import Body, Inertia
from flexstage.parts.compliance_matrix import ComplianceMatrix
from flexstage.parts.spring import Spring
from flexstage.spatial.frame import COMPONENTS
from flexstage.spatial.rotation import exponential
from tests.conftest import examples
from tests.laws.strategies import mechanisms, orientations, places


def added(stage, **parts):
    """The stage with more links between ground and platform, each with its part and pose; twists are given where they were."""
    centre = tuple(float(part) for part in expand(stage).bodies["platform"].reference)
    stage = replace(stage, bodies={**stage.bodies, "platform": replace(stage.bodies["platform"], reference=centre)})
    links = {name: Link(("ground", "platform"), name, at, along, bends) for name, (_, at, along, bends) in parts.items()}
    return replace(stage, parts={**stage.parts, **{name: each[0] for name, each in parts.items()}}, links={**stage.links, **links})


@st.composite
def matrices(draw):
    """A symmetric 6x6 of any signs, rotations over a metre."""
    half = np.random.default_rng(draw(st.integers(0, 2**32 - 1))).normal(size=(6, 6)) * 1e3
    return half + half.T


@given(mechanisms())
@examples(12)
def test_a_spring_with_the_stiffness_of_a_given_part_is_that_part(stage):
    givens = {name: part for name, part in stage.parts.items() if isinstance(part, ComplianceMatrix)}
    assume(givens)
    springs = {name: Spring(matrix=tuple(map(tuple, stiffness(part, None).tolist())), free=part.free) for name, part in givens.items()}
    massless = replace(stage, parts={**stage.parts, **{name: replace(part, mass=0.0) for name, part in givens.items()}})
    swapped = replace(stage, parts={**stage.parts, **springs})
    one, other = (lumped(each) for each in (massless, swapped))
    np.testing.assert_allclose(other.stiffness_matrix, one.stiffness_matrix, rtol=1e-12, atol=1e-12 * np.max(one.stiffness_matrix))
    np.testing.assert_array_equal(other.inertia_matrix, one.inertia_matrix)
    assert [link.part.intended for link in expand(swapped).links.values()] == [link.part.intended for link in expand(stage).links.values()]


@given(mechanisms(), matrices(), places, orientations())
@examples(12)
def test_a_spring_and_its_negative_cancel(stage, matrix, at, pose):
    whole = tuple(map(tuple, matrix.tolist()))
    opposite = tuple(map(tuple, (-matrix).tolist()))
    both = added(stage, plus=(Spring(matrix=whole), at, *pose), minus=(Spring(matrix=opposite), at, *pose))
    assert not check(both)
    assert loads(dumps(both)) == both
    one, other = lumped(stage), lumped(both)
    np.testing.assert_allclose(other.stiffness_matrix, one.stiffness_matrix, rtol=1e-12, atol=1e-13 * np.max(one.stiffness_matrix))


@given(mechanisms(), st.sampled_from((0.9, 0.999, 1.001, 5.0)))
@examples(12)
def test_a_stage_bears_as_much_negative_stiffness_as_it_has(stage, share):
    model = lumped(stage)
    centre = tuple(float(part) for part in expand(stage).bodies["platform"].reference)
    held = 1.0 / statics(model).compliance.values[1, 1]
    magnet = added(stage, magnet=(Spring(stiffness=-share * held), centre, (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)))
    if share < 1.0:
        softer = 1.0 / statics(lumped(magnet)).compliance.values[1, 1]
        np.testing.assert_allclose(softer, (1.0 - share) * held, rtol=1e-6)
        return
    with pytest.raises(
        DesignError, match=rf"magnet: the nominal position is unstable: .* in x \(stable limit .*, {1.0 / share:.4g} times this stiffness\)"
    ):
        lumped(magnet)


def held(**springs: Spring) -> Mechanism:
    """A platform on a spring at the origin, with others along x at x = -10 mm."""
    stiff = Spring(diagonal=(1e6, 2e4, 1e6, 1e4, 1e4, 1e4))
    links = {"stiff": Link(("ground", "platform"), "stiff", (0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0))}
    links |= {name: Link(("ground", "platform"), name, (-0.01, 0.0, 0.0), (1.0, 0.0, 0.0)) for name in springs}
    body = Body(mass=1.0, centre=(0.0, 0.0, 0.0), inertia=Inertia(1e-3, 1e-3, 1e-3))
    return Mechanism("held", parts={"stiff": stiff, **springs}, bodies={"platform": body}, links=links, gravity=(0.0, 0.0, 0.0))


def test_a_preload_is_a_pair_of_forces_and_says_so():
    stage = held(coil=Spring(stiffness=1e3, length=0.02, free_length=0.025))
    found = deflection(stage, lumped(stage))
    assert found.by_cause.columns == ("own weight", "preload of coil")
    np.testing.assert_allclose(found.by_cause.at("platform.x", "preload of coil"), 5.0 / (1e6 + 1e3), rtol=1e-9)
    assert deflection(held(coil=Spring(stiffness=1e3)), lumped(stage)).by_cause.columns == ("own weight",)


@pytest.mark.parametrize("preload", [10.0, -10.0])
def test_a_preload_softens_or_stiffens_across_by_force_over_length(preload):
    """A strut of length L under F, turning about both ends, the far one on k: it falls over at F = k L."""
    stage = held(strut=Spring(stiffness=0.0, length=0.02, preload=preload))
    found = stability(stage, lumped(stage))
    across = 2e4 * 0.02 / 10.0
    if preload > 0.0:
        np.testing.assert_allclose(found.dead, across, rtol=2e-3)  # what else gives: the platform's tilt on 1e4 N m/rad
    else:
        np.testing.assert_allclose(found.stiffens, 1.0 / across, rtol=2e-3)


def test_freedoms_that_nothing_holds_are_named():
    stage = held()
    loose = replace(stage, parts={"stiff": Spring(stiffness=1e6)})
    with pytest.raises(DesignError, match="singular: 5 motion"):
        lumped(loose)
    assert ideal(stage).mobility == 6
    locked = replace(stage, links={"stiff": replace(stage.links["stiff"], free=())})
    assert ideal(locked).mobility == 0


def test_designs_that_are_unstable_have_no_numbers():
    stage = held(magnet=Spring(stiffness=np.array([-1e3, -2e6, -5e5])))
    model = lumped(stage)
    frequencies = eigen(model).values
    assert np.isnan(frequencies[1]).all()
    assert np.isfinite(frequencies[[0, 2]]).all()
    assert np.isnan(statics(model).compliance.values[1]).all()
    family = plan(held(magnet=Spring(stiffness=-1e3)), ("parts.magnet.stiffness",))
    found = platform_modes(family, np.array([[-1e3], [-2e6], [-5e5]]))
    assert found.status.tolist() == [Status.WHOLE, Status.NONE, Status.WHOLE]
    lowest = np.sort(np.sqrt(frequencies[0]))[: found.frequencies.shape[1]] / (2.0 * np.pi)
    np.testing.assert_allclose(np.sort(found.frequencies[0]), lowest, rtol=1e-9)


@given(st.floats(0.01, 0.1), st.floats(0.1, 5.0))
def test_the_mass_of_a_spring_is_that_of_a_straight_line(length, weight):
    matrix = mass(Spring(stiffness=1.0, length=length, mass=weight), None)
    whole = matrix[:6, :6] + matrix[:6, 6:] + matrix[6:, :6] + matrix[6:, 6:]
    turning = weight * length**2 / 12.0
    np.testing.assert_allclose(whole, np.diag([weight, weight, weight, 0.0, turning, turning]), atol=1e-14)
    np.testing.assert_allclose(matrix[6, 6], weight / 3.0)  # Rayleigh: a third of the spring's mass


@pytest.mark.parametrize(
    ("spring", "what"),
    [
        (Spring(), "parts.spring: stiffness missing"),
        (Spring(stiffness=1.0, diagonal=(1.0,) * 6), "parts.spring: both stiffness and diagonal specified"),
        (Spring(stiffness=1.0, preload=2.0), "parts.spring.length: length missing: with a preload"),
        (Spring(stiffness=1.0, preload=2.0, length=0.1, free_length=0.1), "parts.spring.free_length: preload specified too"),
        (
            Spring(matrix=tuple(map(tuple, np.triu(np.ones((6, 6))).tolist()))),
            "parts.spring.matrix at index 0, 1: not symmetric: 1 and 0 SI",
        ),
    ],
)
def test_bad_springs_are_told(spring, what):
    for stage in (replace(held(), parts={"stiff": spring, "spring": spring}), held(spring=spring)):
        assert any(str(finding).startswith(what) for finding in check(stage))


@pytest.mark.parametrize("force", [40.0, -40.0])
@pytest.mark.parametrize("stated", ["preload", "free_length"])
def test_the_loaded_stage_has_the_springs_force_over_its_length(force, stated):
    """Across a spring of length L that pushes with F: k - F / L at its loaded length, what else the platform's turning compliance takes."""
    own = {"preload": force} if stated == "preload" else {"free_length": 0.02 + force / 1e3}
    stage = held(strut=Spring(stiffness=1e3, length=0.02, **own))
    moved = equilibrium(nonlinear(stage)).displacement()[0]
    across = 2e4 - (force - 1e3 * moved) / (0.02 + moved)
    about = linearise(equilibrium(nonlinear(stage)))
    found = 1.0 / statics(about).compliance.values[1, 1]
    np.testing.assert_allclose(found, across, rtol=1e-5)  # the tilt under the lever L / 2 on 1e4 N m/rad
    near = 1.0 / statics(prestress(stage, lumped(stage))).compliance.values[1, 1]
    np.testing.assert_allclose(near - 2e4, found - 2e4, rtol=2e-2)  # the drawn length instead of the loaded one
    effect = load_effect(stage)
    assert effect is not None
    np.testing.assert_allclose(effect.change, found / 2e4 - 1.0, rtol=1e-2)


def test_a_mass_on_a_spring_with_a_length_is_a_pendulum():
    """F / l of the loaded spring and the stiffness that guides it: f = ((k + m g / l) / m)^1/2 / 2 pi."""
    rate, guide, weight, length = 1e4, 100.0, 9.80665, 0.1
    stage = held(coil=Spring(stiffness=rate, length=length))
    parts = {**stage.parts, "stiff": Spring(diagonal=(0.0, guide, guide, 1e5, 1e5, 1e5))}
    links = {**stage.links, "coil": replace(stage.links["coil"], at=(-length / 2.0, 0.0, 0.0))}
    hung = replace(stage, parts=parts, links=links, gravity=(weight, 0.0, 0.0))
    found = fs.analyse(hung).modes
    expected = np.sqrt(guide + weight / (length + weight / rate)) / (2.0 * np.pi)
    np.testing.assert_allclose(found.frequencies[:2], expected, rtol=1e-5)


def test_a_spring_pulls_along_the_line_of_its_ends_however_far_they_move():
    """Held anywhere, the platform carries k (l - L) along the line from the spring's one end to the other."""
    rate, length, push, along = 2e3, 0.03, 5.0, np.array([2.0, -1.0, 2.0]) / 3.0
    stage = held(strut=Spring(stiffness=rate, length=length, preload=push))
    pose = Link(("ground", "platform"), "strut", (0.0, 0.0, 0.0), tuple(along.tolist()), (1.0, 2.0, 0.0))
    weak = replace(stage, parts={**stage.parts, "stiff": Spring(diagonal=(1.0,) * 6)}, links={**stage.links, "strut": pose})
    rng = np.random.default_rng(7)
    shift, angle = 0.3 * length * rng.normal(size=(8, 3)), 0.4 * rng.normal(size=(8, 3))
    values = dict(zip((f"platform.{each}" for each in COMPONENTS), np.concatenate([shift, angle], axis=-1).T, strict=True))
    bare = replace(weak, links={"stiff": stage.links["stiff"]})
    with_spring, without = (equilibrium(nonlinear(each), hold=values).reactions[:, :3] for each in (weak, bare))
    line = shift + 0.5 * length * (exponential(angle) @ along + along)
    span = np.linalg.norm(line, axis=-1, keepdims=True)
    np.testing.assert_allclose(with_spring - without, (rate * (span - length) - push) * line / span, atol=1e-9 * rate * length)


@given(st.integers(0, 2**32 - 1))
@examples(8)
def test_rows_of_a_springs_deformation_are_its_slopes(seed):
    rng = np.random.default_rng(seed)
    model = nonlinear(held(strut=Spring(stiffness=1e3, length=0.02, preload=5.0)))
    turns = exponential(0.5 * rng.normal(size=(2, 2, 1, 3)))
    ends = Ends(0.01 * rng.normal(size=(2, 1, 3)), turns[0], 0.01 * rng.normal(size=(2, 1, 3)), turns[1])
    _, rows = deform(model.hinges, ends)
    stepped, _ = deform(model.hinges, _nudge(ends))
    np.testing.assert_allclose(np.moveaxis(np.imag(stepped) / 1e-30, 0, -1), rows, rtol=1e-9, atol=1e-12)
