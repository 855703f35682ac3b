"""Bodies of documents about reach and quality: workspace, error budget, sensitivities, requirements, findings."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Any, TypeVar

import numpy as np

from flexstage.analysis.error_budget import ErrorBudget
from flexstage.analysis.requirements import Verdict
from flexstage.analysis.sensitivities import Sensitivities
from flexstage.analysis.workspace.blocking import StackLine
from flexstage.analysis.workspace.buckling import Buckling
from flexstage.analysis.workspace.drive import Drive
from flexstage.analysis.workspace.gauging import GaugeRange
from flexstage.analysis.workspace.load import LoadShare
from flexstage.analysis.workspace.map_error import MapError
from flexstage.analysis.workspace.polytope import Polytope
from flexstage.analysis.workspace.room import Room
from flexstage.analysis.workspace.strength import HingeStress
from flexstage.analysis.workspace.stroke import SingleAxis, StrokeLimits, Utilisation
from flexstage.analysis.workspace.workspace import Workspace
from flexstage.base.document import Document
from flexstage.base.labelled import Matrix
from flexstage.base.number import Array, Number
from flexstage.spatial.frame import COMPONENTS

_Result = TypeVar("_Result")


def workspace_body(workspace: Workspace) -> Document:
    """Strokes, forces, volts, gauges, room, stress, buckling and loads; null with a reason where a reading does not give them.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.ideal import ideal
    >>> from flexstage.analysis.workspace.workspace import workspace
    >>> stage = double_triangle()
    >>> workspace_body(workspace(stage, ideal(stage), None))["single_axis"]["limiting"]["x"]
    'B1'
    """
    limits = workspace.limits
    return {
        "command": motions(workspace.command),
        "strokes": Matrix(np.stack([limits.low, limits.high], axis=-1), limits.actuators, ("low", "high"), "m").to_json(),
        "single_axis": _single(workspace.single),
        "single_axis_corrected": _of(workspace.corrected, _single),
        "corner": _of(workspace.corner, _corner),
        "polytope": _of(workspace.polytope, _polytope),
        "drive": _of(workspace.drive, _drive),
        "map_error": _of(workspace.map_error, _map_error),
        "gauge_range": _of(workspace.gauges, _gauges),
        "pose_resolution": _of(workspace.resolution, lambda found: found.table.to_json()),
        "room": _of(workspace.room, _room),
        "platform_lines": _of(workspace.platform_lines, lambda found: found.table.to_json()),
        "stack_lines": _of(workspace.stack_lines, _stack_lines),
        "stress": _of(workspace.stress, _stress),
        "buckling": _of(workspace.buckling, buckling_body),
        "loads": _of(workspace.loads, lambda found: _loads(found, limits.from_zero)),
        **({"reasons": dict(workspace.missing)} if workspace.missing else {}),
    }


def _of(result: _Result | None, body: Callable[[_Result], Document]) -> Document | None:
    return None if result is None else body(result)


def motions(values: Mapping[str, Number]) -> Document:
    """Values by coordinate with the unit in the key.

    >>> motions({"x": 5e-05, "rz": 1e-4})
    {'x_m': 5e-05, 'rz_rad': 0.0001}
    """
    return {f"{name}_{'rad' if name.startswith('r') else 'm'}": value for name, value in values.items()}


def _single(single: SingleAxis) -> Document:
    return {"table": single.table.to_json(), "limiting": dict(zip(single.coordinates, single.limiting, strict=True)), "at": single.at}


def _corner(corner: Utilisation) -> Document:
    values = zip(corner.actuators, corner.demand, corner.available, corner.ratio, strict=True)
    return {
        "actuators": {name: {"demand_m": demand, "available_m": room, "ratio": ratio} for name, demand, room, ratio in values},
        "reachable": bool(corner.reachable),
        "scale": corner.scale,
    }


def _polytope(polytope: Polytope) -> Document:
    known = polytope.vertices[~np.isnan(polytope.vertices).any(axis=-1)]
    return {
        "extent": polytope.extent.to_json(),
        "volume": polytope.volume,
        "volume_unit": polytope.volume_unit,
        "coordinates": list(polytope.coordinates),
        "vertices": known,
    }


def _drive(drive: Drive) -> Document:
    columns = {
        "gain_m_per_v": drive.gain,
        "low_v": drive.low,
        "high_v": drive.high,
        "bias_v": drive.bias,
        "capacitance_f": drive.capacitance,
    }
    return {name: {key: values[index] for key, values in columns.items()} for index, name in enumerate(drive.actuators)}


def _map_error(error: MapError) -> Document:
    worst = {str(name): value for name, value in zip(COMPONENTS, error.worst, strict=True)}
    return {"worst": motions(worst), "table": error.table.to_json(), "residual_m": error.residual, "points": len(error.strokes)}


def _gauges(gauges: GaugeRange) -> Document:
    fits = {name: bool(fits) for name, fits in zip(gauges.gauges, gauges.fits, strict=True)}
    return {"command": motions(gauges.command), "fits": fits, "table": gauges.table.to_json()}


def _room(room: Room) -> Document:
    return {
        "size_m": room.size,
        "table": room.table.to_json(),
        "intrusions": {item.name: {"depth_m": item.depth} for item in room.intrusions},
        "findings": list(room.findings),
    }


def _stack_lines(lines: StackLine) -> Document:
    columns = {
        "free_m": lines.free,
        "blocking_n": lines.blocking,
        "stiffness_n_per_m": lines.stiffness,
        "against_n_per_m": lines.against,
        "travel_m": lines.travel,
        "force_n": lines.force,
    }
    return {name: {key: values[index] for key, values in columns.items()} for index, name in enumerate(lines.actuators)}


def _stress(stress: HingeStress) -> Document:
    strokes = Matrix(stress.strokes, stress.links, stress.actuators, "m")
    return {
        "least_safety": stress.least if stress.links else None,
        "weakest": stress.weakest if stress.links else None,
        "table": stress.table.to_json(),
        "strokes": strokes.to_json(),
        "unknown": list(stress.unknown),
        "unchecked": list(stress.unchecked),
    }


def buckling_body(buckling: Buckling) -> Document:
    """Load factors of the whole stage, and Euler's of each part."""
    ends = {name: item.value for name, item in zip(buckling.links, buckling.ends, strict=True)}
    weakest = buckling.weakest if buckling.links else None
    stage = {"dead_load": buckling.stage.dead, "worst_strokes": buckling.stage.worst, "moving": buckling.stage.moving}
    return {"least_factor": buckling.least, "stage": stage, "weakest": weakest, "ends": ends, "table": buckling.table.to_json()}


def _loads(loads: LoadShare, limits: StrokeLimits) -> Document:
    least, largest = loads.range(limits)
    columns = {
        "compression_n": loads.compression,
        "least_compression_n": least,
        "largest_compression_n": largest,
        "maximum_load_n": loads.maximum,
        "preload_n": loads.preload,
        "tensile_limit_n": loads.tensile,
        "usage": loads.usage(largest),
        "pull": loads.pull(least),
    }
    actuators = {name: {key: values[index] for key, values in columns.items()} for index, name in enumerate(loads.actuators)}
    return {"actuators": actuators, "loads": loads.loads.to_json(), "share": loads.share.to_json(), "stroke": loads.stroke.to_json()}


def budget_body(budget: ErrorBudget) -> Document:
    """The error budget by axis and source, by the ideal mapping and with the lost-motion gains, and its sums.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.analysis.budget import budget
    >>> budget_body(budget(double_triangle(), {"x": 5e-5}))["missing"]
    ['gauge noise']
    """
    return {
        "command": motions(budget.command),
        "temperature_k": budget.temperature,
        "coverage": budget.coverage,
        "ideal": budget.ideal.to_json(),
        "corrected": budget.corrected.to_json(),
        "sums": budget.sums.to_json(),
        "missing": list(budget.missing),
        "provenance": budget.provenance,
    }


def sensitivities_body(found: Sensitivities) -> Document:
    """Derivatives of frequencies, gains and losses with respect to every parameter (SI), and relative ones.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.analysis.sensitivities import sensitivities
    >>> body = sensitivities_body(sensitivities(double_triangle(), ("parts.neck.thickness",), modes=2))
    >>> body["parameters"][0]["address"], body["frequency"]["unit"]
    ('parts.neck.thickness', [['Hz/m', 'Hz/m']])
    """
    columns = tuple(f"mode {number + 1}" for number in range(len(found.frequencies)))
    hertz, plain = (
        [[f"{top}/{unit}" if unit != "1" else top for _ in range(count)] for unit in found.units]
        for top, count in (("Hz", len(columns)), ("1", len(found.actuators)))
    )
    return {
        "parameters": [_parameter(*each) for each in zip(found.parameters, found.values, found.units, strict=True)],
        "frequencies_hz": found.frequencies,
        "clusters": [list(group) for group in found.clusters],
        "frequency": _matrix(found.frequency, (found.parameters, columns), hertz),
        "relative_frequency": found.relative_frequency.to_json(),
        "gain": _matrix(found.gain, (found.parameters, found.actuators), plain),
        "loss": _matrix(found.loss, (found.parameters, found.actuators), plain),
        "relative_loss": found.relative_loss.to_json(),
        "one_sided": list(found.one_sided),
        "missing": dict(found.missing),
        "provenance": found.provenance,
    }


def _parameter(address: str, value: float, unit: str) -> Document:
    return {"address": address, "value": value, "unit": unit}


def _matrix(values: Array, names: tuple[tuple[str, ...], tuple[str, ...]], units: list[list[str]]) -> Document:
    return Matrix(values, *names, tuple(tuple(row) for row in units)).to_json()


def requirements_body(verdicts: Iterable[Verdict]) -> list[Document]:
    """Verdicts on the design's requirements: limit and value in SI, relative margin, whether it is met.

    >>> requirements_body([])
    []
    """
    return [_verdict(verdict) for verdict in verdicts]


def _verdict(verdict: Verdict) -> Document:
    asked = verdict.requirement
    result: dict[str, Any] = {
        "key": asked.key,
        "text": asked.text,
        "passed": bool(verdict.passed),
        "value": verdict.value,
        "limit": asked.limit,
        "unit": asked.quantity.si,
        "sense": asked.sense.value,
        "point": asked.point,
        "margin": None if verdict.value is None else verdict.margin,
    }
    return {**result, **({"reason": verdict.reason} if verdict.reason else {})}
