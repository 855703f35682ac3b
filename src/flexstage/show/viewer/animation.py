"""Animations of a stage at large displacements: a load path, and modes and buckling modes about a state."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, TypeAlias

import numpy as np

from flexstage.analysis.dynamics.modes import Modes
from flexstage.analysis.loaded.load_cases import REST, CaseFactor
from flexstage.analysis.loaded.misalign import Misaligned
from flexstage.analysis.loaded.operating_point import OperatingPoint
from flexstage.analysis.loaded.stroke import PostBuckling, Stroke
from flexstage.base.arguments import check_arguments
from flexstage.base.labelled import Matrix
from flexstage.base.number import Array
from flexstage.mechanism.mechanism import GROUND, Mechanism
from flexstage.models.nonlinear.equilibrium import State
from flexstage.models.nonlinear.lines import Line, Motions, centre_lines, critical_motion, mode_motions
from flexstage.models.nonlinear.paths.critical_load import Critical
from flexstage.models.nonlinear.paths.load_path import LoadPath
from flexstage.show.display import DisplayUnit, display_unit_of, format_value, to_typography
from flexstage.show.viewer.bend import interpolate
from flexstage.show.viewer.data import StageData, still_data
from flexstage.show.viewer.motions import Curve, Group, Motion, PathMotion
from flexstage.spatial.rotation import exponential, logarithm

NODES = 12
"""Points along a link at which its position is computed."""
_BYTES = 400_000
"""Size limit for the poses of a path in a page [bytes]."""
_MODES, _LOWEST = 6, 12
_MILLIMETRES = DisplayUnit("mm", 1e3)
_OWN = {"strain": DisplayUnit("um/m", 1e6), "lost": DisplayUnit("%", 100.0)}


_Label: TypeAlias = tuple[str, str, str, float | None]
"""Name of a small motion, its label in a list, its remark, its frequency [Hz] if it has one."""


def stroke_data(mechanism: Mechanism, path: LoadPath, found: Stroke) -> StageData:
    """Return viewer data of a stage along a load path: one motion through its points, and the first modes at its last stable point.

    Flexures follow their centre lines; parts that are known only by a 6x6 matrix are interpolated linearly between their ends. Points
    without an equilibrium are skipped.
    """
    still = still_data(mechanism)
    motions = [_along(still, path.state, path.drive, found), *_modes_there(still, path)]
    return replace(still, motions=tuple(motions), notes=tuple(str(each) for each in found.warnings))


def misalign_data(mechanism: Mechanism, found: Misaligned) -> StageData:
    """Return viewer data of a stage with one misaligned instance: one motion, from zero to the largest misalignment."""
    still = still_data(mechanism)
    motion = _along(still, found.state, f"{found.copy} {found.axis}", found)
    return replace(still, motions=(motion,), notes=tuple(str(each) for each in found.warnings))


def buckling_data(mechanism: Mechanism, cases: Sequence[CaseFactor], after: PostBuckling | None = None) -> StageData:
    """Return viewer data of buckling: the buckling mode of each load case about the last stable state, and the path `after` buckling."""
    still = still_data(mechanism)
    motions = [
        motion
        for number, case in enumerate(cases)
        if case.found is not None
        for motion in _buckling_motions(still, case, case.found, number)
    ]
    paths = [] if after is None else [_along(still, after.path.state, after.path.drive, after.stroke)]
    return replace(still, motions=(*motions, *paths))


def _buckling_motions(still: StageData, case: CaseFactor, found: Critical, number: int) -> Iterator[Motion]:
    place = "" if case.place == REST else f"  {case.place}"
    label = to_typography(f"{case.kind}  × {format_value(case.factor, '1', 4)}{place}")
    name = "buckling" if number == 0 else f"buckling {number + 1}"
    yield from _about(still, found.state, critical_motion(found), [(name, label, to_typography(f"{case.load}, {case.place}"), None)])


def modes_at_data(mechanism: Mechanism, there: OperatingPoint, found: Modes, said: str) -> StageData:
    """Return viewer data of a stage with its lowest modes about an operating point, which the text `said` describes."""
    still = still_data(mechanism)
    moved = mode_motions(there.state, found.shapes[:, :_LOWEST], there.locked)
    return replace(still, motions=tuple(_about(still, there.state, moved, _labels(found.frequencies[:_LOWEST], said))))


def _along(still: StageData, state: State, drive: str, found: Stroke | Misaligned) -> Motion:
    known = np.flatnonzero(state.converged)
    poses = _poses(still, state)
    most = max(2, _BYTES // (24 * poses.shape[1]))
    frames = known[np.unique(np.linspace(0, len(known) - 1, min(most, len(known))).round().astype(int))]
    curves = curves_of(found.along)
    numbers = {thing.name: number for number, thing in enumerate(still.things)}
    over = ([numbers[name] for name, *_ in _over(found, point) if name in numbers] for point in range(len(found.along.values)))
    course = PathMotion(frames, poses[frames], None, curves, tuple(tuple(sorted(each)) for each in over), limits(found))
    return Motion(Group.PATH, drive, f"{drive}  {curves[0].span}", np.zeros((0, 6)), course=course)


def curves_of(along: Matrix) -> tuple[Curve, ...]:
    """Convert quantities along a path (rows: points, columns: quantities) to curves in display units.

    The first curve is the quantity that is varied.
    """
    return tuple(
        Curve(name, to_typography(form.text), values * form.factor) for name, values, form in quantities_of(along) if name != "unstable"
    )


def quantities_of(along: Matrix) -> Iterator[tuple[str, Array, DisplayUnit]]:
    """Yield the quantities along a path: name, SI values at every point, and display unit."""
    units = (along.unit,) * len(along.columns) if isinstance(along.unit, str) else along.unit[0]
    for name, values, unit in zip(along.columns, np.moveaxis(along.values, -1, 0), units, strict=True):
        largest = float(np.max(np.abs(values[np.isfinite(values)]), initial=0.0))
        far = unit == "m" and largest >= 1e-3
        yield name, values, _MILLIMETRES if far else _OWN.get(name) or display_unit_of(unit, largest)


def limits(found: Stroke | Misaligned) -> tuple[str, ...]:
    """Describe the exceeded limits at each point. The text of a point is empty if no limit is exceeded there."""
    return tuple(to_typography("; ".join(_words(found, point))) for point in range(len(found.along.values)))


def _over(found: Stroke | Misaligned, point: int) -> list[tuple[str, Any, Any]]:
    """The flexures with a stress above their material's limit, their stress and this limit."""
    strained = found.strained
    return [each for each in zip(strained.names, strained.stress[point], strained.limit, strict=True) if each[1] > each[2]]


def _words(found: Stroke | Misaligned, point: int) -> Iterator[str]:
    for name, *values in _over(found, point):
        stress, limit = (format_value(float(each), "Pa", 4) for each in values)
        yield f"{name}: stress {stress}, limit {limit}"
    loose = found.along.values[point, found.along.columns.index("unstable")]
    if np.isnan(loose):
        yield "no equilibrium found"
    elif loose > 0:
        yield "the free stage is unstable"


def _modes_there(still: StageData, path: LoadPath) -> Iterator[Motion]:
    """The first modes at the last point that is stable without the prescribed coordinates."""
    from flexstage.models.linear.eigen import eigen
    from flexstage.models.nonlinear.linearise import linearise

    stable = np.flatnonzero(path.state.converged & (path.motions == 0))
    if not len(stable):
        return
    last = path.state.case(int(stable[-1]))
    found = eigen(linearise(last))
    kept = np.flatnonzero(np.nan_to_num(found.values) > 0.0)[:_MODES]
    frequencies = np.sqrt(found.values[kept]) / (2.0 * np.pi)
    moved = mode_motions(last, found.shapes[:, kept])
    yield from _about(still, last, moved, _labels(frequencies, _point_text(path, int(stable[-1]))))


def _point_text(path: LoadPath, point: int) -> str:
    """A point of a path as text."""
    channel = next((each.unit for each in path.state.model.inputs if each.name == path.drive), None)
    unit = channel or ("rad" if path.drive.rpartition(".")[2].startswith("r") else "m")
    return to_typography(f"at {path.drive} = {format_value(float(path.values[point]), unit, 4)}")


def _labels(frequencies: Array, said: str) -> list[_Label]:
    return [
        (str(number + 1), to_typography(f"{number + 1}  {format_value(float(each), 'Hz', 4)}"), said, float(each))
        for number, each in enumerate(frequencies)
    ]


def _about(still: StageData, state: State, moved: Motions, labels: Sequence[_Label]) -> Iterator[Motion]:
    """Small motions about a state, with their names, labels, remarks and frequencies."""
    poses = _poses(still, state)[:1]
    lines = {name: Line(line.shares, line.place[:1], line.turn[:1]) for name, line in centre_lines(state).items()}
    order = [still.bodies.index(name) for name in state.model.bodies]
    for number, (name, label, remark, frequency) in enumerate(labels):
        bodies = np.zeros((len(still.bodies), 6))
        bodies[order] = moved.bodies[number]
        inside = {each: rows[number] for each, rows in moved.lines.items()}
        shape = np.concatenate([bodies, *(_carried(still, carrier, bodies, lines, inside) for carrier in _bending(still))])
        course = PathMotion(frames=np.zeros(1, dtype=int), poses=poses, shape=shape, curves=(), beyond=((),), said=("",))
        yield Motion(Group.STATE, name, label, np.zeros((0, 6)), remark, frequency, course=course)


@dataclass(frozen=True, eq=False)
class _Carrier:
    """A piece between two bodies: its part, its bodies, and its drawn ends (2, 3)."""

    name: str
    bodies: tuple[int, int]
    ends: Array


def _bending(still: StageData) -> list[_Carrier]:
    """The pieces of the mesh that bend, in its order."""
    mesh = still.mesh
    first = {int(carrier): int(part) for carrier, part in zip(mesh.carrier[::-1], mesh.part[::-1], strict=True)}
    return [
        _Carrier(still.things[first[number]].name, (int(one), int(other)), mesh.ends[number])
        for number, (one, other) in enumerate(mesh.bodies)
        if one != other
    ]


def _poses(still: StageData, state: State) -> Array:
    """Displacements and rotation vectors (b, rows, 6) of all bodies, the ground first, and of the nodes of bending pieces."""
    count = len(state.pose.position)
    position, turn = np.zeros((count, len(still.bodies), 3)), np.broadcast_to(np.eye(3), (count, len(still.bodies), 3, 3)).copy()
    model = state.model
    for name in model.bodies:
        if name not in still.bodies:  # a seat is not drawn
            continue
        place, number = still.bodies.index(name), model.body(name)
        position[:, place] = state.pose.position[:, number] - model.reference[number]
        turn[:, place] = state.pose.turn[:, number]
    references = _references(still)
    lines = centre_lines(state)
    rows = [np.concatenate([position, logarithm(turn)], axis=-1)]

    def at(body: int, point: Array) -> Array:
        return references[body] + position[:, body] + turn[:, body] @ (point - references[body])

    rows += [_piece(carrier, lines.get(carrier.name), at, turn) for carrier in _bending(still)]
    return np.nan_to_num(np.concatenate(rows, axis=1))


def _references(still: StageData) -> Array:
    return np.stack([np.zeros(3) if name == GROUND else still.bones.references[name] for name in still.bodies])


def _piece(carrier: _Carrier, line: Line | None, at: Callable[[int, Array], Array], turn: Array) -> Array:
    """Displacements and rotation vectors (b, NODES, 6) along a piece: of a flexure its centre line, else interpolated between its ends."""
    shares = np.linspace(0.0, 1.0, NODES)
    drawn = carrier.ends[0] + shares[:, None] * (carrier.ends[1] - carrier.ends[0])
    if line is not None:
        place, vectors = _resampled(line, shares)
    else:
        first, second = (at(body, end) for body, end in zip(carrier.bodies, carrier.ends, strict=True))
        place = first[:, None] + shares[:, None] * (second - first)[:, None]
        one, other = (turn[:, body] for body in carrier.bodies)
        half = logarithm(one.mT @ other)
        vectors = logarithm(one[:, None] @ exponential(shares[:, None] * half[:, None]))
    return np.concatenate([place - drawn, vectors], axis=-1)


def _resampled(line: Line, shares: Array) -> tuple[Array, Array]:
    """Positions and rotation vectors (b, NODES, 3) of a centre line; its slope is that of the sections."""
    place, vectors = (np.stack([interpolate(shares, line.shares, case) for case in each]) for each in (line.place, logarithm(line.turn)))
    return place, vectors


def _carried(still: StageData, carrier: _Carrier, bodies: Array, lines: Mapping[str, Line], moved: Mapping[str, Array]) -> Array:
    """Small motions (NODES, 6) along a piece, from those of bodies and, `moved`, of centre `lines`."""
    shares = np.linspace(0.0, 1.0, NODES)
    known = moved.get(carrier.name)
    if known is not None:
        return interpolate(shares, lines[carrier.name].shares, known)
    references = _references(still)
    ends = [
        np.concatenate([bodies[body, :3] + np.cross(bodies[body, 3:], end - references[body]), bodies[body, 3:]])
        for body, end in zip(carrier.bodies, carrier.ends, strict=True)
    ]
    return ends[0] + shares[:, None] * (ends[1] - ends[0])


@check_arguments
def animate(mechanism: Mechanism, path: LoadPath) -> Any:
    """Animate a stage along a load path at large displacements. Notebooks show the view; its method `save` writes a page.

    Curves of force, stiffness, parasitic motion and frequencies are below the stage, with a cursor. Values that exceed a limit are red.
    Small motions are magnified by the displayed factor.

    >>> import flexstage as fs
    >>> stage = fs.case("parallelogram")
    >>> fs.animate(stage, fs.load_path(fs.nonlinear(stage), "platform.x", [0.0, 1e-4])).html[:15]
    '<!doctype html>'
    """
    from flexstage.analysis.loaded.stroke import stroke
    from flexstage.show.viewer.view import view_of

    data = stroke_data(mechanism, path, stroke(path))
    return view_of(mechanism, data, f"path {path.drive}")
