"""Constrained interfaces: faces with rigid, linear and quadratic motions, or with prescribed mean motion and free warping (averaged).

A constrained face is stiffer than the real joint, and an averaged face is softer. The results with both kinds of faces bracket the error of
the cut. The end caps of stacks and faces on rigid bodies always remain plane.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from flexstage.base.number import Array
from flexstage.parts.piezo import Piezo
from flexstage.solid.fea.meshing.fineness import Hold, Reduction
from flexstage.solid.fea.solver.component import Component, Interface
from flexstage.solid.fea.solver.field import (
    Columns,
    Field,
    Forms,
    Inertia,
    KindSolver,
    concatenate,
    factorise_kinds,
    mean_motion,
    rigid,
    solve_kinds,
    stiffness,
    times,
    warp_kinds,
    warping_motion,
)
from flexstage.spatial.frame import Frame

_SHIFT = (2.0 * np.pi * 10.0) ** 2
"""Inertia that supports a component without constrained faces, as of a motion at 10 Hz: in the basis only, not in the energies [1/s^2]."""


@dataclass(frozen=True, eq=False)
class Support:
    """Motions due to unit twists of m `faces` (n, 6 m), due to unit `warps` (n, w), and due to loads while faces are fixed (`within`).

    `solve` computes motions due to other forces.
    """

    faces: Columns
    warps: Columns
    within: Columns
    solve: KindSolver


def is_rigid(component: Component, interface: Interface, hold: Hold) -> bool:
    """Return whether the complete motion of an interface is constrained (by `hold` or by a stack's end cap), not only the mean motion.

    >>> from flexstage.solid.fea.meshing.bar import bar
    >>> is_rigid(bar(), bar().interfaces[0], Hold.RIGID), is_rigid(bar(), bar().interfaces[0], Hold.AVERAGED)
    (True, False)
    """
    pieces = (*component.pieces, interface.footprint)
    stacks = [piece.name for piece in pieces if piece is not None and isinstance(piece.form, Piezo)]
    return hold is Hold.RIGID or interface.joint.link in stacks


def support(component: Component, space: Field, reduction: Reduction, *, elastic: Forms, mass: Inertia, loads: Columns) -> Support:
    """Constrain a component's interfaces. `elastic` is the stiffness, `mass` the inertia.

    Rigid faces and faces on the ground are fixed in `space`. The responses to `loads` within the component use the same matrix
    factorisation, which is kept only if it is needed later.

    >>> from flexstage.solid.fea.meshing.bar import bar
    >>> from flexstage.solid.fea.solver.field import field, inertia, stiffness
    >>> from flexstage.solid.fea.meshing.fineness import Fineness, Reduction
    >>> from flexstage.solid.fea.meshing.mesh import mesh_component
    >>> space = field(mesh_component(bar(), Fineness(order=2)), ["foot"], 2)
    >>> elastic, none = [stiffness(space)], Columns.of(np.zeros((space.size, 0)))
    >>> faces = support(bar(), space, Reduction(hold=Hold.AVERAGED), elastic=elastic, mass=inertia(space), loads=none).faces.values
    >>> round(float((faces.T @ times(elastic, faces))[0, 0]) * 1e-6, 6)  # E A / L, N/um
    100.0
    """
    if component.floats:
        return _afloat(component, space, mass, loads)
    loose = [item for item in component.interfaces if not is_rigid(component, item, reduction.hold)]
    unsupported = len(loose) == len(component.interfaces) and not component.fixed
    law = [stiffness(space, shift=_SHIFT)] if unsupported else elastic
    once = not (loose or reduction.modes or reduction.residual)
    plain = partial(solve_kinds, space, law) if once else factorise_kinds(space, law)
    if not loose:
        faces = [_face_motion(item, space) for item in component.interfaces]
        warps = [_face_warping(item, space) for item in component.interfaces if item.yields]
        both, within = _static_motions([*faces, *warps], space, elastic, plain, loads)
        count = sum(len(each.kinds) for each in faces)
        return Support(both.some(slice(count)), both.some(slice(count, None)), within, plain)
    means = np.vstack([mean_motion(space, _frame(item), item.joint.name) for item in loose])
    held, solve = _held(plain, means)
    free, none = np.split(held, len(loose), axis=1), Columns.of(np.zeros((space.size, 0)))
    columns = [
        free[loose.index(item)] if item in loose else _static_motions([_face_motion(item, space)], space, elastic, solve, none)[0].values
        for item in component.interfaces
    ]
    return Support(Columns.of(np.hstack(columns)), none, _moved(loads, solve), solve)


def _held(plain: KindSolver, means: Array) -> tuple[Array, KindSolver]:
    """Motions (n, m) with one of some means (m, n) equal to one and the others zero, and the solver with all of them zero.

    Without mirrors: all is of one kind.
    """
    carried = plain(Columns.of(means.T))
    gain = np.linalg.inv(means @ carried)

    def solve(forces: Columns) -> Array:
        motion = plain(forces)
        return motion - carried @ (gain @ (means @ motion))

    return carried @ gain, solve


def middle(component: Component) -> Array:
    """Return the reference point (3,) for the motion of a floating component: the point of its first body.

    >>> from flexstage.solid.fea.meshing.bar import bar
    >>> from dataclasses import replace
    >>> middle(replace(bar(), bodies={"bar": np.ones(3)})).tolist()
    [1.0, 1.0, 1.0]
    """
    return next(iter(component.bodies.values()))


def _afloat(component: Component, space: Field, mass: Inertia, loads: Columns) -> Support:
    """Response of a component without support: a rigid motion, and a remainder without momentum and angular momentum."""
    motion = rigid(space, Frame(np.eye(3), middle(component)))
    plain = factorise_kinds(space, [stiffness(space, shift=_SHIFT)])
    solve = _held(plain, mass.times(motion).T)[1]
    return Support(Columns.of(motion), Columns.of(np.zeros((space.size, 0))), _moved(loads, solve), solve)


def _face_motion(item: Interface, space: Field) -> Columns:
    return Columns(rigid(space, _frame(item), faces=item.joint.name), space.meshed.mirrors.twist_kinds(np.eye(3)))


def _face_warping(item: Interface, space: Field) -> Columns:
    motions = warping_motion(space, item.joint.frame, float(np.sqrt(item.joint.area)), item.joint.name)
    return Columns(motions, warp_kinds(space.meshed.mirrors, item.joint.frame))


def _static_motions(moved: Sequence[Columns], space: Field, elastic: Forms, solve: KindSolver, loads: Columns) -> tuple[Columns, Columns]:
    """One face moved and all others fixed, u = R - K_ff^-1 K R; and the responses to loads within."""
    motions = concatenate([Columns.of(np.zeros((space.size, 0))), *moved])
    found = _moved(concatenate([replace(motions, values=times(elastic, motions.values)), loads]), solve)
    count = len(motions.kinds)
    return replace(motions, values=motions.values - found.values[:, :count]), found.some(slice(count, None))


def _moved(loads: Columns, solve: KindSolver) -> Columns:
    return replace(loads, values=solve(loads))


def _frame(interface: Interface) -> Frame:
    return Frame(np.eye(3), interface.joint.frame.position)
