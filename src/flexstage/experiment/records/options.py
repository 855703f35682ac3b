"""User options for a record: roles of channels, units, and accepted faults."""

from __future__ import annotations

import fnmatch
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, fields, replace
from enum import Enum

from flexstage.base.arguments import CheckedFields
from flexstage.base.finding import Finding, require, suggest_nearest
from flexstage.experiment.records.record import Channel, Role, names_of
from flexstage.experiment.records.unit import plain_unit

INPUT_NAMES = (
    *("u", "u[0-9]*", "u[._ ]*", "in", "in[0-9]*", "in[._ ]*", "input*", "f", "f[0-9]*", "f[xyz]", "m[xyz]", "force*", "load*", "hammer*"),
    *("drive*", "exc*", "command*", "cmd*", "actuator*", "volt*", "ref", "ref[0-9]*", "reference*", "shaker*", "b[0-9]", "b[0-9][0-9]"),
)
"""Default names of input channels, used if neither the user nor the file specifies roles; case-insensitive."""

OUTPUT_NAMES = (
    *("y", "y[0-9]*", "y[._ ]*", "out", "out[0-9]*", "out[._ ]*", "output*", "x", "x[0-9]*", "z", "z[0-9]*", "s", "s[0-9]*", "gauge*"),
    *("sensor*", "resp*", "acc*", "a[0-9]*", "vel*", "disp*", "gap*", "mic*", "platform.*"),
)
"""Default names of output channels, used if neither the user nor the file specifies roles; case-insensitive."""


class Kind(Enum):
    """Requested kind of data, for a file with both records and responses."""

    RECORD = "record"
    RESPONSES = "responses"


class FaultTolerance(Enum):
    """Faults of a record that a user can accept; each entry states how the data are then used. By default, no fault is accepted."""

    TRUNCATED = "truncated"
    """Use the available part of a truncated file."""
    GAPS = "gaps"
    """Use the longest interval without gaps and with finite numbers."""
    DEAD = "dead"
    """Omit channels that are dead, constant or frozen."""
    CLIPPED = "clipped"
    """Use clipped and coarsely quantised channels unchanged; limit a stored coherence to 0 to 1."""
    UNITS = "units"
    """Use numbers with a missing or unknown unit unchanged."""
    DEPENDENT = "dependent"
    """Omit inputs that the other inputs explain."""
    SHORT = "short"
    """Use a record that is too short for the requested resolution."""
    SLOW = "slow"
    """Use a record sampled too slowly for the highest mode, but only at frequencies up to 0.42 times its sampling rate."""
    NAMES = "names"
    """Omit channels without a role, or absent from the stage."""
    WINDOWED = "windowed"
    """Use a hammer force unchanged although it is exactly zero after the impact."""
    INCOMPLETE = "incomplete"
    """Omit outputs with missing responses; omit the whole coherence if the coherence of the last response is missing."""


@dataclass(frozen=True)
class Arrays(CheckedFields):
    """Names or patterns that specify the array of a MAT or HDF5 file, or the column of a CSV file, that contains each quantity.

    A record consists of `samples` and one of `time` [s], `rate` [Hz] and `step` [s]. `names` and `units` are lists with one string per
    channel. Responses have `frequencies` [Hz], complex `responses`, and optional `coherence`. The default names are the names in files that
    flexstage writes. In a CSV file, only `time` and `frequencies` can be assigned: all other columns are channels.
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
        """Return pairs (field, assigned name) for every field that differs from its default.

        >>> Arrays(samples=("u", "y"), time=("t",)).stated()
        (('samples', 'u'), ('samples', 'y'), ('time', 't'))
        """
        own = [each for each in fields(self) if getattr(self, each.name) != each.default]
        return tuple((each.name, name) for each in own for name in getattr(self, each.name))


@dataclass(frozen=True)
class Options(CheckedFields):
    """User options for reading a file.

    `inputs` and `outputs` are names or patterns (`u*`, `S?`) of channels. If only `inputs` is specified, all other channels are outputs,
    and vice versa. `only` (option `--channels`) selects the channels to use. `rate` [Hz] is used instead of the times in the file. `units`
    are pairs of a name or pattern and a unit. `arrays` specifies which arrays or columns of the file contain which quantities.
    `accept_faults` are the accepted faults.
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
    """Assign a role and a unit to each channel: as the user specifies, or else as in the file. Unknown roles follow from the names.

    Raises `DesignError` for patterns that match no channel and for channels with both roles.

    >>> [channel.role.value for channel in assign([Channel("u1", "V"), Channel("S1", "um"), Channel("note")], Options(), "a.csv")]
    ['input', 'output', 'unknown']
    >>> [channel.role.value for channel in assign([Channel("a"), Channel("b")], Options(inputs=("b",)), "a.csv")]
    ['output', 'input']
    """
    known = tuple(channels)
    require(_name_findings(names_of(known), options, where))
    return tuple(replace(channel, role=_role(channel, options), unit=_unit(channel, options)) for channel in known)


def select_names(names: Iterable[str], options: Options) -> tuple[str, ...]:
    """Select the channel names: all, or those that match `only`.

    >>> select_names(["u1", "S1", "trigger"], Options(only=("u*", "S*")))
    ('u1', 'S1')
    """
    return tuple(name for name in names if not options.only or matches(name, options.only))


def matches(name: str, patterns: Iterable[str]) -> bool:
    """Check whether a name equals one of the patterns or matches it; case-sensitive.

    >>> matches("S1", ["S?"]), matches("S1", ["s1"]), matches("a[1]", ["a[1]"])
    (True, False, True)
    """
    return any(name == pattern or fnmatch.fnmatchcase(name, pattern) for pattern in patterns)


def number_names(names: Iterable[str]) -> tuple[str, ...]:
    """Append numbers to equal names, so that all names are unique.

    >>> number_names(["acc", "acc", "u"])
    ('acc 1', 'acc 2', 'u')
    """
    listed = list(names)
    counts, seen = Counter(listed), Counter[str]()
    result = list[str]()
    for name in listed:
        seen[name] += 1
        result.append(f"{name} {seen[name]}".strip() if counts[name] > 1 else name)
    return tuple(result)


def _name_findings(names: Sequence[str], options: Options, where: str) -> Iterator[Finding]:
    units = [name for name, _ in options.units]
    for kind, patterns in (("inputs", options.inputs), ("outputs", options.outputs), ("channels", options.only), ("units", units)):
        for pattern in patterns:
            if not any(matches(name, [pattern]) for name in names):
                yield Finding(f"{where}: {kind} {pattern}", "unknown channel", suggest_nearest(pattern, names))
    for name in names:
        if matches(name, options.inputs) and matches(name, options.outputs):
            yield Finding(f"{where}: {name}", "it is named as an input and as an output", "Assign one role to it")


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
