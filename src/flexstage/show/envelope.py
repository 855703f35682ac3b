"""The envelope of every document: what it is, of which description, by which reading and version, and what is doubtful about it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import flexstage
from flexstage.analysis.cautions import Caveats, caveats
from flexstage.base.digest import digest
from flexstage.base.document import Document
from flexstage.base.finding import Finding
from flexstage.base.record import walk
from flexstage.mechanism.mechanism import Mechanism
from flexstage.models.theory import Reading

FORMAT = "flexstage result 2"


def enveloped(kind: str, mechanism: Mechanism | None, reading: Reading | None, body: Any, more: Iterable[Finding] = ()) -> Document:
    """A document: what it is, of which description (absent: of a record alone), by which reading and version, caveats, then its `body`.

    `body` is a result, or a mapping with results in it. `more` are cautions of the result's own.

    >>> enveloped("mapping", Mechanism("stage"), None, {"mobility": 6})["name"]
    'stage'
    """
    known = Caveats() if mechanism is None else caveats(mechanism)
    return {
        "format": FORMAT,
        "kind": kind,
        "version": flexstage.__version__,
        "name": None if mechanism is None else mechanism.name,
        "reading": None if reading is None else reading.value,
        "physics_digest": None if mechanism is None else digest(mechanism, physics=True),
        "cautions": [*known.cautions, *more],
        "defaults": list(known.defaults),
        **(body if isinstance(body, Mapping) else walk(body)),
    }


def check_document(mechanism: Mechanism | None, errors: Iterable[Finding] = ()) -> Document:
    """The document of a check: whether the design is sound, and its findings; without the envelope's digest and caveats if it is not.

    >>> check_document(None, [Finding("B4/pivot", "it is thin", "Thicken it")])["sound"]
    False
    """
    found = list(errors)
    body: Document = {"sound": not found, "findings": found}
    if mechanism is None:
        return {"format": FORMAT, "kind": "check", "version": flexstage.__version__, **body, "cautions": [], "defaults": [], "warnings": []}
    document = enveloped("check", mechanism, None, body)
    return {**document, "warnings": document["cautions"]}
