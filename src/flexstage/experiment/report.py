"""The reports of tests: modes found in records, and theory beside them; one HTML file each that stands alone."""

from __future__ import annotations

import flexstage
from flexstage.base.digest import digest
from flexstage.experiment.comparison import Compared
from flexstage.experiment.pipeline import Identification
from flexstage.experiment.record import Responses
from flexstage.experiment.sections import (
    coherence_section,
    compare_section,
    found_section,
    measured_shape_section,
    response_data_section,
    stabilisation_section,
)
from flexstage.experiment.shapes_on_stage import StageShapes
from flexstage.mechanism.mechanism import Mechanism
from flexstage.show.page import Head, Section, page
from flexstage.show.scene.stage import scene
from flexstage.show.sections.caveats import caveat_section


def identify_report(seen: Identification, mechanism: Mechanism | None = None, shapes: StageShapes | None = None) -> str:
    """Modes found in a test as a page of HTML: tables, responses with the fit, coherence, stabilisation; with a stage, shapes on it.

    >>> from flexstage.experiment.example import one_mode_record
    >>> from flexstage.experiment.pipeline import identification
    >>> identify_report(identification((one_mode_record(),)))[:15]
    '<!doctype html>'
    """
    return _page("Modes identified in a test", mechanism, seen, _sections(seen, mechanism, shapes))


def compare_report(found: Compared, seen: Identification, mechanism: Mechanism, shapes: StageShapes) -> str:
    """Theory, FEA and experiment as a page of HTML, followed by what the experiment rests on."""
    return _page("Theory and experiment", mechanism, seen, [compare_section(found), *_sections(seen, mechanism, shapes)])


def _sections(seen: Identification, mechanism: Mechanism | None, shapes: StageShapes | None) -> list[Section | None]:
    drawn = None if mechanism is None or shapes is None else measured_shape_section(seen.found, shapes, scene(mechanism))
    return [found_section(seen), drawn, response_data_section(seen), coherence_section(seen), stabilisation_section(seen.found)]


def _page(kind: str, mechanism: Mechanism | None, seen: Identification, sections: list[Section | None]) -> str:
    sources = [seen.test.source] if isinstance(seen.test, Responses) else [each.source for each in seen.test]
    named = ", ".join(each for each in sources if each) or "record"
    origin = [("record", named), ("model", "measured"), ("flexstage", flexstage.__version__)]
    if mechanism is not None:
        origin.insert(1, ("physics", digest(mechanism, physics=True)[:16]))
    title = (mechanism.name if mechanism is not None else "") or named
    known = None if mechanism is None else caveat_section(mechanism)
    return page(Head(title, kind, tuple(origin)), [each for each in (known, *sections) if each is not None])
