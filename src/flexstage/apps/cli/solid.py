"""Commands of the solid reading: `solid`, `verify`, `calibrate`."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TypeAlias

import typer

from flexstage.apps.cli.answer import Asked, answer, tell_missing
from flexstage.apps.cli.bar import Bar, bar
from flexstage.apps.cli.choice import choice, choices
from flexstage.apps.cli.options import Changes, Design, Json
from flexstage.apps.cli.output import STDOUT, announced, output_findings, write
from flexstage.apps.cli.speech import tell, warn
from flexstage.studies.what import What

if TYPE_CHECKING:
    from flexstage.base.finding import Finding
    from flexstage.mechanism.mechanism import Mechanism
    from flexstage.present.page import Section
    from flexstage.present.table import Table
    from flexstage.readings.solid.fineness import Reduction
    from flexstage.readings.solid.hinge import HingeSolid
    from flexstage.readings.solid.hinge_cache import HingeForm
    from flexstage.readings.solid.parts import Parts, Ways
    from flexstage.studies.resolution import Resolution, Resolved
    from flexstage.studies.solid_hinge import Hinges, SolidHinge
    from flexstage.studies.solid_read import Solids
    from flexstage.studies.verify import Verification

Scope: TypeAlias = Annotated[
    What,
    typer.Option(
        "--what",
        parser=choice("--what", What),
        metavar=choices(What),
        autocompletion=lambda: [each.value for each in What],
        help="Every distinct hinge, every distinct unit alone, or the whole stage.",
    ),
]
Accuracy: TypeAlias = Annotated[
    str, typer.Option("--accuracy", metavar="SHARE", help="Relative error to reach in stiffness, gain and frequency.")
]
Order: TypeAlias = Annotated[
    int | None,
    typer.Option("--order", min=2, max=5, help="Order of the elements; without it, raised until the accuracy is met.", show_default=False),
]
Report: TypeAlias = Annotated[
    Path | None, typer.Option("--report", metavar="FILE", help="Write a self-contained HTML report with pictures.", show_default=False)
]
Memory: TypeAlias = Annotated[
    str | None,
    typer.Option(
        "--memory",
        metavar="SIZE",
        help='Memory to plan with, e.g. "8 GB". Default: 90 % of what the machine has left.',
        show_default=False,
    ),
]
_DEFAULT_ACCURACY = "1 %"


@dataclass(frozen=True)
class _Wishes:
    """The resolution asked for, and the memory to plan with [bytes] (absent: what the machine has left)."""

    resolution: Resolution
    memory: float | None

    def ways(self, shown: Bar) -> Ways:
        """By the cache of the user, with the progress shown."""
        from flexstage.readings.solid.cache import Cache
        from flexstage.readings.solid.parts import Ways
        from flexstage.readings.solid.remote import Limits

        return Ways(Cache(), shown.step, Limits(memory=self.memory))


@dataclass(frozen=True)
class _Found:
    """A result of the solid reading, as a document, tables, and sections of a report; cautions about it."""

    body: Callable[[], dict[str, object]]
    tables: Callable[[], Iterator[Table | None]]
    sections: Callable[[], Iterator[Section | None]]
    cautions: tuple[Finding, ...]


def solid(
    design: Design,
    *,
    what: Scope = What.STAGE,
    accuracy: Accuracy = _DEFAULT_ACCURACY,
    order: Order = None,
    memory: Memory = None,
    changes: Changes = None,
    json: Json = None,
    report: Report = None,
) -> None:
    """Read a stage as elastic solids, by finite elements.

    hinge: the 6x6 of every hinge. unit: stiffness, gain, lost motion and stress of every unit. stage: stiffness, modes and stress.

    What was reduced once is kept and not computed again.
    """
    asked = _wishes(accuracy, order, memory)
    mechanism = _opened(design, changes, [("--json", json), ("--report", report)])
    if what is What.STAGE:
        _require_standing(mechanism)
    with bar() as shown:
        found = _STUDIES[what](mechanism, asked, shown)
    if report is not None:
        _write_report(report, mechanism, found.sections(), found.cautions)
    if _shows(json, report):
        answer(Asked("solid", mechanism, None, json, found.cautions), lambda: {"what": what.value, **found.body()}, found.tables)


def verify(
    design: Design,
    *,
    accuracy: Accuracy = _DEFAULT_ACCURACY,
    order: Order = None,
    memory: Memory = None,
    changes: Changes = None,
    json: Json = None,
    report: Report = None,
) -> None:
    """Compare theory with finite elements: which to trust?

    Hinges, units and the whole stage: the paper's springs, the lumped reading, the lumped reading with calibrated hinges, and FEA with its
    own error. Rows that calibrated parts touch are not independent of FEA.
    """
    asked = _wishes(accuracy, order, memory)
    mechanism = _opened(design, changes, [("--json", json), ("--report", report)])
    _require_standing(mechanism)
    from flexstage.present.documents.solid import verification_body
    from flexstage.present.sections.solid import hinge_section, stage_solid_section, unit_section, verification_section
    from flexstage.studies.verify import verify as verified

    with bar() as shown:
        found = verified(mechanism, asked.resolution, _solids(asked, shown), _hinges(asked, shown))
    read = [(name, each) for name, each in (("units", found.units), ("stage", found.stage)) if each is not None]
    cautions = (*_inexact(found.hinges), *(caution for name, each in read for caution in _missed(name, each, asked.resolution)))
    if report is not None:
        units = None if found.units is None else unit_section(found.units)
        stage = None if found.stage is None else stage_solid_section(found.stage)
        _write_report(report, mechanism, iter([verification_section(found), hinge_section(found.hinges), units, stage]), cautions)
    tell_missing(found.missing)
    if _shows(json, report):
        answer(Asked("verify", mechanism, None, json, cautions), lambda: verification_body(found), lambda: _verification_tables(found))


def calibrate(
    design: Design,
    *,
    output: Annotated[Path, typer.Option("--output", "-o", metavar="STAGE.TOML", help="Design file to write.", show_default=False)],
    accuracy: Accuracy = _DEFAULT_ACCURACY,
    order: Order = None,
    memory: Memory = None,
    json: Json = None,
) -> None:
    """Give hinges their 6x6 from finite elements.

    The lumped reading of the written file has FEA's accuracy in its hinges. Comments stay; the drawn hinges are kept beside.
    """
    from flexstage.base.finding import require

    require(output_findings([("--output", output), ("--json", json)], design))
    asked = _wishes(accuracy, order, memory)
    from flexstage.mechanism.store import loads
    from flexstage.mechanism.store.file import read_text
    from flexstage.present.documents.solid import calibration_body
    from flexstage.present.tables.solid import calibration_table
    from flexstage.studies.calibrate import calibrate as calibrated

    text = read_text(design)
    mechanism = loads(text, where=str(design))
    with bar() as shown:
        found = calibrated(text, _hinges(asked, shown), where=str(design))
    write(output, found.text, "--output")
    if str(output) != STDOUT:
        announced(f"Wrote {output}")
        asking = Asked("calibrate", mechanism, None, json, _inexact(found.hinges))
        answer(asking, lambda: calibration_body(found), lambda: [calibration_table(found)])


def _opened(design: Path, changes: list[str] | None, outputs: list[tuple[str, str | Path | None]]) -> Mechanism:
    from flexstage.apps.cli.opening import changed
    from flexstage.base.finding import require
    from flexstage.mechanism.store import load

    require(output_findings(outputs, design))
    return changed(load(design), changes or ())


def _require_standing(mechanism: Mechanism) -> None:
    from flexstage.studies.standing import require_standing

    require_standing(mechanism)


def _wishes(accuracy: str, order: int | None, memory: str | None) -> _Wishes:
    from flexstage.base.finding import refuse
    from flexstage.base.quantity import RATIO
    from flexstage.base.unit import parse
    from flexstage.studies.resolution import Resolution

    share = parse(accuracy, RATIO, where="--accuracy")
    if not 1e-6 <= share < 1.0:
        raise refuse("--accuracy", f"{accuracy} is no relative error to ask for", 'Give one between 0.0001 % and 100 %, e.g. "1 %"')
    return _Wishes(Resolution(share, order), _size(memory))


def _notice(finding: Finding) -> None:
    warn(str(finding))


def _size(memory: str | None) -> float | None:
    """The size of memory stated [bytes]."""
    from flexstage.base.finding import refuse
    from flexstage.base.quantity import Quantity
    from flexstage.base.unit import parse

    if memory is None:
        return None
    size = parse(memory, Quantity("size of memory", "B", "GB", "8 GB"), where="--memory")
    if size <= 0.0:
        raise refuse("--memory", f"{memory} is no memory to plan with", 'Give what may be used, e.g. "8 GB"')
    return size


def _solids(asked: _Wishes, shown: Bar) -> Solids:
    from flexstage.readings.solid.install import require_solver
    from flexstage.studies.solid_read import solids

    require_solver()
    reduce = solids(asked.ways(shown), _notice)

    def told(mechanism: Mechanism, reduction: Reduction) -> Parts:
        shown.about = f"order {reduction.fineness.order}, "
        return reduce(mechanism, reduction)

    return told


def _hinges(asked: _Wishes, shown: Bar) -> Hinges:
    from flexstage.studies.solid_hinge import hinges

    compute = hinges(asked.resolution.accuracy, asked.resolution.order, asked.ways(shown), _notice)

    def told(forms: Mapping[str, HingeForm]) -> Mapping[str, HingeSolid]:
        shown.about = "hinges, "
        return compute(forms)

    return told


def _hinge_study(mechanism: Mechanism, asked: _Wishes, shown: Bar) -> _Found:
    from flexstage.present.documents.solid import hinges_body
    from flexstage.present.sections.solid import hinge_section
    from flexstage.present.tables.solid import hinge_matrices, hinge_table
    from flexstage.studies.solid_hinge import solid_hinges

    found = solid_hinges(mechanism, _hinges(asked, shown))
    return _Found(
        body=lambda: {"hinges": hinges_body(found)},
        tables=lambda: iter([hinge_table(found), *hinge_matrices(found)]),
        sections=lambda: iter([hinge_section(found)]),
        cautions=_inexact(found),
    )


def _unit_study(mechanism: Mechanism, asked: _Wishes, shown: Bar) -> _Found:
    from flexstage.present.documents.solid import solid_units_body
    from flexstage.present.sections.solid import unit_section
    from flexstage.present.tables.solid import command_table, solid_unit_table, stress_table
    from flexstage.studies.verify import units_solid

    found = units_solid(mechanism, asked.resolution, _solids(asked, shown))

    def tables() -> Iterator[Table | None]:
        yield solid_unit_table(found)
        for name, unit in found.result.items():
            yield command_table(name, unit)
            yield stress_table(f"Stress in the {name} unit at full stroke", unit.stress)

    return _Found(lambda: solid_units_body(found), tables, lambda: iter([unit_section(found)]), _missed("units", found, asked.resolution))


def _stage_study(mechanism: Mechanism, asked: _Wishes, shown: Bar) -> _Found:
    from flexstage.present.documents.solid import solid_stage_body
    from flexstage.present.sections.solid import stage_solid_section
    from flexstage.present.tables.modes import mode_table
    from flexstage.present.tables.solid import block_table, stress_table
    from flexstage.present.tables.statics import direction_table, principal_table, stiffness_table
    from flexstage.studies.verify import stage_solid

    found = stage_solid(mechanism, asked.resolution, _solids(asked, shown))
    stage = found.result

    def tables() -> Iterator[Table | None]:
        yield stiffness_table(stage.statics)
        yield principal_table(stage.statics)
        yield direction_table(stage.statics)
        yield mode_table(stage.modes)
        yield block_table(stage)
        yield None if stage.stress is None else stress_table("Highest stress over the strokes", stage.stress)

    cautions = _missed("stage", found, asked.resolution)
    return _Found(lambda: solid_stage_body(found), tables, lambda: iter([stage_solid_section(found)]), cautions)


_STUDIES = {What.HINGE: _hinge_study, What.UNIT: _unit_study, What.STAGE: _stage_study}


def _inexact(hinges: Mapping[str, SolidHinge]) -> tuple[Finding, ...]:
    """Cautions about hinges whose 6x6 is not as exact as was asked."""
    from flexstage.base.finding import Finding

    found = ((name, hinge.found.finding) for name, hinge in hinges.items())
    return tuple(Finding(name, each.what, each.advice) for name, each in found if each is not None)


def _missed(what: str, found: Resolved[Any], asked: Resolution) -> tuple[Finding, ...]:
    """A caution where the error estimated is not as small as was asked; where it is, it is told."""
    from flexstage.base.finding import Finding

    size = f"{100.0 * found.error:.2g} %" if found.errors else "unknown"
    text = f"the error estimated of finite elements is {size} at order {found.order}"
    if found.error <= asked.accuracy:
        tell(f"{what}: {text}")
        return ()
    more = found.stopped or (f"Ask for --order {found.order + 1}" if asked.order is not None else "This is the highest order")
    return (Finding(what, f"{text}; {100.0 * asked.accuracy:.2g} % was asked", more.rstrip(".")),)


def _verification_tables(found: Verification) -> Iterator[Table]:
    from flexstage.present.tables.solid import verdict_table_of, verification_table

    for name, rows in found.groups.items():
        yield verification_table(name, rows)
    yield verdict_table_of(found)


def _write_report(target: Path, mechanism: Mechanism, sections: Iterator[Section | None], cautions: tuple[Finding, ...]) -> None:
    from flexstage.present.solid_report import solid_report

    write(target, solid_report(mechanism, sections, cautions), "--report")
    if str(target) != STDOUT:
        announced(f"Wrote {target}")


def _shows(json: str | None, report: Path | None) -> bool:
    """Whether stdout is free for the result, or it is asked for in a file."""
    return json is not None or str(report) != STDOUT
