"""Measuring chain of a virtual test in the frequency domain: from white noise to recorded inputs and gauge readings.

The whole chain is linear and time-invariant except for the gauges' quantisation, and the drive is band-limited. The continuous response is
therefore exactly the convolution of the drive's samples with the chain's impulse response. The response is computed block by block by
transforms, with the continuous frequency response of the stage, without discretisation.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from flexstage.base.finding import refuse
from flexstage.base.number import Array
from flexstage.experiment.virtual_rig.inputs import InputSignal
from flexstage.experiment.virtual_rig.plan import TAPER, Plan
from flexstage.mechanism.mechanism import Damping, ModalDamping, StructuralDamping
from flexstage.models.linear.damping import modal_ratios
from flexstage.models.linear.eigen import eigen
from flexstage.models.linear.frequency import superpose
from flexstage.models.linear.model import LinearModel
from flexstage.models.linear.port import Ports, ports

_FORGOTTEN = 30.0
"""Time constants after which an impulse response is negligible: e^-30 is 1e-13."""
_SPREAD = 15.0
_STEEPNESS = 4.0
_SHORTEST, _LONGEST = 16_384, 2**23
_LINES = 4096


@dataclass(frozen=True, eq=False)
class Chain:
    """Transfer functions from white noise of unit variance to the signals of the measuring chain, at the lines of a Fourier transform.

    The transform covers three blocks of `size` samples, at `finer` times the sampling rate of the record. `strokes` (l, m) are transfer
    functions to the inputs after the amplifiers, `inputs` (l, m) to the recorded inputs [m, A or N], and `outputs` (l, p, m) to the gauge
    readings [m, rad]. `strokes`, `inputs` and `outputs` use the first l spectral lines, up to the end of the drive's band. `gauge` (f, p)
    are transfer functions to the noise of the gauges, at all f lines. `note` describes the damping model.
    """

    size: int
    finer: int
    frequencies: Array
    strokes: Array
    inputs: Array
    outputs: Array
    gauge: Array
    note: str

    @property
    def input_rms(self) -> Array:
        """Expected rms (m,) of the recorded inputs [m, A or N]."""
        return np.sqrt(self._power(np.abs(self.inputs) ** 2))

    @property
    def output_rms(self) -> Array:
        """Expected rms (p,) of the gauge readings [m, rad]: motion and noise, without drift and quantisation."""
        return np.sqrt(self._power(np.sum(np.abs(self.outputs) ** 2, axis=-1)) + self._power(np.abs(self.gauge) ** 2))

    @property
    def stroke_rate_rms(self) -> Array:
        """Expected rms (m,) of the rate of the inputs after the amplifiers [m/s, A/s or N/s]."""
        omega = 2.0 * np.pi * self.frequencies[: len(self.strokes), None]
        return np.sqrt(self._power(np.abs(omega * self.strokes) ** 2))

    def _power(self, squares: Array) -> Array:
        """Mean square from squared transfer functions on lines from zero up; negative frequencies contribute equally."""
        return (2.0 * np.sum(squares, axis=0) - squares[0]) / (3 * self.size)


def chain(model: LinearModel, plan: Plan, damping: Damping) -> Chain:
    """Compute the measuring chain of a plan. Raises `DesignError` for a stage whose vibrations decay too slowly.

    Structural damping has no time-domain form: each mode has its equivalent damping ratio, and `note` mentions this.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.mapped import mapped
    >>> from flexstage.experiment.virtual_rig.plan import plan_test
    >>> from flexstage.experiment.virtual_rig.setup import RigSetup
    >>> stage = double_triangle()
    >>> model = mapped(stage)
    >>> found = chain(model, plan_test(stage, model, RigSetup(seconds=1.0)), model.damping)
    >>> (1e6 * found.input_rms).round(3).tolist()  # 1.5 and 2 um, reduced by the filter
    [1.418, 1.418, 1.418, 1.89, 1.89, 1.89]
    """
    finer = 2 ** max(1, int(np.ceil(np.log2(2.0 * (1.0 + TAPER) * plan.band[1] / plan.rate))))  # a block of a power of two divides evenly
    rate = finer * plan.rate
    size = _block(_memory(model, plan, damping), rate)
    lines = np.arange(3 * size // 2 + 1) * (rate / (3 * size))
    shape = amplitude_shape(lines, plan.band)
    used = lines[: np.flatnonzero(shape)[-1] + 1]
    unit = shape[: len(used)] / np.sqrt((2.0 * np.sum(shape**2) - shape[0] ** 2) / (3 * size))
    filtered = butterworth(used, plan.setup.filter.order, plan.corner)
    commands = unit[:, None] * plan.rms
    strokes = commands / (1.0 + 1j * used[:, None] / plan.bandwidths)
    seen = filtered[:, None] / (1.0 + 1j * used[:, None] / plan.lags)
    motion = _plant(model, ports(model, plan.gauges, plan.actuators), used, damping) * strokes[:, None, :]
    motion = motion * np.exp(-2j * np.pi * used * plan.setup.delay)[:, None, None] if plan.setup.delay else motion
    white = butterworth(lines, plan.setup.filter.order, plan.corner)[:, None] / (1.0 + 1j * lines[:, None] / plan.lags)
    return Chain(
        size=size,
        finer=finer,
        frequencies=lines,
        strokes=strokes,
        inputs=commands.astype(complex) if plan.setup.input_signal is InputSignal.COMMAND else filtered[:, None] * strokes,
        outputs=seen[:, :, None] * motion,
        gauge=white * (plan.densities * np.sqrt(0.5 * rate)),
        note=_note(damping),
    )


def butterworth(frequencies: Array, order: int, corner: float) -> Array:
    """Evaluate an analogue Butterworth low-pass filter (f,) of order n at frequencies f.

    It is the product over k = 0 ... n - 1 of 1/(s - p_k), with p_k = e^{j pi (2k + n + 1)/(2n)} and s = j f/corner.

    >>> abs(butterworth(np.array([0.0, 100.0]), 6, 100.0)).round(4).tolist(), butterworth(np.array([5.0]), 0, 1.0).tolist()
    ([1.0, 0.7071], [(1+0j)])
    """
    poles = np.exp(0.5j * np.pi * (2.0 * np.arange(order) + order + 1.0) / max(order, 1))
    result = np.ones(len(frequencies), dtype=complex)
    for pole in poles:
        result = result / (1j * frequencies / corner - pole)
    return result


def amplitude_shape(frequencies: Array, band: tuple[float, float]) -> Array:
    """Evaluate the drive's amplitude shape (f,): 1 within the `band` (low, high), 0 below low/2 and above 1.25 high.

    >>> (amplitude_shape(np.array([4.0, 10.0, 100.0, 112.5, 130.0]), (10.0, 100.0)) ** 2).round(6).tolist()
    [0.0, 1.0, 1.0, 0.25, 0.0]

    The edges follow the error function: their impulse response decays like a Gaussian function, so that adjacent blocks overlap little.
    """
    low, high = band
    shape = _edge((frequencies - high) / (TAPER * high))
    return shape * _edge((low - frequencies) / (0.5 * low)) if low > 0.0 else shape


def _edge(x: Array) -> Array:
    """Smooth fall from 1 at x = 0 to 0 at x = 1."""
    return np.where(x <= 0.0, 1.0, np.where(x >= 1.0, 0.0, 0.5 * scipy.special.erfc(_STEEPNESS * (2.0 * x - 1.0))))


def _memory(model: LinearModel, plan: Plan, damping: Damping) -> float:
    """Duration of the chain's impulse response [s]."""
    solved = eigen(model)
    omega, ratios = np.sqrt(solved.values), modal_ratios(model, solved, damping)
    over = np.sqrt(np.maximum(ratios**2 - 1.0, 0.0))
    decays = omega * (ratios - over)
    slowest = int(np.argmin(decays))
    if decays[slowest] <= 0.0:
        what = f"the mode at {omega[slowest] / (2.0 * np.pi):.4g} Hz has no damping: its vibration would never decay"
        raise refuse("damping", what, "Specify damping, for example a modal ratio of 0.01")
    lags = sum(_FORGOTTEN / (2.0 * np.pi * float(np.min(each, initial=np.inf))) for each in (plan.bandwidths, plan.lags))
    order = plan.setup.filter.order
    filtering = _FORGOTTEN / (2.0 * np.pi * plan.corner * np.sin(0.5 * np.pi / order)) if order else 0.0
    edges = _SPREAD / (TAPER * plan.band[1]) + (_SPREAD / (0.5 * plan.band[0]) if plan.band[0] else 0.0)
    return _FORGOTTEN / float(decays[slowest]) + lags + filtering + edges + plan.setup.delay


def _block(memory: float, rate: float) -> int:
    """Block size, a power of two: longer than the chain's impulse response, and than the drive's spectral edges in time."""
    size = max(_SHORTEST, 2 ** int(np.ceil(np.log2(memory * rate))))
    if size > _LONGEST:
        what = f"vibrations decay too slowly (got {memory:.4g} s or {memory * rate:.3g} samples, expected {_LONGEST:.3g} samples at most)"
        raise refuse("damping", what, "Use more damping, a lower rate, or a band that starts at 0 or at a higher frequency")
    return size


def _plant(model: LinearModel, chosen: Ports, lines: Array, damping: Damping) -> Array:
    """Response H (l, p, m) of the stage, a few thousand lines at a time."""
    pieces = [superpose(model, chosen, lines[start : start + _LINES], damping) for start in range(0, len(lines), _LINES)]
    return np.concatenate(pieces)


def _note(damping: Damping) -> str:
    if isinstance(damping, StructuralDamping):
        return "structural damping as equivalent modal ratios"
    return f"modal damping {float(np.real(damping.ratio)):g}" if isinstance(damping, ModalDamping) else "Rayleigh damping"
