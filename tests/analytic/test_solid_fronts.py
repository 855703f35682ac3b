"""Factors front by front against dense linear algebra and NGSolve's own, and lowest modes by blocks against dense ones."""

from __future__ import annotations

import weakref
from collections.abc import Iterator, Sequence
from itertools import islice
from typing import Any

import ngsolve
import numpy as np
import pytest
import scipy
from scipy.linalg import eigh

from flexstage.solid.fea.meshing.bar import bar
from flexstage.solid.fea.meshing.fineness import Fineness
from flexstage.solid.fea.meshing.mesh import mesh_component
from flexstage.solid.fea.solver import frontal
from flexstage.solid.fea.solver.field import Columns, factorise_kinds, field, grid, inertia, nodes_on, solve_kinds, stiffness
from flexstage.solid.fea.solver.frontal import Factorised, Fronts, dissect, factorise_fronts
from flexstage.solid.fea.solver.krylov import Pencil, lowest_modes
from tests.models.solids import solver

ORDER = 3
SPACE = field(mesh_component(bar(), Fineness(order=ORDER, block=1.0)), ["foot"], ORDER)
FREE = np.flatnonzero(SPACE.free)
ELASTIC = stiffness(SPACE)


def dense() -> np.ndarray:
    result = np.zeros((SPACE.size, SPACE.size))
    rows, columns, values = (np.array(each) for each in ELASTIC.mat.COO())
    result[rows, columns] = values
    return result


def test_motions_are_those_of_the_other_solver() -> None:
    forces = np.random.default_rng(1).standard_normal((SPACE.size, 5))
    forces[~SPACE.free] = 0.0
    found = solver(SPACE, ELASTIC)(forces)
    inverse = ELASTIC.mat.Inverse(SPACE.space.FreeDofs(), inverse="sparsecholesky")
    x, y = ngsolve.BaseVector(SPACE.size), ngsolve.BaseVector(SPACE.size)
    x.FV().NumPy()[:] = forces[:, 0]
    inverse.Mult(x, y)
    np.testing.assert_allclose(found[:, 0], y.FV().NumPy(), rtol=0, atol=1e-9 * np.abs(found[:, 0]).max())
    law = dense()[np.ix_(FREE, FREE)]
    assert np.abs(law @ found[FREE] - forces[FREE]).max() < 1e-13 * np.abs(law).max() * np.abs(found).max() * 100.0
    assert not found[~SPACE.free].any()


@pytest.mark.parametrize("definite", [0, 1, 3])
def test_forces_where_a_front_is_not_definite_are_solved_for_by_the_other_solver(monkeypatch: pytest.MonkeyPatch, definite: int) -> None:
    """With a quarter, whose mirrors hold what motions of a kind do not move, and its matrix in two parts."""
    space = field(mesh_component(bar(), Fineness(order=2), by_symmetry=True), ["foot"], 2)
    half = np.arange(space.meshed.mesh.ne) % 2 == 0
    forces = Columns(np.random.default_rng(4).standard_normal((space.size, 4)), np.arange(4))
    parts = [stiffness(space, half), stiffness(space, ~half)]
    expected = factorise_kinds(space, [stiffness(space)])(forces)

    def refuse(order: Fronts, matrices: Sequence[scipy.sparse.csr_array], held: np.ndarray) -> Iterator[Factorised]:
        yield from islice(factorise_fronts(order, matrices, held), definite)
        raise np.linalg.LinAlgError

    monkeypatch.setattr("flexstage.solid.fea.solver.field.factorise_fronts", refuse)
    np.testing.assert_allclose(factorise_kinds(space, parts)(forces), expected, rtol=0, atol=1e-9 * np.abs(expected).max())


def test_traces_are_added_alike_in_blocks_and_scattered(monkeypatch: pytest.MonkeyPatch) -> None:
    forces = np.random.default_rng(2).standard_normal((SPACE.size, 2))
    found = []
    for scattered in (0.0, np.inf):
        monkeypatch.setattr(frontal, "SCATTERED", scattered)
        found.append(solver(SPACE, ELASTIC)(forces))
    np.testing.assert_array_equal(*found)


def test_every_node_is_eliminated_once_and_its_traces_lie_beyond() -> None:
    order = dissect(grid(SPACE), SPACE.free.reshape(3, -1)[0])
    assert sorted(order.nodes) == list(np.flatnonzero(SPACE.free.reshape(3, -1)[0]))
    assert order.fronts[0].first == 0
    assert [front.last for front in order.fronts[:-1]] == [front.first for front in order.fronts[1:]]
    assert all((front.beyond >= front.last).all() for front in order.fronts)
    assert not len(order.fronts[-1].beyond)
    assert len(order.fronts) > 4


def test_fronts_are_shared_by_those_that_hold_nothing_there_and_only_by_them() -> None:
    held, forces = np.zeros((2, 3, SPACE.size // 3), dtype=bool), np.random.default_rng(3).standard_normal((SPACE.size, 2))
    held[1, 1] = nodes_on(SPACE, "end")
    held = held.reshape(2, -1)
    together = tuple(factorise_fronts(SPACE.fronts, [sparse(1.0)], held))
    for found, own in zip(together, held, strict=True):
        (alone,) = factorise_fronts(SPACE.fronts, [sparse(1.0)], own[None])
        np.testing.assert_array_equal(found.solve(forces), alone.solve(forces))
    shared = [one is other for one, other in zip(*(found.factors for found in together), strict=True)]
    assert any(shared)
    assert not shared[-1]


def test_what_is_solved_once_has_one_factor_at_a_time(monkeypatch: pytest.MonkeyPatch) -> None:
    space = field(mesh_component(bar(), Fineness(order=2), by_symmetry=True), ["foot"], 2)
    forces, law = Columns(np.random.default_rng(6).standard_normal((space.size, 4)), np.arange(4)), [stiffness(space)]
    expected, used = factorise_kinds(space, law)(forces), []

    def solve(factorised: Factorised, own: np.ndarray) -> np.ndarray:
        used.append(weakref.ref(factorised))
        return solve_whole(factorised, own)

    def eliminate(*arguments: Any) -> Any:
        assert not any(each() for each in used)
        return eliminate_whole(*arguments)

    solve_whole, eliminate_whole = Factorised.solve, frontal._eliminate_fronts
    monkeypatch.setattr(Factorised, "solve", solve)
    monkeypatch.setattr(frontal, "_eliminate_fronts", eliminate)
    np.testing.assert_array_equal(solve_kinds(space, law, forces), expected)
    assert len(used) == 4
    np.testing.assert_allclose(solve_kinds(space, law, forces.some(slice(2, 3))), expected[:, 2:3], atol=1e-12 * np.abs(expected).max())
    assert len(used) == 5


def sparse(factor: float) -> scipy.sparse.csr_array:
    values, columns, starts = ELASTIC.mat.CSR()
    return scipy.sparse.csr_array((factor * np.asarray(values), np.asarray(columns), np.asarray(starts)), shape=(SPACE.size, SPACE.size))


def test_matrices_are_added() -> None:
    forces, held = np.random.default_rng(5).standard_normal((SPACE.size, 2)), ~SPACE.free[None]
    (whole,), (added,) = (factorise_fronts(SPACE.fronts, parts, held) for parts in ([sparse(1.0)], [sparse(0.25), sparse(0.75)]))
    expected = whole.solve(forces)
    np.testing.assert_allclose(added.solve(forces), expected, rtol=0, atol=1e-9 * np.abs(expected).max())


def test_what_is_not_definite_is_refused() -> None:
    with pytest.raises(np.linalg.LinAlgError, match="not positive definite"):
        next(factorise_fronts(dissect(grid(SPACE), SPACE.free.reshape(3, -1)[0]), [sparse(-1.0)], ~SPACE.free[None]))


def test_lowest_modes_are_the_dense_ones() -> None:
    mass, solve = inertia(SPACE), solver(SPACE, ELASTIC)

    def full(x: np.ndarray) -> np.ndarray:
        result = np.zeros((SPACE.size, x.shape[1]))
        result[FREE] = x
        return result

    (found,) = lowest_modes([Pencil(lambda x: mass.times(full(x))[FREE], lambda x: solve(full(x))[FREE], len(FREE))], 8)
    law, carried = dense()[np.ix_(FREE, FREE)], mass.times(np.eye(SPACE.size)[:, FREE])[FREE]
    values, _ = eigh(law, carried, subset_by_index=(0, 7))
    np.testing.assert_allclose(np.diag(found.T @ law @ found), values, rtol=1e-8)
    np.testing.assert_allclose(found.T @ carried @ found, np.eye(8), atol=1e-9)


def test_a_mass_of_low_rank_has_as_many_modes() -> None:
    few = np.zeros((30, 1))
    few[:2] = 1.0
    found = lowest_modes([Pencil(lambda x: few * x, lambda x: x, 30), Pencil(lambda x: 0.0 * x, lambda x: x, 30)], 5)
    assert [each.shape for each in found] == [(30, 2), (30, 0)]
