"""Reports of optimisations: self-contained HTML files."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from flexstage.analysis.assessment.requirements import Verdict
from flexstage.show.display import format_value
from flexstage.show.figures.export import to_svg
from flexstage.show.page import BlockRow, Headline, Legend, Picture, Prose, Section, Viewer, page, section
from flexstage.show.scene.pictures import stage_picture
from flexstage.show.scene.view import legend
from flexstage.show.sections.caveats import caveat_section
from flexstage.show.sections.stage import first_motion, stage_section
from flexstage.show.viewer.data import StageData, stage_data
from flexstage.studies.optimisation.result import Front, Optimum
from flexstage.studies.optimisation.show.figures import convergence_figure, front_figure
from flexstage.studies.optimisation.show.tables import front_tables, optimise_tables
from flexstage.studies.optimisation.values import values_of
from flexstage.studies.sweeps.loaded import loaded_findings, require_stable
from flexstage.studies.sweeps.show.report import study_head

_SEARCH = "Left: accepted designs of every start; designs with open marks are infeasible. Right: nominal and final value of each variable."


def optimise_report(found: Optimum) -> str:
    """Write an optimisation as an HTML page: objective, variables, limits, binding limits, convergence.

    Raises `DesignError` if the best design is unstable under its permanent load.
    """
    study = found.study
    warnings = () if found.final is None else require_stable(study, values_of(study, found.final.shares))
    objective, variables, limits, *rest = optimise_tables(found)
    search = Picture(to_svg(convergence_figure(found), "search", "objective of accepted designs, variables in their ranges"), _SEARCH)
    final = None if found.final is None else study.mechanism_for(values_of(study, found.final.shares))
    stages = {"stage": stage_data(study.design if final is None else final)} | (
        {} if final is None else {"before": stage_data(study.design)}
    )
    sections: list[Section | None] = [
        _stage(stages),
        section("Objective", [objective, search]),
        caveat_section(study.design, warnings),
        section("Variables", [variables]),
        section("Limits", [limits, *rest[:-1]]),
        section("Starts", rest[-1:]),
    ]
    return page(study_head(study, "An optimisation", _headline(found)), sections, stages)


def _stage(stages: Mapping[str, StageData]) -> Section | None:
    """The final design with the nominal design behind it, or, without a viewer, next to it."""
    if "before" not in stages:
        return stage_section(stages["stage"])
    drawn = {"nominal": stages["before"], "final": stages["stage"]}
    pictures = [_still(each, f"stage{place}", f"The stage, {name}.") for place, (name, each) in enumerate(drawn.items())]
    viewer = Viewer("stage", (BlockRow(tuple(pictures)),), first_motion(stages["stage"]), "before")
    caption = "The final design. In the viewer, the outline shows the nominal design."
    return section("The stage", [viewer, Legend(legend(stages["stage"])), Prose(caption)])


def _still(data: StageData, name: str, caption: str) -> Picture:
    return Picture(to_svg(stage_picture(data, width=4.4), name, caption), caption)


def front_report(found: Front) -> str:
    """Write a Pareto front as an HTML page."""
    picture = Picture(to_svg(front_figure(found), "front", "designs of the front"), "Pareto-optimal designs.")
    data = stage_data(found.study.design)
    sections = [
        stage_section(data),
        section("Front", [picture, *front_tables(found)]),
        caveat_section(found.study.design, loaded_findings(found.study)),
    ]
    headline = Headline(f"{len(found.points)} Pareto-optimal designs.")
    return page(study_head(found.study, "A front of two objectives", headline), sections, {"stage": data})


def _headline(found: Optimum) -> Headline:
    """The objective before and after, and the number of met limits."""
    objective, point = found.definition.objectives[0], found.final
    if point is None:
        return Headline(f"No design found: {found.failure}.", good=False)
    before, after = (format_value(found.value(each), objective.measure.quantity.si) for each in (found.before, point))
    limits = zip(found.limits, point.values[len(found.definition.objectives) :], strict=True)
    kept = [bool(Verdict(each, np.asarray(value)).passed) for each, value in limits]
    kept_text = f"; {sum(kept)} of {len(kept)} limits are met" if kept else ""
    return Headline(f"{objective.name}: {before} in the nominal design, {after} in the final design{kept_text}.", all(kept))
