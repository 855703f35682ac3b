"""Records and responses from the named arrays of a file, by documented names or by names that the user assigns.

A record has `samples` (n, channels) and one of `time` (n,) [s], `rate` [Hz] and `step` [s]. Optional are `start` [s], `name`, and the lists
of strings `names`, `units` and `roles`. Responses have `frequencies` (f,) [Hz] and complex `responses` (f, outputs, inputs). Optional are
`coherence` of the same shape, `output_names`, `output_units`, `input_names`, `input_units`, `window`, `averages` and `name`.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TypeAlias

import numpy as np

from flexstage.base.finding import DesignError, Finding, refuse, require, suggest_nearest
from flexstage.base.number import Array
from flexstage.base.storage.files import Attribute
from flexstage.experiment.records.clock import TIME_SCALES, Clock, clocked_record, determine_clock
from flexstage.experiment.records.options import Arrays, Kind, Options, assign, matches, number_names
from flexstage.experiment.records.record import Channel, ComputedSamples, Record, Responses, Role, Samples, names_of, rising_problem
from flexstage.experiment.records.unit import plain_unit

RECORD_FORM, RESPONSES_FORM = "flexstage record 1", "flexstage responses 1"
"""Format identifiers in files written by flexstage."""
_LISTED = 24
_HERTZ = {"Hz": 1.0, "kHz": 1e3, "1/s": 1.0}
"""Hertz per unit of rates and frequencies."""
_TIMED = "time = seconds({0}.Properties.RowTimes); samples = {0}.Variables; names = {0}.Properties.VariableNames"
_SAVED = {
    "timeseries": "time = {0}.Time; samples = {0}.Data",
    "timetable": _TIMED,
    "table": "samples = {0}.Variables; names = {0}.Properties.VariableNames",
    "iddata": "samples = [{0}.InputData {0}.OutputData]; step = {0}.Ts",
    "idfrd": "frequencies = {0}.Frequency (in Hz); responses = permute({0}.ResponseData, [3 1 2])",
    "frd": "frequencies = {0}.Frequency (in Hz); responses = permute({0}.ResponseData, [3 1 2])",
    "string": "names = cellstr({0})",
    "datetime": "time = seconds({0} - {0}(1))",
    "duration": "time = seconds({0})",
    "Simulink.SimulationData.Dataset": "time = {0}{{1}}.Values.Time; samples = {0}{{1}}.Values.Data",
}
_PLAIN = "{0}'s numbers, time [s] and samples (one column per channel)"


Spans: TypeAlias = tuple[tuple[int, int], ...]
"""Range of an array: start and stop on each axis; empty for the whole array."""


@dataclass(frozen=True, eq=False)
class Variable:
    """Array of a file: its name (with the path in the file), its shape, the function that reads a part of it, and its attributes."""

    name: str
    shape: tuple[int, ...]
    read: Callable[[Spans], Array]
    is_complex: bool = False
    attributes: Mapping[str, Attribute] = field(default_factory=dict[str, Attribute])

    def whole(self) -> Array:
        """Whole array."""
        return self.read(())

    def samples(self, axis: int) -> Samples:
        """Return the array as samples along an axis, read on demand as floats. The other axes are the channels, in order."""

        def read(start: int, stop: int) -> Array:
            spans = [(0, length) for length in self.shape]
            spans[axis] = (start, min(stop, self.shape[axis]))
            values = np.moveaxis(self.read(tuple(spans)), axis, 0)
            return values.reshape(len(values), int(np.prod(values.shape[1:]))).astype(float, copy=False)

        return ComputedSamples(self.shape[axis], read)


def held_array(name: str, values: Array) -> Variable:
    """Wrap an array in memory as a variable.

    >>> held_array("u", np.arange(6.0).reshape(2, 3)).samples(1).read(1, 3).tolist()
    [[1.0, 4.0], [2.0, 5.0]]
    """
    return Variable(name, values.shape, lambda spans: values[tuple(slice(*span) for span in spans)], np.iscomplexobj(values))


@dataclass(frozen=True, eq=False)
class Contents:
    """Contents of a file: the arrays `variables`, and `said`, which maps names to strings, lists or numbers.

    `where` is the name of the file in messages. `objects` maps names to classes of objects that only the program that wrote the file can
    read.
    """

    where: str
    variables: tuple[Variable, ...]
    said: Mapping[str, Attribute] = field(default_factory=dict[str, Attribute])
    objects: Mapping[str, str] = field(default_factory=dict[str, str])

    def find(self, names: tuple[str, ...]) -> tuple[Variable, ...]:
        """Find the arrays whose name equals or matches one of `names`, in the sequence of `names`."""
        fitting = (each for name in names for each in self.variables if matches(each.name, [name]))
        return tuple(dict.fromkeys(fitting))

    def vector(self, names: tuple[str, ...]) -> Variable | None:
        """Return the first real one-dimensional array with one of the names and more than one element; `None` if absent."""
        return next(
            (each for each in self.find(names) if not each.is_complex and 1 < max(each.shape, default=0) == np.prod(each.shape)), None
        )

    def number(self, units: Mapping[str, float], *names: str) -> float | None:
        """Return the first number with one of these names, converted by the factor of its unit; `None` if absent.

        >>> Contents("a.mat", (held_array("data.fs", np.array([[50.0]])),)).number({"Hz": 1.0}, "data.fs")
        50.0
        """
        for each in self.find(names):
            if np.prod(each.shape) == 1:
                return each.whole().item().real * self.scale(each, units)
        return next((value for name in names if isinstance(value := self.said.get(name), float)), None)

    def scale(self, variable: Variable, units: Mapping[str, float]) -> float:
        """Return the factor of a variable's unit, which must be one of `units`; 1 if the variable has no unit."""
        unit = plain_unit(" ".join(_texts(variable.attributes.get("units", ""))))
        if unit and unit not in units:
            what = f'wrong unit (got "{unit}", expected {" or ".join(units)})'
            raise refuse(f"{self.where}: {variable.name}", what, "Use one of these units; the rate can also be specified (option rate)")
        return units.get(unit, 1.0)

    def texts(self, *names: str) -> tuple[str, ...]:
        """Return the list of strings with the first of these names that exists; empty if none exists."""
        return _texts(next((self.said[name] for name in names if name in self.said), ()))

    def text(self, name: str) -> str:
        """Return the string with this name (a list of strings is joined by blanks); empty if absent."""
        return " ".join(self.texts(name))


def describe(what: Record | Responses) -> dict[str, Attribute]:
    """Return the metadata of a record or of responses by name, in the documented form.

    >>> describe(Record((Channel("u", "V"),), 50.0, side_by_side([])))["units"]
    ('V',)
    """
    if isinstance(what, Record):
        said: dict[str, Attribute] = {"format": RECORD_FORM, "rate": float(what.rate), "start": float(what.start)}
        sides = {"": what.channels}
        said["roles"] = tuple(channel.role.value for channel in what.channels)
    else:
        said = {"format": RESPONSES_FORM, "window": what.window, "averages": float(what.averages or 0)}
        sides = {"output_": what.outputs, "input_": what.inputs}
    for side, channels in sides.items():
        said[f"{side}names"] = names_of(channels)
        said[f"{side}units"] = tuple(channel.unit for channel in channels)
    return said | {"name": what.name}


def response_arrays(responses: Responses) -> dict[str, Array]:
    """Build the arrays of responses in the documented form."""
    coherence = {} if responses.coherence is None else {"coherence": responses.coherence}
    return {"frequencies": responses.frequencies, "responses": responses.values} | coherence


def side_by_side(sources: Sequence[Samples]) -> Samples:
    """Concatenate the channels of several sources."""
    return ComputedSamples(
        min((source.length for source in sources), default=0),
        lambda start, stop: np.hstack([source.read(start, stop) for source in sources]),
    )


def complex_of(real: Array, imaginary: Array) -> Array:
    """Combine real and imaginary parts in a complex array; unlike a sum, this keeps the sign of zeros.

    >>> complex_of(np.array([-0.0]), np.array([2.0])).tolist()
    [(-0+2j)]
    """
    whole = np.empty(real.shape, dtype=complex)
    np.real(whole)[...], np.imag(whole)[...] = real, imaginary
    return whole


def read_arrays(contents: Contents, options: Options) -> tuple[Record | Responses, ...]:
    """Read the record, the responses, or both from a file's arrays, according to `options.kind`.

    Raises `DesignError` with a list of the arrays if the file has neither record nor responses, and for unreadable arrays.

    >>> both = (held_array("u", np.zeros((1, 8))), held_array("y", np.ones((8, 2))), held_array("fs", np.array(4.0)))
    >>> (found,) = read_arrays(Contents("a.mat", both), Options(arrays=Arrays(samples=("u", "y"), rate=("fs",))))
    >>> found.names, found.rate, found.values[0].tolist()
    (('u', 'y1', 'y2'), 4.0, [0.0, 1.0, 1.0])
    """
    require(_unknown_names(contents, options.arrays))
    samples, responses = contents.find(options.arrays.samples), contents.find(options.arrays.responses)
    found = list[Record | Responses]()
    if samples and options.kind is not Kind.RESPONSES:
        found.append(_record(contents, samples, options))
    if responses and options.kind is not Kind.RECORD:
        found.append(_responses(contents, responses, options))
    if not found:
        raise _no_arrays(contents, options.kind)
    return tuple(found)


def _unknown_names(contents: Contents, arrays: Arrays) -> Iterator[Finding]:
    known = [*(each.name for each in contents.variables), *contents.said]
    for meaning, name in arrays.stated():
        if any(matches(each, [name]) for each in known):
            continue
        held = next((each for each in contents.objects if matches(each, [name])), None)
        if held is None:
            yield Finding(f"{contents.where}: {meaning}={name}", "unknown array", suggest_nearest(name, known))
        else:
            yield _object_finding(contents, held)


def _object_finding(contents: Contents, name: str) -> Finding:
    kind = contents.objects[name]
    what = f'it is an object of class "{kind}", which only MATLAB can read'
    return Finding(f"{contents.where}: {name}", what, f"Save its contents as plain arrays: {_SAVED.get(kind, _PLAIN).format(name)}")


def _no_arrays(contents: Contents, kind: Kind | None) -> DesignError:
    if contents.objects:
        return DesignError([_object_finding(contents, name) for name in contents.objects])
    missing = {None: '"samples" or "responses"', Kind.RECORD: '"samples"', Kind.RESPONSES: '"responses"'}[kind]
    advice = (
        'Assign the arrays (option array): for a record "samples=..." with "time=...", "rate=..." or "step=...", or specify the rate '
        '(option rate); for responses "responses=..." with "frequencies=..."'
    )
    return refuse(contents.where, f"it has no array {missing}. {list_arrays(contents)}", advice)


def list_arrays(contents: Contents) -> str:
    """Format the arrays of a file with their shapes, single numbers with their values, for a message.

    >>> list_arrays(Contents("a.mat", (held_array("u", np.zeros((8, 2))), held_array("dt", np.array(0.5))), {"note": "run 2"}))
    'It has u (8, 2), dt = 0.5, note "run 2"'
    """
    arrays = [
        f"{each.name} = {each.whole().ravel()[0]:.6g}"
        if np.prod(each.shape) == 1
        else f"{each.name} {each.shape}{' complex' if each.is_complex else ''}"
        for each in contents.variables[:_LISTED]
    ]
    said = [f'{name} "{value[:20]}"' if isinstance(value, str) else f"{name} = {value}" for name, value in contents.said.items()]
    more = len(contents.variables) - _LISTED
    return f"It has {', '.join([*arrays, *([f'{more} more arrays'] if more > 0 else []), *said[:_LISTED]]) or 'none'}"


def _require_real(contents: Contents, chosen: Iterable[Variable]) -> None:
    advice = "Name real arrays with one or two axes"
    require(
        Finding(
            f"{contents.where}: {each.name}", f"unusable as samples (got {'complex' if each.is_complex else f'shape {each.shape}'})", advice
        )
        for each in chosen
        if each.is_complex or not 1 <= len(each.shape) <= 2 or 0 in each.shape
    )


def _record(contents: Contents, chosen: tuple[Variable, ...], options: Options) -> Record:
    _require_real(contents, chosen)
    time = contents.vector(options.arrays.time)
    clock = _clock(contents, time, options)
    axes = _axes(contents, chosen, time, options)
    samples = side_by_side([variable.samples(axis) for variable, axis in axes])
    clock = clock if time is not None else replace(clock, start=contents.number(TIME_SCALES, "start") or 0.0)
    name, channels = contents.text("name"), _channels(contents, axes, options.arrays)
    return clocked_record(channels, samples, clock, options, name=name, where=contents.where)


def _clock(contents: Contents, time: Variable | None, options: Options) -> Clock:
    stated = (
        options.rate
        or contents.number(_HERTZ, *options.arrays.rate)
        or 1.0 / (contents.number(TIME_SCALES, *options.arrays.step) or np.inf)
        or None
    )
    if time is None and stated is None:
        advice = 'Assign the time: "time=...", "rate=..." or "step=..." (option array), or specify the rate (option rate)'
        raise refuse(contents.where, f"times and rate are missing. {list_arrays(contents)}", advice)
    if time is None or options.rate:
        return Clock(float(stated or 0.0))
    times = time.samples(int(np.argmax(time.shape)))
    return determine_clock(times, options, f"{contents.where}: {time.name}", scale=contents.scale(time, TIME_SCALES), stated=stated)


def _axes(contents: Contents, chosen: tuple[Variable, ...], time: Variable | None, options: Options) -> list[tuple[Variable, int]]:
    """Time axis of each array: as long as the times; without times the first, or the longest of arrays named by the user."""
    named = options.arrays.samples != Arrays().samples
    length = max(time.shape) if time is not None else max(chosen[0].shape) if named else chosen[0].shape[0]
    if not all(length in each.shape for each in chosen):
        sizes = ", ".join(f"{each.name} {each.shape}" for each in (*([time] if time is not None else []), *chosen[:_LISTED]))
        raise refuse(contents.where, f"its arrays differ in length: {sizes}", 'Assign arrays of equal length (option array "samples=...")')
    return [(each, each.shape.index(length)) for each in chosen]


def _channels(contents: Contents, axes: list[tuple[Variable, int]], arrays: Arrays) -> tuple[Channel, ...]:
    widths = [int(np.prod(variable.shape)) // variable.shape[axis] for variable, axis in axes]
    variables = [variable for variable, _ in axes]
    names = _texts_by_channel(contents, "names", arrays.names, variables, widths)
    units = _texts_by_channel(contents, "units", arrays.units, variables, widths)
    roles = _texts_by_channel(contents, "roles", ("roles",), variables, widths)
    named = number_names(name or own for name, own in zip(names, _own_names(variables, widths), strict=True))
    known = {role.value: role for role in Role}
    triples = zip(named, units, roles, strict=True)
    return tuple(Channel(name, plain_unit(unit), known.get(role, Role.UNKNOWN)) for name, unit, role in triples)


def _texts_by_channel(
    contents: Contents, kind: str, names: tuple[str, ...], variables: list[Variable], widths: list[int]
) -> tuple[str, ...]:
    """Text per channel: from a list in the file, or from the attributes of its array; empty without both."""
    own = [_texts(variable.attributes.get(kind, ())) for variable in variables]
    found = contents.texts(*names) or tuple(text for each, width in zip(own, widths, strict=True) for text in (each or ("",) * width))
    if len(found) != sum(widths):
        what = f"wrong number of {kind} (got {len(found)}: {', '.join(found[:6])}; expected {sum(widths)}, one per channel)"
        raise refuse(contents.where, what, f'Name the correct list (option array "{kind}=...")')
    return found


def _texts(value: Attribute) -> tuple[str, ...]:
    return value if isinstance(value, tuple) else (str(value),)


def _own_names(variables: list[Variable], widths: list[int]) -> tuple[str, ...]:
    """Channel names from array names: the last part of the path if these differ."""
    short = [re.split(r"[/.]", variable.name)[-1] for variable in variables]
    plain = short if len(set(short)) == len(short) else [variable.name for variable in variables]
    pairs = zip(plain, widths, strict=True)
    return tuple(each for name, width in pairs for each in ([name] if width == 1 else (f"{name}{number + 1}" for number in range(width))))


def _responses(contents: Contents, chosen: tuple[Variable, ...], options: Options) -> Responses:
    """Responses; each of several arrays contains outputs for the same inputs."""
    lines = contents.vector(options.arrays.frequencies)
    if lines is None:
        raise refuse(
            contents.where, f"frequencies are missing. {list_arrays(contents)}", 'Assign the frequencies (option array "frequencies=...")'
        )
    frequencies = lines.whole().ravel() * contents.scale(lines, _HERTZ)
    problem = rising_problem(frequencies)
    if problem is not None:
        raise refuse(f"{contents.where}: {lines.name}", problem, "Export each frequency once, from the lowest to the highest")
    size = len(frequencies)
    require(_no_responses(contents.where, chosen, size))
    cubes = [_cube(each, size) for each in chosen]
    if len({cube.shape[2] for cube in cubes}) > 1:
        shapes = ", ".join(f"{each.name} {each.shape}" for each in chosen)
        raise refuse(contents.where, f"different numbers of inputs: {shapes}", "Name the correct responses (option array)")
    values = np.concatenate(cubes, axis=1)
    averages = contents.number({"1": 1.0}, "averages")
    several = len(chosen) == values.shape[1]
    own = _own_names(list(chosen), [1] * len(chosen)) if several else tuple(f"y{number + 1}" for number in range(values.shape[1]))
    outputs = _side(contents, "output", own, options.outputs)
    names = ("input",) if values.shape[2] == 1 else tuple(f"u{number + 1}" for number in range(values.shape[2]))
    whole = Responses(
        frequencies,
        outputs,
        _side(contents, "input", names, options.inputs),
        values,
        _coherence(contents, values.shape, options.arrays),
        window=contents.text("window"),
        averages=int(averages) if averages is not None and 1.0 <= averages < np.inf else None,
        name=contents.text("name"),
        source=contents.where,
    )
    require(_not_finite(contents.where, values, outputs))
    return _select(whole, options)


def _no_responses(where: str, chosen: Iterable[Variable], size: int) -> Iterator[Finding]:
    for each in chosen:
        if not each.is_complex or size not in each.shape:
            what = f"unusable as responses at {size} frequencies (got {'complex' if each.is_complex else 'real'} array, shape {each.shape})"
            yield Finding(f"{where}: {each.name}", what, "Name complex arrays (frequencies, outputs, inputs)")


def _cube(variable: Variable, size: int) -> Array:
    """Array as (frequencies, outputs, inputs); the frequency axis is the first of that length."""
    values = np.moveaxis(variable.whole(), variable.shape.index(size), 0)
    rest = values.shape[1:] if values.ndim <= 3 else tuple(length for length in values.shape[1:] if length > 1)
    if len(rest) > 2:
        raise refuse(variable.name, f"wrong number of axes (got shape {variable.shape})", "Store frequencies, outputs and inputs")
    return values.reshape(size, *rest, *[1] * (2 - len(rest)))


def _side(contents: Contents, side: str, own: tuple[str, ...], given: tuple[str, ...]) -> tuple[Channel, ...]:
    """Outputs or inputs named by the file, else by the user, else by their arrays."""
    names, units = (_as_many(contents.texts(f"{side}_{kind}"), own) for kind in ("names", "units"))
    plain = not any(sign in name for name in given for sign in "*?[")
    names = names or (_as_many(given, own) if plain else ()) or own
    pairs = zip(number_names(names), units or ("",) * len(own), strict=True)
    return tuple(Channel(name, plain_unit(unit), Role(side)) for name, unit in pairs)


def _as_many(texts: tuple[str, ...], own: tuple[str, ...]) -> tuple[str, ...]:
    return texts if len(texts) == len(own) else ()


def _coherence(contents: Contents, shape: tuple[int, ...], arrays: Arrays) -> Array | None:
    """Coherence stored with the responses. Raises `DesignError` for a wrong shape."""
    stored = contents.find(arrays.coherence)
    if not stored:
        return None
    if not any(each.is_complex or shape[0] not in each.shape for each in stored):
        whole = np.concatenate([_cube(each, shape[0]) for each in stored], axis=1).astype(float)
        if whole.shape == shape:
            return whole
    sizes = ", ".join(f"{each.name} {each.shape}" for each in stored)
    raise refuse(
        contents.where,
        f"wrong shape of the coherence (got {sizes}, expected {shape}, the shape of the responses)",
        'Assign the coherence (option array "coherence=...")',
    )


def _not_finite(where: str, values: Array, outputs: tuple[Channel, ...]) -> Iterator[Finding]:
    for column, output in enumerate(outputs):
        broken = int(np.count_nonzero(~np.isfinite(values[:, column])))
        if broken:
            what = f"{broken} of {values[:, column].size} responses are not numbers"
            yield Finding(f"{where}: {output.name}", what, "Export the responses again")


def _select(responses: Responses, options: Options) -> Responses:
    """Responses with the user's units; only the selected channels."""
    count = len(responses.outputs)
    whole = assign((*responses.outputs, *responses.inputs), Options(units=options.units), responses.source)
    sides = (("outputs", whole[:count], options.outputs), ("inputs", whole[count:], options.inputs))
    rows, columns = (_positions(known, asked) for _, known, asked in sides)
    require(
        Finding(
            f"{responses.source}: {kind}",
            f"none of {', '.join(names_of(known))} is called {', '.join(asked)}",
            "Check the names",
        )
        for kind, known, asked in sides
        if not _positions(known, asked)
    )
    return replace(responses, outputs=whole[:count], inputs=whole[count:]).select(rows, columns)


def _positions(channels: tuple[Channel, ...], patterns: tuple[str, ...]) -> list[int]:
    return [number for number, channel in enumerate(channels) if not patterns or matches(channel.name, patterns)]
