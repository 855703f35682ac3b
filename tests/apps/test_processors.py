"""What a command says does not depend on the processor: names, keys, orders and lengths are the same, numbers but for rounding."""

from __future__ import annotations

import itertools
import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from flexstage.cases.registry import CASES
from tests.conftest import FULL
from tools.processors import processors

SMALL = 1e-7
"""What rounding may change, as a share of the largest number beside it."""

SCRIPT = """
import sys
from flexstage.apps.cli import run
for name in sys.argv[1:]:
    run(["new", f"{name}.toml", "--case", name])
    run(["analyse", f"{name}.toml", "--json", f"{name}.json"])
"""


def _analysed(folder: Path, names: list[str], environment: dict[str, str]) -> dict[str, Any]:
    folder.mkdir()
    subprocess.run([sys.executable, "-c", SCRIPT, *names], cwd=folder, env={**os.environ, **environment}, check=True, capture_output=True)
    return {name: json.loads((folder / f"{name}.json").read_text()) for name in names}


def _leaves(value: Any, path: str, largest: float) -> list[tuple[str, Any, float]]:
    """Every number and text with where it stands, and the largest number of the list it is in."""
    if isinstance(value, dict):
        return [(f"{path} {list(value)}", len(value), 0.0)] + [leaf for key in value for leaf in _leaves(value[key], f"{path}.{key}", 0.0)]
    if isinstance(value, list):
        size = largest or _largest(value)
        return [(path, len(value), 0.0)] + [leaf for number, each in enumerate(value) for leaf in _leaves(each, f"{path}[{number}]", size)]
    return [(path, value, largest)]


def _largest(value: Any) -> float:
    if isinstance(value, list):
        return max(map(_largest, value), default=0.0)
    return abs(value) if isinstance(value, float) else 0.0


def _sure(found: dict[str, Any], name: str) -> dict[str, float]:
    """By the path of a mode, what rounding may change of its shape: that of squared frequencies (eps times one over the least) by gaps."""
    modes = found["modes"]["modes"]
    squares = [mode["frequency_hz"] ** 2 for mode in modes]
    gaps = [abs(one - other) for one, other in itertools.pairwise(squares)]
    apart = [
        min((gap for gap in gaps[max(0, place - 1) : place + 1] if gap > 2e-6 * value), default=value)
        for place, value in enumerate(squares)
    ]
    eps = np.finfo(float).eps
    return {f"{name}.modes.modes[{place}]": eps * value**2 / (squares[0] * apart[place]) for place, value in enumerate(squares)}


def test_every_processor_names_and_counts_alike(tmp_path: Path) -> None:
    others = processors()
    if not others:
        pytest.skip("OpenBLAS has no other kernels for this processor")
    names = list(CASES) if FULL else ["tip-tilt"]
    first = _analysed(tmp_path / "own", names, {})
    for number, environment in enumerate(others.values() if FULL else list(others.values())[:1]):
        second = _analysed(tmp_path / str(number), names, dict(environment))
        for name in names:
            sure = _sure(first[name], name)
            own, other = _leaves(first[name], name, 0.0), _leaves(second[name], name, 0.0)
            assert [path for path, _, _ in own] == [path for path, _, _ in other]
            for (path, expected, size), (_, value, _) in zip(own, other, strict=True):
                if isinstance(expected, float) and isinstance(value, float):
                    mode, shares, _ = path.partition(".energy_share.")
                    small, beside = (max(SMALL, sure[mode]), 1.0) if shares else (SMALL, size)
                    assert value == pytest.approx(expected, rel=small, abs=small * beside + 1e-12), path
                else:
                    assert value == expected, path
