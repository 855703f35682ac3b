"""Flexibility of bodies, estimated from their outlines: finite cells, condensed to the ends of the links on each body.

Each outline has a rectangular grid of quadratic hexahedra with 20 nodes. Points of a cell outside the material have almost no stiffness
(finite cell method; Parvizian, Duester, Rank, Comput. Mech. 41, 121, 2007). Outlines that touch or overlap are tied together at points of
their cells.

Loads are wrenches at the ends of the links on a body, balanced by the inertia of the accelerated body (inertia relief). The results are the
twists of these ends relative to the body's mean motion. In a linear model, each body is then rigid, with a compliance between the body and
the ends of its links.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from itertools import pairwise, permutations, product
from typing import Any

import numpy as np
import scipy

from flexstage.base.finding import refuse
from flexstage.base.number import Array
from flexstage.base.session import SESSION
from flexstage.base.storage.digest import digest
from flexstage.mechanism.assembly.expand import Assembly, PlacedBody, PlacedLink, expand
from flexstage.mechanism.design import designs, step_size
from flexstage.mechanism.mechanism import Mechanism
from flexstage.models.linear.model import Contribution, LinearModel
from flexstage.parts.body import Block, Extrusion, Imported, PlacedSolid, Solid
from flexstage.parts.compliance_matrix import Joint
from flexstage.parts.freedom import Freedom
from flexstage.parts.material import Material
from flexstage.parts.part import Part, Restricted, inner, span
from flexstage.parts.profile import single
from flexstage.parts.shape import Shaped
from flexstage.spatial.frame import FORCES, Frame, cross_matrix, spatial_rotation, twist_transform

BODIES = "flexible bodies"
"""Name of the stiffness contribution by which flexible bodies reduce the stiffness of a model."""
_SLENDER, _COMPACT, _CUT, _WHOLE = 4, 3, 8, 8
"""Cells along the longest side of a slender and of a compact block, of another outline, whose surface cuts them, and of a whole body."""
_EMPTY, _VOID = 0.005, 1e-3
"""Share of material below which a cell is left out; stiffness of points outside the material, over that of the material."""
_MOST, _MANY = 200, 40
"""Bodies of a stage above which none is estimated, and outlines of a body above which it is not."""
_FAR = 0.25
"""Distance of a link's end from the outlines, over the body's longest side, above which the body is not estimated."""
_SOUND = 0.25
"""Share of material from which on the motion of a cell is that of its points."""
_LOOSE = 1e9
"""Compliance times shear modulus and size, above which parts of a body are taken as loose."""
_SAME = 1e-6
"""Share of a body's size below which two planes are one."""
_TIE = 100.0
"""Stiffness of a point tied to another outline, over that of its cell."""
_GAUSS = 0.577
"""Points of a link's end face, over its half sides."""
_CORNERS: Array = np.array([each for each in product(range(3), repeat=3) if each.count(1) < 2])
"""Nodes of a cell: its corners and the middles of its edges, in half sides from its first corner."""
_STATIONS: Array = (np.array([-1.0, 1.0])[:, None] + np.array([-1.0, 1.0]) / math.sqrt(3.0)).ravel() / 2.0
_POINTS: Array = np.array(list(product(_STATIONS, repeat=3)))
"""Points of a cell that are inside or outside the material: two Gauss points in each half of its sides."""

_SAMPLES: Array = np.array(
    [each for each in product((-1.0, -0.577, 0.0, 0.577, 1.0), repeat=3) if sum(abs(part) == 1.0 for part in each) < 2]
)
"""Points of a cell and of its faces that may be tied to another outline."""


@dataclass(frozen=True, eq=False)
class BodyFlexibility:
    """Compliance (6 k, 6 k) [SI] of a body between the ends of its k `links`.

    The coordinates are the twists of these ends relative to the mean motion of the body, at the points `ends` (k, 3), in the stage's axes.
    Bodies with equal outlines and links belong to one `group`.
    """

    body: str
    group: int
    links: tuple[str, ...]
    ends: Array
    compliance: Array


@dataclass(frozen=True, eq=False)
class BodyEstimates:
    """Estimated flexibilities of bodies (`found`), and the `reasons` for missing estimates, both by body name."""

    found: tuple[BodyFlexibility, ...]
    reasons: Mapping[str, str]


@SESSION.keep(4)
def body_flexibilities(mechanism: Mechanism) -> BodyEstimates:
    """Estimate the flexibility of every body of one design from its outlines.

    A body has no estimate if it has no outlines, an imported outline or many outlines. A body also has no estimate if it joins a
    superelement, an ideal joint or a part with locked DOFs, or if a link ends far from its outlines. In a stage with many bodies, no body
    has an estimate. The result contains the reason for each missing estimate.

    Equal bodies share their estimate.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> [each.body for each in body_flexibilities(parallelogram()).found]
    ['platform', 'B/base', 'B/tip']
    """
    assembly = expand(mechanism)
    if _is_varied(mechanism):
        return BodyEstimates((), dict.fromkeys(assembly.bodies, "not computed for several designs"))
    if len(assembly.bodies) > _MOST:
        return BodyEstimates((), dict.fromkeys(assembly.bodies, f"the stage has more than {_MOST} bodies"))
    found: list[BodyFlexibility] = []
    reasons: dict[str, str] = {}
    known: dict[_Problem, int] = {}
    for name, body in assembly.bodies.items():
        links = [link for link in assembly.links.values() if name in link.joins]
        reason = _reason(body, links, mechanism.materials)
        if reason is None and (ends := [link for link in links if np.any(span(link.part))]):
            estimate = _estimate(body, ends, mechanism.materials, known)
            found += [] if estimate is None else [estimate]
            reason = None if estimate is not None else "its outlines are not connected, or are too thin"
        if reason is not None:
            reasons[name] = reason
    return BodyEstimates(tuple(found), reasons)


def _is_varied(mechanism: Mechanism) -> bool:
    """Whether a description holds several designs, or a complex step."""
    return designs(mechanism) is not None or step_size(mechanism) != 0.0


def with_estimated_bodies(model: LinearModel, mechanism: Mechanism) -> LinearModel:
    """Return the lumped model of one design with the estimated flexibility of its bodies; raises `DesignError` for several designs.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.models.lumped import lumped
    >>> BODIES in with_estimated_bodies(lumped(parallelogram()), parallelogram()).stiffness
    True
    """
    if _is_varied(mechanism):
        raise refuse("elastic_bodies", "not supported for several designs", "Remove elastic_bodies, or compute the designs one by one")
    return with_flexible_bodies(model, mechanism, body_flexibilities(mechanism).found)


def flexible_links(mechanism: Mechanism) -> tuple[str, ...]:
    """Return the names of links that end on flexible bodies, in the order of their strains in a model.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> flexible_links(parallelogram())
    ('left', 'right', 'B/front', 'B/back', 'B/pzt')
    """
    return _links(body_flexibilities(mechanism).found)


def _links(flexibilities: Sequence[BodyFlexibility]) -> tuple[str, ...]:
    return tuple(dict.fromkeys(link for each in flexibilities for link in each.links))


def with_flexible_bodies(model: LinearModel, mechanism: Mechanism, flexibilities: Sequence[BodyFlexibility]) -> LinearModel:
    """Return the lumped model with bodies that deform elastically between the ends of their links.

    Masses, gauges, points, and links without length (coils, springs) follow the mean motion of their body.

    The link strains are e = G q - s, with the coordinates q and the imposed strokes s. The link stiffness is k, the compliance of the
    bodies is C, and E are the link strains per unit twist of the link ends. The twists of the ends are eliminated: the link forces are (k -
    k E X E^T k) e with X = (C^-1 + E^T k E)^-1.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.models.lumped import lumped
    >>> stage = parallelogram()
    >>> rigid = lumped(stage)
    >>> soft = with_flexible_bodies(rigid, stage, body_flexibilities(stage).found)
    >>> bool(np.all(np.linalg.inv(soft.stiffness_matrix).diagonal() >= np.linalg.inv(rigid.stiffness_matrix).diagonal()))
    True
    """
    assembly = expand(mechanism)
    names = _links(flexibilities)
    if not names:
        return model
    row = {name: slice(6 * place, 6 * place + 6) for place, name in enumerate(names)}
    across = _end_strains(assembly, flexibilities, row)
    compliance = scipy.linalg.block_diag(*(each.compliance for each in flexibilities))
    operator = np.concatenate([model.stiffness[name].operator[:6] for name in names])
    law = scipy.linalg.block_diag(*(model.stiffness[name].law[:6, :6] for name in names))
    pull = law @ across
    relief = np.linalg.solve(np.eye(len(compliance)) + compliance @ across.T @ pull, compliance)
    softer = -pull @ (0.5 * (relief + relief.T)) @ pull.T
    inputs = len(model.inputs)
    none = np.zeros((6, inputs))
    strokes = np.concatenate([model.imposed.get(name, none)[:6] for name in names])
    output, feedthrough = model.output.copy(), model.feedthrough.copy()
    places = {channel.name: place for place, channel in enumerate(model.outputs)}
    rows = [places[f"{name}.{force}"] for name in names for force in FORCES]
    output[rows] += softer @ operator
    feedthrough[rows] -= softer @ strokes
    return replace(
        model,
        stiffness={**model.stiffness, BODIES: Contribution(operator, softer)},
        imposed={**model.imposed, BODIES: strokes} if np.any(strokes) else model.imposed,
        output=output,
        feedthrough=feedthrough,
    )


def _end_strains(assembly: Assembly, flexibilities: Sequence[BodyFlexibility], row: Mapping[str, slice]) -> Array:
    """Strains (6 links, 6 ends) of links per unit of the twists of their ends."""
    result = np.zeros((6 * len(row), sum(6 * len(each.links) for each in flexibilities)))
    column = 0
    for each in flexibilities:
        for name, end in zip(each.links, each.ends, strict=True):
            link = assembly.links[name]
            sign = 1.0 if link.joins[1] == each.body else -1.0
            result[row[name], column : column + 6] += sign * twist_transform(link.frame, end)
            column += 6
    return result


def _reason(body: PlacedBody, links: Sequence[PlacedLink], materials: Mapping[str, Material]) -> str | None:
    """Why the flexibility of a body is not estimated."""
    solids = [placed.solid for placed in body.solids.values()]
    if not solids:
        return "no outlines"
    if any(isinstance(each, Imported) for each in solids) or len(solids) > _MANY:
        return f"an imported outline, or more than {_MANY} outlines"
    if any(materials[each.material].is_cubic or materials[each.material].density == 0.0 for each in solids):
        return "material is a crystal, or has no density"
    if any(not isinstance(each, PlacedLink) and each.joints(body.name) for each in body.links):
        return "joined to a superelement"
    rigid = next((link.name for link in links if _is_rigid(link.part)), None)
    if rigid is not None:
        return f"{rigid} is rigid in some degrees of freedom"
    size = max(float(np.max(each.sides)) for each in solids)
    far = {link.name: _distance(body, _end(link, body.name)) for link in links if np.any(span(link.part))}
    worst = max(far, key=far.__getitem__, default="")
    return f"{worst} ends {far[worst] * 1e3:.3g} mm outside the outlines" if worst and far[worst] > _FAR * size else None


def _is_rigid(part: Part) -> bool:
    """Whether a part is an ideal joint, or has fixed degrees of freedom."""
    return isinstance(part, Joint) or (isinstance(part, Restricted) and len({*part.elastic, *part.free}) < len(Freedom))


def _end(link: PlacedLink, body: str) -> Array:
    """Where a link ends at a body (3,), in the stage's frame."""
    return link.frame.position + _side(link, body) * 0.5 * float(span(link.part)) * link.frame.rotation[:, 0]


def _side(link: PlacedLink, body: str) -> float:
    return 1.0 if link.joins[1] == body else -1.0


def _distance(body: PlacedBody, point: Array) -> float:
    """Distance of a point from the nearest box around an outline of a body."""
    boxes = ((placed.frame.rotation.T @ (point - placed.frame.position), 0.5 * placed.solid.sides) for placed in body.solids.values())
    return min(float(np.linalg.norm(np.maximum(np.abs(own) - half, 0.0))) for own, half in boxes)


def _estimate(
    body: PlacedBody, links: Sequence[PlacedLink], materials: Mapping[str, Material], known: dict[_Problem, int]
) -> BodyFlexibility | None:
    """The flexibility of a body, if it holds together; bodies with the same outlines and ends are one of the `known` groups."""
    frame = Frame(max(body.solids.values(), key=lambda placed: math.prod(placed.solid.sides)).frame.rotation, body.reference)
    solids = [_Outline.of(placed, frame, materials[placed.solid.material]) for placed in body.solids.values()]
    ends = np.array([_end(link, body.name) for link in links])
    spots = [frame.rotation.T @ (spot - frame.position)[..., None] for spot in (_face(link, body.name) for link in links)]
    faces = np.array(spots)[..., 0]
    key = tuple((np.round(each, 9) + 0.0).tobytes() for each in (*(solid.key for solid in solids), faces))
    problem = _Problem(key, solids, faces)
    own = _compliance(problem)
    if own is None:
        return None
    turn = np.kron(np.eye(len(links)), spatial_rotation(frame.rotation))
    names, group = tuple(link.name for link in links), known.setdefault(problem, len(known))
    return BodyFlexibility(body.name, group, names, ends, turn @ own @ turn.T)


@dataclass(frozen=True)
class _Problem:
    """Outlines of a body and the faces (k, 9, 3) at the ends of its links, in its own frame; `key` has all their numbers."""

    key: tuple[bytes, ...]
    outlines: Sequence[_Outline] = field(compare=False)
    faces: Array = field(compare=False)


@SESSION.keep(64)
def _compliance(problem: _Problem) -> Array | None:
    """Compliance (6 k, 6 k) at the ends of links, in the body's frame; none where parts of the body are loose."""
    solid = _Solid.of(problem.outlines)
    with suppress(RuntimeError):  # K is singular
        found = None if solid is None else solid.flexibility(problem.faces)
        shear, size = problem.outlines[0].shear, max(float(np.max(each.solid.sides)) for each in problem.outlines)
        return None if found is None or np.max(np.abs(np.diag(found).reshape(-1, 6)[:, :3])) * shear * size > _LOOSE else found
    return None


def _face(link: PlacedLink, body: str) -> Array:
    """Nine points (9, 3) of a link's end face, its centre in the middle, in the stage's frame."""
    own = inner(link.part)
    section = own.end if isinstance(own, Shaped) else None
    sizes = (0.1 * float(span(link.part)),) * 2 if section is None else (float(section.height), float(section.width))
    spread = 0.5 * _GAUSS * np.array(list(product((0.0, -1.0, 1.0), repeat=2))) * sizes
    return _end(link, body) + spread @ link.frame.rotation[:, 1:].T


@dataclass(frozen=True, eq=False)
class _Outline:
    """An outline in the body's frame: its solid, the frame at its centre, Lame's constants and density of its material."""

    solid: Solid
    rotation: Array
    place: Array
    first: float
    shear: float
    density: float

    @staticmethod
    def of(placed: PlacedSolid, frame: Frame, material: Material) -> _Outline:
        rotation = frame.rotation.T @ placed.frame.rotation
        place = frame.rotation.T @ (placed.frame.position - frame.position)
        young, poisson, density = (single(each) for each in (material.modulus, material.contraction, material.density))
        shear = 0.5 * young / (1.0 + poisson)
        return _Outline(placed.solid, rotation, place, 2.0 * shear * poisson / (1.0 - 2.0 * poisson), shear, density)

    def planes(self, finest: float) -> list[Array]:
        """Planes of its grid across each of its axes: its faces, those of its hole, and even steps between them of at least `finest`."""
        half = 0.5 * np.asarray(self.solid.sides, dtype=float)
        inner: list[Sequence[float]] = [(), (), ()]
        if isinstance(self.solid, Block) and self.solid.hole is not None:
            inner[:2] = [(-0.5 * float(each), 0.5 * float(each)) for each in self.solid.hole]
        if isinstance(self.solid, Extrusion):
            corners = np.asarray(self.solid.corners, dtype=float)
            along = np.abs(np.roll(corners, -1, axis=0) - corners) < _SAME * np.max(half)
            inner[:2] = [corners[along[:, axis], axis].tolist() for axis in range(2)]
        least = 0.5 * float(self.solid.thinnest)
        side, thick = 2.0 * float(max(half)), 2.0 * least
        step = max(side / _SLENDER, min(side / _COMPACT, thick), least) if isinstance(self.solid, Block) else max(side / _CUT, thick)
        faces = [_apart(each, planes, least) for each, planes in zip(half, inner, strict=True)]
        return [_divided(each, max(step, finest)) for each in faces]

    def meets(self, other: _Outline) -> bool:
        """Whether the boxes around two outlines, along the body's axes, touch or overlap."""
        reach = sum(np.abs(each.rotation) @ np.asarray(each.solid.sides, dtype=float) for each in (self, other))
        return bool(np.all(np.abs(self.place - other.place) <= (0.5 + _SAME) * reach))

    def contains(self, points: Array, slack: float = 0.0) -> Array:
        """Which points (n, 3) of the body's frame are inside."""
        return self.solid.contains((points - self.place) @ self.rotation, slack)

    @property
    def key(self) -> Array:
        """Numbers that distinguish it from others."""
        shape = int(digest(self.solid, physics=True)[:12], 16)
        return np.array([shape, *self.rotation.ravel(), *self.place, self.first, self.shear, self.density])


def _apart(half: float, planes: Iterable[float], least: float) -> Array:
    """Both faces, and the planes between them that are at least so far from those before them and from the last."""
    kept = [-half]
    for plane in sorted(planes):
        if min(plane - kept[-1], half - plane) >= least:
            kept.append(plane)
    return np.array([*kept, half])


def _divided(planes: Array, step: float) -> Array:
    """Planes with even steps of at most about `step` between them."""
    counts = np.maximum(np.ceil(np.diff(planes) / step - 1e-6), 1.0).astype(int)
    parts = [np.linspace(*ends, count, endpoint=False) for ends, count in zip(pairwise(planes), counts, strict=True)]
    return np.append(np.concatenate(parts), planes[-1])


@dataclass(frozen=True, eq=False)
class _Cells:
    """Cells of one outline that hold material of it alone: middles and half sizes (c, 3) in its frame, and the nodes (c, 20) of each.

    `material` (c, p) says which points of a cell are inside, `where` (n, 3) places the nodes in the body's frame.
    """

    outline: _Outline
    middle: Array
    half: Array
    nodes: Array
    where: Array
    material: Array

    @staticmethod
    def of(outlines: Sequence[_Outline], number: int, begin: int) -> _Cells:
        """The cells of one of a body's outlines, but for what is in those before it; their nodes are counted from `begin`."""
        outline = outlines[number]
        others = [each for each in outlines[:number] if each.meets(outline)]
        size = max(np.ptp([each.place for each in outlines], axis=0).max(), *(float(np.max(each.solid.sides)) for each in outlines))
        grid = outline.planes(size / _WHOLE)
        places = np.array(list(product(*(range(len(each) - 1) for each in grid))))
        low, high = (np.stack([each[places[:, axis] + step] for axis, each in enumerate(grid)], axis=1) for step in (0, 1))
        middle, half = 0.5 * (low + high), 0.5 * (high - low)
        points = (middle[:, None] + half[:, None] * _POINTS).reshape(-1, 3) @ outline.rotation.T + outline.place
        inside = outline.contains(points) & ~np.any([each.contains(points) for each in others], axis=0)
        inside = inside.reshape(len(middle), -1)
        kept = np.mean(inside, axis=1) > _EMPTY
        counts = [2 * len(each) - 1 for each in grid]
        numbers = np.ravel_multi_index(tuple(np.moveaxis(2 * places[kept][:, None] + _CORNERS, -1, 0)), counts)
        used, numbers = np.unique(numbers, return_inverse=True)
        ways = [np.interp(np.arange(count), 2 * np.arange(len(each)), each) for count, each in zip(counts, grid, strict=True)]
        where = np.stack([way[index] for way, index in zip(ways, np.unravel_index(used, counts), strict=True)], axis=1)
        where = where @ outline.rotation.T + outline.place
        return _Cells(outline, middle[kept], half[kept], begin + numbers.reshape(-1, _NODES), where, inside[kept])

    @property
    def stiffness(self) -> Array:
        """Stiffness (c, 60, 60) of each cell, in the body's axes; cells of the same size and material share it."""
        kinds, number = np.unique(np.hstack([np.round(self.half / np.max(self.half), 6), self.material]), axis=0, return_inverse=True)
        half, inside = np.max(self.half) * kinds[:, :3], kinds[:, 3:]
        share = np.where(inside, 1.0, _VOID) * (np.prod(half, axis=1) / 8.0)[:, None]
        pairs = (share @ _pairs()).reshape(-1, 3, 3, _NODES, _NODES) / (half[:, :, None] * half[:, None])[..., None, None]
        whole = self.outline.first * pairs + self.outline.shear * np.swapaxes(pairs, 1, 2)
        whole[:, range(3), range(3)] += self.outline.shear * np.trace(pairs, axis1=1, axis2=2)[:, None]
        turn = self.outline.rotation
        return np.einsum("xa,cabij,yb->cixjy", turn, whole, turn, optimize=True).reshape(-1, 3 * _NODES, 3 * _NODES)[number.ravel()]

    @property
    def masses(self) -> Array:
        """Mass matrix (c, 20, 20) of each cell along one axis."""
        share = self.outline.density * self.material * (np.prod(self.half, axis=1) / 8.0)[:, None]
        return np.einsum("cp,pi,pj->cij", share, _SHAPES, _SHAPES, optimize=True)

    @property
    def samples(self) -> tuple[Array, Array]:
        """Points (n, 3) of the cells and their faces, in the body's frame, and the stiffness that ties each to another outline [N/m]."""
        points = (self.middle[:, None] + self.half[:, None] * _SAMPLES).reshape(-1, 3) @ self.outline.rotation.T + self.outline.place
        stiffness = _TIE * self.outline.shear * np.cbrt(np.prod(self.half, axis=1))
        return points, np.repeat(stiffness, len(_SAMPLES))

    def shares(self, points: Array) -> tuple[Array, Array, Array]:
        """Nodes (n, 20) whose motion is that of points (n, 3), with the share of each; distances (n,) from the cells."""
        own = (points - self.outline.place) @ self.outline.rotation
        full = np.mean(self.material, axis=1)
        sound = np.flatnonzero(full >= min(_SOUND, float(np.max(full))))
        apart = np.abs(own[:, None] - self.middle[sound]) - self.half[sound]
        beyond = np.linalg.norm(np.maximum(apart, 0.0), axis=2)
        nearest = np.argmin(beyond + _SAME * np.max(np.abs(apart), axis=2), axis=1)
        cell = sound[nearest]
        shares = _shapes((own - self.middle[cell]) / self.half[cell])[0]
        return self.nodes[cell], shares, np.take_along_axis(beyond, nearest[:, None], axis=1)[:, 0]


@dataclass(frozen=True, eq=False)
class _Solid:
    """A body of cells: K (n, n), M R (n, 6) and the rigid motions R (n, 6)."""

    cells: Sequence[_Cells]
    stiffness: Any
    momenta: Array
    rigid: Array

    @staticmethod
    def of(outlines: Sequence[_Outline]) -> _Solid | None:
        """Cells of all outlines, tied together where these meet or overlap; none where no cell has material."""
        cells: list[_Cells] = []
        for number in range(len(outlines)):
            found = _Cells.of(outlines, number, sum(len(other.where) for other in cells))
            cells += [found] if len(found.middle) else []
        if not cells:
            return None
        where = np.concatenate([each.where for each in cells])
        rigid = np.concatenate([np.broadcast_to(np.eye(3), (len(where), 3, 3)), -cross_matrix(where)], axis=2)
        nodes = np.concatenate([each.nodes for each in cells])
        freedoms = (3 * nodes[..., None] + np.arange(3)).reshape(len(nodes), -1)
        pairs = (np.repeat(freedoms, 3 * _NODES, axis=1).ravel(), np.tile(freedoms, (1, 3 * _NODES)).ravel())
        values = np.concatenate([each.stiffness for each in cells])
        stiffness = scipy.sparse.csc_array((values.ravel(), pairs), (3 * len(where), 3 * len(where))) + _ties(cells, len(where))
        momenta = np.zeros_like(rigid)
        np.add.at(momenta, nodes, np.einsum("cnm,cmak->cnak", np.concatenate([each.masses for each in cells]), rigid[nodes], optimize=True))
        return _Solid(cells, stiffness, momenta.reshape(-1, 6), rigid.reshape(-1, 6))

    def flexibility(self, faces: Array) -> Array:
        """Compliance (6 k, 6 k) of ends with faces (k, 9, 3), centres first: their mean twists under wrenches on them."""
        readings = np.concatenate([self._mean_twist(face) for face in faces])
        mean = np.linalg.solve(self.rigid.T @ self.momenta, self.momenta.T)
        load = readings.T - mean.T @ (self.rigid.T @ readings.T)
        fixed = scipy.linalg.qr(self.rigid.T, pivoting=True, mode="economic")[2][:6]
        free = np.setdiff1d(np.arange(len(load)), fixed)
        factor = scipy.sparse.linalg.splu(
            self.stiffness[free][:, free].tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True}
        )
        motion = np.zeros_like(load)
        motion[free] = factor.solve(load[free])
        found = readings @ (motion - self.rigid @ (mean @ motion))
        return 0.5 * (found + found.T)

    def _mean_twist(self, face: Array) -> Array:
        """Rows (6, n) that read the twist of a face about its centre from the motion of the nodes, by least squares."""
        nearest = min((each.shares(face) for each in self.cells), key=lambda found: round(float(np.sum(found[2])), 9))
        points = np.zeros((len(face), 3, len(self.rigid)))
        for axis in range(3):
            np.put_along_axis(points[:, axis], 3 * nearest[0] + axis, nearest[1], axis=1)
        arms = np.concatenate([np.broadcast_to(np.eye(3), (len(face), 3, 3)), -cross_matrix(face - face[0])], axis=2).reshape(-1, 6)
        return np.linalg.pinv(arms) @ points.reshape(-1, len(self.rigid))


def _ties(cells: Sequence[_Cells], nodes: int) -> Any:
    """Stiffness that ties the cells of each outline to those of the others, at points that are inside both or on both."""
    columns, values, weights = [np.zeros((0, 2 * _NODES), dtype=int)], [np.zeros((0, 2 * _NODES))], [np.zeros(0)]
    samples = {id(each): each.samples for each in cells}
    for one, other in (pair for pair in permutations(cells, 2) if pair[0].outline.meets(pair[1].outline)):
        points, stiffness = samples[id(one)]
        slack = 1e-6 * float(np.max(one.half))
        shared = np.flatnonzero(other.outline.contains(points, slack) & one.outline.contains(points, slack))
        if len(shared):
            (own, mine, _), (theirs, less, _) = one.shares(points[shared]), other.shares(points[shared])
            columns.append(np.concatenate([own, theirs], axis=1))
            values.append(np.concatenate([mine, -less], axis=1))
            weights.append(stiffness[shared])
    column, weight = np.concatenate(columns), np.concatenate(weights)
    rows = np.repeat(np.arange(len(weight)), 2 * _NODES)
    gap = scipy.sparse.csc_array((np.concatenate(values).ravel(), (rows, column.ravel())), (len(weight), nodes))
    return scipy.sparse.kron(gap.T @ scipy.sparse.diags_array(weight) @ gap, np.eye(3), format="csc")


def _shapes(points: Array) -> tuple[Array, Array]:
    """Serendipity shape functions (p, 20) of a cell of half sizes one, and their gradients (p, 20, 3), at points (..., 3).

    They are the 27 triquadratic ones, where the motion of the middles of faces and of the cell follows that of corners and edges.
    """
    at = np.atleast_2d(points)
    values = np.stack([0.5 * at * (at - 1.0), 1.0 - at * at, 0.5 * at * (at + 1.0)], axis=-1)
    slopes = np.stack([at - 0.5, -2.0 * at, at + 0.5], axis=-1)
    chosen = [[slopes if axis == along else values for axis in range(3)] for along in range(3)]
    x, y, z = (values[:, axis] for axis in range(3))
    gradients = [np.einsum("pi,pj,pk->pijk", *(each[:, axis] for axis, each in enumerate(way))).reshape(-1, 27) for way in chosen]
    return np.einsum("pi,pj,pk->pijk", x, y, z).reshape(-1, 27) @ _FOLLOW, np.stack([each @ _FOLLOW for each in gradients], axis=-1)


def _follow() -> Array:
    """Motion (27, 20) of the points of a triquadratic cell by that of its corners and the middles of its edges."""
    points = np.array(list(product(range(3), repeat=3)))
    near = np.all((points[:, None] == _CORNERS) | (points[:, None] == 1), axis=2)
    middles = np.sum(points == 1, axis=1)[:, None]
    ones = np.sum(_CORNERS == 1, axis=1)
    return near * np.where(middles < 2, ones == middles, np.where(ones > 0, 0.5 / np.maximum(middles - 1, 1), -0.25))


_NODES = len(_CORNERS)
_FOLLOW = _follow()
_SHAPES, _SLOPES = _shapes(_POINTS)


@SESSION.keep(1)
def _pairs() -> Array:
    """Products (p, 3600) of the slopes of any two nodes of a cell, at its points."""
    return np.einsum("pik,pjl->pklij", _SLOPES, _SLOPES).reshape(len(_POINTS), -1)
