"""Poses, loads and states of a stage at large displacements."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum
from typing import Any

import numpy as np

from flexstage.base.arguments import CheckedFields
from flexstage.base.number import Array

WEIGHT = "weight"
"""Name of the load that is the weight of the stage, including payloads."""
STATED = "stated forces"
"""Name of the load of all specified forces and preloads."""


class Status(IntEnum):
    """Status of an equilibrium solution; `CRITICAL`: a limit point or a bifurcation is on the path, `NOT_FOLLOWED`: the path ends."""

    CONVERGED = 0
    NOT_CONVERGED = 1
    SINGULAR = 2
    CRITICAL = 3
    NOT_FOLLOWED = 4


@dataclass(frozen=True)
class SolverOptions(CheckedFields):
    """Solver options of equilibria.

    An iteration ends at steps below `step` (lengths over the flexures', radians, amplitudes) and gaps below `gap`, or after `iterations`.

    `limit` is the largest step, translations over the stage's `reach`. Failed cases are loaded in steps, the smallest 2^-`halvings` of the
    load, then by arc length with at most `arcs` steps. With `past`, the path also passes limit points: the load may decrease and increase
    again to its whole value, as in a snap-through.
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
    """Loads of b cases: `inputs` (b, m) by the model's channels, `gravity` (b, 3) [m/s^2], fraction `constant` (b,) of specified forces.

    Preloads count as specified forces. Wrenches of inputs keep the directions of their forces and moments in space.
    """

    inputs: Array
    gravity: Array
    constant: Array

    def of(self, cases: Array) -> Loads:
        """Select cases."""
        return Loads(self.inputs[cases], self.gravity[cases], self.constant[cases])

    def times(self, share: Array) -> Loads:
        """Scale each case by a fraction (b,)."""
        return Loads(self.inputs * share[:, None], self.gravity * share[:, None], self.constant * share)


@dataclass(frozen=True, eq=False)
class Pose:
    """Configuration of b cases: body references `position` (b, n + 1, 3) and `turn` (b, n + 1, 3, 3), the ground last.

    `strain` (l, b, q) and `wrench` (l, b, 6) are by group of flexures, `held` (b, c) are the reactions of locked and fixed DOFs.
    """

    position: Array
    turn: Array
    strain: tuple[Array, ...]
    wrench: tuple[Array, ...]
    held: Array

    def of(self, cases: Array) -> Pose:
        """Select cases."""
        strain, wrench = (tuple(each[:, cases] for each in group) for group in (self.strain, self.wrench))
        return Pose(self.position[cases], self.turn[cases], strain, wrench, self.held[cases])

    def put(self, cases: Array, other: Pose) -> Pose:
        """Replace some cases."""
        strain, wrench = (
            tuple(put(one, (slice(None), cases), new) for one, new in zip(mine, theirs, strict=True))
            for mine, theirs in ((self.strain, other.strain), (self.wrench, other.wrench))
        )
        position, turn, held = (put(getattr(self, name), cases, getattr(other, name)) for name in ("position", "turn", "held"))
        return Pose(position, turn, strain, wrench, held)


def put(array: Array, places: Any, values: Array) -> Array:
    """Return a copy of an array with other values at some indices."""
    result = np.array(array)
    result[places] = values
    return result
