"""Modes of the platform as each method finds them, in one form."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from flexstage.base.number import Array
from flexstage.models.batch.blocks import Blocks, Scheme, blocks, dense, of_kind
from flexstage.models.batch.choice import Choice, choose, groups, means
from flexstage.models.batch.dense import Whole, whole
from flexstage.models.batch.factor import factor
from flexstage.models.batch.parameters.features import Rows
from flexstage.models.batch.parameters.numbers import Slopes
from flexstage.models.batch.slopes import motion, slope
from flexstage.models.batch.subspace import Found, Problem, Start, iterate
from flexstage.models.linear.eigen import cholesky

LEAST_PIVOT = 1e-9
"""Least pivot of K over its own diagonal entry: below it another method decides whether K is singular."""


@dataclass(frozen=True, eq=False)
class Stage:
    """Numbers (features, b) of designs, and how they change with each of `variables` numbers (none: no derivatives).

    `still` (features,): which numbers are known to be the same in all designs.
    """

    scheme: Scheme
    numbers: Array | Rows
    variables: int = 0
    slopes: Slopes | None = None
    still: Array | None = None

    @property
    def finite(self) -> Array:
        """Which designs' numbers are all finite."""
        if isinstance(self.numbers, Rows):
            return np.concatenate([np.isfinite(portion).all(axis=0) for portion in self.numbers.held])[: self.numbers.shape[1]]
        return np.asarray(np.isfinite(self.numbers).all(axis=0))

    def take(self, designs: Array | slice) -> Stage:
        """Those of some designs."""
        return replace(self, numbers=self.numbers[:, designs], slopes=None if self.slopes is None else self.slopes.take(designs))


@dataclass(frozen=True, eq=False)
class Solution:
    """Eigenvalues `values` (b, k) of the platform's modes, ascending, and its `share` (b, k); `good` (b,) where they are proved.

    `slopes` (b, P, k): Phi^T (dK - lambda dM) Phi of each mode with itself; `between` (b, P, k (k - 1) / 2) of pairs i < j by rows,
    zero but within clusters: none where there are no clusters.
    """

    values: Array
    share: Array
    good: Array
    slopes: Array
    between: Array | None

    @property
    def matrices(self) -> Array:
        """The slopes as symmetric matrices (b, P, k, k)."""
        count = self.values.shape[1]
        result = np.zeros((*self.slopes.shape, count))
        result[..., range(count), range(count)] = self.slopes
        if self.between is not None:
            rows, columns = np.triu_indices(count, 1)
            result[..., rows, columns] = result[..., columns, rows] = self.between
        return result

    def take(self, designs: Array | slice) -> Solution:
        """Those of some designs."""
        between = None if self.between is None else self.between[designs]
        return Solution(self.values[designs], self.share[designs], self.good[designs], self.slopes[designs], between)

    def put(self, designs: Array, other: Solution) -> Solution:
        """The same with another solution of some designs."""
        for name in ("values", "share", "good", "slopes"):
            getattr(self, name)[designs] = getattr(other, name)
        if self.between is None and other.between is None:
            return self
        count = self.values.shape[1]
        between = np.zeros((*self.slopes.shape[:2], count * (count - 1) // 2)) if self.between is None else self.between
        between[designs] = 0.0 if other.between is None else other.between
        return replace(self, between=between)


def by_iteration(stage: Stage, start: Start) -> Solution:
    """Many designs by iteration from `start`, in numpy.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.batch.engine import plan
    >>> from flexstage.models.batch.parameters.numbers import numbers_of
    >>> stage = plan(double_triangle(), ())
    >>> numbers = numbers_of(stage.family, np.zeros((1, 0)))
    >>> by_iteration(Stage(stage.scheme, numbers), stage.start).good.tolist()
    [True]
    """
    numbers = stage.numbers[:]
    matrices = blocks(stage.scheme, numbers)
    found = found_modes(stage.scheme, matrices, of_kind(stage.scheme, numbers, "inertia")[:, 0], start)
    good = found.proved
    picked = np.argsort(~found.mask, axis=1, kind="stable")[:, : start.choice.count]
    values, share = (np.take_along_axis(item, picked, axis=1) for item in (found.ritz.values, found.ritz.share))
    if stage.slopes is None:
        return Solution(values, share, good, *_no_slopes(stage, values))
    shapes = np.take_along_axis(found.ritz.shapes, picked[:, None, None, :], axis=-1)
    return Solution(values, share, good, *_slopes(stage, shapes, values, start.choice.cluster))


def found_modes(scheme: Scheme, matrices: tuple[Blocks, Blocks], platform: Array, start: Start) -> Found:
    """Iterate with K and M given as blocks, and the platform's own inertia (b, 6, 6).

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.batch.engine import plan
    >>> from flexstage.models.batch.parameters.numbers import numbers_of
    >>> stage = plan(double_triangle(), ())
    >>> numbers = numbers_of(stage.family, np.zeros((1, 0)))
    >>> matrices = blocks(stage.scheme, numbers)
    >>> found_modes(stage.scheme, matrices, of_kind(stage.scheme, numbers, "inertia")[:, 0], stage.start).proved.tolist()
    [True]
    """
    stiffness, inertia = matrices
    parts = factor(scheme.graph, stiffness)
    diagonal = np.diagonal(stiffness.own, axis1=-2, axis2=-1).reshape(parts.pivots.shape)
    firm = (parts.pivots > LEAST_PIVOT * diagonal).all(axis=1)
    root = np.swapaxes(cholesky(parts.inverse[:, -1]), -1, -2)
    found = iterate(Problem(scheme.graph, parts, inertia, platform, root), stiffness, start)
    return Found(found.ritz, found.mask, found.proved & firm)


def _slopes(stage: Stage, shapes: Array, values: Array, gap: float) -> tuple[Array, Array]:
    """Slopes of each mode with itself, and those between modes."""
    group, count = groups(values, gap), values.shape[1]
    (rows, columns), diagonal = np.triu_indices(count, 1), range(count)
    own, between = _no_slopes(stage, values)
    if stage.slopes is None:
        return own, between
    seen = motion(stage.scheme, stage.numbers[:], shapes, means(values, group))
    start = 0
    for change in stage.slopes.changes:
        stop = start + len(change.rows)
        found = slope(stage.scheme, seen, change, stage.slopes.values[start:stop])
        own[:, change.variable] += found[:, diagonal, diagonal]
        between[:, change.variable] += found[:, rows, columns]
        start = stop
    return own, np.where((group[:, rows] == group[:, columns])[:, None], between, 0.0)


def _no_slopes(stage: Stage, values: Array) -> tuple[Array, Array]:
    count = values.shape[1]
    return np.zeros((len(values), stage.variables, count)), np.zeros((len(values), stage.variables, count * (count - 1) // 2))


def wholly(stage: Stage, choice: Choice) -> list[Solution]:
    """Designs by dense matrices, one solution each; where K is singular without modes.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.batch.engine import plan
    >>> from flexstage.models.batch.parameters.numbers import numbers_of
    >>> stage = plan(double_triangle(), ())
    >>> numbers = numbers_of(stage.family, np.zeros((1, 0)))
    >>> (wholly(Stage(stage.scheme, numbers), Choice())[0].values[0, :2] ** 0.5 / (2 * np.pi)).round(1).tolist()
    [106.0, 106.0]
    """
    order = np.argsort(stage.scheme.coordinates)
    modes = [every_mode(stage.scheme, stage.numbers[:, [design]]) for design in range(stage.numbers.shape[1])]
    picked = [platform_indices(each, choice) for each in modes]
    result: dict[int, Solution] = {}
    for count in {len(each) for each in picked}:
        designs = [design for design, each in enumerate(picked) if len(each) == count]
        values, share = (np.stack([getattr(modes[at], name)[picked[at]] for at in designs]) for name in ("values", "share"))
        shapes = np.stack([modes[at].shapes[order][:, picked[at]] for at in designs])
        shapes = shapes.reshape(len(designs), len(stage.scheme.graph.order), 6, count)
        good = np.array([bool(len(modes[at].values)) for at in designs])
        found = Solution(values, share, good, *_slopes(stage.take(np.array(designs)), shapes, values, choice.cluster))
        result |= {at: found.take(np.array([place])) for place, at in enumerate(designs)}
    return [result[design] for design in range(len(modes))]


def every_mode(scheme: Scheme, numbers: Array) -> Whole:
    """Every mode of one design (features, 1), in the topology's coordinates.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.batch.engine import plan
    >>> from flexstage.models.batch.parameters.numbers import numbers_of
    >>> stage = plan(double_triangle(), ())
    >>> len(every_mode(stage.scheme, numbers_of(stage.family, np.zeros((1, 0)))).values)
    114
    """
    stiffness, inertia = blocks(scheme, numbers)
    platform = np.zeros((scheme.topology.size,) * 2)
    platform[:6, :6] = of_kind(scheme, numbers, "inertia")[0, 0]
    return whole(dense(scheme, stiffness)[0], dense(scheme, inertia)[0], platform, np.eye(6, len(platform)), Choice.cluster)


def platform_indices(modes: Whole, choice: Choice) -> Array:
    """Which modes of one design are the platform's.

    >>> platform_indices(Whole(np.array([1.0, 2.0]), np.eye(2), np.array([0.1, 0.9]), np.diag([0.1, 0.9])), Choice(count=1)).tolist()
    [1]
    """
    if not len(modes.values):
        return np.zeros(0, dtype=int)
    return np.flatnonzero(choose(modes.values[None], modes.parts[None], choice).mask[0])


def cluster_slopes(solution: Solution, choice: Choice) -> Array:
    """Derivatives (b, P, k) of the means of clusters, for each of their modes.

    >>> both = Solution(np.array([[1.0, 4.0, 4.0]]), np.array([[0.9, 0.5, 0.5]]), np.array([True]), np.array([[[1.0, 2.0, 4.0]]]), None)
    >>> cluster_slopes(both, Choice()).tolist()
    [[[1.0, 3.0, 3.0]]]
    """
    return np.swapaxes(means(np.swapaxes(solution.slopes, 1, 2), groups(solution.values, choice.cluster)), 1, 2)
