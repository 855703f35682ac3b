"""Reading of study files: TOML with units as text. All errors are reported together."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from flexstage.analysis.assessment.measures import Measure
from flexstage.analysis.assessment.requirements import Requirement, measure, requirement
from flexstage.analysis.assessment.sensitivities import not_numbers
from flexstage.base.arguments import check_arguments
from flexstage.base.finding import DesignError, Finding, require
from flexstage.base.number import Table
from flexstage.base.units.quantity import RATIO, Quantity
from flexstage.cases.registry import Variant
from flexstage.mechanism.addresses.address import quantity_of
from flexstage.mechanism.mechanism import Mechanism
from flexstage.mechanism.store.file import read_text
from flexstage.mechanism.store.lines import with_lines
from flexstage.studies.form import StudyFile, SweepTable, VariedTable, is_share, parse_amount, study_file
from flexstage.studies.sweeps.definition import Study, name_findings
from flexstage.studies.sweeps.plan import Plan, Sampling
from flexstage.studies.sweeps.start import one_quantity, read_parameters, start
from flexstage.studies.sweeps.variable import Variable, variable_findings

_DESIGNS = 1024
_MOST = 10**9


@check_arguments
def load_study(path: str | os.PathLike[str]) -> Study:
    """Read a study's file. The study's design file must be in the same folder.

    Raises one `DesignError` that lists all errors, for example unknown keys, variables and measures (with the nearest known names), empty
    ranges, and wrong units.

    >>> load_study("nowhere/study.toml")
    Traceback (most recent call last):
        ...
    flexstage.base.finding.DesignError: nowhere/study.toml: file not found. Check the path.
    """
    return loads_study(read_text(path), where=os.fspath(path), folder=Path(path).parent)


def loads_study(text: str, *, where: str = "text", folder: Path | None = None) -> Study:
    """Read a study from its text. `folder` contains the design files.

    >>> study = loads_study('''
    ... format = "flexstage study 1"
    ... case = "double-triangle"
    ... variables.neck = { address = "parts.neck.thickness", from = "1.4 mm", to = "1.7 mm" }
    ... responses.tilt = "frequency.platform.1"
    ... sweep = { sampling = "sobol", designs = 8 }
    ... ''')
    >>> study.variables[0].high, study.responses["tilt"].key, study.plan.designs
    (0.0017, 'frequency.platform.1', 8)
    """
    head = read_opening(text, where, folder)
    file, design, findings = head.file, head.design, head.findings
    variables = _variables(file.variables, head)
    plan = _plan(file.sweep, variables, findings)
    if not file.responses:
        findings.append(Finding("responses", "no response", 'Add a measure, e.g. f1 = "frequency.platform.1"'))
    study = Study(file.name, design, variables, Table(head.responses), head.limits, plan, text)
    require(with_lines([*findings, *variable_findings(design, variables), *name_findings(study)], text, where))
    return study


@dataclass(frozen=True, eq=False)
class Opening:
    """Common part of the files of all studies: the file as written, its design and responses, and the `findings` so far.

    `variant` is the case of the design, or `None` for a design file.
    """

    file: StudyFile
    design: Mechanism
    responses: Mapping[str, Measure]
    limits: tuple[Requirement, ...]
    findings: list[Finding]
    variant: Variant | None = None


def read_opening(text: str, where: str, folder: Path | None) -> Opening:
    """Read the common part of the file of any study. Raises `DesignError` if it specifies no valid design.

    >>> text = 'format = "flexstage study 1"' + chr(10) + 'case = "parallelogram"' + chr(10) + 'responses.f = "frequency.1"'
    >>> list(read_opening(text, "here", None).responses)
    ['f']
    """
    file = study_file(text, where)
    try:
        design, variant = start(file, folder or Path())
    except DesignError as error:
        raise DesignError(with_lines(error.findings, text, where)) from None
    findings = list[Finding]()
    return Opening(file, design, _responses(file, design, findings), _limits(file, design, findings), findings, variant)


def _variables(tables: Mapping[str, VariedTable], head: Opening) -> tuple[Variable, ...]:
    """All variables; without an address, the name of a variable is its address."""
    if not tables:
        what = 'Use e.g. neck = { address = "parts.neck.thickness", from = "1.4 mm", to = "1.7 mm" }'
        head.findings.append(Finding("variables", "no variable", what))
    found = []
    for name, table in tables.items():
        try:
            found.append(_variable(table, name, head))
        except DesignError as error:
            head.findings.extend(error.findings)
    return tuple(found)


def _variable(table: VariedTable, name: str, head: Opening) -> Variable:
    where = f"variables.{name}"
    if table.parameter is None:
        addresses, variant = table.address or (name,), None
        quantity = _quantity(where, addresses, head.design)
    else:
        variant = head.variant
        addresses, quantity = read_parameters(table, where, variant)
    shares = (is_share(table.low), is_share(table.high))
    findings = list[Finding]()
    if shares[0] != shares[1]:
        findings.append(Finding(f"{where}.to", "only one end of the range is relative (%)", "Use % for both ends or for neither"))
    ends = list[float]()
    for key, raw, share in zip(("from", "to"), (table.low, table.high), shares, strict=True):
        try:
            ends.append(1.0 + parse_amount(raw, RATIO, f"{where}.{key}") if share else parse_amount(raw, quantity, f"{where}.{key}"))
        except DesignError as error:
            findings += error.findings
    step = _step(table, quantity, where, findings)
    require(findings)
    kind = RATIO if shares[0] else quantity
    return Variable(name, addresses, kind, ends[0], ends[1], shares[0], table.logarithmic, table.levels, step, variant)


def _step(table: VariedTable, quantity: Quantity, where: str, findings: list[Finding]) -> float | None:
    """The step of values that can be made."""
    if table.step is None:
        return None
    try:
        step = parse_amount(table.step, quantity, f"{where}.step")
    except DesignError as error:
        findings += error.findings
        return None
    if is_share(table.low):
        findings.append(Finding(f"{where}.step", "a relative range (%) cannot have a step", "Use a range with a unit, or remove the step"))
    elif not step > 0.0:
        findings.append(Finding(f"{where}.step", f"must be greater than 0 (got {step:g})", 'Use e.g. step = "10 um"'))
    return step


def _quantity(where: str, addresses: tuple[str, ...], design: Mechanism) -> Quantity:
    """The quantity of a variable; all addresses must have the same."""
    found = list[Quantity]()
    findings = list[Finding]()
    for address in addresses:
        try:
            wrong = list(not_numbers(design, (address,)))
            findings += wrong
            found += [] if wrong else [quantity_of(design, address)]
        except DesignError as error:
            findings += error.findings
    require(Finding(where, f"{each.where}: {each.what}", each.advice) for each in findings)
    return one_quantity(f"{where}.address", found)


def _responses(file: StudyFile, design: Mechanism, findings: list[Finding]) -> dict[str, Measure]:
    found = dict[str, Measure]()
    for name, text in file.responses.items():
        try:
            found[name] = measure(design, text, f"responses.{name}")
        except DesignError as error:
            findings.extend(error.findings)
    return found


def _limits(file: StudyFile, design: Mechanism, findings: list[Finding]) -> tuple[Requirement, ...]:
    found = list[Requirement]()
    for key, text in file.limits.items():
        try:
            found.append(requirement(design, key, text, f"limits.{key}"))
        except DesignError as error:
            findings.extend(error.findings)
    return tuple(found)


def _plan(table: SweepTable, variables: tuple[Variable, ...], findings: list[Finding]) -> Plan:
    if table.pairs and table.sampling is not Sampling.SALTELLI:
        advice = f'Use sampling = "{Sampling.SALTELLI.value}", or remove pairs'
        findings.append(Finding("sweep.pairs", f"not available for sampling {table.sampling.value}", advice))
    grid = table.sampling is Sampling.GRID
    levels = _levels(table, variables, findings) if grid else ()
    plan = Plan(table.sampling, len(variables), 0 if grid else table.designs or _DESIGNS, levels, table.seed, table.pairs)
    if plan.designs > _MOST:
        findings.append(Finding("sweep.designs", f"must be at most {_MOST:.0e} (got {plan.designs:.3g})", "Use fewer designs"))
    return plan


def _levels(table: SweepTable, variables: tuple[Variable, ...], findings: list[Finding]) -> tuple[int, ...]:
    without = [each.name for each in variables if each.levels is None]
    findings += (Finding(f"variables.{name}", "levels missing for a grid", "Add e.g. levels = 5") for name in without)
    if table.designs is not None:
        findings.append(Finding("sweep.designs", "the levels define the number of designs of a grid", "Remove designs"))
    return tuple(each.levels or 2 for each in variables)
