"""Contacts: a ball in its seat, pressed by a preload."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum
from typing import Annotated, ClassVar

import numpy as np

from flexstage.base.finding import Finding
from flexstage.base.number import Number
from flexstage.base.quantity import ANGLE, FORCE, LENGTH, POSITIVE, RATIO, Bound
from flexstage.parts.freedom import Freedom, others
from flexstage.parts.shape import Elastic

_HALF_ANGLE = Bound(0.0, 0.5 * np.pi, open_low=True, open_high=True)


class Seat(Enum):
    """What a ball rests on: a `FLAT`, or both walls of a V `GROOVE`."""

    FLAT = "flat"
    GROOVE = "groove"


@dataclass(frozen=True, eq=False)
class Contact(Elastic):
    """A ball of a `radius` pressed on its `seat`: a flat across x, or a V groove along z that x halves.

    The first body has the seat, the second the ball; the link's origin is the ball's centre, x points out of the seat. `material` is that
    of the ball, `counter` that of the seat. `preload` is the force along x that presses them together as drawn: without it there is no
    stiffness. `half_angle` is that of the groove, between a wall and x. `friction` is the coefficient against which slip is judged.
    The ball weighs nothing: its mass is its body's.

    Intended freedoms, without friction: along y and z on a flat, along z in a groove, and all rotations.
    """

    kind: ClassVar[str] = "contact"
    material: str
    counter: str
    radius: Annotated[Number, LENGTH, POSITIVE]
    seat: Seat = Seat.FLAT
    half_angle: Annotated[Number, ANGLE, _HALF_ANGLE] | None = None
    preload: Annotated[Number, FORCE, POSITIVE] | None = None
    friction: Annotated[Number, RATIO, POSITIVE] | None = None

    @property
    def intended(self) -> tuple[Freedom, ...]:
        """The freedoms that a seat without friction leaves free."""
        return others((Freedom.X,) if self.seat is Seat.FLAT else (Freedom.X, Freedom.Y))

    @property
    def is_round(self) -> bool:
        """On a flat."""
        return self.seat is Seat.FLAT

    @property
    def mirrored(self) -> Contact:
        """Itself: x halves the groove."""
        return self

    @property
    def push(self) -> Number | None:
        """Its preload: the seat pushes the ball away."""
        return self.preload

    @property
    def faults(self) -> Iterator[Finding]:
        """It is pressed, and states the angle of a groove, not of a flat."""
        if self.preload is None:
            what = "it states none, and a contact without preload has no stiffness"
            yield Finding("preload", what, 'State the force along x that presses ball and seat together: preload = "10 N"')
        if self.seat is Seat.GROOVE and self.half_angle is None:
            yield Finding("half_angle", "its groove states none", 'State the angle between a wall and x: half_angle = "45 deg"')
        if self.seat is Seat.FLAT and self.half_angle is not None:
            yield Finding("half_angle", "it is that of a groove, and the ball rests on a flat", 'Leave it out, or state seat = "groove"')
