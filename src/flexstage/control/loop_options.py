"""What the options of the command `loop` make of a set-up: theirs go before its own."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any, TypeAlias, TypeVar

from flexstage.base.finding import DesignError, Finding, refuse, require, suggest_nearest
from flexstage.base.units.quantity import ACCELERATION_NOISE, NOISE_DENSITY, RATIO, VELOCITY_NOISE
from flexstage.control.study import setup as forms
from flexstage.control.study.choices import Compensation, Criterion, Following
from flexstage.show.command.options import text_option
from flexstage.show.command.values import first_that_parses, motions

Setup: TypeAlias = Annotated[Path | None, text_option("--setup", "LOOP.TOML", "Set-up file of the loop.")]

_Record = TypeVar("_Record")
_NOTHING = "none"


def override(record: _Record, given: Mapping[str, Any]) -> _Record:
    """The record with the values that are given, others than `None`."""
    return replace(record, **{name: value for name, value in given.items() if value is not None})  # type: ignore[type-var]


def follow_setup(given: forms.FollowSetup | None, method: Following) -> forms.FollowSetup:
    """The set-up's way to follow a path, by another law."""
    return forms.FollowSetup(method) if given is None else replace(given, method=method)


def hysteretic_stacks(said: str | None) -> forms.HystereticStacks | None:
    """A width where the text is a ratio, else a file."""
    if said is None:
        return None
    width = first_that_parses(said, {"width": RATIO})
    return forms.HystereticStacks(file=said) if width is None else forms.HystereticStacks(width=width[1])


def compensation(words: Sequence[str] | None) -> tuple[Compensation, ...] | None:
    """The feedforward that the words of `--feedforward` name."""
    if words is None:
        return None
    known = {each.value: each for each in Compensation}
    require(
        Finding(f"--feedforward {word}", "this is no feedforward", f"It is one of {', '.join(known)}, or {_NOTHING} alone")
        for word in words
        if word not in known and (word != _NOTHING or len(words) > 1)
    )
    return tuple(known[word] for word in words if word in known)


def floor_setup(given: forms.Floor, texts: Sequence[str]) -> forms.Floor | None:
    """The floor as `--floor` says: each axis, or all that no text names an axis of."""
    if not texts:
        return None
    findings: list[Finding] = []
    found: dict[str, forms.VibrationSetup] = {}
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
    return override(given, found)


def _shaking(text: str, value: str) -> forms.VibrationSetup:
    for criterion in Criterion:
        if value == criterion.value:
            return forms.VibrationSetup(criterion=criterion)
    fit = first_that_parses(value, {"acceleration": ACCELERATION_NOISE, "velocity": VELOCITY_NOISE, "displacement": NOISE_DENSITY})
    if fit is None:
        names = ", ".join(each.value for each in Criterion)
        advice = f'Write one of {names}, or an amplitude density, for example "3 um/s^2/Hz^0.5"'
        raise refuse(f"--floor {text}", f'"{value}" is no criterion and no amplitude density', advice)
    return override(forms.VibrationSetup(), {fit[0]: (fit[1],)})


def trajectory_setup(given: forms.TrajectorySetup, word: str | None, moves: Sequence[str] | None) -> forms.TrajectorySetup | None:
    """The trajectory of that name, or of that file, with the sizes of its motions."""
    found = given if word is None else _trajectory_of_name(word, given)
    if moves is None:
        return found if word is not None else None
    if not isinstance(found, (forms.StepMotion, forms.SineMotion)):
        name = found.TOLD_BY[1]
        raise refuse("--amplitude", f"a trajectory of kind {name} has its sizes in the set-up file", "Use it with step or sine")
    return replace(found, amplitude=override(forms.AxisAmplitudes(), motions(moves, "--amplitude")))


def _trajectory_of_name(word: str, given: forms.TrajectorySetup) -> forms.TrajectorySetup:
    """What the set-up says where it is of that kind already, else as the kind is usual; a file where the word is one."""
    usual = (forms.StepMotion(), forms.RasterMotion(), forms.SpiralMotion(), forms.SineMotion())
    kinds = {each.TOLD_BY[1]: each for each in usual}
    if word in kinds:
        return given if type(given) is type(kinds[word]) else kinds[word]
    if word.lower().endswith(".csv"):
        return forms.FileMotion(word)
    raise refuse("--trajectory", f'"{word}" is none of {", ".join(kinds)}, and no CSV file', suggest_nearest(word, kinds))
