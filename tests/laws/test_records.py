"""Results that describe themselves: what the walker tells, and what it leaves out."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated

import numpy as np
import pytest

from flexstage.base.finding import refuse
from flexstage.base.labelled import Matrix
from flexstage.base.number import Array
from flexstage.base.record import INNER, VIEW, Along, UnitOf, paths, walk
from flexstage.base.storage.document import plain
from flexstage.base.units.quantity import DISPLACEMENT, FREQUENCY, RATIO
from flexstage.mechanism.mechanism import Mechanism


@dataclass(frozen=True)
class Line:
    """One line: `size` of it."""

    size: Annotated[float, FREQUENCY]


@dataclass(frozen=True)
class Sample:
    """A result with one field of each kind: `gain` without unit; `lines` one by one."""

    actuators: tuple[str, ...]
    strokes: Annotated[Array, DISPLACEMENT, Along("actuators")]
    gain: Annotated[Array, RATIO]
    lines: tuple[Line, ...]
    named: Mapping[str, Line]
    command: Annotated[Mapping[str, float], UnitOf(lambda name: "rad" if name.startswith("r") else "m")]
    matrix: Matrix
    arithmetic: Array
    stage: Mechanism
    inner: Annotated[str, INNER] = ""
    absent: Line | None = None
    reasons: Mapping[str, str] = field(default_factory=dict)

    @property
    def view(self) -> Annotated[int, VIEW]:
        """What is seen."""
        return 3

    @property
    def untold(self) -> int:
        """Not told, as it is not annotated."""
        return 4

    @property
    def refused(self) -> Annotated[float, FREQUENCY]:
        """What the stage does not have."""
        raise refuse("stage", "it has none", "Add one")


SAMPLE = Sample(
    ("B1", "B2"),
    np.array([1e-5, -0.0]),
    np.array([1.0, np.nan]),
    (Line(2.0),),
    {"first": Line(np.inf)},
    {"x": 1.0, "rz": 2.0},
    Matrix(np.eye(1), ("a",), ("b",), "m"),
    np.zeros(3),
    Mechanism("stage"),
    reasons={"absent": "there is none"},
)


def test_a_result_is_told_by_its_fields() -> None:
    assert plain(SAMPLE) == {
        "actuators": {"B1": {"strokes_m": 1e-5}, "B2": {"strokes_m": 0.0}},
        "gain": [1.0, None],
        "lines": [{"size_hz": 2.0}],
        "named": {"first": {"size_hz": None}},
        "command": {"x_m": 1.0, "rz_rad": 2.0},
        "matrix": {"rows": ["a"], "columns": ["b"], "unit": "m", "values": [[1.0]]},
        "absent": None,
        "view": 3,
        "refused_hz": None,
        "reasons": {
            "absent": "there is none",
            "refused_hz": "stage: it has none. Add one.",
            "gain.1": "not a number",
            "named.first.size_hz": "infinite",
        },
    }


def test_paths_are_those_of_the_document() -> None:
    assert [path for path, _, _ in paths(Sample)] == [
        "actuators.<name>.strokes_m",
        "gain",
        "lines[]",
        "lines[].size_hz",
        "named.<name>",
        "named.<name>.size_hz",
        "command.<name>",
        "matrix",
        "absent",
        "absent.size_hz",
        "view",
        "refused_hz",
    ]
    found = {path: rest for path, *rest in paths(Sample)}
    assert found["lines[]"] == ["", "One line: `size` of it."]
    assert (found["lines[].size_hz"], found["view"]) == (["number, Hz", ""], ["number", "What is seen."])


def test_names_and_values_along_them_are_of_one_length() -> None:
    with pytest.raises(ValueError, match="argument 2 is longer"):
        walk(Sample(("B1",), *(getattr(SAMPLE, name) for name in list(Sample.__dataclass_fields__)[1:])))
