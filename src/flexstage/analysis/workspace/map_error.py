"""Error of the linear map x = J a relative to finite kinematics, over the whole workspace."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, ClassVar

import numpy as np

from flexstage.analysis.workspace.polytope import reachable
from flexstage.analysis.workspace.stroke import StrokeLimits, beside
from flexstage.base.finding import refuse
from flexstage.base.labelled import Matrix
from flexstage.base.notebook import Result
from flexstage.base.number import Array, first_design, index_of_largest, matvec
from flexstage.base.record import INNER, VIEW, Layout
from flexstage.base.units.quantity import LENGTH
from flexstage.mechanism.assembly.expand import expand
from flexstage.mechanism.mechanism import Mechanism
from flexstage.models.finite import design_shape, forward_kinematics
from flexstage.models.linear.kinematics import Kinematics
from flexstage.spatial.frame import COMPONENTS, TWIST_UNITS

_ROUNDING = 64.0 * float(np.finfo(float).eps)


class MapError(Result):
    """Error of the linear map: the pose by finite kinematics minus J a, with the Jacobian J and the strokes a.

    `errors` (k, ..., 6) [m, rad] are the errors at the `strokes` (k, ..., n) [m]. `worst` (..., 6) is the largest error by axis, at
    `worst_strokes` (..., 6, n). If all errors are rounding errors, `worst` is 0 and `worst_strokes` contains the first strokes. `residual`
    (...) [m] is the largest residual of redundant constraints.
    """

    TABLE: ClassVar[Layout] = Layout(
        "Error of the linear map", "errors_and_strokes", notes=("The largest error at {self.points} combinations of strokes.",)
    )

    actuators: tuple[str, ...]
    strokes: Array
    errors: Array
    worst: Array
    worst_strokes: Array
    residual: Annotated[Array, LENGTH]
    provenance: str

    @property
    def points(self) -> Annotated[int, VIEW]:
        """Number of combinations of strokes."""
        return len(self.strokes)

    @property
    def errors_and_strokes(self) -> Annotated[Matrix, INNER]:
        """Worst errors and their strokes; no strokes if all errors are rounding errors."""
        result = self.table
        rounding = (np.arange(result.values.shape[-1]) > 0) & (self.worst[..., None] == 0.0)
        return replace(result, values=np.where(rounding, np.nan, result.values))

    @property
    def notes(self) -> tuple[str, ...]:
        """Note on rounding."""
        return ("0: within the rounding error of the positions.",) if np.any(first_design(self.worst, 1) == 0.0) else ()

    @property
    def table(self) -> Annotated[Matrix, VIEW]:
        """Table of the six components (rows) with the worst error and its strokes."""
        values = np.concatenate([self.worst[..., None], self.worst_strokes], axis=-1)
        units = tuple((unit, *("m",) * len(self.actuators)) for unit in TWIST_UNITS)
        return Matrix(values, COMPONENTS, ("worst", *self.actuators), units)


def linear_map_error(mechanism: Mechanism, kinematics: Kinematics, limits: StrokeLimits, *, inside: int = 64) -> MapError:
    """Compute the error of the linear map in the box of strokes: at corners, centres of faces, and `inside` points of a Halton sequence.

    Redundant strokes strain the links, unless the strokes are consistent with a pose. For redundant actuators, the points are therefore the
    vertices of the reachable polytope and the points halfway from zero to each vertex. Raises `DesignError` if the stage has no stroke
    actuators, or more than 12.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.ideal import ideal
    >>> from flexstage.analysis.workspace.stroke import stroke_limits
    >>> stage = double_triangle()
    >>> error = linear_map_error(stage, ideal(stage), stroke_limits(stage), inside=4)
    >>> error.strokes.shape, bool(error.worst[5] < 4e-6)
    ((80, 6), True)
    """
    if not kinematics.actuators:
        raise refuse("linear map error", "the stage has no stroke actuators", "Use the force workspace")
    depth = len(design_shape(mechanism, kinematics))
    if len(kinematics.actuators) > kinematics.mobility:
        vertices = np.moveaxis(reachable(kinematics.mapping, limits).vertices, -2, 0)
        corners = matvec(kinematics.mapping.values, np.nan_to_num(beside(vertices, depth)))
        return map_error_at(mechanism, kinematics, np.concatenate([corners, 0.5 * corners]))
    points = np.concatenate([limits.points(0), _faces(limits), _interior(limits, inside)])
    return map_error_at(mechanism, kinematics, beside(points, depth))


def map_error_at(mechanism: Mechanism, kinematics: Kinematics, strokes: Array) -> MapError:
    """Compute the error of the linear map at k combinations of strokes (k, ..., n) [m], with batch axes in the middle.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.ideal import ideal
    >>> stage = double_triangle()
    >>> bool(np.max(map_error_at(stage, ideal(stage), np.full((1, 6), 1e-9)).worst) < 1e-14)
    True
    """
    count = len(kinematics.actuators)
    if strokes.shape[-1] != count:
        raise refuse(
            "linear map error", f"wrong number of strokes (got {strokes.shape[-1]}, expected {count})", "Use one stroke per actuator"
        )
    moved = forward_kinematics(mechanism, kinematics, strokes)
    linear = matvec(kinematics.jacobian.values, strokes)
    rounding = _ROUNDING * np.repeat([_reach(mechanism), 1.0], 3)
    errors = moved.pose.vector - linear
    errors = np.where(np.abs(errors) > rounding, errors, 0.0)
    place = index_of_largest(np.moveaxis(np.abs(errors), 0, -1), rounding[:, None])
    return MapError(
        actuators=kinematics.actuators,
        strokes=strokes,
        errors=errors,
        worst=np.max(np.abs(errors), axis=0),
        worst_strokes=_pick(np.broadcast_to(strokes, (*errors.shape[:-1], count)), place),
        residual=np.max(moved.residual, axis=0),
        provenance=moved.provenance,
    )


def _reach(mechanism: Mechanism) -> float:
    """Largest coordinate [m] of a link, the scale of rounding of poses."""
    return max((float(np.max(np.abs(link.frame.position))) for link in expand(mechanism).links.values()), default=0.0)


def _pick(strokes: Array, place: Array) -> Array:
    """Strokes (..., 6, n) of the points (k, ..., n) with index `place` (..., 6)."""
    return np.take_along_axis(strokes[..., None, :], place[None, ..., None], axis=0)[0]


def _faces(limits: StrokeLimits) -> Array:
    count = len(limits.actuators)
    middle = 0.5 * (limits.low + limits.high)
    high = [np.where(np.arange(count) == index, limits.high, middle) for index in range(count)]
    low = [np.where(np.arange(count) == index, limits.low, middle) for index in range(count)]
    return np.stack(high + low)


def _interior(limits: StrokeLimits, count: int) -> Array:
    fractions = np.stack([_radical_inverse(np.arange(1, count + 1), base) for base in _primes(len(limits.actuators))], axis=-1)
    fractions = fractions.reshape(count, *(1,) * (limits.low.ndim - 1), len(limits.actuators))
    return limits.low + fractions * limits.full


def _radical_inverse(numbers: Array, base: int) -> Array:
    """Halton sequence: radical inverse of an integer."""
    result, weight, left = np.zeros(numbers.shape), 1.0 / base, numbers.copy()
    while np.any(left > 0):
        result += weight * (left % base)
        left, weight = left // base, weight / base
    return result


def _primes(count: int) -> list[int]:
    results: list[int] = []
    number = 2
    while len(results) < count:
        if all(number % prime for prime in results):
            results.append(number)
        number += 1
    return results
