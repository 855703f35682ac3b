"""A problem solved by the solid model's own forms and factorisation.

CalculiX 2.20 integrates the mass of a C3D10 by the four points of its stiffness, which are exact for quadratics only; products of two
quadratic shape functions are quartic. Ours are integrated exactly: so far are the two codes' frequencies apart, and no further.
"""

from __future__ import annotations

from dataclasses import dataclass

import ngsolve
import numpy as np
from scipy import sparse
from scipy.sparse.linalg import LinearOperator, eigsh

from flexstage.base.number import Array
from flexstage.solid.fea.geometry.piece import MILLIMETRES
from flexstage.solid.fea.meshing.mesh import PieceMesh
from flexstage.solid.fea.solver.field import Field, field, inertia, stiffness
from tests.elsewhere.calculix.problems import Problem, Solution
from tests.models.solids import solver

MODES = 6


@dataclass(frozen=True)
class Law:
    """How elements are made: polynomial `order`; the mass exact, or by as few points as CalculiX takes."""

    order: int = 2
    few_points: bool = False


def solved(problem: Problem, mesh: PieceMesh, law: Law = Law()) -> Solution:
    """Compliance of the loaded face and the lowest frequencies."""
    space = field(mesh, [problem.held], law.order)
    elastic = stiffness(space)
    mass = _sparse(_by_four_points(space)) if law.few_points else _mass(space)
    solve = solver(space, elastic)
    forces = np.column_stack([_force(space, problem.loaded, axis) for axis in range(3)])
    free = np.flatnonzero(space.free)
    full = np.zeros(space.size)

    def inverse(force: Array) -> Array:
        full[free] = force.ravel()
        return solve(full)[free]

    matrix = _sparse(elastic)[free][:, free]
    operator = LinearOperator(matrix.shape, matvec=inverse, dtype=float)  # pyright: ignore[reportCallIssue]  (its stubs know only __new__)
    start = np.random.default_rng(0).standard_normal(len(free))
    values = eigsh(matrix, k=MODES, M=mass[free][:, free], sigma=0.0, OPinv=operator, v0=start, return_eigenvectors=False)
    return Solution(forces.T @ solve(forces), np.sqrt(np.sort(values)) / (2.0 * np.pi))


def _by_four_points(space: Field) -> ngsolve.BilinearForm:
    u, v = space.space.TnT()
    form = ngsolve.BilinearForm(space.space, symmetric=True)
    rule = ngsolve.IntegrationRule(ngsolve.TET, 2)
    form += MILLIMETRES**-3 * space.density * ngsolve.InnerProduct(u, v) * ngsolve.dx(intrules={ngsolve.TET: rule})
    return form.Assemble()


def _force(space: Field, face: str, axis: int) -> Array:
    """Nodal forces (n,) of 1 N along an axis, spread evenly over a face."""
    mesh = space.meshed.mesh
    area = ngsolve.Integrate(ngsolve.CoefficientFunction(1.0), mesh, definedon=mesh.Boundaries(face))
    form = ngsolve.LinearForm(space.space)
    form += space.space.TestFunction()[axis] / area * ngsolve.ds(definedon=mesh.Boundaries(face))
    form.Assemble()
    return np.array(form.vec.FV().NumPy())


def _mass(space: Field) -> sparse.csr_matrix:
    (one,) = inertia(space).scalar
    return sparse.block_diag([one] * 3, format="csr")


def _sparse(form: ngsolve.BilinearForm) -> sparse.csr_matrix:
    values, columns, rows = form.mat.CSR()
    return sparse.csr_matrix((np.array(values), np.array(columns), np.array(rows)))
