"""Elasticity on a mesh: displacements are in metres, the mesh is in millimetres, and vectors of degrees of freedom are numpy arrays."""

from __future__ import annotations

import functools
import operator
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, cast

import ngsolve
import numpy as np
import scipy

from flexstage.base.number import Array
from flexstage.solid.fea.geometry.mirror import MIRRORS, Mirrors
from flexstage.solid.fea.geometry.piece import MILLIMETRES, Medium
from flexstage.solid.fea.meshing.mesh import PieceMesh, centroids
from flexstage.solid.fea.solver.frontal import Fronts, Grid, dissect, factorise_fronts
from flexstage.spatial.frame import Frame

_PER_METRE = 1.0 / MILLIMETRES
"""Factor on energies: gradients per mm are 1e3 smaller than per m, squared, over volumes 1e9 larger."""
_PER_VOLUME = 1.0 / MILLIMETRES**3
_FEW = 0.5
"""Share of nonzero rows below which a product uses only these rows."""
_BELL = 6
"""Increase of the integration order for bell functions."""


@dataclass(frozen=True)
class Field:
    """Finite-element space of a mesh's displacements with some faces fixed; elastic constants and density as functions of position."""

    meshed: PieceMesh
    space: ngsolve.FESpace
    lame: ngsolve.CoefficientFunction
    shear: ngsolve.CoefficientFunction
    density: ngsolve.CoefficientFunction
    tensor: ngsolve.CoefficientFunction | None = None

    @property
    def size(self) -> int:
        """Number of degrees of freedom."""
        return self.space.ndof

    @property
    def whole_size(self) -> int:
        """Number of DOFs of the whole component, even if the mesh is only one side of the component; DOFs on a mirror are counted once."""
        mirrors = self.meshed.mirrors
        own = sum((nodes_on(self, MIRRORS[axis]).astype(np.int64) for axis in mirrors.axes), np.zeros(self.size // 3, dtype=np.int64))
        return 3 * int(np.sum(mirrors.copies >> own))

    @cached_property
    def members(self) -> tuple[Array, Array]:
        """All m pairs of a basis function and its element, sorted by element: functions (m,) of one displacement component, elements."""
        scalar, count = self.space.components[0], self.meshed.mesh.ne
        nodes = [np.array(scalar.GetDofNrs(ngsolve.ElementId(ngsolve.VOL, number)), dtype=np.int64) for number in range(count)]
        return np.concatenate(nodes), np.repeat(np.arange(count), [len(each) for each in nodes])

    @cached_property
    def places(self) -> Array:
        """Mean vertex position (elements, 3) of each element [m]."""
        return centroids(self.meshed.mesh)

    @cached_property
    def free(self) -> Array:
        """Mask (n,) of the degrees of freedom that are not on fixed faces."""
        return np.array([bool(bit) for bit in self.space.FreeDofs()], dtype=bool)

    @cached_property
    def linear(self) -> tuple[Array, Array]:
        """Coefficients that represent 1 (n / 3,) and x, y, z [m] (n / 3, 3) in the basis functions of one displacement component."""
        function, place = ngsolve.GridFunction(self.space.components[0]), np.empty((self.size // 3, 3))
        for axis, coordinate in enumerate(_coordinates()):
            function.Set(coordinate, dual=False)
            place[:, axis] = function.vec.FV().NumPy()
        at_vertices = np.arange(self.size // 3) < self.meshed.mesh.nv  # higher-order functions are zero there
        return at_vertices.astype(float), place / MILLIMETRES

    @cached_property
    def fronts(self) -> Fronts:
        """The elimination order of the free nodes."""
        return dissect(grid(self), self.free.reshape(3, -1)[0])

    def stress(self, strain: ngsolve.CoefficientFunction) -> ngsolve.CoefficientFunction:
        """Apply Hooke's law, 2 mu strain + lambda tr(strain) I, or the tensor of a crystal [Pa if the strain is dimensionless]."""
        if self.tensor is not None:
            pairs = [(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)]
            found = self.tensor * ngsolve.CoefficientFunction(tuple(strain[i, j] + (0.0 if i == j else strain[j, i]) for i, j in pairs))
            return ngsolve.CoefficientFunction(tuple(found[entry] for entry in (0, 5, 4, 5, 1, 3, 4, 3, 2)), dims=(3, 3))
        return 2.0 * self.shear * strain + self.lame * ngsolve.Trace(strain) * ngsolve.Id(3)


def field(meshed: PieceMesh, held: Iterable[str], order: int) -> Field:
    """Build the displacement space of this `order` on a mesh with the faces `held` fixed; `finer` elements have one order more.

    >>> from flexstage.solid.fea.meshing.bar import bar
    >>> from flexstage.solid.fea.meshing.fineness import Fineness
    >>> from flexstage.solid.fea.meshing.mesh import mesh_component
    >>> space = field(mesh_component(bar(), Fineness(order=2)), ["foot"], 2)
    >>> space.size == 3 * (space.size // 3) and not space.free.all()
    True
    """
    mesh = meshed.mesh
    pattern = "|".join(_escape(name) for name in held)
    scalar = ngsolve.H1(mesh, order=order, dirichlet=pattern) if pattern else ngsolve.H1(mesh, order=order)
    if meshed.finer.any():
        for number in np.flatnonzero(meshed.finer).tolist():
            element = mesh[ngsolve.ElementId(ngsolve.VOL, number)]
            for node in (*element.edges, *element.faces, ngsolve.NodeId(ngsolve.CELL, number)):
                scalar.SetOrder(node, order + 1)
        scalar.UpdateDofTables()

    def coefficient(values: list[float]) -> ngsolve.CoefficientFunction:
        return mesh.MaterialCF({f"medium {number}": value for number, value in enumerate(values)})

    media = meshed.media
    return Field(
        meshed,
        ngsolve.VectorValued(scalar),
        coefficient([medium.lame for medium in media]),
        coefficient([medium.shear for medium in media]),
        coefficient([medium.density for medium in media]),
        _tensor([hooke(medium) for medium in media], coefficient) if any(medium.tensor for medium in media) else None,
    )


def hooke(medium: Medium) -> Array:
    """Return the stiffness (6, 6) of a medium [Pa] for the strains xx, yy, zz, yz, xz, xy, with engineering shear.

    >>> hooke(Medium(1.0, 0.25, 1.0))[0].round(9).tolist()
    [1.2, 0.4, 0.4, 0.0, 0.0, 0.0]
    """
    if medium.tensor is not None:
        return np.array(medium.tensor)
    return medium.lame * np.pad(np.ones((3, 3)), (0, 3)) + medium.shear * np.diag([2.0, 2.0, 2.0, 1.0, 1.0, 1.0])


def _tensor(rows: list[Array], coefficient: Callable[[list[float]], ngsolve.CoefficientFunction]) -> ngsolve.CoefficientFunction:
    entries = np.stack(rows, axis=-1).reshape(36, -1)
    return ngsolve.CoefficientFunction(tuple(coefficient([float(value) for value in entry]) for entry in entries), dims=(6, 6))


def _escape(name: str) -> str:
    return "".join(f"\\{letter}" if letter in ".+*?()[]{}|^$\\" else letter for letter in name)


def strain(displacement: ngsolve.CoefficientFunction) -> ngsolve.CoefficientFunction:
    """Compute the small strain: derivatives of a displacement with respect to coordinates in mm.

    >>> from flexstage.solid.fea.meshing.bar import bar
    >>> from flexstage.solid.fea.meshing.fineness import Fineness
    >>> from flexstage.solid.fea.meshing.mesh import mesh_component
    >>> space = field(mesh_component(bar(), Fineness(order=2)), ["foot"], 2)
    >>> function = ngsolve.GridFunction(space.space)
    >>> function.Set(ngsolve.CF((1e-3 * ngsolve.x, 0, 0)))
    >>> round(ngsolve.Integrate(strain(function)[0, 0], space.meshed.mesh), 6)  # 1e-3 over 10 000 mm^3
    10.0
    """
    return 0.5 * (ngsolve.Grad(displacement) + ngsolve.Grad(displacement).trans)


def stiffness(space: Field, elements: Array | None = None, *, assemble: bool = True, shift: float = 0.0) -> ngsolve.BilinearForm:
    """Build the elastic form: the integral of stress(u) : strain(v) [N/m] over some elements (mask) or all, for two motions u and v.

    A form that is not assembled can be used only with `apply_form`. `shift` times the inertia is added, so that a form without support is
    positive definite.

    >>> from flexstage.solid.fea.meshing.bar import bar
    >>> from flexstage.solid.fea.meshing.fineness import Fineness
    >>> from flexstage.solid.fea.meshing.mesh import mesh_component
    >>> space = field(mesh_component(bar(), Fineness(order=2)), ["foot"], 2)
    >>> forces = times([stiffness(space)], rigid(space, Frame(np.eye(3), np.zeros(3))))
    >>> bool(np.abs(forces).max() < 1e-3)  # N per m and rad, of a bar of 1e8 N/m
    True
    >>> moved = rigid(space, Frame(np.eye(3), np.zeros(3)))[:, :1]
    >>> round((moved.T @ times([stiffness(space, shift=100.0)], moved)).item(), 5)  # 100 / s^2 times 10 g
    1.0
    """
    u, v = space.space.TnT()
    form = ngsolve.BilinearForm(space.space, symmetric=True, nonassemble=not assemble)
    form += _PER_METRE * ngsolve.InnerProduct(space.stress(strain(u)), strain(v)) * _volume(elements)
    if shift:
        form += shift * _PER_VOLUME * space.density * ngsolve.InnerProduct(u, v) * _volume(elements)
    return form.Assemble() if assemble else form


@dataclass(frozen=True, eq=False)
class Inertia:
    """The integral of rho u . v dV [kg] for motions u and v; each displacement component's matrix (n / 3, n / 3) is the sum of `scalar`."""

    scalar: tuple[Any, ...]

    def times(self, vectors: Array) -> Array:
        """Compute the momenta (n, k) of velocities (n, k)."""
        count, columns = len(vectors) // 3, vectors.shape[1]
        each = vectors.reshape(3, count, columns).transpose(1, 0, 2).reshape(count, 3 * columns)
        moved = functools.reduce(operator.iadd, (_symmetric_times(matrix, each) for matrix in self.scalar))
        return moved.reshape(count, 3, columns).transpose(1, 0, 2).reshape(3 * count, columns)


def total(parts: Sequence[Inertia]) -> Inertia:
    """Return the sum of inertias.

    >>> one = Inertia((scipy.sparse.csr_array(np.eye(1)),))
    >>> total([one, one]).times(np.ones((3, 1))).tolist()
    [[2.0], [2.0], [2.0]]
    """
    return Inertia(tuple(matrix for part in parts for matrix in part.scalar))


def inertia(space: Field, elements: Array | None = None) -> Inertia:
    """Build the inertia of some elements (mask) or all.

    >>> from flexstage.solid.fea.meshing.bar import bar
    >>> from flexstage.solid.fea.meshing.fineness import Fineness
    >>> from flexstage.solid.fea.meshing.mesh import mesh_component
    >>> space = field(mesh_component(bar(), Fineness(order=2)), ["foot"], 2)
    >>> moved = rigid(space, Frame(np.eye(3), np.zeros(3)))[:, :1]
    >>> round((moved.T @ inertia(space).times(moved)).item(), 9)  # the bar's 10 g
    0.01
    """
    scalar = space.space.components[0]
    u, v = scalar.TnT()
    form = ngsolve.BilinearForm(scalar, symmetric=True)
    form += _PER_VOLUME * space.density * u * v * _volume(elements)
    form.Assemble()
    return Inertia((_matrix(form).copy(),))


def _volume(elements: Array | None) -> object:
    return ngsolve.dx if elements is None else ngsolve.dx(definedonelements=ngsolve.BitArray(elements.tolist()))


def apply_form(form: ngsolve.BilinearForm, vectors: Array) -> Array:
    """Apply a form to columns (n, k), without assembling its matrix.

    >>> from flexstage.solid.fea.meshing.bar import bar
    >>> from flexstage.solid.fea.meshing.fineness import Fineness
    >>> from flexstage.solid.fea.meshing.mesh import mesh_component
    >>> space = field(mesh_component(bar(), Fineness(order=2)), ["foot"], 2)
    >>> moved = rigid(space, Frame(np.eye(3), np.zeros(3)))
    >>> bool(np.abs(apply_form(stiffness(space, assemble=False), moved)).max() < 1e-3)
    True
    """
    return _apply_by_columns(form.Apply, vectors)


def _apply_by_columns(operator: Callable[[ngsolve.BaseVector, ngsolve.BaseVector], object], vectors: Array) -> Array:
    """Columns (n, k) that an operator, which writes to its second vector, computes from columns (n, k)."""
    x, y = ngsolve.BaseVector(len(vectors)), ngsolve.BaseVector(len(vectors))
    result = np.empty_like(vectors)
    for number in range(vectors.shape[1]):
        x.FV().NumPy()[:] = vectors[:, number]
        operator(x, y)
        result[:, number] = y.FV().NumPy()
    return result


def stroke_force(space: Field, frame: Frame, length: float) -> Array:
    """Compute the forces (n,) of a unit free stroke: the integrals of C e0 : strain(v) over the volume, for each basis function v.

    C is the elastic tensor; e0 = x x^T / length is a uniform strain along the unit vector x of the frame's x axis.

    >>> from flexstage.solid.fea.meshing.bar import bar
    >>> from flexstage.solid.fea.meshing.fineness import Fineness
    >>> from flexstage.solid.fea.meshing.mesh import mesh_component
    >>> space = field(mesh_component(bar(), Fineness(order=2)), ["foot"], 2)
    >>> end = Frame(np.eye(3), np.array([0.1, 0.0, 0.0]))
    >>> force = stroke_force(space, Frame(np.eye(3), np.zeros(3)), 0.1)
    >>> motion = solve_kinds(space, [stiffness(space)], Columns.of(force[:, None]))
    >>> round(float((mean_motion(space, end, "end") @ motion)[0, 0]), 9)  # a unit stroke lengthens it by one
    1.0
    """
    axis = np.outer(frame.rotation[:, 0], frame.rotation[:, 0]) / length
    imposed = ngsolve.CoefficientFunction(tuple(axis.ravel()), dims=(3, 3))
    v = space.space.TestFunction()
    # Strains of v are per mm: one factor 1e3; the volume 1e-9.
    return _integrals(space, MILLIMETRES * _PER_VOLUME * ngsolve.InnerProduct(space.stress(imposed), strain(v)) * ngsolve.dx)


def rigid(space: Field, frame: Frame, faces: str | None = None) -> Array:
    """Return the six rigid motions (n, 6) about a frame's origin, in the frame's axes, on all elements or only on the specified `faces`.

    The motions are translations of 1 m and rotations of 1 rad.

    >>> from flexstage.solid.fea.meshing.bar import bar
    >>> from flexstage.solid.fea.meshing.fineness import Fineness
    >>> from flexstage.solid.fea.meshing.mesh import mesh_component
    >>> space = field(mesh_component(bar(), Fineness(order=2)), ["foot"], 2)
    >>> end = Frame(np.eye(3), np.array([0.1, 0.0, 0.0]))
    >>> (mean_motion(space, end, "end") @ rigid(space, end)).round(9).tolist() == np.eye(6).tolist()
    True
    """
    if faces is not None:
        return _interpolated_on(space, [_rigid_motion(frame, axis) for axis in range(6)], faces)
    one, place = space.linear
    arm = place - one[:, None] * frame.position
    axes = frame.rotation.T
    motions = [*(np.outer(one, axis) for axis in axes), *(np.cross(axis, arm) for axis in axes)]
    return np.stack([motion.T.ravel() for motion in motions], axis=1)


def warping_motion(space: Field, frame: Frame, size: float, faces: str) -> Array:
    """Return the twelve non-rigid motions (n, 12) that are linear or quadratic over a face, which is normal to a frame's x axis.

    Here y and z are divided by `size` [m]. In the frame's axes, the first three motions are the strains along y and z, and the shear in the
    y-z plane. In the other nine motions, u_x, u_y or u_z is y^2, y z or z^2.

    >>> from flexstage.solid.fea.meshing.bar import bar
    >>> from flexstage.solid.fea.meshing.fineness import Fineness
    >>> from flexstage.solid.fea.meshing.mesh import mesh_component
    >>> space = field(mesh_component(bar(), Fineness(order=2)), ["foot"], 2)
    >>> end = Frame(np.eye(3), np.array([0.1, 0.0, 0.0]))
    >>> from flexstage.solid.fea.meshing.fineness import WARPS
    >>> warping_motion(space, end, 0.01, "end").shape == (space.size, WARPS)
    True
    """
    across = [sum(float(c) * a for c, a in zip(frame.rotation[:, k], _arm(frame.position), strict=True)) * (1.0 / size) for k in (1, 2)]
    y, z = across
    square = (y * y, y * z, z * z)
    local = [(0, y, 0), (0, 0, z), (0, z, y), *(tuple(f if k == axis else 0 for k in range(3)) for axis in range(3) for f in square)]
    turn = ngsolve.CoefficientFunction(tuple(frame.rotation.ravel().tolist()), dims=(3, 3))
    return _interpolated_on(space, [turn * ngsolve.CoefficientFunction(each) for each in local], faces)


def warp_kinds(mirrors: Mirrors, frame: Frame) -> Array:
    """Return the kinds (12,) of the motions of `warping_motion`: whether each motion is odd or even across each mirror (see `Mirrors`).

    >>> warp_kinds(Mirrors((1,)), Frame(np.eye(3), np.zeros(3))).tolist()
    [0, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0]
    """
    terms = np.array([(1, 1, 0), (2, 0, 1), (1, 0, 1), *((axis, *powers) for axis in range(3) for powers in ((2, 0), (1, 1), (0, 2)))])
    across = [int(np.argmax(np.abs(frame.rotation[axis]))) for axis in mirrors.axes]
    odd = [(terms[:, 0] == column) ^ (terms[:, column] % 2 == 1) for column in across]
    return mirrors.kinds(np.reshape(odd, (len(across), len(terms))))


def _rigid_motion(frame: Frame, axis: int) -> ngsolve.CoefficientFunction:
    direction = frame.rotation[:, axis % 3]
    if axis < 3:
        return ngsolve.CoefficientFunction(tuple(float(value) for value in direction))
    arm = _arm(frame.position)
    a, b, c = (float(value) for value in direction)
    return ngsolve.CoefficientFunction((b * arm[2] - c * arm[1], c * arm[0] - a * arm[2], a * arm[1] - b * arm[0]))


def _arm(start: Array) -> list[ngsolve.CoefficientFunction]:
    """The vector from a point [m]."""
    return [coordinate * (1.0 / MILLIMETRES) - float(at) for coordinate, at in zip(_coordinates(), start, strict=True)]


def _coordinates() -> tuple[ngsolve.CoefficientFunction, ...]:
    return ngsolve.x, ngsolve.y, ngsolve.z


def _interpolated_on(space: Field, columns: list[ngsolve.CoefficientFunction], faces: str) -> Array:
    result = np.empty((space.size, len(columns)))
    function = ngsolve.GridFunction(space.space)
    for number, column in enumerate(columns):
        function.Set(column, definedon=space.meshed.mesh.Boundaries(_escape(faces)))
        result[:, number] = function.vec.FV().NumPy()
    return result


def degrees_of(space: Field, elements: Array) -> Array:
    """Return a mask (n,) of the degrees of freedom of some elements (mask).

    >>> from flexstage.solid.fea.meshing.bar import bar
    >>> from flexstage.solid.fea.meshing.fineness import Fineness
    >>> from flexstage.solid.fea.meshing.mesh import mesh_component
    >>> space = field(mesh_component(bar(), Fineness(order=2)), ["foot"], 2)
    >>> bool(degrees_of(space, np.ones(space.meshed.mesh.ne, dtype=bool)).all())
    True
    """
    nodes, owners = space.members
    result = np.zeros(space.size // 3, dtype=bool)
    result[nodes[elements[owners]]] = True
    return np.tile(result, 3)


def nodes_on(space: Field, face: str) -> Array:
    """Return a mask (n / 3,) of the basis functions of one displacement component that belong to a named face.

    >>> from flexstage.solid.fea.meshing.bar import bar
    >>> from flexstage.solid.fea.meshing.fineness import Fineness
    >>> from flexstage.solid.fea.meshing.mesh import mesh_component
    >>> space = field(mesh_component(bar(), Fineness(order=2)), ["foot"], 2)
    >>> bool(np.all(nodes_on(space, "foot") == ~space.free.reshape(3, -1)[0]))
    True
    """
    found = space.space.components[0].GetDofs(space.meshed.mesh.Boundaries(_escape(face)))
    return np.array(list(found), dtype=bool)


def mean_motion(space: Field, frame: Frame, face: str) -> Array:
    """Compute the rows (6, n) that map a motion u to the mean twist of a face in a frame.

    The mean twist is G^-1 int R^T u dS with G = int R^T R dS over the face; the columns of R are the six rigid motions.

    >>> from flexstage.solid.fea.meshing.bar import bar
    >>> from flexstage.solid.fea.meshing.fineness import Fineness
    >>> from flexstage.solid.fea.meshing.mesh import mesh_component
    >>> space = field(mesh_component(bar(), Fineness(order=2)), ["foot"], 2)
    >>> end = Frame(np.eye(3), np.array([0.1, 0.0, 0.0]))
    >>> mean = mean_motion(space, end, "end")
    >>> round(1e-6 / float((mean @ solve_kinds(space, [stiffness(space)], Columns.of(mean.T)))[0, 0]), 6)  # E A / L, N/um
    100.0
    """
    return _mean_twist(space, frame, lambda work: work * ngsolve.ds(_escape(face)))


def _mean_twist(space: Field, frame: Frame, over: Callable[[ngsolve.CoefficientFunction], Any]) -> Array:
    """Rows (6, n) of a mean twist in a frame; `over` weighs an integrand on a surface."""
    v = space.space.TestFunction()
    rows = np.array([_integrals(space, over(ngsolve.InnerProduct(_rigid_motion(frame, axis), v))) for axis in range(6)])
    return np.linalg.solve(rows @ rigid(space, frame), rows)


def _integrals(space: Field, integrand: Any) -> Array:
    """Integrals (n,) for each basis function."""
    form = ngsolve.LinearForm(space.space)
    form += integrand
    form.Assemble()
    return np.array(form.vec.FV().NumPy())


def seat_motion(space: Field, point: Array, reach: float, faces: Array) -> Array:
    """Compute the rows (6, n) that map a motion to the mean twist of surface elements `faces` (mask) about a point, in the field's axes.

    The mean has the weight exp(-(d^2 - d0^2) / reach^2), where d is the distance of a surface point from the given point, and d0 is the
    smallest distance. On a flat face, the weight is a bell curve around the point's perpendicular projection; on a sphere about the point,
    it is uniform.

    >>> from flexstage.solid.fea.meshing.bar import bar
    >>> from flexstage.solid.fea.meshing.fineness import Fineness
    >>> from flexstage.solid.fea.meshing.mesh import mesh_component
    >>> space = field(mesh_component(bar(), Fineness(order=2)), ["foot"], 2)
    >>> at = np.array([0.1, 0.0, 0.0])
    >>> rows = seat_motion(space, at, 0.005, np.ones(space.meshed.mesh.GetNE(ngsolve.BND), dtype=bool))
    >>> bool(np.allclose(rows @ rigid(space, Frame(np.eye(3), at)), np.eye(6)))
    True
    """
    mesh = space.meshed.mesh
    used = np.array([[vertex.nr for vertex in element.vertices] for element in mesh.Elements(ngsolve.BND)])[faces]
    places = np.array([mesh.vertices[int(number)].point for number in np.unique(used)]) / MILLIMETRES
    least = float(np.min(np.sum((places - point) ** 2, axis=1)))
    bell = ngsolve.exp((least - sum(each**2 for each in _arm(point))) * (1.0 / reach**2))
    around = ngsolve.ds(definedonelements=ngsolve.BitArray(faces.tolist()), bonus_intorder=_BELL)
    return _mean_twist(space, Frame(np.eye(3), point), lambda work: bell * work * around)


Forms = Sequence[ngsolve.BilinearForm]
"""Assembled forms, each over some elements; the list represents the sum of the forms."""


def times(forms: Forms, vectors: Array) -> Array:
    """Multiply columns (n, k) by the sum of the matrices of assembled forms.

    >>> from flexstage.solid.fea.meshing.bar import bar
    >>> from flexstage.solid.fea.meshing.fineness import Fineness
    >>> from flexstage.solid.fea.meshing.mesh import mesh_component
    >>> space = field(mesh_component(bar(), Fineness(order=2)), ["foot"], 2)
    >>> times([stiffness(space)], np.zeros((space.size, 2))).shape == (space.size, 2)
    True
    """
    return functools.reduce(operator.iadd, (_symmetric_times(matrix, vectors) for matrix in map(_matrix, forms)))


def _symmetric_times(matrix: Any, vectors: Array) -> Array:
    """A symmetric matrix times vectors (n, k); with few nonzero entries, by their rows."""
    moving = vectors.any(axis=1)
    return matrix @ vectors if np.mean(moving) > _FEW else matrix[moving].T @ vectors[moving]


def _matrix(form: ngsolve.BilinearForm) -> Any:
    """The matrix (n, n) of a form as `scipy.sparse.csr_array`, sharing its memory."""
    return scipy.sparse.csr_array(tuple(np.asarray(each) for each in form.mat.CSR()), shape=(form.mat.height, form.mat.width))


def held_at_mirrors(space: Field, kind: int) -> Array:
    """Return a mask (n,) of DOFs at mirrors that are zero in motions of a kind: normal DOFs for even motions, tangential DOFs for odd ones.

    >>> from flexstage.solid.fea.meshing.bar import bar
    >>> from flexstage.solid.fea.meshing.fineness import Fineness
    >>> from flexstage.solid.fea.meshing.mesh import mesh_component
    >>> held_at_mirrors(field(mesh_component(bar(), Fineness(order=2)), ["foot"], 2), 0).any()  # it is whole
    np.False_
    """
    mirrors, held = space.meshed.mirrors, np.zeros((3, space.size // 3), dtype=bool)
    for axis in mirrors.axes:
        across = np.arange(3) == axis
        held[across != mirrors.is_odd(np.array(kind), axis)] |= nodes_on(space, MIRRORS[axis])
    return held.ravel()


Solver = Callable[[Array], Array]


@dataclass(frozen=True, eq=False)
class Columns:
    """Motions or forces (n, k) as columns, and the symmetry `kinds` (k,) of the columns (see `Mirrors`)."""

    values: Array
    kinds: Array

    @staticmethod
    def of(values: Array) -> Columns:
        """Make columns for a mesh without mirrors, in which all motions are of one kind."""
        return Columns(values, np.zeros(values.shape[1], dtype=np.int64))

    def kind(self, kind: int) -> Array:
        """Return the columns of one kind."""
        return self.values[:, self.kinds == kind]

    def some(self, columns: slice) -> Columns:
        """Return a slice of the columns."""
        return Columns(self.values[:, columns], self.kinds[columns])


def concatenate(columns: Sequence[Columns]) -> Columns:
    """Concatenate columns.

    >>> concatenate([Columns.of(np.zeros((3, 2))), Columns.of(np.ones((3, 1)))]).values[0].tolist()
    [0.0, 0.0, 1.0]
    """
    return Columns(np.hstack([each.values for each in columns]), np.concatenate([each.kinds for each in columns]))


KindSolver = Callable[[Columns], Array]
"""Function that returns displacements (n, k) for forces."""


def factorise_kinds(space: Field, forms: Forms) -> KindSolver:
    """Return a solver for forces of all kinds; its matrix is the sum of the forms' matrices. The solver keeps one matrix factor per kind.

    >>> from flexstage.solid.fea.meshing.bar import bar
    >>> from flexstage.solid.fea.meshing.fineness import Fineness
    >>> from flexstage.solid.fea.meshing.mesh import mesh_component
    >>> space = field(mesh_component(bar(), Fineness(order=2), by_symmetry=True), ["foot"], 2)
    >>> factorise_kinds(space, [stiffness(space)])(Columns(np.zeros((space.size, 4)), np.arange(4))).shape == (space.size, 4)
    True
    """
    solvers = list(_solvers(space, forms, range(space.meshed.mirrors.copies)))
    return lambda forces: _solve_each(forces, solvers.__getitem__)


def solve_kinds(space: Field, forms: Forms, forces: Columns) -> Array:
    """Solve for the displacements due to forces, with the sum of the forms' matrices, one kind after another; keep no matrix factor.

    >>> from flexstage.solid.fea.meshing.bar import bar
    >>> from flexstage.solid.fea.meshing.fineness import Fineness
    >>> from flexstage.solid.fea.meshing.mesh import mesh_component
    >>> space = field(mesh_component(bar(), Fineness(order=2), by_symmetry=True), ["foot"], 2)
    >>> forces, law = Columns(np.ones((space.size, 4)), np.arange(4)), [stiffness(space)]
    >>> np.array_equal(solve_kinds(space, law, forces), factorise_kinds(space, law)(forces))
    True
    """
    solvers = _solvers(space, forms, np.unique(forces.kinds))
    return _solve_each(forces, lambda _kind: next(solvers))


def _solve_each(forces: Columns, solver: Callable[[int], Solver]) -> Array:
    """Displacements from forces, kind after kind, each by its solver."""
    result = np.empty_like(forces.values)
    for kind in np.unique(forces.kinds):
        result[:, forces.kinds == kind] = solver(kind)(forces.kind(kind))
    return result


def _solvers(space: Field, forms: Forms, kinds: Iterable[int]) -> Iterator[Solver]:
    """Solvers for forces (n, k) of each of some kinds, made when needed."""
    matrices, held = [_matrix(form) for form in forms], [held_at_mirrors(space, kind) for kind in kinds]
    done = 0
    try:
        for solve in map(operator.attrgetter("solve"), factorise_fronts(space.fronts, matrices, np.array(held))):
            yield solve
            del solve  # frees its large factor
            done += 1
    except np.linalg.LinAlgError:  # very thin part: rounding makes eigenvalues negative
        entries = functools.reduce(operator.add, matrices).tocoo()
        create = cast("Callable[..., ngsolve.BaseMatrix]", ngsolve.la.SparseMatrixd.CreateFromCOO)
        law = create(entries.row, entries.col, entries.data, space.size, space.size)
        for also in held[done:]:
            inverse = law.Inverse(ngsolve.BitArray((space.free & ~also).tolist()), inverse="sparsecholesky")
            yield functools.partial(_apply_held, inverse.Mult, also)


def _apply_held(operator: Callable[[ngsolve.BaseVector, ngsolve.BaseVector], object], held: Array, forces: Array) -> Array:
    return _apply_by_columns(operator, np.where(held[:, None], 0.0, forces))


def grid(space: Field) -> Grid:
    """Return the elements and nodes of a field, as input for `dissect`.

    >>> from flexstage.solid.fea.meshing.bar import bar
    >>> from flexstage.solid.fea.meshing.fineness import Fineness
    >>> from flexstage.solid.fea.meshing.mesh import mesh_component
    >>> space = field(mesh_component(bar(), Fineness(order=2)), ["foot"], 2)
    >>> 3 * grid(space).count == space.size
    True
    """
    nodes, elements = space.members
    return Grid(
        faces=np.array([[face.nr for face in element.faces] for element in space.meshed.mesh.Elements(ngsolve.VOL)]),
        places=space.places,
        nodes=nodes,
        elements=elements,
        count=space.size // 3,
    )
