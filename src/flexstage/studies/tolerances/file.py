"""The sections `[scatter]` and `[tolerance]` of a study's file."""

from __future__ import annotations

import os
from dataclasses import dataclass, field, replace
from pathlib import Path

from flexstage.analysis.requirements import Requirement, requirements
from flexstage.base.finding import DesignError, Finding, nearest, require
from flexstage.base.number import Table
from flexstage.base.quantity import RATIO, Quantity
from flexstage.base.unit import show
from flexstage.mechanism.address import get, quantity_of
from flexstage.mechanism.mechanism import PLATFORM, Mechanism
from flexstage.mechanism.store.file import read_text
from flexstage.models.ideal import ideal
from flexstage.studies.sweeps.definition import name_findings
from flexstage.studies.sweeps.fields import Fields
from flexstage.studies.sweeps.file import Opening, opening, placed
from flexstage.studies.sweeps.plan import Sampling
from flexstage.studies.sweeps.start import one_quantity
from flexstage.studies.tolerances.bounds import bound_findings
from flexstage.studies.tolerances.crosstalk import Command
from flexstage.studies.tolerances.definition import Copies, Tolerance, commanded
from flexstage.studies.tolerances.distribution import Distribution, Shape
from flexstage.studies.tolerances.reach import reach
from flexstage.studies.tolerances.scatter import Scatter, targets

_SAMPLINGS = (Sampling.MONTE_CARLO, Sampling.LATIN_HYPERCUBE, Sampling.SOBOL)
_COPIES = 1024
_FEWEST = 32
_YIELD = 0.99
_MOST = 10**7


def load_tolerance(path: str | os.PathLike[str]) -> Tolerance:
    """Read a study's file with sections `[scatter]` and, if need be, `[tolerance]`.

    Raises `DesignError` with every finding: what points nowhere (with the nearest names), deviations that are not above nought or wider
    than the number, `each` of what there is only one of.

    >>> load_tolerance("nowhere/study.toml")
    Traceback (most recent call last):
        ...
    flexstage.base.finding.DesignError: nowhere/study.toml: there is no such file. Check the path, or write one with "flexstage new".
    """
    return loads_tolerance(read_text(path), where=os.fspath(path), folder=Path(path).parent)


def loads_tolerance(text: str, *, where: str = "text", folder: Path | None = None) -> Tolerance:
    """Read a tolerance study from its text; `folder` is where design files are looked for.

    >>> study = loads_tolerance('''
    ... format = "flexstage study 1"
    ... case = "parallelogram"
    ... scatter.wire = { of = "hinges.thickness", normal = "5 um", each = true }
    ... ''')
    >>> [variable.name for variable in study.variables][:2]
    ['wire.links.left.thickness', 'wire.links.right.thickness']
    >>> [line.key for line in study.limits], study.plan.count
    (['stroke.x', 'frequency.platform.1', 'safety'], 1024)
    """
    head = opening(text, where, folder)
    findings, design = head.findings, head.design
    bench = _Bench(design)
    scatters = tuple(each for name in head.tables["scatter"].tree if (each := _scatter(head.tables["scatter"].table(name), name, bench)))
    if not head.tables["scatter"].tree:
        findings.append(Finding("scatter", "nothing scatters", 'Write for example wire = { of = "hinges.thickness", normal = "5 um" }'))
    asked = _asked(head.tables["tolerance"], design)
    limits = (*(_lines(design, findings) if asked.require else ()), *head.limits)
    if not head.responses and not limits and asked.command is None:
        findings.append(Finding("responses", "nothing is asked", 'Name a measure, for example f1 = "frequency.platform.1"'))
    require(placed(findings, where))
    return _study(head, scatters, (asked, limits, bench.shared), (text, where))


@dataclass(frozen=True, eq=False)
class _Bench:
    """The design, and which shared number each copy's own comes from."""

    design: Mechanism
    shared: dict[str, str] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class _Asked:
    """The section `[tolerance]`."""

    copies: int
    seed: int
    sampling: Sampling
    require: bool
    wanted: float
    command: Command | None


def _study(
    head: Opening, scatters: tuple[Scatter, ...], asked: tuple[_Asked, tuple[Requirement, ...], dict[str, str]], origin: tuple[str, str]
) -> Tolerance:
    wishes, limits, shared = asked
    variables = tuple(one for each in scatters for one in each.variables())
    reached = targets(head.design, variables, shared)
    groups = tuple(len(each.members) for each in scatters)
    alone = max(_FEWEST, wishes.copies // 16) if len(groups) > 1 else 0
    plan = Copies(wishes.sampling, len(variables), wishes.copies, seed=wishes.seed, alone=alone, groups=groups)
    study = Tolerance(
        name=head.name,
        design=head.design,
        variables=variables,
        responses=Table(head.responses),
        limits=limits,
        plan=plan,
        text=origin[0],
        scatters=scatters,
        targets=reached,
        wanted=wishes.wanted,
        commanded=wishes.command,
    )
    named = (replace(each, where=each.where.replace("variables.", "scatter.", 1)) for each in name_findings(study))
    require(placed([*bound_findings(head.design, reached, variables), *named], origin[1]))
    return study


def _lines(design: Mechanism, findings: list[Finding]) -> tuple[Requirement, ...]:
    try:
        return requirements(design)
    except DesignError as error:
        findings.extend(error.findings)
        return ()


def _scatter(table: Fields, name: str, bench: _Bench) -> Scatter | None:
    """One entry; nothing after a finding about it."""
    before = len(table.findings)
    sources = table.text_or_texts("of", name)
    components = _components(table, sources, bench)
    addresses = [address for members in components.values() for address in members]
    quantity = one_quantity(table, "of", [quantity_of(bench.design, address) for address in addresses])
    found = _distribution(table, quantity)
    each = table.flag("each")
    table.done()
    if found is None or quantity is None or len(table.findings) > before:
        return None
    distribution, relative = found
    if each and len(addresses) < 2:
        table.note("each", f"{addresses[0]} is one number, and has no copies", "Leave it out")
    if relative:
        table.findings.extend(_no_share(table, addresses, bench.design))
    if len(table.findings) > before:
        return None
    members = tuple((address,) for address in addresses) if each else tuple(tuple(found) for found in components.values())
    return Scatter(name, sources, RATIO if relative else quantity, distribution, members, each, relative)


def _no_share(table: Fields, addresses: list[str], design: Mechanism) -> list[Finding]:
    nought = [address for address in addresses if float(get(design, address)) == 0.0]
    advice = 'Give the deviation with its unit, for example "10 um"'
    return [Finding(table.where, f"{nought[0]} is 0, and a share of it is 0", advice)] if nought else []


def _components(table: Fields, sources: tuple[str, ...], bench: _Bench) -> dict[str, list[str]]:
    found: dict[str, list[str]] = {}
    for source in sources:
        try:
            reached = reach(bench.design, source)
        except DesignError as error:
            table.findings.extend(Finding(table.where, f"{each.where}: {each.what}", each.advice) for each in error.findings)
            continue
        bench.shared.update(reached.shared)
        for component, addresses in reached.components.items():
            known = found.setdefault(component, [])
            known += [address for address in addresses if address not in known]
    return found


def _distribution(table: Fields, quantity: Quantity | None) -> tuple[Distribution, bool] | None:
    """The distribution, and whether its numbers are shares of what the design states."""
    given = [shape for shape in Shape if shape.value in table.tree]
    table.asked.extend([*(shape.value for shape in Shape), "within"])
    if len(given) != 1:
        what = "it is both normal and uniform" if given else "it is not said how far it deviates"
        table.note(Shape.NORMAL.value, what, 'Write normal = "2 um", a standard deviation, or uniform = "5 um", a half width')
        return None
    size, relative = _size(table, given[0].value, quantity)
    within, also = _size(table, "within", quantity) if "within" in table.tree else (None, relative)
    if size is not None and within is not None and relative != also:
        table.note("within", "one is relative (%), the other not", "Give both alike")
    if within is not None and given[0] is Shape.UNIFORM:
        table.note("within", "a uniform distribution ends by itself", "Leave it out")
    return None if size is None else (Distribution(given[0], size, within), relative)


def _size(table: Fields, key: str, quantity: Quantity | None) -> tuple[float | None, bool]:
    raw = table.tree.get(key)
    relative = isinstance(raw, str) and raw.strip().endswith("%")
    wanted = RATIO if relative else quantity
    if wanted is None:
        table.asked.append(key)
        return None, relative
    value = table.number(key, wanted)
    if value is not None and not value > 0.0:
        table.note(key, f"found {show(value, wanted)}", "Give a deviation above 0")
        return None, relative
    return value, relative


def _asked(table: Fields, design: Mechanism) -> _Asked:
    copies, seed = table.whole("copies", 2, _COPIES), table.whole("seed", 0, 0)
    if copies > _MOST:
        table.note("copies", f"these are {copies:.3g} copies", f"Ask for at most {_MOST:.0e}")
    text = table.text("sampling", _SAMPLINGS[0].value)
    known = [each.value for each in _SAMPLINGS]
    if text not in known:
        table.note("sampling", f'found "{text}"', nearest(text, known))
        text = known[0]
    wanted = table.number("yield", RATIO, _YIELD)
    if wanted is None or not 0.5 < wanted < 1.0:
        table.note("yield", f"found {wanted}", 'Give a share between 50 % and 100 %, for example "99 %"')
    needed = table.raw("require", bool, "true or false", default=True)
    found = _command(table, design)
    table.done()
    return _Asked(copies, seed, Sampling(text), needed, wanted or _YIELD, found)


def _command(table: Fields, design: Mechanism) -> Command | None:
    """What the nominal stage is commanded by; nothing where it is not wanted, or not said and not to be had."""
    wanted = table.raw("crosstalk", bool, "true or false")
    point = table.text("point", PLATFORM)
    if wanted is False:
        return None
    try:
        if wanted is None and point == PLATFORM and not ideal(design).actuated:
            return None
        return commanded(design, point)
    except DesignError as error:
        table.findings.extend(Finding(table.at("crosstalk"), f"{each.where}: {each.what}", each.advice) for each in error.findings)
        return None
