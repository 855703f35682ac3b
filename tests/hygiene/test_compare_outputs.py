"""The tool that compares outputs: what it must see, and what it must not."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tools.compare_outputs import tasks
from tools.differences import (
    DIFFERENT,
    EQUAL,
    RENAMED,
    SKIPPED,
    WITHIN,
    Meant,
    Rule,
    compared,
    compared_folders,
    compared_texts,
    deviation,
    document,
    searched,
)

MODES = [{"name": "tilt", "frequency_hz": 106.0}, {"name": "tilt", "frequency_hz": 106.5}]
RESULT = {"version": "1", "modes": MODES, "map": {"unit": "m", "values": [[1.0, 2.0]]}}


def found(old: Any, new: Any, rules: tuple[Rule, ...] = (), paths: Mapping[str, str] | None = None) -> list[tuple[str, str]]:
    return list(compared("run/a.json", document(old), document(new), Meant({}, paths or {}, rules)))


def told(old: Any, new: Any, paths: Mapping[str, str] | None = None) -> list[str]:
    return [text for state, text in found(old, new, paths=paths) if state == DIFFERENT]


def test_what_is_not_equal_bit_by_bit_is_told_with_its_path() -> None:
    assert {state for state, _ in found(RESULT, RESULT | {"version": "2"})} == {EQUAL, SKIPPED}
    changed = json.loads(json.dumps(RESULT).replace("106.5", "106.50000000000001"))
    assert told(RESULT, changed) == ["modes[].frequency_hz: 1 of 2 differ, by 1.3e-16 at most: 106.5 -> 106.50000000000001"]
    for one, other in ((1, 1.0), (0.0, -0.0), (True, 1), (None, 0.0), ("1", 1), ([], {}), ([1.0], [1.0, None])):
        assert told({"a": one}, {"a": other}), (one, other)
    assert told({"a": np.zeros(2)}, {"a": np.zeros(2, np.float32)})


def test_stated_renamings_are_compared_and_other_moves_named() -> None:
    renamed = {"version": "1", "states": {"all": MODES}, "map": RESULT["map"]}
    assert not told(RESULT, renamed, {r"^modes\[": "states.all["})
    assert told(RESULT, renamed) == ["modes[] -> states.all[]"]
    assert told({"n": RESULT}, {"n": {"modes": MODES, "new": 1}}) == [
        "n.version: only at BASE",
        "n.map: only at BASE",
        "n.new: only at HEAD",
    ]


def test_changed_arithmetic_is_judged_by_the_largest_entries_of_row_and_column() -> None:
    matrix = np.array([[1e-6, 1.0], [1.0, 1e6]])
    assert deviation(matrix, matrix + np.array([[1e-19, 0.0], [0.0, 0.0]])) == pytest.approx(1e-19)
    assert deviation(matrix, matrix + np.array([[0.0, 0.0], [1e-8, 0.0]])) == pytest.approx(1e-11)
    assert deviation([1.0, None], [1.0, None]) == 0.0
    assert deviation([1.0, None], [1.0, 0.0]) == deviation("1", "2") == deviation([1.0], [1.0, 2.0]) == np.inf
    rule = (Rule("a.json:x", "sums in another order"),)
    states = [found({"x": 1.0, "y": 1.0}, {"x": 1.0 + off, "y": 1.0 + off}, rule) for off in (5e-13, 5e-12)]
    assert [[state for state, _ in each] for each in states] == [[WITHIN, DIFFERENT], [DIFFERENT, DIFFERENT]]


def test_repeated_modes_are_compared_as_subspaces() -> None:
    shapes, turn = np.random.default_rng(0).normal(size=(6, 3)), np.array([[0.6, -0.8], [0.8, 0.6]])
    turned = np.column_stack([shapes[:, :2] @ turn, -shapes[:, 2]])
    rule = (Rule(":shapes", "another basis", frequencies="hz[]"),)
    for frequencies, state in (([1.0, 1.0 + 1e-9, 2.0], WITHIN), ([1.0, 1.1, 2.0], DIFFERENT)):
        old, new = ({"hz[]": frequencies, "shapes": each.tolist()} for each in (shapes, turned))
        assert [each for each, _ in found(old, new, rule)] == [EQUAL, state]
    assert told({"shapes": shapes}, {"shapes": turned})


def test_searches_count_by_objectives_and_constraints() -> None:
    old = {"optimum": {"variables": {"t": 1.0}, "objectives": {"f1": 100.0}, "limits": [{"value": 2.0}]}}
    near = {"optimum": {"variables": {"t": 1.1}, "objectives": {"f1": 100.00001}, "limits": [{"value": 2.0}]}}
    far = {"optimum": {"variables": {"t": 1.0}, "objectives": {"f1": 100.0}, "limits": [{"value": 2.1}]}}
    assert sorted(state for state, _ in found(old, near, searched("run", "another search"))) == [EQUAL, SKIPPED, WITHIN]
    assert DIFFERENT in {state for state, _ in found(old, far, searched("run", "another search"))}


def test_files_are_compared_as_what_they_are(tmp_path: Path) -> None:
    page = "<style>{}</style><table><tr><td>gain</td><td>{}</td></tr></table><script>{}</script>"
    for side, style, value in (("old", "a", "0.98"), ("new", "b", "0.97")):
        (tmp_path / side).mkdir()
        (tmp_path / side / "a.html").write_text(page.format(style, value, style))
        (tmp_path / side / "b.stdout").write_text(f"gain {' ' * len(style)} 1\n\nmade by flexstage 0.1.0\n")
        (tmp_path / side / f"{side}.json").write_text("{}")
    seen = [
        (where, text) for where, (state, text) in compared_folders("run", tmp_path / "old", tmp_path / "new", Meant()) if state == DIFFERENT
    ]
    assert seen == [("run/a.html", 'line 2: "0.98" -> "0.97"'), ("run/new.json", "only at HEAD"), ("run/old.json", "only at BASE")]
    meant = Meant({"0.98": "0.97"})
    assert RENAMED in {state for where, (state, _) in compared_folders("run", tmp_path / "old", tmp_path / "new", meant) if "html" in where}


def test_what_is_meant_is_told_apart_from_what_is_equal() -> None:
    meant = Meant(
        {"reading": "model"}, {"^ends$": "ends[].of", "^gain_matrix": "gain"}, (), {"worst": "in the table"}, {"source": "told now"}
    )
    old = {"ends": [["a"], ["b"]], "gain_matrix": 1.0, "why": "a reading", "same": 1.0, "worst": 2.0, "other": "c"}
    new = {"ends": [{"of": ["a"]}, {"of": ["b"]}], "gain": 1.0, "why": "a model", "same": 1.0, "source": "x"}
    states = {text: state for state, text in compared("run/a.json", document(old), document(new), meant)}
    assert {states[each] for each in ("ends[].of", "gain", "why")} == {RENAMED}
    assert {states[each] for each in ("worst", "source")} == {WITHIN}
    assert states["same"] == EQUAL
    assert states["other: only at BASE"] == DIFFERENT


def test_long_texts_are_compared_line_by_line() -> None:
    old = [str(number) for number in range(5000)]
    assert list(compared_texts(old, ["x", *old[1:], "y"], Meant())) == [
        (DIFFERENT, 'line 1: "0" -> "x"'),
        (DIFFERENT, 'line 5001: "" -> "y"'),
    ]


def test_runs_are_spelled_in_the_words_of_each_side() -> None:
    all_of_them = list(tasks(""))
    assert len({each.name for each in all_of_them}) == len(all_of_them) > 20
    (run,) = tasks("^hysteresis$")
    new = run.spelled({"--limits": "--volts-range", r"u \[V\]": "drive [V]"})
    assert "--volts-range" in new.commands[0]
    assert "drive [V]" in new.files["stack.csv"]
