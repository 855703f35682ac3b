"""Ideal model: rigid bodies; hinges are free in their intended DOFs and locked in all others; superelements are rigid.

The unknowns are the twists of all bodies and the strokes. The deformations of every link in locked DOFs are zero. For an actuator, the
locked deformations equal its free deformation times its stroke. The remaining motions give R_a = da/dx and R_s = ds/dx (Eqs. 13 and 14 of
Shin & Moon) for strokes a, gauge readings s and platform motion x. They also give the platform mobility, free internal modes and redundant
constraints.

Force actuators do not constrain motion. Their generalised forces on the ideal motions are computed by virtual work.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, cast

import numpy as np
import scipy

from flexstage.base.arguments import check_arguments
from flexstage.base.finding import DesignError, Finding, refuse, require
from flexstage.base.number import Array, Number, first_design, join
from flexstage.base.session import SESSION
from flexstage.base.sparse import Rows, Sparse, as_csr, few
from flexstage.base.storage.digest import digest
from flexstage.beams.compliance import law
from flexstage.mechanism.assembly.expand import Assembly, IdentityKey, PlacedLink, PlacedSuperelement, expand
from flexstage.mechanism.assembly.incidence import LARGE, Layout, deformation, free_deformations, is_single, layout, require_room, twist_at
from flexstage.mechanism.mechanism import GROUND, PLATFORM, Mechanism
from flexstage.models.linear.block_elimination import eliminate_blocks
from flexstage.models.linear.blockage import Blockage, blockage
from flexstage.models.linear.channels import reading
from flexstage.models.linear.elimination import Elimination, echelon, eliminate_each, null_space, unlike
from flexstage.models.linear.kinematics import FreeInternalMode, Kinematics, RedundantConstraint
from flexstage.models.linear.large import least_strain
from flexstage.parts.freedom import ALL, Freedom
from flexstage.spatial.frame import COMPONENTS

_NEGLIGIBLE = 1e-7
_ENERGYLESS = 1e-12
_MATRICES = 10.0
"""Dense matrices in memory at once: 9 to 12 on chains of 200 and 300 rods, measured."""


@dataclass(frozen=True, eq=False)
class _Graph:
    """The stage as constraints: `strain` of all links (..., 6 L, N), constraint rows (..., m, N + n) and their names.

    `scale` (..., N + n) makes coordinates comparable by the `length` (...) of each design.
    """

    assembly: Assembly
    order: Layout
    strain: Array
    constraints: Array
    names: tuple[str, ...]
    scale: Array
    length: Number
    elements: Mapping[str, PlacedSuperelement]


def free_freedoms(link: PlacedLink) -> tuple[Freedom, ...]:
    """Return the free DOFs of a link: the DOFs specified at the link or, if none are specified, the intended DOFs of the part.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> [freedom.value for freedom in free_freedoms(expand(double_triangle()).links["B4/pivot"])]
    ['rz']
    """
    return link.link.free if link.link.free is not None else link.part.intended


@check_arguments
def ideal(mechanism: Mechanism) -> Kinematics:
    """Compute the ideal kinematics of a stage.

    Motions are small, about the nominal position. Raises `DesignError` if a stroke moves only its own actuator (an actuator not connected
    to the platform). Under-actuated stages are accepted, but their `mapping` raises `DesignError`.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> ideal(double_triangle()).mapping.values[0].round(3).tolist()
    [1.0, 0.0, 0.0, 0.0, -0.025, 0.085]
    """
    return _cached(IdentityKey(mechanism)) if is_single(expand(mechanism)) else _read(mechanism)


@SESSION.keep(2)
def _cached(key: IdentityKey) -> Kinematics:
    """Result of one design, cached for further calls with the same description."""
    return _read(key.mechanism)


def _read(mechanism: Mechanism) -> Kinematics:
    return _ideal_of_large(mechanism) or _ideal(mechanism)


def _ideal(mechanism: Mechanism) -> Kinematics:
    """Kinematics by dense matrices, of all designs of a batch."""
    graph = _graph(mechanism)
    solution = eliminate_each(graph.constraints, graph.scale, keep=tuple(range(6)))
    freedoms = [index for index in solution.independent if index < 6]
    columns = [solution.independent.index(index) for index in freedoms]
    idle_columns = [index for index in range(len(solution.independent)) if index not in columns]
    size = graph.order.size
    idle = np.real(solution.basis[..., idle_columns])
    _require_paths(graph, idle[..., size:, :])
    motion = _without_idle(graph, solution, columns, idle_columns)
    bodies, strokes = motion[..., :size, :], motion[..., size:, :]
    sensed = _sense(graph, solution, columns, idle_columns, bodies)
    result = Kinematics(
        actuators=tuple(graph.assembly.strokes),
        coordinates=tuple(COMPONENTS[index] for index in freedoms),
        gauges=tuple(graph.assembly.gauges),
        gauge_units=tuple(gauge.unit for gauge in graph.assembly.gauges.values()),
        sums={name: gauge.members for name, gauge in graph.assembly.gauges.items() if gauge.members},
        actuation=strokes,
        sensing=_sensing(graph, sensed),
        motion=bodies[..., :6, :],
        body_coordinates=graph.order.coordinates,
        bodies=bodies,
        strains=dict(zip(graph.assembly.links, _by_link(graph.strain @ bodies), strict=True)) | _element_strains(graph, bodies),
        free={name: free_freedoms(link) for name, link in graph.assembly.links.items()},
        idle=_idle(graph, first_design(idle, 2)[:size]),
        redundant=_redundant(graph),
        length=graph.length,
        provenance=f"ideal model of {digest(mechanism, physics=True)[:16]}",
        thrusts=tuple(graph.assembly.thrusts),
        thrust_inputs=tuple(graph.assembly.actuator(name).input.si for name in graph.assembly.thrusts),
        thrust=_thrust(graph, sensed),
    )
    return replace(result, blocked=_blockages(graph, result.immobile)) if result.immobile else result


def _ideal_of_large(mechanism: Mechanism) -> Kinematics | None:
    """Kinematics of one large design, body by body; `None` for others, and if gauges or forces see free internal modes."""
    whole = expand(mechanism)
    assembly = whole.welded
    if len(assembly.bodies) < LARGE or whole.superelements or not is_single(assembly) or not assembly.links:
        return None
    order = layout(assembly, sparse=True)
    operators = [cast("Sparse", deformation(assembly, order, link)) for link in assembly.links.values()]
    rows, names = _large_constraints(assembly, operators, order.size)
    length = _length(assembly)
    scale = _scale(assembly, length)
    solved = eliminate_blocks(rows, scale, len(order.bodies), len(assembly.strokes))
    free = [index for index in solved.last.independent if index < 6]
    columns = [solved.last.independent.index(index) for index in free]
    idle_columns = [index for index in range(len(solved.last.independent)) if index not in columns]
    graph = _Graph(assembly, order, cast("Array", Rows.of(operators, order.size)), np.zeros((0, 0)), names, scale, length, {})
    _require_paths(graph, solved.last.basis[6:, idle_columns])
    size = order.size
    idle = as_csr([Sparse(each.columns, each.values, len(scale)) for each in solved.idle], len(scale)).T.tocsr()[:size]
    strained = cast("Rows", graph.strain).entries @ idle if idle.shape[1] else None
    watching = [*(_reading(graph, name) for name in assembly.gauges), *_elongations(graph).values()]
    if idle_columns or (strained is not None and any(_sees_few(row, idle) for row in watching)):
        return None
    strokes = solved.last.basis[6:, columns]
    bodies = _least_deformed(graph, solved.last.basis[:6, columns], strokes)
    if bodies is None:
        return None
    strains = graph.strain @ bodies
    result = Kinematics(
        actuators=tuple(assembly.strokes),
        coordinates=tuple(COMPONENTS[index] for index in free),
        gauges=tuple(assembly.gauges),
        gauge_units=tuple(gauge.unit for gauge in assembly.gauges.values()),
        sums={name: gauge.members for name, gauge in assembly.gauges.items() if gauge.members},
        actuation=strokes,
        sensing=_sensing(graph, bodies),
        motion=bodies[:6],
        body_coordinates=order.coordinates,
        bodies=bodies,
        strains=dict(zip(assembly.links, _by_link(strains), strict=True)),
        free={name: free_freedoms(link) for name, link in assembly.links.items()},
        idle=_named_idle(graph, idle, strained),
        redundant=tuple(RedundantConstraint(tuple(names[place] for place in state)) for state in solved.redundant),
        length=length,
        provenance=f"ideal model of {digest(mechanism, physics=True)[:16]}",
        thrusts=tuple(assembly.thrusts),
        thrust_inputs=tuple(assembly.actuator(name).input.si for name in assembly.thrusts),
        thrust=_thrust(graph, bodies),
    )
    return None if result.immobile else result


def _large_constraints(assembly: Assembly, operators: Sequence[Sparse], size: int) -> tuple[list[Sparse], tuple[str, ...]]:
    """The rows of `_constraints` as one block per constraint."""
    strokes = {link: size + number for number, link in enumerate(assembly.strokes.values())}
    moved = {link: assembly.actuator(name).free_deformation for name, link in assembly.strokes.items()}
    rows: list[Sparse] = []
    names: list[str] = []
    for (name, link), operator in zip(assembly.links.items(), operators, strict=True):
        free = free_freedoms(link)
        for index, freedom in enumerate(ALL):
            if freedom not in free:
                columns, values = operator.columns, operator.values[[index]]
                if name in strokes:
                    columns, values = np.append(columns, strokes[name]), np.append(values, [[-moved[name][index]]], axis=1)
                rows.append(Sparse(columns, values, size + len(strokes)))
                names.append(f"{name}.{freedom.value}")
    return rows, tuple(names)


def _sees_few(row: Array, idle: Any) -> bool:
    """`_sees` for sparse free internal modes."""
    own = few(row)
    signal, most = own.values @ idle[own.columns].toarray(), np.abs(own.values) @ np.abs(idle[own.columns].toarray())
    return bool(np.any(np.abs(signal) > _NEGLIGIBLE * most))


def _least_deformed(graph: _Graph, motion: Array, strokes: Array) -> Array | None:
    """Body motions (N, f) for platform motions (6, f) and strokes (n, f), with free internal modes as in `_without_idle`."""
    links = graph.assembly.links.values()
    rigid = np.array([freedom not in free_freedoms(link) for link in links for freedom in ALL])
    weights = np.tile(_weights(graph.length), len(links))
    over = graph.scale[6 : graph.order.size]
    strain = (scipy.sparse.diags_array(weights) @ cast("Rows", graph.strain).entries).tocsc()
    imposed = strain[:, :6] @ motion - (rigid * weights)[:, None] * (free_deformations(graph.assembly) @ strokes)
    others = least_strain(strain[:, 6:] @ scipy.sparse.diags_array(over), rigid, imposed)
    return None if others is None else np.concatenate([motion, over[:, None] * others])


def _named_idle(graph: _Graph, idle: Any, strained: Any) -> tuple[FreeInternalMode, ...]:
    """Bodies and links that move or strain in each free internal mode."""
    if strained is None:
        return ()
    links = tuple(graph.assembly.links)
    result: list[FreeInternalMode] = []
    moving, deforming = idle.tocsc(), strained.tocsc()
    for place in range(idle.shape[1]):
        size = np.max(np.abs(moving.data[moving.indptr[place] : moving.indptr[place + 1]]), initial=0.0)
        named = [_owners(matrix, place, _NEGLIGIBLE * size, names) for matrix, names in ((moving, graph.order.bodies), (deforming, links))]
        result.append(FreeInternalMode(*named))
    return tuple(result)


def _owners(matrix: Any, column: int, threshold: float, names: tuple[str, ...]) -> tuple[str, ...]:
    """Bodies or links, six rows each, that a column of a sparse matrix moves by more than a threshold."""
    own = slice(matrix.indptr[column], matrix.indptr[column + 1])
    return tuple(names[place] for place in np.unique(matrix.indices[own][np.abs(matrix.data[own]) > threshold] // 6))


def _hinges(graph: _Graph) -> dict[str, PlacedSuperelement]:
    """The superelements whose links specify DOFs."""
    return {name: item for name, item in graph.elements.items() if item.link.free}


def _element_strains(graph: _Graph, bodies: Array) -> dict[str, Array]:
    """Twists (..., 6, f) of their second ports relative to the bodies of the first ones, the deformation of the elastic models."""
    result: dict[str, Array] = {}
    for name, item in _hinges(graph).items():
        first, second = item.ports.values()
        ends = [twist_at(graph.assembly, graph.order, port.body, second.frame) for port in (first, second)]
        result[name] = (ends[1] - ends[0]) @ bodies
    return result


def _blockages(graph: _Graph, immobile: tuple[str, ...]) -> dict[str, Blockage]:
    """Blockage of each immobile stroke, by the addresses of the links in the description."""
    rows = _comparable(graph)
    links = {name: link.drawn.removeprefix("links.") for name, link in graph.assembly.links.items()}
    ends = [name.rpartition(".") for name in graph.names]
    names = tuple(f"{links[link]}.{freedom}" for link, _, freedom in ends)
    meant = {f"{links[name]}.{freedom.value}" for name, link in graph.assembly.links.items() for freedom in link.part.intended}
    actuators = list(graph.assembly.strokes)
    result = {name: blockage(rows, graph.order.size + actuators.index(name), names, frozenset(meant)) for name in immobile}
    return {
        name: replace(each, ends=_rigid_ends(graph.assembly.links[graph.assembly.strokes[name]], each)) for name, each in result.items()
    }


def _rigid_ends(link: PlacedLink, blocked: Blockage) -> tuple[str, ...]:
    """Ends at ground or platform of an actuator whose locked DOFs work against its stroke."""
    own = f"{link.drawn.removeprefix('links.')}."
    stiff = any(name.startswith(own) for name in blocked.against)
    return tuple(body for body in link.joins if body in (GROUND, PLATFORM)) if stiff else ()


def _comparable(graph: _Graph) -> Array:
    """The constraints of the first design, rows scaled to equal size."""
    first = np.real(first_design(graph.constraints, 2)) * first_design(graph.scale, 1)
    norms = np.linalg.norm(first, axis=1)
    return first / np.where(norms > 0.0, norms, 1.0)[:, None]


def _graph(mechanism: Mechanism) -> _Graph:
    whole = expand(mechanism)
    assembly = whole.welded
    require_room(assembly, _MATRICES)
    order = layout(assembly)
    operators = [deformation(assembly, order, link) for link in assembly.links.values()]
    if not operators:
        raise refuse("links", "none specified", "Join bodies by links, for example the platform and the ground")
    strain = join(operators)
    length = _length(assembly)
    constraints, names = _constraints(assembly, strain)
    return _Graph(assembly, order, strain, constraints, names, _scale(assembly, length), length, whole.superelements)


def _scale(assembly: Assembly, length: Number) -> Array:
    """Scale (..., N + n) that makes all coordinates comparable, by real parts."""
    own = _weights(1.0 / np.real(length))
    twists = np.tile(own, len(assembly.bodies))
    return np.concatenate([twists, np.ones((*own.shape[:-1], len(assembly.strokes)))], axis=-1)


def _constraints(assembly: Assembly, strain: Array) -> tuple[Array, tuple[str, ...]]:
    """Constraint rows and their names: locked deformations are zero; an actuator's equal its free deformation times its stroke."""
    locked: dict[str, int] = {}
    for place, (name, link) in enumerate(assembly.links.items()):
        free = free_freedoms(link)
        locked |= {f"{name}.{freedom.value}": 6 * place + index for index, freedom in enumerate(ALL) if freedom not in free}
    places = list(locked.values())
    rows, strokes = strain[..., places, :], -free_deformations(assembly)[..., places, :]
    return join([rows, strokes], axis=-1), tuple(locked)


def _by_link(strains: Array) -> Array:
    """Reshape strains (..., 6 L, k), or twists of bodies, to (L, ..., 6, k)."""
    return np.moveaxis(strains.reshape(*strains.shape[:-2], strains.shape[-2] // 6, 6, strains.shape[-1]), -3, 0)


def _weights(rotation: Number) -> Array:
    """Weights (..., 6): 1 for translations, `length` for rotations."""
    own = np.asarray(rotation)[..., None]
    return np.concatenate([np.ones((*own.shape[:-1], 3)), own, own, own], axis=-1)


def _length(assembly: Assembly) -> Number:
    """Length scale (...) of each design: rms distance of its links from the platform's reference."""
    centre = assembly.bodies[PLATFORM].reference
    arms = [link.frame.position - centre for link in assembly.links.values()]
    squares = [(arm[..., None, :] @ arm[..., None])[..., 0, 0] for arm in arms]
    length = np.sqrt(np.mean(np.stack(np.broadcast_arrays(*squares), axis=-1), axis=-1))
    return np.where(np.real(length) > 0.0, length, 1.0) if length.ndim or np.iscomplexobj(length) else float(length) or 1.0


def _require_paths(graph: _Graph, idle_strokes: Array) -> None:
    """Refuse strokes (..., n, k) that can change with the platform at rest, in any design."""
    moving = np.max(np.abs(idle_strokes), axis=(*range(idle_strokes.ndim - 2), -1), initial=0.0) > _NEGLIGIBLE
    require(
        Finding(
            link,
            f"actuator {name} can move with the platform at rest: the links do not transmit its stroke to the platform",
            "Join its unit to the platform, or lock the degree of freedom along which it slips",
        )
        for (name, link), slips in zip(graph.assembly.strokes.items(), moving, strict=True)
        if slips
    )


def _without_idle(graph: _Graph, solution: Elimination, columns: list[int], idle_columns: list[int]) -> Array:
    """Motions per platform coordinate, free internal modes set for the least deformation of links (rotations times the length scale)."""
    driven, idle = solution.basis[..., columns], solution.basis[..., idle_columns]
    if not idle_columns:
        return driven
    size = graph.order.size
    weighted = np.tile(_weights(graph.length), len(graph.assembly.links))[..., None] * graph.strain
    before, spun = (weighted @ motion[..., :size, :] for motion in (driven, idle))
    transposed = spun.mT
    return driven - idle @ np.linalg.solve(transposed @ spun, transposed @ before)


def _sense(graph: _Graph, solution: Elimination, columns: list[int], idle_columns: list[int], bodies: Array) -> Array:
    """The body motions (..., N, f) for gauges and force actuators.

    Free internal modes that one of them sees have minimal energy in the links they strain. Forces on idle bodies reach the platform in this
    way.
    """
    size = graph.order.size
    driven, idle = solution.basis[..., :size, columns], solution.basis[..., :size, idle_columns]
    still = np.real(idle)
    rows = [*((name, _reading(graph, name)) for name in graph.assembly.gauges), *_elongations(graph).items()]
    watching = [(name, np.real(row)) for name, row in rows if _sees_in_batch(name, np.real(row), still)]
    if not watching:
        return bodies
    energy, mixed = np.zeros((len(idle_columns), len(idle_columns))), np.zeros((len(idle_columns), len(columns)))
    for place, stiffness in _stiffnesses(graph, still, [name for name, _ in watching]):
        strain = graph.strain[..., place, :]
        force = (stiffness @ (strain @ idle)).mT
        energy, mixed = energy + force @ (strain @ idle), mixed + force @ (strain @ driven)
    stored, loose = _split_batch(np.real(energy))
    unresisted = [name for name, row in watching if np.any(_sees(row, still @ loose))]
    require(_undetermined_findings(graph, unresisted, first_design(still @ loose, 2)))
    return driven - idle[..., stored] @ np.linalg.solve(energy[..., stored, :][..., stored], mixed[..., stored, :])


def _sees_in_batch(name: str, row: Array, motions: Array) -> bool:
    """`_sees`, required to be equal in all designs of a batch."""
    flags = np.ravel(_sees(row, motions))
    if np.any(flags != flags[0]):
        raise unlike(
            int(np.argmax(flags != flags[0])), f"differs from the first design in whether {name} is affected by a free internal mode"
        )
    return bool(flags[0])


def _sees(row: Array, motions: Array) -> Array:
    """Whether (...) a gauge row (..., 1, N) sees one of the motions (..., N, k) above rounding."""
    return np.any(np.abs(row @ motions) > _NEGLIGIBLE * (np.abs(row) @ np.abs(motions)), axis=(-2, -1))


def _stiffnesses(graph: _Graph, idle: Array, watching: list[str]) -> Iterator[tuple[slice, Array]]:
    """Rows in the strain, and stiffness, of every link that free internal modes deform."""
    strains = np.abs(_by_link(np.real(graph.strain) @ idle))
    strained = np.max(strains, axis=tuple(range(1, strains.ndim))) > _NEGLIGIBLE
    for number, (name, link) in enumerate(graph.assembly.links.items()):
        if strained[number]:
            element = next((each for each, item in _hinges(graph).items() if name in {weld.name for weld in item.welds()}), None)
            if element is not None:
                what = (
                    f"affected by a free internal mode in specified degrees of freedom of {element}; this model has no stiffness for them"
                )
                raise refuse(", ".join(watching), what, "Move the gauge to the platform, or remove these degrees of freedom")
            try:
                yield slice(6 * number, 6 * number + 6), law(link.part, link.material).stiffness
            except DesignError as error:
                reason = "; ".join(finding.what for finding in error.findings)
                what = f"affected by a free internal mode that strains {name}, and the stiffness of {name} is unknown: {reason}"
                raise refuse(", ".join(watching), what, "Specify the stiffness, or move the gauge to the platform") from error


def _split_batch(energy: Array) -> tuple[list[int], Array]:
    """`_split_by_energy` of all designs (..., k, k), required to agree, and their combinations (..., k, l)."""
    splits = [_split_by_energy(each) for each in energy.reshape(-1, *energy.shape[-2:])]
    stored = splits[0][0]
    for number, (other, _) in enumerate(splits):
        if other != stored:
            raise unlike(number, "differs from the first design in its free internal modes with elastic resistance")
    loose = np.stack([each for _, each in splits])
    return stored, loose.reshape(*energy.shape[:-2], *loose.shape[-2:])


def _split_by_energy(energy: Array) -> tuple[list[int], Array]:
    """Free internal modes that store energy, as many as determine the others, and combinations (k, l) that store none."""
    diagonal = np.diag(energy)
    top = np.max(diagonal, initial=0.0)
    root = np.sqrt(np.where(diagonal > _ENERGYLESS * top, diagonal, top or 1.0))
    scaled = energy / root / root[:, None]
    values, vectors = np.linalg.eigh(scaled)
    loose = values < _ENERGYLESS
    order = scipy.linalg.qr(scaled, pivoting=True)[2][: int(np.sum(~loose))]
    return sorted(int(index) for index in order), (vectors / root[:, None])[:, loose]


def _undetermined_findings(graph: _Graph, gauges: list[str], motions: Array) -> Iterator[Finding]:
    """Warn of gauges that see a free internal mode without elastic resistance."""
    moving = np.max(np.abs(_by_link(motions)), axis=(1, 2), initial=0.0) > _NEGLIGIBLE * np.max(np.abs(motions), initial=0.0)
    bodies = ", ".join(itertools.compress(graph.order.bodies, moving))
    for name in gauges:
        what = "its reading does not follow from" if name in graph.assembly.gauges else "its force does not drive"
        yield Finding(
            name,
            f"affected by a free internal mode without elastic resistance ({bodies}): {what} the platform's motion",
            "Move the gauge to the platform, add stiffness in that degree of freedom to a link of these bodies, or lock it",
        )


def _reading(graph: _Graph, name: str) -> Array:
    """Reading of a gauge (..., 1, N) by the body motions."""
    return reading(graph.assembly.gauges[name], lambda body, frame: twist_at(graph.assembly, graph.order, body, frame))


def _elongations(graph: _Graph) -> dict[str, Array]:
    """Work (..., 1, N) of every force actuator per unit of its input and of the body motions, w^T times its deformation."""
    assembly, places = graph.assembly, {name: 6 * number for number, name in enumerate(graph.assembly.links)}
    found: dict[str, Array] = dict.fromkeys(assembly.thrusts, np.zeros(1))
    for link, (name, wrench) in assembly.pushes.items():
        found[name] = found[name] + wrench[..., None, :] @ graph.strain[..., places[link] : places[link] + 6, :]
    return found


def _thrust(graph: _Graph, bodies: Array) -> Array:
    """Generalised force (..., f, t) on every platform coordinate per unit input of each force actuator, by virtual work."""
    rows = [row @ bodies for row in _elongations(graph).values()]
    none = np.zeros((*bodies.shape[:-2], 0, bodies.shape[-1]))
    return (join(rows) if rows else none).mT


def _sensing(graph: _Graph, bodies: Array) -> Array:
    """Gauge readings per platform twist; gauges on other bodies see only the ideal motions."""
    motion = bodies[..., :6, :]
    rows = [_gauge_row(graph, name, bodies, motion) for name in graph.assembly.gauges]
    if not rows:
        return np.zeros((0, 6))
    return join(rows)


def _gauge_row(graph: _Graph, name: str, bodies: Array, motion: Array) -> Array:
    gauge, row = graph.assembly.gauges[name], _reading(graph, name)
    if all({sight.body, sight.base} <= {PLATFORM, "ground"} for sight in gauge.sights):
        return row[..., :6]
    weighted = motion.mT * _weights(graph.length)[..., None, :] ** 2
    return row @ bodies @ np.linalg.solve(weighted @ motion, weighted)


def _idle(graph: _Graph, motions: Array) -> tuple[FreeInternalMode, ...]:
    scale = first_design(graph.scale, 1)[: graph.order.size, None]
    vectors = echelon((motions / scale).T).T * scale
    strains = np.real(first_design(graph.strain, 2)) @ vectors
    threshold = _NEGLIGIBLE * np.max(np.abs(vectors), axis=0, initial=0.0)
    moving, deforming = (np.max(np.abs(_by_link(parts)), axis=1) > threshold for parts in (vectors, strains))
    return tuple(
        FreeInternalMode(tuple(itertools.compress(graph.order.bodies, moved)), tuple(itertools.compress(graph.assembly.links, strained)))
        for moved, strained in zip(moving.T, deforming.T, strict=True)
    )


def _redundant(graph: _Graph) -> tuple[RedundantConstraint, ...]:
    """Self-stress states of the locked DOFs: left null vectors of the constraints."""
    states = echelon(null_space(_comparable(graph).T).T)
    return tuple(
        RedundantConstraint(tuple(graph.names[place] for place in np.flatnonzero(np.abs(state) > _NEGLIGIBLE))) for state in states
    )
