"""Reports of tolerance studies: one HTML file each that stands alone."""

from __future__ import annotations

from dataclasses import replace

from flexstage.base.storage.digest import digest
from flexstage.base.version import __version__
from flexstage.show.display import number
from flexstage.show.figures.export import to_svg
from flexstage.show.page import Head, Headline, Picture, Section, page, section
from flexstage.show.sections.caveats import caveat_section
from flexstage.show.sections.stage import platform_modes, stage_section
from flexstage.show.viewer.data import StageData, stage_data
from flexstage.show.viewer.motions import Group, Motion
from flexstage.studies.sweeps.loaded import loaded_findings
from flexstage.studies.sweeps.show.tables import failure_table
from flexstage.studies.tolerances.run import Toleranced
from flexstage.studies.tolerances.show.figures import distributions_figure
from flexstage.studies.tolerances.show.tables import allowance_table, crosstalk_table, scatter_table, share_table, spread_table, yield_table

_LIMITS = "Copies by value; black: the design as drawn; red: the limits, and copies beyond them."


def tolerance_report(found: Toleranced) -> str:
    """A tolerance study as a page of HTML: yields first, what scatters, distributions, contributions, allowances, crosstalk."""
    study, said = found.study, found.summary
    drawn = Picture(to_svg(distributions_figure(found), "distributions", "histograms of the responses"), _LIMITS)
    data = _spread(found, stage_data(study.design))
    sections: list[Section | None] = [
        stage_section(data),
        section("Yield", [yield_table(found)]),
        caveat_section(study.design, loaded_findings(study)),
        section("What scatters", [scatter_table(found)]),
        section("Responses", [spread_table(found), drawn if study.measures else None]),
        section("What does it", [share_table(found)]),
        section("What is allowed", [allowance_table(found)] if said.lines else []),
        section("Crosstalk", [crosstalk_table(found, each) for each in said.crosstalk]),
        section("Copies without values", [failure_table(found.results)] if found.results.failures else []),
    ]
    origin = (("design", study.design.name), ("physics", digest(study.design, physics=True)[:16]), ("flexstage", __version__))
    return page(Head(study.name, "Tolerances", origin, _headline(found)), sections, {"stage": data})


def _spread(found: Toleranced, data: StageData) -> StageData:
    """The stage's motions, with the spread of the frequencies that the study asks for beside those of the platform's modes."""
    spread = {
        f"{measure.key}": float(found.summary.spread.deviation[column]) for column, measure in enumerate(found.study.measures.values())
    }
    known = {each.name: spread.get(f"frequency.platform.{place}") for place, each in enumerate(platform_modes(data), start=1)}
    return replace(data, motions=tuple(_with_spread(each, known.get(each.name)) for each in data.motions))


def _with_spread(motion: Motion, deviation: float | None) -> Motion:
    if motion.group is not Group.MODE or deviation is None:
        return motion
    return replace(motion, remark=f"{motion.remark}; over the copies \u00b1{number(deviation, 3)} Hz (one standard deviation)")


def _headline(found: Toleranced) -> Headline:
    """The yield of all lines together, and the line that the fewest copies keep."""
    kept = found.summary.together
    if kept is None:
        return Headline(f"{found.summary.copies} copies; no line says what a good one is.")
    said = f"{number(100.0 * kept.share, 4)} % of {kept.copies} copies keep every line"
    worst = min(found.summary.lines, key=lambda line: line.kept.share)
    return Headline(f"{said}; the fewest, {number(100.0 * worst.kept.share, 4)} %, keep {worst.column}.", kept.kept == kept.copies)
