"""Critical loads against small steps along the path: the first limit point or bifurcation, whatever the load's size, units and parts.

The path of reference is followed here by arc length in equal small steps, and negative eigenvalues are counted in all of it.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import flexstage as fs
from flexstage.base.finding import LowerBoundError
from flexstage.mechanism.mechanism import Link, Mechanism
from flexstage.models.nonlinear.elements.condense import system
from flexstage.models.nonlinear.elements.fixed_coordinates import no_coordinates
from flexstage.models.nonlinear.equilibrium import equilibrium
from flexstage.models.nonlinear.graph import System, advance, assemble
from flexstage.models.nonlinear.paths.critical_load import Kind, critical_load, unstable_motions
from flexstage.models.nonlinear.paths.load_path import continuation
from flexstage.models.nonlinear.stage import Nonlinear, nonlinear
from flexstage.models.nonlinear.state import Loads, SolverOptions, Status
from flexstage.parts.body import Body, Inertia
from flexstage.parts.leaf import Leaf, LeafSection
from flexstage.parts.material import Material
from flexstage.parts.rod import Rod

STEEL = Material(young=200e9, poisson=0.3, density=0.0)
DOWN = "platform.fz"


def legs(part: Leaf | Rod, azimuths: np.ndarray, slopes: np.ndarray, *, radius: float = 2e-3) -> Mechanism:
    """A platform on legs that rise towards it: an arch of two, a dome of three or four; upright columns at a slope of 90 degrees."""
    length = float(part.length)
    body = Body(mass=0.02, inertia=Inertia(1e-6, 1e-6, 1e-6), centre=(0.0, 0.0, 0.0), reference=(0.0, 0.0, 0.0))
    links: dict[str, Link] = {}
    for number, (azimuth, slope) in enumerate(zip(azimuths, slopes, strict=True)):
        out = np.array([np.cos(azimuth), np.sin(azimuth), 0.0])
        along = np.array([0.0, 0.0, np.sin(slope)]) - np.cos(slope) * out
        across = np.array([-out[1], out[0], 0.0])
        links[f"leg{number}"] = Link(("ground", "platform"), "leg", tuple(radius * out - 0.5 * length * along), tuple(along), tuple(across))
    return Mechanism("", {"steel": STEEL}, parts={"leg": part}, bodies={"platform": body}, links=links, gravity=(0.0, 0.0, 0.0))


def random_legs(seed: int) -> Mechanism:
    """Arches, symmetric or skew, of leaves; domes of three and four rods, with double eigenvalues; columns that buckle all round."""
    random = np.random.default_rng([7, seed])
    length, kind = 0.05, seed % 5
    slope = random.uniform(0.01, 0.08)
    leaf = Leaf("steel", length, random.uniform(0.2e-3, 0.8e-3), random.uniform(4e-3, 20e-3), section=LeafSection.BEAM)
    rod = Rod("steel", length=length, diameter=random.uniform(0.3e-3, 1.2e-3))
    if kind < 2:
        return legs(leaf, np.array([0.0, np.pi]), slope * np.array([1.0, 1.0 if kind == 0 else random.uniform(0.8, 1.0)]))
    if kind < 4:
        return legs(rod, 2.0 * np.pi * np.arange(kind + 1) / (kind + 1), np.full(kind + 1, slope), radius=random.uniform(1e-3, 6e-3))
    return legs(rod, 0.5 * np.pi * np.arange(4), np.full(4, 0.5 * np.pi), radius=10e-3)


def lowest(model: Nonlinear, here: System) -> tuple[int, float]:
    """Negative eigenvalues, and the lowest over the scale of translations and rotations."""
    matrix = here.stiffness[0]
    scale = np.tile([1.0 / model.size] * 3 + [1.0] * 3, len(model.bodies))
    values = np.linalg.eigvalsh(0.5 * (matrix + matrix.T) / scale / scale[:, None])
    inside = 0
    for bent in here.bent:
        own = system(bent.tangent)[:, 0]
        own[:, -6:] *= -1.0
        inside += int(np.sum(np.linalg.eigvalsh(0.5 * (own + np.swapaxes(own, -1, -2))) < 0.0)) - 6 * len(own)
    return int(np.sum(values < 0.0)) + inside, float(values[0])


def first_event(model: Nonlinear, step: float, count: int) -> float:
    """The load at which the first eigenvalue vanishes along fz, by arc length in equal steps of bodies over the size; NaN if none does."""
    index = [channel.name for channel in model.inputs].index(DOWN)
    scale = np.tile([1.0 / model.size] * 3 + [1.0] * 3, len(model.bodies))
    pose, load, last = equilibrium(model).pose, 0.0, None

    def loads(size: float) -> Loads:
        inputs = np.zeros((1, len(model.inputs)))
        inputs[0, index] = size
        return Loads(inputs, np.zeros((1, 3)), np.ones(1))

    held, before = no_coordinates(1), (0.0, 0.0)
    for number in range(count):
        here = assemble(model, pose, loads(load), held)
        motions, value = lowest(model, here)
        if motions:
            there, was = before
            return there + (load - there) * was / (was - value)
        before, moved = (load, value), np.zeros(model.freedoms)
        for correction in range(20):
            here = assemble(model, pose, loads(load), held)
            rate = np.linalg.solve(here.stiffness[0], (here.residual - assemble(model, pose, loads(load + 1.0), held).residual)[0])
            own = np.linalg.solve(here.stiffness[0], -here.residual[0])
            if correction:
                change = float(-(scale * moved) @ (scale * own) / ((scale * moved) @ (scale * rate)))
            else:
                sign = -1.0 if last is None else float(np.sign((scale * rate) @ last))
                change, own = float(sign * step / np.linalg.norm(scale * rate)), 0.0 * own
            moved, load = moved + own + change * rate, load + change
            pose, _ = advance(model, pose, here.bent, (own + change * rate)[None], np.ones(1))
            if np.linalg.norm(scale * own) < 1e-11 and correction:
                break
        last = scale * moved
        assert number < count
    return np.nan


def factors(model: Nonlinear, sizes: np.ndarray) -> list[float]:
    """The critical load by each size of the load; NaN where the path leaves the law of the material."""
    found: list[float] = []
    for size in sizes:
        try:
            found.append(critical_load(model, {DOWN: -float(size)}, weight=0.0).factor * -float(size))
        except LowerBoundError:
            found.append(np.nan)
    return found


@pytest.mark.parametrize("seed", [1, 4, *(pytest.param(each, marks=pytest.mark.full) for each in (0, 2, 3, *range(5, 200)))])
def test_the_critical_load_is_the_first_event_of_small_steps_whatever_the_size_of_the_load(seed: int):
    model = nonlinear(random_legs(seed))
    found = np.array(factors(model, np.geomspace(1e-3, 1e3, 20 if seed > 4 else 3)))
    if np.isnan(found).any():
        assert np.isnan(found).all()
        return
    assert np.ptp(found) < 1e-3 * np.abs(found[0])
    assert first_event(model, 1e-6 if seed % 5 == 4 else 5e-5, 10000) == pytest.approx(found[0], rel=1e-3)


@pytest.mark.parametrize("seed", [3, *(pytest.param(each, marks=pytest.mark.full) for each in (2, *range(6, 40)))])
def test_units_change_no_critical_load(seed: int):
    """Lengths by 1.6, the modulus by 0.37: loads by 0.37 * 1.6^2, within the 1e-6 of an event's place; NaN in both or none."""
    drawn = random_legs(seed)
    length, stiff = 1.6, 0.37
    part = drawn.parts["leg"]
    assert isinstance(part, Leaf | Rod)
    sizes = {name: length * getattr(part, name) for name in ("length", "thickness", "width", "diameter") if hasattr(part, name)}
    links = {name: replace(link, at=tuple(length * np.array(link.at))) for name, link in drawn.links.items()}
    steel = replace(STEEL, young=stiff * 200e9)
    scaled = replace(drawn, materials={"steel": steel}, parts={"leg": replace(part, **sizes)}, links=links)
    one, other = (factors(nonlinear(each), np.array([1.0]))[0] for each in (drawn, scaled))
    assert other == pytest.approx(stiff * length**2 * one, rel=1e-6, nan_ok=True)


def halved(drawn: Mechanism) -> Mechanism:
    """The same stage with every leg in two halves and a body without mass between them."""
    part = drawn.parts["leg"]
    assert isinstance(part, Rod)
    bodies, links = dict(drawn.bodies), dict[str, Link]()
    for name, link in drawn.links.items():
        bodies[f"{name}middle"] = Body(mass=0.0, inertia=Inertia(0.0, 0.0, 0.0), centre=link.at, reference=link.at)
        along = np.array(link.along, dtype=float)
        shift = 0.25 * float(part.length) * along / np.linalg.norm(along)
        for joins, side in ((("ground", f"{name}middle"), -1.0), ((f"{name}middle", "platform"), 1.0)):
            links[f"{name}{side:+.0f}"] = replace(link, joins=joins, at=tuple(np.array(link.at) + side * shift))
    return replace(drawn, parts={"leg": replace(part, length=0.5 * part.length)}, bodies=bodies, links=links)


@pytest.mark.parametrize("seed", [2, 4, *(pytest.param(each, marks=pytest.mark.full) for each in range(7, 60) if each % 5 > 1)])
def test_a_rod_in_two_halves_has_the_same_critical_load(seed: int):
    drawn = random_legs(seed)
    one, other = (factors(nonlinear(each), np.array([1.0]))[0] for each in (drawn, halved(drawn)))
    assert np.isnan(one) == np.isnan(other)
    assert other == pytest.approx(one, rel=1e-5, nan_ok=True)


def test_no_equilibrium_beyond_a_snap_is_taken_for_the_deflection_under_a_load():
    """A dome bears 0.95 of its limit load; beyond it the equilibrium of the dome that has snapped through is refused."""
    stage = random_legs(2)
    (limit,) = factors(nonlinear(stage), np.array([1.0]))
    assert fs.operating_point(stage, loads={DOWN: 0.95 * limit}).sag.at("platform", "z") < 0.0
    beyond = equilibrium(nonlinear(stage), {DOWN: 1.5 * limit}, options=SolverOptions(past=True))
    assert beyond.converged
    assert not unstable_motions(beyond)
    refused = fs.equilibrium(fs.nonlinear(stage), {DOWN: np.array([0.95, 1.5]) * limit})
    assert refused.converged.tolist() == [True, False]
    assert "at 0.66" in refused.reasons[1]
    with pytest.raises(fs.DesignError, match=r"at 0\.66\d* of the loads the stage snaps or buckles"):
        fs.operating_point(stage, loads={DOWN: 1.5 * limit})


def test_just_below_its_critical_value_a_load_has_the_stable_equilibrium_of_its_path():
    """At 0.99 of it Newton's method goes from the drawn position to another equilibrium, which is not stable."""
    model = nonlinear(random_legs(17))
    (load,) = factors(model, np.array([1.0]))
    found, before = (equilibrium(model, {DOWN: share * load}, weight=0.0) for share in (0.99, 0.98))
    assert not unstable_motions(found)
    assert found.twist() == pytest.approx(equilibrium(model, {DOWN: 0.99 * load}, weight=0.0, start=before).twist(), rel=1e-8, abs=1e-12)


def test_a_trace_with_long_steps_has_the_events_of_one_with_short_steps():
    """A dome through its snap: a limit point, and another one where it takes load again; nothing else."""
    model, load = nonlinear(random_legs(2)), {DOWN: -1.0}
    long, short = (continuation(model, load, step=step, points=count) for step, count in ((0.05, 4), (0.005, 40)))
    assert [each.kind for each in long.events] == [Kind.LIMIT, Kind.LIMIT]
    assert [each.value for each in long.events] == pytest.approx([each.value for each in short.events], rel=5e-3)
    assert not long.motions[[0, -1]].any()


def test_a_double_eigenvalue_is_counted_twice():
    """A square of columns sways both ways at once: the determinant keeps its sign, two motions lower the potential.

    The upright state beyond is not returned unless limits may be passed.
    """
    model = nonlinear(random_legs(4))
    (load,) = factors(model, np.array([1.0]))
    loads = {DOWN: np.array([0.999, 1.001]) * load}
    assert unstable_motions(equilibrium(model, loads, options=SolverOptions(past=True))).tolist() == [0, 2]
    found = equilibrium(model, loads)
    assert found.status.tolist() == [Status.CONVERGED, Status.CRITICAL]
    assert np.isnan(found.displacement()[1]).all()
    assert found.reached[1] * 1.001 == pytest.approx(1.0, rel=1e-4)


def cantilever() -> Mechanism:
    """A platform at the end of a slender rod along x."""
    body = Body(mass=0.02, inertia=Inertia(1e-6, 1e-6, 1e-6), centre=(0.1, 0.0, 0.0), reference=(0.1, 0.0, 0.0))
    link = Link(("ground", "platform"), "rod", (0.05, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0))
    rod = Rod("steel", length=0.1, diameter=0.5e-3)
    return Mechanism("", {"steel": STEEL}, parts={"rod": rod}, bodies={"platform": body}, links={"rod": link}, gravity=(0.0, 0.0, 0.0))


def test_a_law_of_small_motions_is_10_per_cent_off_where_the_range_of_a_6x6_ends():
    """A cantilever under P L^2 = E I: 0.3017 L and 0.4613 rad (Bisshopp & Drucker), where linear theory has 1/3 and 1/2."""
    unit = 200e9 * np.pi * 0.5e-3**4 / 64.0 / 0.1**2
    state = fs.equilibrium(fs.nonlinear(cantilever()), {"platform.fy": unit})
    assert state.displacement()[1] / 0.1 == pytest.approx(0.3017, abs=2e-4)
    assert state.rotation()[2] == pytest.approx(0.4613, abs=2e-4)


@pytest.mark.parametrize(("load", "end"), [("platform.fx", 0.3 * 0.05 * 1e4), ("platform.mx", 0.46 * 50.0)])
def test_a_load_is_bounded_where_the_6x6_of_a_link_ends(load: str, end: float):
    """Displaced along its axis by 0.3 of the stage's extent (50 mm from its centre to the platform), or turned about it by 0.46 rad."""
    spring = fs.Spring(diagonal=(1e4, 1e4, 1e4, 50.0, 50.0, 50.0))
    held = replace(cantilever(), parts={"rod": spring})
    with pytest.raises(LowerBoundError, match="rod is deformed beyond the range of its 6x6") as error:
        critical_load(nonlinear(held), {load: 1.0}, weight=0.0)
    assert error.value.bound == pytest.approx(end, rel=1e-4)
