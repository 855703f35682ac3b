"""Values are of the kind that their field asks for; files are so by their reading, descriptions written in Python may not be."""

from __future__ import annotations

from collections.abc import Iterator

from flexstage.base.finding import Finding
from flexstage.mechanism.grammar import node_of
from flexstage.mechanism.mechanism import Mechanism


def kind_findings(mechanism: Mechanism) -> Iterator[Finding]:
    """Findings about values of another kind than their field's.

    >>> from flexstage.parts.rod import Rod
    >>> print(*kind_findings(Mechanism("", parts={"wire": Rod("steel", length=None, diameter=0.001)})))
    parts.wire.length: found None where a length is expected. Give a number or an array in SI units.
    """
    return node_of(Mechanism).check(mechanism, "")
