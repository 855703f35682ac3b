"""The words of a loop's set-up. Light: the command line names the choices without loading more."""

from __future__ import annotations

from enum import Enum


class ControllerKind(Enum):
    """What closes the loop."""

    PI = "pi"
    """Proportional and integral."""
    PID = "pid"
    """The same with a filtered derivative."""
    RESONANT = "resonant"
    """Integral resonant control: positive feedback that damps the modes, an integrator around it."""
    LQG = "lqg"
    """Linear-quadratic regulator with a Kalman filter and integrators."""
    NONE = "none"
    """Nothing: the stage is commanded in open loop."""


SEARCHED = (ControllerKind.PI, ControllerKind.PID, ControllerKind.LQG)
"""Kinds that a goal searches for; the others are tuned to the highest bandwidth."""


class OfferedKind(str):
    """A kind of controller that stands in `CONTROLLERS` and not among the words above, by its name there."""

    __slots__ = ()

    @property
    def value(self) -> str:
        """Its name."""
        return str(self)


class Axes(Enum):
    """Coordinates in which single loops are closed."""

    ACTUATOR = "actuator"
    """One loop for each actuator: what the platform's error asks of it."""
    PLATFORM = "platform"
    """One loop for each motion of the platform."""
    MODAL = "modal"
    """One loop for each mode of the platform."""


class Notching(Enum):
    """Which resonances notch filters are placed on."""

    AUTOMATIC = "automatic"
    """On the modes that the loop needs them for."""
    NONE = "none"
    """On none but those stated."""


class Compensation(Enum):
    """What is fed forward to the actuators."""

    LOST_MOTION = "lost-motion"
    """Commands corrected by the gains of the lost-motion analysis."""
    LOAD = "load"
    """The strokes that hold up payloads and own weight."""
    REFERENCE = "reference"
    """The commanded trajectory itself; the controller sees what is left."""
    HYSTERESIS = "hysteresis"
    """The inverse of the stacks' hysteresis."""


class Following(Enum):
    """What is commanded along a known path."""

    INVERSE = "inverse"
    """The path through the inverse of the model's loop."""
    LEARNING = "learning"
    """What passes over it have taught."""
    REPETITIVE = "repetitive"
    """What the periods before have taught, as it runs."""
    ZV = "zv"
    """The path through a shaper that leaves a mode at rest."""
    ZVD = "zvd"
    """The same, less sensitive to the mode's frequency."""


class StackKind(Enum):
    """How hysteretic stacks behave."""

    MODEL = "model"
    """As the model of their hysteresis says, to the end."""
    BOUC_WEN = "bouc-wen"
    """As Bouc-Wen stacks of the same width: of another kind than what is inverted."""


class Axis(Enum):
    """A motion of the platform that rasters and spirals go along."""

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
    """Generic vibration criteria: rms velocity of the floor in every third-octave band."""

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
