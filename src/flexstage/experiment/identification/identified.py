"""What a record tells of a stage's modes."""

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
from flexstage.experiment.records.record import Channel, Responses

FrequencyInterval: TypeAlias = Annotated[tuple[float, float], FREQUENCY, Heading("95 % interval")]
DampingRatio: TypeAlias = Annotated[float, RATIO, Heading("damping ratio", digits=4, unit="%")]
DampingInterval: TypeAlias = Annotated[tuple[float, float], RATIO, Heading("95 % interval", unit="%")]
Widening: TypeAlias = Annotated[float, Heading("interval inflation", digits=2, mark=Graded(1.0))]
INFLATION = (
    "Interval inflation: width of the intervals over the width due to noise alone; above 1 where the residual near the mode exceeds noise."
)


@dataclass(frozen=True)
class IdentifiedMode:
    """One mode, its number counted from 1, with 95 % intervals; `shape` by output and `participation` by input are complex.

    `widening`, `complexity` and `significance` are told at `Identified`.
    """

    TABLE: ClassVar[Layout] = Layout(
        "Modes found",
        "number frequency frequency_interval damping damping_interval widening complexity significance",
        notes=(
            INFLATION,
            "Complexity: 0 where all outputs move in phase or opposite, 1 for a travelling wave.",
            "Test statistic: chi-squared of the mode, over the value that noise would exceed once in 1e9 tries.",
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
    """Modes found in records or responses, by rising frequency, each with its standard deviation.

    `frequencies` (k,) [Hz] are natural frequencies |pole|/(2 pi), `damping` (k,) ratios; `shapes` (p, k) complex, of the outputs, largest
    component 1; `participation` (k, m) complex, of the inputs: H = sum of shape participation / (j w - pole) + conjugate. `deviation` of
    shapes is that of real and of imaginary part. `widening` (k,) is how many times larger deviations are than noise makes them, because the
    fit leaves more than noise near the mode: 1 where it does not. `significance` (k,) is the chi-square by which the data ask for the mode,
    over that which noise would pass once in 1e9. `close` lists modes nearer to one another than their half-widths: compare those by
    subspace. `noise` (p,) is the outputs' noise density, in the outputs' unit squared per Hz. `warnings` say what the data cannot tell;
    `peaks` are seen and are no modes, or not with confidence. `delay` [s] is how much later all outputs come than the modes have it, as
    far as it had to be taken out for them to fit (0: not at all): H is as above times e^{-j w delay}.
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
        """The modes one by one, ascending."""
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
        """The band, the delay and the close modes, for tables."""
        band = f"between {self.band[0]:.4g} and {self.band[1]:.4g} Hz."
        if not self.modes:
            return (f"No mode was found {band}",)
        late, spread = 1e3 * self.delay, 1e3 * NORMAL_95 * self.delay_deviation
        close = (
            f"Modes {' and '.join(map(str, group))} are closer than their half-widths: use their subspace." for group in self.close_modes
        )
        delay = (
            [f"All outputs come {late:.4g} ms late (95 %: +-{spread:.2g} ms); the delay is removed before the fit."] if self.delay else []
        )
        return (*close, f"Searched {band}", *delay)

    @property
    def close_modes(self) -> Annotated[tuple[tuple[int, ...], ...], VIEW]:
        """Numbers of modes that lie nearer than their half-widths: compare those by subspace."""
        return tuple(tuple(index + 1 for index in group) for group in self.close)

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
        values = values * np.exp(-2j * np.pi * np.asarray(frequencies) * self.delay)[:, None, None] if self.delay else values
        return Responses(np.asarray(frequencies), self.outputs, self.inputs, values, name="modes", source=self.provenance)

    @property
    def shape_matrix(self) -> Annotated[Matrix, VIEW]:
        """The real shapes: rows are outputs, columns modes."""
        names = tuple(str(index + 1) for index in range(len(self.frequencies)))
        return Matrix(self.real_shapes, tuple(channel.name for channel in self.outputs), names, "1")


def _interval(values: Array, deviations: Array) -> Array:
    return np.stack([values - NORMAL_95 * deviations, values + NORMAL_95 * deviations], axis=-1)


def _by_channel(channels: Sequence[Channel], values: Array) -> dict[str, complex]:
    return {channel.name: complex(value) for channel, value in zip(channels, values, strict=True)}
