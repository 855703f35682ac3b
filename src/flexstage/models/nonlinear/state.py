"""Poses, loads and states of a stage at large displacements."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum
from typing import Any

import numpy as np

from flexstage.base.arguments import CheckedFields
from flexstage.base.number import Array

WEIGHT = "weight"
"""Name of the load that represents the weight of the stage, including payloads."""
STATED = "stated forces"
"""Name of the load that represents all specified forces and preloads."""


class Status(IntEnum):
    """Status of an equilibrium solution. `CRITICAL`: a limit point or a bifurcation is on the load path. `NOT_FOLLOWED`: the path ends."""

    CONVERGED = 0
    NOT_CONVERGED = 1
    SINGULAR = 2
    CRITICAL = 3
    NOT_FOLLOWED = 4


@dataclass(frozen=True)
class SolverOptions(CheckedFields):
    """Options of the equilibrium solver.

    An iteration ends after `iterations` steps, or earlier if the size of a step is below `step` and the residuals are below `gap`. The size
    of a step is the largest of its translations divided by the longest flexure length, its rotations in radians, and its changes of flexure
    amplitudes.

    `limit` is the largest permitted step; for this limit, translations are divided by the length scale `Nonlinear.reach`. If the iteration
    of a load case does not converge, the load is applied in steps, down to 2^-`halvings` of the load. If the steps fail too, the load is
    applied by arc length in at most `arcs` steps. With `past`, the path also passes limit points: the load may decrease and then increase
    to its whole value, as in a snap-through.
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
    """Loads of b cases: values `inputs` (b, m) of the channels, `gravity` (b, 3) [m/s^2], fraction `constant` (b,) of the specified forces.

    Preloads count as specified forces. Forces and moments of wrench inputs keep their directions in space.
    """

    inputs: Array
    gravity: Array
    constant: Array

    def of(self, cases: Array) -> Loads:
        """Return the loads of some cases."""
        return Loads(self.inputs[cases], self.gravity[cases], self.constant[cases])

    def plus(self, other: Loads, factor: float) -> Loads:
        """Return the sum with `factor` times other loads."""
        return Loads(self.inputs + factor * other.inputs, self.gravity + factor * other.gravity, self.constant + factor * other.constant)

    def times(self, share: Array) -> Loads:
        """Return the loads with each case multiplied by a fraction (b,)."""
        return Loads(self.inputs * share[:, None], self.gravity * share[:, None], self.constant * share)


@dataclass(frozen=True, eq=False)
class Pose:
    """Configuration of b cases: `position` (b, n + 1, 3) of body reference points and rotation `turn` (b, n + 1, 3, 3), the ground last.

    Each group of flexures has amplitudes `strain` (l, b, q) and end wrenches `wrench` (l, b, 6). `held` (b, c) are the reactions of locked
    and fixed DOFs.
    """

    position: Array
    turn: Array
    strain: tuple[Array, ...]
    wrench: tuple[Array, ...]
    held: Array

    def of(self, cases: Array) -> Pose:
        """Return the pose of some cases."""
        strain, wrench = (tuple(each[:, cases] for each in group) for group in (self.strain, self.wrench))
        return Pose(self.position[cases], self.turn[cases], strain, wrench, self.held[cases])

    def put(self, cases: Array, other: Pose) -> Pose:
        """Return a copy of the pose in which some cases are replaced."""
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
