"""Tests of a stack: hysteresis from a record, creep from a step record, and the voltage of the inverse model."""

from __future__ import annotations

from collections.abc import Generator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import Annotated, ClassVar

import numpy as np

from flexstage.base.arguments import CheckedFields, check_arguments
from flexstage.base.finding import DesignError, Finding, refuse, require, suggest_nearest
from flexstage.base.notebook import InNotebook
from flexstage.base.number import Array
from flexstage.base.record import VIEW, Heading, Layout
from flexstage.control.hysteresis.creep_record import IdentifiedCreep, identify_creep
from flexstage.control.hysteresis.identify import identify_hysteresis
from flexstage.control.hysteresis.models.inverse import inverse
from flexstage.control.hysteresis.models.shape import Range
from flexstage.control.hysteresis.result import SMALL_ERROR, IdentifiedHysteresis
from flexstage.control.hysteresis.stack import StackHysteresis, stack_hysteresis
from flexstage.experiment.records.record import Channel, Record
from flexstage.experiment.records.unit import in_si, same_dimension, unit_problem


@dataclass(frozen=True)
class Channels(CheckedFields):
    """Channel names of a stack's test. Defaults: the only channel in volts, and the only channel in a unit of length."""

    volts: str | None = None
    stroke: str | None = None


@dataclass(frozen=True, eq=False)
class StackTest(InNotebook):
    """Result of a stack's test: its `hysteresis`, its `creep` if a step was recorded, and the channels used.

    `inverse_volts` (k,) [V] is the inverse model's voltage for the recorded strokes; an exact model would reproduce the applied voltage.
    """

    TABLE: ClassVar[Layout] = Layout(
        "Hysteresis of the stack",
        "hysteresis.range hysteresis.stroke hysteresis.width hysteresis.branches hysteresis.inner hysteresis.rms hysteresis.largest "
        "hysteresis.validation inverse_rms hysteresis.drift creep.law.rate",
        notes=(
            "Errors and drift are divided by the stroke, the width by the major loop's stroke, the inverse's error by the voltage range.",
            "The loop width is the largest distance between the branches. Validation is the error on sections left out of the fit.",
        ),
    )

    hysteresis: IdentifiedHysteresis
    inverse_volts: Array
    channels: Channels
    source: str
    creep: IdentifiedCreep | None = None

    @property
    def stack(self) -> StackHysteresis:
        """Return the test's model as contents of a hysteresis file."""
        law = None if self.creep is None else self.creep.law
        found = self.hysteresis
        return stack_hysteresis(found.model, creep=law, volts=found.range, rms=found.rms, source=self.source)

    @property
    def valid_samples(self) -> Array:
        """Indices (m,) of the samples that do not depend on the unknown history. Errors are computed from these samples."""
        return np.arange(self.hysteresis.known_from, len(self.inverse_volts))

    @property
    def notes(self) -> tuple[str, ...]:
        """Notes on the size of the model, and on the fitted time span of creep."""
        found = self.hysteresis
        plays, knots = found.model.thresholds.shape[1], found.model.before.knots.shape[1]
        size = f"{plays} plays and an envelope of {knots} knots, selected from {len(found.trials)} model sizes."
        creep = () if self.creep is None else ("Creep fit: {:.3g} to {:.3g} s after the step.".format(*self.creep.span),)
        return (size, *creep)

    @property
    def inverse_rms(self) -> Annotated[float, VIEW, Heading("rms error, inverse", digits=3, unit="%", mark=SMALL_ERROR)]:
        """Rms difference between the voltage of the inverse model and the applied voltage, divided by the voltage range."""
        wrong, (low, high) = (self.inverse_volts - self.hysteresis.volts)[self.valid_samples], self.hysteresis.range
        return float(np.sqrt(np.mean(wrong**2))) / (high - low)


@check_arguments
def stack_test(record: Record, channels: Channels = Channels(), *, step: Record | None = None, limits: Range | None = None) -> StackTest:
    """Identify hysteresis from a record of voltage and stroke and, optionally, creep from the record of a `step`.

    Channels are converted to V and m. `limits` are the actuator's voltage limits. Raises `DesignError` for ambiguous channels, for missing
    or wrong units, and in the cases of `identify_hysteresis` and `identify_creep`.

    >>> from flexstage.experiment.records.record import in_memory
    >>> volts = 500.0 * (1.0 - np.cos(np.linspace(0.0, 6.0 * np.pi, 400)))
    >>> strokes = np.where(np.gradient(volts) > 0.0, 0.15 * volts, 0.15 * volts + 4e-5 * volts * (1000.0 - volts))
    >>> test = stack_test(in_memory([Channel("u", "V"), Channel("y", "um")], 100.0, np.column_stack([volts, strokes])))
    >>> round(test.hysteresis.width, 2), test.hysteresis.rms < 0.02
    (0.07, True)
    """
    chosen = _choose_channels(record, channels)
    _, volts, strokes = _samples(record, chosen)
    with _naming(record):
        found = identify_hysteresis(volts, strokes, limits=limits)
    creep = None
    if step is not None:
        times, *both = _samples(step, _choose_channels(step, channels))
        with _naming(step):
            creep = identify_creep(times, *both)
    used = Channels(*(each.name for each in chosen))
    return StackTest(found, inverse(found.model).run(found.strokes), used, record.source, creep)


@contextmanager
def _naming(record: Record) -> Generator[None]:
    """Findings located in the record."""
    try:
        yield
    except DesignError as error:
        where = record.source or "record"
        raise DesignError(replace(finding, where=f"{where}: {finding.where}") for finding in error.findings) from None


def _samples(record: Record, chosen: tuple[Channel, Channel]) -> tuple[Array, Array, Array]:
    """Times [s], volts [V] and strokes [m] (k,)."""
    known = in_si(record)
    columns = [record.names.index(channel.name) for channel in chosen]
    volts, strokes = known.samples.read(0, record.length)[:, columns].T
    return record.start + np.arange(record.length) / record.rate, volts, strokes


def _choose_channels(record: Record, channels: Channels) -> tuple[Channel, Channel]:
    """Channels of voltage and stroke."""
    found = [_choose_channel(record, "volts", "V", channels.volts), _choose_channel(record, "stroke", "m", channels.stroke)]
    require(each for each in found if isinstance(each, Finding))
    volts, stroke = (each for each in found if isinstance(each, Channel))
    if volts.name == stroke.name:
        raise refuse(record.source or "record", f"{volts.name} is selected both for volts and for stroke", "Select two channels")
    return volts, stroke


def _choose_channel(record: Record, kind: str, unit: str, name: str | None) -> Channel | Finding:
    """The named channel, or the only one in this unit; else the reason why there is none."""
    where, (noun, example) = f"{record.source or 'record'}: {kind}", ("volts", "V") if unit == "V" else ("a unit of length", "um")
    fitting = [each for each in record.channels if unit_problem(each.unit) is None and same_dimension(each.unit, unit)]
    if name is None:
        if len(fitting) == 1:
            return fitting[0]
        said = ", ".join(f"{each.name} [{each.unit or 'no unit'}]" for each in record.channels[:12])
        what = f"{len(fitting) or 'none'} of the channels ({said}) {'are' if fitting else 'is'} in {noun}"
        return Finding(where, what, f'Select one with --{kind}, and specify its unit, e.g. --units "NAME={example}"')
    named = next((each for each in record.channels if each.name == name), None)
    if named is None:
        return Finding(where, f"there is no channel {name}", suggest_nearest(name, record.names))
    if named in fitting:
        return named
    if (problem := unit_problem(named.unit)) is not None:
        return Finding(where, f"{name}: {problem}", f'Specify the unit, e.g. --units "{name}={example}"')
    what = f"{name} is in {named.unit} (expected {noun})"
    return Finding(where, what, "Check whether the channels are exchanged, or correct the unit with --units")
