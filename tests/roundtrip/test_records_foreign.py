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
from flexstage.experiment.records.options import Arrays, Kind, Options
from flexstage.experiment.records.record import Record, Responses, in_memory
from tests.roundtrip.records import awkward_record, awkward_responses, write_version_73
from tests.roundtrip.records import write_form as write

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


def of(**names: str) -> Options:
    """The arrays that are meant, names of one meaning with blanks between."""
    return Options(arrays=Arrays(**{meaning: tuple(listed.split()) for meaning, listed in names.items()}))


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
    path.write_bytes(path.read_bytes()[:200])
    if binary and even:  # left in the file
        with pytest.raises(DesignError, match="the file shrank during reading"):
            _ = found.values


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


@pytest.mark.parametrize("form", ["uff", "uff-ascii"])
def test_pyuff_reads_what_we_write(form: str, tmp_path: Path) -> None:
    path = tmp_path / "a.uff"
    ours = in_memory(awkward_record().channels, RATE, np.random.default_rng(2).standard_normal((LENGTH, 6)))
    write(path, ours, form)
    theirs = pyuff.UFF(str(path)).read_sets()
    assert [each["id1"] for each in theirs] == list(ours.names)
    assert [each["ordinate_axis_units_lab"] or "NONE" for each in theirs] == [each.unit or "NONE" for each in ours.channels]
    np.testing.assert_allclose(np.stack([each["data"] for each in theirs], axis=-1), ours.values, rtol=0.0 if form == "uff" else 5.1e-13)
    np.testing.assert_allclose(theirs[0]["x"][-1], (LENGTH - 1) / RATE, rtol=1e-6)


@pytest.mark.parametrize("form", ["uff", "uff-ascii"])
def test_pyuff_reads_our_responses(form: str, tmp_path: Path) -> None:
    path = tmp_path / "a.uff"
    draw = awkward_responses(coherence=False)
    ours = Responses(draw.frequencies, draw.outputs, draw.inputs, np.exp(1j * np.arange(320.0)).reshape(40, 4, 2))
    write(path, ours, form)
    theirs = pyuff.UFF(str(path)).read_sets()
    values = np.stack([each["data"] for each in theirs], axis=-1).reshape(40, 4, 2)
    np.testing.assert_allclose(values, ours.values, rtol=0.0 if form == "uff" else 1e-11, atol=1e-12 if form == "uff-ascii" else 0.0)
    np.testing.assert_allclose(theirs[0]["x"], ours.frequencies, rtol=1e-6)


# --- MAT files ---


FORM = {"samples": np.hstack([U, Y]), "rate": RATE, "names": np.array(["u1", "u2", "y1", "y2", "y3"], dtype=object)}
U_Y = of(samples="u y", step="dt")
MAT: dict[str, tuple[dict[str, Any], Options]] = {
    "the documented form": (FORM, Options()),
    "columns and a time vector": ({"time": TIMES[:, None], "u": U, "y": Y}, of(samples="u y")),
    "rows and a step": ({"dt": 1 / RATE, "u": U.T, "y": Y.T}, U_Y),
    "mixed orientations and a rate": ({"t": TIMES, "fs": np.int32(2048), "u": U.T, "y": Y}, of(samples="u y", time="t", rate="fs")),
    "one variable a channel": (
        {"t": TIMES[None], "u1": U[:, 0], "u2": U[:, 1], "y1": Y[:, 0], "y2": Y[None, :, 1], "y3": Y[:, 2]},
        of(samples="u? y?", time="t"),
    ),
    "a structure": ({"test": {"u": U, "y": Y, "Fs": RATE, "operator": "someone"}}, of(samples="test.u test.y", rate="test.Fs")),
    "big-endian": ({"dt": np.array(1 / RATE, ">f8"), "u": U.astype(">f8"), "y": Y.astype(">f8")}, U_Y),
}


@pytest.mark.parametrize("layout", MAT, ids=list(MAT))
@pytest.mark.parametrize("compressed", [False, True])
def test_mat_files_of_scipy(layout: str, compressed: bool, tmp_path: Path) -> None:
    path = tmp_path / "a.mat"
    values, options = MAT[layout]
    scipy.io.savemat(path, values, do_compression=compressed)
    same(record(path, options))


def test_mat_version_4(tmp_path: Path) -> None:
    path = tmp_path / "a.mat"
    scipy.io.savemat(path, {"dt": 1 / RATE, "u": U, "y": Y}, format="4")
    same(record(path, U_Y))


def test_mat_single_precision_and_integers(tmp_path: Path) -> None:
    path = tmp_path / "a.mat"
    counts = np.arange(LENGTH, dtype=np.int16)[:, None] % 100
    scipy.io.savemat(path, {"t": TIMES.astype(np.float32), "u": U.astype(np.float32), "y": counts})
    found = record(path, of(samples="u y", time="t"))
    np.testing.assert_array_equal(found.values, np.hstack([U.astype(np.float32), counts]))
    assert found.rate == RATE


def test_names_and_units_in_lists_that_are_named(tmp_path: Path) -> None:
    path = tmp_path / "a.mat"
    cells = np.array(["drive", "S1"], dtype=object)
    scipy.io.savemat(path, {"fs": RATE, "data": U, "channel_names": cells, "unit": np.array(["Volts", "micron"], dtype=object)})
    found = record(path, of(samples="data", rate="fs", names="channel_names", units="unit"))
    assert [(each.name, each.unit) for each in found.channels] == [("drive", "V"), ("S1", "um")]
    scipy.io.savemat(path, {"rate": RATE, "samples": U[:, :1], "names": cells})
    with pytest.raises(DesignError, match=r"wrong number of names \(got 2: drive, S1; expected 1"):
        read(path)


def test_mat_responses(tmp_path: Path) -> None:
    path = tmp_path / "a.mat"
    for name, values in {"inputs last": H, "frequencies last": np.moveaxis(H, 0, -1), "frequencies between": np.moveaxis(H, 0, 1)}.items():
        scipy.io.savemat(path, {"freq": LINES, "FRF": values, "coh": np.full(values.shape, 0.9)})
        found = responses(path, of(frequencies="freq", responses="FRF", coherence="coh"))
        np.testing.assert_array_equal(found.values, H, err_msg=name)
        assert found.coherence is not None
        assert found.coherence.shape == H.shape


def test_mat_responses_one_a_variable(tmp_path: Path) -> None:
    path = tmp_path / "a.mat"
    scipy.io.savemat(path, {"f": LINES[None], "H_x": H[:, 0, 0], "H_y": H[:, 1, 0], "cross_spec": H[:, 2, 0]})
    found = responses(path, of(frequencies="f", responses="H_*"))
    assert [each.name for each in found.outputs] == ["H_x", "H_y"]
    np.testing.assert_array_equal(found.values[:, :, 0], H[:, :2, 0])


def test_a_file_with_both_asks_which_is_meant(tmp_path: Path) -> None:
    path = tmp_path / "a.mat"
    scipy.io.savemat(path, FORM | {"frequencies": LINES, "responses": H})
    with pytest.raises(
        DesignError, match=r"contains a record \(u1, u2, y1, y2, y3; 500 samples\) and frequency responses \(64 frequencies\)"
    ):
        read(path)
    same(record(path, Options(kind=Kind.RECORD)))
    assert responses(path, Options(kind=Kind.RESPONSES)).values.shape == H.shape


def test_arrays_of_unknown_meaning_are_listed_with_the_option_that_names_them(tmp_path: Path) -> None:
    path = tmp_path / "a.mat"
    scipy.io.savemat(path, {"dt": 1 / RATE, "u": U, "H": H, "note": "run 2"})
    told = (
        r"no array \"samples\" or \"responses\".*dt = 0.000488281, u \(500, 2\), H \(64, 3, 2\) complex.*Assign the arrays \(option array\)"
    )
    with pytest.raises(DesignError, match=told):
        read(path)
    with pytest.raises(DesignError, match=r"times and rate are missing.*dt = 0.000488281.*\"step=...\""):
        read(path, of(samples="u"))
    with pytest.raises(DesignError, match=r"step=dz: unknown array"):
        read(path, of(samples="u", step="dz"))
    with pytest.raises(DesignError, match=r"frequencies are missing"):
        read(path, of(responses="H"))


def test_mat_73_structures_cells_and_complex(tmp_path: Path) -> None:
    test = {"u": U, "y": Y.T, "fs": RATE, "comment": "white noise"}
    units = ("V", "V", "um", "um", "um")
    path = write_version_73(tmp_path / "a.mat", {"test": test, "time": TIMES, "units": units, "freq": LINES, "H1": H})
    found = record(path, of(samples="test.u test.y", rate="test.fs"))
    same(found)
    assert [each.unit for each in found.channels] == ["V", "V", "um", "um", "um"]
    np.testing.assert_array_equal(responses(path, of(frequencies="freq", responses="H1")).values, H)


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
                one = file.create_dataset(f"run 1/{kind}/{number}", data=column)
                one.attrs["names"] = f"{'u' if kind == 'inputs' else 'y'}{number + 1}"
                one.attrs["units"] = np.bytes_(unit)
    found = record(path, Options(arrays=Arrays(samples=("run 1/*",), rate=("sampling_rate",))))
    same(found)
    assert [each.unit for each in found.channels] == ["V", "V", "um", "um", "um"]
    with h5py.File(path, "r+") as file:
        del file["run 1/inputs/1"].attrs["names"], file["run 1/outputs/2"].attrs["units"]
    found = record(path, Options(arrays=Arrays(samples=("run 1/*",), rate=("sampling_rate",))))
    assert found.names == ("u1", "run 1/inputs/1", "y1", "y2", "y3")
    assert [each.unit for each in found.channels] == ["V", "V", "um", "um", ""]


def test_hdf_transposed_big_endian_float32_and_times_in_ms(tmp_path: Path) -> None:
    path = tmp_path / "a.hdf5"
    with h5py.File(path, "w") as file:
        file.create_dataset("Time", data=1000.0 * TIMES).attrs["units"] = "ms"
        file["u"] = U.T.astype(">f4")
        file.create_dataset("y", data=Y, chunks=(64, 3), compression="gzip")
    found = record(path, of(samples="u y", time="Time"))
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
    same(record(path, of(samples="log/table/u? log/table/y?", time="log/table/time")))


def test_hdf_responses_with_lists_of_names(tmp_path: Path) -> None:
    path = tmp_path / "a.h5"
    with h5py.File(path, "w") as file:
        file["frf/frequency"] = LINES
        file["frf/H"] = H
        file["output_names"] = ["S1", "S2", "S3"]
        file["input_names"] = ["B1", "B2"]
    found = responses(path, of(frequencies="frf/frequency", responses="frf/H"))
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
    head = ["Messung vom 3. März", "Zeit;u1;u2;y1;y2;y3", "s;V;V;µm;µm;µm"]
    path.write_bytes("\r\n".join([*head, *rows, ""]).encode("latin-1"))
    with pytest.raises(DesignError, match=r"no column contains times \(columns: Zeit, u1.*array \"time=...\""):
        read(path)
    found = record(path, of(time="Zeit"))
    same(found)
    assert [each.unit for each in found.channels] == ["V", "V", "µm", "µm", "µm"]


def test_times_of_few_digits_give_the_rate(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    np.savetxt(path, TABLE, header=HEAD, delimiter=",", fmt=["%.4f", *["%.18e"] * 5])  # steps of 0.4 and 0.5 ms
    same(record(path))


def test_parentheses_quotes_and_a_byte_order_mark(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    lines = ['"Time (s)","u1 (V)","gap left, ""a"" (um)"', *(f'"{t!r}","{u!r}","{y!r}"' for t, u, y in TABLE[:, [0, 1, 3]].tolist())]
    path.write_text("\n".join(lines), encoding="utf-8-sig")
    found = record(path, of(time="Time"))
    assert [(each.name, each.unit) for each in found.channels] == [("u1", "V"), ('gap left, "a"', "um")]
    np.testing.assert_array_equal(found.values, TABLE[:, [1, 3]])


def test_responses_in_columns(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    columns = np.column_stack([LINES / 1e3, *(part for row in range(2) for part in (H[:, row, 0].real, H[:, row, 0].imag))])
    np.savetxt(path, columns, header="f [kHz],x re [um/V],x im [um/V],y_re [um/V],y_im [um/V]", delimiter=",")
    found = responses(path, of(frequencies="f"))
    np.testing.assert_array_equal(found.values[:, :, 0], H[:, :2, 0])
    np.testing.assert_allclose(found.frequencies, LINES, rtol=1e-15)
    assert ([each.name for each in found.outputs], found.units) == (["x", "y"], (("um/V",), ("um/V",)))
    np.savetxt(path, columns[:, :4], header="frequency [Hz],x re,x im,y re", delimiter=",")
    with pytest.raises(
        DesignError, match=r"its columns do not form complete responses \(columns: x re, x im, y re\)\. Write real and imaginary part"
    ):
        read(path)


def test_numpy_reads_what_we_write(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    ours = awkward_record()
    write(path, ours)
    np.testing.assert_array_equal(np.loadtxt(path, delimiter=",", skiprows=2)[:, 1:], ours.values)
