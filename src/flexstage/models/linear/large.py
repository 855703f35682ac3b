"""Sparse stiffness and inertia of large stages: factors, exact solutions and the lowest modes.

The stiffness is K = G^T k G, with G the strains of all links per coordinate. In a long chain of links, rounding errors in K give rigid
motions of a section of the chain a spurious energy. Solutions are therefore refined with forces computed from the strains. If the
refinement does not converge, the equations are solved with both strains and motions as unknowns. Rigid motions are then exact. These
equations are the augmented system of weighted least squares (Bjorck, BIT 7, 1, 1967).
"""

from __future__ import annotations

from collections.abc import Generator, Iterable
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from typing import Any, cast

import numpy as np
import scipy

from flexstage.base.finding import refuse
from flexstage.base.number import Array
from flexstage.base.sparse import Sparse, as_csr, block_diagonal

SINGULAR = 1e-11
"""Smallest accepted pivot or eigenvalue of K, relative to the diagonal of K."""
_DEFINITE = 1e-12
_EXACT = 1e-13
_ENOUGH = 1e-9
_USABLE = 1e-6
"""Permitted residual of self-balanced loads, as of growing parts: the level of their rounding."""
_STEPS = 12
_SOFT = 1e-8
"""Relative compliance of rigid strains in the factor; refinement removes it."""
_RATIO, _RESTARTS = 1e-10, 100
_MASSLESS = 1e-13
_LEAST = 32
"""Number of computed modes of a large stage; the last cluster, which may be incomplete, is omitted."""


@contextmanager
def _fits(matrix: Any) -> Generator[None]:
    """Refuse a factor that does not fit into memory."""
    try:
        yield
    except MemoryError as error:
        what = f"the factor of its {matrix.shape[0]:,} equations, with {matrix.nnz:,} coefficients, does not fit into memory"
        raise refuse("stage", what, "Analyse parts of the stage, or free memory") from error


def symmetric_factor(matrix: Any) -> Any:
    """Factorise a symmetric sparse matrix in minimum-degree order. Raises `DesignError` if the factor does not fit into memory."""
    with _fits(matrix):
        return scipy.sparse.linalg.splu(matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})


@dataclass(frozen=True, eq=False)
class Quadratic:
    """Sum of contributions G^T k G: all operators stacked in G (R, n), all stiffness laws in the block-diagonal k (R, R), both sparse."""

    rows: Any
    law: Any

    @staticmethod
    def of(operators: Iterable[Sparse], laws: Iterable[Array], size: int) -> Quadratic:
        """Build the sum from operators (r, n) and laws (r, r); `size` is n."""
        return Quadratic(as_csr(operators, size), block_diagonal(laws))

    @property
    def shape(self) -> tuple[int, int]:
        """Shape (n, n)."""
        return self.rows.shape[1], self.rows.shape[1]

    def __matmul__(self, motion: Array) -> Array:
        """Multiply G^T k G by a motion (n, k), via the strains."""
        return self.rows.T @ (self.law @ (self.rows @ motion))

    def __add__(self, other: Quadratic) -> Quadratic:
        rows = scipy.sparse.vstack([self.rows, other.rows], format="csr")
        return Quadratic(rows, scipy.sparse.block_diag([self.law, other.law], format="csr"))

    def __rmul__(self, factor: float) -> Quadratic:
        return Quadratic(self.rows, factor * self.law)

    @cached_property
    def matrix(self) -> Any:
        """Assemble G^T k G as a sparse symmetric matrix."""
        total = self.rows.T @ self.law @ self.rows
        return (0.5 * (total + total.T)).tocsc()


@dataclass(frozen=True, eq=False)
class Solver:
    """Solver of K q = f for a large stage."""

    stiffness: Quadratic

    @cached_property
    def scale(self) -> Array:
        """Scale factors (n,) that make the diagonal of K equal to one."""
        diagonal = self.stiffness.matrix.diagonal()
        return np.sqrt(np.where(diagonal > 0.0, diagonal, 1.0))

    @cached_property
    def _root(self) -> Array:
        """Scale that makes the diagonal of the links' law one."""
        diagonal = np.abs(self.stiffness.law.diagonal())
        return np.sqrt(np.where(diagonal > 0.0, diagonal, 1.0))

    @cached_property
    def _factor(self) -> Any:
        over = scipy.sparse.diags_array(1.0 / self.scale)
        scaled = (over @ self.stiffness.matrix @ over).tocsc()
        return symmetric_factor(scaled)

    @cached_property
    def _augmented(self) -> tuple[Any, Any, Any]:
        """Factor of [[1, -B], [B^T k, 0]] for scaled strains and motions; B and B^T k."""
        law, root = self.stiffness.law, self._root
        rows = scipy.sparse.diags_array(root) @ self.stiffness.rows @ scipy.sparse.diags_array(1.0 / self.scale)
        pull = rows.T @ (scipy.sparse.diags_array(1.0 / root) @ law @ scipy.sparse.diags_array(1.0 / root))
        whole = scipy.sparse.block_array([[scipy.sparse.eye_array(rows.shape[0]), -rows], [pull, None]], format="csc")
        with _fits(whole):
            return scipy.sparse.linalg.splu(whole), rows, pull

    def definite(self) -> bool:
        """Whether K is positive definite: all pivots are large enough compared with the diagonal."""
        try:
            pivots = self._factor.U.diagonal()
        except RuntimeError:  # exactly singular
            return False
        return bool(np.min(pivots) > SINGULAR)

    def solve(self, load: Array) -> Array:
        """Solve K q = `load` for the coordinates q (n, k). Raises `DesignError` if double precision does not suffice."""
        try:
            motion, left = _refine(load, self._direct, self._missing)
        except RuntimeError:
            motion, left = load, np.inf
        if not left <= _ENOUGH:
            motion, left = self._with_strains(load)
        self._require(left)
        return motion

    @staticmethod
    def _require(left: float) -> None:
        if not left <= _USABLE:
            what = f"rounding limits the relative accuracy of its equations to {left:.1g} (expected at most {_USABLE:g})"
            raise refuse("stage", what, "Check for extreme stiffness ratios, or analyse parts of the stage")

    def _direct(self, load: Array) -> Array:
        over = self.scale.reshape(-1, *[1] * (load.ndim - 1))
        return self._factor.solve(load / over) / over

    def _missing(self, load: Array, motion: Array) -> Array:
        return load - self.stiffness @ motion

    def follow(self, imposed: Array) -> Array:
        """Compute q (n, k) that minimises the energy if `imposed` strains (R, k) are added to the strains of q: K q = -G^T k `imposed`.

        The strains are not converted to forces, because rounding would disturb the equilibrium of the forces. Raises `DesignError` as
        `solve` does.
        """
        motion, left = self._with_strains(np.zeros((len(self.scale), imposed.shape[1])), imposed)
        self._require(left)
        return motion

    def _with_strains(self, load: Array, imposed: Array | None = None) -> tuple[Array, float]:
        factor, rows, pull = self._augmented
        over = self.scale.reshape(-1, *[1] * (load.ndim - 1))
        count = rows.shape[0]
        strains = np.zeros((count, *load.shape[1:])) if imposed is None else self._root[:, None] * imposed
        whole = np.concatenate([strains, load / over])

        def missing(target: Array, solution: Array) -> Array:
            strain, motion = solution[:count], solution[count:]
            return np.concatenate([target[:count] - strain + rows @ motion, target[count:] - pull @ strain])

        solution, left = _refine(whole, factor.solve, missing)
        return solution[count:] / over, left


def least_strain(rows: Any, rigid: Array, imposed: Array) -> Array | None:
    """Compute motions q (n, k) that minimise the strains `rows` q + `imposed` (R, k); the strains marked in `rigid` (R,) must be zero.

    Strains and motions are both unknowns. The factorised matrix gives rigid strains a small compliance, so that redundant constraints do
    not make the matrix singular. Returns `None` if strains and constraints do not determine the motions.
    """
    count, size = rows.shape
    give = scipy.sparse.diags_array(np.where(rigid, 0.0, 1.0))
    soft = scipy.sparse.diags_array(np.where(rigid, _SOFT, 1.0))
    whole = scipy.sparse.block_array([[soft, -rows], [rows.T, None]], format="csc")

    def missing(target: Array, solution: Array) -> Array:
        force, motion = solution[:count], solution[count:]
        return np.concatenate([target[:count] - give @ force + rows @ motion, target[count:] - rows.T @ force])

    try:
        with _fits(whole):
            factor = scipy.sparse.linalg.splu(whole)
    except RuntimeError:  # exactly singular
        return None
    load = np.concatenate([imposed, np.zeros((size, imposed.shape[1]))])
    solution, left = _refine(load, factor.solve, missing, first=count)  # forces of redundant strains do not converge
    return solution[count:] if left <= _ENOUGH else None


def _refine(load: Array, solve: Any, missing: Any, first: int = 0) -> tuple[Array, float]:
    """Refine a solution until it is stationary from its `first` row on; also return its last relative change there.

    `solve` solves loads (n, k) approximately, `missing` returns the residual load of a solution.
    """
    solution = solve(load)
    last = np.inf
    for _ in range(_STEPS):
        step = solve(missing(load, solution))
        before = np.maximum(np.linalg.norm(solution[first:], axis=0), np.finfo(float).tiny)
        size = float(np.max(np.linalg.norm(step[first:], axis=0) / before, initial=0.0))
        if not size < 0.5 * last:
            break
        solution, last = solution + step, size
        if size < _EXACT:
            break
    return solution, last


def surely_definite(laws: Iterable[Array], joins: Iterable[tuple[int, int]], bodies: int) -> bool:
    """Return whether K is surely positive definite: all 6x6 link stiffnesses are positive definite, and links join all bodies to ground.

    `joins` are the pairs of joined bodies, by number; the ground has the number `bodies`.
    """
    distinct = {id(law): law for law in laws}.values()
    for law in distinct:
        root = np.sqrt(np.maximum(np.diag(law), np.finfo(float).tiny))
        if np.min(np.linalg.eigvalsh(law / root / root[:, None])) < _DEFINITE:
            return False
    ends = np.array(list(joins)).T
    graph = scipy.sparse.coo_array((np.ones(ends.shape[1]), (ends[0], ends[1])), (bodies + 1, bodies + 1))
    return bool(scipy.sparse.csgraph.connected_components(graph, directed=False)[0] == 1)


def lowest(solver: Solver, inertia: Quadratic, count: int = _LEAST) -> tuple[Array, Array]:
    """Compute the lowest eigenvalues (k,) of K phi = lambda M phi and mass-normalised shapes (n, k) by shift-and-invert Lanczos.

    The eigenvalues are Rayleigh quotients, computed from strains and motions. The start vector is constant, so that results are
    reproducible.
    """
    size = inertia.rows.shape[1]
    shape = (size, size)
    stiffness, mass, inverse = (
        scipy.sparse.linalg.LinearOperator(shape, matvec=each, dtype=float)
        for each in (lambda motion: solver.stiffness @ motion, lambda motion: inertia.matrix @ motion, solver.solve)
    )
    result = scipy.sparse.linalg.eigsh(
        stiffness, min(count, max(1, size // 3)), mass, sigma=0.0, OPinv=inverse, v0=1.0 + 0.5 * np.cos(np.arange(size)), which="LM"
    )[1]
    inverse_values, turn = scipy.linalg.eigh(result.T @ (inertia @ result), result.T @ (solver.stiffness @ result))
    kept = np.flatnonzero(inverse_values > _MASSLESS * inverse_values[-1])[::-1]
    return 1.0 / inverse_values[kept], result @ turn[:, kept] / np.sqrt(inverse_values[kept])


def least_ratios(solver: Solver, taken: Quadratic, count: int) -> tuple[Array, Array]:
    """Compute the smallest eigenvalues mu (k,) of T x = mu K x, ascending, and shapes (n, k) with x^T K x = 1; `taken` is T.

    Returns fewer than `count` values if the other eigenvalues are too close together to converge, for example many eigenvalues near zero.
    The start vector is constant.
    """
    size = taken.rows.shape[1]
    stiffness, inverse = (
        scipy.sparse.linalg.LinearOperator((size, size), matvec=each, dtype=float)
        for each in (lambda motion: solver.stiffness @ motion, solver.solve)
    )
    ways = {"which": "SA", "tol": _RATIO, "maxiter": _RESTARTS, "v0": 1.0 + 0.5 * np.cos(np.arange(size))}
    try:
        result = scipy.sparse.linalg.eigsh(taken.matrix, min(count, size - 1), stiffness, Minv=inverse, **ways)[1]
    except scipy.sparse.linalg.ArpackNoConvergence as error:
        result = error.eigenvectors
        if not result.shape[1]:
            raise refuse("stage", "the iteration for the lowest load factor does not converge", "Analyse the loads one by one") from None
    values, turn = scipy.linalg.eigh(result.T @ (taken @ result), result.T @ (solver.stiffness @ result))
    return cast("Array", values), result @ turn
