"""Compliance matrices that replace drawn parts in a design file's text: those are kept under another name, comments stay."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from flexstage.base.finding import Finding, refuse, require
from flexstage.base.lazy import Late
from flexstage.mechanism.checks import require_valid
from flexstage.mechanism.grammar.grammar import TAGS, node_of
from flexstage.mechanism.mechanism import Mechanism
from flexstage.mechanism.store.decode import read_design
from flexstage.mechanism.store.encode import plain
from flexstage.parts.compliance_matrix import ComplianceMatrix

if TYPE_CHECKING:
    import tomlkit
    import tomlkit.exceptions
else:
    tomlkit = Late("tomlkit")  # reading a file needs none of it

KEPT = "-drawn"


@dataclass(frozen=True, eq=False)
class StandIn:
    """A `compliance_matrix` part that stands for the drawn one its `replaces` names, at the `links` (drawn addresses) that are listed."""

    given: ComplianceMatrix
    links: tuple[str, ...]

    @property
    def drawn_name(self) -> str:
        """The name that the drawn part had.

        >>> StandIn(ComplianceMatrix(((0.0,) * 6,) * 6, (), replaces="neck-drawn"), ()).drawn_name
        'neck'
        """
        return self.given.replaces.removesuffix(KEPT)


def write_stand_ins(text: str, parts: Mapping[str, StandIn], tag: str, *, where: str = "text") -> str:
    """The text of a design file with compliance matrices, by name, in the places of drawn ones, which are kept as `<name>-drawn`.

    The new matrices carry `tag`. Raises `DesignError` where links depart from such a part, and where the file's layout does not allow it.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.mechanism.store import dumps, loads
    >>> unit = tuple(tuple(1e-7 * (row == column) for column in range(6)) for row in range(6))
    >>> leaf = StandIn(ComplianceMatrix(unit, free=(), replaces="leaf-drawn"), ("links.left", "links.right"))
    >>> text = write_stand_ins(dumps(parallelogram()), {"leaf": leaf}, "derived test")
    >>> loads(text).parts["leaf"].replaces, "leaf-drawn" in loads(text).parts
    ('leaf-drawn', True)
    """
    before = read_design(text, where)
    require(_clashes(before, parts))
    try:
        document = tomlkit.parse(text)
        for name in dict.fromkeys(part.drawn_name for part in parts.values()):
            document["parts"][name + KEPT] = document["parts"].pop(name)  # pyright: ignore[reportIndexIssue, reportAttributeAccessIssue]
            _rename_tags(document, f"parts.{name}.", f"parts.{name}{KEPT}.")
        for name, part in parts.items():
            _stand_in(document, name, part, tag)
        after = tomlkit.dumps(document)
    except (tomlkit.exceptions.TOMLKitError, KeyError) as error:
        raise refuse(where, f"the file cannot be changed: {error}", "Write it anew with dump") from None
    found = require_valid(read_design(after, where))
    if any(found.parts.get(name) != part.given for name, part in parts.items()):
        raise refuse(where, "its tables are laid out so that parts cannot be exchanged", "Write it anew with dump")
    return after


def _clashes(mechanism: Mechanism, parts: Mapping[str, StandIn]) -> list[Finding]:
    drawn = {part.drawn_name for part in parts.values()}
    taken = {name + KEPT: name for name in drawn} | {name: part.drawn_name for name, part in parts.items() if name != part.drawn_name}
    found = [
        Finding(f"parts.{name}", "there is a part of this name", f"Rename it: the name is needed for the {old} that is calibrated")
        for name, old in taken.items()
        if name in mechanism.parts
    ]
    links = [(f"{unit}/{name}", link.part) for unit, drawn in mechanism.units.items() for name, link in drawn.links.items()]
    links += [(name, link.part) for name, link in mechanism.links.items()]
    touched = {address: part for address, part in links if part in drawn}
    for key in mechanism.overrides:
        ends = [address for address in touched if f"/{key}".partition(".")[0].endswith(f"/{address.rpartition('/')[2]}")]
        if ends:
            what = f"it departs from {touched[ends[0]]}, whose 6x6 is shared"
            found.append(Finding(f'overrides."{key}"', what, "Give that link a part of its own, or take the override out"))
    return found


def _stand_in(document: Any, name: str, part: StandIn, tag: str) -> None:
    node = node_of(Mechanism).fields["parts"].node.child(None, name)
    table = tomlkit.table()
    values = plain(node, part.given, f"parts.{name}")
    for key, value in values.items():
        table[key] = _lines(value) if key == "compliance" else value
    table[TAGS] = tomlkit.inline_table()
    table[TAGS].update({"compliance": tag})
    document["parts"][name] = table
    for address in part.links if name != part.drawn_name else ():
        unit, _, link = address.rpartition("/")
        owner = document["units"][unit] if unit else document
        owner["links"][link.removeprefix("links.")]["part"] = name


def _lines(rows: Any) -> Any:
    """A matrix with a line for each row."""
    array = tomlkit.array()
    for row in rows:
        array.append(row)
    return array.multiline(multiline=True)


def _rename_tags(document: Any, old: str, new: str) -> None:
    """Tags at the top of the file that were the drawn part's."""
    tags = document.get(TAGS, {})
    for key in [key for key in tags if str(key).startswith(old)]:
        tags[new + str(key).removeprefix(old)] = tags[key]
        del tags[key]
