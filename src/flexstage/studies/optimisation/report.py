"""Reports of optimisations: one HTML file each that stands alone."""

from __future__ import annotations

import flexstage
from flexstage.base.digest import digest
from flexstage.show.figures.export import to_svg
from flexstage.show.page import Head, Picture, Section, page, section
from flexstage.show.sections.caveats import caveat_section
from flexstage.studies.optimisation.figures import convergence_figure, front_figure
from flexstage.studies.optimisation.result import Front, Optimum
from flexstage.studies.optimisation.tables import front_tables, optimise_tables
from flexstage.studies.optimisation.values import values_of
from flexstage.studies.sweeps.definition import Study
from flexstage.studies.sweeps.loaded import loaded_findings, require_stable

_SEARCH = (
    "Left: accepted designs of every start; open: some limit is not kept. Right: each variable in its range, as it stands and at the end."
)


def optimise_report(found: Optimum) -> str:
    """An optimisation as a page of HTML: objective, variables, limits, what binds, convergence.

    Raises `DesignError` where the best design does not hold under its dead load.
    """
    study = found.study
    cautions = () if found.final is None else require_stable(study, values_of(study, found.final.shares))
    objective, variables, limits, *rest = optimise_tables(found)
    search = Picture(to_svg(convergence_figure(found), "search", "objective over accepted designs, variables in their ranges"), _SEARCH)
    sections: list[Section | None] = [
        caveat_section(study.design, cautions),
        section("Objective", [objective, search]),
        section("Variables", [variables]),
        section("Limits", [limits, *rest[:-1]]),
        section("Starts", rest[-1:]),
    ]
    return page(_head(study, "An optimisation"), [each for each in sections if each is not None])


def front_report(found: Front) -> str:
    """A front as a page of HTML."""
    picture = Picture(to_svg(front_figure(found), "front", "designs of the front"), "None of these designs is better in both objectives.")
    sections = [caveat_section(found.study.design, loaded_findings(found.study)), section("Front", [picture, *front_tables(found)])]
    return page(_head(found.study, "A front of two objectives"), [each for each in sections if each is not None])


def _head(study: Study, kind: str) -> Head:
    origin = (("design", study.design.name), ("physics", digest(study.design, physics=True)[:16]), ("flexstage", flexstage.__version__))
    return Head(study.name, kind, origin)
