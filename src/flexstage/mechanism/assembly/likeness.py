"""Inheritance of units (`like`): inherited bodies and links, and precedence of overrides."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

from flexstage.base.finding import Finding
from flexstage.base.number import Table
from flexstage.mechanism.mechanism import Mechanism, Unit


def drawn_units(mechanism: Mechanism) -> Mapping[str, Unit]:
    """Return the units including inherited bodies and links. A unit's own bodies and links replace inherited ones of the same name.

    >>> drawn_units(Mechanism("", units={"outer": Unit({}, {}, like="inner"), "inner": Unit({}, {}, stiffness=1e6)}))["outer"].like
    'inner'
    """
    if all(unit.like is None for unit in mechanism.units.values()):
        return mechanism.units
    return {name: _drawn(mechanism, name) for name in mechanism.units}


def _drawn(mechanism: Mechanism, name: str) -> Unit:
    unit = mechanism.units[name]
    models = [mechanism.units[each] for each in reversed(ancestry(mechanism, name))]
    bodies = {key: body for each in models for key, body in each.bodies.items()}
    links = {key: link for each in models for key, link in each.links.items()}
    return replace(unit, bodies=Table(bodies), links=Table(links))


def ancestry(mechanism: Mechanism, name: str) -> tuple[str, ...]:
    """Return the unit's name and the chain of units from which it inherits, up to an unknown or repeated unit.

    >>> ancestry(Mechanism("", units={"outer": Unit({}, {}, like="inner"), "inner": Unit({}, {})}), "outer")
    ('outer', 'inner')
    """
    results: list[str] = []
    while name in mechanism.units and name not in results:
        results.append(name)
        name = mechanism.units[name].like or ""
    return tuple(results)


def link_lineage(mechanism: Mechanism, unit: str, link: str) -> tuple[str, ...]:
    """Return the units whose overrides apply to a unit's link, beginning with the unit that draws the link.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> link_lineage(double_triangle(), "horizontal", "front")
    ('horizontal',)
    """
    line = ancestry(mechanism, unit)
    own = next((number for number, name in enumerate(line) if link in mechanism.units[name].links), 0)
    return line[own::-1]


def likeness_findings(mechanism: Mechanism) -> Iterator[Finding]:
    """Return errors for units with circular inheritance.

    >>> print(*likeness_findings(Mechanism("", units={"inner": Unit({}, {}, like="inner")})))
    units.inner.like: circular reference. Remove like from one unit.
    """
    for name, unit in mechanism.units.items():
        if unit.like is None:
            continue
        line = ancestry(mechanism, name)
        if mechanism.units[line[-1]].like == name:
            what = "circular reference" if len(line) == 1 else f"circular reference: {', '.join(line)}"
            yield Finding(f"units.{name}.like", what, "Remove like from one unit")
