"""Noise budget of a loop: mean square and rms of position by source."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Annotated, Any

import numpy as np

from flexstage.analysis.dynamics.random_response import Spectrum, quadrature, spectrum_findings
from flexstage.base.arguments import check_arguments
from flexstage.base.finding import Finding, refuse, require, suggest_nearest
from flexstage.base.labelled import Matrix
from flexstage.base.notebook import InNotebook
from flexstage.base.number import Array
from flexstage.base.record import INNER, VIEW, Axes, Called
from flexstage.base.units.quantity import FREQUENCY
from flexstage.control.plant_models.electronics import Amplifier, Sensor
from flexstage.control.plant_models.plants import SENSED
from flexstage.control.robustness.stability import require_stable
from flexstage.control.systems.closed import Loop
from flexstage.control.systems.curves import points_around, rates_of
from flexstage.control.systems.system import System, select
from flexstage.control.white_noise import Kind, Source, bounded_amplifiers, mean_squares, white_system
from flexstage.mechanism.mechanism import GROUND
from flexstage.models.linear.model import Channel
from flexstage.spatial.frame import COMPONENTS

_PER_DECADE = 6
_HALF = 0.5


@dataclass(frozen=True, eq=False)
class NoiseBudget(InNotebook):
    """Noise budget: mean squares of the outputs at the sampling instants. The contributions of the uncorrelated sources add up.

    `squares` (p, k) [unit^2] has a row for each of `outputs` and a column for each of `sources`. `density` (f, p, k) is the one-sided
    density [unit^2/Hz] at `frequencies` (f,) [Hz]. The density due to floor vibration belongs to the frequency of the vibration, even above
    half the sampling rate. The densities of white sources include aliasing, and are zero above half the sampling rate. `changes` (g,) are
    the rms changes of the readings of `gauges` between samples, before rounding, in resolution steps (NaN: no rounding). `notes` list the
    assumptions and missing data of each kind of source.
    """

    outputs: Annotated[tuple[Channel, ...], INNER]
    sources: tuple[Source, ...]
    squares: Annotated[Array, Called("mean_square")]
    frequencies: Array
    density: Array
    band: Annotated[tuple[float, float], FREQUENCY]
    gauges: Annotated[tuple[str, ...], INNER]
    changes: Array
    notes: tuple[str, ...]

    @property
    def slowly_rounding(self) -> tuple[str, ...]:
        """Gauges whose rounding has an effect and is not white: their readings change by less than half a step per sample.

        In a Gaussian series with rms changes of s steps, the rounding errors of successive samples have a correlation of about exp(-2 pi^2
        s^2) (Widrow & Kollar, Quantization Noise, 2008). For s = 1/2, the correlation is 0.7 %.
        """
        counts = np.any(self.squares > 0.0, axis=0)
        rounded = {each.channel for each, some in zip(self.sources, counts, strict=True) if some and each.kind is Kind.ROUNDING}
        return tuple(name for name, change in zip(self.gauges, self.changes, strict=True) if change < _HALF and name in rounded)

    @property
    def rms(self) -> Annotated[Array, Axes("output_names")]:
        """Rms value (p,) of each output, due to all sources."""
        return np.sqrt(np.sum(self.squares, axis=1))

    @property
    def kinds(self) -> tuple[Kind, ...]:
        """Kinds of sources in the budget."""
        return tuple(kind for kind in Kind if any(source.kind is kind for source in self.sources))

    @property
    def by_kind(self) -> Matrix:
        """Mean squares by output and kind of source."""
        values = _sum_by(self.squares, [source.kind for source in self.sources], self.kinds)
        units = tuple((f"{unit}^2",) * len(self.kinds) for unit in self.units)
        return Matrix(values, self.output_names, tuple(kind.value for kind in self.kinds), units)

    @property
    def output_names(self) -> Annotated[tuple[str, ...], Called("outputs")]:
        """Names of the outputs."""
        return tuple(channel.name for channel in self.outputs)

    @property
    def units(self) -> Annotated[tuple[str, ...], Axes("output_names")]:
        """Units of the outputs; mean squares have the squares of these units."""
        return tuple(channel.unit for channel in self.outputs)

    @property
    def steps_per_sample(self) -> Annotated[Mapping[str, float], VIEW]:
        """Rms change of the reading of each rounding gauge between samples, in resolution steps."""
        return {name: float(each) for name, each in zip(self.gauges, self.changes, strict=True) if not np.isnan(each)}

    @property
    def rounding_is_white(self) -> Annotated[bool, VIEW]:
        """Whether rounding is white noise, as the budget assumes. If rounding is not white, use the simulated rms."""
        return not self.slowly_rounding


@check_arguments
def noise_budget(
    closed: Loop, floor: Mapping[str, Spectrum], band: tuple[float, float], outputs: tuple[str, ...] | None = None
) -> NoiseBudget:
    """Compute the noise budget of a loop: mean squares of `outputs` due to floor, gauges, converters and amplifiers.

    The default outputs are the platform's six motions relative to the ground. `floor` maps ground motions (`ground.x`) to one-sided
    densities. The densities of floor vibration, of leg sensors, and of amplifiers without lag are integrated by Gauss quadrature over
    `band` (low, high) [Hz]. All other sources are white: Lyapunov's equation gives their mean squares over all frequencies
    (`white_system`). The gauges sample a ground motion e^{j omega t} at the times k T, with the sampling period T and integers k. At these
    times, a ground motion w causes the outputs y = [G_y(j omega) + S_y(e^{j omega T}) G_gap(j omega)] w. G_y and G_gap are the stage's
    responses at the outputs and at the gauges, and S_y is the response of the sampled loop's outputs to gauge noise. Aliasing of ground
    motion above half the sampling rate is included exactly. Raises `DesignError` for an unstable loop (the message contains its growth
    rate) and for a continuous loop.

    >>> from flexstage.control.example import integral_loop
    >>> found = noise_budget(integral_loop(), {"ground.x": Spectrum(1e-18)}, (0.1, 1000.0), ("relative.x",))
    >>> [source.kind.value for source in found.sources], bool(np.allclose(found.rms**2, found.by_kind.values.sum()))
    (['gauge noise', 'gauge rounding', 'floor'], True)
    """
    require_stable(closed, "rms values")
    if closed.step is None:
        raise refuse("loop", "a noise budget needs a sampled loop, but the loop is continuous", "Specify the sampling rate")
    require([*spectrum_findings(floor, band), *_findings(floor)] if floor else [])
    outputs = tuple(f"relative.{name}" for name in COMPONENTS) if outputs is None else outputs
    gauges = closed.plant.gauges
    seen, count = (*outputs, *(name for name in gauges if name not in outputs)), len(outputs)
    both, sources = white_system(closed, seen)
    white, readings = (select(both, both.input_names, names) for names in (outputs, gauges))
    listed = tuple(dict.fromkeys(sources))
    squares = _sum_by(mean_squares(white), sources, listed)
    spectra = band_spectra(closed, floor, seen)
    nodes, weights = quadrature(_panels(closed, floor, band))
    every = np.abs(disturbance_response(closed, tuple(spectra), seen, nodes)) ** 2
    gains = every[:, :count]
    densities = np.stack([spectrum.at(nodes) for spectrum in spectra.values()], axis=-1) if spectra else np.zeros((len(nodes), 0))
    shares = np.einsum("f,fpm,fm->pm", weights, gains, densities)
    differences = 4.0 * np.sin(np.pi * nodes * closed.step)[:, None] ** 2  # |e^{j omega T} - 1|^2, for successive samples
    driven = np.einsum("f,fgm,fm->g", weights, every[:, [seen.index(name) for name in gauges]], differences * densities)
    changes = _changes(closed, readings, sources, driven)
    budget = NoiseBudget(
        outputs=white.outputs,
        sources=(*listed, *(_source(name) for name in spectra)),
        squares=np.hstack([squares, shares]),
        frequencies=nodes,
        density=np.concatenate([_white_density(white, sources, nodes), gains * densities[:, None, :]], axis=-1),
        band=band,
        gauges=gauges,
        changes=changes,
        notes=(),
    )
    return replace(budget, notes=tuple(_notes(closed, outputs, budget)))


def _changes(closed: Loop, readings: System, sources: tuple[Source, ...], driven: Array) -> Array:
    """Rms changes (g,) of readings between samples, in their steps: white sources through y[k] - y[k-1], and the `driven` part."""
    gauges = closed.plant.gauges
    steps = np.array([closed.plant.hardware.sensors.get(name, Sensor()).resolution for name in gauges])
    states, count = len(readings.A), len(gauges)
    A = np.block([[readings.A, np.zeros((states, count))], [readings.C, np.zeros((count, count))]])
    B, C = np.vstack([readings.B, readings.D]), np.hstack([readings.C, -np.eye(count)])
    moving = [source.kind not in (Kind.ROUNDING, Kind.CONVERTER) for source in sources]
    squares = np.sum(mean_squares(replace(readings, A=A, B=B, C=C))[:, moving], axis=1) + driven
    return np.sqrt(squares) / np.where(steps > 0.0, steps, np.nan)


def _sum_by(squares: Array, labels: Sequence[Any], groups: Sequence[Any]) -> Array:
    """Sum of the columns of each group."""
    columns = [np.sum(squares[..., [each == group for each in labels]], axis=-1) for group in groups]
    return np.stack(columns, axis=-1) if columns else np.zeros((*squares.shape[:-1], 0))


def _white_density(white: System, sources: tuple[Source, ...], frequencies: Array) -> Array:
    """One-sided densities (f, p, k) of white sources: 2 T |H|^2, or 2 |H|^2 of a continuous loop; zero above half the sampling rate."""
    step = white.step or np.nan
    size = np.where((frequencies <= 0.5 / step)[:, None, None], 2.0 * step * np.abs(white.sweep(frequencies)) ** 2, 0.0)
    return _sum_by(size, sources, tuple(dict.fromkeys(sources)))


def band_spectra(closed: Loop, floor: Mapping[str, Spectrum], outputs: tuple[str, ...]) -> dict[str, Spectrum]:
    """Return the spectra that are integrated over a band, by name of the plant input: floor, amplifiers without lag, and leg sensors.

    >>> from flexstage.control.example import integral_loop
    >>> list(band_spectra(integral_loop(), {"ground.x": Spectrum(1e-18)}, ("relative.x",)))
    ['ground.x']
    """
    found = dict(floor) | {name: Spectrum(density**2) for name, density in closed.plant.heard.items()}
    bounded = bounded_amplifiers(closed, outputs)
    for name, amplifier in closed.plant.hardware.amplifiers.items():
        if amplifier.noise_density and name not in bounded:
            found[name] = Spectrum(amplifier.noise_density**2)
    return found


def _source(name: str) -> Source:
    if name.startswith(f"{SENSED}."):
        return Source(Kind.GAUGE, name)
    return Source(Kind.FLOOR if name.startswith(f"{GROUND}.") else Kind.AMPLIFIER, name)


def disturbance_response(closed: Loop, inputs: tuple[str, ...], outputs: tuple[str, ...], frequencies: Array) -> Array:
    """Compute the response (f, p, m) of a loop to continuous disturbances of its stage: ground motion (`ground.x`) or strokes of actuators.

    At the samples, the response is G_y(j omega) + S_y(e^{j omega T}) G_gap(j omega) (symbols: see `noise_budget`). `frequencies` (f,) [Hz]
    may exceed half the sampling rate.
    """
    given = closed.plant
    own = [name for name in outputs if name in given.system.output_names]
    gaps = select(given.system, inputs, (*(f"gap.{name}" for name in given.gauges), *own)).sweep(frequencies)
    noises = [f"noise.{name}" for name in given.gauges]
    found = select(closed.system, noises, outputs).sweep(frequencies) @ gaps[:, : len(noises)]
    found[:, [outputs.index(name) for name in own]] += gaps[:, len(noises) :]
    return found


def _panels(closed: Loop, floor: Mapping[str, Spectrum], band: tuple[float, float]) -> Array:
    """Panel ends [Hz]: around every resonance of stage and loop, mirrored at multiples of the sampling rate for a sampled loop."""
    low, high = band
    step = closed.step or np.nan
    near = points_around(rates_of(closed.system.poles, step))
    near = np.concatenate([np.abs(number / step + sign * near) for number in range(int(high * step) + 2) for sign in (1.0, -1.0)])
    stage = points_around(rates_of(closed.plant.system.poles, None))
    coarse = np.geomspace(low, high, 2 + int(_PER_DECADE * np.log10(high / low)))
    knots = [np.asarray(spectrum.frequencies) for spectrum in floor.values() if spectrum.frequencies is not None]
    ends = np.concatenate([coarse, near, stage, *knots])
    return np.unique(np.concatenate([[low, high], ends[(ends > low) & (ends < high)]]))


def _findings(floor: Mapping[str, Spectrum]) -> list[Finding]:
    known = [f"{GROUND}.{name}" for name in COMPONENTS]
    return [Finding(name, "unknown motion of the ground", suggest_nearest(name, known)) for name in floor if name not in known]


def _notes(closed: Loop, outputs: tuple[str, ...], budget: NoiseBudget) -> Iterator[str]:
    """Assumptions for each kind of source, and missing data."""
    given = closed.plant
    sensors = {name: given.hardware.sensors.get(name, Sensor()) for name in given.gauges}
    silent = [name for name, sensor in sensors.items() if sensor.noise_density is None]
    bare = [name for name, sensor in sensors.items() if sensor.noise_density and np.isinf(sensor.bandwidth) and not sensor.filter_order]
    if silent:
        yield f"the noise of {', '.join(silent)} is not specified: counted as zero"
    if bare:
        end = f"half the sampling rate, {0.5 / (closed.step or np.nan):g} Hz"
        yield f"bandwidth and filter of {', '.join(bare)} are not specified: noise is limited to {end}"
    if len(bare) < len(sensors) - len(silent):
        yield "gauge noise is assumed white before lag and filter; aliasing of its part above half the sampling rate is computed exactly"
    if budget.slowly_rounding:
        units = {channel.name: channel.unit for channel in given.coordinates.readings() if channel.name in budget.slowly_rounding}
        steps = {unit: max(sensors[name].resolution for name, own in units.items() if own == unit) for unit in sorted({*units.values()})}
        half = ", ".join(f"{1e9 * 0.5 * step:.3g} n{unit}" for unit, step in steps.items())
        most = max(change for name, change in zip(budget.gauges, budget.changes, strict=True) if name in budget.slowly_rounding)
        yield (
            f"rounding of the readings of {', '.join(budget.slowly_rounding)} is counted as white noise, but it is not white: from sample "
            f"to sample, these readings change by at most {most:.2g} steps (rms), and white rounding requires half a step. A reading at "
            f"rest may be wrong by half a step ({half}), which the loop cannot correct"
        )
    quiet = [name for name in given.actuators if given.hardware.amplifiers.get(name, Amplifier()).noise_density is None]
    if quiet:
        yield f"the amplifier noise of {', '.join(quiet)} is not specified: counted as zero"
    unbounded = list(band_spectra(closed, {}, outputs))
    heard = [name for name in unbounded if name.startswith(f"{SENSED}.")]
    only = f"integrated from {budget.band[0]:g} to {budget.band[1]:g} Hz only"
    driven = [name for name in unbounded if name not in heard]
    if driven:
        yield f"the amplifiers of {', '.join(driven)} have no lag: their noise is {only}"
    if heard:
        legs = ", ".join(name.removeprefix(f"{SENSED}.") for name in heard)
        yield f"sensor noise of the legs of {legs} is {only}"
