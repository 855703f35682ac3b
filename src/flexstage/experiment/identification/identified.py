"""Result of a modal identification."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar, TypeAlias

import numpy as np

from flexstage.base.labelled import Matrix
from flexstage.base.notebook import InNotebook
from flexstage.base.number import Array
from flexstage.base.record import INNER, VIEW, Graded, Heading, Layout
from flexstage.base.units.quantity import FREQUENCY, RATIO, TIME
from flexstage.experiment.identification.cluster import Stabilisation
from flexstage.experiment.identification.confidence import NORMAL_95
from flexstage.experiment.identification.diagnosis.peaks import Peak
from flexstage.experiment.identification.residues import modal_sum, remainder_sum
from flexstage.experiment.records.record import Channel, Responses, names_of

FrequencyInterval: TypeAlias = Annotated[tuple[float, float], FREQUENCY, Heading("95 % interval")]
DampingRatio: TypeAlias = Annotated[float, RATIO, Heading("damping ratio", digits=4, unit="%")]
DampingInterval: TypeAlias = Annotated[tuple[float, float], RATIO, Heading("95 % interval", unit="%")]
Widening: TypeAlias = Annotated[float, Heading("interval inflation", digits=2, mark=Graded(1.0))]
INFLATION = (
    "Interval inflation: width of the intervals divided by their width due to noise alone; above 1 if the residual near the mode exceeds "
    "noise or may contain a further mode."
)


@dataclass(frozen=True)
class IdentifiedMode:
    """Identified mode: number (from 1), 95 % intervals, complex `shape` for each output and complex `participation` for each input.

    See `Identified` for `widening`, `complexity` and `significance`.
    """

    TABLE: ClassVar[Layout] = Layout(
        "Modes found",
        "number frequency frequency_interval damping damping_interval widening complexity significance",
        notes=(
            INFLATION,
            "Complexity: 0 if all outputs move in phase or in opposite phase, 1 for a travelling wave.",
            "Test statistic: chi-squared of the mode, divided by the value that noise exceeds once in 1e9 cases.",
        ),
    )

    number: Annotated[int, Heading("mode")]
    frequency: Annotated[float, FREQUENCY, Heading(digits=7)]
    frequency_interval: FrequencyInterval
    damping: DampingRatio
    damping_interval: DampingInterval
    widening: Widening
    shape: Mapping[str, complex]
    participation: Mapping[str, complex]
    complexity: Annotated[float, Heading(digits=2, mark=Graded(0.1))]
    significance: Annotated[float, Heading("test statistic", digits=3, mark=Graded(3.0, 0.0))]


@dataclass(frozen=True, eq=False)
class Identified(InNotebook):
    """Modes identified from records or responses, by ascending frequency, each with its standard deviation.

    `frequencies` (k,) [Hz] are natural frequencies |pole|/(2 pi), and `damping` (k,) are damping ratios. `shapes` (p, k) are complex, with
    a row for each output and largest component 1; `participation` (k, m) is complex, with a column for each input. At the angular frequency
    w, the response H is the sum of two terms for each mode: shape times participation / (j w - pole), and the same term with conjugate
    shape, participation and pole. Standard deviations of shapes apply to the real and to the imaginary part. `widening` (k,) is the
    inflation factor of all standard deviations, above 1 if the residual near the mode exceeds noise or may contain a further mode.
    `significance` (k,) is the mode's chi-squared statistic, divided by the level that noise exceeds with a probability of 1e-9. `close`
    lists groups of modes closer than their half-widths: only the subspace of a group can be compared, not the single modes. `noise` (p,) is
    the noise density of the outputs, in the output's unit squared per Hz; with floor excitation, `noise` is the whole density of the
    outputs. For an analyser's responses and for free decays, `noise` is unknown (NaN). `data_warnings` lists limits of the data. `peaks`
    are peaks not confirmed as modes. `delay` [s] is the common delay of all outputs, removed before the fit (0: none). With a delay, the
    response H above is multiplied by e^{-j w delay}.
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
    outputs: Annotated[tuple[Channel, ...], INNER]
    inputs: Annotated[tuple[Channel, ...], INNER]
    close: Annotated[tuple[tuple[int, ...], ...], INNER]
    residuals: Array
    responses: Annotated[Responses, INNER]
    stabilisation: Annotated[tuple[Stabilisation, ...], INNER]
    band: Annotated[tuple[float, float], FREQUENCY]
    noise: Array
    data_warnings: tuple[str, ...]
    provenance: str
    peaks: tuple[Peak, ...] = ()
    delay: Annotated[float, TIME] = 0.0
    delay_deviation: Annotated[float, TIME] = 0.0

    @property
    def modes(self) -> Annotated[tuple[IdentifiedMode, ...], VIEW]:
        """List of modes by ascending frequency."""
        columns: tuple[Iterable[Any], ...] = (
            range(1, len(self.frequencies) + 1),
            self.frequencies.tolist(),
            map(tuple, self.frequency_intervals.tolist()),
            self.damping.tolist(),
            map(tuple, self.damping_intervals.tolist()),
            self.widening.tolist(),
            (_by_channel(self.outputs, shape) for shape in self.shapes.T),
            (_by_channel(self.inputs, row) for row in self.participation),
            self.complexity.tolist(),
            self.significance.tolist(),
        )
        return tuple(IdentifiedMode(*row) for row in zip(*columns, strict=True))

    @property
    def notes(self) -> tuple[str, ...]:
        """Notes on the band, the delay and the close modes."""
        band = f"between {self.band[0]:.4g} and {self.band[1]:.4g} Hz."
        if not self.modes:
            return (f"No mode was found {band}",)
        late, spread = 1e3 * self.delay, 1e3 * NORMAL_95 * self.delay_deviation
        close = (
            f"Modes {' and '.join(map(str, group))} are closer than their half-widths: compare the subspace of their shapes."
            for group in self.close_modes
        )
        delay = (
            [f"All outputs are {late:.4g} ms late (95 % interval: +-{spread:.2g} ms). The delay is removed before the fit."]
            if self.delay
            else []
        )
        return (*close, f"Modes were searched for {band}", *delay)

    @property
    def close_modes(self) -> Annotated[tuple[tuple[int, ...], ...], VIEW]:
        """Numbers (from 1) of modes closer than their half-widths, in groups. Compare the subspace of a group, not its single modes."""
        return tuple(tuple(index + 1 for index in group) for group in self.close)

    @property
    def poles(self) -> Array:
        """Poles (k,) in rad/s, with positive imaginary part."""
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
        """Real parts of the shapes (p, k), each rotated in phase to be as real as possible, for comparison with an undamped model."""
        turn = np.exp(-0.5j * np.angle(np.sum(self.shapes**2, axis=0)))
        turned = np.real(self.shapes * turn)
        largest = np.take_along_axis(turned, np.argmax(np.abs(turned), axis=0)[None, :], axis=0)
        return turned / np.where(largest == 0.0, 1.0, largest)

    @property
    def complexity(self) -> Array:
        """Complexity (k,) of each shape phi: 1 - |sum(phi^2)|/sum(|phi|^2), which is 0 for a real mode, 1 for a travelling wave."""
        return 1.0 - np.abs(np.sum(self.shapes**2, axis=0)) / np.sum(np.abs(self.shapes) ** 2, axis=0)

    def response(self, frequencies: Array) -> Responses:
        """Compute the fitted responses at `frequencies` in Hz: modes, and residual terms of modes outside the band."""
        values = modal_sum(frequencies, self.poles, self.shapes, self.participation) + remainder_sum(frequencies, self.residuals)
        values = values * np.exp(-2j * np.pi * np.asarray(frequencies) * self.delay)[:, None, None] if self.delay else values
        return Responses(np.asarray(frequencies), self.outputs, self.inputs, values, name="modes", source=self.provenance)

    @property
    def shape_matrix(self) -> Annotated[Matrix, VIEW]:
        """Real shapes as a matrix: rows are outputs, columns modes."""
        names = tuple(str(index + 1) for index in range(len(self.frequencies)))
        return Matrix(self.real_shapes, names_of(self.outputs), names, "1")


def _interval(values: Array, deviations: Array) -> Array:
    return np.stack([values - NORMAL_95 * deviations, values + NORMAL_95 * deviations], axis=-1)


def _by_channel(channels: Sequence[Channel], values: Array) -> dict[str, complex]:
    return {channel.name: complex(value) for channel, value in zip(channels, values, strict=True)}
