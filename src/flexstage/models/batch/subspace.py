"""Subspace iteration with shift at zero, begun from the modes of one design and sped up by Chebyshev's polynomials.

With T = K^-1 M, self-adjoint in the inner product of M, and mu = 1 / lambda:

1. Z = T Y for the block Y (n, m); Rayleigh-Ritz: Z^T M Z q = mu Z^T K Z q, where Z^T K Z = Z^T M Y costs no product with K.
2. Each Ritz pair carries the residual of the block before the last product, rho^2 = |T y - mu y|^2 / |T y|^2 in M = 1 - 1 / (mu^2 y^T M y)
   with y = Y q, (Z q)^T M (Z q) = 1. An eigenvalue lies within rho (relative) of each. Of the first p together, each lies within
   s^2 / (mu_j - mu_p+1), s^2 the sum of their (rho mu)^2 (Mathias, SIAM J. Matrix Anal. Appl. 19, 1998), and the vectors are off by
   s / (mu_j - mu_p+1). The angle of Z is less than that of Y by another factor mu_p+1 / mu_p.
3. If that is not enough: a Chebyshev polynomial of T that is small on [0, mu_m], then again 1. The same number of products as plain
   iteration, but the error falls like exp(d arccosh(2 mu / mu_m - 1)) and not like (mu / mu_m)^d.

Which modes can have been missed: none below sigma if K - sigma M has as many negative pivots as Ritz values lie below. Those above do not
decide which of the lower ones are the platform's.
"""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from typing import Any, TypeVar, cast

import numpy as np

from flexstage.base.number import Array
from flexstage.models.batch.blocks import Blocks
from flexstage.models.batch.choice import Choice, Chosen, choose, participation
from flexstage.models.batch.factor import Factor, factor, product, solve
from flexstage.models.batch.order import Elimination

TOGETHER = 1e-4
"""Relative gap of eigenvalues below which one side of it is not counted without the other."""

_Any = TypeVar("_Any", bound=Any)


@dataclass(frozen=True, eq=False)
class Start:
    """The block to begin with (bodies, 6, m), and how it goes on: `degree` of each polynomial, `rounds` at most, bounds to reach.

    `value` bounds the relative error of eigenvalues, `angle` that of vectors. The modes outside the block are expected to begin at `edge`
    times its highest eigenvalue. Of the first `needed` modes are the platform's. The kernel begins with the inertial forces `force` of
    these and more, and with K - `shift` M; it finds the first `needed` one by one:
    vectors of those that are to be found `once` (needed,) in one step, though derivatives are asked for, of others in two.
    """

    block: Array
    choice: Choice
    edge: float = 1.0
    degree: int = 3
    rounds: int = 5
    value: float = 1e-7
    angle: float = np.inf
    needed: int = 0
    once: Array = field(default_factory=lambda: np.zeros(0, dtype=bool))
    force: Array = field(default_factory=lambda: np.zeros((0, 6, 0)))
    shift: float = 0.0


@dataclass(frozen=True, eq=False)
class Ritz:
    """Ascending `values` lambda (b, m), M-normalised `shapes` and M times them (b, bodies, 6, m), `residual` rho, `share` (b, m).

    `parts` (b, 6, m) is the participation in the platform's compliance.
    """

    values: Array
    shapes: Array
    heavy: Array
    residual: Array
    share: Array
    parts: Array

    def take(self, designs: Array) -> Ritz:
        """Those of some designs."""
        return Ritz(*(getattr(self, each.name)[designs] for each in fields(self)))


@dataclass(frozen=True, eq=False)
class Verdict:
    """Whether a design is `done` (b,), which modes are the platform's, and the `shift` below which `below` eigenvalues must lie."""

    done: Array
    chosen: Chosen
    shift: Array
    below: Array


@dataclass(frozen=True, eq=False)
class Problem:
    """K factored and M of many designs, the platform's own inertia (b, 6, 6) and a root R of its compliance C = R^T R (b, 6, 6)."""

    graph: Elimination
    parts: Factor
    inertia: Blocks
    platform: Array
    root: Array

    def take(self, designs: Array) -> Problem:
        """Those of some designs."""
        return Problem(self.graph, self.parts.take(designs), self.inertia.take(designs), self.platform[designs], self.root[designs])


@dataclass(frozen=True, eq=False)
class Found:
    """What iteration found: Ritz pairs, the platform's modes, and whether all of that is `proved` (b,)."""

    ritz: Ritz
    mask: Array
    proved: Array


def iterate(problem: Problem, stiffness: Blocks, start: Start) -> Found:
    """Iterate until every design is done or the rounds are over; what is not proved is for another method.

    >>> from flexstage.models.batch.order import elimination
    >>> graph, none = elimination(2, [(0, 1)], keep=0), np.zeros((1, 1, 6, 6))
    >>> stiff = Blocks(np.stack([100.0 * np.eye(6), np.diag(np.arange(1.0, 7.0))])[None], none)
    >>> heavy = Blocks(np.stack([0.1 * np.eye(6), np.eye(6)])[None], none)
    >>> problem = Problem(graph, factor(graph, stiff), heavy, np.eye(6)[None], np.diag(np.arange(1.0, 7.0) ** -0.5)[None])
    >>> block = np.eye(12)[:, [6, 7, 8, 9, 10, 11, 0]].reshape(2, 6, 7)
    >>> iterate(problem, stiff, Start(block, Choice())).ritz.values[0, :6].round(9).tolist()  # the body kept last is the platform
    [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]
    """
    count = len(problem.platform)
    block = np.broadcast_to(start.block, (count, *start.block.shape))
    ritz = _ritz(problem, block)
    verdict = _verdict(ritz, start)
    for _ in range(start.rounds):
        left = np.flatnonzero(~verdict.done)
        if not len(left):
            break
        part = problem.take(left) if len(left) < count else problem
        better = _ritz(part, _filter(part, ritz.take(left) if len(left) < count else ritz, start))
        ritz = _replace(ritz, better, left)
        verdict = _replace(verdict, _verdict(better, start), left)
    proved = verdict.done & (_negative(problem, stiffness, verdict.shift) == verdict.below)
    return Found(ritz, verdict.chosen.mask, proved)


def _ritz(problem: Problem, block: Array) -> Ritz:
    """Rayleigh-Ritz on T Y for the block Y."""
    force = product(problem.graph, problem.inertia, block)
    ahead = solve(problem.graph, problem.parts, force)
    heavy = product(problem.graph, problem.inertia, ahead)
    flat, force, ahead, heavy = (_flat(item) for item in (block, force, ahead, heavy))
    turned = np.swapaxes(ahead, -1, -2)
    before, stiff, mass = np.swapaxes(flat, -1, -2) @ force, turned @ force, turned @ heavy
    values, vectors = _small(stiff, mass)
    with np.errstate(divide="ignore", invalid="ignore"):
        norm = np.sum(vectors * (before @ vectors), axis=-2)
        residual = np.sqrt(np.maximum(1.0 - values * values / norm, 0.0))
    shapes, heavy = (item @ vectors for item in (ahead, heavy))
    seen = shapes[:, -6:]
    share, parts = np.sum(seen * (problem.platform @ seen), axis=-2), participation(problem.root, seen, values)
    return Ritz(values, _as_block(shapes), _as_block(heavy), residual, share, parts)


def _small(stiff: Array, mass: Array) -> tuple[Array, Array]:
    """Ascending lambda (b, m) of stiff q = lambda mass q, with q^T mass q = 1; NaN where that cannot be done."""
    scale = 1.0 / np.sqrt(np.diagonal(stiff, axis1=-2, axis2=-1))
    both = scale[:, :, None] * scale[:, None, :]
    stiff, mass = stiff * both, mass * both
    bad = ~np.isfinite(stiff).all(axis=(-2, -1)) | ~np.isfinite(mass).all(axis=(-2, -1))
    stiff[bad], mass[bad] = np.eye(stiff.shape[-1]), np.eye(stiff.shape[-1])
    lower, failed = _lower(stiff)
    bad |= failed
    inverse = np.linalg.inv(lower)
    back = np.swapaxes(inverse, -1, -2)
    roots, vectors = np.linalg.eigh(inverse @ mass @ back)
    roots, vectors = roots[:, ::-1], vectors[..., ::-1]
    with np.errstate(divide="ignore", invalid="ignore"):
        vectors = scale[:, :, None] * (back @ vectors) / np.sqrt(roots)[:, None, :]
        values = 1.0 / roots
    values[bad] = np.nan
    return values, vectors


def _lower(matrix: Array) -> tuple[Array, Array]:
    """Cholesky factors; the unit matrix, and True, where there is none."""
    failed = np.zeros(len(matrix), dtype=bool)
    try:
        return np.linalg.cholesky(matrix), failed
    except np.linalg.LinAlgError:
        failed = np.linalg.eigvalsh(matrix)[:, 0] <= 1e-14
        return np.linalg.cholesky(np.where(failed[:, None, None], np.eye(matrix.shape[-1]), matrix)), failed


def _filter(problem: Problem, ritz: Ritz, start: Start) -> Array:
    """Chebyshev's polynomial in 2 T / mu - 1, mu where the modes outside begin, of the shapes; columns divided by its value there."""
    outside = start.edge * ritz.values[:, -1:]
    twice = 2.0 * outside[..., None, None]
    before, now = ritz.shapes, twice * solve(problem.graph, problem.parts, ritz.heavy) - ritz.shapes
    for _ in range(start.degree - 1):
        force = product(problem.graph, problem.inertia, now)
        before, now = now, 2.0 * (twice * solve(problem.graph, problem.parts, force) - now) - before
    with np.errstate(invalid="ignore", over="ignore"):
        growth = np.cosh(start.degree * np.arccosh(np.maximum(2.0 * outside / ritz.values - 1.0, 1.0)))
    return now / growth[:, None, None, :]


def _verdict(ritz: Ritz, start: Start) -> Verdict:
    """Judge every design: platform modes, the bounds of all up to the last of them, and the shift that counts eigenvalues."""
    values, count = ritz.values, ritz.values.shape[1]
    with np.errstate(invalid="ignore", divide="ignore"):
        picked = choose(values, ritz.parts, start.choice)
        needed = count - np.argmax(picked.mask[:, ::-1], axis=1)
        below = _apart(values, needed)
        edge = np.minimum(below, count - 1)[:, None]
        inner, outer = (np.take_along_axis(values, item, axis=1)[:, 0] for item in (edge - 1, edge))
        good = _within(ritz, start, picked, needed, below)
        done = good & picked.exact & picked.sure & (below < count) & np.isfinite(values).all(axis=1)
    return Verdict(done, picked, inner + 0.1 * (outer - inner), below)


def _within(ritz: Ritz, start: Start, picked: Chosen, needed: Array, below: Array) -> Array:
    """Whether the first `needed` values and the chosen vectors are within their bounds, the first `below` together against the others."""
    values, count = ritz.values, ritz.values.shape[1]
    edge = np.minimum(below, count - 1)[:, None]
    inner, outer = (np.take_along_axis(values, item, axis=1) for item in (edge - 1, edge))
    inside = np.arange(count) < below[:, None]
    spread = np.sqrt(np.sum(np.where(inside, (ritz.residual / values) ** 2, 0.0), axis=1, keepdims=True))
    spread = spread * inner / outer  # of Z, which is one product further than the residual's Y
    gap = 1.0 / values - 1.0 / outer
    error = np.minimum(ritz.residual, spread * spread * values / gap)
    return ((np.arange(count) >= needed[:, None]) | ((error <= start.value) & (~picked.mask | (spread / gap <= start.angle)))).all(axis=1)


def _apart(values: Array, needed: Array) -> Array:
    """How many Ritz values to take, `needed` at least, so that the next stands apart."""
    near = values[:, 1:] - values[:, :-1] <= TOGETHER * values[:, 1:]
    near = np.concatenate([near, np.zeros((len(values), 1), dtype=bool)], axis=1)
    return np.argmax(~near & (np.arange(values.shape[1]) >= needed[:, None] - 1), axis=1) + 1


def _negative(problem: Problem, stiffness: Blocks, shift: Array) -> Array:
    """How many eigenvalues lie below the shift: negative pivots of K - shift M."""
    sigma = np.where(np.isfinite(shift), shift, 0.0)[:, None, None, None]
    moved = Blocks(stiffness.own - sigma * problem.inertia.own, stiffness.edges - sigma * problem.inertia.edges)
    return np.sum(factor(problem.graph, moved).pivots < 0.0, axis=1)


def _flat(item: Array) -> Array:
    return item.reshape(len(item), -1, item.shape[-1])


def _as_block(item: Array) -> Array:
    return item.reshape(len(item), -1, 6, item.shape[-1])


def _replace(whole: _Any, part: _Any, designs: Array) -> _Any:
    """The whole with some designs' values taken from a part: every array of it, and of what it holds."""
    if isinstance(whole, np.ndarray):
        if len(designs) == len(whole):
            return part
        result = whole.copy()
        result[designs] = part
        return cast(_Any, result)
    values = (_replace(getattr(whole, field.name), getattr(part, field.name), designs) for field in fields(whole))
    return type(whole)(*values)
