"""Commands of the solid model: `solid`, `verify`, `calibrate`."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
import typer

from flexstage.analysis.loaded.standing import require_standing
from flexstage.base.finding import Finding, refuse
from flexstage.base.lazy import LazyModule
from flexstage.base.record import SideBySide
from flexstage.base.units.quantity import RATIO, Quantity
from flexstage.base.units.unit import parse
from flexstage.beams.leaf import leaf_diagonal
from flexstage.mechanism.assembly.expand import expand
from flexstage.mechanism.drawn import with_drawn_parts
from flexstage.mechanism.mechanism import Mechanism
from flexstage.mechanism.store import loads
from flexstage.mechanism.store.file import read_text
from flexstage.parts.leaf import Leaf, LeafEnds
from flexstage.parts.part import inner
from flexstage.show.command.answer import CommandResult, command, print_missing
from flexstage.show.command.options import Design, order_option, output_option, text_option, word_option
from flexstage.show.command.output import save
from flexstage.show.command.progress import ProgressBar, progress_bar
from flexstage.show.command.terminal import print_note, print_warning
from flexstage.show.table import Table
from flexstage.show.tables.modes import mode_table
from flexstage.show.tables.statics import direction_table, principal_table, stiffness_table
from flexstage.solid.fea.jobs.cache import Cache
from flexstage.solid.fea.jobs.parts import Ways, announce
from flexstage.solid.fea.jobs.remote import Limits, Pool
from flexstage.solid.results import calibration, verification
from flexstage.solid.results.hinges import SolidHinge, hinges, solid_hinges
from flexstage.solid.results.plan import reduction_plan, units_alone, verification_plan, work_ahead
from flexstage.solid.results.read import solids
from flexstage.solid.results.resolution import NOT_ESTIMATED, Converged, Resolution
from flexstage.solid.show.tables import (
    block_table,
    calibration_table,
    command_table,
    hinge_matrices,
    hinge_table,
    solid_unit_table,
    stress_table,
    verdict_table_of,
    verification_table,
)

if TYPE_CHECKING:
    from flexstage.show import page
    from flexstage.show.page import Headline
    from flexstage.solid.show import report as reports
    from flexstage.solid.show import sections as pages
else:  # reports are rare
    page, reports, pages = (
        LazyModule("flexstage.show.page"),
        LazyModule("flexstage.solid.show.report"),
        LazyModule("flexstage.solid.show.sections"),
    )


class Scope(Enum):
    """Scope of a study of solids: each distinct hinge, each distinct isolated unit, or the whole stage."""

    HINGE = "hinge"
    UNIT = "unit"
    STAGE = "stage"


@dataclass(frozen=True)
class SolidOptions:
    """Accuracy of a solid study, and its resources."""

    accuracy: Annotated[
        str, typer.Option("--accuracy", metavar="SHARE", help="Permitted relative error of stiffness, gain and frequency.")
    ] = "1 %"
    order: Annotated[
        int | None,
        order_option(
            min=2, help="Polynomial order of the elements. Default: increased until the required accuracy is reached.", show_default=False
        ),
    ] = None
    memory: Annotated[str | None, text_option("--memory", "SIZE", 'Memory limit, e.g. "8 GB". Default: 90 % of the free memory.')] = None

    @property
    def resolution(self) -> Resolution:
        """Required accuracy and element order. Raises `DesignError` if the accuracy is out of range."""
        share = parse(self.accuracy, RATIO, where="--accuracy")
        if not 1e-6 <= share < 1.0:
            what = f"must be between 1e-6 and 1 (got {self.accuracy})"
            raise refuse("--accuracy", what, 'Use e.g. "1 %"')
        return Resolution(share, self.order)

    def ways(self, shown: ProgressBar, pool: Pool | None = None) -> Ways:
        """Return the options of the jobs, with the user's cache and progress. Raises `DesignError` for an invalid memory size."""
        return Ways(Cache(), shown.step, Limits(memory=_size(self.memory)), pool, print_warning, print_note)


@command("report")
def solid(
    mechanism: Mechanism,
    *,
    scope: Annotated[
        Scope, word_option("--scope", Scope, "Scope: each distinct hinge, each distinct unit, or the whole stage.")
    ] = Scope.STAGE,
    options: SolidOptions,
) -> CommandResult:
    """Analyse a stage as elastic solids by finite elements.

    With --scope hinge, computes the 6x6 compliance matrix of every hinge. With --scope unit, computes stiffness, lost motion and stress of
    isolated units. With --scope stage, computes stiffness, modes and stress of the stage.

    Reduced components are stored in a cache for later commands.
    """
    resolution = options.resolution
    with progress_bar() as shown, Pool() as pool:
        ways = options.ways(shown, pool)
        if scope is Scope.STAGE:
            require_standing(mechanism)
        found = _STUDIES[scope](mechanism, resolution, ways)
    return replace(found, warnings=(*free_end_warnings(mechanism), *found.warnings))


@command("report")
def verify(
    mechanism: Mechanism,
    *,
    options: SolidOptions,
) -> CommandResult:
    """Compare theory with finite elements.

    For hinges, units and the whole stage, compares four models: axial springs, lumped, lumped with calibrated hinges, and FEA. Results
    with calibrated hinges are not independent of FEA, because their compliance matrices come from FEA.
    """
    resolution = options.resolution
    with progress_bar() as shown, Pool() as pool:
        ways = options.ways(shown, pool)
        require_standing(mechanism)
        found = _verify(mechanism, resolution, ways)
    solved = (("units", found.units), ("stage", found.stage))
    warnings = (
        *free_end_warnings(mechanism),
        *_inexact_hinges(found.hinges),
        *(warning for name, each in solved if each is not None for warning in _accuracy_warnings(name, each, resolution)),
    )

    def page() -> str:
        units = None if found.units is None else pages.unit_section(found.units)
        stage = None if found.stage is None else pages.stage_solid_section(found.stage)
        pairs, beside = ({}, None) if found.stage is None else pages.paired_with_theory(mechanism, found.stage.result)
        more = () if found.stage is None else pages.solid_motions(mechanism, found.stage.result, pairs)
        sections = [pages.verification_section(found), beside, pages.hinge_section(found.hinges), units, stage]
        return reports.solid_report(mechanism, pages.verification_headline(found), sections, warnings, more)

    print_missing(found.reasons)
    return CommandResult(mechanism, lambda: found, lambda: _verification_tables(found), page, warnings=warnings)


def _verify(mechanism: Mechanism, resolution: Resolution, ways: Ways) -> verification.Verification:
    """The verification; prints its cost before the computation, and each verdict after it."""
    todo = verification_plan(mechanism, resolution, ways)
    missing = todo.missing(ways.cache)
    if not missing:
        print_note(announce((), 1, len(todo.jobs)))
    work_ahead(todo, ways)
    return verification.verify(
        mechanism, resolution, solids(ways), hinges(resolution.accuracy, resolution.order, ways), _print_verdicts if missing else None
    )


def _print_verdicts(rows: tuple[verification.Row, ...]) -> None:
    for name, group in verification.groups(rows).items():
        print_note(f"{name}: {verification.verdict(group)}")


@command("output")
def calibrate(
    design: Design,
    *,
    output: Annotated[Path, output_option("STAGE.TOML", "Design file to write.")],
    options: SolidOptions,
) -> CommandResult:
    """Compute the 6x6 compliance of hinges by finite elements.

    Writes a design file in which the hinges have compliance matrices from FEA, for a more accurate lumped model. The file also contains
    the comments and, under the name NAME-drawn, each original hinge.
    """
    resolution = options.resolution
    text = read_text(design)
    mechanism = loads(text, where=str(design))
    with progress_bar() as shown:
        found = calibration.calibrate(text, hinges(resolution.accuracy, resolution.order, options.ways(shown)), where=str(design))
    save(output, found.text, "--output")
    warnings, tables = _inexact_hinges(found.hinges), [calibration_table(found)]
    return CommandResult(mechanism, lambda: found, lambda: tables, warnings=warnings)


def _size(memory: str | None) -> float | None:
    """The specified size of memory [bytes]."""
    if memory is None:
        return None
    size = parse(memory, Quantity("size of memory", "B", "GB", "8 GB"), where="--memory")
    if size <= 0.0:
        raise refuse("--memory", f"must be a size of memory (got {memory})", 'Use e.g. "8 GB"')
    return size


def _hinge_study(mechanism: Mechanism, resolution: Resolution, ways: Ways) -> CommandResult:
    found = solid_hinges(mechanism, hinges(resolution.accuracy, resolution.order, ways))
    warnings = _inexact_hinges(found)

    def report() -> str:
        text = f"{len(found)} distinct hinges, {len(warnings) or 'none'} of them less accurate than required."
        return reports.solid_report(mechanism, page.Headline(text, not warnings), [pages.hinge_section(found)], warnings)

    return CommandResult(
        mechanism,
        lambda: SideBySide(({"what": "hinge"}, {"hinges": found})),
        lambda: [hinge_table(found), *hinge_matrices(found)],
        report,
        warnings=warnings,
    )


def _unit_study(mechanism: Mechanism, resolution: Resolution, ways: Ways) -> CommandResult:
    alone = units_alone(mechanism)
    todo = reduction_plan(alone, resolution, ways)
    bare = bool(todo.missing(ways.cache))
    work_ahead(reduction_plan(alone, resolution, ways, bare=True) if bare else todo, ways)
    found = verification.units_solid(mechanism, resolution, solids(ways), bare=bare)

    def tables() -> Iterator[Table | None]:
        yield solid_unit_table(found)
        for name, unit in found.result.items():
            yield command_table(name, unit)
            yield stress_table(f"Stress in the {name} unit at full stroke", unit.stress)

    warnings = _accuracy_warnings("units", found, resolution)
    return CommandResult(
        mechanism,
        lambda: SideBySide(({"what": "unit"}, found, {"units": found.result})),
        tables,
        lambda: reports.solid_report(mechanism, _accuracy_headline(found, resolution), [pages.unit_section(found)], warnings),
        warnings=warnings,
    )


def _stage_study(mechanism: Mechanism, resolution: Resolution, ways: Ways) -> CommandResult:
    work_ahead(reduction_plan([with_drawn_parts(mechanism)], resolution, ways), ways)
    found = verification.stage_solid(mechanism, resolution, solids(ways))
    stage, warnings = found.result, _accuracy_warnings("stage", found, resolution)

    def tables() -> Iterator[Table | None]:
        for table in (stiffness_table, principal_table, direction_table):
            yield table(stage.statics)
        yield mode_table(stage.modes)
        yield block_table(stage)
        yield stress_table("Highest stress over the strokes", stage.stress)

    def report() -> str:
        pairs, beside = pages.paired_with_theory(mechanism, stage)
        sections, motions = [pages.stage_solid_section(found), beside], pages.solid_motions(mechanism, stage, pairs)
        return reports.solid_report(mechanism, _accuracy_headline(found, resolution), sections, warnings, motions)

    return CommandResult(mechanism, lambda: SideBySide(({"what": "stage"}, found, stage)), tables, report, warnings=warnings)


_STUDIES = {Scope.HINGE: _hinge_study, Scope.UNIT: _unit_study, Scope.STAGE: _stage_study}


def free_end_warnings(mechanism: Mechanism) -> tuple[Finding, ...]:
    """Return warnings about leaves whose ends are free to warp in theory, but clamped in the solid model.

    >>> free_end_warnings(Mechanism("stage"))
    ()
    """
    found: dict[str, Finding] = {}
    for link in expand(mechanism).links.values():
        part = inner(link.part)
        if isinstance(part, Leaf) and part.ends is LeafEnds.FREE and link.material is not None:
            clamped = leaf_diagonal(replace(part, ends=LeafEnds.CLAMPED), link.material)[3]
            stiffer = float(np.max(np.real(leaf_diagonal(part, link.material)[3] / clamped))) - 1.0
            what = f"its ends may warp in theory; the solid model clamps them, and is {100.0 * stiffer:.3g} % stiffer in twist"
            found[link.link.part] = Finding(f"parts.{link.link.part}", what, 'Compare with ends = "clamped"')
    return tuple(found.values())


def _inexact_hinges(hinges: Mapping[str, SolidHinge]) -> tuple[Finding, ...]:
    """Warnings about hinges whose 6x6 misses the required accuracy."""
    found = ((name, hinge.found.finding) for name, hinge in hinges.items())
    return tuple(Finding(name, each.what, each.advice) for name, each in found if each is not None)


def _accuracy_warnings(what: str, found: Converged[Any], resolution: Resolution) -> tuple[Finding, ...]:
    """A warning if the estimated error exceeds the required accuracy; else a note."""
    text = _accuracy_text(found)
    if found.error <= resolution.accuracy:
        print_note(f"{what}: {text}")
        return ()
    more = found.stopped or (f"Use --order {found.order + 1}" if resolution.order is not None else "This is the highest order")
    return (Finding(what, f"{text}; {100.0 * resolution.accuracy:.2g} % required", more.rstrip(".")),)


def _accuracy_text(found: Converged[Any]) -> str:
    size = f"{100.0 * max(found.errors.values()):.2g} %" if found.errors else "unknown"
    more = f" ({found.order + 1} in {found.raised} of the components)" if found.raised else ""
    if found.unestimated:
        locked, number = ", ".join(found.unestimated[:3]), len(found.unestimated)
        more = f"; for {number} other figures ({locked}{', ...' if number > 3 else ''}), {NOT_ESTIMATED.partition('. ')[0]}"
    return f"the estimated error of finite elements is {size} at order {found.order}{more}"


def _accuracy_headline(found: Converged[Any], resolution: Resolution) -> Headline:
    """Accuracy of a result, compared with the required accuracy."""
    text = _accuracy_text(found)
    return page.Headline(f"{text[0].upper()}{text[1:]}; {100.0 * resolution.accuracy:.2g} % required.", found.error <= resolution.accuracy)


def _verification_tables(found: verification.Verification) -> Iterator[Table | str | None]:
    if found.rows:
        yield found.headline
    for rows in found.groups.values():
        yield verification_table(rows)
    yield verdict_table_of(found)
