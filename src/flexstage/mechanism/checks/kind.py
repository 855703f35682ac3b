"""Values are of the kind that their field asks for, and the packages that offer kinds are installed."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from importlib.metadata import PackageNotFoundError, version

from flexstage.base.finding import Finding
from flexstage.mechanism.grammar.grammar import node_of
from flexstage.mechanism.mechanism import Mechanism


def kind_findings(mechanism: Mechanism) -> Iterator[Finding]:
    """Findings about values of another kind than a file can hold: classes that no register lists, for example.

    >>> from flexstage.parts.rod import Rod
    >>> class Wire(Rod): ...
    >>> print(*kind_findings(Mechanism("", parts={"wire": Wire("steel", length=0.03, diameter=0.001)})))
    parts.wire: found Wire(... where ... Rod ... is expected. Give ...
    """
    return node_of(Mechanism).check(mechanism, "")


def package_findings(packages: Iterable[str]) -> Iterator[Finding]:
    """Findings about packages that a description asks for and that are not installed, or not in the versions asked for.

    >>> print(*package_findings(["numpy >= 1", "tapered-leaf >= 1"]))
    packages: "tapered-leaf >= 1" is not installed. Install it where flexstage is, for example with: pip install "tapered-leaf >= 1".
    """
    for text in packages:
        from packaging.requirements import InvalidRequirement, Requirement  # takes 0.1 s, and few designs name any

        try:
            wanted = Requirement(text)
        except InvalidRequirement:
            yield Finding("packages", f'"{text}" names no package', 'Write its name, and perhaps its versions: "tapered-leaf >= 1"')
            continue
        install = f'Install it where flexstage is, for example with: pip install "{text}"'
        try:
            there = version(wanted.name)
        except PackageNotFoundError:
            yield Finding("packages", f'"{text}" is not installed', install)
            continue
        if not wanted.specifier.contains(there, prereleases=True):
            yield Finding("packages", f'"{text}" is asked for, and {wanted.name} {there} is installed', install)
