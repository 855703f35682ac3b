"""Identification of a test from the files' contents to modes: what is usable, spectra of it, modes."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Annotated, TypeAlias

import numpy as np

from flexstage.base.finding import DesignError, Finding, join_findings, refuse, require
from flexstage.base.number import Array
from flexstage.base.record import INNER, VIEW
from flexstage.experiment.identification.evidence import choose_segments
from flexstage.experiment.identification.excitation import Excitation
from flexstage.experiment.identification.identified import Identified
from flexstage.experiment.identification.identify import Search, identify
from flexstage.experiment.identification.outputs.unrecorded import identify_decay, identify_floor
from flexstage.experiment.records.health import RecordRequirements, responses_findings, usable_record
from flexstage.experiment.records.options import FaultTolerance
from flexstage.experiment.records.record import Record, Responses, report_reading
from flexstage.experiment.spectral.cross_spectra import Spectra, Tell, pool, spectra
from flexstage.experiment.spectral.transfer import h2, multiple_coherence, spectral_ratio

Told: TypeAlias = Callable[[str, float], None]
"""Told what is done now, and the share of all that is done."""

Measurement: TypeAlias = tuple[Record, ...] | Responses
"""What was measured: records of one stage that belong together, or an analyser's responses."""

_LOOKED, _SPECTRA = 0.1, 0.3
_DEFAULT = Search()


@dataclass(frozen=True, eq=False)
class Identification:
    """A test, the modes found in it, and what its spectra say.

    `multiple` (f, p) is the multiple coherence; `second` and `ratio` are H2 and the paper's T_ij = G_ij/G_ii (Eq. 29), absent where the
    spectra do not give them. All are absent for an analyser's responses. H1 and the ordinary coherence are in `found.responses`.
    """

    test: Annotated[Measurement, INNER]
    found: Annotated[Identified, INNER]
    spectra: Spectra | None = None
    multiple: Array | None = None
    second: Annotated[Responses | None, INNER] = None
    ratio: Annotated[Responses | None, INNER] = None

    @property
    def files(self) -> Annotated[tuple[Record | Responses, ...], VIEW]:
        """What was measured, file by file."""
        return (self.test,) if isinstance(self.test, Responses) else self.test

    @property
    def mean_multiple_coherence(self) -> Annotated[Mapping[str, float] | None, VIEW]:
        """The share of each output's power that all inputs explain, over the band; null for an analyser's responses."""
        if self.spectra is None or self.multiple is None:
            return None
        low, high = self.found.band
        inside = (self.spectra.frequencies >= low) & (self.spectra.frequencies <= high)
        return {channel.name: float(np.mean(self.multiple[inside, row])) for row, channel in enumerate(self.spectra.outputs)}


def usable_measurement(
    contents: Sequence[Record | Responses],
    accept_faults: frozenset[FaultTolerance] = frozenset(),
    requirements: RecordRequirements | None = None,
    told: Told | None = None,
) -> Measurement:
    """What of the files' contents can be used together; raises `DesignError` with every fault that is not allowed.

    Several records are taken for tests of one stage; responses stand alone.

    >>> from flexstage.experiment.example import one_mode_record
    >>> [each.duration for each in usable_measurement([one_mode_record()])]
    [64.0]
    """
    wanted = requirements if requirements is not None else RecordRequirements()
    records = [each for each in contents if isinstance(each, Record)]
    responses = [each for each in contents if isinstance(each, Responses)]
    if responses:
        require(_mixed_kinds(contents))
        return _sound_responses(responses[0], accept_faults, wanted)
    findings: list[Finding] = []
    kept: list[Record] = []
    for index, record in enumerate(records):
        try:
            kept.append(_sound_record(record, accept_faults, wanted, _part_progress(told, index, len(records))))
        except DesignError as error:
            findings += error.findings
    require(join_findings(findings))
    return tuple(kept)


def identification(test: Measurement, search: Search = _DEFAULT, told: Told | None = None) -> Identification:
    """The modes of a test, and the spectra they were found in. Raises `DesignError` as `identify` does.

    >>> from flexstage.experiment.example import one_mode_record
    >>> seen = identification((one_mode_record(),))
    >>> round(float(seen.found.frequencies[0]), 1), seen.multiple.shape[1]
    (10.0, 1)
    """
    if search.excitation is not Excitation.RECORDED:
        return Identification(test, _without_inputs(test, search, _stage_progress(told, "finding modes", _LOOKED, 1.0)))
    if isinstance(test, Responses):
        return Identification(test, identify(test, search, _stage_progress(told, "finding modes", 0.0, 1.0)))
    segments = search.segments if search.segments is not None else choose_segments(test)
    share = (_SPECTRA - _LOOKED) / len(test)
    parts = [
        spectra(record, segments, _stage_progress(told, "spectra", _LOOKED + index * share, _LOOKED + (index + 1) * share))
        for index, record in enumerate(test)
    ]
    found = identify(list(test), search, _stage_progress(told, "finding modes", _SPECTRA, 1.0), parts)
    names = {channel.name for channel in found.inputs}
    known = pool([part.driven(names) for part in parts])
    second = h2(known) if len(known.outputs) >= len(known.inputs) else None
    return Identification(test, found, known, multiple_coherence(known), second, spectral_ratio(known))


def _without_inputs(test: Measurement, search: Search, tell: Tell | None) -> Identified:
    if isinstance(test, Responses):
        what = f"the test is of responses to inputs, and {search.excitation.value} is said to have moved the stage"
        raise refuse(test.where, what, "Leave the excitation out, or give records of outputs")
    find = identify_floor if search.excitation is Excitation.FLOOR else identify_decay
    return find(test, search, tell)


def _sound_record(record: Record, accept_faults: frozenset[FaultTolerance], requirements: RecordRequirements, told: Told | None) -> Record:
    """The usable part of the record itself, not of the one that tells how far it was read."""
    tell = _stage_progress(told, "looking at the record", 0.0, _LOOKED)
    seen = record if tell is None else report_reading(record, lambda stop: tell(stop / max(1, record.length)))
    kept = usable_record(seen, accept_faults, requirements)
    first = round((kept.start - record.start) * record.rate)
    whole = kept.length == record.length
    chosen = record if kept.names == record.names else record.select(kept.names)
    return chosen if whole else chosen.part(first, first + kept.length)


def _sound_responses(responses: Responses, accept_faults: frozenset[FaultTolerance], requirements: RecordRequirements) -> Responses:
    faults = responses_findings(responses, requirements)
    require(fault.finding for fault in faults if fault.kind not in accept_faults)
    dropped = {fault.channel for fault in faults if fault.kind is FaultTolerance.NAMES}
    if responses.coherence is not None:
        responses = replace(responses, coherence=np.clip(np.nan_to_num(responses.coherence), 0.0, 1.0))
    if not dropped:
        return responses
    rows = [index for index, channel in enumerate(responses.outputs) if channel.name not in dropped]
    columns = [index for index, channel in enumerate(responses.inputs) if channel.name not in dropped]
    chosen = np.ix_(range(len(responses.frequencies)), rows, columns)
    return replace(
        responses,
        outputs=tuple(responses.outputs[index] for index in rows),
        inputs=tuple(responses.inputs[index] for index in columns),
        values=responses.values[chosen],
        coherence=None if responses.coherence is None else responses.coherence[chosen],
    )


def _mixed_kinds(contents: Sequence[Record | Responses]) -> list[Finding]:
    if len(contents) == 1:
        return []
    kinds = ", ".join(f"{each.source or each.name or 'one'}: {'record' if isinstance(each, Record) else 'responses'}" for each in contents)
    return [Finding("records", f"responses cannot be put together with others ({kinds})", "Give several records, or responses alone")]


def _stage_progress(told: Told | None, text: str, start: float, stop: float) -> Callable[[float], None] | None:
    return None if told is None else lambda share: told(text, start + share * (stop - start))


def _part_progress(told: Told | None, index: int, count: int) -> Told | None:
    return None if told is None else lambda text, share: told(text, (index * _LOOKED + share) / count)
