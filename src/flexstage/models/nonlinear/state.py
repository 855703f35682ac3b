"""Poses, loads and states of a stage at large displacements."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum
from typing import Any

import numpy as np

from flexstage.base.arguments import CheckedFields
from flexstage.base.number import Array

WEIGHT = "weight"
"""The load that is the stage's own weight, payloads included."""
STATED = "stated forces"
"""The load that is all stated forces and preloads."""


class Status(IntEnum):
    """How a search for equilibrium ended; `CRITICAL`: a limit point or a bifurcation is on the way, `NOT_FOLLOWED`: the way ends."""

    CONVERGED = 0
    NOT_CONVERGED = 1
    SINGULAR = 2
    CRITICAL = 3
    NOT_FOLLOWED = 4


@dataclass(frozen=True)
class SolverOptions(CheckedFields):
    """Solver options of equilibria.

    A search ends at steps below `step` (lengths over the flexures', radians, amplitudes) and gaps below `gap`, or after `iterations`.

    `limit` is the largest step, translations over the stage's `reach`. What fails is loaded in steps, the least 2^-`halvings` of the load;
    and what still fails follows its load by arc length, `arcs` steps at most, `past` limits too: the load may then
    fall and rise again to where it is whole, as a stage does that snaps through.
    """

    step: float = 1e-9
    gap: float = 1e-6
    iterations: int = 25
    limit: float = 0.3
    halvings: int = 8
    arcs: int = 30
    past: bool = False


@dataclass(frozen=True, eq=False)
class Loads:
    """Loads of b cases: `inputs` (b, m) by the model's channels, `gravity` (b, 3) [m/s^2], and the share `constant` (b,) of stated forces.

    Preloads count as stated forces. Wrenches of inputs are dead: their forces and moments keep their directions in space.
    """

    inputs: Array
    gravity: Array
    constant: Array

    def of(self, cases: Array) -> Loads:
        """Those of some cases."""
        return Loads(self.inputs[cases], self.gravity[cases], self.constant[cases])

    def times(self, share: Array) -> Loads:
        """A share (b,) of each case's."""
        return Loads(self.inputs * share[:, None], self.gravity * share[:, None], self.constant * share)


@dataclass(frozen=True, eq=False)
class Pose:
    """Where everything is, in b cases: bodies' references `position` (b, n + 1, 3) and `turn` (b, n + 1, 3, 3), the ground last.

    `strain` (l, b, q) and `wrench` (l, b, 6) of each group of flexures, `held` (b, c) the reactions of locked and held freedoms.
    """

    position: Array
    turn: Array
    strain: tuple[Array, ...]
    wrench: tuple[Array, ...]
    held: Array

    def of(self, cases: Array) -> Pose:
        """That of some cases."""
        strain, wrench = (tuple(each[:, cases] for each in group) for group in (self.strain, self.wrench))
        return Pose(self.position[cases], self.turn[cases], strain, wrench, self.held[cases])

    def put(self, cases: Array, other: Pose) -> Pose:
        """This pose with that of some cases exchanged."""
        strain, wrench = (
            tuple(put(one, (slice(None), cases), new) for one, new in zip(mine, theirs, strict=True))
            for mine, theirs in ((self.strain, other.strain), (self.wrench, other.wrench))
        )
        position, turn, held = (put(getattr(self, name), cases, getattr(other, name)) for name in ("position", "turn", "held"))
        return Pose(position, turn, strain, wrench, held)


def put(array: Array, places: Any, values: Array) -> Array:
    """A copy of an array with other values at some places."""
    result = np.array(array)
    result[places] = values
    return result
