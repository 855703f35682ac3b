"""Random guides under loads far beyond use: every search ends in an equilibrium, or says why not; none is wrong.

One to four leaves of t / L from 0.002 to 0.1 and b / L from 0.05 to 1, rods or notches, side by side or at random; forces to 200 and
moments to 30 in units of the softest one's E I / L^2 and E I / L, ten times what else is asked of guides.
"""

from __future__ import annotations

import numpy as np
import pytest

from flexstage.mechanism.mechanism import Link, Mechanism
from flexstage.models.nonlinear.equilibrium import State, equilibrium
from flexstage.models.nonlinear.graph import assemble
from flexstage.models.nonlinear.paths.critical_load import unstable_motions
from flexstage.models.nonlinear.stage import Nonlinear, nonlinear
from flexstage.models.nonlinear.state import SolverOptions, Status
from flexstage.parts.body import Body, Inertia
from flexstage.parts.leaf import Leaf
from flexstage.parts.material import Material
from flexstage.parts.notch import Notch
from flexstage.parts.part import Part, span
from flexstage.parts.profile import Circular
from flexstage.parts.rod import Rod
from flexstage.spatial.rotation import exponential

STEEL = Material(young=200e9, poisson=0.3, density=7800.0)
COMPONENTS = ("fx", "fy", "fz", "mx", "my", "mz")
STEPS = np.linspace(0.0, 1.0, 65)[1:]


def one_part(rng: np.random.Generator, kind: str) -> Part:
    length = 0.1 * np.exp(rng.uniform(-0.4, 0.4))
    if kind == "leaf":
        thickness = np.exp(rng.uniform(np.log(0.002), np.log(0.1)))
        width = np.exp(rng.uniform(np.log(max(0.05, 1.5 * thickness)), 0.0))
        return Leaf("steel", length=length, thickness=thickness * length, width=width * length)
    if kind == "rod":
        return Rod("steel", length=length, diameter=length * np.exp(rng.uniform(np.log(0.005), np.log(0.1))))
    radius = length * rng.uniform(0.02, 0.2)
    thickness, width = radius * rng.uniform(0.05, 0.5), length * rng.uniform(0.1, 0.5)
    return Notch("steel", thickness=thickness, width=width, profile=Circular(radius))


def stage(rng: np.random.Generator) -> Mechanism:
    """Parts alike side by side, or different ones anywhere in any direction; each drawn from either end."""
    kind, count, even = str(rng.choice(["leaf", "leaf", "leaf", "rod", "notch"])), int(rng.integers(1, 5)), rng.random() < 0.5
    parts = {f"part{number}": one_part(rng, kind) for number in range(1 if even else count)}
    links: dict[str, Link] = {}
    for number in range(count):
        name = "part0" if even else f"part{number}"
        turn = np.eye(3) if even else exponential(rng.uniform(-1.0, 1.0, 3) * rng.choice([0.3, 2.0]))
        beside = np.array([0.5 * float(span(parts[name])) - 0.1, 0.05 * (number - (count - 1) / 2.0), 0.0])
        at = beside if even else rng.uniform(-0.05, 0.05, 3)
        joins, side = (("ground", "platform"), 1.0) if rng.random() < 0.5 else (("platform", "ground"), -1.0)
        links[f"link{number}"] = Link(joins, name, tuple(at), tuple(side * turn[:, 0]), bends=tuple(turn[:, 2]))
    body = Body(mass=1.0, inertia=Inertia(1e-3, 1e-3, 1e-3), centre=(0.0, 0.0, 0.0), reference=(0.0, 0.0, 0.0))
    return Mechanism("", materials={"steel": STEEL}, parts=parts, bodies={"platform": body}, links=links, gravity=(0.0, 0.0, 0.0))


def wrenches(rng: np.random.Generator, model: Nonlinear, count: int) -> np.ndarray:
    softest = min(float(np.min(group.law.rigidity / group.law.length**2)) for group in model.flexures)
    scale = softest * np.array([100.0, 200.0, 100.0, *np.full(3, 30.0 * model.size)])
    sizes = np.exp(rng.uniform(np.log(1e-2), 0.0, (count, 1)))
    plane = np.where(rng.random((count, 1)) < 0.3, [1.0, 1.0, 0.0, 0.0, 0.0, 1.0], 1.0)
    return rng.uniform(-1.0, 1.0, (count, 6)) * sizes * plane * scale


def loads(wrench: np.ndarray) -> dict[str, np.ndarray]:
    return {f"platform.{name}": wrench[:, place] for place, name in enumerate(COMPONENTS)}


def lack(found: State) -> np.ndarray:
    """The force that is not in balance (b,), over the largest in a flexure; moments over the model's length."""
    system = assemble(found.model, found.pose, found.loads, found.hold)
    left = np.abs(system.residual.reshape(len(system.residual), -1, 6)) / np.array([1.0] * 3 + [found.model.size] * 3)
    inside = [
        np.max(np.abs(bent.wrench) * (group.law.rigidity / group.law.length**2)[:, None, None], axis=(0, 2))
        for group, bent in zip(found.model.flexures, system.bent, strict=True)
    ]
    return np.max(left, axis=(1, 2)) / np.max(inside, axis=0)


def ends(models: int, each: int, share: float) -> None:
    """Require equilibria of a share of the loads, and as many answers from the unloaded stage: its equilibrium, or its critical load."""
    known = np.zeros(2, dtype=int)
    for number in range(models):
        rng = np.random.default_rng([0, number])
        model = nonlinear(stage(rng))
        wrench = loads(wrenches(rng, model, each))
        every = equilibrium(model, wrench, options=SolverOptions(past=True)), equilibrium(model, wrench)
        for found in every:
            assert np.max(lack(found)[found.converged], initial=0.0) < 1e-5
            assert np.isnan(found.twist()[~found.converged]).all()
            assert [bool(why) for why in found.reasons] == (~found.converged).tolist()
            assert ((found.reached == 1.0) == found.converged).all()
        critical = every[1].status == Status.CRITICAL
        assert ((every[1].reached > 0.0) & (every[1].reached < 1.0))[critical].all()
        known += [np.sum(every[0].converged), np.sum(every[1].converged | critical)]
    assert np.all(known > share * models * each), known


def test_every_search_ends_in_an_equilibrium_or_says_why_not():
    ends(4, 6, 0.9)


@pytest.mark.full
def test_every_one_of_many_searches_ends_in_an_equilibrium_or_says_why_not():
    ends(60, 25, 0.95)


def followed(model: Nonlinear, wrench: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Twists (b, 6) at the end of 64 steps of load, each from the last, and whether (b,) all of them were found and stable."""
    last, firm = None, np.ones(len(wrench), dtype=bool)
    for share in STEPS:
        last = equilibrium(model, loads(share * wrench), start=last, options=SolverOptions(halvings=0))
        firm &= last.converged & (unstable_motions(last) == 0)
        if not firm.any():
            break
    assert last is not None
    return last.twist(), firm


@pytest.mark.parametrize("models", [pytest.param(20, marks=pytest.mark.full), 2])
def test_what_is_stable_is_where_small_steps_of_load_lead(models: int):
    """One step may find another equilibrium than loading by and by does; then that one is not stable, and is told so."""
    same = 0
    for number in range(models):
        rng = np.random.default_rng([7, number])
        model = nonlinear(stage(rng))
        wrench = wrenches(rng, model, 5)
        found = equilibrium(model, loads(wrench))
        twist, firm = followed(model, wrench)
        both = firm & found.converged & (unstable_motions(found) == 0)
        assert np.max(np.abs(twist - found.twist())[both], initial=0.0) < 1e-7
        same += int(both.sum())
    assert same > 0.8 * 5 * models
