"""Summary of an analysis on one screen: the platform axis by axis, modes, lost motion, the verdict and its reasons."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace

import numpy as np

from flexstage.analysis.assessment import measures
from flexstage.analysis.assessment.measures import MeasureKind
from flexstage.analysis.assessment.requirements import Verdict
from flexstage.analysis.complete import Analysis, Model
from flexstage.analysis.dynamics.modes import Modes
from flexstage.analysis.workspace.strength import HingeStress
from flexstage.base.labelled import NOISE
from flexstage.base.number import first_design
from flexstage.models.batch.choice import platform_rows
from flexstage.models.linear.model import LinearModel
from flexstage.models.linear.undetermined import floats
from flexstage.parts.profile import single
from flexstage.show.display import NO_VALUE, format_value, number, percent
from flexstage.show.table import Cell, Column, Mark, Table, first_rows, make_table, merge_rows, optional, result_table
from flexstage.show.tables.lost_motion import loss_table
from flexstage.show.tables.requirements import margin_text, rank, value_text, verdict_table, verdict_text
from flexstage.spatial.frame import COMPONENTS, MOTION, WRENCH_UNITS

_DIGITS = 4
_ROWS = 8
_LOSS = 3
"""Number of columns in the table of lost motion, up to the loss."""
_NO_REQUIREMENTS = "no requirements. Add a table [requirements] to the design file."


def stage_text(analysis: Analysis) -> str:
    """Describe the analysed stage in one line: model, DOFs, actuators and gauges.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.analysis.complete import Model, analyse
    >>> stage_text(analyse(double_triangle(), Model.IDEAL))
    'double triangle, ideal model: 6 DOFs (x, y, z, rx, ry, rz), 6 actuators, 6 gauges'
    """
    found = analysis.kinematics
    free = f"{count_text(found.mobility, 'DOF')} ({', '.join(found.coordinates)})" if found.coordinates else "no DOF"
    driven = [count_text(len(found.actuators), "actuator")] if found.actuators or not found.thrusts else []
    forced = [count_text(len(found.thrusts), "force actuator")] if found.thrusts else []
    with_bodies = " with elastic bodies" if analysis.mechanism.elastic_bodies and analysis.model is Model.LUMPED else ""
    things = ", ".join([free, *driven, *forced, count_text(len(found.gauges), "gauge")])
    return f"{analysis.mechanism.name or 'stage'}, {analysis.model.value} model{with_bodies}: {things}"


def load_line(analysis: Analysis) -> str | None:
    """Describe the effect of weight, payloads and forces; `None` if unknown or without a load.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.analysis.complete import Model, analyse
    >>> load_line(analyse(double_triangle(), Model.IDEAL)) is None
    True
    """
    return None if analysis.loaded is None else analysis.loaded.text or None


def floating_line(model: LinearModel | None) -> str | None:
    """Describe platform motions without stiffness, and the actuators that drive them; `None` if all platform motions have stiffness.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.lumped import lumped
    >>> floating_line(lumped(double_triangle())) is None
    True
    """
    if model is None or model.floating is None:
        return None
    twist = np.abs(platform_rows(model) @ model.floating).T
    axes = [name for name, moved in zip(COMPONENTS, np.any(twist > NOISE * np.max(twist), axis=0), strict=True) if moved]
    driving = [name for name, drives in zip(model.actuators, floats(model, model.actuators), strict=True) if drives]
    modes = "a mode" if len(twist) == 1 else f"{len(twist)} modes"
    where = f"Motion along {', '.join(axes)}, driven by {', '.join(driving)}, has no stiffness"
    return f"{where}: {modes} at 0 Hz. Static stiffness, and strokes under force, are undefined along these axes."


def small_line(analysis: Analysis) -> str | None:
    """Describe the error of linear kinematics over the strokes; `None` if unknown.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.analysis.complete import Model, analyse
    >>> small_line(analyse(double_triangle(), Model.MAPPED)).partition(" (")[0]
    'Over the strokes the error of linear kinematics is up to 0.0016 %'
    """
    return None if analysis.second_order is None else analysis.second_order.text


def count_text(count: int, thing: str) -> str:
    """Format a count with its noun in singular or plural.

    >>> count_text(2, "gauge")
    '2 gauges'
    """
    return f"{count} {thing}{'' if count == 1 else 's'}"


def overview_tables(analysis: Analysis) -> Iterator[Table | str | None]:
    """Make the tables of the requirements and of the summary. The first table of the summary has no notes."""
    yield verdict_table(analysis.verdicts)
    yield from summary_tables(analysis, explained=False)


def summary_tables(analysis: Analysis, *, explained: bool) -> Iterator[Table | str | None]:
    """Make the summary: the platform's axes and modes, lost motion, and strength. If `explained`, the first table has notes.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.analysis.complete import Model, analyse
    >>> [each.title for each in summary_tables(analyse(double_triangle(), Model.IDEAL), explained=True) if isinstance(each, Table)]
    ['Platform']
    """
    yield floating_line(analysis.linear)
    axes = axis_table(analysis)
    yield axes if explained or axes is None else replace(axes, notes=())
    yield optional(_platform_modes, analysis.modes)
    yield optional(lowest_mode, analysis.modes)
    yield None if analysis.lost_motion is None else _first_rows(loss_table(analysis.lost_motion))
    yield "\n".join(filter(None, (_strength_text(analysis), load_line(analysis), small_line(analysis)))) or None


def axis_table(analysis: Analysis) -> Table | None:
    """Tabulate the platform axis by axis: stroke and its limit, stiffness, resolution; `None` if the model has none of these results.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.analysis.complete import Model, analyse
    >>> axis_table(analyse(double_triangle(), Model.MAPPED)).texts()[3]
    ['z', '+-300 um', 'B4', '10.09 N/um', '10 nm']
    """
    strokes, stiffness, resolution = _strokes(analysis), _stiffness(analysis), _resolution(analysis)
    columns = {
        Column("stroke"): {name: text for name, (text, _) in strokes.items()},
        Column("limited by", numeric=False): {name: cause for name, (_, cause) in strokes.items()},
        Column("stiffness"): stiffness,
        Column("resolution"): resolution,
    }
    heads = [head for head, texts in columns.items() if texts]
    if not heads:
        return None
    rows = [
        (Cell(name, Mark.STRONG), *(Cell(columns[head][name]) if name in columns[head] else Cell(NO_VALUE, Mark.FAINT) for head in heads))
        for name in COMPONENTS
        if any(name in texts for texts in columns.values())
    ]
    return make_table("Platform", ["along", *heads], rows, notes=[_axis_note(analysis)])


def _axis_note(analysis: Analysis) -> str:
    said = {
        "Strokes: one axis at a time, with corrected lost motion": analysis.workspace is not None and analysis.lost_motion is not None,
        "Strokes: one axis at a time": analysis.workspace is not None and analysis.lost_motion is None,
        "Strokes: elastic motion that can be held continuously": analysis.force_workspace is not None,
        "Stiffness of an axis: under a load along this axis, with fixed actuators and the other axes free": analysis.statics is not None,
        "Resolution: largest pose error if the reading of every gauge is wrong by one step": bool(_resolution(analysis)),
    }
    return "".join(f"{text}. " for text, there in said.items() if there).rstrip()


def _strokes(analysis: Analysis) -> Mapping[str, tuple[str, str]]:
    """Stroke in both directions and its limit, by coordinate."""
    reach, forced = analysis.workspace, analysis.force_workspace
    if reach is not None:
        single = reach.corrected or reach.single_axis
        rows = single.coordinates, single.symmetric, single.limiting
    elif forced is not None:
        rows = forced.coordinates, forced.held, forced.limited_by
    else:
        return {}
    return {
        name: (NO_VALUE if np.isnan(value) else f"+-{_shown(value, name)}", cause or "no limit specified")
        for name, value, cause in zip(rows[0], np.real(first_design(rows[1], 1)), rows[2], strict=True)
    }


def _stiffness(analysis: Analysis) -> Mapping[str, str]:
    """One over the diagonal of the compliance, by axis; nothing for an axis without stiffness."""
    if analysis.statics is None:
        return {}
    compliance = np.diagonal(np.real(first_design(analysis.statics.compliance.values, 2)))
    rows = zip(COMPONENTS, compliance, WRENCH_UNITS, strict=True)
    return {name: format_value(1.0 / float(each), f"{unit}/{MOTION.unit(name)}", _DIGITS) for name, each, unit in rows if each > 0.0}


def _resolution(analysis: Analysis) -> Mapping[str, str]:
    found = None if analysis.workspace is None else analysis.workspace.resolution
    if found is None:
        return {}
    worst = np.real(first_design(found.worst, 1))
    return {name: _shown(value, name) for name, value in zip(COMPONENTS, worst, strict=True) if value > 0.0}


def _shown(value: float, name: str) -> str:
    return format_value(float(value), MOTION.unit(name), _DIGITS)


def _platform_modes(modes: Modes) -> Table | None:
    notes: list[str] = []
    if modes.local:
        lowest = number(modes.mode(min(modes.local)).frequency, _DIGITS)
        count = count_text(len(modes.local), "local mode")
        notes = [f"{count} between {lowest} Hz and 1.5 times the highest platform frequency."]
    fields = "number frequency name platform_share compliance_share"
    table = result_table(tuple(map(modes.mode, modes.platform)), fields, title="Platform modes", notes=notes)
    return optional(merge_rows, table)


def lowest_mode(modes: Modes) -> str | None:
    """Describe the lowest mode of the whole stage, and the body with the largest kinetic energy; `None` without modes.

    >>> import flexstage as fs
    >>> from flexstage.cases.double_triangle import double_triangle
    >>> lowest_mode(fs.modes(fs.lumped(double_triangle())))
    'Lowest mode of the whole stage: 106 Hz, mainly platform (91.5 % of its kinetic energy).'
    """
    if not modes.names:
        return None
    bodies, share = modes.dominant_bodies(0)
    frequency = number(float(first_design(modes.frequencies, 1)[0]), _DIGITS)
    return f"Lowest mode of the whole stage: {frequency} Hz, mainly {bodies} ({percent(share, 3)} of its kinetic energy)."


def _first_rows(table: Table) -> Table:
    """Actuator, transmission ratio, loss and largest contribution; equal ones in one row. A note counts the rows left out."""
    rows = [(*row[:_LOSS], replace(row[-1], text=row[-1].text.partition(", ")[0])) for row in table.rows]
    shown = make_table(table.title, [*table.columns[:_LOSS], "largest contribution"], rows, provenance=table.provenance)
    return first_rows(merge_rows(shown), _ROWS)


def _strength_text(analysis: Analysis) -> str | None:
    reach = analysis.workspace
    buckling = analysis.buckling if reach is None else reach.buckling
    strengths = (analysis.stress, None if reach is None else reach.stress)
    said = [_weakest_text(each) for each in strengths if each is not None and each.links]
    if buckling is not None:
        said.append(f"Buckling load factor: {number(single(buckling.min_factor), 4)}.")
    return "\n".join(said) or None


def _weakest_text(found: HingeStress) -> str:
    """Smallest safety factor at the worst corner of some strokes, the hinge and the position in it."""
    place = f", {found.places[found.links.index(found.weakest)]}" if found.places else ""
    value = f"{number(single(found.min_safety), 4)}, in {found.weakest}{place}"
    if found.unknown:
        value = f"unknown, because {', '.join(found.unknown[:3])} has no stress limit"
    return f"Smallest safety factor at the worst corner {found.condition}: {value}."


def closing_text(analysis: Analysis, *, whole: bool) -> str:
    """Format the verdict: number of requirements that are met, the smallest margin and its cause.

    Unless `whole`, name the options --full and --report.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.analysis.complete import Model, analyse
    >>> print(closing_text(analyse(double_triangle()), whole=True))
    Verdict: All 8 requirements are met; the smallest margin is 6.01 %, for frequency.platform.1.
      Look at frequency.platform.1, 106.01 Hz (at least 100 Hz, +6.01 %): mode 1, tilt.
    """
    doubts = () if analysis.ends is None else analysis.ends.warnings
    more = "".join(f"\n  warning: {each}" for each in doubts) + (
        "" if whole else "\n  For all tables, use --full. For a page with pictures, use --report FILE."
    )
    if not analysis.verdicts:
        return f"Verdict: {_NO_REQUIREMENTS}{more}"
    worst = min(analysis.verdicts, key=rank)
    asked = worst.requirement
    why = worst.reason.rstrip(".") or _cause(analysis, worst)
    look = f"Look at {asked.key}, {value_text(worst)} ({asked.text}, {margin_text(worst)}){f': {why}' if why else ''}."
    return f"Verdict: {verdict_text(analysis.verdicts)}\n  {look}{more}"


def _cause(analysis: Analysis, verdict: Verdict) -> str:
    """The cause of a measure's value, if the analysis contains it."""
    find = _CAUSES.get(verdict.requirement.kind)
    return "" if find is None else find(analysis, verdict.requirement.name)


def _stroke_cause(analysis: Analysis, name: str) -> str:
    strokes = _strokes(analysis)
    return f"limited by {strokes[name][1]}" if name in strokes else ""


def _platform_mode_cause(analysis: Analysis, name: str) -> str:
    places = () if analysis.modes is None else analysis.modes.platform
    return _mode_cause(analysis, str(places[int(name) - 1] + 1)) if int(name) <= len(places) else ""


def _mode_cause(analysis: Analysis, name: str) -> str:
    known = analysis.modes is not None and int(name) <= len(analysis.modes.names)
    return f"mode {name}, {analysis.modes.names[int(name) - 1]}" if known and analysis.modes is not None else ""


def _loss_cause(analysis: Analysis, name: str) -> str:
    lost = analysis.lost_motion
    if lost is None:
        return ""
    losses = np.abs(np.diagonal(first_design(lost.loss.values, 2)))
    owner = name or lost.loss.rows[int(np.argmax(np.round(losses, 9)))]
    largest = loss_table(lost).rows[lost.loss.rows.index(owner)][-1].text
    return f"{owner}, {largest}" if largest else owner


def _safety_cause(analysis: Analysis, _: str) -> str:
    stress = None if analysis.workspace is None else analysis.workspace.stress
    if stress is None and analysis.kinematics.thrusts:
        return "with all coils at their limits in short use; safety.at_strokes is for the required strokes"
    return f"the hinge {stress.weakest}" if stress is not None and stress.links else ""


def _cause_at_strokes(analysis: Analysis, _: str) -> str:
    return "" if analysis.stress is None else f"the hinge {analysis.stress.weakest}"


_CAUSES: Mapping[MeasureKind, Callable[[Analysis, str], str]] = {
    measures.stroke: _stroke_cause,
    measures.frequency: _mode_cause,
    measures.platform_frequency: _platform_mode_cause,
    measures.loss: _loss_cause,
    measures.own_loss: _loss_cause,
    measures.safety: _safety_cause,
    measures.safety_at_strokes: _cause_at_strokes,
}
