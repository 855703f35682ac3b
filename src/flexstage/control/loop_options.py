"""Options of the command `loop` that override values of its set-up file."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum
from pathlib import Path
from typing import Annotated, Any, TypeAlias

import typer

from flexstage.base.finding import DesignError, Finding, refuse, require
from flexstage.base.units.quantity import ACCELERATION_NOISE, NOISE_DENSITY, RATIO, VELOCITY_NOISE
from flexstage.control.study.choices import Axes, Compensation, Criterion, Following
from flexstage.control.study.file import SetupChange, read_setup
from flexstage.control.study.setup import LoopSetup
from flexstage.control.tuning.objective import TuningObjective
from flexstage.models.theory import Model
from flexstage.show.command.options import (
    ELASTIC_MODEL,
    AmplifierValues,
    GaugeNoise,
    GaugeResolution,
    Seed,
    rate_option,
    text_option,
    word_option,
)
from flexstage.show.command.values import Values, amplifier_values, first_that_parses, motions

Setup: TypeAlias = Annotated[Path | None, text_option("--setup", "LOOP.TOML", "Set-up file of the loop.")]

_NOTHING, _AXES = "none", ("x", "y", "z")
_ADDRESSES = {
    "model": "model",
    "rate": "rate",
    "delay": "delay",
    "seed": "seed",
    "controller": "controller.kind",
    "coordinates": "controller.coordinates",
    "bandwidth": "controller.bandwidth",
    "tune_for": "controller.goal.objective",
    "max_sensitivity": "controller.sensitivity",
    "force_feedback": "damping.ratio",
    "tracking": "follow.method",
    "gauge_noise": "gauges.noise",
    "resolution": "gauges.resolution",
}
"""Options whose text is the value of a key of the set-up file."""
_UNITS = {"bandwidth": "Hz", "resistance": "ohm", "current": "A"}


@dataclass(frozen=True)
class LoopOptions:
    """Set-up of a loop, specified by options of a command."""

    setup: Setup = None
    controller: Annotated[
        str | None,
        text_option(
            "--controller",
            "KIND",
            "Kind of controller: pi, pid, resonant, ppf, pvf or lqg; none for an open loop. Default: pi, or pid for force-driven stages.",
        ),
    ] = None
    coordinates: Annotated[
        Axes | None,
        word_option(
            "--coordinates",
            Axes,
            "One loop for each actuator, platform motion or platform mode. Default: platform.",
            show_default=False,
        ),
    ] = None
    bandwidth: Annotated[
        str | None, text_option("--bandwidth", "VALUE", "Gain crossover for tuning without optimisation. Default: chosen by the tuning.")
    ] = None
    tune_for: Annotated[
        TuningObjective | None,
        word_option("--tune-for", TuningObjective, "Objective of tuning by optimisation. Default: balance.", show_default=False),
    ] = None
    quick: Annotated[
        bool, typer.Option("--quick", help="Tune for the highest bandwidth that --max-sensitivity allows, without optimisation.")
    ] = False
    max_sensitivity: Annotated[
        str | None, text_option("--max-sensitivity", "NUMBER", "Largest permitted peak sensitivity Ms of a tuned loop. Default: 2.")
    ] = None
    force_feedback: Annotated[
        str | None,
        text_option("--force-feedback", "RATIO", "Damping ratio to reach by integral force feedback in the legs, e.g. 50%. Default: none."),
    ] = None
    tracking: Annotated[
        Following | None,
        word_option(
            "--tracking", Following, "Tracking method for a known path; zv and zvd need a set-up file. Default: none.", show_default=False
        ),
    ] = None
    rate: Annotated[str | None, rate_option("10 kHz; for fast stages, 10 times the highest platform frequency, rounded up")] = None
    delay: Annotated[
        str | None, text_option("--delay", "VALUE", "Delay from a sample to the new controller output. Default: one sample.")
    ] = None
    trajectory: Annotated[
        str | None,
        text_option("--trajectory", "NAME|FILE", "Trajectory: step, raster, spiral, sine, or CSV file of times and poses. Default: step."),
    ] = None
    amplitude: Annotated[
        list[str] | None,
        text_option(
            "--amplitude",
            "AXIS=VALUE",
            "Amplitude of a step or sine, e.g. x=1um. Default: 1 um or 10 urad; for a sine, only along the first axis. Repeatable.",
        ),
    ] = None
    seconds: Annotated[
        float | None, text_option("--seconds", "NUMBER", "Duration in seconds. Default: the trajectory and the settling after it.")
    ] = None
    feedforward: Annotated[
        list[str] | None,
        text_option(
            "--feedforward",
            "NAME",
            f"Feedforward: {', '.join(each.value for each in Compensation)}, or none. Default: lost-motion. Repeatable.",
        ),
    ] = None
    hysteresis: Annotated[
        str | None,
        text_option(
            "--hysteresis", "FILE|SHARE", "Hysteresis of the stacks: model file, or width of the hysteresis loop, e.g. 15%. Default: none."
        ),
    ] = None
    floor: Annotated[
        list[str] | None,
        text_option(
            "--floor",
            "[AXIS=]VALUE",
            'Floor vibration as a criterion or amplitude density, e.g. VC-D, z=VC-C or "x=3 um/s^2/Hz^0.5". Default: none. Repeatable.',
        ),
    ] = None
    gauge_noise: GaugeNoise = None
    resolution: GaugeResolution = None
    amplifier: AmplifierValues = None
    seed: Seed = None
    model: Annotated[Model | None, ELASTIC_MODEL] = None

    def read(self) -> tuple[LoopSetup, list[Finding]]:
        """Return the set-up with all valid options, and the findings of invalid options."""
        changes, findings = dict[str, SetupChange](), list[Finding]()
        for each in (self._plain(), self._compensate(), self._floor(), self._trajectory(), self._amplifier()):
            try:
                changes |= dict(each)
            except DesignError as error:
                findings += error.findings
        found, wrong = read_setup(self.setup, changes)
        return found, [*findings, *wrong]

    def _plain(self) -> Iterator[tuple[str, SetupChange]]:
        given = vars(self)
        for name, address in _ADDRESSES.items():
            if (value := given[name]) is not None:
                yield address, SetupChange(f"--{name.replace('_', '-')}", value.value if isinstance(value, Enum) else value)
        if self.quick:
            yield "controller.quick", SetupChange("--quick", value=True)
        if self.seconds is not None:
            yield "seconds", SetupChange("--seconds", f"{self.seconds!r} s")
        if self.hysteresis is not None:
            is_width = first_that_parses(self.hysteresis, {"width": RATIO}) is not None
            yield "hysteresis", SetupChange("--hysteresis", {"width" if is_width else "file": self.hysteresis})

    def _compensate(self) -> Iterator[tuple[str, SetupChange]]:
        words, known = self.feedforward or (), [each.value for each in Compensation]
        require(
            Finding(f"--feedforward {word}", "unknown feedforward", f"Use {', '.join(known)}, or {_NOTHING}")
            for word in words
            if word not in known and (word != _NOTHING or len(words) > 1)
        )
        if words:
            yield "compensate", SetupChange("--feedforward", [word for word in words if word != _NOTHING])

    def _floor(self) -> Iterator[tuple[str, SetupChange]]:
        for text in self.floor or ():
            axis, sign, value = (part.strip() for part in text.rpartition("="))
            if sign and axis not in _AXES:
                raise refuse(
                    f"--floor {text}",
                    f'unknown axis of the floor "{axis}"',
                    "Use x, y or z. Without an axis, the value applies to all three",
                )
            shaking = _shaking(text, value)
            yield from ((f"floor.{each}", SetupChange(f"--floor {text}", shaking)) for each in _AXES if not sign or each == axis)

    def _trajectory(self) -> Iterator[tuple[str, SetupChange]]:
        word = self.trajectory
        is_file = word is not None and word.lower().endswith(".csv")
        if word is not None or self.amplitude is not None:
            stated = {"kind": "file", "file": word} if is_file else {"kind": word or "step"}
            yield "trajectory", SetupChange("--trajectory", lambda old: old if old and word in (None, old.get("kind")) else stated)
        if self.amplitude is not None:
            sizes = {
                name: f"{size!r} {'rad' if name.startswith('r') else 'm'}" for name, size in motions(self.amplitude, "--amplitude").items()
            }
            yield "trajectory.amplitude", SetupChange("--amplitude", sizes)

    def _amplifier(self) -> Iterator[tuple[str, SetupChange]]:
        values = Values()
        found = amplifier_values(values, self.amplifier or ())
        require(values.findings)
        yield from ((f"amplifier.{name}", SetupChange("--amplifier", f"{value!r} {_UNITS[name]}")) for name, value in found.items())


def _shaking(text: str, value: str) -> dict[str, Any]:
    """Table of a floor vibration: a criterion, or an amplitude density."""
    known = [each.value for each in Criterion]
    if value in known:
        return {"criterion": value}
    fit = first_that_parses(value, {"acceleration": ACCELERATION_NOISE, "velocity": VELOCITY_NOISE, "displacement": NOISE_DENSITY})
    if fit is None:
        advice = f'Use {", ".join(known)}, or an amplitude density, e.g. "3 um/s^2/Hz^0.5"'
        raise refuse(f"--floor {text}", f'unknown criterion or amplitude density "{value}"', advice)
    return {fit[0]: [value]}
