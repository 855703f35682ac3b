"""Checks of a record: faults by channel, and the usable remainder.

One pass checks everything, and all faults are reported together. Faulty data are omitted only if `FaultTolerance` accepts the fault.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from flexstage.base.arguments import CheckedFields, check_arguments
from flexstage.base.finding import Finding, require, suggest_nearest
from flexstage.base.notebook import InNotebook
from flexstage.base.number import Array
from flexstage.experiment.records.numbers import Numbers, RecordNumbers, count_ends, explained_share, gather
from flexstage.experiment.records.options import FaultTolerance, matches
from flexstage.experiment.records.record import Channel, Record, Responses, Role, names_of, rising_problem
from flexstage.experiment.records.unit import same_dimension, unit_problem

_STILL, _STILL_SHARE = 32, 0.05
_DEAD_BESIDE_OTHERS = 1e-5
_PILE, _PILE_RATIO, _MISSED, _LEVELS = 8, 2.5, 2, 16
"""Clipping criteria: a quantised sine without clipping is at most 2.4 times as long on its highest level as on the next.

Sampling may miss a sample of the next level on either side.
"""
_EXPLAINED, _TIE = 0.9, 1e-6
_SEGMENTS_AN_INPUT = 5
_BROKEN_SHARE = 0.5
_HAMMERS = ("hammer*", "force*", "impact*", "f", "f[0-9]*", "f[xyz]")
_UNWINDOWED = (
    'If the window removed only noise, accept "windowed" to use the force unchanged. Save outputs without an exponential window, which '
    "would add damping"
)


@dataclass(frozen=True)
class RecordRequirements(CheckedFields):
    """Requirements on a record: frequency `resolution` [Hz], number of `averages` at this resolution, frequency of the `highest` mode [Hz].

    `inputs` and `outputs` are the channels of the stage as pairs (name, unit). If `unrecorded` is true, the excitation was not recorded,
    and the record must have no inputs.
    """

    resolution: float | None = None
    averages: int = 8
    highest: float | None = None
    inputs: tuple[tuple[str, str], ...] | None = None
    outputs: tuple[tuple[str, str], ...] | None = None
    unrecorded: bool = False


@dataclass(frozen=True)
class Fault:
    """Fault of a record: the tolerance that accepts it (`kind`; `None`: always an error), its `channel`, and its message `finding`."""

    kind: FaultTolerance | None
    channel: str
    finding: Finding


@dataclass(frozen=True, eq=False)
class Examination(InNotebook):
    """Result of the checks: all faults, and the statistics of every channel by name."""

    faults: tuple[Fault, ...]
    numbers: Mapping[str, Numbers]
    stretch: tuple[int, int]

    @property
    def findings(self) -> tuple[Finding, ...]:
        """Error messages of all faults."""
        return tuple(fault.finding for fault in self.faults)

    def channels(self, kinds: Iterable[FaultTolerance]) -> frozenset[str]:
        """Return the names of channels with a fault of one of these `kinds`."""
        known = frozenset(kinds)
        return frozenset(fault.channel for fault in self.faults if fault.kind in known and fault.channel)


_NEEDS = RecordRequirements()
_Problem: TypeAlias = tuple[FaultTolerance | None, str, str, str]
"""Tolerance, channel (empty: the whole record), description and advice of a fault."""


@check_arguments
def examine(record: Record, requirements: RecordRequirements = _NEEDS) -> Examination:
    """Find all faults of a record.

    Faults are non-finite samples; dead, constant, frozen, clipped or coarsely quantised channels; missing and unknown units; dependent
    inputs; wrong roles and names; an insufficient duration or sampling rate.

    >>> from flexstage.experiment.records.record import in_memory
    >>> noise = np.random.default_rng(1).normal(size=(4096, 2)) * [1.0, 0.0]
    >>> shaken = in_memory([Channel("u1", "V", Role.INPUT), Channel("S1", "um", Role.OUTPUT)], 2048.0, noise)
    >>> [str(finding) for finding in examine(shaken).findings]
    ['record: S1: it is zero throughout. Check cable and range, or accept "dead" to omit the channel.']
    """
    found = gather(record)
    numbers = dict(zip(record.names, found.channels, strict=True))
    problems = (
        *_samples(record, found),
        *_units(record.channels),
        *_dependent(record, found),
        *_roles(record, requirements),
        *_extent(record, requirements),
    )
    return Examination(tuple(_faults(record.where, problems)), numbers, found.stretch)


def usable_record(
    record: Record, accept_faults: frozenset[FaultTolerance] = frozenset(), requirements: RecordRequirements = _NEEDS
) -> Record:
    """Return the usable record, without the faulty data that may be omitted according to `accept_faults`.

    Dead channels, dependent inputs, and channels without a role or absent from the stage are removed. If a record has non-finite samples,
    only its longest interval of finite samples is kept. Raises `DesignError` with every fault that is not accepted.

    >>> from flexstage.experiment.records.record import in_memory
    >>> noise = np.random.default_rng(1).normal(size=(4096, 3)) * [1.0, 0.0, 1.0]
    >>> three = [Channel("u1", "V", Role.INPUT), Channel("S1", "um", Role.OUTPUT), Channel("S2", "um", Role.OUTPUT)]
    >>> usable_record(in_memory(three, 2048.0, noise), frozenset({FaultTolerance.DEAD})).names
    ('u1', 'S2')
    """
    found = examine(record, requirements)
    require(fault.finding for fault in found.faults if fault.kind not in accept_faults)
    dropped = found.channels({FaultTolerance.DEAD, FaultTolerance.DEPENDENT, FaultTolerance.NAMES})
    kept = record.select([name for name in record.names if name not in dropped]) if dropped else record
    roles = _roles(kept, RecordRequirements(unrecorded=requirements.unrecorded))
    require(fault.finding for fault in _faults(record.where, roles))
    if not any(found.numbers[name].broken for name in kept.names):
        return kept
    return kept.part(*(gather(kept).stretch if dropped else found.stretch))


def responses_findings(responses: Responses, requirements: RecordRequirements = _NEEDS) -> list[Fault]:
    """Find faults of stored responses: units, names, frequencies that decrease or end below the highest mode, a coherence above one.

    >>> one = Responses(np.array([1.0, 2.0]), (Channel("S1", "um"),), (Channel("u1", "V"),), np.ones((2, 1, 1), complex))
    >>> [fault.finding.what for fault in responses_findings(one, RecordRequirements(highest=5.0))]
    ['its responses end at 2 Hz, below the highest mode at 5 Hz']
    """
    return _faults(responses.where, _response_problems(responses, requirements))


def _faults(where: str, problems: Iterable[_Problem]) -> list[Fault]:
    return [
        Fault(kind, channel, Finding(f"{where}: {channel}" if channel else where, what, advice)) for kind, channel, what, advice in problems
    ]


def _response_problems(responses: Responses, requirements: RecordRequirements) -> Iterator[_Problem]:
    yield from _units((*responses.outputs, *responses.inputs))
    yield from _name_faults(responses, requirements)
    frequencies = responses.frequencies
    if (falling := rising_problem(frequencies)) is not None:
        yield None, "", falling, "Export each frequency once, from the lowest to the highest"
    elif requirements.highest is not None and requirements.highest > frequencies[-1]:
        what = f"its responses end at {frequencies[-1]:g} Hz, below the highest mode at {requirements.highest:g} Hz"
        yield FaultTolerance.SLOW, "", what, 'Measure a wider band, or accept "slow" to use the available band'
    if responses.coherence is not None:
        yield from _coherence(responses.coherence)


def _coherence(coherence: Array) -> Iterator[_Problem]:
    """Findings for coherence above 1, as some analysers write it for few averages."""
    outside = int(np.sum(~((coherence >= 0.0) & (coherence <= 1.0 + 1e-6))))
    if outside:
        low, high = float(np.nanmin(coherence)), float(np.nanmax(coherence))
        what = f"its coherence ranges from {low:g} to {high:g}: {outside} of {coherence.size} values are outside 0 to 1"
        yield FaultTolerance.CLIPPED, "", what, 'Check the export, or accept "clipped" to limit the coherence to 0 to 1'


def _samples(record: Record, found: RecordNumbers) -> Iterator[_Problem]:
    for channel, numbers in zip(record.channels, found.channels, strict=True):
        name = channel.name
        if numbers.broken:
            yield _broken_samples(record, name, numbers, found.stretch)
        if numbers.broken == record.length:
            continue
        if (windowed := _force_window(record, channel, numbers)) is not None:
            yield FaultTolerance.WINDOWED, name, windowed, _UNWINDOWED
        elif (dead := _dead(record, channel, numbers) or _faint(record, found, channel, numbers)) is not None:
            yield FaultTolerance.DEAD, name, dead, 'Check cable and range, or accept "dead" to omit the channel'
        elif (clipped := _clipped(record, channel, numbers)) is not None:
            size = "wider" if clipped.startswith("it is clipped") else "smaller"
            advice = f'Record with a {size} range, or accept "clipped" to use the channel unchanged'
            yield FaultTolerance.CLIPPED, name, clipped, advice


def _broken_samples(record: Record, name: str, numbers: Numbers, stretch: tuple[int, int]) -> _Problem:
    start, stop = stretch
    first = record.start + numbers.first_broken / record.rate
    what = f"{numbers.broken} of {record.length} samples are not numbers, the first at {first:.6g} s"
    if numbers.broken > _BROKEN_SHARE * record.length:
        return FaultTolerance.DEAD, name, what, 'Record it again, or accept "dead" to omit the channel'
    length = f"{stop - start} samples ({(stop - start) / record.rate:.4g} s)"
    advice = f'The longest finite stretch has {length}: accept "gaps" to use only this stretch'
    return FaultTolerance.GAPS, name, what, advice


def _stands_still(record: Record, numbers: Numbers) -> bool:
    return numbers.still >= max(_STILL, _STILL_SHARE * record.length)


def _with_unit(value: float, channel: Channel) -> str:
    return f"{value:.6g} {channel.unit}".strip()


def _dead(record: Record, channel: Channel, numbers: Numbers) -> str | None:
    if numbers.low == numbers.high:
        return "it is zero throughout" if numbers.low == 0.0 else f"it is constant at {_with_unit(numbers.low, channel)}"
    if not _stands_still(record, numbers):
        return None
    start = record.start + numbers.still_from / record.rate
    stop = start + numbers.still / record.rate
    return f"it is frozen from {start:.6g} s to {stop:.6g} s: {numbers.still} of {record.length} samples are equal"


def _force_window(record: Record, channel: Channel, numbers: Numbers) -> str | None:
    """Findings for a force that is exactly zero after an impact, as some analysers set it: the later force is unknown."""
    force = same_dimension(channel.unit, "N") if unit_problem(channel.unit) is None else matches(channel.name, _HAMMERS)
    zeros = _stands_still(record, numbers) and numbers.still_at == 0.0 and numbers.still_from > 0 and numbers.low != numbers.high
    if not zeros or not force or channel.role is Role.OUTPUT:
        return None
    start, share = record.start + numbers.still_from / record.rate, 100.0 * numbers.still_from / record.length
    zeros = f"{numbers.still} of {record.length} samples"
    return f"it looks force-windowed: exact zeros from {start:.6g} s on, after {share:.3g} % of the record ({zeros})"


def _faint(record: Record, found: RecordNumbers, channel: Channel, numbers: Numbers) -> str | None:
    """Findings for a channel much weaker than all others of its kind."""
    pairs = zip(record.channels, found.channels, strict=True)
    kind = channel.unit, channel.role
    others = [each.rms for other, each in pairs if other is not channel and (other.unit, other.role) == kind and each.rms > 0.0]
    if not others or numbers.rms >= _DEAD_BESIDE_OTHERS * float(np.median(others)):
        return None
    return f"its rms is {numbers.rms:.3g} {channel.unit} (median of similar channels: {float(np.median(others)):.3g} {channel.unit})"


def _clipped(record: Record, channel: Channel, numbers: Numbers) -> str | None:
    if numbers.levels == 1.0 and channel.role is Role.INPUT:
        return None  # a random binary sequence
    if 0.0 < numbers.levels < _LEVELS:
        span = f"{numbers.low:.6g} and {_with_unit(numbers.high, channel)}"
        return f"it has {round(numbers.levels) + 1} levels between {span}: its resolution is too coarse"
    for end, value, pair, tail in (
        ("highest", numbers.high, numbers.pairs[1], numbers.highs),
        ("lowest", numbers.low, numbers.pairs[0], -numbers.lows),
    ):
        at, after = count_ends(tail)
        if pair == value and at >= _PILE and at > _PILE_RATIO * (after + _MISSED):
            return f"it is clipped: at least {at} of {record.length} samples equal its {end} value, {_with_unit(value, channel)}"
    return None


def _units(channels: Iterable[Channel]) -> Iterator[_Problem]:
    for channel in channels:
        if (problem := unit_problem(channel.unit)) is not None:
            advice = 'Specify it (option units), e.g. "S*=um", or accept "units" to use the numbers unchanged'
            yield FaultTolerance.UNITS, channel.name, problem, advice


def _dependent(record: Record, found: RecordNumbers) -> Iterator[_Problem]:
    """Inputs explained by the others, one at a time, until the others are independent."""
    names = names_of(record.inputs)
    alive = [number for number in range(len(names)) if np.real(found.input_spectra[:, number, number]).sum() > 0.0]
    while len(alive) > 1 and found.segments >= _SEGMENTS_AN_INPUT * len(alive):
        shares = _remove_bias(explained_share(found.input_spectra[:, alive][:, :, alive]), len(alive), found.segments)
        worst = int(np.flatnonzero(shares >= shares.max() - _TIE)[-1])  # of equal ones the last
        if shares[worst] < _EXPLAINED:
            return
        name = names[alive.pop(worst)]
        what = f"{100.0 * shares[worst]:.3g} % of its power is explained by the other inputs, {', '.join(names[k] for k in alive)}"
        advice = 'Drive the inputs with independent noise, or accept "dependent" to omit this input: the other inputs explain its effect'
        yield FaultTolerance.DEPENDENT, name, what, advice


def _remove_bias(shares: Array, inputs: int, segments: int) -> Array:
    """Multiple coherence less its bias for independent signals with so few averages."""
    lost = (inputs - 1) / segments
    return np.maximum(0.0, (shares - lost) / (1.0 - lost))


def _roles(record: Record, requirements: RecordRequirements) -> Iterator[_Problem]:
    for channel in record.channels:
        if channel.role is Role.UNKNOWN:
            advice = 'Specify it (options inputs, outputs), or accept the fault "names", which omits the channel'
            yield FaultTolerance.NAMES, channel.name, "its role is unknown", advice
    if requirements.unrecorded and record.inputs:
        what = f"the excitation is unrecorded, but the record has inputs: {', '.join(names_of(record.inputs))}"
        yield None, "", what, "Select only outputs (option channels), or omit the excitation"
    for kind, channels in (("input", record.inputs), ("output", record.outputs)):
        if not channels and not (requirements.unrecorded and kind == "input"):
            what = f"none of its channels ({', '.join(record.names[:12])}) is an {kind}"
            other = ", or specify the excitation (option excitation)" if kind == "input" else ""
            yield None, "", what, f"Specify the {kind}s (option {kind}s) by names or patterns{other}"
    yield from _name_faults(record, requirements)


def _name_faults(test: Record | Responses, requirements: RecordRequirements) -> Iterator[_Problem]:
    """Findings for channels that the stage does not have, and units that contradict the stage's channels."""
    for kind, channels, expected in (("input", test.inputs, requirements.inputs), ("output", test.outputs, requirements.outputs)):
        known = dict(expected or ())
        for channel in channels if expected is not None else ():
            if channel.name not in known:
                advice = f'{suggest_nearest(channel.name, known)}; rename the channel, or accept the fault "names", which omits it'
                yield FaultTolerance.NAMES, channel.name, f"unknown {kind}", advice
            elif unit_problem(channel.unit) is None and not same_dimension(channel.unit, known[channel.name]):
                what = f"wrong unit (got {channel.unit}, expected {known[channel.name]}, the unit of the stage's {kind})"
                yield FaultTolerance.UNITS, channel.name, what, 'Specify its unit, or accept "units" to use the numbers unchanged'


def _extent(record: Record, requirements: RecordRequirements) -> Iterator[_Problem]:
    resolution, averages, highest = requirements.resolution, requirements.averages, requirements.highest
    if resolution is not None and record.duration * resolution < averages:
        got = f"(got {record.duration * resolution:.3g} in {record.duration:.4g} s, expected {averages})"
        what = f"too few averages at a resolution of {resolution:g} Hz {got}"
        advice = f'Request a resolution of {averages / record.duration:.3g} Hz, record longer, or accept "short" to use fewer averages'
        yield FaultTolerance.SHORT, "", what, advice
    if highest is not None and record.rate <= 2.0 * highest:
        what = f"it is sampled at {record.rate:g} Hz, not above twice the frequency of the highest mode, {highest:g} Hz"
        advice = f'Sample at {2.56 * highest:.4g} Hz or more, or accept "slow" to identify only modes below {0.42 * record.rate:g} Hz'
        yield FaultTolerance.SLOW, "", what, advice
