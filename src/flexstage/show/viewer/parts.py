"""Description of drawn parts for the viewer: name, unit, address in the design file, and data as text."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from flexstage.mechanism.addresses.locate import link_path, unit_of_copy
from flexstage.mechanism.assembly.expand import Assembly, PlacedLink, PlacedSuperelement
from flexstage.mechanism.assembly.pattern import copy_names
from flexstage.mechanism.grammar.grammar import node_of
from flexstage.mechanism.mechanism import Mechanism
from flexstage.mechanism.store.lines import line_of
from flexstage.parts.part import inner
from flexstage.show.display import field_unit, format_value, to_typography
from flexstage.show.scene.primitives import first_value
from flexstage.show.scene.skin import Kind
from flexstage.show.tables.description import kind_name

_FOOT = " foot"
Fact = tuple[str, str]


@dataclass(frozen=True)
class DrawnEntry:
    """A drawn part, body, gauge or ground: `what` is its kind, `unit` is the instance to which the entry belongs.

    `address` and `line` locate the entry in the design file. `facts` are pairs of a name and a value with its unit of measurement.
    """

    name: str
    kind: Kind
    what: str
    address: str
    unit: str
    line: int | None
    bodies: tuple[int, int]
    facts: tuple[Fact, ...]


class Describer:
    """Builder of the descriptions of drawn entries by name."""

    def __init__(self, mechanism: Mechanism, assembly: Assembly, lines: Mapping[str, int]) -> None:
        self._mechanism = mechanism
        self._assembly = assembly
        self._lines = lines
        self._copies = unit_of_copy(mechanism)
        self._gauges = {name: key for key in mechanism.gauges for name in copy_names(key)}
        self._owners = {address: body for body, item in assembly.bodies.items() for address in item.solids}
        self._links = {**assembly.links, **assembly.superelements}

    def thing(self, name: str, kind: Kind, first: int, second: int) -> DrawnEntry:
        """Describe the drawn entry named `name`. `first` and `second` are the numbers of the bodies that the entry connects."""
        what, address, facts = self._description(name)
        unit = name.rpartition("/")[0]
        line = line_of(address, self._lines) if address else None
        return DrawnEntry(name, kind, what, address, unit if unit in self._copies else "", line, (first, second), facts)

    def _description(self, name: str) -> tuple[str, str, tuple[Fact, ...]]:
        """Its kind, address and facts."""
        if (link := self._links.get(name) or self._links.get(name.removesuffix(_FOOT))) is not None:
            return "ground" if name.endswith(_FOOT) else kind_name(link.part), link_address(self._mechanism, link), self._link_facts(link)
        if (gauge := self._assembly.gauges.get(name)) is not None:
            return gauge.gauge.kind, f"gauges.{self._gauges.get(name, name)}", tuple(part_facts(gauge.gauge))
        if name in self._assembly.bodies:
            return "body", body_address(self._copies, name), self._body_facts(name)
        placed = self._owners.get(name)
        solids = self._assembly.ground if placed is None else self._assembly.bodies[placed].solids
        solid = solids[name].solid
        drawn, _, own = name.rpartition(".")
        facts = (*part_facts(solid), *(() if placed is None else (("body", placed), *self._body_facts(placed))))
        return type(getattr(solid, "solid", solid)).__name__.lower(), f"{body_address(self._copies, drawn)}.solids.{own}", facts

    def _link_facts(self, link: PlacedLink | PlacedSuperelement) -> tuple[Fact, ...]:
        return (("part", link.link.part), ("joins", " – ".join(link.joins)), *part_facts(inner(link.part)))

    def _body_facts(self, name: str) -> tuple[Fact, ...]:
        mass = self._assembly.bodies[name].mass
        return () if mass is None else (("mass", format_value(first_value(mass.mass), "kg")),)


def link_address(mechanism: Mechanism, link: PlacedLink | PlacedSuperelement) -> str:
    """Return the address at which the description defines a link, such as `units.vertical.links.pivot`."""
    described = link.described if isinstance(link, PlacedLink) else link
    return ".".join(link_path(mechanism, described.drawn.removeprefix("links.")))


def body_address(copies: Mapping[str, str], name: str) -> str:
    """Return the address at which the description defines a body, such as `units.vertical.bodies.lever`; `copies` names units by copy."""
    copy, _, own = name.rpartition("/")
    return f"units.{copies[copy]}.bodies.{own}" if copy in copies else f"bodies.{name}"


def part_facts(record: object) -> Iterator[Fact]:
    """Yield the scalar numbers of a part or another record, each with the name of its key. Positions and matrices are left out."""
    for address, value, node in node_of(type(record)).numbers(record):
        if "." not in address or address.startswith("profile."):
            text = field_unit(node.quantity).format(first_value(value))
            yield address.replace("_", " ").replace(".", " "), to_typography(text)
