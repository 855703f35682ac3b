"""What a record tells of a stage's modes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from flexstage.base.labelled import Matrix, ratio_units
from flexstage.base.number import Array
from flexstage.experiment.identification.cluster import Stabilisation
from flexstage.experiment.identification.confidence import NORMAL_95
from flexstage.experiment.identification.peaks import Peak
from flexstage.experiment.identification.residues import modal_sum, remainder_sum
from flexstage.experiment.record import Channel, Responses


@dataclass(frozen=True, eq=False)
class Identified:
    """Modes found in records or responses, by rising frequency, each with its standard deviation.

    `frequencies` (k,) [Hz] are natural frequencies |pole|/(2 pi), `damping` (k,) ratios; `shapes` (p, k) complex, of the outputs, largest
    component 1; `participation` (k, m) complex, of the inputs: H = sum of shape participation / (j w - pole) + conjugate. `deviation` of
    shapes is that of real and of imaginary part. `widening` (k,) is how many times larger deviations are than noise makes them, because the
    fit leaves more than noise near the mode: 1 where it does not. `significance` (k,) is the chi-square by which the data ask for the mode,
    over that which noise would pass once in 1e9. `close` lists modes nearer to one another than their half-widths: compare those by
    subspace. `noise` (p,) is the outputs' noise density, in the outputs' unit squared per Hz. `warnings` say what the data cannot tell;
    `peaks` are seen and are no modes, or not with confidence.
    """

    frequencies: Array
    damping: Array
    shapes: Array
    participation: Array
    frequency_deviations: Array
    damping_deviations: Array
    shape_deviations: Array
    widening: Array
    significance: Array
    outputs: tuple[Channel, ...]
    inputs: tuple[Channel, ...]
    close: tuple[tuple[int, ...], ...]
    residuals: Array
    responses: Responses
    stabilisation: tuple[Stabilisation, ...]
    band: tuple[float, float]
    noise: Array
    warnings: tuple[str, ...]
    provenance: str
    peaks: tuple[Peak, ...] = ()

    @property
    def poles(self) -> Array:
        """Poles (k,) in rad/s, the ones of positive imaginary part."""
        natural = 2.0 * np.pi * self.frequencies
        return natural * (-self.damping + 1j * np.sqrt(1.0 - self.damping**2))

    @property
    def frequency_intervals(self) -> Array:
        """95 % intervals (k, 2) of the frequencies in Hz."""
        return _interval(self.frequencies, self.frequency_deviations)

    @property
    def damping_intervals(self) -> Array:
        """95 % intervals (k, 2) of the damping ratios."""
        return _interval(self.damping, self.damping_deviations)

    @property
    def real_shapes(self) -> Array:
        """Shapes (p, k) turned to be as real as they can be, and their real parts: what modes of an undamped model are compared with."""
        turn = np.exp(-0.5j * np.angle(np.sum(self.shapes**2, axis=0)))
        turned = np.real(self.shapes * turn)
        largest = np.take_along_axis(turned, np.argmax(np.abs(turned), axis=0)[None, :], axis=0) if turned.size else turned[:1]
        return turned / np.where(largest == 0.0, 1.0, largest)

    @property
    def complexity(self) -> Array:
        """How far (k,) each shape is from a real one: 1 - |sum phi^2| / sum |phi|^2, nought for a real mode, 1 for a travelling wave."""
        return 1.0 - np.abs(np.sum(self.shapes**2, axis=0)) / np.sum(np.abs(self.shapes) ** 2, axis=0)

    def response(self, frequencies: Array) -> Responses:
        """The fitted responses at `frequencies` in Hz: modes and the residuals of what lies outside the band."""
        values = modal_sum(frequencies, self.poles, self.shapes, self.participation) + remainder_sum(frequencies, self.residuals)
        return Responses(np.asarray(frequencies), self.outputs, self.inputs, values, name="modes", source=self.provenance)

    def shape_matrix(self) -> Matrix:
        """The real shapes labelled: rows are outputs, columns modes."""
        names = tuple(str(index + 1) for index in range(len(self.frequencies)))
        return Matrix(self.real_shapes, tuple(channel.name for channel in self.outputs), names, "1")

    def to_json(self) -> dict[str, Any]:
        """Modes, deviations, shapes and warnings as plain lists."""
        rows = tuple(channel.unit or "?" for channel in self.outputs)
        unit = ratio_units(rows, tuple(channel.unit or "?" for channel in self.inputs))
        return {
            "frequency_hz": self.frequencies.tolist(),
            "frequency_interval_hz": self.frequency_intervals.tolist(),
            "damping": self.damping.tolist(),
            "damping_interval": self.damping_intervals.tolist(),
            "outputs": [channel.name for channel in self.outputs],
            "inputs": [channel.name for channel in self.inputs],
            "shape_real": np.real(self.shapes).tolist(),
            "shape_imaginary": np.imag(self.shapes).tolist(),
            "shape_deviation": self.shape_deviations.tolist(),
            "participation_real": np.real(self.participation).tolist(),
            "participation_imaginary": np.imag(self.participation).tolist(),
            "response_unit": [list(row) for row in unit],
            "widening": self.widening.tolist(),
            "complexity": self.complexity.tolist(),
            "close": [[index + 1 for index in group] for group in self.close],
            "significance": self.significance.tolist(),
            "band_hz": list(self.band),
            "peaks": [peak.to_json() for peak in self.peaks],
            "warnings": list(self.warnings),
            "provenance": self.provenance,
        }


def _interval(values: Array, deviations: Array) -> Array:
    return np.stack([values - NORMAL_95 * deviations, values + NORMAL_95 * deviations], axis=-1)
