"""Reduction of a component by Craig and Bampton's method (AIAA J. 6, 1313, 1968), with attachment modes for the loads within.

The displacement is the sum of static responses to rigid motions and warps of the interface faces, fixed-interface modes, and static
responses, with faces fixed, to a wrench on each body and to each stroke. For these loads, the static response is equal to that of the full
model, for any number of modes.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import ngsolve
import numpy as np

from flexstage.base.number import Array
from flexstage.mechanism.mechanism import PLATFORM
from flexstage.parts.piezo import Piezo
from flexstage.solid.fea.geometry.cad import region
from flexstage.solid.fea.geometry.piece import span, thinnest
from flexstage.solid.fea.jobs.progress import Report, Stage, silent
from flexstage.solid.fea.meshing.fineness import Reduction
from flexstage.solid.fea.meshing.mesh import PieceMesh
from flexstage.solid.fea.solver.component import Component, groups
from flexstage.solid.fea.solver.contribution import Assembled, assemble_groups, contributions
from flexstage.solid.fea.solver.field import (
    Columns,
    Field,
    Inertia,
    concatenate,
    degrees_of,
    field,
    held_at_mirrors,
    rigid,
    seat_motion,
    stroke_force,
    times,
    total,
)
from flexstage.solid.fea.solver.hold import Support, is_rigid, middle, support
from flexstage.solid.fea.solver.krylov import Pencil, lowest_modes
from flexstage.solid.fea.solver.skin import skin, surface_owners
from flexstage.solid.fea.solver.superelement import Superelement
from flexstage.solid.fea.solver.ties import End
from flexstage.spatial.frame import Frame, identity, transport

_DEPENDENT = 1e-13
_REACH = 0.5
"""Extent of a body's surface around the end of a part without a shape, divided by the smallest dimension of the body's solid there."""


@dataclass(frozen=True, eq=False)
class _Problem:
    component: Component
    field: Field
    assembled: tuple[Assembled, ...]
    inertia: Inertia

    @property
    def stiffness(self) -> list[ngsolve.BilinearForm]:
        """The forms of the total stiffness."""
        return [alike.stiffness for alike in self.assembled]


@dataclass(frozen=True, eq=False)
class _Motions:
    """The `basis` (n, k) of a component's motion: columns of `faces`, of their `warps`, then those within; its loads.

    `weights` (6, 6) are the bodies' inertias about their reference points. The factor is not kept: it is as large as all later data.
    """

    problem: _Problem
    basis: Columns
    faces: int
    warps: int
    weights: Mapping[str, Array]
    strokes: Mapping[int, Array]
    seats: Mapping[str, Array]


def reduce_mesh(
    component: Component, mesh: PieceMesh, reduction: Reduction, springs: Array | None = None, report: Report = silent
) -> Superelement:
    """Assemble and reduce a meshed component, with progress reports.

    If `springs` (6 m, 6 m) connect the m interfaces, the modes are computed with the interfaces on these springs instead of fixed. If a
    whole stage is one component, these modes are exact. With `springs`, the mesh is large. Therefore static shapes are computed only for
    loads on the platform; static responses to loads on other bodies are approximate.

    >>> from flexstage.solid.fea.meshing.bar import bar
    >>> from flexstage.solid.fea.meshing.fineness import Fineness
    >>> from flexstage.solid.fea.meshing.mesh import mesh_component
    >>> plan = Reduction(Fineness(order=2))
    >>> element = reduce_mesh(bar(), mesh_component(bar(), plan.fineness), plan)
    >>> round(float(element.stiffness["bar"][0, 0]) * 1e-6, 6)  # E A / L, N/um
    100.0
    """
    return _project(_motions(component, mesh, reduction, springs, report), report)


def _motions(component: Component, mesh: PieceMesh, reduction: Reduction, springs: Array | None, report: Report) -> _Motions:
    problem = _problem(component, mesh, reduction, report)
    report(Stage.FACTORISING, 0.0)
    strokes, twist = _strokes(problem), mesh.mirrors.twist_kinds(np.eye(3))
    loaded = [PLATFORM] if springs is not None and PLATFORM in component.bodies else list(component.bodies)
    seats = {str(number): _seat(problem, end) for number, end in enumerate(component.seats)}
    weights: dict[str, Array] = {}
    loads = [Columns.of(np.zeros((problem.field.size, 0)))]
    for body in component.bodies:
        motion, momentum = _momenta(problem, body)
        weights[body] = mesh.mirrors.whole(motion.T @ momentum, twist, twist)
        if body in loaded:
            loads.append(Columns(momentum @ np.linalg.inv(weights[body]), twist))  # over the mass: M R (R^T M R)^-1
    loads += [Columns.of(force[:, None]) for force in strokes.values()]  # stacks are whole
    loads += [Columns.of(rows.T) for rows in seats.values()]
    elastic, mass = problem.stiffness, problem.inertia
    held = support(component, problem.field, reduction, elastic=elastic, mass=mass, loads=concatenate(loads))
    report(Stage.REDUCING, 0.0)
    inner = [_modes(problem, held, reduction.modes, springs), held.within]
    if reduction.residual:
        forces = replace(held.faces, values=problem.inertia.times(held.faces.values))
        inner.append(replace(forces, values=held.solve(forces)))
    basis = concatenate([held.faces, held.warps, _independent_columns(problem, concatenate(inner))])
    return _Motions(problem, basis, len(held.faces.kinds), len(held.warps.kinds), weights, strokes, seats)


def _problem(component: Component, mesh: PieceMesh, reduction: Reduction, report: Report) -> _Problem:
    report(Stage.ASSEMBLING, 0.0)
    plane = [item.joint.name for item in component.interfaces if is_rigid(component, item, reduction.hold)]
    space = field(mesh, plane + [joint.name for joint in component.fixed], reduction.fineness.order)
    names = groups(component)
    assembled = assemble_groups(space, {name: np.isin(mesh.owner, pieces) for name, pieces in names.items()})
    return _Problem(component, space, assembled, total([alike.inertia for alike in assembled]))


def _strokes(problem: _Problem) -> dict[int, Array]:
    return {
        number: stroke_force(problem.field, piece.frame, span(piece.form))
        for number, piece in enumerate(problem.component.pieces)
        if isinstance(piece.form, Piezo)
    }


def _momenta(problem: _Problem, body: str) -> tuple[Array, Array]:
    """Rigid motions R (n, 6) of a body's elements about its reference point, zero elsewhere, and their momenta M R (n, 6)."""
    law, own = next((alike.inertia, group.degrees) for alike in problem.assembled for group in alike.groups if group.name == body)
    motion = np.where(own[:, None], rigid(problem.field, Frame(np.eye(3), problem.component.bodies[body])), 0.0)
    return motion, law.times(motion)


def _seat(problem: _Problem, end: End) -> Array:
    """Rows (6, n) of the twist of the body's surface around the end of a part without a shape."""
    own = [number for number, piece in enumerate(problem.component.pieces) if piece.body == end.body]
    pieces = [problem.component.pieces[number] for number in own]
    nearest = min(pieces, key=lambda piece: float(region(piece, end.point[None])[0]))
    faces = np.isin(surface_owners(problem.field.meshed.mesh, problem.field.meshed.owner), own)
    return seat_motion(problem.field, end.point, _REACH * thinnest(nearest.form), faces)


def _modes(problem: _Problem, supported: Support, count: int, springs: Array | None) -> Columns:
    """The lowest modes (n, count) by shift and invert at zero: with interfaces fixed, or free and joined by springs."""
    if count <= 0:
        return Columns.of(np.zeros((problem.field.size, 0)))
    kinds = range(problem.field.meshed.mirrors.copies)
    held = [np.flatnonzero(problem.field.free & ~held_at_mirrors(problem.field, kind)) for kind in kinds]
    found = lowest_modes([_pencil(problem, supported, springs, kind, free) for kind, free in zip(kinds, held, strict=True)], count)
    result = concatenate(
        [Columns(np.zeros((problem.field.size, own.shape[1])), np.full(own.shape[1], kind)) for kind, own in enumerate(found)]
    )
    for kind, (free, own) in enumerate(zip(held, found, strict=True)):
        result.values[np.ix_(free, result.kinds == kind)] = own[: len(free)]
    return result


def _pencil(problem: _Problem, supported: Support, springs: Array | None, kind: int, free: Array) -> Pencil:
    """Inertia and stiffness of a kind on its `free` degrees of freedom and, joined by springs, the interfaces.

    Motions are u = v + faces q with v zero on the interfaces: the stiffness is then diag(K, S), S = faces^T K faces + springs.
    """
    faces = supported.faces.values
    joined = faces if springs is not None else faces[:, :0]
    boundary = joined.T @ times(problem.stiffness, joined) + (springs if springs is not None else 0.0)

    def weighed(x: Array) -> Array:
        full = joined @ x[len(free) :]
        full[free] += x[: len(free)]
        force = problem.inertia.times(full)
        return np.vstack([force[free], joined.T @ force])

    def inverse(force: Array) -> Array:
        full = np.zeros((problem.field.size, force.shape[1]))
        full[free] = force[: len(free)]
        moved = supported.solve(Columns(full, np.full(force.shape[1], kind)))
        return np.vstack([moved[free], np.linalg.solve(boundary, force[len(free) :])])

    return Pencil(weighed, inverse, len(free) + joined.shape[1])


def _independent_columns(problem: _Problem, motions: Columns) -> Columns:
    """An independent set spanning the motions, kind by kind, orthonormal in strain energy."""
    copies = problem.field.meshed.mirrors.copies
    found: list[Columns] = []
    for kind in range(copies):
        own = motions.kind(kind)
        energy = copies * (own.T @ times(problem.stiffness, own))
        scale = 1.0 / np.sqrt(np.maximum(np.diag(energy), np.finfo(float).tiny))
        values, vectors = np.linalg.eigh(0.5 * (energy + energy.T) * scale * scale[:, None])
        kept = values > _DEPENDENT
        found.append(Columns(own @ (scale[:, None] * vectors[:, kept] / np.sqrt(values[kept])), np.full(int(kept.sum()), kind)))
    return concatenate(found)


def _project(found: _Motions, report: Report) -> Superelement:
    component, space, basis, kinds = found.problem.component, found.problem.field, found.basis.values, found.basis.kinds
    elastic: dict[str, Array] = {}
    mass: dict[str, Array] = {}
    bodies: dict[str, Array] = {}
    moving: dict[str, Array] = {}
    resultants: dict[str, Array] = {}
    names, mirrors = groups(component), space.meshed.mirrors
    twist, everything = mirrors.twist_kinds(np.eye(3)), rigid(space, identity())
    carried = np.zeros((basis.shape[1], 6))
    for number, part in enumerate(contributions(space, found.problem.assembled, basis)):
        report(Stage.PROJECTING, number / len(names))
        name = part.name
        elastic[name] = _symmetrise(mirrors.whole(part.strained.T @ part.forces, kinds, kinds))
        mass[name] = _symmetrise(mirrors.whole(part.motions.T @ part.momenta, kinds, kinds))
        carried += mirrors.whole(part.momenta.T @ everything[part.rows], kinds, twist)
        if name in component.bodies:
            motion = rigid(space, Frame(np.eye(3), component.bodies[name]))[part.rows]
            bodies[name] = np.linalg.solve(found.weights[name], mirrors.whole(motion.T @ part.momenta, twist, kinds))
            moving[name] = _symmetrise(found.weights[name])
        else:
            link = names[name][0]
            across = mirrors.twist_kinds(component.pieces[link].frame.rotation)
            resultants[name] = mirrors.whole(_sections(found.problem, link)[part.rows].T @ part.forces, across, kinds)
    projected = {number: basis.T @ force for number, force in found.strokes.items()}
    return Superelement(
        interfaces=len(component.interfaces) + component.floats,
        warps=found.warps,
        stiffness={name: elastic[name] for name in names},
        inertia={name: mass[name] for name in names},
        bodies=bodies,
        body_inertia=moving,
        resultants=resultants,
        strokes={component.pieces[number].name: force for number, force in projected.items()},
        free_strokes={component.pieces[number].name: _free_stroke(found, number, force) for number, force in projected.items()},
        rigid=_rigid_coordinates(component, basis.shape[1]),
        carried=carried,
        skin=skin(space, found.basis),
        freedoms=space.whole_size,
        elements=mirrors.copies * space.meshed.mesh.ne,
        seats={number: rows @ basis for number, rows in found.seats.items()},
    )


def _sections(problem: _Problem, number: int) -> Array:
    """Test motions (n, 6): a link's elements beyond its middle move rigidly, in its frame about its centre, all others are fixed.

    The work of the link's stresses on them is its wrench, exactly, by equilibrium in the discrete sense.
    """
    piece, space = problem.component.pieces[number], problem.field
    along = (space.places - piece.frame.position) @ piece.frame.rotation[:, 0]
    beyond = degrees_of(space, (space.meshed.owner == number) & (along > 0.0))
    return rigid(space, piece.frame) * beyond[:, None]


def _free_stroke(found: _Motions, number: int, force: Array) -> Array:
    """Coordinates of a stack's unconstrained stroke: its end caps moved apart by the stroke, and the resulting internal motion.

    Internal coordinates are orthonormal in energy with the interfaces fixed, so the response to the stroke's force is that force.
    """
    component = found.problem.component
    piece, result = component.pieces[number], np.array(force)
    result[: found.faces + found.warps] = 0.0
    ends = [(place, item.joint.frame) for place, item in enumerate(component.interfaces) if item.joint.link == piece.name]
    for place, frame in ends:
        outward = float(np.sign((frame.position - piece.frame.position) @ piece.frame.rotation[:, 0]))
        result[6 * place : 6 * place + 3] = piece.frame.rotation[:, 0] * outward / len(ends)
    return result


def _rigid_coordinates(component: Component, size: int) -> Array:
    result = np.zeros((size, 6))
    if component.floats:
        result[:6] = transport(middle(component))
    for number, item in enumerate(component.interfaces):
        arm = item.joint.frame.position
        result[6 * number : 6 * number + 6] = transport(arm)
    return result


def _symmetrise(matrix: Array) -> Array:
    return 0.5 * (matrix + matrix.T)
