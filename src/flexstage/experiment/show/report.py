"""Reports of tests: identified modes, and comparison with models; one self-contained HTML file each."""

from __future__ import annotations

from dataclasses import replace

from flexstage.analysis.complete import loaded_model
from flexstage.base.storage.digest import digest
from flexstage.base.version import __version__
from flexstage.experiment.comparison import Compared
from flexstage.experiment.pipeline import Identification
from flexstage.experiment.shapes_on_stage import StageShapes
from flexstage.experiment.show.sections import (
    coherence_section,
    compare_section,
    found_section,
    measured_motions,
    measured_shape_section,
    pair_section,
    response_data_section,
    stabilisation_section,
)
from flexstage.mechanism.mechanism import Mechanism
from flexstage.show.display import number, percent
from flexstage.show.page import Head, Headline, Section, page
from flexstage.show.sections.caveats import caveat_section
from flexstage.show.sections.stage import stage_section
from flexstage.show.viewer.data import StageData, stage_data


def identify_report(seen: Identification, mechanism: Mechanism | None = None, shapes: StageShapes | None = None) -> str:
    """Write the modes of a test as an HTML page: tables, responses with fit, coherence, stabilisation and, if a stage is given, shapes.

    >>> from flexstage.experiment.example import one_mode_record
    >>> from flexstage.experiment.pipeline import identification
    >>> identify_report(identification((one_mode_record(),)))[:15]
    '<!doctype html>'
    """
    data = None if mechanism is None else _with_measured(stage_data(mechanism), seen, shapes)
    sections = [None if data is None else stage_section(data), *_sections(seen, shapes, data)]
    return _page("Modes identified in a test", _found_headline(seen), mechanism, seen, sections, data=data)


def compare_report(found: Compared, seen: Identification, mechanism: Mechanism, shapes: StageShapes) -> str:
    """Write the comparison of model, finite elements and test as an HTML page, followed by the test's data."""
    data = _with_measured(stage_data(mechanism, model=loaded_model(mechanism, found.model)), seen, shapes)
    head = [stage_section(data), compare_section(found), pair_section(found, data)]
    sections = [*head, *_sections(seen, shapes, data)]
    return _page("Theory and experiment", _compared_headline(found), mechanism, seen, sections, data=data)


def _with_measured(data: StageData, seen: Identification, shapes: StageShapes | None) -> StageData:
    """Ideal and measured motions of the stage."""
    return data if shapes is None else replace(data, motions=(*data.motions, *measured_motions(seen.found, shapes, data.bones)))


def _found_headline(seen: Identification) -> Headline:
    """Headline: number of identified modes, and their frequency range."""
    found = seen.found.frequencies
    ends = f", {number(float(found[0]), 4)} to {number(float(found[-1]), 4)} Hz" if len(found) else ""
    return Headline(f"{len(found)} {'mode' if len(found) == 1 else 'modes'} found{ends}.")


def _compared_headline(found: Compared) -> Headline:
    """Headline: number of platform modes in the test, and the largest frequency error of the model."""
    seen = [mode for mode in found.modes if mode.difference is not None]
    said = f"{len(seen)} of {len(found.modes)} modes of the platform are found in the experiment"
    if not seen:
        return Headline(f"{said}.", good=False)
    worst = max(seen, key=lambda mode: abs(mode.difference or 0.0))
    off = percent(worst.difference or 0.0, 3)
    return Headline(
        f"{said}; the largest frequency error of theory is {off}, in mode {worst.number} ({worst.name}).", len(seen) == len(found.modes)
    )


def _sections(seen: Identification, shapes: StageShapes | None, data: StageData | None) -> list[Section | None]:
    measured = None if shapes is None or data is None else measured_shape_section(seen.found, shapes, data)
    return [found_section(seen), measured, response_data_section(seen), coherence_section(seen), stabilisation_section(seen.found)]


def _page(
    kind: str,
    said: Headline,
    mechanism: Mechanism | None,
    seen: Identification,
    sections: list[Section | None],
    *,
    data: StageData | None,
) -> str:
    named = ", ".join(each.source for each in seen.files if each.source) or "record"
    origin = [("record", named), ("model", "measured"), ("flexstage", __version__)]
    if mechanism is not None:
        origin.insert(1, ("physics", digest(mechanism, physics=True)[:16]))
    title = (mechanism.name if mechanism is not None else "") or named
    known = None if mechanism is None else caveat_section(mechanism)
    return page(Head(title, kind, tuple(origin), said), (*sections[:2], known, *sections[2:]), {} if data is None else {"stage": data})
