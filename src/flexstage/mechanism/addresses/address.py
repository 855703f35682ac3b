"""Addresses of values: one scheme for files, `--set`, messages, studies and sensitivities.

- `parts.neck.thickness`: a shared part.
- `bodies.platform.mass`: a value in the tree of the description, name by name.
- `units.horizontal.links.front.at.x`, short `horizontal/front.at.x`: a link's placement in all instances of its unit.
- `horizontal/front.thickness`: the part of one link of a unit, in all instances. The value is an override, in `overrides`.
- `B2/front.thickness`: the same part in one instance; this override takes precedence over the override of all instances.
- `links.strut.thickness`: the part of a link of the stage; also an override.
- `numbers.arm`: a named number; results of formulas change with it.
- `B2.shift.x`, `S1.rotation.z`: misalignment of a unit instance or a gauge relative to its pattern; an override, default zero.

Levels may be omitted if the result is unique: `horizontal/front.radius` for `horizontal/front.profile.radius`, `neck.thickness` for
`parts.neck.thickness`. The error for an ambiguous or misspelt address lists the candidates.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from flexstage.base.finding import DesignError, refuse
from flexstage.base.number import Number, Table, freeze
from flexstage.base.units.expression import parse_expression
from flexstage.base.units.quantity import Quantity
from flexstage.mechanism.addresses.locate import Place, canonical, link_path, locate
from flexstage.mechanism.addresses.path import follow, replace_member, replace_members, with_mirror
from flexstage.mechanism.assembly.expand import apply_overrides
from flexstage.mechanism.assembly.misalignment import misalignment_of
from flexstage.mechanism.grammar.formulas import NUMBERS, amount_of, dependents, formula_value, is_formula, scope_of, shown_unit
from flexstage.mechanism.grammar.grammar import node_of
from flexstage.mechanism.grammar.node import NumberNode
from flexstage.mechanism.mechanism import Link, Mechanism, NamedNumber
from flexstage.parts.part import Part

ASSUMED = "assumed"
_MOST_NAMES = 8


def get(mechanism: Mechanism, address: str) -> Any:
    """Return the value at an address, including overrides.

    >>> from flexstage.parts.rod import Rod
    >>> get(Mechanism("", parts={"wire": Rod("steel", 0.03, 0.001)}), "parts.wire.length")
    0.03
    """
    return value_at(mechanism, locate(mechanism, address))


def value_at(mechanism: Mechanism, place: Place) -> Any:
    """Return the value at a resolved address, including overrides."""
    return follow(_holder(mechanism, place), place.path)


def _holder(mechanism: Mechanism, place: Place) -> Any:
    """Root of the path of an address, with overrides."""
    if place.misaligned:
        return misalignment_of(mechanism.overrides, place.owners[0])
    if not place.owners:
        return mechanism
    link, part = _link_and_part(mechanism, place)
    return link if place.in_link else part


def set_value(mechanism: Mechanism, address: str, value: Any) -> Mechanism:
    """Return the mechanism with a new value (SI number, array, or name) at an address; the tag of the old value is removed.

    An override is written to `overrides`. An entry of a 6x6 matrix is set together with its symmetric entry. If a named number changes,
    formulas that use it are recomputed. The formula of a replaced value is removed.

    >>> from flexstage.parts.rod import Rod
    >>> stage = Mechanism("", parts={"wire": Rod("steel", 0.03, 0.001)})
    >>> get(set_value(stage, "wire.length", 0.04), "wire.length")
    0.04
    """
    return set_values(mechanism, [(address, value)])


def set_values(mechanism: Mechanism, values: Iterable[tuple[str, Any]]) -> Mechanism:
    """Return the mechanism with new values at several addresses, set in their order; formulas are recomputed once (see `set_value`)."""
    changed, lost, numbers = mechanism, list[str](), list[str]()
    for address, value in values:
        place = locate(changed, address)
        lost.append(place.address)
        for path in with_mirror(place.path):
            written = replace(place, path=path)
            try:
                changed = _without_formulas(_write(changed, written, freeze(value)), written.address)
            except DesignError as error:
                raise DesignError(replace(finding, where=address) for finding in error.findings) from None
        if place.number:
            numbers.append(place.number)
    if numbers:
        moved = dependents(changed, *numbers)
        changed = _recompute(changed, moved)
        lost += moved
    tags = {key: tag for key, tag in mechanism.tags.items() if canonical(mechanism, key) not in lost}
    return changed if len(tags) == len(mechanism.tags) else replace(changed, tags=Table(tags))


def set_text(mechanism: Mechanism, address: str, text: str) -> Mechanism:
    """Return the mechanism with the value at an address set from a string: a value, a relative change (`+10%`), or a formula.

    A percentage with a sign is a relative change of any number. A percentage without a sign is the value of a ratio.

    >>> from flexstage.parts.rod import Rod
    >>> stage = Mechanism("", parts={"wire": Rod("steel", 0.03, 0.001)}, numbers={"arm": NamedNumber(0.026, "mm")})
    >>> stage = set_text(set_text(stage, "wire.length", "2*arm"), "numbers.arm", "+100 %")
    >>> stage.parts["wire"].length, stage.formulas["parts.wire.length"]
    (0.104, '2*arm')
    """
    place, where = locate(mechanism, address), address.strip()
    if not place.node.single:
        raise _several(mechanism, place, where)
    if isinstance(place.node, NumberNode) and (share := _SHARE.fullmatch(text.strip())) is not None:
        return set_value(mechanism, where, _share_of(mechanism, where, 1.0 + float(share[1]) / 100.0))
    try:
        return set_value(mechanism, where, place.node.parse(text.strip(), where))
    except DesignError:
        if not isinstance(place.node, NumberNode) or not is_formula(text, scope_of(mechanism)):
            raise
    return _set_formula(mechanism, place, where, text.strip())


_SHARE = re.compile(r"([+-]\d+\.?\d*|[+-]\.\d+)\s*%")


def _share_of(mechanism: Mechanism, where: str, factor: float) -> Number:
    """A number scaled by a factor."""
    value = get(mechanism, where)
    if value is None:
        raise refuse(where, "not specified, so a percentage has no reference value", "Use a value with its unit")
    if np.all(np.equal(value, 0.0)):
        raise refuse(where, "the value is 0, and a percentage does not change it", "Use a value with its unit")
    return value * factor  # type: ignore[no-any-return]


def _set_formula(mechanism: Mechanism, place: Place, where: str, text: str) -> Mechanism:
    value = formula_value(text, quantity_of(mechanism, where), scope_of(mechanism), where)
    circle = {
        number for number in parse_expression(text).names if f"{NUMBERS}.{number}" in (place.address, *dependents(mechanism, place.number))
    }
    if place.number and circle:
        what = f'circular formula: "{text}" depends on {", ".join(sorted(circle))}, and therefore on {place.number}'
        raise refuse(where, what, "Use a number, or a formula that does not depend on the number itself")
    changed = set_value(mechanism, where, value)
    if place.number:
        own_unit = NamedNumber(value, shown_unit(amount_of(mechanism.numbers[place.number])))
        changed = replace(changed, numbers=Table({**changed.numbers, place.number: own_unit}))
    own = {replace(place, path=path).address: text for path in with_mirror(place.path)}
    return replace(changed, formulas=Table({**changed.formulas, **own}))


def _without_formulas(mechanism: Mechanism, address: str) -> Mechanism:
    """The mechanism without the formulas of a value and of its members."""
    kept = {key: text for key, text in mechanism.formulas.items() if key != address and not key.startswith(f"{address}.")}
    return mechanism if len(kept) == len(mechanism.formulas) else replace(mechanism, formulas=Table(kept))


def _recompute(mechanism: Mechanism, addresses: Iterable[str]) -> Mechanism:
    """The mechanism with the values of formulas, in order of dependence."""
    scope, changes = scope_of(mechanism), list[tuple[tuple[str, ...], Any]]()
    for address in addresses:
        place = locate(mechanism, address)
        value = formula_value(mechanism.formulas[address], quantity_at(place, address), scope, address)
        if place.number:
            scope[place.number] = amount_of(replace(mechanism.numbers[place.number], value=value))
        if place.owners:
            mechanism = _write(mechanism, place, value)
        else:
            changes.append((place.path, value))
    return replace_members(mechanism, changes) if changes else mechanism  # type: ignore[no-any-return]


def assign(mechanism: Mechanism, assignment: str) -> Mechanism:
    """Return the mechanism after an assignment such as `horizontal/front.thickness=1.4 mm`.

    >>> from flexstage.parts.rod import Rod
    >>> stage = Mechanism("", parts={"wire": Rod("steel", 0.03, 0.001)})
    >>> get(assign(stage, "wire.length = 40mm"), "wire.length")
    0.04
    """
    address, equals, text = assignment.partition("=")
    if not equals:
        raise refuse(f'"{assignment}"', "an assignment needs an equals sign", 'Use e.g. "parts.neck.thickness=1.4 mm"')
    return set_text(mechanism, address, text)


def _several(mechanism: Mechanism, place: Place, where: str) -> DesignError:
    """Error for an assignment to an object with several values."""
    inner = [name for name, _, _ in place.node.numbers(get(mechanism, where))]
    if not inner:
        return refuse(where, "it has no number that can be set", "Set it in the design file")
    shown = ", ".join(inner[:_MOST_NAMES]) + (" and more" if len(inner) > _MOST_NAMES else "")
    return refuse(where, f"it has several values: {shown}", f'Set one of them, e.g. "{where}.{inner[0]}=..."')


def addresses(mechanism: Mechanism) -> tuple[str, ...]:
    """Return the address of every number of a description: shared parts, bodies, placements, and existing overrides.

    Directions and absent values are omitted.

    >>> from flexstage.parts.rod import Rod
    >>> addresses(Mechanism("", parts={"wire": Rod("steel", 0.03, 0.001)}))[:2]
    ('parts.wire.length', 'parts.wire.diameter')
    """
    results = [address for address, _, _ in node_of(Mechanism).numbers(mechanism)]
    for key, value in mechanism.overrides.items():
        place = locate(mechanism, key)
        results += [address for address, _, _ in place.node.numbers(value, place.address)]
    return tuple(dict.fromkeys(results))


def quantity_of(mechanism: Mechanism, address: str) -> Quantity:
    """Return the quantity of the number, vector or direction at an address.

    >>> from flexstage.parts.rod import Rod
    >>> quantity_of(Mechanism("", parts={"wire": Rod("steel", 0.03, 0.001)}), "wire.length").shown
    'mm'
    """
    return quantity_at(locate(mechanism, address), address)


def quantity_at(place: Place, address: str) -> Quantity:
    """Return the quantity of the number at a resolved address; raises `DesignError` if the value is not a number."""
    quantity = place.node.measures
    if quantity is None:
        raise refuse(address, "not a number", "Use the address of one of its numbers")
    return quantity


def tag_of(mechanism: Mechanism, address: str) -> str:
    """Return the tag (`stated paper 2.2`) of the value at an address; a value inherits the tag of its vector or shared part.

    Untagged values are `assumed`.

    >>> from flexstage.parts.rod import Rod
    >>> stage = Mechanism("", parts={"wire": Rod("steel", 0.03, 0.001)}, tags={"parts.wire.length": "stated paper 2.2"})
    >>> tag_of(stage, "wire.length"), tag_of(stage, "wire.diameter")
    ('stated paper 2.2', 'assumed')
    """
    return _tag(_canonical_tags(mechanism), _origin(mechanism, locate(mechanism, address)))


def provenance(mechanism: Mechanism) -> Mapping[str, str]:
    """Return the tag of every number by its address (see `addresses` and `tag_of`).

    >>> from flexstage.parts.rod import Rod
    >>> provenance(Mechanism("", parts={"wire": Rod("steel", 0.03, 0.001)}))["parts.wire.length"]
    'assumed'
    """
    tags = _canonical_tags(mechanism)
    return Table({address: _tag(tags, address) for address in addresses(mechanism)})


def _link_and_part(mechanism: Mechanism, place: Place) -> tuple[Link, Part]:
    link = follow(mechanism, link_path(mechanism, place.owners[0]))
    try:
        return apply_overrides(mechanism, link, place.owners)
    except KeyError as error:
        raise refuse(f"override of {place.owners[-1]}", f"unknown name {error}", "Check the description") from None


def _write(mechanism: Mechanism, place: Place, value: Any) -> Mechanism:
    if not place.owners:
        return replace_member(mechanism, place.path, value)  # type: ignore[no-any-return]
    value = follow(replace_member(_holder(mechanism, place), place.path, value), place.path)
    overrides = dict(mechanism.overrides)
    for key, path in _overrides(mechanism, place.owners[-1]):
        depth = len(path)
        if place.path[:depth] == path:
            overrides[key] = replace_member(overrides[key], place.path[depth:], value)
            return replace(mechanism, overrides=Table(overrides))
        if path[: len(place.path)] == place.path:
            del overrides[key]
    return replace(mechanism, overrides=Table(overrides | {place.address: value}))


def _overrides(mechanism: Mechanism, owner: str) -> Iterator[tuple[str, tuple[str, ...]]]:
    """Overrides of an owner: key and full path."""
    for key in mechanism.overrides:
        if not f"links.{key}".startswith((f"{owner}.", f"links.{owner}.")):
            continue  # avoids locating each: a batch has a hundred overrides
        place = locate(mechanism, key)
        if place.owners[-1:] == (owner,):
            yield key, place.path


def _canonical_tags(mechanism: Mechanism) -> dict[str, str]:
    return {canonical(mechanism, key): tag for key, tag in mechanism.tags.items()}


def _origin(mechanism: Mechanism, place: Place) -> str:
    """Address of the source of a value: its override, or the shared part or drawn link."""
    for owner in reversed(place.owners):
        for _, path in _overrides(mechanism, owner):
            if path == place.path[: len(path)] or path[: len(place.path)] == place.path:
                return replace(place, owners=(owner,)).address
    if not place.owners or place.misaligned:
        return place.address
    home = link_path(mechanism, place.owners[0])
    return ".".join((*(home if place.in_link else ("parts", follow(mechanism, home).part)), *place.path))


def _tag(tags: Mapping[str, str], address: str) -> str:
    steps = address.split(".")
    for depth in range(len(steps), 0, -1):
        if (tag := tags.get(".".join(steps[:depth]))) is not None:
            return tag
    return ASSUMED
