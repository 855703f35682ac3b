"""Fuzzing the loader: whatever stands in a file, a description or a DesignError comes out, and what passes the checks can be expanded."""

from __future__ import annotations

import random
import subprocess
import sys
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from flexstage.base.finding import DesignError, Finding
from flexstage.cases.registry import CASES
from flexstage.mechanism.expand import expand
from flexstage.mechanism.store import dumps, load, loads, tidied
from tests.conftest import examples
from tests.roundtrip.designs import TEXT
from tests.roundtrip.mutation import mutated, noise

DESIGNS = (TEXT, *(dumps(tidied(case.build())) for case in CASES.values()))


@examples(300, 3000)
@given(st.integers(min_value=0), st.sampled_from(DESIGNS))
def test_an_altered_design_is_read_or_refused(seed: int, design: str) -> None:
    assert all(finding.where and finding.what and finding.advice for finding in findings(mutated(design, chance(seed))))


def findings(text: str) -> tuple[Finding, ...]:
    """What is said about a text; nothing, if it is read and the description can be expanded."""
    try:
        expand(loads(text))
    except DesignError as error:
        return error.findings or (Finding("", "", ""),)
    return ()


def chance(seed: int) -> random.Random:
    """Chance that can be repeated."""
    return random.Random(seed)  # noqa: S311 (nothing secret)


@given(data=st.one_of(st.binary(max_size=200), st.integers(min_value=0).map(lambda seed: noise(chance(seed)))))
def test_any_bytes_are_read_or_refused(data: bytes, tmp_path_factory: pytest.TempPathFactory) -> None:
    path = tmp_path_factory.getbasetemp() / "noise.toml"
    path.write_bytes(data)
    with pytest.raises(DesignError):
        load(path)


def test_the_fuzzer_says_how_many_inputs_the_loader_survived() -> None:
    script = Path(__file__).parents[2] / "benchmarks" / "fuzz_loader.py"
    done = subprocess.run([sys.executable, str(script), "--seconds", "1"], capture_output=True, text=True, check=True)
    assert "inputs survived" in done.stdout
