"""Options of the command `loop` that stand for keys of its set-up file: read together, told together."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TypeAlias, TypeVar

import typer

from flexstage.apps.cli.choice import choice, choices
from flexstage.base.finding import DesignError, Finding, nearest, require
from flexstage.studies.loop.choices import Axes, Compensation, ControllerKind, Criterion
from flexstage.studies.reading import Reading

if TYPE_CHECKING:
    from flexstage.base.quantity import Quantity
    from flexstage.studies.loop.setup import Commanded, Controlling, Floor, Gauging, HystereticStacks, LoopSetup, Shaking

_Value = TypeVar("_Value")
_NOTHING = "none"


def _text(name: str, metavar: str, about: str) -> Any:
    return typer.Option(name, metavar=metavar, help=about, show_default=False)


def _choice(name: str, among: type[Enum], about: str) -> Any:
    return typer.Option(name, parser=choice(name, among), metavar=choices(among), help=about, show_default=False)


Setup: TypeAlias = Annotated[Path | None, _text("--setup", "LOOP.TOML", "Set-up file; options on the line go before it.")]
Rate: TypeAlias = Annotated[str | None, _text("--rate", "VALUE", "Sampling rate. Default: 10 kHz, or 10 times the highest platform mode.")]
Delay: TypeAlias = Annotated[str | None, _text("--delay", "VALUE", "From sampling to the new output. Default: one sample.")]
Kind: TypeAlias = Annotated[
    ControllerKind | None,
    _choice("--controller", ControllerKind, "What closes the loop; none: open loop. Default: pi."),
]
Coordinates: TypeAlias = Annotated[
    Axes | None,
    _choice("--coordinates", Axes, "In which coordinates single loops are closed. Default: platform."),
]
Bandwidth: TypeAlias = Annotated[
    str | None, _text("--bandwidth", "VALUE", "Bandwidth to tune to. Default: the highest that the margin allows.")
]
Sensitivity: TypeAlias = Annotated[str | None, _text("--sensitivity", "NUMBER", "Highest peak of the sensitivity S that tuning allows.")]
Compensate: TypeAlias = Annotated[
    list[str] | None,
    _text(
        "--compensate",
        "NAME",
        f"{', '.join(each.value for each in Compensation)}, or none; several times. Default: lost-motion.",
    ),
]
Hysteresis: TypeAlias = Annotated[
    str | None, _text("--hysteresis", "FILE|SHARE", "Hysteresis of the stacks: a model's file, or its width, e.g. 15%. Default: none.")
]
FloorNoise: TypeAlias = Annotated[
    list[str] | None,
    _text("--floor", "[AXIS=]VALUE", 'Vibration of the floor: VC-D, z=VC-C, "x=3 um/s^2/Hz^0.5"; several times. Default: none.'),
]
GaugeNoise: TypeAlias = Annotated[
    str | None, _text("--gauge-noise", "DENSITY", 'Noise of the gauges, e.g. "0.1 nm/Hz^0.5". Default: what the design states.')
]
Resolution: TypeAlias = Annotated[str | None, _text("--resolution", "VALUE", "Steps of the gauges; 0nm: none. Default: the design's.")]
Amplifier: TypeAlias = Annotated[
    list[str] | None,
    _text("--amplifier", "VALUE", "Bandwidth (500Hz) or output resistance (50ohm); largest current (0.2A). Default: ideal."),
]
Trajectory: TypeAlias = Annotated[
    str | None,
    _text(
        "--trajectory",
        "NAME|FILE",
        "step, raster, spiral or sine, or a CSV file of times and poses. Default: step.",
    ),
]
Moves: TypeAlias = Annotated[
    list[str] | None,
    _text("--command", "AXIS=VALUE", "Size of a step or sine, e.g. x=1um; several times. Default: 1 um and 10 urad of every motion."),
]
Seconds: TypeAlias = Annotated[float | None, _text("--seconds", "NUMBER", "Length of the simulation. Default: until all has settled.")]
Seed: TypeAlias = Annotated[int | None, _text("--seed", "NUMBER", "Seed of all random numbers. Default: 0.")]
ReadBy: TypeAlias = Annotated[
    Reading | None,
    _choice("--reading", Reading, "Theory to read the plant by. Default: lumped."),
]


@dataclass(frozen=True)
class Said:
    """What the options say, as texts of the command line; absent: what the file says."""

    file: Path | None
    reading: Reading | None
    rate: str | None
    delay: str | None
    kind: ControllerKind | None
    coordinates: Axes | None
    bandwidth: str | None
    sensitivity: str | None
    compensate: list[str] | None
    hysteresis: str | None
    floor: list[str] | None
    gauge_noise: str | None
    resolution: str | None
    amplifier: list[str] | None
    trajectory: str | None
    moves: list[str] | None
    seconds: float | None
    seed: int | None

    def setup(self) -> LoopSetup:
        """The set-up of file and options; raises `DesignError` with all that is wrong with either."""
        from flexstage.studies.loop.checks import setup_findings
        from flexstage.studies.loop.file import load_setup
        from flexstage.studies.loop.setup import LoopSetup

        texts = Texts()
        given = texts.tried(lambda: LoopSetup() if self.file is None else load_setup(self.file))
        found = self._over(LoopSetup() if given is None else given, texts)
        texts.findings += setup_findings(found)
        require(texts.findings)
        return found

    def _over(self, given: LoopSetup, texts: Texts) -> LoopSetup:
        from flexstage.base.quantity import FREQUENCY, TIME

        said = {
            "reading": self.reading,
            "rate": texts.value("--rate", self.rate, FREQUENCY),
            "delay": texts.value("--delay", self.delay, TIME),
            "seconds": self.seconds,
            "seed": self.seed,
            "compensate": texts.tried(lambda: _compensation(self.compensate)),
            "amplifier": _with(given.amplifier, texts.electric(self.amplifier)),
            "gauges": self._gauges(given, texts),
            "floor": texts.tried(lambda: _floor(given.floor, self.floor)),
            "controller": self._controller(given, texts),
            "hysteresis": _stacks(self.hysteresis),
            "trajectory": texts.tried(lambda: _trajectory(given.trajectory, self.trajectory, self.moves)),
        }
        return _with(given, said)

    def _gauges(self, given: LoopSetup, texts: Texts) -> Gauging:
        from flexstage.base.quantity import DISPLACEMENT, NOISE_DENSITY

        noise = texts.value("--gauge-noise", self.gauge_noise, NOISE_DENSITY)
        return _with(given.gauges, {"noise": noise, "resolution": texts.value("--resolution", self.resolution, DISPLACEMENT)})

    def _controller(self, given: LoopSetup, texts: Texts) -> Controlling:
        from flexstage.base.quantity import FREQUENCY, RATIO

        said = {
            "kind": self.kind,
            "coordinates": self.coordinates,
            "bandwidth": texts.value("--bandwidth", self.bandwidth, FREQUENCY),
            "sensitivity": texts.value("--sensitivity", self.sensitivity, RATIO),
        }
        return _with(given.controller, said)


class Texts:
    """Reads texts with units and gathers what is wrong with them."""

    def __init__(self) -> None:
        self.findings: list[Finding] = []

    def tried(self, action: Callable[[], _Value]) -> _Value | None:
        """What an action gives; nothing, and its findings noted, where it fails."""
        try:
            return action()
        except DesignError as error:
            self.findings += error.findings
            return None

    def value(self, option: str, text: str | None, quantity: Quantity) -> float | None:
        """The value of a text; nothing where it is absent or wrong."""
        from flexstage.base.unit import parse

        return None if text is None else self.tried(lambda: parse(text, quantity, where=option))

    def electric(self, texts: Sequence[str] | None) -> dict[str, float]:
        """What `--amplifier` says, each by its unit."""
        from flexstage.base.quantity import CURRENT, FREQUENCY, RESISTANCE

        known = {"bandwidth": FREQUENCY, "resistance": RESISTANCE, "current": CURRENT}
        found: dict[str, float] = {}
        for text in texts or ():
            if (pair := _first_fit(text, known)) is None:
                what = f'found "{text}", which is no frequency, resistance or current'
                self.findings.append(Finding("--amplifier", what, 'Write for example "500 Hz", "50 ohm" or "0.2 A"'))
            else:
                found[pair[0]] = pair[1]
        return found


def _first_fit(text: str, known: Mapping[str, Quantity]) -> tuple[str, float] | None:
    from flexstage.base.unit import parse

    for name, quantity in known.items():
        try:
            return name, parse(text, quantity)
        except DesignError:
            continue
    return None


def _with(record: _Value, said: Mapping[str, Any]) -> _Value:
    """The record with the values that were said."""
    return replace(record, **{name: value for name, value in said.items() if value is not None})  # type: ignore[type-var]


def _stacks(said: str | None) -> HystereticStacks | None:
    """A width where the text is a ratio, else a file."""
    from flexstage.base.quantity import RATIO
    from flexstage.studies.loop.setup import HystereticStacks

    if said is None:
        return None
    width = _first_fit(said, {"width": RATIO})
    return HystereticStacks(file=said) if width is None else HystereticStacks(width=width[1])


def _compensation(words: Sequence[str] | None) -> tuple[Compensation, ...] | None:
    if words is None:
        return None
    known = {each.value: each for each in Compensation}
    require(
        Finding(f"--compensate {word}", "this is nothing that is fed forward", f"It is one of {', '.join(known)}, or {_NOTHING} alone")
        for word in words
        if word not in known and (word != _NOTHING or len(words) > 1)
    )
    return tuple(known[word] for word in words if word in known)


def _floor(given: Floor, texts: Sequence[str] | None) -> Floor | None:
    if not texts:
        return None
    findings: list[Finding] = []
    found: dict[str, Shaking] = {}
    for text in texts:
        axis, sign, value = (part.strip() for part in text.rpartition("="))
        try:
            shaking = _shaking(text, value)
            found |= {each: shaking for each in ("x", "y", "z") if not sign or each == axis}
        except DesignError as error:
            findings += error.findings
        if sign and axis not in ("x", "y", "z"):
            findings.append(Finding(f"--floor {text}", f'"{axis}" is no axis of the floor', "Write x, y or z, or no axis for all three"))
    require(findings)
    return _with(given, found)


def _shaking(text: str, value: str) -> Shaking:
    from flexstage.base.finding import refuse
    from flexstage.base.quantity import ACCELERATION_NOISE, NOISE_DENSITY, VELOCITY_NOISE
    from flexstage.studies.loop.setup import Shaking

    for criterion in Criterion:
        if value == criterion.value:
            return Shaking(criterion=criterion)
    fit = _first_fit(value, {"acceleration": ACCELERATION_NOISE, "velocity": VELOCITY_NOISE, "displacement": NOISE_DENSITY})
    if fit is None:
        names = ", ".join(each.value for each in Criterion)
        advice = f'Write one of {names}, or an amplitude density, for example "3 um/s^2/Hz^0.5"'
        raise refuse(f"--floor {text}", f'"{value}" is no criterion and no amplitude density', advice)
    return _with(Shaking(), {fit[0]: (fit[1],)})


def _trajectory(given: Commanded, word: str | None, moves: Sequence[str] | None) -> Commanded | None:
    """The trajectory of that name, or of that file, with the sizes of its motions."""
    from flexstage.apps.cli.reach import motions_from
    from flexstage.base.finding import refuse
    from flexstage.studies.loop import setup

    found = given if word is None else _named(word, given)
    if moves is None:
        return found if word is not None else None
    if not isinstance(found, (setup.StepMotion, setup.SineMotion)):
        name = found.TOLD_BY[1]
        raise refuse("--command", f"a trajectory of kind {name} has its sizes in the set-up file", "Use it with step or sine")
    return replace(found, by=_with(setup.Motion(), motions_from(list(moves))))


def _named(word: str, given: Commanded) -> Commanded:
    """What the set-up says where it is of that kind already, else as the kind is usual; a file where the word is one."""
    from flexstage.base.finding import refuse
    from flexstage.studies.loop import setup

    usual = (setup.StepMotion(), setup.RasterMotion(), setup.SpiralMotion(), setup.SineMotion())
    kinds = {each.TOLD_BY[1]: each for each in usual}
    if word in kinds:
        return given if type(given) is type(kinds[word]) else kinds[word]
    if word.lower().endswith(".csv"):
        return setup.FileMotion(word)
    raise refuse("--trajectory", f'"{word}" is none of {", ".join(kinds)}, and no CSV file', nearest(word, kinds))
