"""Body of the document of a loop."""

from __future__ import annotations

import dataclasses
from enum import Enum
from typing import Any

import numpy as np

from flexstage.base.document import Document
from flexstage.control.error_tables import settled_rms
from flexstage.control.simulation.result import others
from flexstage.control.stability_margins import ChannelMargins, Edge
from flexstage.control.study.rest import RestErrors
from flexstage.control.study.runs import Run
from flexstage.control.study.study import LoopStudy


def loop_body(found: LoopStudy) -> Document:
    """Set-up, plant, controller, stability, margins, simulations."""
    return {
        "setup": _plain(found.setup),
        "plant": _plant(found),
        "controller": _controller(found),
        "stability": _stability(found),
        "margins": None if found.margins is None else {each.channel: _margins(each) for each in found.margins.channels},
        "peaks": _peaks(found),
        "bandwidths": _bandwidths(found),
        "crosstalk": found.crosstalk.to_json(),
        "disk_margin": None if found.disk is None else {**dataclasses.asdict(found.disk), "loops": list(found.disk.loops)},
        "static_errors": _rest(found.rest),
        "noise": _noise(found),
        "hysteresis": _hysteresis(found),
        "runs": [run_body(each) for each in found.runs],
        "reasons": dict(found.missing),
    }


def _plain(value: Any) -> Any:
    """A set-up in plain values, SI."""
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        told = getattr(value, "TOLD_BY", None)
        kind = {told[0]: told[1]} if told is not None else {}
        return kind | {field.name: _plain(getattr(value, field.name)) for field in dataclasses.fields(value)}
    if isinstance(value, Enum):
        return value.value
    return [_plain(each) for each in value] if isinstance(value, tuple) else value


def _plant(found: LoopStudy) -> Document:
    plant = found.settled.plant
    return {
        "coordinates": list(plant.coordinates.names),
        "actuators": list(plant.actuators),
        "gauges": list(plant.gauges),
        "rate_hz": found.settled.rate,
        "delay_s": plant.hardware.delay,
        "modes_hz": plant.frequencies,
        "modes_left_out": plant.left_out,
        "highest_platform_mode_hz": found.settled.highest,
        "note": plant.note,
    }


def _controller(found: LoopStudy) -> Document:
    control = found.control
    notches = control.notches or ((),) * len(control.laws)
    system = control.system
    return {
        "loops": {
            name: {**dataclasses.asdict(law), "notches": [dataclasses.asdict(each) for each in group]}  # type: ignore[call-overload]
            for name, law, group in zip(control.loop_names, control.laws, notches, strict=True)
        },
        "tuned": None if control.tuning is None else control.tuning.reason,
        "bandwidth_hz": None if control.tuning is None else control.tuning.bandwidth,
        "gains": [[float(value) for value in row] for row in control.gains],
        "state_space": {
            "A": system.A,
            "B": system.B,
            "C": system.C,
            "D": system.D,
            "inputs": list(system.input_names),
            "outputs": list(system.output_names),
            "step_s": system.step,
        },
    }


def _stability(found: LoopStudy) -> Document:
    least = found.verdict.least
    return {
        "stable": found.verdict.stable,
        "least": dataclasses.asdict(least),
        "growth_all_modes": found.growth,
        "gain_low": found.verdict.gain_low,
        "gain_high": found.verdict.gain_high,
        "sentence": found.verdict.sentence,
    }


def _margins(each: ChannelMargins) -> Document:
    return {
        "gain_low": _edge(each.gain_low),
        "gain_high": _edge(each.gain_high),
        "phase_rad": _edge(each.phase),
        "delay_s": _edge(each.delay),
        "disk": _edge(each.disk),
    }


def _edge(edge: Edge) -> Document:
    return {"value": edge.value, "frequency_hz": edge.frequency}


def _peaks(found: LoopStudy) -> Document | None:
    if found.peaks is None:
        return None
    pair = {"sensitivity": found.peaks.sensitivity, "complementary": found.peaks.complementary}
    return {name: {"value": each.value, "frequency_hz": each.frequency} for name, each in pair.items()}


def _bandwidths(found: LoopStudy) -> Document | None:
    seen = found.bandwidths
    if seen is None:
        return None
    return {
        name: {"tracking_hz": float(seen.tracking[index]), "rejection_hz": float(seen.rejection[index])}
        for index, name in enumerate(seen.coordinates)
    }


def _rest(found: RestErrors) -> Document:
    kinds = {"ideal_map": found.bare, "lost_motion_gains": found.corrected, f"{found.other_model.value}_gains": found.other}
    return {
        **{
            name: None if each is None else {"error": each.error.to_json(), "parasitic": each.parasitic.to_json(), "largest": each.largest}
            for name, each in kinds.items()
        },
        "load": found.load,
        "load_left": found.carried,
        "load_strokes_m": found.strokes,
    }


def _noise(found: LoopStudy) -> Document:
    resting = found.resting
    return {
        **found.noise.to_json(),
        "simulated_rms": None if found.still is None and resting is None else settled_rms(found),
        "simulated_interval": None if resting is None else [resting.low, resting.high],
    }


def _hysteresis(found: LoopStudy) -> Document | None:
    if found.stacks is None or found.sweep is None:
        return None
    sweep = found.sweep
    return {
        name: {
            "width": float(found.stacks.width[index]),
            "range_m": float(np.ptp(sweep.wanted[:, index])),
            "rms_error": float(sweep.error(sweep.bare)[index]),
            "rms_error_inverse": float(sweep.error(sweep.inverse)[index]),
        }
        for index, name in enumerate(sweep.actuators)
    }


def run_body(test: Run) -> Document:
    """One simulation: its figures; its series stay out of the document."""
    seen = test.simulated
    result: Document = {
        "course": test.course.name,
        "moved": list(test.course.moved),
        "seconds": float(seen.times[-1] + (seen.times[1] - seen.times[0])),
        "tracking": test.tracking.to_json(),
        "saturated": dict(zip(seen.actuators, seen.saturated.tolist(), strict=True)),
        "slewing": dict(zip(seen.actuators, seen.slewed.tolist(), strict=True)),
        "out_of_range": dict(zip(seen.gauges, seen.held.tolist(), strict=True)),
        "step": None,
    }
    figures = test.figures
    if figures is not None:
        index = test.index
        result["step"] = {
            "size": float(seen.reference[-1, index]),
            "unit": seen.coordinates[index].unit,
            "settling_s": float(figures.settling[index]),
            "overshoot": float(figures.overshoot[index]),
            "residual": float(figures.residual[index]),
            "others": {
                name: {"largest": value, "unit": unit} for name, (value, unit) in others(seen, seen.coordinates[index].name).items()
            },
            "largest": np.max(np.abs(seen.true_error), axis=0),
        }
    return result
