"""Reports of tolerance studies: one HTML file each that stands alone."""

from __future__ import annotations

import flexstage
from flexstage.base.digest import digest
from flexstage.show.figures.export import to_svg
from flexstage.show.page import Head, Picture, Section, page, section
from flexstage.show.sections.caveats import caveat_section
from flexstage.studies.sweeps.loaded import loaded_findings
from flexstage.studies.sweeps.tables import failure_table
from flexstage.studies.tolerances.figures import crosstalk_figure, crosstalk_title, distributions_figure, shares_figure, yields_figure
from flexstage.studies.tolerances.run import Toleranced
from flexstage.studies.tolerances.tables import allowance_table, crosstalk_table, scatter_table, share_table, spread_table, yield_table

_LIMITS = "Copies by value; black: the design as drawn; red: the limits, and copies beyond them."
_YIELDS = "Share of the copies that keep each line, with its 95 % interval; dashed: what is wanted of each line."
_SHARES = "From exact derivatives where a response is linear in the deviations, else from copies in which one entry scatters alone."
_MATRIX = "Mean and deviation over the copies, row unit per unit of command; the darker, the larger among its kind."


def tolerance_report(found: Toleranced) -> str:
    """A tolerance study as a page of HTML: what scatters, yields, distributions, contributions, allowances, crosstalk."""
    study, said = found.study, found.summary
    drawn = Picture(to_svg(distributions_figure(found), "distributions", "histograms of the responses"), _LIMITS)
    yields = Picture(to_svg(yields_figure(found), "yields", "yields of the specification's lines"), _YIELDS) if said.lines else None
    shares = Picture(to_svg(shares_figure(found), "shares", "shares of the variance"), _SHARES)
    sections: list[Section | None] = [
        caveat_section(study.design, loaded_findings(study)),
        section("What scatters", [scatter_table(found)]),
        section("Yield", [yield_table(found), yields]),
        section("Responses", [spread_table(found), drawn if study.measures else None]),
        section("What does it", [share_table(found), shares if study.measures else None]),
        section("What is allowed", [allowance_table(found)] if said.lines else []),
        *(_crosstalk(found, number) for number in range(len(said.crosstalk))),
        section("Copies without values", [failure_table(found.results)] if found.results.failures else []),
    ]
    origin = (("design", study.design.name), ("physics", digest(study.design, physics=True)[:16]), ("flexstage", flexstage.__version__))
    return page(Head(study.name, "Tolerances", origin), [each for each in sections if each is not None])


def _crosstalk(found: Toleranced, number: int) -> Section | None:
    crosstalk = found.summary.crosstalk[number]
    picture = to_svg(crosstalk_figure(crosstalk), f"crosstalk-{crosstalk.kind}", "pose errors per command")
    return section(f"Crosstalk, {crosstalk_title(crosstalk)}", [crosstalk_table(found, crosstalk), Picture(picture, _MATRIX)])
