"""Resolution of addresses: grammar, completion of omitted levels, and errors with candidates."""

from __future__ import annotations

from dataclasses import dataclass, fields, is_dataclass, replace
from typing import Any

from flexstage.base.finding import DesignError, refuse, suggest_nearest
from flexstage.base.renamed import new_name
from flexstage.mechanism.addresses.path import completions, follow, has_member, member
from flexstage.mechanism.assembly.expand import copy_names, unit_of_copy
from flexstage.mechanism.assembly.likeness import ancestry, drawn_units, link_lineage
from flexstage.mechanism.assembly.misalignment import MISALIGNED, Misalignment
from flexstage.mechanism.grammar.formulas import NUMBERS
from flexstage.mechanism.grammar.grammar import NumbersNode, RecordNode, node_of
from flexstage.mechanism.grammar.node import Node
from flexstage.mechanism.mechanism import Link, Mechanism, NamedNumber, posed
from flexstage.spatial.frame import COMPONENTS

_DOCUMENT = ("tags", "sources", "requirements", "overrides", "formulas", "paths")
_TOPOLOGY = ("joins", "part")


@dataclass(frozen=True, eq=False)
class Place:
    """Resolved address of a value.

    Without `owners`, `path` is the full path from the root of the description. For an override, `owners` are the units and instances with
    overrides, in order of increasing precedence (`horizontal/front`, `B2/front`). With `owners`, the `path` begins at the link if `in_link`
    (for instance `at.x`), else at the link's part. For a misalignment (`shift.x`), `owners` contains the instance or gauge.
    """

    owners: tuple[str, ...]
    path: tuple[str, ...]
    node: Node
    in_link: bool = False

    @property
    def misaligned(self) -> bool:
        """Whether the value is a misalignment of an instance or a gauge."""
        return bool(self.owners) and not self.in_link and self.path[:1] in [(name,) for name in MISALIGNED]

    @property
    def address(self) -> str:
        """Full address of the value; the level `part` between a link's restricted part and the part inside it is omitted."""
        inside = bool(self.owners) and not self.in_link and self.path[:1] == ("part",)
        path = self.path[:2] if self.number else self.path
        return ".".join((*self.owners[-1:], *path[inside:]))

    @property
    def number(self) -> str:
        """Name of the named number; empty if the address is not of a named number."""
        return self.path[1] if not self.owners and self.path[:1] == (NUMBERS,) and len(self.path) > 1 else ""


def locate(mechanism: Mechanism, address: str) -> Place:
    """Resolve an address; raises `DesignError` with the candidates if it is unknown or ambiguous.

    >>> from flexstage.parts.rod import Rod
    >>> locate(Mechanism("", parts={"wire": Rod("steel", 0.03, 0.001)}), "wire.length").address
    'parts.wire.length'
    """
    steps = tuple(address.strip().split("."))
    owner, slash, link = steps[0].rpartition("/")
    if slash and not _is_whole(mechanism, steps[0]):
        return _in_unit(mechanism, address, owner.strip(), (link.strip(), *steps[1:]))
    if (first := new_name(steps[0], _DOCUMENT) or steps[0]) in _DOCUMENT:
        raise refuse(address, f'"{first}" contains no values of the stage', "Use the address of a value")
    if _stands(mechanism, address, steps):
        return _descend(Misalignment(), address, Place(steps[:1], (), RecordNode(Misalignment)), steps[1:])
    return _descend(mechanism, address, Place((), (), RecordNode(Mechanism)), steps)


def _is_whole(mechanism: Mechanism, name: str) -> bool:
    """Whether a name (`fine/B1`) is of a mounted stage, and so not a link of a unit or instance."""
    return name in (*unit_of_copy(mechanism), *(each for key in mechanism.gauges for each in copy_names(key))) or bool(
        completions(mechanism, name)
    )


def _stands(mechanism: Mechanism, address: str, steps: tuple[str, ...]) -> bool:
    """Whether the steps are a misalignment of an instance or a gauge."""
    if len(steps) < 2 or (steps[1] not in MISALIGNED and has_member(mechanism, steps[0])):
        return False
    owners = [*unit_of_copy(mechanism), *(name for key in posed(mechanism.gauges) for name in copy_names(key))]
    if steps[0] not in owners or (steps[1] not in MISALIGNED and completions(mechanism, steps[0])):
        return False
    if owners.count(steps[0]) > 1:
        raise refuse(address, f'"{steps[0]}" is both an instance of a unit and a gauge', "Rename one of them")
    return True


def link_path(mechanism: Mechanism, owner: str) -> tuple[str, ...]:
    """Return the path of a link in the description; `owner` is `unit/link`, or a link of the stage.

    >>> link_path(Mechanism(""), "strut")
    ('links', 'strut')
    """
    unit, _, link = owner.rpartition("/")
    return ("units", unit, "links", link) if unit in mechanism.units else ("links", owner)


def _in_unit(mechanism: Mechanism, address: str, owner: str, steps: tuple[str, ...]) -> Place:
    copies = unit_of_copy(mechanism)
    name = owner if owner in mechanism.units else copies.get(owner, "")
    if name not in mechanism.units:
        raise refuse(address, f'unknown unit or instance "{owner}"', suggest_nearest(owner, [*mechanism.units, *copies]))
    unit = drawn_units(mechanism)[name]
    if owner == name and steps[0] in unit.bodies:
        home = next(each for each in ancestry(mechanism, name) if steps[0] in mechanism.units[each].bodies)
        if home != name:
            advice = f"Use {home}/{steps[0]}, or draw the body in units.{name}.bodies"
            raise refuse(address, f'unit {name} inherits its body "{steps[0]}" from {home}', advice)
        return _descend(mechanism, address, Place((), (), RecordNode(Mechanism)), ("units", name, "bodies", *steps))
    if steps[0] not in unit.links:
        raise refuse(address, f'unit {name} has no link "{steps[0]}"', suggest_nearest(steps[0], unit.links))
    lineage = link_lineage(mechanism, name, steps[0])
    owners = (*lineage, owner) if owner != name else lineage
    tree = ("units", lineage[0], "links", steps[0])
    return _in_link(mechanism, address, tree, tuple(f"{each}/{steps[0]}" for each in owners), steps[1:])


def _in_link(mechanism: Mechanism, address: str, tree: tuple[str, ...], owners: tuple[str, ...], steps: tuple[str, ...]) -> Place:
    """Target in the link at path `tree`: a field, or an override of its part."""
    link = follow(mechanism, tree)
    if not steps or steps[0] in _TOPOLOGY:
        raise refuse(
            address, "the bodies and the part of a link cannot be overridden", "Use the address of a value of the link or of its part"
        )
    if has_member(link, steps[0]):
        departed = len(owners) > 1 or any(key.startswith(f"{drawn}.{steps[0]}") for drawn in owners for key in mechanism.overrides)
        start = Place(owners, (), RecordNode(Link), in_link=True) if departed else Place((), tree, RecordNode(Link))
        return _descend(link, address, start, steps)
    if link.part not in mechanism.parts:
        raise refuse(address, f'unknown part "{link.part}"', suggest_nearest(link.part, mechanism.parts))
    parts = node_of(Mechanism).fields["parts"].node
    start = Place(owners, (), parts.child(mechanism.parts, link.part))
    return _descend(mechanism.parts[link.part], address, start, steps)


def _descend(value: Any, address: str, start: Place, steps: tuple[str, ...]) -> Place:
    """Follow the steps from the value at `start`."""
    mechanism, path, node = value, start.path, start.node
    for number, step in enumerate(steps):
        if isinstance(value, Link) and not has_member(value, step):
            return _in_link(mechanism, address, path, _owners(path), steps[number:])
        if isinstance(value, NamedNumber):
            raise refuse(address, f'unknown name "{step}": {steps[number - 1]} is a number', "Use the address of the number")
        for name in _complete(value, address, node, step, last=number == len(steps) - 1):
            node, value = node.child(value, name), member(value, name)
            path += (name,)
    if isinstance(value, NamedNumber):
        return replace(start, path=(*path, "value"), node=node.child(value, "value"))
    return replace(start, path=path, node=node)


def _owners(tree: tuple[str, ...]) -> tuple[str, ...]:
    """Owners of overrides for a link drawn at a path (a link of the stage may be abbreviated)."""
    return (tree[1], f"links.{tree[1]}") if tree[0] == "links" else (f"{tree[1]}/{tree[3]}",)


def _complete(value: Any, address: str, node: Node, step: str, *, last: bool) -> tuple[str, ...]:
    """Candidate names of a step; a named number is valid only as the last step."""
    if isinstance(value, tuple):
        return (_component(value, address, node, step),)
    step = node.field_called(value, step)
    results = [path for path in completions(value, step) if path[0] not in _DOCUMENT and (last or path[:-1] != (NUMBERS,))]
    if len(results) == 1:
        return results[0]
    if results:
        raise refuse(address, f'ambiguous name "{step}" (got {" or ".join(".".join(path) for path in results)})', "Use the full address")
    if value is None:
        raise refuse(address, f'unknown name "{step}": its parent is not specified', "Specify the parent first")
    raise refuse(address, f'unknown name "{step}"', suggest_nearest(step, _names(value)))


def _component(value: Any, address: str, node: Node, step: str) -> str:
    if isinstance(node, NumbersNode):
        if step.isdecimal() and has_member(value, step):
            return step
        raise refuse(address, f'unknown index "{step}"', f"Use 0 to {len(value) - 1}")
    if not node.components or not has_member(value, step):
        raise refuse(address, f'unknown component "{step}"', suggest_nearest(step, COMPONENTS[: len(value)]))
    return COMPONENTS[int(step)] if step in "012345" else step


def _names(value: Any) -> list[str]:
    if not is_dataclass(value):
        return list(value) if hasattr(value, "keys") else []
    own = [field.name for field in fields(value) if field.name not in _DOCUMENT]
    nested = [getattr(value, name) for name in own]
    return own + [name for inner in nested if is_dataclass(inner) or hasattr(inner, "keys") for name in _names(inner)]


def canonical(mechanism: Mechanism, address: str) -> str:
    """Return the full address; an unknown address is returned unchanged.

    >>> canonical(Mechanism(""), "nowhere")
    'nowhere'
    """
    try:
        return locate(mechanism, address).address
    except DesignError:
        return address
