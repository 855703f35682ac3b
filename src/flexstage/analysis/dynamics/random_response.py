"""Random response: power spectral densities and rms values of outputs due to random inputs."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from enum import Enum
from typing import Annotated

import numpy as np

from flexstage.analysis.dynamics.modes import average, repeated_groups
from flexstage.base.arguments import CheckedFields, check_arguments
from flexstage.base.finding import Finding, require
from flexstage.base.notebook import Result
from flexstage.base.number import Array
from flexstage.base.record import INNER, VIEW, Axes, Called
from flexstage.base.units.quantity import FREQUENCY
from flexstage.mechanism.mechanism import Damping
from flexstage.models.linear.damping import damping_law, modal_ratios
from flexstage.models.linear.eigen import eigen
from flexstage.models.linear.frequency import transfer
from flexstage.models.linear.model import Channel, LinearModel
from flexstage.models.linear.port import ports

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(8)
_OFFSETS = np.array([-81.0, -27.0, -9.0, -3.0, -1.0, 0.0, 1.0, 3.0, 9.0, 27.0, 81.0])
_PANELS_PER_DECADE = 6


class Rate(Enum):
    """Quantity of a spectrum: the value of the input, its velocity or its acceleration (e.g. floor acceleration)."""

    VALUE = 0
    VELOCITY = 1
    ACCELERATION = 2


@dataclass(frozen=True, eq=False)
class Spectrum(CheckedFields):
    """One-sided power spectral density of an input.

    `density` is one number (white noise), or a table (f,) of densities at `frequencies` (f,) in Hz. `rate` specifies whether the density is
    that of the input, of its velocity or of its acceleration. The unit of `density` is the square of the unit of this quantity, divided by
    Hz. Between the frequencies of a table, the logarithm of the density is linear in the logarithm of the frequency. Outside the table, the
    density is zero. Example for floor acceleration: `Spectrum(1e-8, rate=Rate.ACCELERATION)` in (m/s^2)^2/Hz.
    """

    density: float | Array
    frequencies: Array | None = None
    rate: Rate = Rate.VALUE

    def at(self, frequencies: Array) -> Array:
        """Return the density of the input at frequencies (f,) > 0 in Hz.

        >>> Spectrum(np.array([1.0, 100.0]), np.array([1.0, 10.0])).at(np.array([10.0**0.5, 20.0])).round(9).tolist()
        [10.0, 0.0]
        """
        scale = (2.0 * np.pi * frequencies) ** (-2 * self.rate.value)
        if self.frequencies is None:
            return np.asarray(self.density) * scale
        inside = (frequencies >= self.frequencies[0]) & (frequencies <= self.frequencies[-1])
        table = np.interp(np.log(frequencies), np.log(self.frequencies), np.log(self.density))
        return np.where(inside, np.exp(table), 0.0) * scale


class RandomResponse(Result):
    """One-sided densities (..., f, p) [unit^2/Hz] and rms values (..., p) [unit] of outputs, with the contribution of each input.

    `shares` (..., p, m) are the mean squares of each output due to each input. The inputs are uncorrelated, so the sum of an output's mean
    squares is rms^2. `method` is the method of integration.
    """

    frequencies: Annotated[Array, FREQUENCY, Called("frequency")]
    outputs: Annotated[tuple[Channel, ...], INNER]
    inputs: Annotated[tuple[Channel, ...], INNER]
    density: Annotated[Array, VIEW, Axes("frequencies", "responding")]
    rms: Annotated[Array, VIEW, Axes("responding")]
    shares: Annotated[Array, VIEW, Called("mean_square"), Axes("responding", "disturbing")]
    band: Annotated[tuple[float, float], FREQUENCY]
    method: str
    provenance: Annotated[str, INNER]

    @property
    def responding(self) -> Annotated[tuple[str, ...], VIEW, Called("outputs")]:
        """Output names."""
        return tuple(channel.name for channel in self.outputs)

    @property
    def disturbing(self) -> Annotated[tuple[str, ...], VIEW, Called("inputs")]:
        """Input names."""
        return tuple(channel.name for channel in self.inputs)

    @property
    def units(self) -> Annotated[tuple[str, ...], VIEW, Axes("responding")]:
        """Unit of each output's rms value. Mean squares have the square of this unit, densities the square of this unit per hertz."""
        return tuple(channel.unit for channel in self.outputs)


@check_arguments
def random_response(
    model: LinearModel,
    outputs: str | Iterable[str],
    spectra: Mapping[str, Spectrum],
    band: tuple[float, float],
    *,
    damping: Damping | None = None,
) -> RandomResponse:
    """Compute densities and rms values of outputs for uncorrelated random inputs.

    The density of output i is the sum over j of |H_ij|^2 S_j, with the frequency response H_ij to input j and the density S_j of this
    input. The square of the rms value is the integral of the output's density over `band`.

    `spectra` maps input names to one-sided densities. Each name is a single input channel, as in `response`; for example, `ground.z` is
    vertical floor motion. `band` is (low, high) in Hz, with low > 0. The integration is by Gauss-Legendre quadrature with 8 nodes per
    panel. Panels are frequency intervals. Their ends are at about six frequencies per decade, at the frequencies of the tables in
    `spectra`, and at distances from each resonance that are multiples of its half width (natural frequency times damping ratio). These
    panels resolve every peak (error 1e-8, compared with the solution of the Lyapunov equation). Raises `DesignError` for unknown names, an
    empty band, or non-positive densities.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.models.lumped import lumped
    >>> floor = {"ground.x": Spectrum(1e-18, rate=Rate.VALUE)}  # 1 nm per root hertz
    >>> result = random_response(lumped(parallelogram()), ["platform.x"], floor, (1.0, 101.0))
    >>> round(float(result.rms[0]) * 1e9, 1)  # far below the resonance the platform follows: 1 nm (100 Hz)^(1/2)
    10.0
    """
    require(spectrum_findings(spectra, band))
    law = damping_law(model, damping)
    chosen = ports(model, outputs, tuple(spectra))
    grid, weights = quadrature(_panels(model, law, spectra, band))
    gains = np.abs(transfer(model, chosen, grid, law)) ** 2
    each = gains * np.stack([spectrum.at(grid) for spectrum in spectra.values()], axis=-1)[:, None, :]
    shares = np.einsum("f,...fpm->...pm", weights, each)
    method = f"Gauss-Legendre, 8 nodes on each of {len(grid) // 8} panels"
    rms = np.sqrt(np.sum(shares, axis=-1))
    return RandomResponse(grid, chosen.outputs, chosen.inputs, np.sum(each, axis=-1), rms, shares, band, method, model.provenance)


def spectrum_findings(spectra: Mapping[str, Spectrum], band: tuple[float, float]) -> list[Finding]:
    """Return the errors in spectra and the integration band.

    >>> [finding.where for finding in spectrum_findings({"ground.z": Spectrum(-1.0)}, (10.0, 1.0))]
    ['band', 'ground.z']
    """
    low, high = band
    result = (
        [] if 0.0 < low < high < np.inf else [Finding("band", f"invalid band (got {low:g} Hz to {high:g} Hz)", "Use 0 < low < high in Hz")]
    )
    if not spectra:
        result.append(Finding("spectra", "no input has a spectrum", "Add a spectrum, e.g. {'ground.z': Spectrum(1e-18)}"))
    for name, spectrum in spectra.items():
        result += _table_findings(name, np.asarray(spectrum.density), spectrum.frequencies)
    return result


def _table_findings(name: str, density: Array, frequencies: Array | None) -> list[Finding]:
    wrong = not np.all(np.isfinite(density)) or np.any(density < 0.0) or (frequencies is not None and np.any(density == 0.0))
    findings = [Finding(name, "invalid density (negative or not finite, or zero in a table)", "Correct the density")] if wrong else []
    if frequencies is not None and (density.shape != frequencies.shape or np.any(np.diff(frequencies) <= 0.0) or frequencies[0] <= 0.0):
        findings.append(
            Finding(name, "invalid frequencies (expected positive ascending numbers, one for each density)", "Correct the table")
        )
    return findings


def _panels(model: LinearModel, law: Damping, spectra: Mapping[str, Spectrum], band: tuple[float, float]) -> Array:
    """Ends of the panels (k,) [Hz], for all designs of a batch."""
    solved = eigen(model)
    natural = np.sqrt(solved.values) / (2.0 * np.pi)
    rows = (part.reshape(-1, natural.shape[-1]) for part in np.broadcast_arrays(natural, modal_ratios(model, solved, law)))
    around = np.concatenate([_around(*each) for each in zip(*rows, strict=True)])
    low, high = band
    coarse = np.geomspace(low, high, 2 + int(_PANELS_PER_DECADE * np.log10(high / low)))
    knots = [np.asarray(item.frequencies) for item in spectra.values() if item.frequencies is not None]
    ends = np.concatenate([coarse, around[np.isfinite(around)].ravel(), *knots])
    return np.unique(np.concatenate([[low, high], ends[(ends > low) & (ends < high)]]))


def _around(natural: Array, ratios: Array) -> Array:
    """Ends of panels around the resonances of one design; repeated modes at their mean."""
    groups = repeated_groups(natural**2)
    width = np.maximum(average(ratios, groups), 1e-9)
    return (average(natural, groups)[:, None] * (1.0 + width[:, None] * _OFFSETS)).ravel()


def quadrature(ends: Array) -> tuple[Array, Array]:
    """Return nodes and weights of Gauss-Legendre quadrature, 8 nodes on every panel between `ends` (k,).

    >>> nodes, weights = quadrature(np.array([0.0, 1.0, 3.0]))
    >>> round(float(weights @ nodes**2), 12), round(3.0**3 / 3.0, 12)
    (9.0, 9.0)
    """
    half = 0.5 * np.diff(ends)[:, None]
    middle = 0.5 * (ends[1:] + ends[:-1])[:, None]
    return (middle + half * _NODES).ravel(), (half * _WEIGHTS).ravel()
