"""The hysteresis file: hysteresis and creep of a stack as TOML with units."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import numpy as np

from flexstage.base.arguments import check_arguments
from flexstage.base.finding import DesignError, refuse
from flexstage.base.storage.store import write
from flexstage.base.units.quantity import DISPLACEMENT, NOT_NEGATIVE, PIEZO_GAIN, POSITIVE, RATIO, TIME, VOLTAGE
from flexstage.control.hysteresis.creep import LogCreep
from flexstage.control.hysteresis.models.envelope import IDENTITY, Envelope, straight
from flexstage.control.hysteresis.models.prandtl_ishlinskii import PrandtlIshlinskii
from flexstage.mechanism.grammar.grammar import node_of
from flexstage.mechanism.store.decode import record_from
from flexstage.mechanism.store.encode import plain
from flexstage.mechanism.store.file import parse_toml, read_text
from flexstage.mechanism.store.lines import with_lines
from flexstage.mechanism.store.schema import schema_of
from flexstage.mechanism.store.toml import text_of

FORMAT = "flexstage hysteresis 1"

_Volts = tuple[Annotated[float, VOLTAGE], ...]
_Strokes = tuple[Annotated[float, DISPLACEMENT], ...]
_COMMENTS = {
    "": "Hysteresis of a stack: stroke = offset + sum of weight x play(threshold); input of the plays: envelope of the volts.",
    "volts": "Voltage range of the record.",
    "rms": "Rms model error on the record, relative to the stroke.",
}


@dataclass(frozen=True)
class Bend:
    """Envelope before the plays, as in a file: `effective` [V] is the input of the plays at `volts` [V]."""

    volts: _Volts
    effective: _Volts


@dataclass(frozen=True)
class OuterBend:
    """Envelope after the plays, as in a file: it maps the weighted sums `plays` [m] of the play outputs to `strokes` [m]."""

    plays: _Strokes
    strokes: _Strokes


@dataclass(frozen=True)
class StackCreep:
    """Creep, as in a file: `rate` is the creep per decade of time, divided by the stroke at the `reference` time after a step."""

    rate: Annotated[float, RATIO]
    reference: Annotated[float, TIME, POSITIVE] = 0.1


@dataclass(frozen=True)
class StackHysteresis:
    """Hysteresis of one stack, as in a file: thresholds, weights, envelopes, range of the record, model error and source.

    `model` and `log_creep` return the stack's model and creep law; `stack_hysteresis` exactly converts a model and a creep law back.
    """

    thresholds: _Volts
    weights: tuple[Annotated[float, PIEZO_GAIN], ...]
    offset: Annotated[float, DISPLACEMENT] = 0.0
    envelope: Bend | None = None
    outer: OuterBend | None = None
    creep: StackCreep | None = None
    volts: _Volts = ()
    rms: Annotated[float, RATIO, NOT_NEGATIVE] | None = None
    source: str = ""

    @property
    def model(self) -> PrandtlIshlinskii:
        """Return the one-axis model. Raises `DesignError` for an invalid model."""
        before = IDENTITY if self.envelope is None else Envelope(np.array(self.envelope.volts), np.array(self.envelope.effective))
        after = straight([1.0], self.offset)
        if self.outer is not None:
            if self.offset:
                what = f"conflicts with the outer envelope, which has its own offset (got {self.offset:g} m)"
                raise refuse("offset", what, "Omit the offset, or the outer envelope")
            after = Envelope(np.array(self.outer.plays), np.array(self.outer.strokes))
        return PrandtlIshlinskii(np.array(self.thresholds), np.array(self.weights), before, after)

    @property
    def log_creep(self) -> LogCreep | None:
        """Return the creep law, or None."""
        return None if self.creep is None else LogCreep(self.creep.rate, self.creep.reference)


@check_arguments
def stack_hysteresis(
    model: PrandtlIshlinskii,
    *,
    creep: LogCreep | None = None,
    volts: tuple[float, float] | None = None,
    rms: float | None = None,
    source: str = "",
) -> StackHysteresis:
    """Convert the hysteresis model of one stack to the contents of a file. Raises `DesignError` for a model with several axes (stacks).

    >>> stack_hysteresis(PrandtlIshlinskii([0.0, 50.0], [1e-7, 2e-8])).weights
    (1e-07, 2e-08)
    """
    if model.axes != 1:
        raise refuse("hysteresis", f"too many axes (got {model.axes}, expected 1)", "Write one file per stack")
    knots, values = model.after.knots[0], model.after.values[0]
    offset = float(values[0]) if knots.tolist() == [0.0, 1.0] else 0.0
    simple = _same(model.after, straight([1.0], offset))
    return StackHysteresis(
        thresholds=tuple(model.thresholds[0].tolist()),
        weights=tuple(model.weights[0].tolist()),
        offset=offset if simple else 0.0,
        envelope=None if _same(model.before, IDENTITY) else Bend(*_pair(model.before)),
        outer=None if simple else OuterBend(*_pair(model.after)),
        creep=None if creep is None else StackCreep(creep.rate, creep.reference),
        volts=() if volts is None else volts,
        rms=rms,
        source=source,
    )


def _same(envelope: Envelope, other: Envelope) -> bool:
    return np.array_equal(envelope.knots, other.knots) and np.array_equal(envelope.values, other.values)


def _pair(envelope: Envelope) -> tuple[tuple[float, ...], tuple[float, ...]]:
    return tuple(envelope.knots[0].tolist()), tuple(envelope.values[0].tolist())


def dumps_hysteresis(stack: StackHysteresis) -> str:
    """Format the text of a hysteresis file.

    >>> print(dumps_hysteresis(stack_hysteresis(PrandtlIshlinskii([0.0, 50.0], [1e-7, 2e-8]), creep=LogCreep(0.02))), end="")
    # Hysteresis of a stack: stroke = offset + sum of weight x play(threshold); input of the plays: envelope of the volts.
    format = "flexstage hysteresis 1"
    thresholds = ["0 V", "50 V"]
    weights = ["100 nm/V", "20 nm/V"]
    creep = { rate = 0.02 }
    """
    tree = {"format": FORMAT} | plain(node_of(StackHysteresis), stack, "")
    return text_of(tree, {key: text for key, text in _COMMENTS.items() if not key or key in tree})


def loads_hysteresis(text: str, *, where: str = "text") -> StackHysteresis:
    r"""Parse the text of a hysteresis file; `where` is the file's name in findings.

    Raises `DesignError` with all errors of the file, including those of an invalid model.

    >>> loads_hysteresis('format = "flexstage hysteresis 1"\nthresholds = ["0 V"]\nweights = ["150 nm/V"]').weights
    (1.5e-07,)
    """
    raw = parse_toml(text, where)
    try:
        stack = record_from(StackHysteresis, raw, FORMAT)
        _ = stack.model, stack.log_creep
    except DesignError as error:
        raise DesignError(with_lines(error.findings, text, where)) from None
    return stack


def hysteresis_schema() -> dict[str, Any]:
    """Return the JSON Schema of a hysteresis file, for editors.

    >>> hysteresis_schema()["required"]
    ['format', 'thresholds', 'weights']
    """
    return schema_of(StackHysteresis, FORMAT, "flexstage hysteresis")


@check_arguments
def dump_hysteresis(stack: StackHysteresis, path: str | os.PathLike[str]) -> Path:
    """Write a hysteresis file and return its path. Raises `DesignError` if the file cannot be written.

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     load_hysteresis(dump_hysteresis(stack_hysteresis(PrandtlIshlinskii([0.0], [1e-7])), f"{folder}/stack.toml")).weights
    (1e-07,)
    """
    return write(path, dumps_hysteresis(stack))


@check_arguments
def load_hysteresis(path: str | os.PathLike[str]) -> StackHysteresis:
    """Read a hysteresis file. Raises `DesignError` with all errors of the file; each error names file, line and key.

    >>> load_hysteresis("nowhere.toml")
    Traceback (most recent call last):
        ...
    flexstage.base.finding.DesignError: nowhere.toml: file not found. Check the path, or write one with "flexstage hysteresis -o".
    """
    if not Path(path).exists():
        raise refuse(os.fspath(path), "file not found", 'Check the path, or write one with "flexstage hysteresis -o"')
    return loads_hysteresis(read_text(path), where=os.fspath(path))
