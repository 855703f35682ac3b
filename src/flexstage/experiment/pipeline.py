"""Identification pipeline from file contents to modes: usable data, spectra, modes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
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
from flexstage.experiment.progress import each_part, part
from flexstage.experiment.records.health import RecordRequirements, responses_findings, usable_record
from flexstage.experiment.records.options import FaultTolerance
from flexstage.experiment.records.record import Record, Responses, names_of
from flexstage.experiment.spectral.cross_spectra import Spectra, pool, spectra
from flexstage.experiment.spectral.lines import in_band
from flexstage.experiment.spectral.transfer import h2, multiple_coherence, spectral_ratio

Measurement: TypeAlias = tuple[Record, ...] | Responses
"""Records of one stage, or an analyser's responses."""

_LOOKED, _SPECTRA = 0.1, 0.3
_DEFAULT = Search()


@dataclass(frozen=True, eq=False)
class Identification:
    """Identification of a test: its data, modes and spectra.

    `multiple` (f, p) is the multiple coherence. `second` contains the H2 estimate of the responses; it is absent if there are fewer outputs
    than inputs. `ratio` is T_ij = G_ij/G_ii: the cross spectrum of input i and output j, divided by the spectrum of input i (Shin & Moon,
    equation 29). For an analyser's responses, and without recorded inputs, `multiple`, `second` and `ratio` are absent. `found.responses`
    contains H1 and the ordinary coherence.
    """

    test: Annotated[Measurement, INNER]
    found: Annotated[Identified, INNER]
    spectra: Spectra | None = None
    multiple: Array | None = None
    second: Annotated[Responses | None, INNER] = None
    ratio: Annotated[Responses | None, INNER] = None

    @property
    def files(self) -> Annotated[tuple[Record | Responses, ...], VIEW]:
        """Measured data of each file."""
        return (self.test,) if isinstance(self.test, Responses) else self.test

    @property
    def mean_multiple_coherence(self) -> Annotated[Mapping[str, float] | None, VIEW]:
        """Fraction of each output's power that all inputs explain, averaged over the band; null if spectra are absent."""
        if self.spectra is None or self.multiple is None:
            return None
        inside = in_band(self.spectra.frequencies, self.found.band)
        return {channel.name: float(np.mean(self.multiple[inside, row])) for row, channel in enumerate(self.spectra.outputs)}


def usable_measurement(
    contents: Sequence[Record | Responses],
    accept_faults: frozenset[FaultTolerance] = frozenset(),
    requirements: RecordRequirements | None = None,
) -> Measurement:
    """Check the contents of files and return the usable data; raises `DesignError` with every fault that is not accepted.

    Several records must be tests of one stage. Responses of an analyser cannot be combined with other data.

    >>> from flexstage.experiment.example import one_mode_record
    >>> [each.duration for each in usable_measurement([one_mode_record()])]
    [64.0]
    """
    wanted = requirements or RecordRequirements()
    for responses in contents:
        if isinstance(responses, Responses):
            require(_mixed_kinds(contents))
            return _sound_responses(responses, accept_faults, wanted)
    records = [each for each in contents if isinstance(each, Record)]
    findings: list[Finding] = []
    kept: list[Record] = []
    for index, record in enumerate(records):
        try:
            with part(index * _LOOKED / len(records), (index + 1) * _LOOKED / len(records), "checking the record"):
                kept.append(usable_record(record, accept_faults, wanted))
        except DesignError as error:
            findings += error.findings
    require(join_findings(findings))
    return tuple(kept)


def identification(test: Measurement, search: Search = _DEFAULT) -> Identification:
    """Identify the modes of a test, with spectra and coherences. Raises `DesignError` in the same cases as `identify`.

    >>> from flexstage.experiment.example import one_mode_record
    >>> seen = identification((one_mode_record(),))
    >>> round(float(seen.found.frequencies[0]), 1), seen.multiple.shape[1]
    (10.0, 1)
    """
    if search.excitation is not Excitation.RECORDED or isinstance(test, Responses):
        with part(_LOOKED, 1.0, "finding modes"):
            return Identification(test, (identify if search.excitation is Excitation.RECORDED else _without_inputs)(test, search))
    segments = search.segments or choose_segments(test)
    with part(_LOOKED, _SPECTRA, "spectra"):
        parts = each_part(lambda record: spectra(record, segments), test)
    with part(_SPECTRA, 1.0, "finding modes"):
        found = identify(list(test), search, parts)
    names = names_of(found.inputs)
    known = pool([each.driven(names) for each in parts])
    second = h2(known) if len(known.outputs) >= len(known.inputs) else None
    return Identification(test, found, known, multiple_coherence(known), second, spectral_ratio(known))


def _without_inputs(test: Measurement, search: Search) -> Identified:
    if isinstance(test, Responses):
        what = f"the test contains responses to inputs, but the specified excitation is {search.excitation.value}"
        raise refuse(test.where, what, "Omit the excitation, or use records of outputs")
    return identify_floor(test, search) if search.excitation is Excitation.FLOOR else identify_decay(test, search)


def _sound_responses(responses: Responses, accept_faults: frozenset[FaultTolerance], requirements: RecordRequirements) -> Responses:
    faults = responses_findings(responses, requirements)
    require(fault.finding for fault in faults if fault.kind not in accept_faults)
    dropped = {fault.channel for fault in faults if fault.kind is FaultTolerance.NAMES}
    if responses.coherence is not None:
        responses = replace(responses, coherence=np.clip(np.nan_to_num(responses.coherence), 0.0, 1.0))
    sides = responses.outputs, responses.inputs
    rows, columns = ([index for index, channel in enumerate(side) if channel.name not in dropped] for side in sides)
    return responses.select(rows, columns)


def _mixed_kinds(contents: Sequence[Record | Responses]) -> Iterator[Finding]:
    if len(contents) > 1:
        kinds = ", ".join(f"{each.source or each.name or 'one'}: {each.kind}" for each in contents)
        what = f"responses cannot be combined with other data ({kinds})"
        yield Finding("records", what, "Use several records, or a single file of responses")
