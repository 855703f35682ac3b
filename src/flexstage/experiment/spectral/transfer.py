"""Frequency responses and coherences from spectra: H1, H2, the ratio of Shin & Moon, ordinary and multiple coherence."""

from __future__ import annotations

import numpy as np

from flexstage.base.arguments import check_arguments
from flexstage.base.finding import Finding, refuse, require
from flexstage.base.number import Array
from flexstage.experiment.records.record import Responses
from flexstage.experiment.spectral.cross_spectra import Spectra
from flexstage.experiment.spectral.lines import auto_powers

_DEPENDENT, _NOTHING = 1e-9, 1e-15


@check_arguments
def h1(spectra: Spectra) -> Responses:
    """Estimate H1 = G_yx G_xx^-1, the least-squares estimate for noise at the outputs (Bendat & Piersol, chapter 7).

    G_yx are the cross spectra of outputs y and inputs x, G_xx the spectra of the inputs. H_ij is the ratio of output i to input j. Inputs
    may be correlated. The result contains the ordinary coherence of every entry. Raises `DesignError` for linearly dependent inputs,
    because no estimate can separate their effects.

    >>> from flexstage.experiment.spectral.cross_spectra import example_spectra
    >>> h1(example_spectra()).values[3].round(9).real.tolist()
    [[3.0]]
    """
    require(dependent_inputs(spectra))
    # lines without input, such as the mean's, have no response: a trace of power gives zero
    trace = _NOTHING * np.real(np.mean(np.diagonal(spectra.xx, axis1=1, axis2=2))) * np.eye(spectra.xx.shape[1])
    values = np.swapaxes(np.linalg.solve(np.swapaxes(spectra.xx + trace, 1, 2), np.swapaxes(spectra.yx, 1, 2)), 1, 2)
    return _responses(spectra, values, "H1")


@check_arguments
def h2(spectra: Spectra) -> Responses:
    """Estimate H2 = G_yy G_xy^-1, for noise at the inputs; with more outputs than inputs, the inverse is a least-squares inverse.

    G_yy are the spectra of the outputs y, G_xy the cross spectra with the inputs x. H2 has more variance than H1, and noise at the outputs
    biases H2 upwards. Raises `DesignError` for fewer outputs than inputs.

    >>> from flexstage.experiment.spectral.cross_spectra import example_spectra
    >>> h2(example_spectra()).values[3].round(9).real.tolist()
    [[3.0]]
    """
    outputs, inputs = spectra.yx.shape[1:]
    if outputs < inputs:
        raise refuse("H2", f"too few outputs for {inputs} inputs (got {outputs})", "Use H1, or record as many outputs as inputs")
    crossed = np.conj(np.swapaxes(spectra.yx, 1, 2))
    return _responses(spectra, spectra.yy @ np.linalg.pinv(crossed), "H2")


def spectral_ratio(spectra: Spectra) -> Responses:
    """Compute the spectral ratio T_ij = G_ij / G_ii of Shin & Moon (equation 29), with outputs j as rows and inputs i as columns.

    G_ij is the cross spectrum of input i and output j, G_ii the power spectrum of input i. The ratio equals H1 for a single input or
    uncorrelated inputs. For correlated inputs, the ratio is not a transfer function.

    >>> from flexstage.experiment.spectral.cross_spectra import example_spectra
    >>> spectral_ratio(example_spectra()).values[3].round(9).real.tolist()
    [[3.0]]
    """
    return _responses(spectra, spectra.yx / auto_powers(spectra.xx)[:, None, :], "G_ij/G_ii")


def ordinary_coherence(spectra: Spectra) -> Array:
    """Compute the ordinary coherence |G_yx|^2 / (G_xx G_yy), shape (f, p, m), of every output y with every input x, between 0 and 1.

    >>> from flexstage.experiment.spectral.cross_spectra import example_spectra
    >>> ordinary_coherence(example_spectra())[3].round(9).tolist()
    [[1.0]]
    """
    both = auto_powers(spectra.yy)[:, :, None] * auto_powers(spectra.xx)[:, None, :]
    return _share(np.abs(spectra.yx) ** 2, both)


def multiple_coherence(spectra: Spectra) -> Array:
    """Compute the multiple coherence (f, p), the fraction of every output's power that all inputs explain (Bendat & Piersol, chapter 7).

    The coherence is H1 G_xx H1^H / G_yy, with the spectra G_xx of the inputs and the spectrum G_yy of the output. If an output is only
    noise, its estimated coherence is not zero, but about the number of inputs divided by the number of independent averages.

    >>> from flexstage.experiment.spectral.cross_spectra import example_spectra
    >>> multiple_coherence(example_spectra())[3].round(9).tolist()
    [1.0]
    """
    return _share(_explained(spectra), auto_powers(spectra.yy))


def noise_density(spectra: Spectra) -> Array:
    """Estimate the part (f, p) of the output power density that inputs do not explain, corrected for the bias of finite averages.

    >>> from flexstage.experiment.spectral.cross_spectra import example_spectra
    >>> bool(noise_density(example_spectra())[3, 0] < 1e-9)
    True
    """
    left = np.maximum(auto_powers(spectra.yy) - _explained(spectra), 0.0)
    free = spectra.independent - spectra.yx.shape[2]
    return left * spectra.independent / max(free, 1.0)


def dependent_inputs(spectra: Spectra) -> list[Finding]:
    """Check whether inputs are linearly dependent, that is, whether the smallest eigenvalue of their coherence matrix is zero.

    >>> from flexstage.experiment.spectral.cross_spectra import example_spectra
    >>> dependent_inputs(example_spectra())
    []
    """
    count = spectra.xx.shape[1]
    if not count:
        return [Finding("inputs", "no channel is an input", "Specify the input channels")]
    mean = np.mean(spectra.xx, axis=0)
    power = np.real(np.diagonal(mean))
    dead = [spectra.inputs[index].name for index in range(count) if power[index] <= 0.0]
    if dead:
        return [Finding(name, "the input is constant", "Omit it, or drive it") for name in dead]
    values, vectors = np.linalg.eigh(mean / np.sqrt(np.outer(power, power)))
    if values[0] > _DEPENDENT * count and spectra.averages >= count:
        return []
    if spectra.averages < count:
        what = f"{spectra.averages} averages cannot separate {count} inputs"
        return [Finding("inputs", what, "Record longer, or request a coarser resolution")]
    involved = [spectra.inputs[index].name for index in np.flatnonzero(np.abs(vectors[:, 0]) > 0.1)]
    what = f"{' and '.join(involved)} are not independent (smallest eigenvalue of the coherence matrix {max(values[0], 0.0):.1e})"
    return [Finding("inputs", what, "Drive them by independent noise, or omit all but one")]


def _explained(spectra: Spectra) -> Array:
    """Power densities (f, p) of the outputs that inputs explain."""
    return np.real(np.sum(h1(spectra).values * np.conj(spectra.yx), axis=-1))


def _share(part: Array, whole: Array) -> Array:
    return np.clip(np.divide(part, whole, out=np.zeros_like(part), where=whole > 0.0), 0.0, 1.0)


def _responses(spectra: Spectra, values: Array, name: str) -> Responses:
    return Responses(
        frequencies=spectra.frequencies,
        outputs=spectra.outputs,
        inputs=spectra.inputs,
        values=values,
        coherence=ordinary_coherence(spectra),
        window=spectra.segments.window.value,
        averages=spectra.averages,
        name=name,
    )
