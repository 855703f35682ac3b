"""Reports of tolerance studies: self-contained HTML files."""

from __future__ import annotations

from flexstage.show.display import number
from flexstage.show.figures.export import to_svg
from flexstage.show.page import Headline, Picture, Section, page, section
from flexstage.show.sections.caveats import caveat_section
from flexstage.show.sections.stage import stage_section
from flexstage.show.viewer.data import stage_data
from flexstage.studies.sweeps.loaded import loaded_findings
from flexstage.studies.sweeps.show.report import study_head
from flexstage.studies.sweeps.show.tables import failure_table
from flexstage.studies.tolerances.run import Toleranced
from flexstage.studies.tolerances.show.figures import distributions_figure
from flexstage.studies.tolerances.show.tables import allowance_table, crosstalk_table, scatter_table, share_table, spread_table, yield_table

_LIMITS = "Histograms of all samples. Black: the nominal design. Red: the limits, and samples that violate them."


def tolerance_report(found: Toleranced) -> str:
    """Write a tolerance study as an HTML page: yields, scatter, distributions, variance contributions, allowable tolerances, crosstalk."""
    study, statistics = found.study, found.summary
    drawn = Picture(to_svg(distributions_figure(found), "distributions", "histograms of the responses"), _LIMITS)
    data = stage_data(study.design)
    sections: list[Section | None] = [
        stage_section(data),
        section("Yield", [yield_table(found)]),
        caveat_section(study.design, loaded_findings(study)),
        section("Scatter", [scatter_table(found)]),
        section("Responses", [spread_table(found), drawn if study.measures else None]),
        section("Variance contributions", [share_table(found)]),
        section("Allowable tolerances", [allowance_table(found)] if statistics.lines else []),
        section("Crosstalk", [crosstalk_table(found, each) for each in statistics.crosstalk]),
        section("Failed samples", [failure_table(found.results)] if found.results.failures else []),
    ]
    return page(study_head(study, "Tolerances", _headline(found)), sections, {"stage": data})


def _headline(found: Toleranced) -> Headline:
    """The total yield, and the requirement with the lowest yield."""
    kept = found.summary.together
    if kept is None:
        return Headline(f"{found.summary.copies} samples, without a specification.")
    text = f"{number(100.0 * kept.share, 4)} % of {kept.copies} samples meet all requirements"
    worst = min(found.summary.lines, key=lambda line: line.kept.share)
    return Headline(f"{text}; lowest yield {number(100.0 * worst.kept.share, 4)} %, for {worst.column}.", kept.kept == kept.copies)
