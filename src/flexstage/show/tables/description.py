"""Tables of a description: the parts of the stage, and every value with its unit and source."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from itertools import groupby
from typing import TypeAlias

from flexstage.base.number import Number
from flexstage.base.units.quantity import Quantity
from flexstage.mechanism.addresses.address import get, provenance, quantity_of
from flexstage.mechanism.assembly.expand import copy_names, expand
from flexstage.mechanism.grammar.grammar import node_of
from flexstage.mechanism.mechanism import Mechanism
from flexstage.parts.part import Part, Restricted
from flexstage.show.display import field_unit, number
from flexstage.show.scene.primitives import first_value
from flexstage.show.table import Cell, Column, Mark, Table, further, make_table, text_table
from flexstage.spatial.frame import COMPONENTS

TITLES = {
    "numbers": "Named numbers",
    "materials": "Materials",
    "parts": "Parts",
    "bodies": "Bodies",
    "links": "Links",
    "units": "Units",
    "placements": "Placement of units",
    "sensors": "Gauge types",
    "gauges": "Placement of gauges",
    "payloads": "Payloads",
    "forces": "Forces",
    "stops": "Stops",
    "temperatures": "Temperatures",
    "overrides": "Overrides of single instances",
    "": "Stage",
}
TAG_MARKS = {"stated": Mark.STATED, "derived": Mark.DERIVED, "assumed": Mark.ASSUMED}
"""Marks of values by the first word of their tag."""
_NUMBER_DIGITS = 6


def composition_table(mechanism: Mechanism) -> Table | None:
    """Tabulate the numbers and kinds of bodies, links, actuators and gauges of a stage.

    >>> composition_table(Mechanism("")).texts()[1]
    ['bodies', '0', '']
    """
    assembly = expand(mechanism)
    links = (*assembly.links.values(), *assembly.superelements.values())
    kinds = Counter(kind_name(link.part) for link in links)
    gauges = Counter(getattr(place, "gauge", "sum") for key, place in mechanism.gauges.items() for _ in copy_names(key))
    units = Counter(placement.unit for key, placement in mechanism.placements.items() for _ in copy_names(key))
    rows = {
        "bodies": (str(len(assembly.bodies)), _counts_text(units)),
        "links": (str(len(links)), _counts_text(kinds)),
        "actuators": (str(len(assembly.actuators)), ", ".join(assembly.actuators)),
        "gauges": (str(len(assembly.gauges)), _counts_text(gauges)),
        **({"stops": (str(len(assembly.stops)), ", ".join(assembly.stops))} if assembly.stops else {}),
    }
    return text_table("Composition", ["", Column("number"), "which"], rows)


def _counts_text(counts: Mapping[str, int]) -> str:
    return ", ".join(f"{count} x {kind}" for kind, count in counts.items())


def kind_name(part: Part) -> str:
    """Return the name of the kind of a part.

    >>> from flexstage.parts.compliance_matrix import Joint
    >>> kind_name(Joint())
    'joint'
    """
    inner = part.part if isinstance(part, Restricted) else part
    return inner.kind if inner is part else f"restricted {inner.kind}"


def link_table(mechanism: Mechanism) -> Table | None:
    """Tabulate the links of the design file: connected bodies, part, number of instances; `None` without links.

    >>> link_table(Mechanism("")) is None
    True
    """
    assembly = expand(mechanism)
    links = [*assembly.links.values(), *assembly.superelements.values()]
    counts = Counter(link.drawn for link in links)
    first = {link.drawn: link for link in reversed(links)}
    rows = {
        drawn.removeprefix("links."): (" - ".join(first[drawn].link.bodies), first[drawn].link.part, str(count))
        for drawn, count in counts.items()
    }
    return text_table("Links in the design file", ["link", "joins", "part", Column("instances")], rows)


_Numbers: TypeAlias = Mapping[str, tuple[Number, Quantity]]
"""Numbers of a description by address; overrides at the address of the override."""


def value_tables(mechanism: Mechanism, most: int | None = None) -> tuple[Table, ...]:
    """Tabulate all numbers of the description with unit, tag (stated, derived, assumed) and source, one table for each kind of entry.

    With `most`, tables are limited to that number of rows, and a note contains the number of further rows.

    >>> value_tables(Mechanism(""))[0].texts()[1]
    ['gravity', '(0, 0, -9.80665)', 'm/s^2', 'assumed', '']
    """
    tags = provenance(mechanism)
    known = {address: (value, node.measures) for address, value, node in node_of(Mechanism).numbers(mechanism)}
    groups: dict[str, list[tuple[str, tuple[str, ...]]]] = {}
    for addresses in (tuple(components) for _, components in groupby(tags, _owner)):
        group, name = _group_of(mechanism, addresses)
        groups.setdefault(group, []).append((name, addresses))
    heads = ["value", Column("", numeric=True), "unit", "tag", "source"]
    return tuple(
        make_table(
            title,
            heads,
            [_row(mechanism, name, addresses, tags[addresses[0]], known) for name, addresses in groups[group][:most]],
            notes=[] if most is None or len(groups[group]) <= most else [further(len(groups[group]) - most)],
        )
        for group, title in TITLES.items()
        if group in groups
    )


def provenance_table(mechanism: Mechanism) -> Table:
    """Tabulate how many values of the description are stated, derived and assumed.

    >>> provenance_table(Mechanism("")).texts()
    [['tag', 'numbers'], ['assumed', '3']]
    """
    counts = Counter(tag.split()[0] if tag.split() else "assumed" for tag in provenance(mechanism).values())
    order = [*TAG_MARKS, *sorted(set(counts) - set(TAG_MARKS))]
    rows = [(Cell(tag, TAG_MARKS.get(tag, Mark.PLAIN)), str(counts[tag])) for tag in order if counts[tag]]
    return make_table("Provenance of the numbers", ["tag", Column("numbers")], rows)


def source_table(mechanism: Mechanism) -> Table | None:
    """Tabulate the sources to which tags refer, and those of materials, parts and gauges; `None` without sources.

    >>> source_table(Mechanism("")) is None
    True
    """
    holders = {**mechanism.materials, **mechanism.parts, **mechanism.sensors}
    own = {name: source for name, value in holders.items() if (source := str(getattr(value, "source", "")))}
    return text_table("Sources", ["", "source"], {**mechanism.sources, **own})


def _owner(address: str) -> str:
    """The address of the vector to which a component belongs; other addresses as they are."""
    owner, _, last = address.rpartition(".")
    return owner if owner and last in COMPONENTS else address


def _group_of(mechanism: Mechanism, addresses: tuple[str, ...]) -> tuple[str, str]:
    """The kind of entry of an address, and the name within it."""
    address, *others = addresses
    address = _owner(address) if others else address
    first, _, rest = address.partition(".")
    if "/" in first or address in mechanism.overrides or first not in TITLES or not rest:
        return ("overrides" if "/" in first or address in mechanism.overrides else "", address)
    return first, rest


def _row(mechanism: Mechanism, name: str, addresses: tuple[str, ...], tag: str, known: _Numbers) -> tuple[Cell, ...]:
    values = [_value(*(known.get(address) or (get(mechanism, address), quantity_of(mechanism, address)))) for address in addresses]
    word, _, source = tag.partition(" ")
    unit = values[0][1]
    text = values[0][0] if len(values) == 1 else f"({', '.join(text for text, _ in values)})"
    formulas = ", ".join(f"= {mechanism.formulas[address]}" for address in addresses if address in mechanism.formulas)
    origin = f"{formulas}; {source}" if formulas and source else formulas or source
    return Cell(name, Mark.STRONG), Cell(text), Cell("" if unit == "1" else unit), Cell(word, TAG_MARKS.get(word, Mark.PLAIN)), Cell(origin)


def _value(value: Number, quantity: Quantity) -> tuple[str, str]:
    form = field_unit(quantity)
    return number(first_value(value) * form.factor, _NUMBER_DIGITS), form.unit
