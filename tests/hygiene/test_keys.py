"""A key of files has one meaning: where it is in several tables it takes the same unit of measurement, type or table."""

from collections import defaultdict
from collections.abc import Iterator
from typing import Any

from flexstage.control.hysteresis.stack import hysteresis_schema
from flexstage.control.study.file import setup_schema
from flexstage.mechanism.store import schema
from flexstage.studies.form import study_schema

SEVERAL = {
    "a length or an angle, by axis or gauge; densities of such": "acceleration length noise noise_density radius range resolution",
    "two textbook terms of two fields: a corner of a fillet, of a filter": "along corner depth gain rate reference step width",
    "a number in one file, a table of it in another": "creep damping envelope outer prefilter requirements units x y z",
    "names in one table, what they name in another": "gauges like mass part stiffness",
    "the ends of a link, of a path, of a range": "drive first from to",
    "a point by name, whether a body is one, points of a body, how many a path has": "point points",
}
"""Keys with several meanings, by the reason: this only shrinks."""


def meanings(node: Any) -> Iterator[str]:
    """What a schema takes: quantities by name, tables by definition, other types."""
    if isinstance(node, list):
        for each in node:
            yield from meanings(each)
    elif isinstance(node, dict) and "description" in node:
        yield node["description"].partition(",")[0]
    elif isinstance(node, dict) and ("$ref" in node or ("type" in node and node["type"] not in ("array", "object"))):
        yield node.get("$ref") or node["type"]
    elif isinstance(node, dict):
        yield from meanings([each for name, each in node.items() if name != "properties"])


def test_a_key_has_one_meaning() -> None:
    found: defaultdict[str, set[frozenset[str]]] = defaultdict(set)
    for document in (schema(), study_schema(), setup_schema(), hysteresis_schema()):
        for table in (document, *document["$defs"].values()):
            for key, node in table.get("properties", {}).items():
                if "const" not in node:
                    found[key].add(frozenset(meanings(node)))
    several = {key for key, each in found.items() if len(each) > 1}
    assert several == set(" ".join(SEVERAL.values()).split())
