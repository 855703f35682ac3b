"""Records that other programs wrote: pyuff, scipy.io, h5py and numpy.savetxt, in ways other than ours."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
import pyuff
import scipy.io

from flexstage.base.finding import DesignError
from flexstage.experiment.formats.read import read
from flexstage.experiment.formats.uff.values import BinaryValues, PrintedValues
from flexstage.experiment.formats.variables import SideBySide
from flexstage.experiment.formats.write import Form, write
from flexstage.experiment.options import Kind, Options
from flexstage.experiment.record import Record, Responses, in_memory
from tests.roundtrip.records import awkward_record, awkward_responses

pytestmark = pytest.mark.filterwarnings("ignore:unclosed file:ResourceWarning")  # pyuff does not close what it writes in binary

RATE, LENGTH = 2048.0, 500
TIMES = np.arange(LENGTH) / RATE
DRAW = np.random.default_rng(7)
U, Y = DRAW.standard_normal((LENGTH, 2)), 1e-6 * DRAW.standard_normal((LENGTH, 3))
LINES = 0.5 * np.arange(1, 65)
KINDS = {"ordinate_spec_data_type": 12, "orddenom_spec_data_type": 13}
H = DRAW.standard_normal((64, 3, 2)) + 1j * DRAW.standard_normal((64, 3, 2))


def record(path: Path, options: Options | None = None) -> Record:
    found = read(path, options or Options())
    assert isinstance(found, Record)
    return found


def responses(path: Path, options: Options | None = None) -> Responses:
    found = read(path, options or Options())
    assert isinstance(found, Responses)
    return found


def same(found: Record, *, rtol: float = 0.0) -> None:
    """The channels u1, u2, y1, y2, y3 with their numbers, and the rate."""
    assert [each.name for each in found.inputs] == ["u1", "u2"]
    assert [each.name for each in found.outputs] == ["y1", "y2", "y3"]
    np.testing.assert_allclose(found.select(["u1", "u2", "y1", "y2", "y3"]).values, np.hstack([U, Y]), rtol=rtol, atol=0.0)
    assert found.rate == RATE


# --- universal files ---


def history(name: str, node: int, values: np.ndarray, **more: Any) -> dict[str, Any]:
    form = {
        "binary": 1,
        "abscissa_spacing": 1,
        "abscissa_min": 0.0,
        "abscissa_inc": 1 / RATE,
        "ordinate_spec_data_type": 12,
        "orddenom_spec_data_type": 0,
        **more,
    }
    units = {"abscissa_spec_data_type": 17, "abscissa_axis_units_lab": "s", "ordinate_axis_units_lab": "m/s^2"}
    place = {"rsp_ent_name": name, "rsp_node": node, "rsp_dir": 3, "ref_dir": 0, "ref_node": 0}
    return pyuff.prepare_58(func_type=1, data=values, x=TIMES[: len(values)], num_pts=len(values), **units, **place, **form)


@pytest.mark.parametrize("binary", [1, 0])
@pytest.mark.parametrize("even", [1, 0])
def test_pyuff_histories(binary: int, even: int, tmp_path: Path) -> None:
    path = tmp_path / "a.uff"
    columns = np.hstack([U, Y]).T
    names = ["u1", "u2", "y1", "y2", "y3"]
    sets = [history(name, 0, values, binary=binary, abscissa_spacing=even) for name, values in zip(names, columns, strict=True)]
    pyuff.UFF(str(path)).write_sets(sets)
    found = record(path, Options(inputs=("u*",)))
    same(found, rtol=0.0 if binary else 5e-12)
    assert {each.unit for each in found.channels} == {"m/s^2"}
    kind = BinaryValues if binary else PrintedValues
    if even:
        assert isinstance(found.samples, SideBySide)
        assert all(isinstance(each, kind) for each in found.samples.sources)  # left in the file


def test_pyuff_names_by_node_and_direction(tmp_path: Path) -> None:
    path = tmp_path / "a.uff"
    pyuff.UFF(str(path)).write_sets([history("NONE", node, U[:, 0]) for node in (4, 7)])
    assert record(path).names == ("4+Z", "7+Z")


def test_pyuff_single_precision(tmp_path: Path) -> None:
    path = tmp_path / "a.uff"
    pyuff.UFF(str(path)).write_sets([history("y1", 0, Y[:, 0], binary=0, ord_data_type=2)], force_double=False)
    found = record(path)
    np.testing.assert_allclose(found.values[:, 0], Y[:, 0], rtol=5e-6, atol=0.0)


def test_big_endian_and_carriage_returns(tmp_path: Path) -> None:
    # As an instrument writes it: lines end in CR LF, numbers in the byte order of other processors.
    path = tmp_path / "a.uff"
    write(path, in_memory(awkward_record().channels[2:3], RATE, Y[:, :1]))
    head, mark, _ = path.read_bytes().partition(b"f" * 0 + Y[:, 0].astype("<f8").tobytes())
    assert mark
    lines = head.replace(b"58b     1", b"58b     2").replace(b"\n", b"\r\n")
    path.write_bytes(lines + Y[:, 0].astype(">f8").tobytes() + b"\r\n    -1\r\n")
    np.testing.assert_array_equal(record(path).values[:, 0], Y[:, 0])


@pytest.mark.parametrize("binary", [1, 0])
@pytest.mark.parametrize("even", [1, 0])
def test_pyuff_responses(binary: int, even: int, tmp_path: Path) -> None:
    path = tmp_path / "a.uff"
    sets: list[dict[str, Any]] = []
    for (row, column), _ in np.ndenumerate(H[0]):
        place = {"rsp_node": row + 1, "rsp_dir": -1, "ref_node": column + 1, "ref_dir": 3}
        axis = {
            "abscissa_spacing": even,
            "abscissa_min": 0.5,
            "abscissa_inc": 0.5,
            "abscissa_spec_data_type": 18,
            "binary": binary,
            **KINDS,
        }
        units = {"ordinate_axis_units_lab": "m/s^2", "orddenom_axis_units_lab": "N", "abscissa_axis_units_lab": "Hz"}
        sets.append(pyuff.prepare_58(func_type=4, data=H[:, row, column], x=LINES, num_pts=64, **place, **axis, **units))
    pyuff.UFF(str(path)).write_sets(sets)
    found = responses(path)
    assert ([each.name for each in found.outputs], [each.name for each in found.inputs]) == (["1-X", "2-X", "3-X"], ["1+Z", "2+Z"])
    np.testing.assert_allclose(found.values, H, rtol=0.0 if binary else 5e-12)
    np.testing.assert_allclose(found.frequencies, LINES, rtol=1e-15)
    assert found.units[0] == ("m/s^2/N", "m/s^2/N")


def test_a_response_that_is_missing_is_named(tmp_path: Path) -> None:
    path = tmp_path / "a.uff"
    axis = {"abscissa_spacing": 1, "abscissa_min": 0.5, "abscissa_inc": 0.5, "abscissa_spec_data_type": 18, "binary": 1, **KINDS}
    places = [("S1", "u1"), ("S1", "u2"), ("S2", "u1")]
    sets = [
        pyuff.prepare_58(
            func_type=4,
            data=H[:, 0, 0],
            x=LINES,
            num_pts=64,
            rsp_ent_name=out,
            ref_ent_name=into,
            rsp_node=0,
            rsp_dir=0,
            ref_node=0,
            ref_dir=0,
            **axis,
        )
        for out, into in places
    ]
    pyuff.UFF(str(path)).write_sets(sets)
    with pytest.raises(DesignError, match=r"S2: its responses to u2 are missing"):
        read(path)
    assert responses(path, Options(inputs=("u1",))).values.shape == (64, 2, 1)


@pytest.mark.parametrize("form", [Form.UFF, Form.UFF_ASCII])
def test_pyuff_reads_what_we_write(form: Form, tmp_path: Path) -> None:
    path = tmp_path / "a.uff"
    ours = in_memory(awkward_record().channels, RATE, np.random.default_rng(2).standard_normal((LENGTH, 6)))
    write(path, ours, form)
    theirs = pyuff.UFF(str(path)).read_sets()
    assert [each["id1"] for each in theirs] == list(ours.names)
    assert [each["ordinate_axis_units_lab"] or "NONE" for each in theirs] == [each.unit or "NONE" for each in ours.channels]
    np.testing.assert_allclose(np.stack([each["data"] for each in theirs], axis=-1), ours.values, rtol=0.0 if form is Form.UFF else 5.1e-13)
    np.testing.assert_allclose(theirs[0]["x"][-1], (LENGTH - 1) / RATE, rtol=1e-6)


@pytest.mark.parametrize("form", [Form.UFF, Form.UFF_ASCII])
def test_pyuff_reads_our_responses(form: Form, tmp_path: Path) -> None:
    path = tmp_path / "a.uff"
    draw = awkward_responses(coherence=False)
    ours = Responses(draw.frequencies, draw.outputs, draw.inputs, np.exp(1j * np.arange(320.0)).reshape(40, 4, 2))
    write(path, ours, form)
    theirs = pyuff.UFF(str(path)).read_sets()
    values = np.stack([each["data"] for each in theirs], axis=-1).reshape(40, 4, 2)
    np.testing.assert_allclose(values, ours.values, rtol=0.0 if form is Form.UFF else 1e-11, atol=1e-12 if form is Form.UFF_ASCII else 0.0)
    np.testing.assert_allclose(theirs[0]["x"], ours.frequencies, rtol=1e-6)


# --- MAT files ---


MAT: dict[str, dict[str, Any]] = {
    "columns and a time vector": {"time": TIMES[:, None], "u": U, "y": Y},
    "rows and a step": {"dt": 1 / RATE, "u": U.T, "y": Y.T},
    "mixed orientations and a rate": {"fs": np.int32(2048), "u": U.T, "y": Y},
    "one variable a channel": {"t": TIMES[None], "u1": U[:, 0], "u2": U[:, 1], "y1": Y[:, 0], "y2": Y[None, :, 1], "y3": Y[:, 2]},
    "a structure": {"test": {"u": U, "y": Y, "Fs": RATE, "operator": "someone"}},
    "big-endian": {"dt": np.array(1 / RATE, ">f8"), "u": U.astype(">f8"), "y": Y.astype(">f8")},
}


@pytest.mark.parametrize("layout", MAT, ids=list(MAT))
@pytest.mark.parametrize("compressed", [False, True])
def test_mat_files_of_scipy(layout: str, compressed: bool, tmp_path: Path) -> None:
    path = tmp_path / "a.mat"
    scipy.io.savemat(path, MAT[layout], do_compression=compressed)
    same(record(path))


def test_mat_version_4(tmp_path: Path) -> None:
    path = tmp_path / "a.mat"
    scipy.io.savemat(path, {"dt": 1 / RATE, "u": U, "y": Y}, format="4")
    same(record(path))


def test_mat_single_precision_and_integers(tmp_path: Path) -> None:
    path = tmp_path / "a.mat"
    counts = np.arange(LENGTH, dtype=np.int16)[:, None] % 100
    scipy.io.savemat(path, {"t": TIMES.astype(np.float32), "u": U.astype(np.float32), "y": counts})
    found = record(path)
    np.testing.assert_array_equal(found.values, np.hstack([U.astype(np.float32), counts]))
    assert found.rate == RATE


def test_mat_structure_array_of_channels(tmp_path: Path) -> None:
    # A structure a channel, with its name, unit and data: as data loggers export.
    path = tmp_path / "a.mat"
    channels = np.zeros((1, 2), dtype=[("name", object), ("unit", object), ("data", object)])
    channels[0, 0] = ("force", "N", U[:, :1])
    channels[0, 1] = ("gap", "µm", Y[:, :1])
    scipy.io.savemat(path, {"ch": channels, "fs": RATE})
    found = record(path)
    assert [(each.name, each.unit, each.role.value) for each in found.channels] == [("force", "N", "input"), ("gap", "µm", "output")]


def test_mat_names_and_units_beside(tmp_path: Path) -> None:
    path = tmp_path / "a.mat"
    cells = np.array(["drive", "S1"], dtype=object)
    scipy.io.savemat(path, {"fs": RATE, "data": U, "channel_names": cells, "units": np.array(["Volts", "micron"], dtype=object)})
    assert [(each.name, each.unit) for each in record(path).channels] == [("drive", "V"), ("S1", "um")]


def test_mat_responses(tmp_path: Path) -> None:
    path = tmp_path / "a.mat"
    for name, values in {"inputs last": H, "frequencies last": np.moveaxis(H, 0, -1), "frequencies between": np.moveaxis(H, 0, 1)}.items():
        scipy.io.savemat(path, {"freq": LINES, "FRF": values, "coh": np.full(values.shape, 0.9)})
        found = responses(path)
        np.testing.assert_array_equal(found.values, H, err_msg=name)
        assert found.coherence is not None
        assert found.coherence.shape == H.shape


def test_mat_responses_one_a_variable_and_in_halves(tmp_path: Path) -> None:
    path = tmp_path / "a.mat"
    one = {"H_x": H[:, 0, 0], "H_y": H[:, 1, 0], "cross_spec": H[:, 2, 0]}
    scipy.io.savemat(path, {"f": LINES[None], **one})
    found = responses(path)
    assert [each.name for each in found.outputs] == ["H_x", "H_y"]
    scipy.io.savemat(path, {"f": LINES, "H_re": H[:, 0, 0].real, "H_im": H[:, 0, 0].imag})
    np.testing.assert_array_equal(responses(path).values[:, 0, 0], H[:, 0, 0])


def test_a_file_with_both_asks_which_is_meant(tmp_path: Path) -> None:
    path = tmp_path / "a.mat"
    scipy.io.savemat(path, {"time": TIMES, "u": U, "y": Y, "f": LINES, "H": H})
    with pytest.raises(DesignError, match=r"holds a record \(u1, u2, y1, y2, y3; 500 samples\) and frequency responses \(64 frequencies\)"):
        read(path)
    same(record(path, Options(kind=Kind.RECORD)))
    assert responses(path, Options(kind=Kind.RESPONSES)).values.shape == H.shape


def as_matlab(file: h5py.File | h5py.Group, name: str, values: np.ndarray | float | str) -> None:
    """A variable as MATLAB itself stores it in version 7.3."""
    if isinstance(values, str):
        found = file.create_dataset(name, data=np.array([[ord(each)] for each in values], np.uint16))
        found.attrs["MATLAB_class"] = np.bytes_("char")
        return
    array = np.atleast_2d(np.asarray(values)).T
    if np.iscomplexobj(array):
        pairs = np.zeros(array.shape, [("real", "<f8"), ("imag", "<f8")])
        pairs["real"], pairs["imag"] = array.real, array.imag
        array = pairs
    file.create_dataset(name, data=array).attrs["MATLAB_class"] = np.bytes_("double")


def version_73(path: Path) -> h5py.File:
    return h5py.File(path, "w", userblock_size=512)


def signed(path: Path) -> None:
    with path.open("r+b") as stream:
        stream.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64, Created on: Mon".ljust(124) + b"\x00\x02IM")


def test_mat_73_structures_cells_and_complex(tmp_path: Path) -> None:
    path = tmp_path / "a.mat"
    with version_73(path) as file:
        test = file.create_group("test")
        as_matlab(test, "u", U)
        as_matlab(test, "y", Y.T)
        as_matlab(test, "fs", RATE)
        as_matlab(test, "comment", "white noise")
        references = file.create_group("#refs#")
        units = ["V", "V", "um", "um", "um"]
        for number, unit in enumerate(units):
            as_matlab(references, f"r{number}", unit)
        cell = file.create_dataset("units", (5, 1), dtype=h5py.ref_dtype)
        for number in range(5):
            cell[number, 0] = references[f"r{number}"].ref
        cell.attrs["MATLAB_class"] = np.bytes_("cell")
        as_matlab(file, "freq", LINES)
        as_matlab(file, "H1", H)
    signed(path)
    found = record(path, Options(kind=Kind.RECORD))
    same(found)
    assert [each.unit for each in found.channels] == ["V", "V", "um", "um", "um"]
    np.testing.assert_array_equal(responses(path, Options(kind=Kind.RESPONSES)).values, H)


def test_scipy_reads_what_we_write(tmp_path: Path) -> None:
    path = tmp_path / "a.mat"
    ours = awkward_record()
    write(path, ours)
    theirs = scipy.io.loadmat(path, simplify_cells=True)
    np.testing.assert_array_equal(theirs["samples"], ours.values)
    assert list(theirs["names"]) == list(ours.names)
    assert theirs["rate"] == ours.rate


# --- HDF5 ---


def test_hdf_groups_with_attributes(tmp_path: Path) -> None:
    path = tmp_path / "a.h5"
    with h5py.File(path, "w") as file:
        file.attrs["sampling_rate"] = RATE
        for kind, values, unit in (("inputs", U, "V"), ("outputs", Y, "um")):
            for number, column in enumerate(values.T):
                one = file.create_dataset(f"run 1/{kind}/{kind[0] if kind[0] != 'i' else 'u'}{number}", data=column)
                one.attrs["name"] = f"{'u' if kind == 'inputs' else 'y'}{number + 1}"
                one.attrs["unit"] = np.bytes_(unit)
    found = record(path)
    same(found)
    assert [each.unit for each in found.channels] == ["V", "V", "um", "um", "um"]


def test_hdf_transposed_big_endian_float32_and_times_in_ms(tmp_path: Path) -> None:
    path = tmp_path / "a.hdf5"
    with h5py.File(path, "w") as file:
        file.create_dataset("Time", data=1000.0 * TIMES).attrs["unit"] = "ms"
        file["u"] = U.T.astype(">f4")
        file.create_dataset("y", data=Y, chunks=(64, 3), compression="gzip")
    found = record(path)
    same(found, rtol=1e-7)
    np.testing.assert_array_equal(found.values[:, 2:], Y)


def test_hdf_table_with_named_columns(tmp_path: Path) -> None:
    path = tmp_path / "a.h5"
    names = ["time", "u1", "u2", "y1", "y2", "y3"]
    table = np.zeros(LENGTH, [(name, "<f8") for name in names])
    for name, column in zip(names, np.column_stack([TIMES, U, Y]).T, strict=True):
        table[name] = column
    with h5py.File(path, "w") as file:
        file["log/table"] = table
    same(record(path))


def test_hdf_responses_with_lists_of_names(tmp_path: Path) -> None:
    path = tmp_path / "a.h5"
    with h5py.File(path, "w") as file:
        file["frf/frequency"] = LINES
        file["frf/H"] = H
        file["frf/outputs"] = ["S1", "S2", "S3"]
        file["frf/inputs"] = ["B1", "B2"]
    found = responses(path)
    assert ([each.name for each in found.outputs], [each.name for each in found.inputs]) == (["S1", "S2", "S3"], ["B1", "B2"])
    np.testing.assert_array_equal(found.at("S2", "B2"), H[:, 1, 1])


# --- CSV ---


TABLE = np.column_stack([TIMES, U, Y])
HEAD = "time [s],u1 [V],u2 [V],y1 [um],y2 [um],y3 [um]"


def test_savetxt_with_its_commented_header(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    np.savetxt(path, TABLE, header=HEAD, delimiter=",")  # "# time [s],..." and 18 digits
    found = record(path)
    same(found)
    assert [each.unit for each in found.channels] == ["V", "V", "um", "um", "um"]


@pytest.mark.parametrize(("delimiter", "kind"), [(";", "semicolons"), ("\t", "tabs"), (" ", "blanks"), (", ", "commas and blanks")])
def test_other_delimiters(delimiter: str, kind: str, tmp_path: Path) -> None:
    path = tmp_path / f"{kind}.txt"
    np.savetxt(path, TABLE, header=HEAD.replace(",", delimiter), delimiter=delimiter, comments="")
    same(record(path))


def test_decimal_commas_units_below_and_latin_1(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    rows = [";".join(f"{value:.17e}".replace(".", ",") for value in line) for line in TABLE]
    head = ["Messung vom 3. März", "Abtastrate: 2,048 kHz", "Zeit;u1;u2;y1;y2;y3", "s;V;V;µm;µm;µm"]
    path.write_bytes("\r\n".join([*head, *rows, ""]).encode("latin-1"))
    found = record(path)
    same(found)
    assert [each.unit for each in found.channels] == ["V", "V", "µm", "µm", "µm"]


def test_a_rate_in_a_comment_stands_for_times(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    np.savetxt(path, TABLE[:, 1:], header=f"Sampling rate: 2048 Hz\n{HEAD.partition(',')[2]}", delimiter=",")
    same(record(path))


def test_times_of_few_digits_give_the_rate(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    np.savetxt(path, TABLE, header=HEAD, delimiter=",", fmt=["%.4f", *["%.18e"] * 5])  # steps of 0.4 and 0.5 ms
    same(record(path))


def test_parentheses_quotes_and_a_byte_order_mark(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    lines = ['"Time (s)","u1 (V)","gap left, ""a"" (um)"', *(f'"{t!r}","{u!r}","{y!r}"' for t, u, y in TABLE[:, [0, 1, 3]].tolist())]
    path.write_text("\n".join(lines), encoding="utf-8-sig")
    found = record(path)
    assert [(each.name, each.unit) for each in found.channels] == [("u1", "V"), ('gap left, "a"', "um")]
    np.testing.assert_array_equal(found.values, TABLE[:, [1, 3]])


def test_responses_in_columns(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    np.savetxt(path, np.column_stack([LINES, H[:, 0, 0].real, H[:, 0, 0].imag]), header="f [Hz],H_re,H_im", delimiter=",")
    np.testing.assert_array_equal(responses(path).values[:, 0, 0], H[:, 0, 0])


def test_numpy_reads_what_we_write(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    ours = awkward_record()
    write(path, ours)
    np.testing.assert_array_equal(np.loadtxt(path, delimiter=",", skiprows=4)[:, 1:], ours.values)
