"""The study's file: TOML with unit strings, read with all its findings at once."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from flexstage.analysis.requirements import Measure, Requirement, measure, requirement
from flexstage.analysis.sensitivities import not_numbers
from flexstage.base.finding import DesignError, Finding, nearest, require
from flexstage.base.number import Table
from flexstage.base.quantity import RATIO, Quantity
from flexstage.cases.registry import Variant
from flexstage.mechanism.address import quantity_of
from flexstage.mechanism.mechanism import Mechanism
from flexstage.mechanism.store.file import parse_toml, read_text
from flexstage.studies.sweeps.definition import Study, name_findings
from flexstage.studies.sweeps.fields import Fields
from flexstage.studies.sweeps.plan import Plan, Sampling
from flexstage.studies.sweeps.start import one_quantity, parameters_varied, start
from flexstage.studies.sweeps.variable import Variable, variable_findings

FORMAT = "flexstage study 1"
OTHERS = ("optimise", "tolerance", "scatter")
"""Sections that a study's file may have for other commands; each is read by its own."""
_MOST = 10**9


def load_study(path: str | os.PathLike[str]) -> Study:
    """Read a study's file; a design file that it names is looked for beside it.

    Raises `DesignError` with every finding: unknown keys, variables and measures (with the nearest names), empty ranges, wrong units.

    >>> load_study("nowhere/study.toml")
    Traceback (most recent call last):
        ...
    flexstage.base.finding.DesignError: nowhere/study.toml: there is no such file. Check the path, or write one with "flexstage new".
    """
    return loads_study(read_text(path), where=os.fspath(path), folder=Path(path).parent)


def loads_study(text: str, *, where: str = "text", folder: Path | None = None) -> Study:
    """Read a study from its text; `folder` is where design files are looked for.

    >>> study = loads_study('''
    ... format = "flexstage study 1"
    ... case = "double-triangle"
    ... variables.neck = { of = "parts.neck.thickness", from = "1.4 mm", to = "1.7 mm" }
    ... responses.tilt = "frequency.platform.1"
    ... sweep = { sampling = "sobol", designs = 8 }
    ... ''')
    >>> study.variables[0].high, study.responses["tilt"].key, study.plan.designs
    (0.0017, 'frequency.platform.1', 8)
    """
    head = opening(text, where, folder)
    design, tables, findings = head.design, head.tables, head.findings
    variables = _variables(tables["variables"], design, head.variant)
    plan = _plan(tables["sweep"], variables)
    if not tables["responses"].tree:
        findings.append(Finding("responses", "nothing is asked", 'Name a measure, for example f1 = "frequency.platform.1"'))
    study = Study(head.name, design, variables, Table(head.responses), head.limits, plan, text)
    require(placed([*findings, *variable_findings(design, variables), *name_findings(study)], where))
    return study


@dataclass(frozen=True, eq=False)
class Opening:
    """What all studies' files have: the design, what is asked of it, and the `tables` of their sections with the `findings` so far.

    `variant` is the case that the design is drawn from; `None`: a design file.
    """

    name: str
    design: Mechanism
    tables: Mapping[str, Fields]
    responses: Mapping[str, Measure]
    limits: tuple[Requirement, ...]
    findings: list[Finding]
    variant: Variant | None = None


def opening(text: str, where: str, folder: Path | None) -> Opening:
    """Read what all studies' files have; sections are left to who reads them. Raises `DesignError` where there is no design to go on with.

    >>> text = 'format = "flexstage study 1"' + chr(10) + 'case = "parallelogram"' + chr(10) + 'responses.f = "frequency.1"'
    >>> list(opening(text, "here", None).responses)
    ['f']
    """
    findings: list[Finding] = []
    fields = Fields(parse_toml(text, where), "", findings)
    if fields.text("format") != FORMAT:
        fields.note("format", f'found "{fields.text("format")}"', f'Begin the file with format = "{FORMAT}"')
    name = fields.text("name", "study")
    design, variant = start(fields, folder or Path())
    tables = {key: fields.table(key) for key in ("variables", "responses", "limits", "sweep", *OTHERS)}
    fields.done()
    require(placed(findings, where))
    responses, limits = _responses(tables["responses"], design), _limits(tables["limits"], design)
    return Opening(name, design, tables, responses, limits, findings, variant)


def placed(findings: Iterable[Finding], where: str) -> Iterator[Finding]:
    """Findings with the file they are about.

    >>> [str(each) for each in placed([Finding("limits", "none", "Add one")], "study.toml")]
    ['study.toml: limits: none. Add one.']
    """
    for each in findings:
        yield Finding(f"{where}: {each.where}", each.what, each.advice)


def _variables(table: Fields, design: Mechanism, variant: Variant | None) -> tuple[Variable, ...]:
    """All variables; the name of one that gives no address is its address."""
    found = [_variable(table.table(name), name, design, variant) for name in table.tree]
    if not table.tree:
        what = 'Write for example neck = { of = "parts.neck.thickness", from = "1.4 mm", to = "1.7 mm" }'
        table.findings.append(Finding("variables", "nothing is varied", what))
    return tuple(each for each in found if each is not None)


def _variable(table: Fields, name: str, design: Mechanism, variant: Variant | None) -> Variable | None:
    before = len(table.findings)
    if "parameter" in table.tree:
        addresses, quantity = parameters_varied(table, variant)
    else:
        addresses = table.text_or_texts("of", name)
        quantity, variant = _quantity(table, addresses, design), None
    low, relative = _end(table, "from", quantity)
    high, also = _end(table, "to", quantity)
    logarithmic = table.flag("logarithmic")
    levels = table.whole("levels", 2, 0) or None
    step = _step(table, quantity, relative=relative)
    table.done()
    if len(table.findings) == before and relative != also:
        table.note("to", "one end is relative (%), the other not", "Give both alike")
    if quantity is None or len(table.findings) > before:
        return None
    return Variable(name, addresses, RATIO if relative else quantity, low, high, relative, logarithmic, levels, step, variant)


def _step(table: Fields, quantity: Quantity | None, *, relative: bool) -> float | None:
    """The step of values that can be made."""
    step = None if quantity is None or "step" not in table.tree else table.number("step", quantity)
    table.asked.append("step")
    if step is not None and relative:
        table.note("step", "the range is relative (%)", "Give the range with its unit, or leave out the step")
    elif step is not None and not step > 0.0:
        table.note("step", f"found {step:g}", 'Give a step above 0, for example step = "10 um"')
    return step


def _quantity(table: Fields, addresses: tuple[str, ...], design: Mechanism) -> Quantity | None:
    """The quantity of what is moved; all addresses must have the same."""
    found: list[Quantity] = []
    for address in addresses:
        try:
            wrong = list(not_numbers(design, (address,)))
            table.findings.extend(Finding(table.where, f"{each.where}: {each.what}", each.advice) for each in wrong)
            found += [] if wrong else [quantity_of(design, address)]
        except DesignError as error:
            table.findings.extend(Finding(table.where, f"{each.where}: {each.what}", each.advice) for each in error.findings)
    return one_quantity(table, "of", found)


def _end(table: Fields, key: str, quantity: Quantity | None) -> tuple[float, bool]:
    """One end of a range, and whether it is relative: "-10 %" is nine tenths of what the design states."""
    raw = table.tree.get(key)
    if isinstance(raw, str) and raw.strip().endswith("%"):
        share = table.number(key, RATIO, 0.0)
        return 1.0 + (share or 0.0), True
    if raw is None:
        table.asked.append(key)
        table.note(key, "it is not given", 'Give both ends, such as from = "1.4 mm", or from = "-10 %" of what the design states')
    value = None if quantity is None else table.number(key, quantity, 0.0)
    table.asked.append(key)
    return value or 0.0, False


def _responses(table: Fields, design: Mechanism) -> dict[str, Measure]:
    found: dict[str, Measure] = {}
    for name in table.tree:
        try:
            found[name] = measure(design, table.text(name), table.at(name))
        except DesignError as error:
            table.findings.extend(error.findings)
    return found


def _limits(table: Fields, design: Mechanism) -> tuple[Requirement, ...]:
    found: list[Requirement] = []
    for key in table.tree:
        try:
            found.append(requirement(design, key, table.text(key), table.at(key)))
        except DesignError as error:
            table.findings.extend(error.findings)
    return tuple(found)


def _plan(table: Fields, variables: tuple[Variable, ...]) -> Plan:
    wanted = table.text("sampling", Sampling.SOBOL.value)
    known = [each.value for each in Sampling]
    if wanted not in known:
        table.note("sampling", f'found "{wanted}"', nearest(wanted, known))
        wanted = Sampling.SOBOL.value
    sampling = Sampling(wanted)
    count, seed = table.whole("designs", 1, 1024), table.whole("seed", 0, 0)
    pairs = table.flag("pairs")
    if pairs and sampling is not Sampling.SALTELLI:
        table.note("pairs", f"sampling is {sampling.value}", f'Take sampling = "{Sampling.SALTELLI.value}", or leave it out')
    table.done()
    levels = _levels(table, variables) if sampling is Sampling.GRID else ()
    plan = Plan(sampling, len(variables), 0 if sampling is Sampling.GRID else count, levels, seed, pairs)
    if plan.designs > _MOST:
        table.note("designs", f"these are {plan.designs:.3g} designs", f"Ask for at most {_MOST:.0e}")
    return plan


def _levels(table: Fields, variables: tuple[Variable, ...]) -> tuple[int, ...]:
    for each in variables:
        if each.levels is None:
            table.findings.append(Finding(f"variables.{each.name}", "a grid needs its levels", "Add for example levels = 5"))
    if "designs" in table.tree:
        table.note("designs", "a grid has as many designs as its levels make", "Leave it out")
    return tuple(each.levels or 2 for each in variables)
