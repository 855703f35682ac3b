"""The first page of a report: verdicts on the requirements, and the stage in a few numbers and sentences."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from flexstage.analysis.assessment.difference import Comparison
from flexstage.analysis.complete import Analysis
from flexstage.show.display import format_value, number, percent
from flexstage.show.page import Fact, Facts, Headline, Prose, Section, section
from flexstage.show.table import first_design, result_table
from flexstage.show.tables.change import set_table
from flexstage.show.tables.requirements import is_met, verdict_table, verdict_text

_SILENT = 1e-9


def headline(analysis: Analysis) -> Headline:
    """How many requirements are met, and the worst margin.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.analysis.complete import Model, analyse
    >>> headline(analyse(double_triangle(), Model.IDEAL)).text
    'All 8 requirements are met; the least margin is 6.01 %, for frequency.platform.1.'
    """
    verdicts = analysis.verdicts
    if not verdicts:
        return Headline("No requirements are stated.")
    return Headline(verdict_text(verdicts), all(map(is_met, verdicts)))


def requirement_section(analysis: Analysis) -> Section | None:
    """Verdicts with their values, those that fail before the others; `None` without requirements.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.analysis.complete import Model, analyse
    >>> requirement_section(analyse(double_triangle(), Model.IDEAL)).blocks[0].texts()[1][:5]
    ['stroke.x', '74.4 um', 'at least 50 um', '+48.8 %', 'met']
    """
    if not analysis.verdicts:
        return None
    note = "Judged by the lumped model, whichever model the rest of this report uses."
    return section("Requirements", [verdict_table(sorted(analysis.verdicts, key=is_met), explained=True), Prose(note)])


def change_section(analysis: Analysis, compared: Comparison | None) -> Section | None:
    """The values that were set, and the key figures before and after; `None` where nothing was set.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.analysis.complete import Model, analyse
    >>> change_section(analyse(double_triangle(), Model.IDEAL), None) is None
    True
    """
    if compared is None:
        return None
    values = set_table(compared.stated, analysis.mechanism, compared.addresses)
    return section("Changes", [values, result_table(compared.figures)])


def summary_section(analysis: Analysis) -> Section | None:
    """The stage in a few numbers and sentences.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.analysis.complete import Model, analyse
    >>> [fact.name for fact in summary_section(analyse(double_triangle(), Model.IDEAL)).blocks[0].items]
    ['Freedoms', 'Stroke along x']
    """
    return section("Summary", [Facts(tuple(_facts(analysis))), *(Prose(text) for text in _sentences(analysis))])


def _facts(analysis: Analysis) -> Iterator[Fact]:
    kinematics = analysis.kinematics
    driven = f"{_count_text(len(kinematics.actuators), 'actuator')}, {_count_text(len(kinematics.gauges), 'gauge')}"
    yield Fact("Freedoms", str(kinematics.mobility), driven)
    if analysis.modes is not None and analysis.modes.platform:
        index = analysis.modes.platform[0]
        frequency = float(first_design(analysis.modes.frequencies, 1)[index])
        yield Fact("First platform mode", format_value(frequency, "Hz", 4), analysis.modes.names[index])
    if analysis.statics is not None:
        most, least = (float(value) for value in first_design(analysis.statics.free.principal, 1))
        spread = "in every direction" if most - least < _SILENT * most else f"to {format_value(most, 'N/m', 4)}"
        yield Fact("Stiffness in the plane", format_value(least, "N/m", 4), spread)
    if analysis.lost_motion is not None:
        losses = np.diagonal(first_design(analysis.lost_motion.loss.values, 2))
        worst = int(np.argmax(np.round(np.abs(losses), 9)))
        yield Fact(
            "Lost motion", percent(_zero_if_noise(float(losses[worst])), 3), f"at worst, actuator {analysis.lost_motion.loss.rows[worst]}"
        )
    yield from _reach_facts(analysis)


def _count_text(count: int, thing: str) -> str:
    return f"{count} {thing}{'' if count == 1 else 's'}"


def _zero_if_noise(share: float) -> float:
    return 0.0 if abs(share) < _SILENT else share


def _reach_facts(analysis: Analysis) -> Iterator[Fact]:
    if analysis.workspace is None:
        return
    single = analysis.workspace.corrected or analysis.workspace.single_axis
    if single.coordinates:
        name = single.coordinates[0]
        value = float(first_design(single.symmetric, 1)[0])
        yield Fact(f"Stroke along {name}", f"±{format_value(value, 'rad' if name.startswith('r') else 'm', 4)}", "one axis at a time")
    stress = analysis.workspace.stress
    if stress is not None and stress.links:
        least = float(first_design(np.atleast_1d(stress.min_safety), 1)[0])
        yield Fact("Least safety factor", number(least, 3), f"against yield, in {stress.weakest}")


def _sentences(analysis: Analysis) -> Iterator[str]:
    if analysis.modes is not None and analysis.modes.platform:
        yield _mode_sentence(analysis)
    if analysis.lost_motion is not None:
        yield _loss_sentence(analysis)
    if analysis.workspace is not None and analysis.workspace.worst_case is not None:
        scale = float(first_design(np.atleast_1d(analysis.workspace.worst_case.scale), 1)[0])
        reached = "can be reached at once" if scale >= 1.0 else f"cannot all be reached at once: at most {percent(scale, 3)} of the box can"
        yield f"The commanded strokes {reached}."


def _mode_sentence(analysis: Analysis) -> str:
    modes = analysis.modes
    if modes is None:
        return ""
    frequencies = first_design(modes.frequencies, 1)
    listed = [f"{name} at {' and '.join(values)} Hz" for name, values in _by_name(analysis, [float(value) for value in frequencies])]
    text = f"The platform's modes are {_join_words(listed)}."
    if modes.local:
        lowest = min(float(frequencies[index]) for index in modes.local)
        text += f" {len(modes.local)} modes of single units lie below 1.5 times the highest of them, the lowest at {number(lowest, 4)} Hz."
    return text


def _by_name(analysis: Analysis, frequencies: list[float]) -> list[tuple[str, list[str]]]:
    modes = analysis.modes
    result: dict[str, list[str]] = {}
    for index in () if modes is None else modes.platform:
        text = number(frequencies[index], 4)
        if modes is not None and text not in result.setdefault(modes.names[index], []):
            result[modes.names[index]].append(text)
    return list(result.items())


def _join_words(items: Sequence[str]) -> str:
    return items[0] if len(items) == 1 else f"{', '.join(items[:-1])} and {items[-1]}"


def _loss_sentence(analysis: Analysis) -> str:
    lost = analysis.lost_motion
    if lost is None:
        return ""
    loss = first_design(lost.loss.values, 2)
    own = np.abs(np.diagonal(loss))
    others = np.abs(loss - np.diag(np.diagonal(loss)))
    if max(own.max(), others.max(initial=0.0)) < _SILENT:
        return "In this model the actuators lose no motion: its springs lie in line with the strokes."
    range_text = f"{percent(float(own.min()), 3)} to {percent(float(own.max()), 3)}" if np.ptp(own) > 1e-4 else percent(float(own.max()), 3)
    taken = f"Elasticity takes {range_text} of the actuators' strokes"
    stirred = float(others.max(initial=0.0))
    return f"{taken}, and up to {percent(stirred, 3)} of a stroke appears as another's." if stirred > _SILENT else f"{taken}."
