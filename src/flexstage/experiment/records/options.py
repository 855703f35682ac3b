"""What a user says about a record: which channels are inputs and outputs, their units, and what may be used although it is bad."""

from __future__ import annotations

import fnmatch
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, fields, replace
from enum import Enum

from flexstage.base.arguments import CheckedFields
from flexstage.base.finding import Finding, require, suggest_nearest
from flexstage.experiment.records.record import Channel, Role
from flexstage.experiment.records.unit import plain_unit

INPUT_NAMES = (
    *("u", "u[0-9]*", "u[._ ]*", "in", "in[0-9]*", "in[._ ]*", "input*", "f", "f[0-9]*", "f[xyz]", "m[xyz]", "force*", "load*", "hammer*"),
    *("drive*", "exc*", "command*", "cmd*", "actuator*", "volt*", "ref", "ref[0-9]*", "reference*", "shaker*", "b[0-9]", "b[0-9][0-9]"),
)
"""Names of channels that are taken for inputs where neither the user nor the file says anything; upper and lower case alike."""

OUTPUT_NAMES = (
    *("y", "y[0-9]*", "y[._ ]*", "out", "out[0-9]*", "out[._ ]*", "output*", "x", "x[0-9]*", "z", "z[0-9]*", "s", "s[0-9]*", "gauge*"),
    *("sensor*", "resp*", "acc*", "a[0-9]*", "vel*", "disp*", "gap*", "mic*", "platform.*"),
)
"""Names of channels that are taken for outputs where neither the user nor the file says anything; upper and lower case alike."""


class Kind(Enum):
    """What is wanted of a file that holds both."""

    RECORD = "record"
    RESPONSES = "responses"


class FaultTolerance(Enum):
    """Accepted fault of a record, and how its data are used: no fault is accepted unless the user names it."""

    TRUNCATED = "truncated"
    """Use what a file that breaks off still holds."""
    GAPS = "gaps"
    """Use the longest stretch without gaps and without numbers that are none."""
    DEAD = "dead"
    """Leave out channels that are dead, constant or stand still."""
    CLIPPED = "clipped"
    """Use clipped and coarsely quantised channels as they are; cut a stored coherence off at 0 and 1."""
    UNITS = "units"
    """Use numbers whose unit is missing or unknown as they are."""
    DEPENDENT = "dependent"
    """Leave out inputs that the others explain."""
    SHORT = "short"
    """Use a record that is short for the resolution asked for."""
    SLOW = "slow"
    """Use a record sampled too slowly for the highest mode, up to half its rate."""
    NAMES = "names"
    """Leave out channels that are neither inputs nor outputs, or that the stage does not have."""
    WINDOWED = "windowed"
    """Use a hammer's force that was set to nought after the blow as it is: a free decay from a blow."""
    INCOMPLETE = "incomplete"
    """Leave out outputs whose responses to some inputs are missing, and coherence where the last response lacks its."""


@dataclass(frozen=True)
class Arrays(CheckedFields):
    """Which arrays of a MAT or HDF5 file, or which columns of a CSV file, are what: names or patterns.

    A record has `samples`, and `time` [s], `rate` [Hz] or `step` [s]; `names` and `units` are lists of texts, one a channel. Responses have
    `frequencies` [Hz], complex `responses`, and `coherence`. What is not stated has the name that files written here give it. Of a CSV file
    `time` and `frequencies` count: the others are its channels.
    """

    samples: tuple[str, ...] = ("samples",)
    time: tuple[str, ...] = ("time",)
    rate: tuple[str, ...] = ("rate",)
    step: tuple[str, ...] = ("step",)
    names: tuple[str, ...] = ("names",)
    units: tuple[str, ...] = ("units",)
    frequencies: tuple[str, ...] = ("frequencies", "frequency")
    responses: tuple[str, ...] = ("responses",)
    coherence: tuple[str, ...] = ("coherence",)

    def stated(self) -> tuple[tuple[str, str], ...]:
        """Pairs of a meaning and a name that is not the usual one.

        >>> Arrays(samples=("u", "y"), time=("t",)).stated()
        (('samples', 'u'), ('samples', 'y'), ('time', 't'))
        """
        own = [each for each in fields(self) if getattr(self, each.name) != each.default]
        return tuple((each.name, name) for each in own for name in getattr(self, each.name))


@dataclass(frozen=True)
class Options(CheckedFields):
    """What a user says about a file.

    `inputs` and `outputs` are names or patterns (`u*`, `S?`); where only one of them is given, all other channels are of the other kind.
    `only` names the channels that count at all. `rate` in Hz overrides what the file says of time. `units` are pairs of a name or pattern
    and a unit. `arrays` says which arrays of the file are what. `allow` is what may be used although it is bad.
    """

    inputs: tuple[str, ...] = ()
    outputs: tuple[str, ...] = ()
    only: tuple[str, ...] = ()
    rate: float | None = None
    units: tuple[tuple[str, str], ...] = ()
    kind: Kind | None = None
    arrays: Arrays = Arrays()
    accept_faults: frozenset[FaultTolerance] = frozenset()


def assign(channels: Iterable[Channel], options: Options, where: str) -> tuple[Channel, ...]:
    """The channels with roles and units as the user says, else as the file says, else by their names.

    Raises `DesignError` for patterns that match no channel and for channels that are said to be both.

    >>> [channel.role.value for channel in assign([Channel("u1", "V"), Channel("S1", "um"), Channel("note")], Options(), "a.csv")]
    ['input', 'output', 'unknown']
    >>> [channel.role.value for channel in assign([Channel("a"), Channel("b")], Options(inputs=("b",)), "a.csv")]
    ['output', 'input']
    """
    known = tuple(channels)
    names = [channel.name for channel in known]
    require([*_unknown_names(names, options, where), *_named_twice(names, options, where)])
    return tuple(replace(channel, role=_role(channel, options), unit=_unit(channel, options)) for channel in known)


def select_names(names: Iterable[str], options: Options) -> tuple[str, ...]:
    """The names that count: all, or those that `only` matches.

    >>> select_names(["u1", "S1", "trigger"], Options(only=("u*", "S*")))
    ('u1', 'S1')
    """
    return tuple(name for name in names if not options.only or matches(name, options.only))


def matches(name: str, patterns: Iterable[str]) -> bool:
    """Whether a name is one of the patterns or fits one; upper and lower case differ.

    >>> matches("S1", ["S?"]), matches("S1", ["s1"]), matches("a[1]", ["a[1]"])
    (True, False, True)
    """
    return any(name == pattern or fnmatch.fnmatchcase(name, pattern) for pattern in patterns)


def number_names(names: Iterable[str]) -> tuple[str, ...]:
    """Names made different by numbers where some are alike.

    >>> number_names(["acc", "acc", "u"])
    ('acc 1', 'acc 2', 'u')
    """
    listed = list(names)
    counts, seen = Counter(listed), Counter[str]()
    result: list[str] = []
    for name in listed:
        seen[name] += 1
        result.append(f"{name} {seen[name]}".strip() if counts[name] > 1 else name)
    return tuple(result)


def _unknown_names(names: list[str], options: Options, where: str) -> list[Finding]:
    asked = {
        "inputs": options.inputs,
        "outputs": options.outputs,
        "channels": options.only,
        "units": tuple(name for name, _ in options.units),
    }
    missing = [
        (kind, pattern) for kind, patterns in asked.items() for pattern in patterns if not any(matches(name, [pattern]) for name in names)
    ]
    return [Finding(f"{where}: {kind} {pattern}", "unknown channel", suggest_nearest(pattern, names)) for kind, pattern in missing]


def _named_twice(names: list[str], options: Options, where: str) -> list[Finding]:
    twice = [name for name in names if matches(name, options.inputs) and matches(name, options.outputs)]
    return [Finding(f"{where}: {name}", "it is named as an input and as an output", "Name it once") for name in twice]


def _role(channel: Channel, options: Options) -> Role:
    if matches(channel.name, options.inputs):
        return Role.INPUT
    if matches(channel.name, options.outputs):
        return Role.OUTPUT
    if options.inputs or options.outputs:
        return Role.UNKNOWN if options.inputs and options.outputs else Role.OUTPUT if options.inputs else Role.INPUT
    if channel.role is not Role.UNKNOWN:
        return channel.role
    short = channel.name.lower()
    if matches(short, INPUT_NAMES):
        return Role.INPUT
    return Role.OUTPUT if matches(short, OUTPUT_NAMES) else Role.UNKNOWN


def _unit(channel: Channel, options: Options) -> str:
    return next((plain_unit(unit) for pattern, unit in options.units if matches(channel.name, [pattern])), channel.unit)
