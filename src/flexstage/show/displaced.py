"""Reports of large displacements: a stroke, buckling, misalignment; self-contained HTML files."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from flexstage.analysis.loaded.load_cases import REST, CaseFactor, CaseFactors
from flexstage.analysis.loaded.misalign import Misaligned, Misalignments
from flexstage.analysis.loaded.stroke import PostBuckling, Stroke
from flexstage.base.labelled import NOISE_RULE, Matrix, quiet
from flexstage.base.number import Array
from flexstage.base.storage.digest import digest
from flexstage.base.version import __version__
from flexstage.mechanism.mechanism import Mechanism
from flexstage.models.nonlinear.paths.load_path import LoadPath
from flexstage.show.display import format_value, to_typography
from flexstage.show.figures.export import to_svg
from flexstage.show.figures.stroke import stroke_figure
from flexstage.show.page import Head, Headline, Picture, Section, page, section
from flexstage.show.sections.caveats import caveat_section
from flexstage.show.sections.stage import drawing_section, stage_section
from flexstage.show.table import Column, Table, column_table, make_table, matrix_table, number_cells, result_table
from flexstage.show.viewer.animation import buckling_data, curves_of, limits, misalign_data, quantities_of, stroke_data
from flexstage.show.viewer.data import StageData, still_data
from flexstage.spatial.frame import COMPONENTS, MOTION, TWIST_UNITS


def stroke_report(mechanism: Mechanism, path: LoadPath, found: Stroke) -> str:
    """Write a stroke along a load path as an HTML page: an animated stage with curves and a cursor. The printed page is static."""
    data, beyond = stroke_data(mechanism, path, found), [each for each in limits(found) if each]
    words = f"{len(found.along.values)} points, {path.drive} {data.motions[0].label.partition('  ')[2]}"
    sections = [
        section("Over the stroke", [_curves(found, "stroke", "Results over the stroke", f"{words}.")]),
        caveat_section(mechanism, found.warnings),
        section("Point by point", stroke_tables(found)),
    ]
    text = f"{words}; {len(beyond)} of the points exceed a limit (first: {beyond[0]})" if beyond else words
    caption = "Bodies and flexures are shown at large displacements. Red: a limit is exceeded."
    kind = ("A stroke at large displacements", found.provenance)
    return _page(mechanism, kind, Headline(text, not beyond), data, sections, said=caption)


def _curves(found: Stroke, name: str, title: str, caption: str) -> Picture:
    """Results along a path, with the points shaded that exceed a limit."""
    figure = stroke_figure(curves_of(found.along), np.array([each != "" for each in limits(found)]))
    return Picture(to_svg(figure, name, title), to_typography(caption))


def stroke_tables(found: Stroke) -> list[Table]:
    """Tabulate the results at every point of a stroke, and the static deflection at its start, if any."""
    start = "static equilibrium" if found.sag is not None else "the undeformed configuration"
    free = "The frequencies f1 to f3 and the number of unstable modes are computed with the drive coordinate free, under the drive force."
    words = f"Displacements are relative to {start}. {free} The stress is the largest von Mises stress of all flexures."
    table = along_table(f"Along {found.drive}", found.along, [words])
    sag = [] if found.sag is None else [matrix_table("Static deflection under weight, loads and temperature change", found.sag)]
    return [table, *sag]


def along_table(title: str, along: Matrix, notes: Iterable[str] = ()) -> Table:
    """Tabulate results along a path: one row for each point, one column for each quantity in its own display unit."""
    kept = quiet(along.values)
    quantities = list(quantities_of(replace(along, values=kept)))
    heads = [Column(name, form.text) for name, _, form in quantities]
    rows = zip(*(number_cells(values, form) for _, values, form in quantities), strict=True)
    noise = [NOISE_RULE] if np.any((kept == 0.0) & (along.values != 0.0)) else []
    return make_table(title, heads, rows, notes=[*notes, *noise])


def buckling_report(mechanism: Mechanism, found: CaseFactors, after: PostBuckling | None = None) -> str:
    """Write an HTML page on buckling: the mode of each load case at its last stable state, the lowest factor first.

    `after` is the post-buckling path of the load case with the lowest factor.
    """
    known = sorted((case for case in found.cases if case.found is not None), key=lambda case: case.factor)
    data = buckling_data(mechanism, known, after) if known else still_data(mechanism)
    sections = [
        section("Buckling", buckling_tables(found)),
        None if after is None else _beyond_section(after.stroke),
        caveat_section(mechanism, found.warnings if after is None else (*found.warnings, *after.stroke.warnings)),
    ]
    caption = "The amplitude of the mode is arbitrary; choose it with the slider." if known else ""
    headline = Headline(_buckling_text(found), not found.warnings)
    return _page(mechanism, ("Buckling", found.provenance), headline, data, sections, said=caption)


def _buckling_text(found: CaseFactors) -> str:
    least, open_ = found.least, found.least_bound
    if open_ is not None and not (least is not None and least.factor <= open_.bound):
        return f"{open_.load}, {open_.place}: stable up to {format_value(open_.bound, '1', 4)} times the load; not computed beyond"
    known = f"{sum(not np.isnan(case.factor) for case in found.cases)} of {len(found.cases)} load cases and stroke ends"
    if least is None:
        return f"no buckling in {known}"
    where = "" if least.place == REST else f", {least.place}"
    text = f"{least.load}{where}: buckles at {format_value(least.factor, '1', 4)} times the load"
    return text if len(found.cases) == 1 else f"{text}, the lowest factor in {known}"


def buckling_tables(found: CaseFactors, after: PostBuckling | None = None) -> list[Table | None]:
    """Tabulate the buckling factor of each load case and stroke end, the mode of the lowest factor, and equilibria `after` buckling."""
    table = result_table(found.cases)
    least = found.least
    if least is None:
        return [table]
    beyond = [] if after is None else [along_table("Post-buckling path", after.stroke.along)]
    shape, size = shape_of(least), "The amplitude is arbitrary; the largest entry is scaled to 1 mm or 1 mrad."
    scaled = replace(shape, values=1e-3 * shape.values)
    return [table, matrix_table(f"Buckling mode: {least.load}, {least.place}", scaled, notes=[size]), *beyond]


def shape_of(case: CaseFactor) -> Matrix:
    """Return the buckling mode, scaled to a largest entry of 1. The matrix has no rows if the case does not buckle."""
    if case.found is None:
        return Matrix(np.zeros((0, 6)), (), COMPONENTS, ())
    shape = case.found.shape / (np.max(np.abs(case.found.shape), initial=0.0) or 1.0)
    return Matrix(shape, case.found.bodies, COMPONENTS, (TWIST_UNITS,) * len(case.found.bodies))


def _beyond_section(found: Stroke) -> Section | None:
    caption = "Equilibria beyond the lowest critical load, as a function of the load factor."
    shown = _curves(found, "beyond", "Post-buckling path", caption)
    return section("Post-buckling path", [shown, along_table("Results along the path", found.along)])


_BENT = "Flexures are shown as bent by the misalignment. Red: a limit is exceeded."


def misalign_report(mechanism: Mechanism, found: Misaligned) -> str:
    """Write an HTML page of a misaligned instance: the deformed stage; loads, frequencies and stress as functions of misalignment."""
    sections = [
        _misaligned_curves(found),
        caveat_section(mechanism, found.warnings),
        section("Point by point", misaligned_tables(found)),
    ]
    headline = Headline(_misaligned_text(found), not bool(np.any(_beyond(found))))
    return _page(mechanism, ("A misalignment", found.provenance), headline, misalign_data(mechanism, found), sections, said=_BENT)


def _misaligned_curves(found: Misaligned) -> Section | None:
    figure = to_svg(stroke_figure(curves_of(found.along), _beyond(found)), "misalign", "Results as functions of the misalignment")
    return section("Effect of the misalignment", [Picture(figure, to_typography(f"{_misaligned_text(found)}. Shaded: buckled."))])


def _beyond(found: Misaligned) -> Array:
    return found.along.values[:, -1] != 0.0


def _misaligned_text(found: Misaligned) -> str:
    kind = "about" if found.axis.startswith("r") else "along"
    return f"{found.copy} misaligned {kind} {found.axis[-1]}: {critical_text(found)}"


def misaligned_tables(found: Misaligned) -> list[Table]:
    """Tabulate the critical misalignment, results as functions of misalignment, and loads in flexures at the largest misalignment."""
    last = format_value(float(found.along.values[-1, 0]), MOTION.unit(found.axis), 4)
    return [
        make_table("Misaligned instance", ["instance", "axis", "stability"], [[found.copy, found.axis, critical_text(found)]]),
        along_table(f"Along {found.axis}", found.along),
        matrix_table(f"Loads on both ends of each flexure at a misalignment of {last}, in the frame of its first end", found.loads),
    ]


def misalignments_report(mechanism: Mechanism, found: Misalignments) -> str:
    """Write an HTML page on the effect of misaligning each instance; the animation shows the most critical instance."""
    worst = found.worst
    sections = [
        section("Instance by instance", misalignment_tables(found)),
        None if worst is None else _misaligned_curves(worst),
        caveat_section(mechanism, found.warnings),
        None if worst is None else section("The most critical instance, point by point", misaligned_tables(worst)),
    ]
    data, said = (still_data(mechanism), "") if worst is None else (misalign_data(mechanism, worst), _BENT)
    kind = ("Misalignments", f"the nonlinear model of {digest(mechanism, physics=True)[:16]}")
    return _page(mechanism, kind, Headline(misalignments_text(found)), data, sections, said=said)


def misalignments_text(found: Misalignments) -> str:
    """Describe the number of misaligned instances, and the instance that buckles first."""
    count, worst = len(found.critical.rows), found.worst
    if worst is None:
        return "no instance and no link is connected to the ground"
    where = f"{worst.copy} {'about' if worst.axis.startswith('r') else 'along'} {worst.axis[-1]}"
    summary = f"the most critical is {where} ({critical_text(worst)})"
    if np.isnan(worst.critical) and not np.ptp(found.followed.values):
        summary = f"all are {critical_text(worst)}; the highest stress is at {where}"
    return f"{count} instances and links misaligned one by one: {summary}"


def critical_text(found: Misaligned) -> str:
    """Format the critical misalignment as text."""
    size = format_value(found.followed, MOTION.unit(found.axis), 4)
    return f"stable up to {size}; not computed beyond" if np.isnan(found.critical) else f"buckles at {size}"


def misalignment_tables(found: Misalignments) -> list[Table]:
    """Tabulate the results of each instance and axis: critical misalignment, and load and stress at a given misalignment."""
    size = format_value(found.size, MOTION.unit(found.critical.columns[0]), 4)
    alone = "Each instance is misaligned individually, in its own frame"
    return [
        column_table("Critical misalignment", found.critical, head="instance", notes=[f"{alone}. -: stable up to the values below."]),
        column_table("Largest computed stable misalignment", found.followed, head="instance"),
        column_table(
            f"Load at a misalignment of {size}", found.load, head="instance", notes=[f"{alone}, about its origin or the middle of a link."]
        ),
        column_table(
            f"Largest von Mises stress of a flexure at a misalignment of {size}",
            found.stress,
            head="instance",
            notes=["Stress due to weight is included."],
        ),
    ]


def _page(
    mechanism: Mechanism, kind: tuple[str, str], headline: Headline, data: StageData, sections: Iterable[Section | None], *, said: str
) -> str:
    """A page of a kind and provenance that begins with the animated stage, `said` below it, and ends with its drawings."""
    origin = (("model", kind[1]), ("physics", digest(mechanism, physics=True)[:16]), ("flexstage", __version__))
    head = Head(mechanism.name or "stage", kind[0], origin, replace(headline, text=to_typography(headline.text)))
    return page(head, [stage_section(data, said=said), *sections, drawing_section(mechanism, data)], {"stage": data})
