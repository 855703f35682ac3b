"""How a loop is set up: clock, amplifier, gauges, floor, controller, compensation, trajectory. The form of a set-up file.

Every field carries its quantity: that alone makes the file's reader and its schema.
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
from flexstage.control.study.choices import Axes, Axis, Compensation, ControllerKind, Criterion, Following, Notching, OfferedKind, StackKind
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
    """A kind of controller: those that stand here, and those of `CONTROLLERS`, which other packages add to."""

    @property
    def words(self) -> dict[str, Any]:
        """The kinds by what a file calls them."""
        return {each.value: each for each in ControllerKind} | {name: OfferedKind(name) for name in CONTROLLERS}


KINDS = KindNode(ControllerKind)
"""Kinds of controllers as files and options name them."""
GAINS = ("proportional", "integral", "derivative")
"""Keys of a law's gains."""


@dataclass(frozen=True)
class AxisAmplitudes(CheckedFields):
    """Amounts by motion of the platform; absent: none."""

    x: Annotated[float, DISPLACEMENT] | None = None
    y: Annotated[float, DISPLACEMENT] | None = None
    z: Annotated[float, DISPLACEMENT] | None = None
    rx: Annotated[float, ANGLE] | None = None
    ry: Annotated[float, ANGLE] | None = None
    rz: Annotated[float, ANGLE] | None = None


@dataclass(frozen=True)
class GaugeSetup(CheckedFields):
    """Gauges: white `noise`, steps of `resolution`, `bandwidth`; absent: what each gauge of the design states.

    `filter_order` and `filter_corner` are those of an analogue low-pass (Butterworth) before sampling (order 0: none).
    """

    noise: Annotated[float, NOISE_DENSITY, NOT_NEGATIVE] | None = None
    resolution: Annotated[float, DISPLACEMENT, NOT_NEGATIVE] | None = None
    bandwidth: Annotated[float, FREQUENCY, POSITIVE] | None = None
    filter_order: Annotated[int, Bound(low=0.0, high=20.0)] = 0
    filter_corner: Annotated[float, FREQUENCY, POSITIVE] | None = None


@dataclass(frozen=True)
class VibrationSetup(CheckedFields):
    """The floor along one axis: a `criterion` by name, or an amplitude density of `acceleration`, `velocity` or `displacement`.

    One density alone is white; with `frequencies`, as many as there are densities, straight between them in log-log and none outside.
    """

    criterion: Criterion | None = None
    frequencies: tuple[Annotated[float, FREQUENCY, POSITIVE], ...] = ()
    acceleration: tuple[Annotated[float, ACCELERATION_NOISE, NOT_NEGATIVE], ...] = ()
    velocity: tuple[Annotated[float, VELOCITY_NOISE, NOT_NEGATIVE], ...] = ()
    displacement: tuple[Annotated[float, NOISE_DENSITY, NOT_NEGATIVE], ...] = ()


@dataclass(frozen=True)
class Floor(CheckedFields):
    """The floor's vibration by axis; absent: it stands still."""

    x: VibrationSetup | None = None
    y: VibrationSetup | None = None
    z: VibrationSetup | None = None


@dataclass(frozen=True)
class NotchSetup(CheckedFields):
    """A notch filter: at which `frequency`, how `deep` (gain there), how wide (`damping` of its poles)."""

    frequency: Annotated[float, FREQUENCY, POSITIVE]
    depth: Annotated[float, RATIO, NOT_NEGATIVE] | None = None
    damping: Annotated[float, RATIO, POSITIVE] | None = None


@dataclass(frozen=True)
class PrefilterSetup(CheckedFields):
    """A prefilter of the reference: a low-pass of second order at a `frequency` with a `damping`, and a `lead` above it."""

    frequency: Annotated[float, FREQUENCY, POSITIVE]
    damping: Annotated[float, RATIO, POSITIVE] = 1.0
    lead: Annotated[float, FREQUENCY, POSITIVE] | None = None


@dataclass(frozen=True)
class LoopNumbers(CheckedFields):
    """The numbers of some of the loops, `axes` names them: x, rz ..., in other coordinates mode1 or the actuator's name.

    What is absent is that of all loops; `notches` are besides theirs.
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
    """What a search for the controller is after: its `objective`, and what every loop shall keep.

    `rejection` is the least frequency up to which disturbances are made smaller, `settling` the longest time to 2 % of a step, `overshoot`
    the most of it, `delay_margin` the least; absent: as good as it gets. The peak of S holds with all modes up to `spread` and all gains up
    to `gain` off. With `prefilter` what is commanded is shaped too.
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
    """The controller: its `kind`, in which coordinates, and either what it shall reach or its numbers.

    Without a kind it is PI, where forces drive the stage PID (unless numbers are given). What it shall reach: `bandwidth` (where the open
    loop's gain passes 1; absent: the highest that `sensitivity` allows) and `sensitivity`, the highest peak of S. Its numbers:
    `proportional` (strokes or motion per error), `integral` rate, `derivative` time and its `filter` corner, of all loops; `loops` state
    those of single ones. `notches` besides those placed by themselves. `prefilter` shapes what is commanded. With
    a `goal` laws and notches are searched for instead, within `sensitivity`.
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

    @property
    def stated(self) -> tuple[str, ...]:
        """Gains that are stated, of all loops or of single ones: what is then not tuned."""
        return tuple(name for name in GAINS if any(getattr(each, name) is not None for each in (self, *self.loops)))

    @property
    def law(self) -> ControllerKind | OfferedKind:
        """Its kind, PI where none is stated."""
        return self.kind or ControllerKind.PI


@dataclass(frozen=True)
class DampingSetup(CheckedFields):
    """Integral force feedback in the legs, under the loop of the pose: each stack gives way at the rate of its leg's tension.

    `ratio` is the damping wanted of the modes that the loop feels most, or the `gain` is stated. `corner` of the high pass (absent: a tenth
    of the lowest of these modes without the stacks' stiffness) and its `order`: 2 keeps the stiffness at rest, 1 leaves a / (a + gain) of
    it. The tension is that of a sensor of force in each leg, of white `noise`, or of strain `gauges` on links of the legs, whose noise and
    bandwidth are theirs. `lag` and `delay` are those of the electronics, which are analogue; or a computer runs the law at a `rate`, a
    whole multiple of the loop's, and gives its strokes after `delay` (absent: one sample of that rate).
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
    """What the loop is asked to follow instead of the trajectory itself, which is known beforehand; the error is against the trajectory.

    `method`: the inverse of the model's loop, learning (so many `passes` of a `gain`) or repetitive control of that gain (of a path that
    repeats: a raster, a sine), all in the band that holds with all modes up to `spread` off; or a shaper for a mode at `frequency` of a
    `damping` ratio.
    """

    method: Following
    passes: Annotated[int, Bound(low=1.0, high=50.0)] = 10
    gain: Annotated[float, RATIO, _DAMPED] = 0.6
    spread: Annotated[float, RATIO, _SPREAD] = 0.02
    frequency: Annotated[float, FREQUENCY, POSITIVE] | None = None
    damping: Annotated[float, RATIO, _SWINGING] = 0.0


@dataclass(frozen=True)
class HystereticStacks(CheckedFields):
    """The stacks' hysteresis: a model in a `file`, as `flexstage hysteresis` writes it, or only the `width` of the loop per stroke.

    The model is scaled to each stack's stroke and voltage. It is what the inverse inverts; the stacks themselves behave as `plant` says:
    by the same model, or as Bouc-Wen stacks of the same width, which no such inverse can follow to the end (absent: the model of a
    file, Bouc-Wen where only the width is known). `creep`: by how much of its stroke a stack goes on in each decade of time, from 0.1 s
    on (absent: as the file says).
    """

    file: str | None = None
    width: Annotated[float, RATIO, _SHARE] | None = None
    plant: StackKind | None = None
    creep: Annotated[float, RATIO, _CREEP] | None = None


@dataclass(frozen=True)
class StepMotion(CheckedFields):
    """A step of every stated motion, each by itself; without any: 1 um and 10 urad, of all motions that the stage has.

    With `speed`, `acceleration` and `jerk`, all three, it is a move within them: along the way, in m; of a move that only turns, a metre
    stands for a radian.
    """

    TOLD_BY: ClassVar[tuple[str, str]] = ("kind", "step")

    amplitude: AxisAmplitudes = field(default_factory=AxisAmplitudes)
    speed: Annotated[float, SPEED, POSITIVE] | None = None
    acceleration: Annotated[float, ACCELERATION, POSITIVE] | None = None
    jerk: Annotated[float, JERK, POSITIVE] | None = None


@dataclass(frozen=True)
class RasterMotion(CheckedFields):
    """`lines` of a `length`, `pitch` apart, to and fro at an even `speed`, turned around with `acceleration`; along `fast` and `slow`.

    Of a motion that turns, a metre stands for a radian: a line of 20 um along rx is one of 20 urad.
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
    """A spiral from the middle to `radius`, its turns `pitch` apart, at an even `speed`; in the plane of `first` and `second`.

    Of a motion that turns, a metre stands for a radian.
    """

    TOLD_BY: ClassVar[tuple[str, str]] = ("kind", "spiral")

    radius: Annotated[float, DISPLACEMENT, POSITIVE] = 5e-6
    pitch: Annotated[float, DISPLACEMENT, POSITIVE] = 1e-6
    speed: Annotated[float, SPEED, POSITIVE] = 0.1e-3
    first: Axis = Axis.X
    second: Axis = Axis.Y


@dataclass(frozen=True)
class SineMotion(CheckedFields):
    """A sine of every stated motion at `frequency`, all at once, for so many `periods`; without any motion: 1 um in the first one."""

    TOLD_BY: ClassVar[tuple[str, str]] = ("kind", "sine")

    frequency: Annotated[float, FREQUENCY, POSITIVE] = 5.0
    periods: Annotated[float, RATIO, POSITIVE] = 3.0
    amplitude: AxisAmplitudes = field(default_factory=AxisAmplitudes)


@dataclass(frozen=True)
class FileMotion(CheckedFields):
    """A table of times and poses in a `file` (CSV): a first column `time [s]`, and motions with units, as `x [um]`, `rz [urad]`."""

    TOLD_BY: ClassVar[tuple[str, str]] = ("kind", "file")

    file: str


TrajectorySetup: TypeAlias = StepMotion | RasterMotion | SpiralMotion | SineMotion | FileMotion


@dataclass(frozen=True)
class LoopSetup(CheckedFields):
    """A loop: by which `model` the stage is the plant, sampled at `rate`, its outputs `delay` late, and all that belongs to it.

    Without a rate it is 10 kHz, or for faster stages ten times the highest platform mode; without a delay it is one sample. `modes` is
    how many are retained, lowest first (absent: those that matter), the others' compliance stays. The simulation lasts `seconds`
    (absent: as long as the trajectory, and until the loop has settled), its random numbers are those of `seed`.

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
        """The keys of its file with plain values, SI."""
        kind, word = self.trajectory.TOLD_BY
        chosen = {"amplifier": {"kind": self.amplifier.kind, **asdict(self.amplifier)}}  # type: ignore[call-overload]
        return asdict(self) | chosen | {"trajectory": {kind: word, **asdict(self.trajectory)}}
