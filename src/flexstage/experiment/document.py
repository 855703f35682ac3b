"""Bodies of documents of tests: modes identified, theory beside them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from flexstage.base.document import Document
from flexstage.experiment.record import Channel, Record, Responses
from flexstage.spatial.frame import COMPONENTS

if TYPE_CHECKING:
    from flexstage.experiment.comparison import Compared, ComparedMode, Measured
    from flexstage.experiment.identification.identified import Identified
    from flexstage.experiment.pipeline import Identification
    from flexstage.experiment.shapes_on_stage import StageShapes


def identify_body(seen: Identification, shapes: StageShapes | None = None) -> Document:
    """What was measured, the modes with intervals and shapes, how they were found; with `shapes`, the platform's motion in each.

    >>> from flexstage.experiment.example import one_mode_record
    >>> from flexstage.experiment.pipeline import identification
    >>> identify_body(identification((one_mode_record(),)))["test"][0]["rate_hz"]
    64.0
    """
    found = seen.found
    result: Document = {
        "test": recorded_body(seen.test),
        "modes": [mode_body(found, index) for index in range(len(found.frequencies))],
        "close": [[index + 1 for index in group] for group in found.close],
        "peaks": [peak.to_json() for peak in found.peaks],
        "shapes": found.shape_matrix().to_json(),
        "band_hz": list(found.band),
        "spectra": _spectra(seen),
        "warnings": list(found.warnings),
        "provenance": found.provenance,
    }
    if shapes is not None:
        result["platform"] = _platform(shapes)
    return result


def recorded_body(test: Sequence[Record] | Responses) -> list[Document]:
    """Files with their channels.

    >>> from flexstage.experiment.example import one_mode_record
    >>> recorded_body((one_mode_record(),))[0]["seconds"]
    64.0
    """
    if isinstance(test, Responses):
        lines = {"lines": len(test.frequencies), "low_hz": float(test.frequencies[0]), "high_hz": float(test.frequencies[-1])}
        return [{"kind": "responses", "source": test.source, **_sides(test.inputs, test.outputs), **lines}]
    return [
        {
            "kind": "record",
            "source": each.source,
            **_sides(each.inputs, each.outputs),
            "rate_hz": each.rate,
            "seconds": each.duration,
            "samples": each.length,
        }
        for each in test
    ]


def _sides(inputs: Sequence[Channel], outputs: Sequence[Channel]) -> Document:
    return {
        side: [{"name": channel.name, "unit": channel.unit} for channel in channels]
        for side, channels in (("inputs", inputs), ("outputs", outputs))
    }


def mode_body(found: Identified, index: int) -> Document:
    """One mode: frequency and damping with 95 % intervals, complex shape and participation.

    >>> from flexstage.experiment.example import one_mode_record
    >>> from flexstage.experiment.identification.identify import identify
    >>> mode_body(identify(one_mode_record()), 0)["number"]
    1
    """
    return {
        "number": index + 1,
        "frequency_hz": float(found.frequencies[index]),
        "frequency_interval_hz": found.frequency_intervals[index],
        "damping": float(found.damping[index]),
        "damping_interval": found.damping_intervals[index],
        "widening": float(found.widening[index]),
        "shape": _complex(found.outputs, found.shapes[:, index]),
        "participation": _complex(found.inputs, found.participation[index]),
        "complexity": float(found.complexity[index]),
        "significance": float(found.significance[index]),
    }


def _complex(channels: Sequence[Channel], values: np.ndarray) -> Document:
    return {channel.name: [float(value.real), float(value.imag)] for channel, value in zip(channels, values, strict=True)}


def _spectra(seen: Identification) -> Document | None:
    known = seen.spectra
    if known is None:
        return None
    low, high = seen.found.band
    inside = (known.frequencies >= low) & (known.frequencies <= high)
    return {
        "window": known.segments.window.value,
        "overlap": known.segments.overlap,
        "resolution_hz": float(known.frequencies[1]),
        "averages": known.averages,
        "independent_averages": known.independent,
        "mean_multiple_coherence": None
        if seen.multiple is None
        else {channel.name: float(np.mean(seen.multiple[inside, row])) for row, channel in enumerate(known.outputs)},
    }


def _platform(shapes: StageShapes) -> Document:
    twist = shapes.twists.get("platform")
    return {
        "used": list(shapes.used),
        "explained": shapes.explained,
        "twists": None if twist is None else [dict(zip(COMPONENTS, column.tolist(), strict=True)) for column in twist.T],
        "missing": shapes.missing or None,
    }


def compare_body(found: Compared) -> Document:
    """Theory, FEA and experiment mode by mode, subspaces of repeated modes, further measured modes."""
    return {
        "modes": [compared_mode_body(row) for row in found.rows],
        "repeated": [{"modes": list(group.numbers), "seen": group.seen, "largest_angle_rad": group.angle} for group in found.repeated],
        "further": [
            {"experiment": _measured(mode.experiment), "name": mode.name, "theory_hz": mode.theory, "modal_assurance": mode.assurance}
            for mode in found.further
        ],
        "sensors": list(found.sensors),
        "fea_order": None if found.fea is None else found.fea.order,
        "warnings": list(found.warnings),
        "provenance": found.provenance,
    }


def compared_mode_body(row: ComparedMode) -> Document:
    """One mode by theory, by FEA and in the experiment.

    >>> from flexstage.experiment.comparison import ComparedMode
    >>> compared_mode_body(ComparedMode(1, "z", 100.0))["theory_hz"]
    100.0
    """
    return {
        "number": row.number,
        "name": row.name,
        "theory_hz": row.theory,
        "fea_hz": row.fea,
        "fea_error": row.fea_error,
        "experiment": None if row.experiment is None else _measured(row.experiment),
        "theory_over_experiment": row.difference,
        "fea_over_experiment": row.fea_difference,
        "modal_assurance": row.assurance,
        "fea_modal_assurance": row.fea_assurance,
    }


def _measured(seen: Measured) -> Document:
    return {
        "number": seen.number + 1,
        "frequency_hz": seen.frequency,
        "frequency_interval_hz": list(seen.interval),
        "damping": seen.damping,
        "damping_interval": list(seen.damping_interval),
        "widening": seen.widening,
    }
