"""Transformations of a description: restriction of the degrees of freedom of parts, and isolation of one unit."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from flexstage.base.finding import refuse
from flexstage.base.number import Table, Vector
from flexstage.mechanism.assembly.expand import apply_overrides, copies
from flexstage.mechanism.assembly.likeness import ancestry, drawn_units, link_lineage
from flexstage.mechanism.assembly.pattern import Pose
from flexstage.mechanism.mechanism import GROUND, PLATFORM, Link, Mechanism, Placement
from flexstage.parts.body import Body, owner_of
from flexstage.parts.compliance_matrix import Joint
from flexstage.parts.freedom import Freedom
from flexstage.parts.part import Part, Restricted, inner

Freedoms = tuple[Freedom, ...]


def restrict(mechanism: Mechanism, kept: Mapping[str, tuple[Freedoms, Freedoms]]) -> Mechanism:
    """Restrict parts, by name or link address (`vertical/lower`), to the elastic and free degrees of freedom in `kept`; lock all others.

    Restricted parts are massless. Raises `DesignError` for a name that is not a part or a link.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> restrict(double_triangle(), {"neck": ((Freedom.X,), ())}).parts["neck"].elastic
    (<Freedom.X: 'x'>,)
    """
    result = mechanism
    for name, (elastic, free) in kept.items():
        if name in mechanism.parts:
            result = replace(result, parts={**result.parts, name: _restrict(mechanism.parts[name], elastic, free)})
        else:
            result = _restrict_link(result, mechanism, name, elastic, free)
    return result


def _restrict(part: Part, elastic: Freedoms, free: Freedoms) -> Part:
    own = inner(part)
    return Joint(free) if isinstance(own, Joint) else Restricted(own, elastic, free)


def _restrict_link(result: Mechanism, original: Mechanism, address: str, elastic: Freedoms, free: Freedoms) -> Mechanism:
    unit, _, link = address.rpartition("/")
    known = drawn_units(original)
    if unit not in known or link not in known[unit].links:
        raise refuse(address, "unknown part or link", f"Use one of {', '.join(original.parts)}")
    drawn, there = result.units[unit], known[unit].links[link]
    own = f"{there.part} of {address}"
    part = original.parts[there.part]
    if link not in drawn.links:  # drawn by the unit from here on: overrides of the other unit no longer apply
        there, part = apply_overrides(original, there, tuple(f"{each}/{link}" for each in link_lineage(original, unit, link)))
    part = _restrict(part, elastic, free)
    links = {**drawn.links, link: replace(there, part=own)}
    return replace(result, parts={**result.parts, own: part}, units={**result.units, unit: replace(drawn, links=links)})


def isolate(mechanism: Mechanism, copy: str, *, guide: Vector | None = None) -> Mechanism:
    """Isolate one unit in its own frame, with a massless platform at its output; `guide` constrains the output to a direction.

    The reference point of the output is the joint with the platform. Overrides of the instance and of its unit are kept. Other units, and
    outlines that belong to bodies of the stage (lugs of the platform), are omitted.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> list(isolate(double_triangle(), "B4").units)
    ['vertical']
    """
    units = {name: unit for name, unit, _ in copies(mechanism)}
    if copy not in units:
        raise refuse(copy, "unknown instance of a unit", f"Use one of {', '.join(units)}")
    unit = drawn_units(mechanism)[units[copy]]
    joint = next((link for link in unit.links.values() if PLATFORM in (owner_of(unit.bodies, body) for body in link.bodies)), None)
    if joint is None:
        raise refuse(copy, "its unit does not join the platform", "Use a unit that joins the platform")
    own = {name: body if body.of is None else replace(body, solids={}) for name, body in unit.bodies.items()}
    used = {name: mechanism.units[name] for name in ancestry(mechanism, units[copy])}
    others = {*mechanism.units, *units} - {copy, *used}
    links = {} if guide is None else {"guide": Link((GROUND, PLATFORM), "guide", joint.centre, guide)}
    return replace(
        mechanism,
        parts={**mechanism.parts, **{name: Joint((Freedom.X,)) for name in links}},
        bodies={PLATFORM: Body(reference=joint.centre)},
        links=links,
        units={**used, units[copy]: replace(used[units[copy]], bodies=own)},
        placements={copy: Placement(units[copy], Pose())},
        overrides=Table({address: value for address, value in mechanism.overrides.items() if address.partition("/")[0] not in others}),
        gauges={},
        stops={},
        payloads={},
        forces={},
        requirements={},
        paths={},
        temperatures={},
        envelope=None,
        opening=None,
    )
