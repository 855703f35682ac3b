"""The sections `[scatter]` and `[tolerance]` of a study's file."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

from flexstage.analysis.assessment.requirements import Requirement, requirements
from flexstage.base.arguments import check_arguments
from flexstage.base.finding import DesignError, Finding, refuse, require
from flexstage.base.number import Table
from flexstage.base.units.quantity import RATIO, Quantity
from flexstage.base.units.unit import show
from flexstage.mechanism.addresses.address import get, quantity_of
from flexstage.mechanism.mechanism import PLATFORM, Mechanism
from flexstage.mechanism.store.file import read_text
from flexstage.mechanism.store.lines import with_lines
from flexstage.models.ideal import ideal
from flexstage.studies.form import ScatterTable, ToleranceTable, is_share, parse_amount
from flexstage.studies.sweeps.definition import name_findings
from flexstage.studies.sweeps.file import Opening, read_opening
from flexstage.studies.sweeps.start import one_quantity
from flexstage.studies.tolerances.bounds import bound_findings
from flexstage.studies.tolerances.crosstalk import Command
from flexstage.studies.tolerances.definition import Copies, Tolerance, nominal_command
from flexstage.studies.tolerances.distribution import Distribution, Shape
from flexstage.studies.tolerances.reach import reach
from flexstage.studies.tolerances.scatter import Scatter, targets

_FEWEST = 32
_MOST = 10**7


@check_arguments
def load_tolerance(path: str | os.PathLike[str]) -> Tolerance:
    """Read a study's file with sections `[scatter]` and, optionally, `[tolerance]`.

    Raises one `DesignError` that lists all errors. Examples of errors are unknown addresses (with the nearest names), deviations that are
    not positive, deviations that are too large for the number that they change, and `independent` for an address of a single number.

    >>> load_tolerance("nowhere/study.toml")
    Traceback (most recent call last):
        ...
    flexstage.base.finding.DesignError: nowhere/study.toml: file not found. Check the path.
    """
    return loads_tolerance(read_text(path), where=os.fspath(path), folder=Path(path).parent)


def loads_tolerance(text: str, *, where: str = "text", folder: Path | None = None) -> Tolerance:
    """Read a tolerance study from its text. `folder` contains the design files.

    >>> study = loads_tolerance('''
    ... format = "flexstage study 1"
    ... case = "parallelogram"
    ... scatter.wire = { address = "hinges.thickness", normal = "5 um", independent = true }
    ... ''')
    >>> [variable.name for variable in study.variables][:2]
    ['wire.links.left.thickness', 'wire.links.right.thickness']
    >>> [line.key for line in study.limits], study.plan.count
    (['stroke.x', 'frequency.platform.1', 'safety'], 1024)
    """
    head = read_opening(text, where, folder)
    file, findings, design = head.file, head.findings, head.design
    bench = _Reached(design)
    scatters = _scatters(file.scatter, bench, findings)
    if not file.scatter:
        findings.append(Finding("scatter", "no scatter", 'Use e.g. wire = { address = "hinges.thickness", normal = "5 um" }'))
    if file.tolerance.copies > _MOST:
        findings.append(Finding("tolerance.copies", f"must be at most {_MOST:.0e} (got {file.tolerance.copies:.3g})", "Use fewer samples"))
    asked = _command(file.tolerance, design, findings)
    limits = (*(_lines(design, findings) if file.tolerance.requirements else ()), *head.limits)
    if not head.responses and not limits and asked is None:
        findings.append(Finding("responses", "no response", 'Add a measure, e.g. f1 = "frequency.platform.1"'))
    require(with_lines(findings, text, where))
    study = _study(head, scatters, limits, bench.shared, text=text, command=asked)
    named = (replace(each, where=each.where.replace("variables.", "scatter.", 1)) for each in name_findings(study))
    require(with_lines([*bound_findings(design, study.targets, study.deviations), *named], text, where))
    return study


@dataclass(frozen=True, eq=False)
class _Reached:
    """The design, and the shared number behind each instance's own."""

    design: Mechanism
    shared: dict[str, str] = field(default_factory=dict)


def _study(
    head: Opening,
    scatters: tuple[Scatter, ...],
    limits: tuple[Requirement, ...],
    shared: dict[str, str],
    *,
    text: str,
    command: Command | None,
) -> Tolerance:
    wishes = head.file.tolerance
    variables = tuple(one for each in scatters for one in each.variables())
    groups = tuple(len(each.members) for each in scatters)
    alone = max(_FEWEST, wishes.copies // 16) if len(groups) > 1 else 0
    return Tolerance(
        name=head.file.name,
        design=head.design,
        variables=variables,
        responses=Table(head.responses),
        limits=limits,
        plan=Copies(wishes.sampling, len(variables), wishes.copies, seed=wishes.seed, alone=alone, groups=groups),
        text=text,
        scatters=scatters,
        targets=targets(head.design, variables, shared),
        wanted=wishes.yield_,
        commanded=command,
    )


def _lines(design: Mechanism, findings: list[Finding]) -> tuple[Requirement, ...]:
    try:
        return requirements(design)
    except DesignError as error:
        findings.extend(error.findings)
        return ()


def _scatters(tables: Mapping[str, ScatterTable], bench: _Reached, findings: list[Finding]) -> tuple[Scatter, ...]:
    found = []
    for name, table in tables.items():
        try:
            found.append(_scatter(table, name, bench))
        except DesignError as error:
            findings.extend(error.findings)
    return tuple(found)


def _scatter(table: ScatterTable, name: str, bench: _Reached) -> Scatter:
    """One entry; raises `DesignError` with all errors in it."""
    where = f"scatter.{name}"
    sources = table.address or (name,)
    findings = list[Finding]()
    components = _components(sources, where, bench, findings)
    addresses = [address for members in components.values() for address in members]
    shape = _shape(table, where, findings)
    require(findings)
    quantity = one_quantity(f"{where}.address", [quantity_of(bench.design, address) for address in addresses])
    distribution, relative = _distribution(table, where, shape, quantity)
    if table.independent and len(addresses) < 2:
        findings.append(Finding(f"{where}.independent", f"{addresses[0]} is a single number", "Remove independent"))
    if relative:
        findings += _no_share(where, addresses, bench.design)
    require(findings)
    members = tuple((address,) for address in addresses) if table.independent else tuple(tuple(found) for found in components.values())
    return Scatter(name, sources, RATIO if relative else quantity, distribution, members, table.independent, relative)


def _no_share(where: str, addresses: list[str], design: Mechanism) -> list[Finding]:
    nought = [address for address in addresses if float(get(design, address)) == 0.0]
    advice = 'Use a deviation with a unit, e.g. "10 um"'
    return [Finding(where, f"{nought[0]} is 0, so a deviation in percent has no effect", advice)] if nought else []


def _components(sources: tuple[str, ...], where: str, bench: _Reached, findings: list[Finding]) -> dict[str, list[str]]:
    found = dict[str, list[str]]()
    for source in sources:
        try:
            reached = reach(bench.design, source)
        except DesignError as error:
            findings += (Finding(where, f"{each.where}: {each.what}", each.advice) for each in error.findings)
            continue
        bench.shared.update(reached.shared)
        for component, addresses in reached.components.items():
            known = found.setdefault(component, [])
            known += [address for address in addresses if address not in known]
    return found


def _shape(table: ScatterTable, where: str, findings: list[Finding]) -> Shape:
    """The specified distribution."""
    specified = [shape for shape, raw in ((Shape.NORMAL, table.normal), (Shape.UNIFORM, table.uniform)) if raw is not None]
    if len(specified) != 1 and (specified or table.interval is None):
        what = "must be normal or uniform, not both" if specified else "deviation missing"
        advice = 'Use normal = "2 um" (standard deviation), uniform = "5 um" (half width), or interval = ["-1 um", "5 um"]'
        findings.append(Finding(f"{where}.normal", what, advice))
    if table.within is not None and specified == [Shape.UNIFORM]:
        findings.append(Finding(f"{where}.within", "a uniform distribution is bounded already", "Remove within"))
    if table.interval is not None and (table.uniform is not None or table.within is not None):
        findings.append(Finding(f"{where}.interval", "limits specified twice", "Remove uniform or within"))
    return specified[0] if specified else Shape.UNIFORM if table.interval else Shape.NORMAL


def _distribution(table: ScatterTable, where: str, shape: Shape, quantity: Quantity) -> tuple[Distribution, bool]:
    """The distribution, and whether its numbers are shares of the design's value."""
    low, high = table.interval or (None, None)
    raw = {"normal": table.normal, "uniform": table.uniform, "within": table.within, "interval.0": low, "interval.1": high}
    specified = {key: text for key, text in raw.items() if text is not None}
    if len({is_share(text) for text in specified.values()}) > 1:
        raise refuse(f"{where}.within", "some amounts are relative (%), others are not", "Use % for all amounts or for none")
    sizes = dict[str, float]()
    findings = list[Finding]()
    for key, text in specified.items():
        wanted = RATIO if is_share(text) else quantity
        try:
            sizes[key] = parse_amount(text, wanted, f"{where}.{key}")
            if not sizes[key] > 0.0 and key not in ("interval.0", "interval.1"):
                findings.append(
                    Finding(f"{where}.{key}", f"must be greater than 0 (got {show(sizes[key], wanted)})", "Use a positive deviation")
                )
        except DesignError as error:
            findings += error.findings
    require(findings)
    relative = is_share(next(iter(specified.values())))
    if table.interval is None:
        return Distribution(shape, sizes[shape.value], sizes.get("within")), relative
    low, high = sizes["interval.0"], sizes["interval.1"]
    if not low < high:
        raise refuse(f"{where}.interval", "the lower limit must be below the upper limit", 'Use e.g. interval = ["-1 um", "5 um"]')
    half, middle = 0.5 * (high - low), 0.5 * (high + low)
    return Distribution(shape, sizes.get("normal", half), half if shape is Shape.NORMAL else None, middle), relative


def _command(table: ToleranceTable, design: Mechanism, findings: list[Finding]) -> Command | None:
    """The nominal stage's command; nothing if it is disabled, or neither requested nor available."""
    if table.crosstalk is False:
        return None
    try:
        if table.crosstalk is None and table.point == PLATFORM and not ideal(design).actuated:
            return None
        return nominal_command(design, table.point)
    except DesignError as error:
        findings += (Finding("tolerance.crosstalk", f"{each.where}: {each.what}", each.advice) for each in error.findings)
        return None
