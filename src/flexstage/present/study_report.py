"""Reports of studies of many designs: one HTML file each that stands alone."""

from __future__ import annotations

import flexstage
from flexstage.base.digest import digest
from flexstage.present.figures.export import to_svg
from flexstage.present.figures.study import designs_figure, effects_figure
from flexstage.present.page import Head, Picture, Section, page, section
from flexstage.present.tables.study import study_tables
from flexstage.studies.study.definition import Study
from flexstage.studies.study.effects import Effects
from flexstage.studies.study.store import Results

_STEEP = "All panels of a row have one scale: the steeper, the stronger. Means over designs, the other variables anywhere in their ranges."
_PARALLEL = "Each line is a design; colour by the last response."


def sweep_report(study: Study, results: Results, found: Effects) -> str:
    """A sweep as a page of HTML: what was varied, distributions, main effects, shares of variance, designs as lines.

    >>> sweep_report.__name__
    'sweep_report'
    """
    varied, responses, shares, *failures = study_tables(study, results, found)
    effects = Picture(to_svg(effects_figure(study, found), "effects", "mean responses over the variables"), _STEEP)
    designs = Picture(to_svg(designs_figure(results), "designs", "designs over parallel axes"), _PARALLEL)
    sections: list[Section | None] = [
        section("What was varied", [varied]),
        section("Responses", [responses, designs if found.used else None]),
        section("Effects", [shares, effects if found.used else None]),
        section("Designs without values", failures),
    ]
    origin = (("design", study.design.name), ("physics", digest(study.design, physics=True)[:16]), ("flexstage", flexstage.__version__))
    return page(Head(study.name, "A sweep of designs", origin), [each for each in sections if each is not None])
