"""Replacement of drawn parts by compliance matrices in a design file's text. Drawn parts are renamed; comments are preserved."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from flexstage.base.finding import Finding, refuse, require
from flexstage.base.lazy import LazyModule
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
    tomlkit = LazyModule("tomlkit")  # not required for reading a file

KEPT = "-drawn"


@dataclass(frozen=True, eq=False)
class ReplacementPart:
    """Compliance matrix `given` that replaces the drawn part `given.replaces` in `links`, which contains the addresses of these links."""

    given: ComplianceMatrix
    links: tuple[str, ...]

    @property
    def drawn_name(self) -> str:
        """Original name of the drawn part, without the suffix `-drawn`.

        >>> ReplacementPart(ComplianceMatrix(((0.0,) * 6,) * 6, (), replaces="neck-drawn"), ()).drawn_name
        'neck'
        """
        return self.given.replaces.removesuffix(KEPT)


def write_stand_ins(text: str, parts: Mapping[str, ReplacementPart], tag: str, *, where: str = "text") -> str:
    """Return the text of a design file in which compliance matrices replace drawn parts of the same names.

    The drawn parts are renamed `<name>-drawn`. The new matrices get the tag `tag`. Raises `DesignError` if links override a replaced part,
    or if the file's layout does not allow the change.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.mechanism.store import dumps, loads
    >>> unit = tuple(tuple(1e-7 * (row == column) for column in range(6)) for row in range(6))
    >>> leaf = ReplacementPart(ComplianceMatrix(unit, free=(), replaces="leaf-drawn"), ("links.left", "links.right"))
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
        raise refuse(where, f"the file cannot be changed: {error}", "Rewrite the file with dump") from None
    result = require_valid(read_design(after, where))
    if any(result.parts.get(name) != part.given for name, part in parts.items()):
        raise refuse(where, "its table layout does not allow an exchange of parts", "Rewrite the file with dump")
    return after


def _clashes(mechanism: Mechanism, parts: Mapping[str, ReplacementPart]) -> list[Finding]:
    drawn = {part.drawn_name for part in parts.values()}
    taken = {name + KEPT: name for name in drawn} | {name: part.drawn_name for name, part in parts.items() if name != part.drawn_name}
    results = [
        Finding(f"parts.{name}", "the part name is in use", f"Rename this part: its present name is required for the calibrated {old}")
        for name, old in taken.items()
        if name in mechanism.parts
    ]
    links = [(f"{unit}/{name}", link.part) for unit, drawn in mechanism.units.items() for name, link in drawn.links.items()]
    links += [(name, link.part) for name, link in mechanism.links.items()]
    touched = {address: part for address, part in links if part in drawn}
    for key in mechanism.overrides:
        ends = [address for address in touched if f"/{key}".partition(".")[0].endswith(f"/{address.rpartition('/')[2]}")]
        if ends:
            what = f"changes one link of part {touched[ends[0]]}, but the calibrated compliance matrix applies to all links of the part"
            results.append(Finding(f'overrides."{key}"', what, "Use a separate part for that link, or remove the override"))
    return results


def _stand_in(document: Any, name: str, part: ReplacementPart, tag: str) -> None:
    node = node_of(Mechanism).fields["parts"].node.child(None, name)
    table = tomlkit.table()
    values = plain(node, part.given, f"parts.{name}")
    for key, value in values.items():
        table[key] = tomlkit.item(value).multiline(multiline=True) if key == "compliance" else value  # one line per row
    table[TAGS] = tomlkit.inline_table()
    table[TAGS].update({"compliance": tag})
    document["parts"][name] = table
    for address in part.links if name != part.drawn_name else ():
        unit, _, link = address.rpartition("/")
        owner = document["units"][unit] if unit else document
        owner["links"][link.removeprefix("links.")]["part"] = name


def _rename_tags(document: Any, old: str, new: str) -> None:
    """Tags of the drawn part at the top of the file."""
    tags = document.get(TAGS, {})
    for key in [key for key in tags if str(key).startswith(old)]:
        tags[new + str(key).removeprefix(old)] = tags[key]
        del tags[key]
