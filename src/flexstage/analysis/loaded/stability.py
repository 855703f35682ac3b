"""Stability of a whole stage: linearised buckling load factors in the nominal position.

Linearised buckling of the nominal stage solves (K + lambda K_g) x = 0. The geometric stiffness K_g is the second variation of the energy of
the loaded stage. K_g has one term for every part under its wrench (`beams.geometric`), and one term for every rigid body. The term of a
rigid body is tr(S) I - (S + S^T)/2 with S = sum F r^T. F are the forces on the body. The points of application of these forces rotate with
the body; r are their positions relative to the body's reference point.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Annotated, Any, ClassVar, TypeAlias, cast

import numpy as np
import scipy

from flexstage.analysis.workspace.load import SAFETY, dead_loads
from flexstage.analysis.workspace.stroke import StrokeLimits
from flexstage.base.finding import DesignError, Finding, refuse, require
from flexstage.base.number import Array, first_design, matvec, stack
from flexstage.base.record import Heading, Layout
from flexstage.base.session import SESSION
from flexstage.base.sparse import Rows, Sparse, below, few
from flexstage.base.units.quantity import LENGTH, RATIO
from flexstage.beams.compliance import locked_freedoms as locked_by
from flexstage.beams.geometric import Geometric, geometric
from flexstage.beams.mass import mass
from flexstage.mechanism.assembly.expand import Assembly, PlacedLink, by_part, expand
from flexstage.mechanism.assembly.moving_mass import carried_masses
from flexstage.mechanism.drawn import with_drawn_parts
from flexstage.mechanism.mechanism import GROUND, Mechanism
from flexstage.models.linear.large import Quadratic, Solver, least_ratios
from flexstage.models.linear.model import Contribution, LinearModel
from flexstage.models.linear.static import displacement, input_motion
from flexstage.parts.part import push_of
from flexstage.spatial.frame import COMPONENTS, FORCES, spatial_rotation, transport, twist_transform

DOUBTFUL = 20.0
"""Load factor below which the stiffness of the loaded stage differs from the nominal stiffness by more than about 5 %."""

_KEPT, _ALIKE, _REPEATED, _NAMED = 3, 1e-9, 1e-6, 6
_NONE = 1e-9
"""Relative softening below which the stage counts as not softened: rounding."""
_NEUTRAL = 1e-6
"""Stiffness over mass [1/s^2] of a motion without stiffness that is rounding."""
LARGE = 900
"""Degrees of freedom above which matrices are sparse."""
_DENSE = 6000
"""Degrees of freedom above which no loaded state is computed."""
_SHAPES = 6
"""Number of buckling modes computed for a large stage."""


@dataclass(frozen=True, eq=False)
class Stability:
    """Buckling load factors of a stage (...). `dead` is the load factor of weight, payloads and forces with all strokes zero.

    `worst` (...) is the load factor of the permanent load together with the worst `strokes` (..., m) [m]; it is infinite if nothing softens
    the stage. `stiffens` (...) is the largest relative increase of any stiffness due to the permanent load. `moving` names the bodies with
    the largest motion in the buckling mode.
    """

    TABLE: ClassVar[Layout] = Layout(
        "Buckling of the stage",
        "dead worst",
        notes=("Linearised load factor at which the whole stage buckles; each compressed part has its actual end conditions.",),
    )

    dead: Annotated[Array, RATIO, Heading("permanent load", digits=4, infinite="none", mark=SAFETY)]
    worst: Annotated[Array, RATIO, Heading("permanent load, worst strokes", digits=4, infinite="none", mark=SAFETY)]
    strokes: Annotated[Array, LENGTH]
    stiffens: Annotated[Array, RATIO]
    moving: tuple[str, ...]
    provenance: str

    @property
    def refusals(self) -> tuple[Finding, ...]:
        """Error if the stage buckles in its nominal position under permanent load; otherwise an empty tuple."""
        least = float(np.min(np.real(self.dead)))
        if least >= 1.0:
            return ()
        what = (
            f"the nominal position is unstable: weight, payloads and forces are {1.0 / least:.3g} times the critical load "
            f"(load factor {least:.3g}), at which {buckling_clause(' and '.join(self.moving))}"
        )
        return (Finding("stage", what, "Reduce the load, stiffen the parts in compression, or put them in tension"),)

    @property
    def warnings(self) -> tuple[Finding, ...]:
        """Warnings if stiffness and frequencies of the loaded stage differ significantly from those of the nominal stage."""
        return tuple(self._doubts())

    def _doubts(self) -> Iterator[Finding]:
        dead, worst, stiffer = (float(each) for each in (np.min(np.real(self.dead)), np.min(np.real(self.worst)), np.max(self.stiffens)))
        if 1.0 <= dead < DOUBTFUL:
            what = (
                f"weight, payloads and forces soften the stage: load factor {dead:.3g}, {buckling_clause(' and '.join(self.moving))}. In "
                f"that motion the loaded stage is {100.0 / dead:.2g} % less stiff than the nominal stage, and its frequency "
                f"{_lower(dead):.2g} % lower"
            )
            advice = "Results of the unloaded stage do not include this effect. Stiffen the parts in compression, or put them in tension"
            yield Finding("stage", what, advice)
        if worst < DOUBTFUL and worst < 0.99 * dead:
            what = f"load factor {worst:.3g} at the worst corner of the stroke range"
            if worst >= 1.0:
                what += (
                    f": there the stage is up to {100.0 / worst:.2g} % less stiff than the results show, and a frequency "
                    f"up to {_lower(worst):.2g} % lower"
                )
            yield Finding("stage", what, "Stiffen the parts that the stacks compress, or limit the strokes")
        if stiffer > 1.0 / DOUBTFUL:
            what = f"weight, payloads and forces stiffen the stage by up to {100.0 * stiffer:.2g} % in one motion"
            yield Finding("stage", what, "Expect higher frequencies in that motion than without load")


def buckling_clause(bodies: str) -> str:
    """Return the clause "BODY buckles" for one body, or "BODIES buckle" for several.

    >>> buckling_clause("table"), buckling_clause("table and frame")
    ('table buckles', 'table and frame buckle')
    """
    return f"{bodies} {'buckle' if ' and ' in bodies else 'buckles'}"


def _lower(factor: float) -> float:
    """Reduction of a frequency at a load factor [%]."""
    return 100.0 * (1.0 - np.sqrt(1.0 - 1.0 / factor))


@SESSION.keep(2)
def stability(mechanism: Mechanism, model: LinearModel, limits: StrokeLimits | None = None) -> Stability:
    """Compute linearised buckling load factors of the stage; if `limits` are specified, also for the worst strokes within these limits.

    `model` must be the lumped model. The worst strokes are at a corner of the limits, because the reciprocal of the factor is a convex
    function of the strokes. Raises `DesignError` for stages with superelements, whose geometric stiffness is unknown.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.lumped import lumped
    >>> stage = double_triangle()
    >>> bool(stability(stage, lumped(stage)).dead > 100.0)
    True
    """
    require(_unknown_softening(expand(mechanism)))
    pieces = _pieces(mechanism, model)
    unit = [pieces.matrix(pieces.geometric(*_stroke(mechanism, pieces, name))) for name in (() if limits is None else limits.actuators)]
    matrices = (pieces.matrix(pieces.stiffness), pieces.dead, *unit)
    corners = np.zeros((1, 0)) if limits is None else np.real(limits.corners)
    if model.floating is not None:
        _require_neutral(model.floating.T @ matrices[1][: len(model.floating), : len(model.floating)] @ model.floating)
    batch = np.broadcast_shapes(corners.shape[:-2], *(each.shape[:-2] for each in matrices))
    corners = np.broadcast_to(corners, (*batch, *corners.shape[-2:]))
    if pieces.is_large:
        rows = [_load_factors_of_large(*matrices, corners=corners)]
    else:
        flat = (np.broadcast_to(each, (*batch, *each.shape[-2:])).reshape(-1, *each.shape[-2:]) for each in matrices)
        each_corners = corners.reshape(int(np.prod(batch)), *corners.shape[-2:])
        rows = [_load_factors(*own, corners=ends) for *own, ends in zip(*flat, each_corners, strict=True)]
    stepped = any(np.iscomplexobj(each) for each in matrices)
    dead, worst = (np.array([getattr(row, name) for row in rows]).reshape(batch) for name in ("dead", "worst"))
    return Stability(
        dead=dead if stepped else np.real(dead),
        worst=worst if stepped else np.real(worst),
        strokes=np.array([row.strokes for row in rows]).reshape(*batch, corners.shape[-1]),
        stiffens=np.array([row.stiffens for row in rows]).reshape(batch),
        moving=pieces.moving(rows[0].shapes),
        provenance=f"linearised buckling of the {model.provenance}",
    )


def _require_neutral(square: Array) -> None:
    """Refuse a dead load that gives motions without stiffness a stiffness of its own, here over mass (k, k) [1/s^2]."""
    if np.max(np.abs(square)) > _NEUTRAL:
        frequency = float(np.sqrt(np.max(np.abs(square)))) / (2.0 * np.pi)
        what = f"this model neglects that weight acts as a spring on a motion without stiffness (frequency {frequency:.3g} Hz)"
        raise refuse("stage", what, "Place the centre of mass on the axis of the bearing, or set gravity along this axis")


@SESSION.keep(2)
def _pieces(mechanism: Mechanism, model: LinearModel) -> _Pieces:
    """Matrices of the stage in terms, shared with and without strokes."""
    return _Pieces.of(mechanism, model)


def is_large(mechanism: Mechanism, model: LinearModel) -> bool:
    """Return whether a stage has too many degrees of freedom for dense matrices of its loaded state.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.models.lumped import lumped
    >>> is_large(parallelogram(), lumped(parallelogram()))
    False
    """
    return _pieces(mechanism, model).size > _DENSE


def prestress(mechanism: Mechanism, model: LinearModel) -> LinearModel:
    """Return the lumped model with the `geometric` stiffness of its permanent load in the nominal position, for a single design.

    The inner bending modes of parts have no mass in this model.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.models.lumped import lumped
    >>> "geometric" in prestress(parallelogram(), lumped(parallelogram())).stiffness
    True
    """
    require(_unknown_softening(expand(mechanism)))
    pieces = _Pieces.of(mechanism, model)
    added, own = (_dense(terms, pieces.size) for terms in (pieces.geometric(*_dead(mechanism, pieces)), pieces.stiffness))
    count = len(model.coordinates)
    across = added[:count, count:]
    inner = np.linalg.solve(own[count:, count:] + added[count:, count:], across.T)
    geometric = Contribution(np.eye(count), added[:count, :count] - across @ inner)
    return replace(model, stiffness={**model.stiffness, "geometric": geometric})


def _unknown_softening(assembly: Assembly) -> Iterator[Finding]:
    for name in assembly.superelements:
        what = "the geometric stiffness of the superelement, and thus its buckling load, is unknown"
        yield Finding(name, what, "Check buckling in the program that computed its matrices")


_Loads: TypeAlias = Mapping[str, list[tuple[Array, Array]]]
"""Loads by body: pairs of a wrench (..., 6) in the stage's axes and its point of application (..., 3)."""
_Terms: TypeAlias = list[tuple[Sparse, Array]]
"""A symmetric matrix as a sum of terms R^T law R."""


@dataclass(frozen=True, eq=False)
class _Pieces:
    """The stage in the model's coordinates and the internal bending of its parts: twists of bodies, laws of links."""

    mechanism: Mechanism
    assembly: Assembly
    model: LinearModel
    twists: Mapping[str, Sparse]
    parts: Mapping[str, Geometric]

    @staticmethod
    def of(mechanism: Mechanism, model: LinearModel) -> _Pieces:
        assembly, size = expand(_with_drawn_parts(mechanism)), len(model.coordinates)
        twists = {GROUND: Sparse(np.zeros(0, dtype=int), np.zeros((6, 0)), size)}
        twists |= {name: _rows(model, tuple(f"{name}.{component}" for component in COMPONENTS)) for name in assembly.bodies}
        return _Pieces(mechanism, assembly, model, twists, by_part(assembly.links, geometric))

    @cached_property
    def is_large(self) -> bool:
        """Whether the matrices of a single design are sparse."""
        if self.size <= LARGE or self.model.designs or any(part.per_force.ndim > 3 for part in self.parts.values()):
            return False
        return self.model.is_sparse or not np.iscomplexobj(self.model.stiffness_matrix)

    @cached_property
    def size(self) -> int:
        return len(self.model.coordinates) + sum(part.inner.shape[-1] for part in self.parts.values())

    def matrix(self, terms: _Terms) -> Any:
        """Sum of terms, dense (..., n + k, n + k), or sparse for a large stage."""
        if self.is_large:
            return Quadratic.of([rows for rows, _ in terms], [law for _, law in terms], self.size)
        return _dense(terms, self.size)

    @cached_property
    def dead(self) -> Any:
        """K_g of the permanent load."""
        return self.matrix(self.geometric(*_dead(self.mechanism, self)))

    @property
    def stiffness(self) -> _Terms:
        """K: stiffness of the model and of the internal bending of every part."""
        own = [(few(item.operator), item.law) for item in self.model.stiffness.values()]
        if self.model.floating is not None:
            momentum = self.model.inertia_matrix @ self.model.floating
            own.append((few(momentum.T), self.model.scale * np.eye(momentum.shape[-1])))
        return own + [(self.inner[name], part.inner[..., None] * np.eye(part.inner.shape[-1])) for name, part in self.parts.items()]

    @cached_property
    def inner(self) -> Mapping[str, Sparse]:
        """Coordinates of internal bending, by link."""
        ends = np.cumsum([len(self.model.coordinates), *(part.inner.shape[-1] for part in self.parts.values())]).tolist()
        places = zip(self.parts, ends[:-1], ends[1:], strict=True)
        return {name: Sparse(np.arange(start, end), np.eye(end - start), self.size) for name, start, end in places}

    @cached_property
    def motions(self) -> Mapping[str, Sparse]:
        """Motion (..., 12 + k, n + k) of both ends at the centre of each link, in its frame, and of its internal bending."""
        return {
            name: below([*(self._end(body, link) for body in link.joins), self.inner[name]], self.size)
            for name, link in self.assembly.links.items()
        }

    def _end(self, body: str, link: PlacedLink) -> Sparse:
        twist = self.twists[body]
        return twist if body == GROUND else cast("Sparse", twist_transform(link.frame, self.assembly.bodies[body].reference) @ twist)

    def geometric(self, wrenches: Mapping[str, Array], loads: _Loads) -> _Terms:
        """K_g of the wrenches (..., 6) of all links, and of the loads on bodies."""
        forces = {name: [(load[..., :3], point) for load, point in loads.get(name, ())] for name in self.assembly.bodies}
        terms: _Terms = []
        for name, link in self.assembly.links.items():
            part, wrench = self.parts[name], wrenches[name]
            terms.append((self.motions[name], np.einsum("...i,...iab->...ab", wrench, part.per_force)))
            force = link.frame.direction(wrench[..., :3])
            arm = link.frame.direction(part.half[..., None] * np.eye(3)[0])
            for body, sign in zip(link.joins, (1.0, -1.0), strict=True):
                if body != GROUND:
                    forces[body].append((sign * force, link.frame.position - sign * arm))
        turned = {name: _turning_law(self.assembly.bodies[name].reference, acting) for name, acting in forces.items() if acting}
        return terms + [(self.twists[name][..., slice(3, 6), :], law) for name, law in turned.items()]

    def moving(self, shapes: Array) -> tuple[str, ...]:
        """Bodies with the largest motion of reference points over the modes (n + k, s) of one load factor."""
        first = {name: np.real(first_design(twist.values, 2)) @ shapes[twist.columns] for name, twist in self.twists.items()}
        sizes = {name: float(np.linalg.norm(twist[:3])) for name, twist in first.items() if name != GROUND}
        largest = max(sizes.values(), default=0.0)
        return tuple(name for name, size in sizes.items() if size > 0.5 * largest > 0.0)[:_NAMED]


def _dense(terms: _Terms, size: int) -> Array:
    """The sum (..., n, n) of terms."""
    smalls: list[tuple[Array, Array]] = []
    for rows, law in terms:
        places, own = np.unique(rows.columns, return_inverse=True)
        motion = rows.values @ np.eye(len(places))[own]
        smalls.append((places, motion.mT @ law @ motion))
    batch = np.broadcast_shapes(*(small.shape[:-2] for _, small in smalls))
    result = np.zeros((*batch, size, size), dtype=np.result_type(float, *(small for _, small in smalls)))
    for places, small in smalls:
        result[..., places[:, None], places] += small
    return result


def _turning_law(reference: Array, acting: list[tuple[Array, Array]]) -> Array:
    """Rotational stiffness (..., 3, 3) of forces at points of a rigid body."""
    moment = sum((force[..., :, None] * (point - reference)[..., None, :] for force, point in acting), np.zeros((3, 3)))
    return np.linalg.trace(moment)[..., None, None] * np.eye(3) - 0.5 * (moment + moment.mT)


def _with_drawn_parts(mechanism: Mechanism) -> Mechanism:
    """The description with drawn parts instead of the computed matrices that replace them."""
    try:
        return with_drawn_parts(mechanism)
    except DesignError:
        return mechanism


def _dead(mechanism: Mechanism, pieces: _Pieces) -> tuple[dict[str, Array], _Loads]:
    """Wrenches of the links under weight, payloads and forces, strokes zero; and these loads."""
    model = pieces.model
    loads = _weights(mechanism)
    total = sum(dead_loads(mechanism, model).values(), np.zeros(len(model.coordinates)))
    seen = _spring_forces(pieces, displacement(model, total[..., None]))
    sprung = {name: seen[name] - _pushed(link) for name, link in pieces.assembly.links.items()}
    return _whole(mechanism, sprung, loads), loads


def _pushed(link: PlacedLink) -> Array:
    """Initial compression (..., 6) of a link."""
    push = push_of(link.part)
    return np.zeros(6) if push is None else np.asarray(push)[..., None] * np.eye(6)[0]


def _stroke(mechanism: Mechanism, pieces: _Pieces, actuator: str) -> tuple[dict[str, Array], _Loads]:
    """Wrenches of the links per unit of stroke [1/m]."""
    column = pieces.model.input_index((actuator,))
    return _whole(mechanism, _spring_forces(pieces, input_motion(pieces.model, column), column), {}), {}


def _spring_forces(pieces: _Pieces, motion: Array, column: Sequence[int] = ()) -> dict[str, Array]:
    """Forces (..., 6) in the springs of every link due to a motion (..., n, 1) and a unit input."""
    model, links = pieces.model, pieces.assembly.links
    rows = model.output_index(tuple(f"{name}.{force}" for name in links for force in FORCES))
    seen = (model.seen(rows, motion) + np.sum(model.feedthrough[..., rows, :][..., list(column)], axis=-1, keepdims=True))[..., 0]
    return dict(zip(links, np.moveaxis(seen.reshape(*seen.shape[:-1], -1, 6), -2, 0), strict=True))


def _weights(mechanism: Mechanism) -> _Loads:
    """Weights of bodies, payloads and links, and specified forces."""
    assembly, gravity = expand(mechanism), stack(mechanism.gravity)
    loads: dict[str, list[tuple[Array, Array]]] = {name: [] for name in assembly.bodies}
    for name, placed in assembly.bodies.items():
        loads[name] += [(_force(item.mass[..., None] * gravity), item.centre) for item in carried_masses(mechanism, placed)]
    masses = by_part(assembly.links, mass)
    for name, link in assembly.links.items():
        back = link.frame.rotation.mT
        fall = matvec(back, gravity)
        pulled = masses[name][..., :12, :12] @ np.concatenate([_force(fall), _force(fall)], axis=-1)[..., None]
        for place, body in enumerate(link.joins):
            if body != GROUND:
                wrench = (spatial_rotation(link.frame.rotation) @ pulled[..., 6 * place : 6 * place + 6, :])[..., 0]
                loads[body].append((wrench, link.frame.position))
    for force in mechanism.forces.values():
        if force.body != GROUND:
            loads[force.body].append((_force(stack(force.force)), stack(force.at)))
    return loads


def _force(force: Array) -> Array:
    return np.concatenate([force, np.zeros_like(force)], axis=-1)


def _whole(mechanism: Mechanism, sprung: dict[str, Array], loads: _Loads) -> dict[str, Array]:
    """Wrenches of the links including constraint forces of locked degrees of freedom, from the equilibrium of every body."""
    assembly = expand(mechanism)
    locked = {name: [freedom.index for freedom in locked_by(link.part)] for name, link in assembly.links.items()}
    if not any(locked.values()):
        return sprung
    order = {name: slice(6 * place, 6 * place + 6) for place, name in enumerate(assembly.bodies)}
    batch = np.broadcast_shapes(*(each.shape[:-1] for each in sprung.values()))
    unmet = np.zeros((*batch, 6 * len(order)), dtype=np.result_type(*sprung.values()))
    for name, placed in assembly.bodies.items():
        for load, point in loads.get(name, []):
            unmet[..., order[name]] += matvec(transport(point - placed.reference).mT, load)
    columns: list[Array] = []
    for name, link in assembly.links.items():
        carry = np.zeros((*batch, 6 * len(order), 6), dtype=np.result_type(unmet, link.frame.position))
        for body, sign in zip(link.joins, (1.0, -1.0), strict=True):
            if body != GROUND:
                carry[..., order[body], :] = sign * twist_transform(link.frame, assembly.bodies[body].reference).mT
        unmet = unmet + matvec(carry, sprung[name])
        columns.append(carry[..., locked[name]])
    held = np.concatenate(columns, axis=-1)
    forces = -np.linalg.pinv(np.real(held)) @ unmet[..., None]
    result, place = {}, 0
    for name, wrench in sprung.items():
        whole = np.zeros((*batch, 6), dtype=np.result_type(wrench, forces)) + wrench
        whole[..., locked[name]] += forces[..., place : place + len(locked[name]), 0]
        place += len(locked[name])
        result[name] = whole
    return result


@dataclass(frozen=True)
class _LoadFactors:
    """Load factors of one design, and the buckling `shapes` (n + k, s) under its permanent load; several for a repeated factor."""

    dead: complex
    worst: complex
    strokes: Array
    stiffens: float
    shapes: Array


def _load_factors(stiffness: Array, *parts: Array, corners: Array) -> _LoadFactors:
    """Load factors of one design; complex-step numbers use the mode of the real design."""
    root = scipy.linalg.cholesky(np.real(stiffness), lower=True)
    normal = [_normal(root, np.real(each)) for each in parts]
    values, shapes = np.linalg.eigh(normal[0])
    strokes, steep = _worst(np.linalg.eigh, np.eye(len(root)), normal, corners) if parts[1:] else (corners[0], shapes[:, 0])
    back = partial(scipy.linalg.solve_triangular, root.T, lower=False)
    return _assess(stiffness, parts, strokes, back(steep), largest=values[-1], shapes=back(shapes[:, _repeated(values)]))


def _load_factors_of_large(stiffness: Quadratic, *parts: Quadratic, corners: Array) -> _LoadFactors:
    """Load factors of one large design: least eigenvalues of K_g x = mu K x with sparse matrices."""
    softest = partial(_softest, Solver(stiffness))
    values, shapes = softest(parts[0])
    strokes, steep = _worst(softest, stiffness, parts, corners) if parts[1:] else (corners[0], shapes[:, 0])
    return _assess(stiffness, parts, strokes, steep, largest=-softest(-1.0 * parts[0])[0][0], shapes=shapes[:, _repeated(values)])


def _assess(stiffness: Any, parts: Sequence[Any], strokes: Array, steep: Array, *, largest: float, shapes: Array) -> _LoadFactors:
    """Load factors from the extreme mu of the permanent load, its buckling modes, and the mode at the worst corner."""
    dead, worst = _factor(stiffness, parts[0], shapes[:, 0]), _factor(stiffness, _combined(parts, strokes), steep)
    return _LoadFactors(dead, min(dead, worst, key=np.real), strokes, float(max(largest, 0.0)), shapes)


def _repeated(values: Array) -> Array:
    """Mask of ascending values that equal the first."""
    return values <= values[0] + _REPEATED * np.abs(values[0]) + _ALIKE * np.max(np.abs(values))


def _combined(parts: Sequence[Any], strokes: Array) -> Any:
    """K_g of the permanent load (first term) and of strokes."""
    return sum((stroke * each for stroke, each in zip(strokes.tolist(), parts[1:], strict=True)), parts[0])


def _worst(softest: Callable[[Any], Any], stiffness: Any, parts: Sequence[Any], corners: Array) -> tuple[Array, Array]:
    """Corner with the least eigenvalue, and its mode.

    Eigenvalues in the subspace of modes of some corners bound those of all corners from above. The corner with the least bound is solved
    and its modes added, until that corner is already solved.
    """
    weights = np.concatenate([np.ones((len(corners), 1)), corners], axis=-1)
    target = [0, len(corners) - 1, *(2**place for place in range(corners.shape[-1]))]
    space, solved = np.zeros((stiffness.shape[-1], 0)), dict[int, Array]()
    while True:
        for corner in dict.fromkeys(target):
            solved[corner] = softest(_combined(parts, corners[corner]))[1][:, :_KEPT]
            space = _orthonormal(stiffness, np.concatenate([space, solved[corner]], axis=-1))
        small = np.array([space.T @ (part @ space) for part in parts])
        bounds = np.linalg.eigvalsh(np.tensordot(weights, small, axes=1))[:, 0]
        least = int(np.argmax(bounds <= np.min(bounds) + _ALIKE * np.max(np.abs(bounds))))
        if least in solved:
            return corners[least], solved[least][:, 0]
        target = [least]


def _orthonormal(stiffness: Any, shapes: Array) -> Array:
    """Orthonormal basis of the same space in the energy norm."""
    shapes = shapes / np.sqrt(np.sum(shapes * (stiffness @ shapes), axis=0))
    values, turn = np.linalg.eigh(shapes.T @ (stiffness @ shapes))
    kept = values > _ALIKE
    return (shapes @ turn)[:, kept] / np.sqrt(values[kept])


def _factor(stiffness: Any, softening: Any, shape: Array) -> complex:
    """Rayleigh quotient of a mode: elastic over geometric energy; infinite without softening."""
    elastic, taken = shape @ (stiffness @ shape), -(shape @ (softening @ shape))
    return complex(elastic / taken) if np.real(taken) > _NONE * np.real(elastic) else complex(np.inf)


def _softest(solver: Solver, softening: Quadratic) -> tuple[Array, Array]:
    """Least mu of K_g x = mu K x and their modes (n + k, s)."""
    if not softening.matrix.count_nonzero():
        return np.zeros(1), solver.solve(np.ones((softening.shape[-1], 1)))
    return least_ratios(solver, softening, _SHAPES)


def _normal(root: Array, matrix: Array) -> Array:
    half = scipy.linalg.solve_triangular(root, matrix, lower=True)
    whole = scipy.linalg.solve_triangular(root, half.T, lower=True)
    return 0.5 * (whole + whole.T)


def _rows(model: LinearModel, names: tuple[str, ...]) -> Sparse:
    index = model.output_index(names)
    return cast("Rows", model.output).few(index[0], len(index)) if model.is_sparse else few(model.output[..., index, :])
