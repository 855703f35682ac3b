"""Hysteretic stacks of a stage: their behaviour, and the model for inverse compensation."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from itertools import pairwise
from typing import Annotated, ClassVar

import numpy as np

from flexstage.analysis.workspace.drive import Drive, drive
from flexstage.base.number import Array
from flexstage.base.record import Along, Heading, Layout
from flexstage.base.units.quantity import LENGTH, SHARE
from flexstage.control.hysteresis.creep import Creep, LogCreep, exponentials
from flexstage.control.hysteresis.identify import identify_hysteresis
from flexstage.control.hysteresis.models.bouc_wen import BoucWen, bouc_wen
from flexstage.control.hysteresis.models.inverse import hysteresis_inverse, inverse_state
from flexstage.control.hysteresis.models.prandtl_ishlinskii import PrandtlIshlinskii
from flexstage.control.hysteresis.models.protocol import Hysteresis
from flexstage.control.hysteresis.models.scaled import scale_to_stacks
from flexstage.control.hysteresis.models.shape import Range, major_loop
from flexstage.control.hysteresis.stack import load_hysteresis
from flexstage.control.study.choices import StackKind
from flexstage.control.study.setup import HystereticStacks
from flexstage.mechanism.mechanism import Mechanism

_LEGS = ((0.0, 1.0), (1.0, 0.0), (0.0, 1.0), (1.0, 0.2), (0.2, 0.8), (0.8, 0.0), (0.0, 0.6), (0.6, 0.0))
_LEG = 60
_STROKE, _VOLTS = 150e-6, (0.0, 1000.0)
"""Reference stack if only the width is known; its model is scaled to the stage's stacks."""
_SWEPT = 0.6
_CREEPS = (0.01, 100.0)
"""Time range [s] of simulated creep: earlier creep counts as stroke; a simulation is shorter."""
_EXACT = 1e-12
_TURNS = (1.0, -1.0, 0.7, -0.7, 0.4, -0.4, 0.0)


@dataclass(frozen=True, eq=False)
class Stacks:
    """Stacks of the actuators: `plant` is their simulated behaviour, `model` the inverted model, both from volts to strokes [m].

    `electric` converts strokes to voltages. `width` (n,) is the width of the plant's hysteresis loop divided by the stroke, for each stack.
    `creep` acts after the hysteresis (`None`: no creep).
    """

    electric: Drive
    plant: Hysteresis
    model: PrandtlIshlinskii
    width: Array
    creep: Creep | None = None


@dataclass(frozen=True, eq=False)
class Sweep:
    """Open-loop sweep of n stacks with decreasing amplitude: `wanted` (k, n) [m] are the requested strokes at k times.

    `bare` and `inverse` (k, n) [m] are the actual strokes without and with the inverse model. `width` (n,) is the width of each stack's
    hysteresis loop, divided by its stroke.
    """

    TABLE: ClassVar[Layout] = Layout(
        "Hysteresis of the stacks",
        "width range rms_error rms_error_inverse improvement",
        notes=("Errors are actual minus commanded strokes of isolated stacks in open loop, relative to the swept range.",),
    )

    actuators: tuple[str, ...]
    width: Annotated[Array, SHARE, Along("actuators"), Heading("loop width", digits=3)]
    wanted: Array
    bare: Array
    inverse: Array

    @property
    def range(self) -> Annotated[Array, LENGTH, Along("actuators"), Heading("swept range", digits=4, varying=True)]:
        """Swept range (n,) [m]."""
        return np.ptp(self.wanted, axis=0)

    @property
    def rms_error(self) -> Annotated[Array, SHARE, Along("actuators"), Heading("rms error", digits=3)]:
        """Rms error (n,) of the strokes during the sweep, divided by the swept range."""
        return self._error(self.bare)

    @property
    def rms_error_inverse(self) -> Annotated[Array, SHARE, Along("actuators"), Heading("rms error with inverse", digits=3)]:
        """Rms error (n,) of the strokes with the inverse model, divided by the swept range."""
        return self._error(self.inverse)

    @property
    def improvement(self) -> Annotated[Array, Along("actuators"), Heading("improvement factor", digits=3, infinite="exact")]:
        """Error without the inverse model divided by the error with it (n,); infinite if the inverse is exact within rounding error."""
        exact = self.rms_error_inverse <= _EXACT
        return np.where(exact, np.inf, self.rms_error / np.where(exact, 1.0, self.rms_error_inverse))

    def _error(self, came: Array) -> Array:
        return np.sqrt(np.mean((came - self.wanted) ** 2, axis=0)) / self.range


def stacks_of(mechanism: Mechanism, given: HystereticStacks) -> Stacks:
    """Construct the stacks of a stage with the hysteresis of a set-up, scaled to their strokes and voltages.

    A file's model is scaled for each stack, so that its hysteresis loop has the stack's voltage range and full stroke. With only a width,
    the plant is by default a Bouc-Wen stack, and the model is identified from a simulated record of such a stack. Raises `DesignError` for
    invalid files, and for stacks without a voltage range.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> found = stacks_of(double_triangle(), HystereticStacks(width=0.15))
    >>> found.model.axes, found.width.round(3).tolist()[:2]
    (6, [0.15, 0.15])
    """
    electric = drive(mechanism)
    low, high = (np.asarray(each, dtype=float) for each in (electric.low, electric.high))
    ranges = list(zip(low.tolist(), high.tolist(), strict=True))
    strokes = np.asarray(electric.gain, dtype=float) * (high - low)
    known, ends, law = _known_model(given)
    model = scale_to_stacks(known, ends or ranges[0], low, high, strokes)
    width = loop_widths(model, ranges)
    kind = given.plant or (StackKind.BOUC_WEN if given.file is None else StackKind.MODEL)
    plant = model if kind is StackKind.MODEL else _bouc_wen(strokes, ranges, width if given.width is None else given.width)
    return Stacks(electric, plant, model, loop_widths(plant, ranges), _creep(law, len(strokes)))


def _known_model(given: HystereticStacks) -> tuple[PrandtlIshlinskii, Range | None, LogCreep | None]:
    """Model of one stack, its voltage range (`None`: that of the stage's first stack), and its creep."""
    stated = LogCreep(given.creep) if given.creep else None
    if given.file is not None:
        stack = load_hysteresis(given.file)
        law = stack.log_creep if given.creep is None else stated
        return stack.model, (stack.volts[0], stack.volts[-1]) if stack.volts else None, law
    return _of_width(given.width or 0.0), _VOLTS, stated


def _creep(law: LogCreep | None, axes: int) -> Creep | None:
    """Common creep law of all stacks, as exponentials over four decades."""
    if law is None:
        return None
    one = exponentials(law, _CREEPS).creep
    return Creep(np.repeat(one.instant, axes), np.repeat(one.gains, axes, axis=0), np.repeat(one.times, axes, axis=0))


@cache
def _of_width(width: float) -> PrandtlIshlinskii:
    """Model identified from a record of a Bouc-Wen stack; a pure function of about a second."""
    volts = _VOLTS[1] * np.concatenate([np.linspace(*leg, _LEG) for leg in _LEGS])
    return identify_hysteresis(volts, bouc_wen(_STROKE, _VOLTS, width).run(volts)).model


def _bouc_wen(strokes: Array, ranges: Sequence[Range], width: Array | float) -> BoucWen:
    """Parallel Bouc-Wen stacks."""
    widths = np.broadcast_to(width, len(strokes)).tolist()
    kinds = list(zip(strokes.tolist(), ranges, widths, strict=True))
    made = {kind: bouc_wen(*kind) for kind in set(kinds)}
    return BoucWen(*(np.concatenate([getattr(made[kind], name) for kind in kinds]) for name in ("gain", "lag", "beta", "gamma")))


def loop_widths(model: Hysteresis, ranges: Sequence[Range]) -> Array:
    """Compute the width (n,) of each stack's settled hysteresis loop over its own voltage range, divided by its stroke.

    >>> from flexstage.control.hysteresis.models.bouc_wen import bouc_wen
    >>> loop_widths(bouc_wen(150e-6, (0.0, 1000.0), 0.1), [(0.0, 1000.0)]).round(3).tolist()
    [0.1]
    """
    loops = {volts: major_loop(model, volts).width for volts in dict.fromkeys(ranges)}
    return np.array([loops[volts][axis] for axis, volts in enumerate(ranges)])


def sweep_stacks(given: Stacks) -> Sweep:
    """Sweep the stacks in open loop around the bias, with amplitudes that decrease from 60 % of the range.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> found = sweep_stacks(stacks_of(double_triangle(), HystereticStacks(width=0.15)))
    >>> bool(np.all(found.rms_error_inverse < 0.2 * found.rms_error))
    True
    """
    electric, model, plant = given.electric, given.model, given.plant
    bias, gain = np.asarray(electric.bias, dtype=float), np.asarray(electric.gain, dtype=float)
    reach = _SWEPT * gain * np.minimum(electric.high - bias, bias - electric.low)
    turns = np.concatenate([np.linspace(a, b, _LEG * 3, endpoint=False) for a, b in pairwise((0.0, *_TURNS))])
    wanted = turns[:, None] * reach
    start = model.start(bias)
    at_rest = model.step(start, bias)[1]
    back = hysteresis_inverse(model)
    volts = back.run(wanted + at_rest, inverse_state(model, start))
    came = [_drive(plant, each, bias) for each in (bias + wanted / gain, volts)]
    return Sweep(electric.actuators, given.width, wanted, came[0], came[1])


def _drive(plant: Hysteresis, volts: Array, bias: Array) -> Array:
    """Strokes relative to those at the bias."""
    start = plant.start(bias)
    return plant.run(volts, start) - plant.step(start, bias)[1]
