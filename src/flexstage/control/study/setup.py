"""Set-up of a loop, with the keys of its file: sampling, amplifier, gauges, floor, controller, compensation, trajectory.

The file reader and the JSON schema are generated from the annotations of the fields.
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
from flexstage.control.study.hardware.amplifiers import AmplifierForm, AmplifierSetup, Frequency
from flexstage.control.tuning.objective import TuningObjective
from flexstage.mechanism.grammar.node import ChoiceNode
from flexstage.models.theory import Model

Length: TypeAlias = Annotated[float, DISPLACEMENT, POSITIVE]
Speed: TypeAlias = Annotated[float, SPEED, POSITIVE]
Ratio: TypeAlias = Annotated[float, RATIO, POSITIVE]
Duration: TypeAlias = Annotated[float, TIME, POSITIVE]
Time: TypeAlias = Annotated[float, TIME, NOT_NEGATIVE]
_PEAK = Bound(low=1.0, open_low=True)
_SHARE = Bound(low=0.0, high=0.5, open_low=True)
_OVER, _SPREAD = Bound(low=0.02, high=1.0), Bound(low=0.0, high=0.3)
_DAMPED, _SWINGING = Bound(low=0.0, high=1.0, open_low=True), Bound(low=0.0, high=1.0, open_high=True)
_CREEP = Bound(low=-0.2, high=0.2)


@dataclass(frozen=True)
class KindNode(ChoiceNode):
    """Kinds of controllers: the members of `ControllerKind`, and the entries of `CONTROLLERS`, to which other packages add kinds."""

    @property
    def words(self) -> dict[str, Any]:
        """Kinds by name, as in files."""
        return {each.value: each for each in ControllerKind} | {name: OfferedKind(name) for name in CONTROLLERS}


KINDS = KindNode(ControllerKind)
"""Kinds of controllers by name, as in files and options."""
GAINS = ("proportional", "integral", "derivative")
"""Keys of the gains of a control law."""


@dataclass(frozen=True)
class AxisAmplitudes(CheckedFields):
    """Amplitudes of the platform coordinates. If any amplitude is specified, unspecified amplitudes are zero."""

    x: Annotated[float, DISPLACEMENT] | None = None
    y: Annotated[float, DISPLACEMENT] | None = None
    z: Annotated[float, DISPLACEMENT] | None = None
    rx: Annotated[float, ANGLE] | None = None
    ry: Annotated[float, ANGLE] | None = None
    rz: Annotated[float, ANGLE] | None = None


@dataclass(frozen=True)
class GaugeSetup(CheckedFields):
    """Gauges: amplitude density of white `noise`, quantisation step `resolution`, and `bandwidth`. Defaults: the values in the design.

    `filter_order` and `filter_corner` describe an analogue low-pass filter (Butterworth) before the sampler (order 0: no filter).
    """

    noise: Annotated[float, NOISE_DENSITY, NOT_NEGATIVE] | None = None
    resolution: Annotated[float, DISPLACEMENT, NOT_NEGATIVE] | None = None
    bandwidth: Frequency | None = None
    filter_order: Annotated[int, Bound(low=0.0, high=20.0)] = 0
    filter_corner: Frequency | None = None


@dataclass(frozen=True)
class VibrationSetup(CheckedFields):
    """Floor vibration along one axis: a named `criterion`, or amplitude densities of `acceleration`, `velocity` or `displacement`.

    A single density means white noise. Between several `frequencies`, each with a density, the logarithm of the density is linear in the
    logarithm of the frequency. Outside these frequencies, the density is zero.
    """

    criterion: Criterion | None = None
    frequencies: tuple[Frequency, ...] = ()
    acceleration: tuple[Annotated[float, ACCELERATION_NOISE, NOT_NEGATIVE], ...] = ()
    velocity: tuple[Annotated[float, VELOCITY_NOISE, NOT_NEGATIVE], ...] = ()
    displacement: tuple[Annotated[float, NOISE_DENSITY, NOT_NEGATIVE], ...] = ()


@dataclass(frozen=True)
class Floor(CheckedFields):
    """Floor vibration along each axis. Default: no vibration."""

    x: VibrationSetup | None = None
    y: VibrationSetup | None = None
    z: VibrationSetup | None = None


@dataclass(frozen=True)
class NotchSetup(CheckedFields):
    """Notch filter: `frequency`, `depth` (gain at that frequency), and `damping` of its poles, which sets the width."""

    frequency: Frequency
    depth: Annotated[float, RATIO, NOT_NEGATIVE] | None = None
    damping: Ratio | None = None


@dataclass(frozen=True)
class PrefilterSetup(CheckedFields):
    """Second-order low-pass prefilter of the reference, with `frequency` and `damping`; its gain falls less steeply above `lead`."""

    frequency: Frequency
    damping: Ratio = 1.0
    lead: Frequency | None = None


@dataclass(frozen=True)
class LoopNumbers(CheckedFields):
    """Parameters of the loops that `axes` lists by name.

    The names of the loops are x, rz etc. in platform coordinates, mode1 etc. in modal coordinates, and the names of actuators in actuator
    coordinates. Unspecified parameters have the common values of all loops; `notches` are added to the common notches.
    """

    axes: tuple[str, ...]
    proportional: Annotated[float, RATIO] | None = None
    integral: Annotated[float, RATE, NOT_NEGATIVE] | None = None
    derivative: Time | None = None
    filter: Frequency | None = None
    notches: tuple[NotchSetup, ...] = ()
    prefilter: PrefilterSetup | None = None


@dataclass(frozen=True)
class GoalSetup(CheckedFields):
    """Specification of optimisation-based tuning: its `objective`, and limits for every loop.

    The limits are the lowest permitted sensitivity crossover `rejection`, the longest 2 % settling time `settling`, the largest `overshoot`
    of a step response and the smallest `delay_margin`. By default, only the overshoot is limited. The limit on the peak of the sensitivity
    applies to all relative mode shifts up to `spread` and relative gain errors up to `gain`. With `prefilter`, a prefilter of the reference
    is also optimised.
    """

    objective: TuningObjective = TuningObjective.BALANCE
    rejection: Frequency | None = None
    settling: Duration | None = None
    overshoot: Annotated[float, RATIO, _OVER] = 0.2
    delay_margin: Duration | None = None
    spread: Annotated[float, RATIO, _SPREAD] = 0.02
    gain: Annotated[float, RATIO, _SPREAD] = 0.0
    prefilter: bool = False


@dataclass(frozen=True)
class ControllerSetup(CheckedFields):
    """Controller: its `kind`, the coordinates of its loops, and either a specification for tuning or specified gains.

    The default kind is PI; for force-driven stages without specified gains it is PID. The specification consists of `sensitivity`, the
    highest permitted peak of the sensitivity, and of `bandwidth`, the gain crossover (default: the highest that `sensitivity` allows). The
    gains `proportional`, `integral` and `derivative`, with the corner `filter` of the derivative, apply to all loops; `loops` override them
    for single loops. `notches` are added to the automatic notches. `prefilter` filters the reference.

    By default, PI and PID are optimised for the objective `balance` (see `goal`), with a peak of the sensitivity of at most `sensitivity`.
    This default optimisation is disabled by `quick`, by a specified bandwidth, gain or notch, and by `notching` none.
    """

    kind: Annotated[ControllerKind | OfferedKind, KINDS] | None = None
    coordinates: Axes = Axes.PLATFORM
    bandwidth: Frequency | None = None
    sensitivity: Annotated[float, RATIO, _PEAK] | None = None
    proportional: Annotated[float, RATIO] | None = None
    integral: Annotated[float, RATE, NOT_NEGATIVE] | None = None
    derivative: Time | None = None
    filter: Frequency | None = None
    notching: Notching = Notching.AUTOMATIC
    notches: tuple[NotchSetup, ...] = ()
    loops: tuple[LoopNumbers, ...] = ()
    prefilter: PrefilterSetup | None = None
    goal: GoalSetup | None = None
    quick: bool = False

    @property
    def search_goal(self) -> GoalSetup | None:
        """Goal of the optimisation, specified or by default; `None` if the controller is not optimised."""
        plain = self.quick or self.stated or self.bandwidth is not None or self.notches or self.notching is Notching.NONE
        return self.goal if self.goal is not None or plain or self.law not in SEARCHED_BY_DEFAULT else GoalSetup()

    @property
    def stated(self) -> tuple[str, ...]:
        """Names of the gains specified for all loops or for single loops. If any gain is specified, the controller is not tuned."""
        return tuple(name for name in GAINS if any(getattr(each, name) is not None for each in (self, *self.loops)))

    @property
    def law(self) -> ControllerKind | OfferedKind:
        """Kind of controller, PI by default."""
        return self.kind or ControllerKind.PI


@dataclass(frozen=True)
class DampingSetup(CheckedFields):
    """Integral force feedback in the legs, inside the pose loop: each stack extends at a rate proportional to its leg's tension.

    `ratio` is the required damping ratio of the modes with the largest residues; `gain` specifies the feedback directly. `corner` is the
    corner of a high-pass filter (default: a tenth of the lowest frequency that these modes have without the stacks' stiffness). A filter of
    `order` 2 preserves the static stiffness of a leg; order 1 multiplies it by a / (a + `gain`), where a is 2 pi times `corner`. The
    tension is measured by a force sensor in each leg, with white `noise`, or by strain `gauges` on links of the legs. The design specifies
    noise and bandwidth of the strain gauges. `lag` and `delay` describe the electronics of analogue feedback. With `rate`, an integer
    multiple of the loop's sampling rate, a computer runs the feedback; the default `delay` is then one sample of this rate.
    """

    ratio: Annotated[float, RATIO, _DAMPED] | None = None
    gain: Annotated[float, RATE, POSITIVE] | None = None
    corner: Frequency | None = None
    order: Annotated[int, Bound(low=1.0, high=2.0)] = 2
    gauges: tuple[str, ...] = ()
    noise: Annotated[float, FORCE_NOISE, NOT_NEGATIVE] | None = None
    lag: Frequency | None = None
    delay: Time | None = None
    rate: Frequency | None = None


@dataclass(frozen=True)
class FollowSetup(CheckedFields):
    """Tracking method for a trajectory known in advance; the error is the difference of the motion and the trajectory.

    There are four kinds of `method`. The first is the inverse of the modelled loop. The second is iterative learning, with `passes` and
    `gain`. The third is repetitive control of a periodic path (raster or sine), with `gain`. These three act only at frequencies where they
    tolerate relative mode shifts up to `spread`. The fourth is an input shaper for a mode with this `frequency` and `damping` ratio.
    """

    method: Following
    passes: Annotated[int, Bound(low=1.0, high=50.0)] = 10
    gain: Annotated[float, RATIO, _DAMPED] = 0.6
    spread: Annotated[float, RATIO, _SPREAD] = 0.02
    frequency: Frequency | None = None
    damping: Annotated[float, RATIO, _SWINGING] = 0.0


@dataclass(frozen=True)
class HystereticStacks(CheckedFields):
    """Hysteresis of the stacks: a model in a `file` from `flexstage hysteresis`, or only the loop's `width` as a fraction of the stroke.

    The model is scaled to the stroke and voltage of each stack. The compensation of hysteresis is the inverse of this model. `plant`
    selects the simulated stacks: the model itself, or Bouc-Wen stacks of equal width. The inverse does not cancel the hysteresis of
    Bouc-Wen stacks exactly. The default of `plant` is the model if a `file` is specified, and Bouc-Wen if a `width` is specified. `creep`
    is the creep per decade of time after 0.1 s, as a fraction of the stroke (default: the creep in the file).
    """

    file: str | None = None
    width: Annotated[float, RATIO, _SHARE] | None = None
    plant: StackKind | None = None
    creep: Annotated[float, RATIO, _CREEP] | None = None


class MotionSetup(CheckedFields):
    """Trajectory of a set-up file; `TOLD_BY` is the key and the word that select its kind."""

    TOLD_BY: ClassVar[tuple[str, str]]


@dataclass(frozen=True)
class StepMotion(MotionSetup):
    """Steps of the specified coordinates, one after the other. Default: steps of all coordinates of the stage, by 1 um or 10 urad.

    `speed`, `acceleration` and `jerk` together replace the step by a motion profile within these limits. In the limits of a rotation, 1 m
    is used for 1 rad.
    """

    TOLD_BY = ("kind", "step")

    amplitude: AxisAmplitudes = field(default_factory=AxisAmplitudes)
    speed: Speed | None = None
    acceleration: Annotated[float, ACCELERATION, POSITIVE] | None = None
    jerk: Annotated[float, JERK, POSITIVE] | None = None


@dataclass(frozen=True)
class RasterMotion(MotionSetup):
    """Raster scan: number of `lines`, their `length` and spacing `pitch`, constant `speed` on the lines, and `acceleration` in reversals.

    The lines are along the axis `fast`, the pitch along `slow`. For rotations, 1 m is used for 1 rad: a length of 20 um along rx is a
    rotation of 20 urad.
    """

    TOLD_BY = ("kind", "raster")

    length: Length = 10e-6
    pitch: Length = 1e-6
    lines: Annotated[int, Bound(low=1.0, high=1e5)] = 6
    speed: Speed = 0.1e-3
    acceleration: Annotated[float, ACCELERATION, POSITIVE] = 5e-3
    fast: Axis = Axis.X
    slow: Axis = Axis.Y


@dataclass(frozen=True)
class SpiralMotion(MotionSetup):
    """Spiral from the centre to `radius`, turns a `pitch` apart, at constant `speed`, in the plane of `first` and `second`.

    If `first` or `second` is a rotation, 1 m is used for 1 rad.
    """

    TOLD_BY = ("kind", "spiral")

    radius: Length = 5e-6
    pitch: Length = 1e-6
    speed: Speed = 0.1e-3
    first: Axis = Axis.X
    second: Axis = Axis.Y


@dataclass(frozen=True)
class SineMotion(MotionSetup):
    """Simultaneous sines of all specified coordinates at `frequency`, for a number of `periods`.

    By default, only the stage's first coordinate moves, with an amplitude of 1 um (10 urad for a rotation).
    """

    TOLD_BY = ("kind", "sine")

    frequency: Frequency = 5.0
    periods: Ratio = 3.0
    amplitude: AxisAmplitudes = field(default_factory=AxisAmplitudes)


@dataclass(frozen=True)
class FileMotion(MotionSetup):
    """Trajectory in a CSV `file`: a first column `time [s]`, then coordinates with units, such as `x [um]` and `rz [urad]`."""

    TOLD_BY = ("kind", "file")

    file: str


TrajectorySetup: TypeAlias = StepMotion | RasterMotion | SpiralMotion | SineMotion | FileMotion


@dataclass(frozen=True)
class LoopSetup(CheckedFields):
    """Set-up of a control loop: plant `model`, sampling `rate`, output `delay`, and one table of keys for each component.

    The default rate is 10 kHz, or ten times the highest platform mode for faster stages; the default delay is one sample. `modes` is the
    number of retained modes, lowest first (default: all significant modes); the static compliance of other modes is kept. The simulation
    lasts `seconds` (default: the duration of the trajectory plus a time for settling). `seed` determines the random numbers of the
    simulation.

    >>> LoopSetup().controller.law.value
    'pi'
    """

    model: Model = Model.LUMPED
    rate: Frequency | None = None
    delay: Time | None = None
    modes: Annotated[int, Bound(low=1.0)] | None = None
    seconds: Duration | None = None
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
        """Return the keys of the set-up file with plain values in SI units."""
        kind, word = self.trajectory.TOLD_BY
        chosen = {"amplifier": {"kind": self.amplifier.kind, **asdict(self.amplifier)}}  # type: ignore[call-overload]
        return asdict(self) | chosen | {"trajectory": {kind: word, **asdict(self.trajectory)}}
