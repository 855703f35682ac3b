"""Choices of a loop's set-up, in a module without slow imports, for the command line."""

from __future__ import annotations

from enum import Enum


class ControllerKind(Enum):
    """Kind of controller."""

    PI = "pi"
    """Proportional and integral control."""
    PID = "pid"
    """Proportional, integral and filtered derivative control."""
    RESONANT = "resonant"
    """Integral resonant control: an inner positive feedback damps the modes, an outer loop integrates the error."""
    LQG = "lqg"
    """Linear-quadratic regulator with a Kalman filter and integrators."""
    NONE = "none"
    """Open loop."""


SEARCHED_BY_DEFAULT = (ControllerKind.PI, ControllerKind.PID)
"""Kinds that are optimised if no goal is specified. LQG is excluded, because its optimisation takes minutes."""
SEARCHED = (*SEARCHED_BY_DEFAULT, ControllerKind.LQG)
"""Kinds with optimisation-based tuning; all other kinds are tuned to the highest bandwidth."""


class OfferedKind(str):
    """Name of a controller kind in `CONTROLLERS` that is not in `ControllerKind`."""

    __slots__ = ()

    @property
    def value(self) -> str:
        """Name of the kind."""
        return str(self)


class Axes(Enum):
    """Choice of loops: one loop for each actuator, platform motion or mode."""

    ACTUATOR = "actuator"
    """One loop for each actuator, for the platform's error in actuator coordinates."""
    PLATFORM = "platform"
    """One loop for each motion of the platform."""
    MODAL = "modal"
    """One loop for each mode of the platform."""


class Notching(Enum):
    """Automatic placement of notch filters."""

    AUTOMATIC = "automatic"
    """Notch filters on the modes that need them."""
    NONE = "none"
    """Only the specified notch filters."""


class Compensation(Enum):
    """Feedforward to the actuators."""

    LOST_MOTION = "lost-motion"
    """Strokes corrected for lost motion, with gains of the lost-motion analysis."""
    LOAD = "load"
    """Strokes that balance payloads and own weight."""
    REFERENCE = "reference"
    """The commanded trajectory; the controller corrects the residual error."""
    HYSTERESIS = "hysteresis"
    """The inverse model of the stacks' hysteresis."""


class Following(Enum):
    """Tracking method for a known path."""

    INVERSE = "inverse"
    """Inverse of the modelled loop, applied to the path."""
    LEARNING = "learning"
    """Iterative learning from previous passes."""
    REPETITIVE = "repetitive"
    """Repetitive control, learning from previous periods during the run."""
    ZV = "zv"
    """Zero-vibration shaper for one mode."""
    ZVD = "zvd"
    """Zero-vibration-derivative shaper, less sensitive to errors of the mode's frequency."""


class StackKind(Enum):
    """Behaviour of hysteretic stacks."""

    MODEL = "model"
    """The hysteresis model that is also inverted."""
    BOUC_WEN = "bouc-wen"
    """Bouc-Wen stacks with the same loop width, which differ from the inverted model."""


class Axis(Enum):
    """Axis of rasters and spirals."""

    X = "x"
    """Along x."""
    Y = "y"
    """Along y."""
    Z = "z"
    """Along z."""
    RX = "rx"
    """About x."""
    RY = "ry"
    """About y."""
    RZ = "rz"
    """About z."""


class Criterion(Enum):
    """Generic vibration criterion: limit of the floor's rms velocity in every third-octave band."""

    WORKSHOP = "ISO workshop"
    """800 um/s."""
    OFFICE = "ISO office"
    """400 um/s."""
    RESIDENTIAL = "ISO residential day"
    """200 um/s."""
    THEATRE = "ISO operating theatre"
    """100 um/s."""
    VC_A = "VC-A"
    """50 um/s."""
    VC_B = "VC-B"
    """25 um/s."""
    VC_C = "VC-C"
    """12.5 um/s."""
    VC_D = "VC-D"
    """6.25 um/s."""
    VC_E = "VC-E"
    """3.12 um/s."""
    VC_F = "VC-F"
    """1.56 um/s."""
    VC_G = "VC-G"
    """0.78 um/s."""
