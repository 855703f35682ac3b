"""Checks that names are valid and unique, and that the entries they name exist."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator

from flexstage.base.finding import Finding, suggest_nearest
from flexstage.mechanism.assembly.expand import placed_bodies, placed_links, unit_of_copy, unknown_names
from flexstage.mechanism.assembly.likeness import drawn_units, likeness_findings
from flexstage.mechanism.assembly.pattern import RANGE, copy_names
from flexstage.mechanism.assembly.sight import gauge_findings
from flexstage.mechanism.grammar.grammar import RESERVED
from flexstage.mechanism.mechanism import EVERYWHERE, GROUND, NAMED, NOT_GROWING, PLATFORM, Link, Mechanism, every_body, posed
from flexstage.parts.actuator import ThrustActuator
from flexstage.parts.body import Body, owner_of
from flexstage.parts.part import inner

MOST_COPIES = 360
_LONGEST = 60


def name_findings(mechanism: Mechanism) -> Iterator[Finding]:
    """Return errors of names; the placement keys must be valid.

    >>> print(*name_findings(Mechanism("", bodies={"ground": Body(), "platform": Body()})))
    bodies.ground: "ground" is implied and cannot be a body of the stage. Rename the body.
    """
    yield from _spelling(mechanism)
    yield from _bodies(mechanism)
    yield from _owners(mechanism)
    yield from unknown_names(mechanism)
    yield from _check_known("ground", "material", mechanism.ground, (*mechanism.materials, NOT_GROWING))
    yield from likeness_findings(mechanism)
    yield from _check_placement(mechanism)
    yield from _clashes(mechanism)
    yield from _loops(mechanism)
    for where, link, bodies in _links(mechanism):
        yield from _link(where, link, bodies)
    yield from _circuits(mechanism)


def copy_findings(mechanism: Mechanism) -> Iterator[Finding]:
    """Return errors of placement keys (`B1-B3`): reversed, too many, or repeated instances.

    >>> from flexstage.mechanism.mechanism import Placement
    >>> from flexstage.mechanism.assembly.pattern import Pose
    >>> print(*copy_findings(Mechanism("", placements={"B3-B1": Placement("leg", Pose())})))
    placements.B3-B1: the first number, 3, is above the last, 1. Use ascending order.
    """
    for section in ("placements", "gauges", "stops"):
        keys = getattr(mechanism, section)
        faults = [fault for key in keys if (fault := _range_fault(f"{section}.{key}", key))]
        yield from faults
        if not faults:
            names = Counter(name for key in keys for name in copy_names(key))
            for name in [name for name, count in names.items() if count > 1]:
                holders = ", ".join(key for key in keys if name in copy_names(key))
                yield Finding(f"{section}.{name}", f"{holders} use the name {names[name]} times", "Use a unique name for every instance")


def _range_fault(where: str, key: str) -> Finding | None:
    if len(key) > _LONGEST:
        return Finding(
            f"{where[:_LONGEST]}...", f"name too long (got {len(key)} characters, expected {_LONGEST} at most)", "Use a shorter name"
        )
    match = RANGE.fullmatch(key)
    if match is None:
        return None
    if max(len(match[2]), len(match[3])) > 9:
        return Finding(where, "numbers with too many digits", "Use e.g. B1-B3")
    first, last = int(match[2]), int(match[3])
    if first > last:
        return Finding(where, f"the first number, {first}, is above the last, {last}", "Use ascending order")
    if last - first >= MOST_COPIES:
        return Finding(where, f"too many instances (got {last - first + 1}, expected {MOST_COPIES} at most)", "Use fewer instances")
    return None


def _spelling(mechanism: Mechanism) -> Iterator[Finding]:
    tables: dict[str, Iterable[str]] = {section: getattr(mechanism, section) for section in NAMED}
    for name, unit in mechanism.units.items():
        tables[f"units.{name}.bodies"], tables[f"units.{name}.links"] = unit.bodies, unit.links
    for where, body in every_body(mechanism):
        tables[f"{where}.solids"], tables[f"{where}.points"] = body.solids, body.points
    for where, names in tables.items():
        for name in names:
            if name in RESERVED or len(name) > _LONGEST or not re.fullmatch(r"\w[\w-]*(/\w[\w-]*)*", name):
                yield Finding(f'{where}."{name[:_LONGEST]}"', "invalid name", "Use letters, digits, _ and -; tags and like are reserved")


def _links(mechanism: Mechanism) -> Iterator[tuple[str, Link, dict[str, Body]]]:
    """Every drawn link, its address, and the bodies it may join apart from the ground."""
    stage = placed_bodies(mechanism)
    for name, link in mechanism.links.items():
        yield f"links.{name}", link, stage
    for unit, drawn in drawn_units(mechanism).items():
        for name, link in mechanism.units[unit].links.items():
            yield f"units.{unit}.links.{name}", link, stage | dict(drawn.bodies)


def _owners(mechanism: Mechanism) -> Iterator[Finding]:
    """Errors of `of`: it must be an independent body of the stage, or the ground."""
    stage = placed_bodies(mechanism)
    for where, body in every_body(mechanism):
        if body.of is None:
            continue
        yield from _check_known(f"{where}.of", "body of the stage", body.of, {GROUND, *stage})
        owner = stage.get(body.of)
        if where == f"bodies.{PLATFORM}":
            yield Finding(
                f"{where}.of", "the platform cannot belong to another body", 'Remove this key; specify of = "platform" in the other body'
            )
        elif owner is not None and owner.of is not None:
            what = f'"{body.of}" belongs to another body, "{owner.of}"'
            yield Finding(f"{where}.of", what, f'Specify of = "{owner.of}"' if owner is not body else "Use another body, or remove 'of'")


def _bodies(mechanism: Mechanism) -> Iterator[Finding]:
    if PLATFORM not in mechanism.bodies:
        yield Finding("bodies", f'unknown body "{PLATFORM}"', f"Declare the moving platform under bodies.{PLATFORM}")
    if GROUND in mechanism.bodies:
        yield Finding(f"bodies.{GROUND}", f'"{GROUND}" is implied and cannot be a body of the stage', "Rename the body")
    for unit, drawn in mechanism.units.items():
        for name in drawn.bodies:
            if name == GROUND or (name in mechanism.bodies and "/" not in unit):
                yield Finding(f"units.{unit}.bodies.{name}", f'the stage also has a body "{name}"', "Rename the unit's body")


def _check_known(where: str, kind: str, name: str | None, names: Iterable[str]) -> Iterator[Finding]:
    if name is not None and name not in names:
        yield Finding(where, f'unknown {kind} "{name}"', suggest_nearest(name, names))


def _check_placement(mechanism: Mechanism) -> Iterator[Finding]:
    gauged = {GROUND, *(name for name, body in placed_bodies(mechanism).items() if body.of is None)}
    loads = gauged - {GROUND}
    bodies = (("gauges", posed(mechanism.gauges), gauged), ("stops", mechanism.stops, gauged))
    for section, items, known in (*bodies, ("payloads", mechanism.payloads, loads), ("forces", mechanism.forces, loads)):
        for name, item in items.items():
            for key in ("body", "base"):
                yield from _check_known(f"{section}.{name}.{key}", "body", getattr(item, key, None), known)
    for name, stop in mechanism.stops.items():
        if stop.body == stop.base:
            yield Finding(f"stops.{name}.base", f'equal to the body, "{stop.body}"', "Use the opposite body")
    yield from gauge_findings(mechanism, {name for name, _, _ in placed_links(mechanism)})
    for name in mechanism.temperatures:
        yield from _check_known(f"temperatures.{name}", "body", name, {EVERYWHERE, *gauged})


def _loops(mechanism: Mechanism) -> Iterator[Finding]:
    """Links of a unit that join a body of one instance: in that instance both ends may be equal."""
    for name, link, joins in placed_links(mechanism):
        if name not in mechanism.links and len({*joins}) == 1 and any("/" in body for body in link.bodies):
            advice = "Draw that link in the stage, or in a separate unit"
            yield Finding(f"{name}.joins", f'in this instance both ends join "{joins[0]}"', advice)


def _clashes(mechanism: Mechanism) -> Iterator[Finding]:
    copies = set(unit_of_copy(mechanism))
    for kind, names in (("unit", mechanism.units), ("link", mechanism.links)):
        for name in sorted(copies & set(names)):
            advice = "Rename one of them: addresses would be ambiguous"
            yield Finding(f"placements.{name}", f"a {kind} and an instance have this name", advice)


def _link(where: str, link: Link, bodies: dict[str, Body]) -> Iterator[Finding]:
    for body in link.bodies:
        if body not in bodies:
            yield from _check_known(f"{where}.joins", "body", body, {GROUND, *bodies})
    owners = {owner_of(bodies, body) for body in link.bodies}
    if len(owners) == 1:
        both = "both ends" if len(link.bodies) == 2 else "all ports"
        yield Finding(f"{where}.joins", f'{both} join "{owners.pop()}"', "Use two different bodies")


def _circuits(mechanism: Mechanism) -> Iterator[Finding]:
    """A circuit joins force actuators of one part, and has a legal name that no other link or instance has."""
    parts: dict[str, str] = {}
    taken = {*(name for name, link in mechanism.links.items() if not link.circuit), *unit_of_copy(mechanism)}
    for where, link, _ in _links(mechanism):
        part = mechanism.parts.get(link.part)
        name = link.circuit and link.circuit.removeprefix("-")
        if not name or part is None:
            continue
        if not re.fullmatch(r"\w[\w-]*", name):
            yield Finding(f"{where}.circuit", f'invalid name "{link.circuit}"', 'Use e.g. "pair" or "-pair"')
        if not isinstance(inner(part), ThrustActuator):
            yield Finding(f"{where}.circuit", f'its part "{link.part}" exerts no force', "Remove this key, or use a force actuator")
        elif name in taken:
            yield Finding(f"{where}.circuit", f'a link or an instance also has the name "{name}"', "Use a unique name")
        elif parts.setdefault(name, link.part) != link.part:
            what = f'different parts in one circuit (got "{link.part}", and "{parts[name]}" in another link)'
            yield Finding(f"{where}.circuit", what, "Use one part for all links of a circuit")
