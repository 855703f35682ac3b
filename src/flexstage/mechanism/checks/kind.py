"""Checks of the kinds of values, and of the packages that provide kinds."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Iterator
from importlib.metadata import PackageNotFoundError, version
from typing import Any

from flexstage.base.finding import Finding
from flexstage.mechanism.grammar.grammar import RecordNode, UnionNode, node_of
from flexstage.mechanism.grammar.node import Node, join
from flexstage.mechanism.mechanism import Mechanism


def kind_findings(mechanism: Mechanism) -> Iterator[Finding]:
    """Return errors for values of unregistered classes, which files cannot contain.

    >>> from flexstage.parts.rod import Rod
    >>> class Wire(Rod): ...
    >>> print(*kind_findings(Mechanism("", parts={"wire": Wire("steel", length=0.03, diameter=0.001)})))
    parts.wire: must be ... Rod ... (got Wire(...). Use ...
    """
    return _unlisted(node_of(Mechanism), mechanism, "")


def _unlisted(node: Node, value: Any, where: str) -> Iterator[Finding]:
    if isinstance(node, RecordNode | UnionNode) and type(value) not in node.records:
        names = " or ".join(record.__name__ for record in node.records)
        yield Finding(where, f"must be {names} (got {textwrap.shorten(repr(value), 60)})", f"Use {names}")
        return
    for name, inner, item in node.members(value):
        yield from () if item is None else _unlisted(inner, item, join(where, name))


def package_findings(packages: Iterable[str]) -> Iterator[Finding]:
    """Return errors for required packages that are missing or have a wrong version.

    >>> print(*package_findings(["numpy >= 1", "tapered-leaf >= 1"]))
    packages: "tapered-leaf >= 1" is not installed. Install it in the environment of flexstage: pip install "tapered-leaf >= 1".
    """
    for text in packages:
        from packaging.requirements import InvalidRequirement, Requirement  # takes 0.1 s, and few designs have any

        try:
            target = Requirement(text)
        except InvalidRequirement:
            yield Finding("packages", f'invalid package (got "{text}")', 'Use its name, with optional versions, e.g. "tapered-leaf >= 1"')
            continue
        install = f'Install it in the environment of flexstage: pip install "{text}"'
        try:
            there = version(target.name)
        except PackageNotFoundError:
            yield Finding("packages", f'"{text}" is not installed', install)
            continue
        if not target.specifier.contains(there, prereleases=True):
            yield Finding("packages", f'wrong version (got {target.name} {there}, expected "{text}")', install)
