"""Records and responses as files: what is read is bit by bit what was written, in every form that has room for it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from flexstage.base.finding import DesignError
from flexstage.experiment.formats.read import read
from flexstage.experiment.formats.uff import write as uff_write
from flexstage.experiment.records.record import Channel, InMemory, Record, Responses, in_memory
from tests.conftest import examples
from tests.roundtrip.records import awkward_record, awkward_responses, bits
from tests.roundtrip.records import write_form as write

SUFFIX = {"uff": ".uff", "uff-ascii": ".unv", "mat": ".mat", "hdf5": ".h5", "csv": ".csv"}
EXACT = [form for form in SUFFIX if form != "uff-ascii"]


def again(folder: Path, what: Record | Responses, form: str) -> Record | Responses:
    path = folder / f"file{SUFFIX[form]}"
    write(path, what, form)
    assert [each.name for each in folder.iterdir()] == [path.name]  # nothing is left aside
    return read(path)


@pytest.mark.parametrize("form", EXACT)
def test_a_record_comes_back_to_the_bit(form: str, tmp_path: Path) -> None:
    first = awkward_record()
    found = again(tmp_path, first, form)
    assert isinstance(found, Record)
    assert bits(found.values) == bits(first.values)
    assert (found.rate, found.start, found.name) == (first.rate, first.start, first.name)
    assert [(each.name, each.unit) for each in found.channels] == [(each.name, each.unit) for each in first.channels]


@pytest.mark.parametrize("form", list(SUFFIX))
def test_roles_come_back(form: str, tmp_path: Path) -> None:
    # A channel of unknown role may be told from its name when it is read: "gauge ..." is an output.
    first = awkward_record()
    found = again(tmp_path, first, form)
    assert isinstance(found, Record)
    assert [each.role for each in found.inputs] == [each.role for each in first.inputs]
    assert {each.name for each in first.outputs} <= {each.name for each in found.outputs}


def test_ascii_keeps_thirteen_digits(tmp_path: Path) -> None:
    plain = in_memory(awkward_record().channels, 2048.0 / 3.0, np.random.default_rng(3).standard_normal((1001, 6)))
    found = again(tmp_path, plain, "uff-ascii")
    assert isinstance(found, Record)
    np.testing.assert_allclose(found.values, plain.values, rtol=5.1e-13, atol=0.0)
    assert found.rate == plain.rate


@pytest.mark.parametrize("even", [True, False], ids=["even", "uneven"])
@pytest.mark.parametrize("form", EXACT)
def test_responses_come_back_to_the_bit(form: str, even: bool, tmp_path: Path) -> None:
    first = awkward_responses(even=even)
    found = again(tmp_path, first, form)
    assert isinstance(found, Responses)
    assert bits(found.values) == bits(first.values)
    assert first.coherence is not None
    assert found.coherence is not None
    assert bits(found.coherence) == bits(first.coherence)
    assert bits(found.frequencies) == bits(first.frequencies)
    assert (found.outputs, found.inputs, found.name) == (first.outputs, first.inputs, first.name)
    assert (found.window, found.averages) == (first.window, first.averages)


@pytest.mark.parametrize("form", list(SUFFIX))
def test_a_single_output_and_input(form: str, tmp_path: Path) -> None:
    whole = awkward_responses(coherence=False)
    single = replace(whole, outputs=whole.outputs[:1], inputs=whole.inputs[:1], values=np.exp(1j * np.arange(40.0))[:, None, None])
    found = again(tmp_path, single, form)
    assert isinstance(found, Responses)
    np.testing.assert_allclose(found.values, single.values, rtol=1e-11)


@examples(20)
@given(length=st.integers(2, 41), channels=st.integers(1, 3), form=st.sampled_from(list(SUFFIX)), data=st.data())
def test_any_part_is_read_as_it_stands_in_the_whole(
    length: int, channels: int, form: str, data: st.DataObject, tmp_path_factory: pytest.TempPathFactory
) -> None:
    values = np.random.default_rng(length).standard_normal((length, channels)) + 2.0
    first = in_memory([Channel(f"S{number}", "um") for number in range(channels)], 10.0, values)
    path = tmp_path_factory.mktemp("part") / f"a{SUFFIX[form]}"
    write(path, first, form)
    found = read(path)
    assert isinstance(found, Record)
    start = data.draw(st.integers(0, length))
    stop = data.draw(st.integers(start, length))
    np.testing.assert_allclose(found.samples.read(start, stop), values[start:stop], rtol=1e-12, atol=0.0)
    size = data.draw(st.integers(1, 7))
    np.testing.assert_array_equal(np.concatenate(list(found.blocks(size))), found.values)


def test_names_that_do_not_fit_are_refused_before_anything_is_written(tmp_path: Path) -> None:
    wrong = in_memory([Channel("a\nb", "um"), Channel("c" * 81, "um"), Channel("d", "kg m^2/(s^2 A) per mm^3")], 1.0, np.zeros((4, 3)))
    with pytest.raises(DesignError) as refused:
        write(tmp_path / "a.uff", wrong)
    assert len(refused.value.findings) == 3
    assert not list(tmp_path.iterdir())


def test_a_writer_that_fails_leaves_the_old_file(tmp_path: Path) -> None:
    path = tmp_path / "a.uff"
    write(path, awkward_record())
    before = path.read_bytes()

    class Failing(InMemory):
        def read(self, start: int, stop: int) -> np.ndarray:  # noqa: ARG002
            raise RuntimeError("the cable was pulled")

    failing = replace(awkward_record(), samples=Failing(np.zeros((1000, 6))))
    for form in SUFFIX:
        with pytest.raises(RuntimeError):
            write(path, failing, form)
    assert path.read_bytes() == before
    assert [each.name for each in tmp_path.iterdir()] == ["a.uff"]


def test_a_folder_that_is_missing_is_told(tmp_path: Path) -> None:
    for form in SUFFIX:
        with pytest.raises(DesignError, match="cannot be written"):
            write(tmp_path / "nowhere" / "a.uff", awkward_record(), form)


def test_a_name_without_a_form_is_refused() -> None:
    with pytest.raises(DesignError, match="unknown file ending"):
        write("record.xyz", awkward_record())


def test_blocks_of_writers_meet(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # Records longer than a writer's block, which is made small here.
    monkeypatch.setattr(uff_write, "BLOCK", 8)
    monkeypatch.setattr("flexstage.experiment.formats.hdf.BLOCK", 8)
    monkeypatch.setattr("flexstage.experiment.formats.table.write.BLOCK", 8)
    first = in_memory([Channel("S1", "um"), Channel("S2", "um")], 3.0, np.random.default_rng(0).standard_normal((37, 2)))
    for form, suffix in SUFFIX.items():
        path = tmp_path / f"{form}{suffix}"
        write(path, first, form)
        found = read(path)
        assert isinstance(found, Record)
        np.testing.assert_allclose(found.values, first.values, rtol=1e-11)
