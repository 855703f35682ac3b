"""Records: sampled channels of a test, and frequency responses of an analyser.

Samples are read in blocks from any source, so that a record may be larger than the memory. Numbers are in the channels' units and
bit-identical to those in the file.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from enum import Enum
from typing import Annotated, Protocol

import numpy as np

from flexstage.base.arguments import GAPS, CheckedFields, check_arguments
from flexstage.base.finding import Finding, require, suggest_nearest
from flexstage.base.labelled import ratio_units
from flexstage.base.notebook import InNotebook
from flexstage.base.number import Array
from flexstage.base.record import INNER, VIEW
from flexstage.base.units.quantity import FREQUENCY, TIME

RATES = (1e-12, 1e15)
"""Valid sampling rates [Hz]."""


class Role(Enum):
    """Role of a channel in the test."""

    INPUT = "input"
    OUTPUT = "output"
    UNKNOWN = "unknown"


@dataclass(frozen=True)
class Channel(CheckedFields):
    """Recorded channel: its name, unit (empty: not specified), and role in the test."""

    name: str
    unit: str = ""
    role: Annotated[Role, INNER] = Role.UNKNOWN


class Samples(Protocol):
    """Samples from any source: `length` samples of every channel; any range of them can be read."""

    @property
    def length(self) -> int:
        """Number of samples of each channel."""
        ...

    def read(self, start: int, stop: int, /) -> Array:
        """Read samples `start` to `stop` (excluded), as floats (n, channels)."""
        ...


@dataclass(frozen=True, eq=False)
class InMemory:
    """Samples in one array (n, channels)."""

    values: Array

    @property
    def length(self) -> int:
        """Number of samples of each channel."""
        return len(self.values)

    def read(self, start: int, stop: int) -> Array:
        """Return samples `start` to `stop` (excluded).

        >>> InMemory(np.array([[1.0], [2.0], [3.0]])).read(1, 3).tolist()
        [[2.0], [3.0]]
        """
        return self.values[start:stop]


@dataclass(frozen=True, eq=False)
class ComputedSamples:
    """Samples from a function: `read(start, stop)` returns samples `start` to `stop` (excluded), as floats (n, channels)."""

    length: int
    read: Callable[[int, int], Array]


def changed_samples(samples: Samples, change: Callable[[Array], Array]) -> Samples:
    """Apply a change to each block of samples when it is read.

    >>> changed_samples(InMemory(np.array([[1.0, 2.0]])), lambda block: block[:, [1]]).read(0, 1).tolist()
    [[2.0]]
    """
    return ComputedSamples(samples.length, lambda start, stop: change(samples.read(start, stop)))


@dataclass(frozen=True, eq=False)
class Record(InNotebook, CheckedFields):
    """Channels sampled together at a constant rate.

    `rate` is in Hz; `start` is the time of the first sample in s. `samples` contains n samples of each channel (n, channels), in the
    channels' own units. `name` and `source` identify the record and its file. Raises `DesignError` for an invalid rate, for missing or
    unnamed channels and for duplicate names.

    >>> both = (Channel("u1", "V", Role.INPUT), Channel("S1", "um", Role.OUTPUT))
    >>> shaken = Record(both, 2048.0, InMemory(np.zeros((4096, 2))))
    >>> shaken.duration, [channel.name for channel in shaken.outputs]
    (2.0, ['S1'])
    """

    channels: Annotated[tuple[Channel, ...], INNER]
    rate: Annotated[float, FREQUENCY]
    samples: Annotated[Samples, INNER]
    start: Annotated[float, INNER] = 0.0
    name: Annotated[str, INNER] = ""
    source: str = ""

    def __post_init__(self) -> None:
        super().__post_init__()
        where = self.where
        require([*_rate_findings(where, self.rate), *name_findings(where, self.channels)])

    @property
    def where(self) -> str:
        """Name of the record in messages: its file, or its `name` if the record has no file."""
        return self.source or self.name or "record"

    @property
    def kind(self) -> Annotated[str, VIEW]:
        """Kind of data: always `record` (frequency responses have the kind `responses`)."""
        return "record"

    @property
    def length(self) -> Annotated[int, VIEW]:
        """Number of samples of each channel."""
        return self.samples.length

    @property
    def duration(self) -> Annotated[float, TIME]:
        """Duration in seconds: number of samples divided by the rate."""
        return self.length / self.rate

    @property
    def names(self) -> tuple[str, ...]:
        """Names of all channels."""
        return names_of(self.channels)

    @property
    def inputs(self) -> Annotated[tuple[Channel, ...], VIEW]:
        """Channels with the role input."""
        return tuple(channel for channel in self.channels if channel.role is Role.INPUT)

    @property
    def outputs(self) -> Annotated[tuple[Channel, ...], VIEW]:
        """Channels with the role output."""
        return tuple(channel for channel in self.channels if channel.role is Role.OUTPUT)

    @property
    def values(self) -> Array:
        """All samples at once, (n, channels)."""
        return self.samples.read(0, self.length)

    def columns(self, names: Iterable[str]) -> tuple[int, ...]:
        """Return the column indices of the named channels; raises `DesignError` for every unknown name."""
        chosen, known = tuple(names), self.names
        where = self.where
        require(
            Finding(f"{where}: {name}", "unknown channel", suggest_nearest(name, known))
            for name in dict.fromkeys(chosen)
            if name not in known
        )
        return tuple(known.index(name) for name in chosen)

    def select(self, names: Iterable[str]) -> Record:
        """Return the record of the named channels, in the sequence of the names.

        >>> both = Record((Channel("a"), Channel("b")), 1.0, InMemory(np.array([[1.0, 2.0]])))
        >>> both.select(["b"]).values.tolist()
        [[2.0]]
        """
        columns = self.columns(names)
        return replace(
            self,
            channels=tuple(self.channels[column] for column in columns),
            samples=changed_samples(self.samples, lambda block: block[:, columns]),
        )

    def part(self, start: int, stop: int) -> Record:
        """Return the record from sample `start` to sample `stop` (excluded).

        >>> long = Record((Channel("a"),), 2.0, InMemory(np.array([[1.0], [2.0], [3.0]])))
        >>> long.part(1, 3).start, long.part(1, 3).values.tolist()
        (0.5, [[2.0], [3.0]])
        """
        start, stop, _ = slice(start, stop).indices(self.length)
        source, length = self.samples, max(0, stop - start)
        samples = ComputedSamples(length, lambda low, high: source.read(start + min(low, length), start + min(high, length)))
        return replace(self, start=self.start + start / self.rate, samples=samples)

    def blocks(self, size: int, overlap: int = 0) -> Iterator[Array]:
        """Iterate over the record in blocks of `size` samples, as arrays (size, channels).

        Each block after the first begins with the last `overlap` samples of the previous block. The final block may be shorter.

        >>> five = Record((Channel("a"),), 1.0, InMemory(np.arange(5.0)[:, None]))
        >>> [block[:, 0].tolist() for block in five.blocks(3, overlap=1)]
        [[0.0, 1.0, 2.0], [2.0, 3.0, 4.0]]
        """
        if not 0 <= overlap < size:
            raise ValueError(f"blocks of {size} samples cannot overlap by {overlap}")
        for start in range(0, max(0, self.length - overlap), size - overlap):
            yield self.samples.read(start, min(start + size, self.length))


@dataclass(frozen=True, eq=False)
class Responses(InNotebook, CheckedFields):
    """Frequency responses of an analyser, each the output divided by the input, for the time dependence e^{+j omega t}.

    `frequencies` (f,) are in Hz, ascending. `values` (f, outputs, inputs) are complex; the unit of a value is the output's unit divided by
    the input's unit. `coherence`, if stored, has the shape of `values`; `window` and `averages` are set if the file specifies them. Raises
    `DesignError` for duplicate names of outputs or of inputs and for shapes that do not match.

    >>> one = Responses(np.array([1.0]), (Channel("S1", "um"),), (Channel("u1", "V"),), np.array([[[2j]]]))
    >>> one.at("S1", "u1").tolist(), one.units
    ([2j], (('um/V',),))
    """

    frequencies: Array
    outputs: tuple[Channel, ...]
    inputs: tuple[Channel, ...]
    values: Annotated[Array, GAPS, INNER]
    coherence: Annotated[Array | None, GAPS, INNER] = None
    window: str = ""
    averages: int | None = None
    name: Annotated[str, INNER] = ""
    source: str = ""

    def __post_init__(self) -> None:
        super().__post_init__()
        where = self.where
        expected = (len(self.frequencies), len(self.outputs), len(self.inputs))
        advice = "Use one value per frequency, output and input"
        wrong = [
            Finding(f"{where}: {name}", f"wrong shape (got {values.shape}, expected {expected})", advice)
            for name, values in (("values", self.values), ("coherence", self.coherence))
            if values is not None and values.shape != expected
        ]
        require([*name_findings(where, self.outputs), *name_findings(where, self.inputs), *wrong])

    @property
    def where(self) -> str:
        """Name of the responses in messages: their file, or their `name` if the responses have no file."""
        return self.source or self.name or "responses"

    @property
    def kind(self) -> Annotated[str, VIEW]:
        """Kind of data: always `responses` (records have the kind `record`)."""
        return "responses"

    @property
    def lines(self) -> Annotated[int, VIEW]:
        """Number of frequencies."""
        return len(self.frequencies)

    @property
    def band(self) -> Annotated[tuple[float, float], FREQUENCY]:
        """Lowest and highest frequency in Hz."""
        return float(self.frequencies[0]), float(self.frequencies[-1])

    @property
    def units(self) -> tuple[tuple[str, ...], ...]:
        """Unit of every entry, by output and input; empty if the unit of the output or of the input is missing."""
        rows, columns = (tuple(channel.unit for channel in side) for side in (self.outputs, self.inputs))
        ratios = zip(rows, ratio_units(rows, columns), strict=True)
        return tuple(tuple(ratio if above and below else "" for below, ratio in zip(columns, row, strict=True)) for above, row in ratios)

    def select(self, rows: Sequence[int], columns: Sequence[int]) -> Responses:
        """Return the responses of the outputs with indices `rows` to the inputs with indices `columns`."""
        chosen = np.ix_(range(len(self.frequencies)), rows, columns)
        return replace(
            self,
            outputs=tuple(self.outputs[row] for row in rows),
            inputs=tuple(self.inputs[column] for column in columns),
            values=self.values[chosen],
            coherence=None if self.coherence is None else self.coherence[chosen],
        )

    def at(self, output: str, input: str) -> Array:  # noqa: A002 the field's word
        """Return the complex response (f,) of one output to one input at all frequencies."""
        return self.values[:, names_of(self.outputs).index(output), names_of(self.inputs).index(input)]


def report_reading(record: Record, tell: Callable[[int], None]) -> Record:
    """Return a record that reports the progress of reading: after each block, `tell` is called with the number of samples read so far.

    >>> told = []
    >>> long = report_reading(in_memory([Channel("S1")], 1.0, np.zeros((5, 1))), told.append)
    >>> sum(len(block) for block in long.blocks(2)), told
    (5, [2, 4, 5])
    """

    def read(start: int, stop: int) -> Array:
        found = record.samples.read(start, stop)
        tell(min(stop, record.length))
        return found

    return replace(record, samples=ComputedSamples(record.length, read))


@check_arguments
def in_memory(channels: Iterable[Channel], rate: float, values: Annotated[Array, GAPS]) -> Record:
    """Create the record of an array (n, channels), sampled at `rate` in Hz.

    >>> in_memory([Channel("S1", "um")], 10.0, np.zeros((5, 1))).duration
    0.5
    """
    return Record(tuple(channels), float(rate), InMemory(np.asarray(values, dtype=float)))


def names_of(channels: Iterable[Channel]) -> tuple[str, ...]:
    """Return the names of channels.

    >>> names_of([Channel("u"), Channel("y")])
    ('u', 'y')
    """
    return tuple(channel.name for channel in channels)


def rising_problem(frequencies: Array) -> str | None:
    """Describe why frequencies do not increase: fewer than two values, a duplicate, or a decrease; None if frequencies increase.

    >>> rising_problem(np.array([1.0, 2.0, 2.0, 3.0]))
    'its frequencies do not increase: 2 Hz occurs twice, as values 2 and 3'
    """
    if len(frequencies) < 2:
        return f"too few frequencies (got {len(frequencies)})"
    falling = np.flatnonzero(~(np.diff(frequencies) > 0.0))
    if not len(falling):
        return None
    line = int(falling[0])
    first, second = frequencies[line], frequencies[line + 1]
    how = f"{first:g} Hz occurs twice, as" if first == second else f"{first:g} Hz, then {second:g} Hz, as"
    return f"its frequencies do not increase: {how} values {line + 1} and {line + 2}"


def name_findings(where: str, channels: tuple[Channel, ...]) -> Iterator[Finding]:
    """Find faults of channel names: no channels, empty names, duplicates.

    >>> [finding.what for finding in name_findings("a.csv", (Channel("S1"), Channel("S1")))]
    ['2 channels have this name']
    """
    if not channels:
        yield Finding(where, "there is no channel", "Use at least one channel")
    counts = Counter(names_of(channels))
    if unnamed := counts.pop("", 0):
        yield Finding(where, f"{unnamed} of {len(channels)} channels have no name", "Name every channel")
    for name, count in counts.items():
        if count > 1:
            yield Finding(f"{where}: {name}", f"{count} channels have this name", "Rename all but one")


def _rate_findings(where: str, rate: float) -> Iterator[Finding]:
    if not RATES[0] <= rate <= RATES[1]:
        yield Finding(where, f"the sampling rate is {rate:g} Hz", f"Use a rate between {RATES[0]:g} and {RATES[1]:g} Hz")
