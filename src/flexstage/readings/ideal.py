"""Ideal reading: rigid bodies, hinges free about their intended freedoms and locked in all others.

Unknowns are the twists of all bodies and the strokes; every link's locked deformations vanish. From the motions that are left follow
R_a = da/dx and R_s = ds/dx (Eqs. 13 and 14 of Shin & Moon), the platform's mobility, idle freedoms and redundant constraints.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from flexstage.base.digest import digest
from flexstage.base.finding import Finding, require
from flexstage.base.number import Array
from flexstage.mechanism.expand import Assembly, PlacedLink, expand
from flexstage.mechanism.incidence import Layout, deformation, layout, twist_at
from flexstage.mechanism.mechanism import PLATFORM, Mechanism
from flexstage.parts.freedom import ALL, Freedom
from flexstage.parts.part import is_actuator
from flexstage.readings.linear.elimination import Elimination, echelon, eliminate, null_space
from flexstage.readings.linear.kinematics import Idle, Kinematics, Redundant
from flexstage.spatial.frame import COMPONENTS

_NEGLIGIBLE = 1e-7


@dataclass(frozen=True, eq=False)
class _Graph:
    """The stage as constraints: deformation operators per link, constraint rows (..., m, N + n) and their names."""

    assembly: Assembly
    order: Layout
    operators: Mapping[str, Array]
    constraints: Array
    names: tuple[str, ...]
    scale: Array
    length: float


def free_freedoms(link: PlacedLink) -> tuple[Freedom, ...]:
    """The freedoms taken as free at a link: its own statement, else the part's intended ones."""
    return link.link.free if link.link.free is not None else link.part.intended


def ideal(mechanism: Mechanism) -> Kinematics:
    """Read a stage as ideal kinematics.

    Small motions about the drawn position. Raises `DesignError` where a stroke moves nothing but itself (an actuator without a path to the
    platform). Under-actuated stages are read, but their `mapping` is refused.
    """
    graph = _graph(mechanism)
    solution = eliminate(graph.constraints, graph.scale, keep=tuple(range(6)))
    freedoms = [index for index in solution.independent if index < 6]
    columns = [solution.independent.index(index) for index in freedoms]
    rest = [index for index in range(len(solution.independent)) if index not in columns]
    size = graph.order.size
    idle = np.real(solution.basis.reshape(-1, *solution.basis.shape[-2:])[0])[:, rest]
    _require_paths(graph, idle[size:])
    motion = _without_idle(graph, solution, columns, rest)
    bodies, strokes = motion[..., :size, :], motion[..., size:, :]
    return Kinematics(
        actuators=tuple(graph.assembly.actuators),
        coordinates=tuple(COMPONENTS[index] for index in freedoms),
        gauges=tuple(graph.assembly.gauges),
        actuation=strokes,
        sensing=_sensing(graph, bodies),
        motion=bodies[..., :6, :],
        body_coordinates=graph.order.coordinates,
        bodies=bodies,
        strains={name: operator @ bodies for name, operator in graph.operators.items()},
        free={name: free_freedoms(link) for name, link in graph.assembly.links.items()},
        idle=_idle(graph, idle[:size]),
        redundant=_redundant(graph),
        length=graph.length,
        provenance=f"ideal reading of {digest(mechanism, physics=True)[:16]}",
    )


def _graph(mechanism: Mechanism) -> _Graph:
    assembly = expand(mechanism)
    order = layout(assembly)
    operators = {name: deformation(assembly, order, link) for name, link in assembly.links.items()}
    drives = {link: number for number, link in enumerate(assembly.actuators.values())}
    rows: list[Array] = []
    names: list[str] = []
    for name, link in assembly.links.items():
        locked = [freedom for freedom in ALL if freedom not in free_freedoms(link)]
        rows.append(_rows(operators[name], locked, len(drives), drives.get(name)))
        names += [f"{name}.{freedom.value}" for freedom in locked]
    batch = np.broadcast_shapes(*(row.shape[:-2] for row in rows))
    constraints = np.concatenate([np.broadcast_to(row, (*batch, *row.shape[-2:])) for row in rows], axis=-2)
    length = _length(assembly)
    scale = np.concatenate([np.tile([1.0, 1.0, 1.0, *[1.0 / length] * 3], len(order.bodies)), np.ones(len(drives))])
    return _Graph(assembly, order, operators, constraints, tuple(names), scale, length)


def _rows(operator: Array, locked: list[Freedom], strokes: int, drive: int | None) -> Array:
    """Constraint rows of one link: locked deformations vanish; an actuator's axial one equals its stroke."""
    rows = operator[..., [freedom.index for freedom in locked], :]
    extra = np.zeros((*rows.shape[:-1], strokes), dtype=rows.dtype)
    if drive is not None:
        extra[..., locked.index(Freedom.X), drive] = -1.0
    return np.concatenate([rows, extra], axis=-1)


def _length(assembly: Assembly) -> float:
    """Length scale of the stage: rms distance of its links from the platform's reference, on the first design."""
    centre = assembly.bodies[PLATFORM].reference
    arms = [np.real(link.frame.position - centre).reshape(-1, 3)[0] for link in assembly.links.values()]
    return float(np.sqrt(np.mean([arm @ arm for arm in arms]))) or 1.0


def _require_paths(graph: _Graph, idle_strokes: Array) -> None:
    """Strokes that can change while the platform stands still drive nothing."""
    moving = np.max(np.abs(idle_strokes), axis=1, initial=0.0) > _NEGLIGIBLE
    require(
        Finding(
            link,
            f"actuator {name} can move while the platform stands still: its stroke has no path to the platform",
            "Join its unit to the platform, or lock the freedom that lets it slip",
        )
        for (name, link), slips in zip(graph.assembly.actuators.items(), moving, strict=True)
        if slips
    )


def _without_idle(graph: _Graph, solution: Elimination, columns: list[int], rest: list[int]) -> Array:
    """Motions per platform coordinate, idle motions set so that the links' deformations are least (rotations times the length scale)."""
    wanted, idle = solution.basis[..., columns], solution.basis[..., rest]
    if not rest:
        return wanted
    size = graph.order.size
    weight = np.array([1.0, 1.0, 1.0, *[graph.length] * 3])[:, None]
    stacked = [weight * operator for operator in graph.operators.values()]
    before = np.concatenate(np.broadcast_arrays(*(item @ wanted[..., :size, :] for item in stacked)), axis=-2)
    spun = np.concatenate(np.broadcast_arrays(*(item @ idle[..., :size, :] for item in stacked)), axis=-2)
    transposed = np.swapaxes(spun, -1, -2)
    return wanted - idle @ np.linalg.solve(transposed @ spun, transposed @ before)


def _sensing(graph: _Graph, bodies: Array) -> Array:
    """Gauge readings per platform twist; gauges on other bodies see the ideal motions only."""
    motion = bodies[..., :6, :]
    rows = [_gauge_row(graph, name, bodies, motion) for name in graph.assembly.gauges]
    if not rows:
        return np.zeros((0, 6))
    return np.concatenate(np.broadcast_arrays(*rows), axis=-2)


def _gauge_row(graph: _Graph, name: str, bodies: Array, motion: Array) -> Array:
    gauge = graph.assembly.gauges[name]
    seen = [twist_at(graph.assembly, graph.order, body, gauge.frame)[..., :1, :] for body in (gauge.body, gauge.base)]
    row = gauge.sign * (seen[0] - seen[1])
    if {gauge.body, gauge.base} <= {PLATFORM, "ground"}:
        return row[..., :6]
    weight = np.array([1.0, 1.0, 1.0, *[graph.length] * 3]) ** 2
    weighted = np.swapaxes(motion, -1, -2) * weight
    return row @ bodies @ np.linalg.solve(weighted @ motion, weighted)


def _idle(graph: _Graph, motions: Array) -> tuple[Idle, ...]:
    scaled = echelon((motions / graph.scale[: graph.order.size, None]).T)
    return tuple(_named_idle(graph, vector * graph.scale[: graph.order.size]) for vector in scaled)


def _named_idle(graph: _Graph, motion: Array) -> Idle:
    threshold = _NEGLIGIBLE * np.max(np.abs(motion))
    bodies = tuple(body for body in graph.order.bodies if np.max(np.abs(motion[graph.order.columns(body)])) > threshold)
    links = tuple(
        name
        for name, operator in graph.operators.items()
        if np.max(np.abs(np.real(operator.reshape(-1, *operator.shape[-2:])[0]) @ motion)) > threshold
    )
    return Idle(bodies, links)


def _redundant(graph: _Graph) -> tuple[Redundant, ...]:
    """Self-stress states of the locked freedoms: left null vectors of the constraints."""
    first = np.real(graph.constraints.reshape(-1, *graph.constraints.shape[-2:])[0]) * graph.scale
    norms = np.linalg.norm(first, axis=1)
    first = first / np.where(norms > 0.0, norms, 1.0)[:, None]
    states = echelon(null_space(first.T).T)
    return tuple(
        Redundant(tuple(name for name, force in zip(graph.names, state, strict=True) if abs(force) > _NEGLIGIBLE)) for state in states
    )
