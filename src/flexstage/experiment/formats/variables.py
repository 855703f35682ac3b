"""Named arrays of a file, as MAT and HDF5 files hold them, told apart: time, rate, channels, frequencies, responses.

Files are written by many programs. Arrays are known by their names, shapes and attributes: samples run along either axis, a time vector, a
step or a rate tells the time, names and units stand in attributes or in lists beside the arrays.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from flexstage.base.files import Attribute
from flexstage.base.finding import refuse
from flexstage.base.number import Array
from flexstage.experiment.clock import Clock, Told, longest_stretch, settled
from flexstage.experiment.options import Allow, Options, assigned, numbered, wanted
from flexstage.experiment.record import Channel, InMemory, Record, Role, Samples
from flexstage.experiment.unit import plain_unit

_BLOCK = 262_144
OWN_FORM = "flexstage record 1"
"""What files written here say of themselves: their `samples` are (n, channels), however few."""

TIMES = re.compile(r"t|t_s|times?(_s|_domain|_vector|_axis)?|tvec|timestamps?|zeit")
RATES = re.compile(r"fs|f_s|sr|rate|rate_hz|(time_)?sampl(e|ing)_?(rate|frequency)|fsamp(le)?")
STEPS = re.compile(r"dt|ts|(time_?)?step|t_step|delta_?t(ime)?|sampl(e|ing)_?(time|interval|period)|(wf_)?increment")
STARTS = re.compile(r"start|t0|start_time|wf_start_offset")
FREQUENCIES = re.compile(r"f|freqs?|f_hz|hz|fvec|frequenc(y|ies)(_domain|_vector|_axis)?|freq_(domain|vector|axis)|frf_freqs?|lines")
UNIT_NAMES = ("unit", "units", "unit_string", "physical_unit", "y_unit")
LABEL_NAMES = ("names", "channel_names", "channels", "labels", "channel_labels", "columns")


class Variable(Protocol):
    """An array of a file: its name (a path), its shape as the user sees it, and how it is read."""

    @property
    def name(self) -> str:
        """Path of the array within its file."""
        ...

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the array, axes of length one included."""
        ...

    @property
    def is_complex(self) -> bool:
        """Whether its numbers are complex."""
        ...

    @property
    def attributes(self) -> Mapping[str, Attribute]:
        """What the file says beside the array, its groups included."""
        ...

    def whole(self) -> Array:
        """The array."""
        ...

    def samples(self, axis: int) -> Samples:
        """The array as samples along an axis; the others are its channels, in order."""
        ...


@dataclass(frozen=True, eq=False)
class Held:
    """An array that is in memory already."""

    name: str
    values: Array
    attributes: Mapping[str, Attribute] = field(default_factory=dict[str, Attribute])

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the array."""
        return self.values.shape

    @property
    def is_complex(self) -> bool:
        """Whether its numbers are complex."""
        return np.iscomplexobj(self.values)

    def whole(self) -> Array:
        """The array."""
        return self.values

    def samples(self, axis: int) -> Samples:
        """The array as samples along an axis, as floats."""
        first = np.moveaxis(self.values, axis, 0)
        return InMemory(first.reshape(len(first), -1).astype(float))


@dataclass(frozen=True, eq=False)
class Contents:
    """What a file holds: arrays, lists of texts by name, attributes of the file; `where` names it."""

    where: str
    variables: tuple[Variable, ...]
    texts: Mapping[str, tuple[str, ...]] = field(default_factory=dict[str, tuple[str, ...]])
    attributes: Mapping[str, Attribute] = field(default_factory=dict[str, Attribute])

    def number(self, names: re.Pattern[str]) -> float | None:
        """The first number whose name fits: an array of one entry, or an attribute of the file or of an array.

        >>> Contents("a.mat", (Held("data/fs", np.array([[50.0]])),)).number(RATES)
        50.0
        """
        scalars = [variable for variable in self.variables if np.prod(variable.shape) == 1 and not variable.is_complex]
        found: list[Attribute] = [float(each.whole().ravel()[0]) for each in scalars if names.fullmatch(plain_name(each.name))]
        for attributes in (self.attributes, *(variable.attributes for variable in self.variables)):
            found += [value for name, value in attributes.items() if names.fullmatch(plain_name(name))]
        return next((float(value) for value in found if isinstance(value, (int, float))), None)

    def text(self, *names: str) -> tuple[str, ...]:
        """The first list of texts of one of these names; empty if there is none.

        >>> Contents("a.mat", (), {"meta/Units": ("V", "um")}).text("units")
        ('V', 'um')
        """
        plain = {plain_name(name): texts for name, texts in reversed(list(self.texts.items()))}
        return next((plain[name] for name in names if name in plain), ())


@dataclass(frozen=True, eq=False)
class SideBySide:
    """Samples of several sources as one: their channels one after another."""

    sources: tuple[Samples, ...]

    @property
    def length(self) -> int:
        """Number of samples of each channel."""
        return min(source.length for source in self.sources)

    def read(self, start: int, stop: int) -> Array:
        """Samples `start` to `stop`, the latter excluded, of all sources.

        >>> SideBySide((InMemory(np.array([[1.0]])), InMemory(np.array([[2.0]])))).read(0, 1).tolist()
        [[1.0, 2.0]]
        """
        return np.hstack([source.read(start, stop) for source in self.sources])


def complex_of(real: Array, imaginary: Array) -> Array:
    """The complex array of two real ones, to the bit: a sum would lose the sign of zeros.

    >>> complex_of(np.array([-0.0]), np.array([2.0])).tolist()
    [(-0+2j)]
    """
    whole = np.empty(real.shape, dtype=complex)
    np.real(whole)[...], np.imag(whole)[...] = real, imaginary
    return whole


def plain_name(name: str) -> str:
    """The last part of a path in small letters, anything else than letters and digits as `_`; a unit in brackets left out.

    >>> plain_name("test 1/Sample-Rate [Hz]"), plain_name("data.fs")
    ('sample_rate', 'fs')
    """
    bare = re.sub(r"[\[(][^\])]*[\])]\s*$", "", name)
    return re.sub(r"[^a-z0-9]+", "_", re.split(r"[/.]", bare)[-1].lower()).strip("_")


def vector_length(variable: Variable) -> int:
    """Length of an array that is a vector, whichever way it lies; 0 for others.

    >>> vector_length(Held("t", np.zeros((1, 5)))), vector_length(Held("t", np.zeros((2, 5)))), vector_length(Held("t", np.zeros(())))
    (5, 0, 0)
    """
    longest = max(variable.shape, default=0)
    return longest if longest > 1 and np.prod(variable.shape) == longest else 0


def pieces(variable: Variable) -> Iterator[Array]:
    """A vector in blocks.

    >>> [block.tolist() for block in pieces(Held("t", np.array([[1.0, 2.0]])))]
    [[1.0, 2.0]]
    """
    source = variable.samples(int(np.argmax(variable.shape)))
    for start in range(0, source.length, _BLOCK):
        yield source.read(start, min(start + _BLOCK, source.length))[:, 0]


def rises(variable: Variable) -> bool:
    """Whether a real vector begins by rising, as an axis does.

    >>> rises(Held("t", np.arange(3.0))), rises(Held("t", np.zeros(3)))
    (True, False)
    """
    if variable.is_complex or not vector_length(variable):
        return False
    first = next(pieces(variable))[:64]
    return bool(np.all(np.diff(first) > 0.0))


def record_of(contents: Contents, options: Options) -> Record | None:
    """The record of a file's arrays; None if it has none. Raises `DesignError` with what keeps it from being one.

    >>> both = (Held("u", np.zeros((1, 8))), Held("y", np.ones((8, 2))), Held("fs", np.array(4.0)))
    >>> found = record_of(Contents("a.mat", both), Options())
    >>> found.names, found.rate, found.values[0].tolist()
    (('u', 'y1', 'y2'), 4.0, [0.0, 1.0, 1.0])
    """
    time = next((each for each in contents.variables if TIMES.fullmatch(plain_name(each.name)) and vector_length(each)), None)
    stated = options.rate or contents.number(RATES) or _inverse(contents.number(STEPS))
    if time is None and stated is None:
        return None
    chosen = _candidates(contents, time, options)
    if not chosen:
        return None
    length = _length(contents, chosen, time)
    axes = [(variable, _axis(variable, length)) for variable in chosen if length in variable.shape]
    clock = _clock(time, stated, options, contents)
    channels, samples = _channels(contents, axes), SideBySide(tuple(variable.samples(axis) for variable, axis in axes))
    start = clock.start if time is not None else contents.number(STARTS) or 0.0
    whole = Record(assigned(channels, options, contents.where), clock.rate, samples, start, name=_name(contents), source=contents.where)
    record = whole.select(wanted(whole.names, options)) if options.only else whole
    return longest_stretch(record, clock)


def _inverse(step: float | None) -> float | None:
    return 1.0 / step if step else None


def _name(contents: Contents) -> str:
    return next(iter(contents.text("name", "title", "test_name")), "") or str(contents.attributes.get("name", ""))


def _candidates(contents: Contents, time: Variable | None, options: Options) -> list[Variable]:
    """Arrays that may be channels: real, of one or two axes, more than one entry, not the time, not of the frequency domain."""
    lines = frequency_axis(contents)
    spectral = 0 if lines is None or (time is not None and vector_length(time) == vector_length(lines)) else vector_length(lines)
    real = [each for each in contents.variables if each not in (time, lines) and not each.is_complex]
    found = [each for each in real if sum(size > 1 for size in each.shape) in (1, 2) and spectral not in each.shape]
    if not options.only:
        return found
    return [
        each for each in found if wanted([each.name, *_own_names(contents, each, max(each.shape)), plain_name(each.name)], options)
    ] or found


def frequency_axis(contents: Contents) -> Variable | None:
    """The vector of frequencies among a file's arrays: called so, and rising.

    >>> frequency_axis(Contents("a.mat", (Held("f", np.array([1.0, -1.0])), Held("freq", np.array([0.0, 0.5]))))).name
    'freq'
    """
    called = (each for each in contents.variables if FREQUENCIES.fullmatch(plain_name(each.name)))
    return next((each for each in called if rises(each)), None)


def _length(contents: Contents, chosen: list[Variable], time: Variable | None) -> int:
    """How many samples the record has: as many as times, else as all arrays share along their longer axis."""
    if OWN_FORM in contents.text("format") and time is None:
        return next((each.shape[0] for each in chosen if each.name == "samples"), max(chosen[0].shape))
    counts = Counter(max(variable.shape) for variable in chosen)
    expected = next(iter(counts)) if time is None else vector_length(time)
    near = [count for count in counts if count != expected and (time is None or abs(count - expected) <= 0.02 * expected)]
    if near or not any(expected in variable.shape for variable in chosen):
        sizes = ", ".join(f"{variable.name} {max(variable.shape)}" for variable in ([time] if time else []) + chosen[:12])
        raise refuse(
            contents.where, f"its arrays differ in length: {sizes}", "Give all as many samples, or name those that are channels (only)"
        )
    return expected


def _axis(variable: Variable, length: int) -> int:
    return variable.shape.index(length)


def _clock(time: Variable | None, stated: float | None, options: Options, contents: Contents) -> Clock:
    if time is None or options.rate:
        return Clock(float(stated or 0.0), 0.0, ((0, 0),))
    scale, source = _time_scale(time), time.samples(int(np.argmax(time.shape)))
    told = Told(stated, allow_gaps=Allow.GAPS in options.allow)
    blocks = (block * scale for block in pieces(time))
    return settled(blocks, lambda number: float(source.read(number, number + 1)[0, 0]) * scale, told, f"{contents.where}: {time.name}")


def _time_scale(time: Variable) -> float:
    """Seconds in the unit of the times."""
    unit = next((str(time.attributes[name]) for name in time.attributes if plain_name(name) in UNIT_NAMES), "s")
    return {"ms": 1e-3, "us": 1e-6, "µs": 1e-6, "ns": 1e-9, "min": 60.0, "h": 3600.0}.get(plain_unit(unit), 1.0)


def _channels(contents: Contents, axes: list[tuple[Variable, int]]) -> tuple[Channel, ...]:
    widths = [int(np.prod(variable.shape)) // variable.shape[axis] for variable, axis in axes]
    total = sum(widths)
    names = _for_all(contents, LABEL_NAMES, total) or _names(contents, axes, widths)
    units = _for_all(contents, UNIT_NAMES, total) or _each(contents, axes, widths, UNIT_NAMES)
    roles = _for_all(contents, ("roles", "role"), total) or _each(contents, axes, widths, ("role", "roles"))
    return tuple(Channel(name, plain_unit(unit), _role(role)) for name, unit, role in zip(names, units, roles, strict=True))


def _for_all(contents: Contents, names: tuple[str, ...], total: int) -> tuple[str, ...]:
    found = contents.text(*names)
    return found if len(found) == total else ()


def _names(contents: Contents, axes: list[tuple[Variable, int]], widths: list[int]) -> tuple[str, ...]:
    short = [variable.name.replace(".", "/").split("/")[-1] for variable, _ in axes]
    plain = short if len(set(short)) == len(short) else [variable.name for variable, _ in axes]
    names: list[str] = []
    for (variable, _), name, width in zip(axes, plain, widths, strict=True):
        own = _own_names(contents, variable, width)
        names += own or ([name] if width == 1 else [f"{name}{number + 1}" for number in range(width)])
    return numbered(names)


def _own_names(contents: Contents, variable: Variable, width: int) -> tuple[str, ...]:
    names = ("name", "channel", "channel_name", "wf_channel", "long_name", *LABEL_NAMES)
    return _beside(contents, variable, names, width)


def _each(contents: Contents, axes: list[tuple[Variable, int]], widths: list[int], names: tuple[str, ...]) -> tuple[str, ...]:
    found: list[str] = []
    for (variable, _), width in zip(axes, widths, strict=True):
        own = _beside(contents, variable, names, width) or _beside(contents, variable, names, 1) * width
        found += own or (_bracketed(variable.name) if names is UNIT_NAMES else "",) * width
    return tuple(found)


def _beside(contents: Contents, variable: Variable, names: tuple[str, ...], width: int) -> tuple[str, ...]:
    """Texts that belong to one array: its attributes, or a list called like it (`y_units`); only as many as it has channels."""
    listed = [value for name in names for key, value in variable.attributes.items() if plain_name(key) == name]
    listed += [contents.text(*(f"{plain_name(variable.name)}_{name}" for name in names))]
    texts = [(each,) if isinstance(each, str) else each for each in listed if not isinstance(each, (int, float))]
    return next((each for each in texts if len(each) == width and any(each)), ())


def _bracketed(name: str) -> str:
    found = re.search(r"[\[(]([^\])]*)[\])]\s*$", name)
    return found[1] if found else ""


def _role(text: str) -> Role:
    return next((role for role in Role if role.value == text.strip().lower()), Role.UNKNOWN)
