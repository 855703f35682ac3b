"""Reports of studies of many designs: self-contained HTML files."""

from __future__ import annotations

import numpy as np

from flexstage.base.storage.digest import digest
from flexstage.base.version import __version__
from flexstage.show.figures.export import to_svg
from flexstage.show.page import Block, Head, Headline, Picture, Section, page, section
from flexstage.show.sections.caveats import caveat_section
from flexstage.show.sections.stage import stage_section
from flexstage.show.table import result_table
from flexstage.show.viewer.data import stage_data
from flexstage.studies.sweeps.definition import Study
from flexstage.studies.sweeps.effects import Effects
from flexstage.studies.sweeps.execution.store import Results
from flexstage.studies.sweeps.loaded import loaded_findings
from flexstage.studies.sweeps.result import Sweep
from flexstage.studies.sweeps.show.figures import designs_figure, effects_figure
from flexstage.studies.sweeps.show.interaction_figures import strongest_figure
from flexstage.studies.sweeps.show.tables import failure_table, limit_notes, pair_table, share_table, variable_table

_STEEP = "All panels of a row have the same scale. The values are means over all designs, in which the other variables vary too."
_STRONGEST = "The strongest pairs of variables. Lines that are not parallel show interaction. Above each panel: fraction of the variance."


def sweep_report(sweep: Sweep) -> str:
    """Write a sweep as an HTML page: distributions first, then variables, main effects, variance contributions, and designs as lines."""
    study, results, found = sweep.study, sweep.results, sweep.effects
    effects = designs = None
    if found.used:
        effects = Picture(to_svg(effects_figure(study, found), "effects", "mean responses as functions of the variables"), _STEEP)
        designs = Picture(to_svg(designs_figure(study, results), "designs", "designs over parallel axes"), _parallel(study, found))
    data = stage_data(study.design)
    sections: list[Section | None] = [
        stage_section(data),
        section("Responses", [result_table(sweep.responses, notes=limit_notes(study, results)), designs]),
        caveat_section(study.design, loaded_findings(study)),
        section("Variables", [variable_table(study, results)]),
        section("Effects", [share_table(found), effects]),
        section("Interactions", _interactions(study, found)),
        section("Designs without values", [failure_table(results)] if results.failures else []),
    ]
    return page(study_head(study, "A sweep of designs", _headline(study, results)), sections, {"stage": data})


def study_head(study: Study, kind: str, said: Headline) -> Head:
    """Return the head of a study's page: its name, its design and the version."""
    origin = (("design", study.design.name), ("physics", digest(study.design, physics=True)[:16]), ("flexstage", __version__))
    return Head(study.name, kind, origin, said)


def _headline(study: Study, results: Results) -> Headline:
    """Number of designs, and of feasible ones."""
    count, failed = len(results.designs), len(results.failures)
    text = f"{count} designs of {len(study.variables)} variables" + (f"; failed designs, without values: {failed}" if failed else "")
    if not study.limits or not count:
        return Headline(f"{text}.")
    kept = int(np.sum(study.feasible(results.responses)))
    return Headline(f"{text}; {kept} meet all limits.", kept > 0)


def _parallel(study: Study, found: Effects) -> str:
    """Caption of the designs over parallel axes."""
    text = f"Each line is a design. Its colour shows {found.responses[0]}, from dark (minimum) to yellow (maximum)"
    return f"{text}. Grey designs do not meet all limits." if study.limits else f"{text}."


def _interactions(study: Study, found: Effects) -> list[Block]:
    """The pairs: table, and the strongest."""
    if not np.any(np.isfinite(found.pairs)):
        return []
    blocks: list[Block] = [pair_table(found)]
    if found.strongest:
        blocks.append(
            Picture(to_svg(strongest_figure(study, found), "strongest", "mean responses as functions of pairs of variables"), _STRONGEST)
        )
    return blocks
