"""Stages small enough to be meshed in a blink: rods between rigid bodies."""

from __future__ import annotations

from dataclasses import replace

from flexstage.base.units.scale import X, mm
from flexstage.mechanism.mechanism import Link, Mechanism
from flexstage.parts.body import Body, Inertia
from flexstage.parts.rod import Rod
from flexstage.solid.fea.jobs.cache import key_of
from flexstage.solid.fea.jobs.reducing import Reduce
from flexstage.solid.fea.meshing.fineness import Fineness, Reduction
from flexstage.solid.fea.solver.component import Component, components
from tests.stock import STEEL

COARSE = Reduction(Fineness(neck=2.5, block=2.5, grading=0.6, order=2), modes=2)


def propped(*lengths: float) -> Mechanism:
    """A rigid platform on the ground by rods side by side, each a component of its own."""
    rods = {f"rod {number + 1}": Rod("steel", size, 4 * mm) for number, size in enumerate(lengths)}
    body = Body(mass=0.1, centre=(0.0, 0.0, 0.0), inertia=Inertia(1e-5, 1e-5, 1e-5))
    return Mechanism(
        name="propped",
        materials={"steel": STEEL},
        parts=rods,
        bodies={"platform": body},
        links={
            f"prop {number + 1}": Link(("ground", "platform"), name, (0.0, 20 * mm * number, 0.0), X) for number, name in enumerate(rods)
        },
    )


def rod(length: float = 6 * mm) -> Component:
    """One rod between the ground and a rigid platform."""
    return components(propped(length))[0]


def job(component: Component) -> Reduce:
    return Reduce(key_of(component, COARSE), component, COARSE)


class Bomb:
    """What does something to the process that loads it, and is nothing else: a crash, a hang, an error, a change of the code there."""

    def __init__(self, function: object, *arguments: object) -> None:
        self.function, self.arguments = function, arguments

    def __reduce__(self) -> tuple[object, tuple[object, ...]]:
        return self.function, self.arguments


def mined(name: str, bomb: Bomb, component: Component | None = None) -> Reduce:
    """A job that goes off where it is loaded."""
    part = replace(component or rod(), name=name)
    plain = job(part)
    return Reduce(plain.key, replace(part, place=bomb), COARSE)
