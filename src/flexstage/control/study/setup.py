"""Set-up of a loop, the form of its file: sampling, amplifier, gauges, floor, controller, compensation, trajectory.

Every field has its quantity, from which the file reader and schema are generated.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from typing import Annotated, Any, ClassVar, TypeAlias

from flexstage.base.arguments import CheckedFields
from flexstage.base.units.quantity import (
    ACCELERATION,
    ACCELERATION_NOISE,
    ANGLE,
    DISPLACEMENT,
    FORCE_NOISE,
    FREQUENCY,
    JERK,
    NOISE_DENSITY,
    NOT_NEGATIVE,
    POSITIVE,
    RATE,
    RATIO,
    SPEED,
    TIME,
    VELOCITY_NOISE,
    Bound,
)
from flexstage.control.controllers.kinds import CONTROLLERS
from flexstage.control.study.choices import (
    SEARCHED_BY_DEFAULT,
    Axes,
    Axis,
    Compensation,
    ControllerKind,
    Criterion,
    Following,
    Notching,
    OfferedKind,
    StackKind,
)
from flexstage.control.study.hardware.amplifier_kinds import AMPLIFIERS
from flexstage.control.study.hardware.amplifiers import AmplifierForm, AmplifierSetup
from flexstage.control.tuning.objective import TuningObjective
from flexstage.mechanism.grammar.node import ChoiceNode
from flexstage.models.theory import Model

_PEAK = Bound(low=1.0, open_low=True)
_SHARE = Bound(low=0.0, high=0.5, open_low=True)
_OVER, _SPREAD = Bound(low=0.02, high=1.0), Bound(low=0.0, high=0.3)
_DAMPED, _SWINGING = Bound(low=0.0, high=1.0, open_low=True), Bound(low=0.0, high=1.0, open_high=True)
_CREEP = Bound(low=-0.2, high=0.2)


@dataclass(frozen=True)
class KindNode(ChoiceNode):
    """Kinds of controllers: the members of `ControllerKind`, and the entries of `CONTROLLERS`, which other packages extend."""

    @property
    def words(self) -> dict[str, Any]:
        """Kinds by their names in files."""
        return {each.value: each for each in ControllerKind} | {name: OfferedKind(name) for name in CONTROLLERS}


KINDS = KindNode(ControllerKind)
"""Kinds of controllers by the names in files and options."""
GAINS = ("proportional", "integral", "derivative")
"""Keys of a law's gains."""


@dataclass(frozen=True)
class AxisAmplitudes(CheckedFields):
    """Amplitudes by platform motion; default: none."""

    x: Annotated[float, DISPLACEMENT] | None = None
    y: Annotated[float, DISPLACEMENT] | None = None
    z: Annotated[float, DISPLACEMENT] | None = None
    rx: Annotated[float, ANGLE] | None = None
    ry: Annotated[float, ANGLE] | None = None
    rz: Annotated[float, ANGLE] | None = None


@dataclass(frozen=True)
class GaugeSetup(CheckedFields):
    """Gauges: white `noise`, steps of `resolution`, `bandwidth`; default: the data of each gauge in the design.

    `filter_order` and `filter_corner` describe an analogue low-pass filter (Butterworth) before sampling (order 0: none).
    """

    noise: Annotated[float, NOISE_DENSITY, NOT_NEGATIVE] | None = None
    resolution: Annotated[float, DISPLACEMENT, NOT_NEGATIVE] | None = None
    bandwidth: Annotated[float, FREQUENCY, POSITIVE] | None = None
    filter_order: Annotated[int, Bound(low=0.0, high=20.0)] = 0
    filter_corner: Annotated[float, FREQUENCY, POSITIVE] | None = None


@dataclass(frozen=True)
class VibrationSetup(CheckedFields):
    """The floor along one axis: a `criterion` by name, or an amplitude density of `acceleration`, `velocity` or `displacement`.

    A single density is white. With `frequencies`, as many as densities, it is interpolated in log-log, and zero outside.
    """

    criterion: Criterion | None = None
    frequencies: tuple[Annotated[float, FREQUENCY, POSITIVE], ...] = ()
    acceleration: tuple[Annotated[float, ACCELERATION_NOISE, NOT_NEGATIVE], ...] = ()
    velocity: tuple[Annotated[float, VELOCITY_NOISE, NOT_NEGATIVE], ...] = ()
    displacement: tuple[Annotated[float, NOISE_DENSITY, NOT_NEGATIVE], ...] = ()


@dataclass(frozen=True)
class Floor(CheckedFields):
    """Floor vibration by axis; default: none."""

    x: VibrationSetup | None = None
    y: VibrationSetup | None = None
    z: VibrationSetup | None = None


@dataclass(frozen=True)
class NotchSetup(CheckedFields):
    """Notch filter: `frequency`, `depth` (gain at that frequency), and `damping` of its poles, which sets the width."""

    frequency: Annotated[float, FREQUENCY, POSITIVE]
    depth: Annotated[float, RATIO, NOT_NEGATIVE] | None = None
    damping: Annotated[float, RATIO, POSITIVE] | None = None


@dataclass(frozen=True)
class PrefilterSetup(CheckedFields):
    """Second-order low-pass prefilter of the reference, with `frequency` and `damping`, and a `lead` above it."""

    frequency: Annotated[float, FREQUENCY, POSITIVE]
    damping: Annotated[float, RATIO, POSITIVE] = 1.0
    lead: Annotated[float, FREQUENCY, POSITIVE] | None = None


@dataclass(frozen=True)
class LoopNumbers(CheckedFields):
    """Parameters of some loops, named by `axes`: x, rz ..., in other coordinates mode1 or the actuator's name.

    Missing parameters are the common ones; `notches` are additional.
    """

    axes: tuple[str, ...]
    proportional: Annotated[float, RATIO] | None = None
    integral: Annotated[float, RATE, NOT_NEGATIVE] | None = None
    derivative: Annotated[float, TIME, NOT_NEGATIVE] | None = None
    filter: Annotated[float, FREQUENCY, POSITIVE] | None = None
    notches: tuple[NotchSetup, ...] = ()
    prefilter: PrefilterSetup | None = None


@dataclass(frozen=True)
class GoalSetup(CheckedFields):
    """Specification of optimisation-based tuning: its `objective`, and limits for every loop.

    `rejection` is the lowest sensitivity crossover, `settling` the longest 2 % settling time, `overshoot` the maximum, `delay_margin` the
    minimum; default: no limit. The limit of the peak of S must hold for relative mode shifts up to `spread` and relative gain errors up to
    `gain`. `prefilter` also optimises a reference prefilter.
    """

    objective: TuningObjective = TuningObjective.BALANCE
    rejection: Annotated[float, FREQUENCY, POSITIVE] | None = None
    settling: Annotated[float, TIME, POSITIVE] | None = None
    overshoot: Annotated[float, RATIO, _OVER] = 0.2
    delay_margin: Annotated[float, TIME, POSITIVE] | None = None
    spread: Annotated[float, RATIO, _SPREAD] = 0.02
    gain: Annotated[float, RATIO, _SPREAD] = 0.0
    prefilter: bool = False


@dataclass(frozen=True)
class ControllerSetup(CheckedFields):
    """Controller: `kind`, coordinates, and either a specification or gains.

    The default kind is PI, for force-driven stages PID (unless gains are specified). Specification: `bandwidth` (the gain crossover;
    default: the highest that `sensitivity` allows) and `sensitivity`, the maximum peak of S. Gains: `proportional` (strokes or motion per
    error), `integral` rate, `derivative` time and its `filter` corner, common to all loops; `loops` specify individual ones. `notches` are
    additional to automatic ones. `prefilter` shapes the reference.

    PI and PID are optimised for a `goal` within `sensitivity`, by default balance. `quick`, a bandwidth, gains or notches disable this.
    """

    kind: Annotated[ControllerKind | OfferedKind, KINDS] | None = None
    coordinates: Axes = Axes.PLATFORM
    bandwidth: Annotated[float, FREQUENCY, POSITIVE] | None = None
    sensitivity: Annotated[float, RATIO, _PEAK] | None = None
    proportional: Annotated[float, RATIO] | None = None
    integral: Annotated[float, RATE, NOT_NEGATIVE] | None = None
    derivative: Annotated[float, TIME, NOT_NEGATIVE] | None = None
    filter: Annotated[float, FREQUENCY, POSITIVE] | None = None
    notching: Notching = Notching.AUTOMATIC
    notches: tuple[NotchSetup, ...] = ()
    loops: tuple[LoopNumbers, ...] = ()
    prefilter: PrefilterSetup | None = None
    goal: GoalSetup | None = None
    quick: bool = False

    @property
    def search_goal(self) -> GoalSetup | None:
        """Goal of the optimisation-based tuning in force; absent: plain tuning, or none."""
        plain = self.quick or self.stated or self.bandwidth is not None or self.notches or self.notching is Notching.NONE
        return self.goal if self.goal is not None or plain or self.law not in SEARCHED_BY_DEFAULT else GoalSetup()

    @property
    def stated(self) -> tuple[str, ...]:
        """Specified gains, common or individual: these are not tuned."""
        return tuple(name for name in GAINS if any(getattr(each, name) is not None for each in (self, *self.loops)))

    @property
    def law(self) -> ControllerKind | OfferedKind:
        """Kind of controller, PI by default."""
        return self.kind or ControllerKind.PI


@dataclass(frozen=True)
class DampingSetup(CheckedFields):
    """Integral force feedback in the legs, inside the pose loop: each stack extends at a rate proportional to its leg's tension.

    `ratio` is the required damping of the modes with the largest residues; alternatively `gain`. `corner` belongs to the high-pass filter
    (default: a tenth of the lowest of these modes without the stacks' stiffness). The filter's `order` 2 preserves the static stiffness;
    order 1 keeps a / (a + gain) of it, with a = 2 pi `corner`. The tension comes from a force sensor in each leg, with white `noise`, or
    from strain `gauges` on links of the legs, with their own noise and bandwidth. `lag` and `delay` belong to analogue electronics.
    Alternatively a computer runs the law at a `rate`, an integer multiple of the loop's, with strokes after `delay` (default: one sample of
    that rate).
    """

    ratio: Annotated[float, RATIO, _DAMPED] | None = None
    gain: Annotated[float, RATE, POSITIVE] | None = None
    corner: Annotated[float, FREQUENCY, POSITIVE] | None = None
    order: Annotated[int, Bound(low=1.0, high=2.0)] = 2
    gauges: tuple[str, ...] = ()
    noise: Annotated[float, FORCE_NOISE, NOT_NEGATIVE] | None = None
    lag: Annotated[float, FREQUENCY, POSITIVE] | None = None
    delay: Annotated[float, TIME, NOT_NEGATIVE] | None = None
    rate: Annotated[float, FREQUENCY, POSITIVE] | None = None


@dataclass(frozen=True)
class FollowSetup(CheckedFields):
    """Tracking method for a trajectory known in advance; the error is relative to the trajectory.

    `method` is the inverse of the model's loop, iterative learning (`passes`, `gain`), or repetitive control with that gain for a periodic
    path (a raster, a sine). All three act in the band that is robust to relative mode shifts up to `spread`. Alternatively `method` is an
    input shaper for a mode at `frequency` of a `damping` ratio.
    """

    method: Following
    passes: Annotated[int, Bound(low=1.0, high=50.0)] = 10
    gain: Annotated[float, RATIO, _DAMPED] = 0.6
    spread: Annotated[float, RATIO, _SPREAD] = 0.02
    frequency: Annotated[float, FREQUENCY, POSITIVE] | None = None
    damping: Annotated[float, RATIO, _SWINGING] = 0.0


@dataclass(frozen=True)
class HystereticStacks(CheckedFields):
    """Hysteresis of the stacks: a model in a `file`, from `flexstage hysteresis`, or only the `width` of the loop relative to the stroke.

    The model is scaled to each stack's stroke and voltage, and defines the inverse. The stacks themselves follow `plant`: the same model,
    or Bouc-Wen stacks of the same width, which the inverse does not cancel exactly (default: the model of a file, Bouc-Wen for a width).
    `creep` is the creep per decade of time relative to the stroke, from 0.1 s (default: as in the file).
    """

    file: str | None = None
    width: Annotated[float, RATIO, _SHARE] | None = None
    plant: StackKind | None = None
    creep: Annotated[float, RATIO, _CREEP] | None = None


@dataclass(frozen=True)
class StepMotion(CheckedFields):
    """Step of every specified motion, one at a time; default: 1 um and 10 urad, for all motions of the stage.

    With `speed`, `acceleration` and `jerk`, all three, it is a motion profile within these limits, along the path in m. For pure rotations
    a metre represents a radian.
    """

    TOLD_BY: ClassVar[tuple[str, str]] = ("kind", "step")

    amplitude: AxisAmplitudes = field(default_factory=AxisAmplitudes)
    speed: Annotated[float, SPEED, POSITIVE] | None = None
    acceleration: Annotated[float, ACCELERATION, POSITIVE] | None = None
    jerk: Annotated[float, JERK, POSITIVE] | None = None


@dataclass(frozen=True)
class RasterMotion(CheckedFields):
    """Raster scan: `lines` of a `length`, `pitch` apart, at constant `speed`, reversed with `acceleration`.

    The axes are `fast` and `slow`. For rotations a metre represents a radian: a line of 20 um along rx is one of 20 urad.
    """

    TOLD_BY: ClassVar[tuple[str, str]] = ("kind", "raster")

    length: Annotated[float, DISPLACEMENT, POSITIVE] = 10e-6
    pitch: Annotated[float, DISPLACEMENT, POSITIVE] = 1e-6
    lines: Annotated[int, Bound(low=1.0, high=1e5)] = 6
    speed: Annotated[float, SPEED, POSITIVE] = 0.1e-3
    acceleration: Annotated[float, ACCELERATION, POSITIVE] = 5e-3
    fast: Axis = Axis.X
    slow: Axis = Axis.Y


@dataclass(frozen=True)
class SpiralMotion(CheckedFields):
    """Spiral from the centre to `radius`, with `pitch` between turns, at constant `speed`, in the plane of `first` and `second`.

    For rotations a metre represents a radian.
    """

    TOLD_BY: ClassVar[tuple[str, str]] = ("kind", "spiral")

    radius: Annotated[float, DISPLACEMENT, POSITIVE] = 5e-6
    pitch: Annotated[float, DISPLACEMENT, POSITIVE] = 1e-6
    speed: Annotated[float, SPEED, POSITIVE] = 0.1e-3
    first: Axis = Axis.X
    second: Axis = Axis.Y


@dataclass(frozen=True)
class SineMotion(CheckedFields):
    """Sine of every specified motion at `frequency`, simultaneously, for `periods`; default: 1 um in the first one."""

    TOLD_BY: ClassVar[tuple[str, str]] = ("kind", "sine")

    frequency: Annotated[float, FREQUENCY, POSITIVE] = 5.0
    periods: Annotated[float, RATIO, POSITIVE] = 3.0
    amplitude: AxisAmplitudes = field(default_factory=AxisAmplitudes)


@dataclass(frozen=True)
class FileMotion(CheckedFields):
    """Table of times and poses in a `file` (CSV): a first column `time [s]`, and motions with units, e.g. `x [um]`, `rz [urad]`."""

    TOLD_BY: ClassVar[tuple[str, str]] = ("kind", "file")

    file: str


TrajectorySetup: TypeAlias = StepMotion | RasterMotion | SpiralMotion | SineMotion | FileMotion


@dataclass(frozen=True)
class LoopSetup(CheckedFields):
    """Loop set-up: plant `model`, sampling `rate`, output `delay`, and all other parts.

    The default rate is 10 kHz, or ten times the highest platform mode for faster stages; the default delay is one sample. `modes` is the
    number retained, lowest first (default: the significant ones), with the static compliance of the others. The simulation lasts `seconds`
    (default: the trajectory, and settling); `seed` determines its random numbers.

    >>> LoopSetup().controller.law.value
    'pi'
    """

    model: Model = Model.LUMPED
    rate: Annotated[float, FREQUENCY, POSITIVE] | None = None
    delay: Annotated[float, TIME, NOT_NEGATIVE] | None = None
    modes: Annotated[int, Bound(low=1.0)] | None = None
    seconds: Annotated[float, TIME, POSITIVE] | None = None
    seed: Annotated[int, NOT_NEGATIVE] = 0
    compensate: tuple[Compensation, ...] = (Compensation.LOST_MOTION,)
    amplifier: Annotated[AmplifierForm, AMPLIFIERS] = field(default_factory=AmplifierSetup)
    gauges: GaugeSetup = field(default_factory=GaugeSetup)
    floor: Floor = field(default_factory=Floor)
    controller: ControllerSetup = field(default_factory=ControllerSetup)
    damping: DampingSetup | None = None
    hysteresis: HystereticStacks | None = None
    trajectory: TrajectorySetup = field(default_factory=StepMotion)
    follow: FollowSetup | None = None

    def to_json(self) -> dict[str, Any]:
        """Return the keys of the set-up file with plain values in SI."""
        kind, word = self.trajectory.TOLD_BY
        chosen = {"amplifier": {"kind": self.amplifier.kind, **asdict(self.amplifier)}}  # type: ignore[call-overload]
        return asdict(self) | chosen | {"trajectory": {kind: word, **asdict(self.trajectory)}}
