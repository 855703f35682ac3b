"""Commands of the General Command Set, syntax version 2.0, supported by the virtual controller.

References: two manuals of Physik Instrumente, "E-727 user manual", E727T0005, 2019-06-28 (syntax, wave generator, data recorder), and
"C-863.12 Mercury Controller user manual", MS249E, version 1.2.1 (motion, answers, error codes).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from typing import Any, TypeAlias

import numpy as np

from flexstage.base.number import Array
from flexstage.base.text import printable
from flexstage.base.version import __version__
from flexstage.control.serve import recorder, waves
from flexstage.control.serve.controller import Generator, StageController
from flexstage.control.serve.errors import Code, CommandError

LONGEST = 65_536
"""Maximum line length [bytes]."""
_TABLES = 32
_UPDATE = 0x0E000200
"""Parameter number of "servo update time"."""
_OPTIONS = {
    recorder.NOTHING: "nothing is recorded",
    recorder.TARGET: "target position of axis",
    recorder.POSITION: "current position of axis",
    recorder.ERROR: "position error of axis",
    recorder.VOLTAGE: "voltage of output channel",
}
_TRIGGERS = {0: "default setting", 1: "any command changing target position", 4: "immediately"}


class Session:
    """Session of one client. Each client has its own error code; all clients share the stage."""

    def __init__(self, stage: StageController) -> None:
        self.stage = stage
        self.error = Code.NO_ERROR
        self.trigger = 0

    def hear(self, line: bytes) -> bytes:
        """Execute a line (without line end), and return the answer, possibly empty. After a refusal, `ERR?` returns the error code."""
        if self.stage.is_lost:
            self.stage.is_lost, self.error = False, Code.LOOP_UNSTABLE
        if len(line) > LONGEST:
            return self._refuse(Code.COMMAND_TOO_LONG)
        text = line.decode("latin-1")
        words = [text] if text in COMMANDS else text.split()
        if not words:
            return b""
        command = COMMANDS.get(words[0].upper())
        if command is None:
            return self._refuse(Code.UNKNOWN_COMMAND)
        try:
            found = command[0](self, words[1:])
        except CommandError as error:
            return self._refuse(error.code)
        return b"" if found is None else " \n".join(found).encode("latin-1", "replace") + b"\n"

    def _refuse(self, code: Code) -> bytes:
        self.error = code
        return b""

    def move(self, targets: dict[int, float]) -> None:
        """Move axes to `targets`; a recorder that waits for a motion starts."""
        self.stage.move(targets)
        if self.trigger == 1:
            self.trigger = 0
            self.stage.recorder.start()

    # --- arguments ---

    def axis(self, word: str) -> int:
        """Return the index of an axis."""
        if word not in self.stage.axes:
            raise CommandError(Code.INVALID_AXIS)
        return self.stage.axes.index(word)

    def axes(self, words: Sequence[str]) -> list[int]:
        """Return the indices of the named axes, or of all axes if `words` is empty."""
        return [self.axis(word) for word in words] if words else list(range(len(self.stage.axes)))

    def pairs(self, words: Sequence[str]) -> dict[int, float]:
        """Read pairs of axis and number; a repeated axis is refused."""
        found = {self.axis(name): _number(value) for name, value in _groups(words, 2)}
        if 2 * len(found) != len(words):
            raise CommandError(Code.DOUBLE_AXIS)
        return found

    def places(self, words: Sequence[str], count: int) -> list[int]:
        """Convert numbers from 1 to `count` to zero-based indices; return all indices if `words` is empty."""
        return [_place(word, count) for word in words] if words else list(range(count))


def spelled(name: str) -> str:
    """Return a command name as printed in manuals; a single character is written as `#` and its code."""
    return f"#{ord(name)}" if len(name) == 1 else name


def _number(word: str) -> float:
    with suppress(ValueError):
        if math.isfinite(value := float(word)):
            return value
    raise CommandError(Code.INVALID_NUMBER)


def _integer(word: str, low: int, high: int) -> int:
    value = _number(word)
    if value != int(value) or not low <= value <= high:
        raise CommandError(Code.PARAMETER_OUT_OF_RANGE)
    return int(value)


def _place(word: str, count: int) -> int:
    return _integer(word, 1, count) - 1


def _groups(words: Sequence[str], size: int) -> list[Sequence[str]]:
    if not words or len(words) % size:
        raise CommandError(Code.NUMBER_OF_PARAMETERS)
    return [words[start : start + size] for start in range(0, len(words), size)]


def _exactly(words: Sequence[str], count: int) -> Sequence[str]:
    if len(words) != count:
        raise CommandError(Code.NUMBER_OF_PARAMETERS)
    return words


def _shown(value: float) -> str:
    return f"{round(value, 6) + 0.0:.6f}"


# --- identification ---


Answer: TypeAlias = Callable[[Session, Sequence[str]], Iterable[str] | None]
"""Function that answers a command."""


def _plain(lines: Callable[[StageController], Sequence[str]]) -> Answer:
    """Answer to a command without arguments."""

    def answer(session: Session, words: Sequence[str]) -> Sequence[str]:
        _exactly(words, 0)
        return lines(session.stage)

    return answer


def _help(_: StageController) -> list[str]:
    return ["The following commands are valid:", *(f"{spelled(name)} {meaning}" for name, (_, meaning) in COMMANDS.items()), "end of help"]


def _last_error(session: Session, words: Sequence[str]) -> list[str]:
    _exactly(words, 0)
    found, session.error = session.error, Code.NO_ERROR
    return [str(int(found))]


def _names(session: Session, words: Sequence[str]) -> list[str]:
    if [word.upper() for word in words] not in ([], ["ALL"]):
        raise CommandError(Code.PARAMETER_SYNTAX)
    return list(session.stage.axes)


def _parameter(session: Session, words: Sequence[str]) -> list[str]:
    item, parameter = _exactly(words, 2)
    try:
        known = int(parameter, 0) == _UPDATE
    except ValueError:
        raise CommandError(Code.INVALID_NUMBER) from None
    if item != "1" or not known:
        raise CommandError(Code.UNKNOWN_PARAMETER)
    return [f"1 {parameter}={session.stage.step:.9g}"]


# --- motion ---


def _set_axes(change: Callable[[StageController, int, float], None], *, switches: bool = True) -> Answer:
    """Set a number for each axis: 0 or 1 if it `switches`, else positive."""

    def answer(session: Session, words: Sequence[str]) -> None:
        wanted = session.pairs(words)
        if switches and any(value not in {0.0, 1.0} for value in wanted.values()):
            raise CommandError(Code.PARAMETER_OUT_OF_RANGE)
        if not switches and any(value <= 0.0 for value in wanted.values()):
            raise CommandError(Code.VELOCITY_OUT_OF_LIMITS)
        for axis, value in wanted.items():
            change(session.stage, axis, value)

    return answer


def _of_axes(name: str, shown: Callable[[Any], object] = _shown) -> Answer:
    """Answer `axis=value` for each, with values from the stage's attribute `name`."""
    return lambda session, words: [
        f"{session.stage.axes[axis]}={shown(getattr(session.stage, name)[axis])}" for axis in session.axes(words)
    ]


def _move(session: Session, words: Sequence[str]) -> None:
    session.move(session.pairs(words))


def _move_by(session: Session, words: Sequence[str]) -> None:
    session.move({axis: session.stage.target[axis] + value for axis, value in session.pairs(words).items()})


def _step(session: Session, words: Sequence[str]) -> None:
    name, value = _exactly(words, 2)
    session.stage.jump(session.axis(name), _number(value))


def _stop(session: Session, words: Sequence[str]) -> None:
    _exactly(words, 0)
    session.stage.stop()
    session.error = Code.STOPPED


def _halt(session: Session, words: Sequence[str]) -> None:
    session.axes(words)
    _stop(session, ())


def _bits(flags: Iterable[bool]) -> list[str]:
    return [f"{sum(1 << place for place, flag in enumerate(flags) if flag):X}"]


def _signals(values: Callable[[StageController], Array]) -> Answer:
    """Answer `number=value` for each channel; unknown for non-numeric values."""

    def answer(session: Session, words: Sequence[str]) -> list[str]:
        found = values(session.stage)
        if not np.all(np.isfinite(found)):
            raise CommandError(Code.UNKNOWN_PARAMETER)
        return [f"{channel + 1}={_shown(found[channel])}" for channel in session.places(words, len(found))]

    return answer


# --- wave generator ---


def _wave(session: Session, words: Sequence[str]) -> None:
    if len(words) < 3:
        raise CommandError(Code.NUMBER_OF_PARAMETERS)
    number, append, kind = _integer(words[0], 1, _TABLES), words[1].upper(), words[2].upper()
    if append not in {"X", "&"}:
        raise CommandError(Code.PARAMETER_SYNTAX)
    _require_idle(session, number)
    made = waves.segment(kind, [_number(word) for word in words[3:]])
    tables = session.stage.tables
    whole = np.concatenate([tables[number], made]) if append == "&" and number in tables else made
    if sum(len(each) for name, each in tables.items() if name != number) + len(whole) > waves.LARGEST:
        raise CommandError(Code.WAVE_TOO_LARGE)
    tables[number] = whole


def _require_idle(session: Session, number: int) -> None:
    if any(each.at is not None and each.table == number for each in session.stage.generators):
        raise CommandError(Code.WAVE_GENERATOR_ACTIVE)


def _wave_lengths(session: Session, words: Sequence[str]) -> list[str]:
    found = _groups(words, 2) if words else [(str(number), "1") for number in range(1, _TABLES + 1)]
    if any(parameter != "1" for _, parameter in found):
        raise CommandError(Code.UNKNOWN_PARAMETER)
    numbers = [_integer(number, 1, _TABLES) for number, _ in found]
    return [f"{number} 1={len(session.stage.tables.get(number, ()))}" for number in numbers]


def _clear_waves(session: Session, words: Sequence[str]) -> None:
    numbers = [_integer(word, 1, _TABLES) for word in words] or list(session.stage.tables)
    for number in numbers:
        _require_idle(session, number)
    for number in numbers:
        session.stage.tables.pop(number, None)


def _wave_data(session: Session, words: Sequence[str]) -> list[str]:
    if len(words) < 2:
        raise CommandError(Code.NUMBER_OF_PARAMETERS)
    numbers = [_integer(word, 1, _TABLES) for word in words[2:]] or sorted(session.stage.tables)
    if any(number not in session.stage.tables for number in numbers) or not numbers:
        raise CommandError(Code.NO_WAVE_SELECTED)
    columns = [session.stage.tables[number] for number in numbers]
    return _array(words, columns, [f"Waveform of wave table {number}" for number in numbers], session.stage.step)


def _set_generators(name: str, read: Callable[[str], float], *, idle: bool = False) -> Answer:
    """Set a number of wave generators, only those that are `idle` if required."""

    def answer(session: Session, words: Sequence[str]) -> None:
        generators = session.stage.generators
        found = [(generators[_place(one, len(generators))], read(value)) for one, value in _groups(words, 2)]
        if idle and any(one.at is not None for one, _ in found):
            raise CommandError(Code.WAVE_GENERATOR_ACTIVE)
        for one, value in found:
            setattr(one, name, value)

    return answer


def _set_wave_rate(session: Session, words: Sequence[str]) -> None:
    generators = session.stage.generators
    found = [(one, _integer(rate, 1, 1_000_000), _integer(kind, 0, 1)) for one, rate, kind in _groups(words, 3)]
    for word, rate, kind in found:
        for place in session.places([] if word == "0" else [word], len(generators)):
            generators[place].rate, generators[place].is_straight = rate, kind == 1


def _generate(session: Session, words: Sequence[str]) -> None:
    found = [(_place(one, len(session.stage.axes)), _integer(mode, 0, 1)) for one, mode in _groups(words, 2)]
    before = [each.at for each in session.stage.generators]
    try:
        for one, mode in found:
            if mode:
                session.stage.generate(one)
            else:
                session.stage.generators[one].at = None
    except CommandError:
        for each, at in zip(session.stage.generators, before, strict=True):
            each.at = at
        raise
    if any(mode for _, mode in found):
        session.stage.recorder.start()


def _of_generators(shown: Callable[[Generator], object]) -> Answer:
    """Answer `number=value` for each."""
    return lambda session, words: [
        f"{place + 1}={shown(session.stage.generators[place])}" for place in session.places(words, len(session.stage.generators))
    ]


# --- data recorder ---


def _tables(words: Sequence[str]) -> list[int]:
    try:
        return [_place(word, recorder.TABLES) for word in words] or list(range(recorder.TABLES))
    except CommandError:
        raise CommandError(Code.INVALID_RECORDER_TABLE) from None


def _configure(session: Session, words: Sequence[str]) -> None:
    found = [_recorded(session, *group) for group in _groups(words, 3)]
    for table, source, option in found:
        session.stage.recorder.sources[table], session.stage.recorder.options[table] = source, option
        session.stage.recorder.empty(table)


def _recorded(session: Session, number: str, source: str, option: str) -> tuple[int, int, int]:
    """A table, and its recorded source for an option."""
    (table,), kind = _tables([number]), _number(option)
    if kind not in _OPTIONS or (kind == recorder.VOLTAGE and not session.stage.has_volts):
        raise CommandError(Code.INVALID_RECORDER_OPTION)
    if kind == recorder.NOTHING:
        return table, 0, int(kind)
    try:
        place = _place(source, len(session.stage.volts)) if kind == recorder.VOLTAGE else session.axis(source)
    except CommandError:
        raise CommandError(Code.INVALID_RECORDER_SOURCE) from None
    return table, place, int(kind)


def _source(session: Session, table: int) -> str:
    source, option = session.stage.recorder.sources[table], session.stage.recorder.options[table]
    if option == recorder.NOTHING:
        return "0"
    return str(source + 1) if option == recorder.VOLTAGE else session.stage.axes[source]


def _recorder_options(_: StageController) -> list[str]:
    return [
        "#RecordOptions",
        *(f"{number}={text}" for number, text in _OPTIONS.items()),
        "#TriggerOptions",
        *(f"{number}={text}" for number, text in _TRIGGERS.items()),
        "end of help",
    ]


def _set_trigger(session: Session, words: Sequence[str]) -> None:
    for table, source, _ in _groups(words, 3):
        if table != "0":
            _tables([table])
        if _number(source) not in _TRIGGERS:
            raise CommandError(Code.PARAMETER_OUT_OF_RANGE)
    source = int(_number(words[-2]))
    session.trigger = source if source == 1 else 0
    if source == 4:
        session.stage.recorder.start()


def _set_record_rate(session: Session, words: Sequence[str]) -> None:
    session.stage.recorder.rate = _integer(_exactly(words, 1)[0], 1, 1_000_000)


def _record(session: Session, words: Sequence[str]) -> list[str]:
    held = session.stage.recorder
    tables = _tables(words[2:]) if words[2:] else [table for table in range(recorder.TABLES) if held.options[table]]
    if not tables:
        raise CommandError(Code.NOT_ENOUGH_RECORDED)
    names = [f"{_OPTIONS[held.options[table]]} {_source(session, table)}" for table in tables]
    return _array(words, [held.points[table] for table in tables], names, session.stage.step * held.rate)


def _array(words: Sequence[str], columns: Sequence[np.ndarray], names: Sequence[str], step: float) -> list[str]:
    """A GCS array: a header, then a row per point. `words` may start with the first point (1) and the count."""
    if len(words) == 1:
        raise CommandError(Code.NUMBER_OF_PARAMETERS)
    there = min(len(each) for each in columns)
    first, count = (_integer(words[0], 1, 2**31), _integer(words[1], 0, 2**31)) if words else (1, there)
    if first - 1 + count > there:
        raise CommandError(Code.NOT_ENOUGH_RECORDED)
    rows = np.stack([each[first - 1 : first - 1 + count] for each in columns], axis=-1)
    return [
        "# REM flexstage",
        "#",
        "# VERSION = 1",
        "# TYPE = 1",
        "# SEPARATOR = 32",
        f"# DIM = {len(columns)}",
        f"# SAMPLE_TIME = {step:.9g}",
        f"# NDATA = {count}",
        "#",
        *(f"# NAME{place} = {name}" for place, name in enumerate(names)),
        "#",
        "# END_HEADER",
        *(" ".join(f"{value:.6f}" for value in row) for row in rows.tolist()),
    ]


COMMANDS: dict[str, tuple[Answer, str]] = {
    "\x05": (lambda s, _: _bits(s.stage.moving), "which axes are moving"),
    "\x07": (lambda _s, _: ["\xb1"], "whether the controller is ready"),
    "\x09": (lambda s, _: _bits(each.at is not None for each in s.stage.generators), "which wave generators run"),
    "\x18": (_stop, "stop all axes"),
    "*IDN?": (
        _plain(lambda stage: [f"flexstage,virtual controller,{printable(stage.name).replace(',', ' ')},{__version__}"]),
        "identification",
    ),
    "CSV?": (_plain(lambda _: ["2.0"]), "syntax version"),
    "DRC": (_configure, "set data recorder configuration"),
    "DRC?": (
        lambda s, w: [f"{t + 1}={_source(s, t)} {s.stage.recorder.options[t]}" for t in _tables(w)],
        "get data recorder configuration",
    ),
    "DRL?": (
        lambda s, w: [f"{t + 1}={len(s.stage.recorder.points[t])}" for t in _tables(w)],
        "get number of recorded points",
    ),
    "DRR?": (_record, "get recorded data values"),
    "DRT": (_set_trigger, "set data recorder trigger source"),
    "DRT?": (lambda s, w: [f"{t + 1}={s.trigger} 0" for t in _tables(w)], "get data recorder trigger source"),
    "ERR?": (_last_error, "get error number and clear it"),
    "GWD?": (_wave_data, "get wave table data"),
    "HDR?": (_plain(_recorder_options), "get all data recorder options"),
    "HLP?": (_plain(_help), "get list of available commands"),
    "HLT": (_halt, "halt all axes"),
    "MOV": (_move, "set target position"),
    "MOV?": (_of_axes("target"), "get target position"),
    "MVR": (_move_by, "set target relative to current target"),
    "ONT?": (_of_axes("on_target", int), "get on-target state"),
    "POS?": (_of_axes("position"), "get measured position"),
    "PUN?": (_of_axes("units", str), "get position unit"),
    "RTR": (_set_record_rate, "set number of samples per recorded point"),
    "RTR?": (lambda s, _: [str(s.stage.recorder.rate)], "get number of samples per recorded point"),
    "SAI?": (_names, "get names of the axes"),
    "SPA?": (_parameter, "get a parameter: only the servo update time is available"),
    "STE": (_step, "move an axis by a step, and start the data recorder"),
    "STP": (_stop, "stop all axes"),
    "SVO": (_set_axes(lambda s, axis, value: s.hold(axis, on=value == 1.0)), "switch the servo of an axis on (1) or off (0)"),
    "SVO?": (_of_axes("held", int), "get whether the servo of an axis is on"),
    "TMN?": (_of_axes("low"), "get minimum commandable position"),
    "TMX?": (_of_axes("high"), "get maximum commandable position"),
    "TNR?": (lambda _s, _: [str(recorder.TABLES)], "get number of record tables"),
    "TPC?": (lambda s, _: [str(len(s.stage.volts))], "get number of output channels"),
    "TSC?": (lambda s, _: [str(len(s.stage.readings))], "get number of gauges"),
    "TSP?": (_signals(lambda s: 1e6 * s.readings), "get positions read by the gauges"),
    "TWG?": (lambda s, _: [str(len(s.stage.axes))], "get number of wave generators"),
    "VCO": (_set_axes(lambda s, axis, value: s.is_ramped.__setitem__(axis, value == 1.0)), "switch velocity limit on or off"),
    "VCO?": (_of_axes("is_ramped", int), "get whether the velocity limit of an axis is on"),
    "VEL": (_set_axes(lambda s, axis, value: s.velocity.__setitem__(axis, value), switches=False), "set closed-loop velocity"),
    "VEL?": (_of_axes("velocity"), "get closed-loop velocity"),
    "VER?": (_plain(lambda _: [f"flexstage: {__version__}"]), "get versions"),
    "VOL?": (_signals(lambda s: s.volts), "get voltage of output channel"),
    "WAV": (_wave, "define a waveform in a wave table"),
    "WAV?": (_wave_lengths, "get lengths of wave tables"),
    "WCL": (_clear_waves, "clear wave table data"),
    "WGC": (_set_generators("cycles", lambda word: _integer(word, 0, 2**31)), "set number of wave generator cycles"),
    "WGC?": (_of_generators(lambda g: g.cycles), "get number of wave generator cycles"),
    "WGO": (_generate, "start (1) or stop (0) a wave generator"),
    "WGO?": (_of_generators(lambda g: int(g.at is not None)), "get whether a wave generator runs"),
    "WOS": (_set_generators("offset", _number, idle=True), "set wave generator output offset"),
    "WOS?": (_of_generators(lambda g: _shown(g.offset)), "get wave generator output offset"),
    "WSL": (_set_generators("table", lambda word: _integer(word, 0, _TABLES), idle=True), "select the wave table of a wave generator"),
    "WSL?": (_of_generators(lambda g: g.table), "get the wave table of a wave generator"),
    "WTR": (_set_wave_rate, "set number of samples per point of a wave table"),
    "WTR?": (
        _of_generators(lambda g: f"{g.rate} {int(g.is_straight)}"),
        "get number of samples per point of a wave table",
    ),
}
"""Answers and short descriptions of all commands, by mnemonic, or by character for single-character commands."""
