"""The tool that compares outputs: what it must see, and what it must not."""

from __future__ import annotations

import json
import sys
from collections import defaultdict
from collections.abc import Mapping
from pathlib import Path
from subprocess import PIPE, Popen
from typing import Any, cast

import numpy as np
import pytest

from flexstage.apps.cli.commands import LazyCommand, application
from flexstage.show.sheets import to_csv
from flexstage.show.workbook import to_xlsx
from tools.compare_outputs import talk, tasks
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
    meant = Meant({"reading": "model"}, {"^gain_matrix": "gain"}, (), {"worst|source": "in the table now"})
    old = {"gain_matrix": 1.0, "why": "a reading", "same": 1.0, "worst": 2.0, "other": "c"}
    new = {"gain": 1.0, "why": "a model", "same": 1.0, "source": "x"}
    states = {text: state for state, text in compared("run/a.json", document(old), document(new), meant)}
    assert {states[each] for each in ("gain", "why")} == {RENAMED}
    assert {states[each] for each in ("worst", "source")} == {WITHIN}
    assert states["same"] == EQUAL
    assert states["other: only at BASE"] == DIFFERENT


def test_long_texts_are_compared_line_by_line() -> None:
    old = [str(number) for number in range(5000)]
    assert list(compared_texts(old, ["x", *old[1:], "y"], Meant())) == [
        (DIFFERENT, 'line 1: "0" -> "x"'),
        (DIFFERENT, 'line 5001: "" -> "y"'),
    ]


@pytest.mark.parametrize("name", ["lines.csv", "lines.xlsx"])
def test_a_changed_number_of_a_table_is_told(tmp_path: Path, name: str) -> None:
    def states(off: float, *rules: Rule) -> set[str]:
        for side, value in (("old", 2.0), ("new", 2.0 + off)):
            result = {"lines": [{"name": "m", "f_hz": each} for each in (1.0, value, None)]}
            (tmp_path / side).mkdir(exist_ok=True)
            (tmp_path / side / name).write_bytes(to_xlsx(result) if name.endswith("xlsx") else to_csv(result)["lines"].encode())
        found = compared_folders("run", tmp_path / "old", tmp_path / "new", Meant(rules=rules))
        return {state for _, (state, _) in found} - {EQUAL}

    assert states(0.0) == set()
    rule = Rule(name, "sums in another order")
    assert [states(off, *rules) for off in (1e-14, 1e-9) for rules in ((), (rule,))] == [{DIFFERENT}, {WITHIN}, {DIFFERENT}, {DIFFERENT}]


def test_texts_that_are_left_out_are_told() -> None:
    lines = ["exit code 0", "stage at 127.0.0.1:{}: axes x", "The stage ran for {} s."]
    old, new = ([each.format(number) for each in lines] for number in (1234, 4321))
    assert list(compared_texts(old, new, Meant())) == [(SKIPPED, "free port, time of a computation")]
    assert list(compared_texts(old, old, Meant())) == [(EQUAL, "")]


def test_with_a_rule_the_words_of_a_text_count() -> None:
    rule = Rule(":", "sums in another order")
    for new, state in ((["gain -1.2e-17 m", "9"], WITHIN), (["gain 3 m", "8"], WITHIN), (["gain 3 mm", "8"], DIFFERENT)):
        assert [each for each, _ in compared_texts(["gain 3.4·10⁻¹⁷ m", "8"], new, Meant(), rule)] == [state]


def test_a_server_is_asked_until_it_answers_and_then_interrupted() -> None:
    server = """
import signal, socket, sys, time
signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background jobs ignore it
with socket.create_server(("127.0.0.1", 0)) as listening:
    print(f"at 127.0.0.1:{listening.getsockname()[1]}: axes x", file=sys.stderr, flush=True)
    connection = listening.accept()[0]
    try:
        for number, line in enumerate(connection.makefile("r")):  # one file for both would forget lines that came before it writes
            connection.sendall(f"{number} of \\n{line}".encode() if "?" in line else b"")
        while True:  # a call that blocks would miss a signal that comes just before it
            time.sleep(0.01)
    except KeyboardInterrupt:
        print("ended", file=sys.stderr)
"""
    with Popen([sys.executable, "-c", server], stderr=PIPE, encoding="utf-8") as running:
        try:
            said = talk(running, "MOV x 1\nONT? x ~ 3 of \\nONT\\? x\nPOS? x\n")
            assert said.splitlines()[1:] == ["MOV x 1", r"ONT? x ~ 3 of \nONT\? x", "POS? x", "4 of ", "POS? x"]
            assert running.communicate(timeout=10.0)[1] == "ended\n"
        finally:
            running.kill()


def test_every_command_writes_every_output_once() -> None:
    known = {name: cast("LazyCommand", command).load().params for name, command in application().commands.items()}
    used: dict[str, set[str]] = defaultdict(set)
    for line in (line for run in tasks("") for line in run.commands if not run.name.startswith("refused")):
        used[line.split()[0]] |= set(line.split())
    assert known.keys() - used == {"studio"}  # its messages depend on the moment: tests/apps and tests/browser have them
    written = {"--json", "--csv", "--xlsx", "--report", "--mat", "--view", "--mesh", "--gltf", "--output", "--export", "--hardware"}
    options = {(name, each.opts[0]): {*each.opts} for name, params in known.items() for each in params if written & {*each.opts}}
    assert {each for each, words in options.items() if not words & used[each[0]]} == set()


def test_runs_are_spelled_in_the_words_of_each_side() -> None:
    all_of_them = list(tasks(""))
    assert len({each.name for each in all_of_them}) == len(all_of_them) > 20
    (run,) = tasks("^hysteresis$")
    new = run.spelled({"--limits": "--volts-range", r"u \[V\]": "drive [V]"})
    assert "--volts-range" in new.commands[0]
    assert "drive [V]" in new.files["stack.csv"]
