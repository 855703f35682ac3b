"""6x6 compliance matrix of a hinge by three-dimensional elasticity, between the ends of its arcs, with an error estimate.

The outer faces of the model are rigid. At each end on a block (root), a piece of this block (stub) is between the hinge and the outer face.
The compliances of the stubs as beams are then subtracted, so that the compliance of the roots remains with the hinge. An end without a root
is rigid at the end of its arcs. A symmetric hinge is cut at its planes of symmetry: each of the six motions is even or odd about each
plane, so a quarter with matching constraints suffices.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import ngsolve
import numpy as np

from flexstage.base.arguments import check_arguments
from flexstage.base.finding import Finding, refuse, require
from flexstage.base.number import Array
from flexstage.parts.material import Material
from flexstage.parts.part import is_actuator
from flexstage.parts.profile import Contour, Filleted
from flexstage.parts.shape import Profiled, Shaped
from flexstage.solid.fea.geometry.draw import specimen
from flexstage.solid.fea.geometry.mirror import MIRRORS
from flexstage.solid.fea.geometry.piece import Medium, is_mirrored, medium, span
from flexstage.solid.fea.hinges.hinge_form import LEAVE, NO_ESTIMATE, HingeSolid
from flexstage.solid.fea.hinges.roots import Roots, own_roots, rises
from flexstage.solid.fea.hinges.specimen import END, START, Specimen, own_stub
from flexstage.solid.fea.hinges.stub import beam
from flexstage.solid.fea.jobs.memory import Counts
from flexstage.solid.fea.jobs.progress import Stage
from flexstage.solid.fea.jobs.worker import Call
from flexstage.solid.fea.meshing.estimate import Accuracy, change, remaining
from flexstage.solid.fea.meshing.fineness import Fineness, is_thin
from flexstage.solid.fea.meshing.mesh import PieceMesh, core_points, generate_mesh, restrict_sizes
from flexstage.solid.fea.solver.field import Columns, Field, apply_form, field, rigid, solve_kinds, stiffness, times
from flexstage.spatial.frame import identity, transport

_SYMMETRY = 1e-8
_LATTICE, _INSIDE = 6, 0.015
"""Steps of the lattice of points in an element, and the lattice's distance from the faces, equal to that of the integration points."""
_BLUNT = 5e-4
"""Relative change of the compliance at the hinge's end due to blunted wedges of arcs at rigid faces: twice the largest observed change."""
_NECK = Fineness().neck
"""Elements within round necks are as in a stage."""
_TELLING, _TELLING_THIN = 3, 4
"""Lowest order at which the change from the previous order is a sufficient error estimate; flat elements of order two lock."""
_COARSER = 1.3
"""Factor on the element size if the mesh with the usual element size has too many DOFs."""
_ATTEMPTS = (
    (1.0, 0.5, 1.2),
    (1.0, 0.5, 1.6),
    (1.0, 0.5, 2.0),
    (1.0, 0.4, 3.0),
    (0.8, 0.5, 2.0),
    (0.8, 0.3, 3.0),
    (0.6, 0.5, 2.5),
    (0.6, 0.3, 4.0),
    (0.4, 0.3, 3.0),
)
"""Factors on element sizes, grading and segments per radius of curvature; the mesher tries them in this order."""


@dataclass(frozen=True, eq=False)
class _Solve:
    stiffness: Array
    freedoms: int
    elements: int
    order: int


@dataclass(frozen=True, eq=False)
class _Subject:
    """A hinge of a `medium` with stubs of these lengths [m] at its first and second end, zero for a rigid end."""

    part: Shaped
    medium: Medium
    first: float
    second: float

    @staticmethod
    def of(part: Shaped, own: Medium, stub: float | None, roots: Roots) -> _Subject:
        """Make a hinge with stubs of the specified length, or their own, at the ends with roots."""
        length = own_stub(part)[1] if stub is None else stub
        return _Subject(part, own, length if roots.first else 0.0, length if roots.second else 0.0)

    @property
    def blunting_error(self) -> float:
        """Error from blunted arcs at a rigid face."""
        is_blunt = isinstance(self.part, Profiled) and not isinstance(self.part.profile, Contour) and rises(self.part)
        return _BLUNT if is_blunt and min(self.first, self.second) == 0.0 else 0.0

    @property
    def stubs(self) -> Array:
        """Compliance (6, 6) of both stubs about the hinge's centre."""
        section, total = own_stub(self.part)[0], np.zeros((6, 6))
        for sign, length in ((-1.0, self.first), (1.0, self.second)):
            if length > 0.0:
                total += _about_centre(beam(section, length, self.medium), sign * 0.5 * (span(self.part) + length))
        return total

    def draw(self, size: float) -> Specimen:
        """The specimen, cut if hinge and medium are symmetric; not through the thickness of leaves: their elements are flat."""
        across = [axis for axis in MIRRORS if is_mirrored(self.medium, axis) and not (axis == 1 and self.part.slender)]
        return specimen(self.part, (self.first, self.second), size).cut(across)


_NOBODY = Call()


@check_arguments
def hinge_compliance(
    part: Shaped,
    material: Material,
    accuracy: Accuracy | None = None,
    stub: float | None = None,
    told: Call = _NOBODY,
    *,
    roots: Roots | None = None,
) -> HingeSolid:
    """Compute the 6x6 compliance matrix of a hinge by finite elements, to the required accuracy (default 1 %).

    One outer face is fixed, and the other is moved rigidly by each of six unit motions about the centre. The displacements u_i due to unit
    motion i give the stiffness K_ij = u_i^T K_FE u_j, with the finite-element stiffness matrix K_FE. A stub is a piece of the adjacent
    block, between an end of the hinge and the outer face. The compliances of the stubs about the hinge's centre are subtracted from the
    compliance K^-1. First the element order is raised, then the mesh is refined, until the error estimated from the last changes of the
    result (`estimate.remaining`) is at most `accuracy.error`.

    `roots` selects the ends that have a stub; the other ends are rigid. By default, both ends have stubs if the profile rises to the full
    height of the hinge; otherwise both ends are rigid. `stub` [m] is the length of a stub. The default length is the height of the hinge's
    end if the profile rises to it, otherwise five times the hinge's length scale `grain`.

    The choice of the stub's length is a convention. Another choice changes the compliance along x by 1 to 3 % and along y by about 10 %. If
    the hinge is several times wider than high, another choice changes the compliance about x by a large factor. Raises `DesignError` for a
    part without a shape, for a batch, and if no mesh can be made. The functions in `told` report every mesh and solution.

    >>> from flexstage.parts.neck import Neck
    >>> from flexstage.parts.profile import Straight
    >>> steel = Material(young=200e9, poisson=0.3, density=7750.0)
    >>> coarse = Accuracy(error=0.5, orders=(2, 3), meshes=1)
    >>> bar = hinge_compliance(Neck("steel", 1e-3, Straight(0.01), width=2e-3), steel, coarse)
    >>> round(float(bar.compliance[0, 0]) * 200e9 * 1e-3 * 2e-3 / 0.01, 1), bar.stub, bar.finding is None
    (1.0, 0.0, True)
    """
    required = accuracy or Accuracy()
    require(_refusals(part))
    own = medium(material)
    subject = _Subject.of(part, own, stub, roots or own_roots(part))
    taken, blunt = subject.stubs, subject.blunting_error
    found: list[Array] = []
    last = None
    for last in _solves(subject, required, told):
        found.append(_symmetrise(np.linalg.inv(last.stiffness)) - taken)
        if blunt + _error(part, found) <= required.error:
            break
    if last is None:
        what = f"its coarsest mesh has more than the {required.freedoms} DOFs allowed"
        raise refuse(_label(part), what, "Raise the limit in Python: hinge_compliance(..., Accuracy(freedoms=NUMBER))")
    alone, error = found[-1], blunt + _error(part, found)
    return HingeSolid(
        compliance=alone,
        stiffness=_symmetrise(np.linalg.inv(alone)),
        error=error,
        changes=np.abs(np.diag(alone - found[-2]) / np.diag(alone)) if len(found) > 1 else np.full(6, np.inf),
        whole=alone + taken,
        stub=max(subject.first, subject.second),
        freedoms=last.freedoms,
        elements=last.elements,
        order=last.order,
        finding=None if error <= required.error else _not_reached(part, error, required, last.freedoms),
    )


def _refusals(part: Shaped) -> Iterator[Finding]:
    """Parts without a shape, batches, fillets longer than the hinge."""
    if not isinstance(part, Shaped) or is_actuator(part):
        yield Finding(_label(part), "has no shape, or is not a hinge", "Use a hinge with a shape: a notch, neck, leaf, rod")
        return
    profile = part.profile if isinstance(part, Profiled) else None
    for owner in (part, profile):
        for name, value in vars(owner).items() if owner is not None else ():
            sizes = [np.size(each) for each in (value if isinstance(value, tuple) else (value,)) if np.ndim(each) > 0]
            if sizes:
                yield Finding(
                    f"{_label(part)}'s {name}",
                    f"is a batch of {max(sizes)}",
                    "Compute the designs separately: a solid model has one design",
                )
    if isinstance(profile, Filleted) and np.ndim(profile.length) == np.ndim(profile.radius) == 0:
        total, radius = float(np.real(profile.length)), float(np.real(profile.radius))
        if 2.0 * radius > total:
            yield Finding(
                _label(part),
                f"its fillets of {radius:.4g} m do not fit into its length of {total:.4g} m",
                "Use a radius of at most half the length",
            )


def _error(part: Shaped, found: Sequence[Array]) -> float:
    """Estimated error of the last compliance, all taken at the hinge's end."""
    arm = transport(np.array([0.5 * span(part), 0.0, 0.0]))
    ends = [arm @ compliance @ arm.T for compliance in found]
    return remaining([change(first, second) for first, second in pairwise(ends)])


def _label(part: Shaped) -> str:
    return f"the {part.kind}"


def _solves(subject: _Subject, accuracy: Accuracy, call: Call) -> Iterator[_Solve]:
    """Solves of rising order on one mesh, then of the highest on finer ones, up to the limit of DOFs.

    If the lowest order has too many on the usual mesh, as for wide notches, a coarser mesh is used from order two on. DOFs and elements
    are counted for the whole hinge.
    """
    lowest, highest = accuracy.orders
    for refinement in range(accuracy.meshes):
        call.report(Stage.MESHING, 0.0)
        cut = _mesh(subject, accuracy.shrink**refinement, highest)
        if refinement == 0:
            telling = max(lowest, _TELLING_THIN if is_thin(subject.part) else _TELLING)
            if cut.mirrors.copies * _space(cut, min(telling, highest)).size > accuracy.freedoms:
                lowest, cut = 2, _mesh(subject, _COARSER, highest)
            mesh = cut.mesh
            call.ask(Counts(mesh.nv, mesh.nedge, mesh.nface, mesh.ne))
        for order in range(lowest if refinement == 0 else highest, highest + 1):
            space = _space(cut, order)
            if cut.mirrors.copies * space.size > accuracy.freedoms:
                return
            call.report(Stage.FACTORISING, 0.0)
            yield _Solve(_law(subject.part, space), cut.mirrors.copies * space.size, cut.mirrors.copies * cut.mesh.ne, order)


def _space(cut: PieceMesh, order: int) -> Field:
    cut.mesh.Curve(order)
    return field(cut, cut.faces, order)


def _law(part: Shaped, space: Field) -> Array:
    """Stiffness (6, 6) of the whole specimen: energies of the motions with one outer face moved and the other fixed.

    Motions of different kinds about a plane of symmetry have no common energy.
    """
    form, motion, mirrors = stiffness(space), rigid(space, identity(), faces=END), space.meshed.mirrors
    kinds = mirrors.twist_kinds(np.eye(3))
    motion -= solve_kinds(space, [form], Columns(times([form], motion), kinds))
    forces = apply_form(stiffness(space, assemble=False), motion)  # by strains: K u of a thin leaf is rounding
    law = np.zeros((6, 6))
    for kind in range(mirrors.copies):
        alike = np.flatnonzero(kinds == kind)
        law[np.ix_(alike, alike)] = mirrors.copies * (motion[:, alike].T @ forces[:, alike])
    _require_symmetric(part, law)
    return _symmetrise(law)


def hinge_mesh(part: Shaped, order: int = 5) -> ngsolve.Mesh:
    """Return a mesh [mm] of a hinge with stubs, whose outer faces are `start` and `end`. No element is inverted at any order up to `order`.

    For an isotropic material, only a symmetric portion is meshed: the quarter at positive y and z, or half of a leaf. If the mesher fails
    or an element is inverted, a few other sizes are tried. Raises `DesignError` if meshing fails with all sizes.

    >>> from flexstage.parts.neck import Neck
    >>> from flexstage.parts.profile import Straight
    >>> hinge_mesh(Neck("steel", 1e-3, Straight(1e-3), width=1e-3)).GetMaterials()
    ('medium 0',)
    """
    return _mesh(_Subject.of(part, Medium(1.0, 0.0, 1.0), None, own_roots(part)), 1.0, order).mesh


def _mesh(subject: _Subject, factor: float, order: int) -> PieceMesh:
    reason = "the mesher did not run"
    for shrink, grading, curvature in _ATTEMPTS:
        drawn = subject.draw(factor * shrink)
        sizes = {
            "mp": restrict_sizes(
                (drawn.mirrors.within(points), size) for points, size in core_points(subject.part, _NECK * factor * shrink)
            ),
            "grading": grading,
            "curvaturesafety": curvature / factor,
        }
        outcome = _attempt(drawn, sizes, order)
        if isinstance(outcome, ngsolve.Mesh):
            none = np.zeros(outcome.ne, dtype=int)
            return PieceMesh(outcome, (subject.medium,), (START, END), none, none > 0, drawn.mirrors)
        reason = outcome
    raise refuse(_label(subject.part), f"no mesh could be made: {reason}", "Check the proportions of the hinge")


def _attempt(drawn: Specimen, sizes: Mapping[str, Any], order: int) -> ngsolve.Mesh | str:
    mesh = generate_mesh(drawn.solid, {"maxh": drawn.largest, **sizes})
    if isinstance(mesh, str):
        return mesh
    for degree in range(2, order + 1):
        mesh.Curve(degree)
        lowest = lowest_jacobian(mesh)
        if lowest <= 0.0:
            return f"a curved face turns an element inside out, Jacobian {lowest:.3g}"
    return mesh


def lowest_jacobian(mesh: ngsolve.Mesh) -> float:
    """Return the lowest Jacobian determinant [mm^3] of all elements, at a lattice of points; elements fold first near corners and edges.

    Points on edges are excluded: if two faces of an element are on one smooth surface, the determinant at their common edge is always zero.

    >>> from flexstage.parts.leaf import Leaf
    >>> lowest_jacobian(hinge_mesh(Leaf("steel", 1e-3, 1e-3, 1e-3))) > 0.0
    True
    """
    steps = range(_LATTICE + 1)
    lattice = np.array([(i, j, k) for i in steps for j in steps for k in steps if i + j + k <= _LATTICE])
    points = _INSIDE + (1.0 - 4.0 * _INSIDE) / _LATTICE * lattice
    rule = ngsolve.IntegrationRule([tuple(point) for point in points.tolist()], [1.0] * len(points))
    return float(np.min(ngsolve.Det(ngsolve.specialcf.JacobianMatrix(3))(mesh.MapToAllElements(rule, ngsolve.VOL))))


def _about_centre(compliance: Array, away: float) -> Array:
    """Transform a compliance about a point `away` [m] along x to the centre."""
    shift = transport(np.array([-away, 0.0, 0.0]))
    return shift @ compliance @ shift.T


def _symmetrise(matrix: Array) -> Array:
    return 0.5 * (matrix + matrix.T)


def _require_symmetric(part: Shaped, law: Array) -> None:
    skew = change(law, law.T)
    if skew > _SYMMETRY:
        raise refuse(
            _label(part),
            f"its stiffness is not symmetric (relative difference {skew:.1e}, expected at most {_SYMMETRY:.0e})",
            "Its mesh is ill-conditioned: check the proportions",
        )


def _not_reached(part: Shaped, error: float, accuracy: Accuracy, freedoms: int) -> Finding:
    if not np.isfinite(error):
        return Finding(_label(part), f"the error of its compliance matrix is unknown: {NO_ESTIMATE}", LEAVE)
    return Finding(
        _label(part),
        f"the error of its compliance matrix with {freedoms} DOFs is {100.0 * error:.2g} %, but {100.0 * accuracy.error:.2g} % is required",
        "Allow more DOFs or a larger error",
    )
