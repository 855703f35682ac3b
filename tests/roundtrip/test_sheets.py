"""Results in other programs: CSV, pandas, xarray and MATLAB have the numbers of the document, under its names."""

from __future__ import annotations

import csv
import functools
import io
import re
import zipfile
from xml.etree.ElementTree import Element, fromstring

import numpy as np
import pytest
import scipy.io
from hypothesis import given
from hypothesis import strategies as st

import flexstage
from flexstage.analysis.dynamics.random_response import Spectrum, random_response
from flexstage.analysis.linear_statics.lost_motion import LostMotion, lost_motion
from flexstage.base.labelled import Matrix
from flexstage.base.record import SideBySide
from flexstage.base.storage.document import plain
from flexstage.base.storage.sheet import Sheet, parts
from flexstage.cases.registry import case
from flexstage.models.ideal import ideal
from flexstage.models.lumped import lumped
from flexstage.show.matlab import to_mat
from flexstage.show.sheets import to_csv, to_pandas, to_xarray
from flexstage.show.workbook import sheet_names, to_xlsx
from tests.conftest import examples

STAGE = case("parallelogram")
MODEL = lumped(STAGE)


def test_complex_values_have_a_column_for_each_part() -> None:
    (sheet,) = (part for path, part in parts({"modes": [{"residue": 3.0 - 4.0j}, {"residue": 1.0j}]}) if path == "modes")
    assert isinstance(sheet, Sheet)
    assert sheet.heads == {"mode": (1, 2), "residue_real": (3.0, 0.0), "residue_imaginary": (-4.0, 1.0)}


@pytest.fixture(scope="module")
def lost() -> LostMotion:
    return lost_motion(ideal(STAGE), MODEL)


NAMES = st.text("ab/.1", min_size=1, max_size=3)
LEAVES = st.none() | st.booleans() | st.floats(allow_nan=False, allow_infinity=False) | st.text("ab", max_size=2)
DOCUMENTS = st.recursive(LEAVES, lambda inner: st.lists(inner, max_size=3) | st.dictionaries(NAMES, inner, max_size=3), max_leaves=12)


def numbers(value: object) -> list[float]:
    """The numbers that a document holds."""
    if isinstance(value, dict):
        return numbers(list(value.values()))
    return [each for item in value for each in numbers(item)] if isinstance(value, list) else [value] if isinstance(value, float) else []


def cells(result: object) -> list[float]:
    """The numbers that the parts of a result hold."""
    found = [part for _, part in parts(result)]
    columns = [list(values) for part in found if isinstance(part, Sheet) for values in part.columns.values()]
    return numbers(columns + [part.values.tolist() for part in found if isinstance(part, Matrix)])


def test_no_number_of_a_result_is_lost(lost: LostMotion) -> None:
    assert sorted(cells(lost)) == sorted(numbers(plain(lost)))


@given(st.dictionaries(NAMES, DOCUMENTS, max_size=4))
def test_no_number_of_a_document_is_lost(document: dict[str, object]) -> None:
    assert sorted(cells(document)) == sorted(numbers(document))
    assert len(to_csv(document)) == len(list(parts(document)))


def test_records_in_records_repeat_their_owners_name(lost: LostMotion) -> None:
    budget = dict(parts(lost))["actuators.budget"]
    assert isinstance(budget, Sheet)
    assert set(budget.names["actuator"]) == {"B"}
    assert dict(zip(budget.names["name"], budget.heads["budget"], strict=True)) == plain(lost)["actuators"]["B"]["budget"]


def test_a_response_is_labelled_on_all_axes() -> None:
    found = random_response(MODEL, ("platform.x", "platform.y"), {"ground.x": Spectrum(1e-18)}, (1.0, 9.0))
    array = to_xarray(found)["density"]["density"]
    assert array.dims == ("frequency_hz", "output")
    np.testing.assert_array_equal(array.sel(output="platform.y"), found.density[:, 1])
    stored = scipy.io.loadmat(io.BytesIO(to_mat(found)), simplify_cells=True)["density"]
    np.testing.assert_array_equal(stored["density"], found.density)
    np.testing.assert_array_equal(stored["frequency_hz"], found.frequencies)
    assert to_pandas(found)["outputs"].loc["platform.x", "rms"] == found.rms[0]


def _xml(files: zipfile.ZipFile, name: str) -> Element:
    return fromstring(files.read(f"xl/{name}"))  # noqa: S314 (written a moment ago)


def workbook(data: bytes) -> dict[str, dict[tuple[int, int], object]]:
    """The cells of a workbook by sheet, row and column, from the XML that it consists of."""
    space = {"": "http://schemas.openxmlformats.org/spreadsheetml/2006/main"}
    with zipfile.ZipFile(io.BytesIO(data)) as files:
        assert {each.date_time for each in files.infolist()} == {(1980, 1, 1, 0, 0, 0)}
        strings = _xml(files, "sharedStrings.xml").findall("si", space)
        texts = ["".join(each.itertext()) for each in strings]
        names = [each.get("name", "") for each in _xml(files, "workbook.xml").find("sheets", space) or ()]
        sheets = [_xml(files, f"worksheets/sheet{number}.xml") for number in range(1, len(names) + 1)]
    found: dict[str, dict[tuple[int, int], object]] = {name: {} for name in names}
    for name, sheet in zip(names, sheets, strict=True):
        for cell in sheet.iterfind(".//c", space):
            value = cell.findtext("v", None, space)
            letters, row = re.fullmatch(r"([A-Z]+)(\d+)", cell.get("r", "")).groups()
            column = functools.reduce(lambda total, letter: 26 * total + ord(letter) - 64, letters, 0)
            if value is not None:
                sort = cell.get("t", "n")
                found[name][int(row) - 1, column - 1] = {"s": lambda v: texts[int(v)], "b": lambda v: v == "1", "n": float}[sort](value)
    return found


def test_a_workbook_has_the_cells_of_the_csv_files_and_units_below_its_heads(lost: LostMotion) -> None:
    found = workbook(to_xlsx(lost))
    assert to_xlsx(lost) == to_xlsx(lost)
    *sheets, last = found
    assert last == "provenance"
    assert found[last][2, 1] == flexstage.__version__
    assert len(sheets) == len(to_csv(lost))
    for name, (path, text) in zip(sheets, to_csv(lost).items(), strict=True):
        assert (path or "result").endswith(name)
        head, *rows = csv.reader(io.StringIO(text))
        cells = found[name]
        units = [cells.get((1, column), "") for column in range(len(head))]
        heads = [cells[0, column] for column in range(len(head))]
        assert [f"{each} [{unit}]" if f"[{unit}]" in old else each for each, unit, old in zip(heads, units, head, strict=True)] == head
        shown = [[cells.get((row, column), "") for column in range(len(head))] for row in range(2, 2 + len(rows))]
        for read, written in zip(shown, rows, strict=True):
            same = [
                float(old) == pytest.approx(new, rel=1e-15) if isinstance(new, float) else old == new
                for new, old in zip(read, written, strict=True)
            ]
            assert all(same), (read, written)
    assert any(isinstance(value, float) for value in found["actuators"].values())


@given(st.dictionaries(NAMES, DOCUMENTS, max_size=4))
@examples(8)
def test_no_number_of_a_document_is_lost_in_its_workbook(document: dict[str, object]) -> None:
    heads = [values for _, part in parts(document) if isinstance(part, Sheet) for values in part.heads.values()]
    written = [float(each) for values in heads for each in values if isinstance(each, (int, float)) and not isinstance(each, bool)]
    texts = {str(each) for each in written if abs(each) > 9.99e307}  # more than a cell takes
    below = [each for sheet in workbook(to_xlsx(document)).values() for (row, _), each in sheet.items() if row > 1]
    read = [float(each) for each in below if isinstance(each, float) or each in texts]
    np.testing.assert_allclose(sorted(read), sorted(written), rtol=1e-15)


@given(st.lists(st.text("aA[]:*?/\\'é. ", max_size=40), max_size=6))
def test_names_of_sheets_are_those_that_excel_takes(paths: list[str]) -> None:
    names = sheet_names([*paths, "History"])
    assert len({name.lower() for name in names}) == len(paths) + 1
    assert all(1 <= len(name) <= 31 and not set("[]:*?/\\") & set(name) and "'" not in (name[0], name[-1]) for name in names)
    assert "history" not in {name.lower() for name in names}


def test_formulas_and_what_is_too_long_stay_texts() -> None:
    found = workbook(to_xlsx({"a": "=1+1", "b": "http://x", "c": "x" * 40_000, "d": float("inf"), "e": None, "f": True}))
    values = list(found["result"].values())[6:]
    assert (2, 4) not in found["result"]
    assert (values[0], values[1], len(str(values[2])), values[3], values[4]) == ("=1+1", "http://x", 32_767, "inf", True)


def test_units_of_a_matrix_stand_where_they_are_alike() -> None:
    values = np.array([[1.0, 2.0], [3.0, np.nan]])
    rows, columns = ("a", "b"), ("x", "rx")
    assert to_csv(Matrix(values, rows, columns, "m"))[""].splitlines() == ["row,x [m],rx [m]", "a,1.0,2.0", "b,3.0,"]
    across = Matrix(values, rows, columns, (("1", "m/rad"),) * 2)
    assert to_csv(across)[""].splitlines()[0] == "row,x,rx [m/rad]"
    down = Matrix(values, rows, columns, (("m", "m"), ("rad", "rad")))
    assert to_csv(down)[""].splitlines()[:2] == ["row,unit,x,rx", "a,m,1.0,2.0"]
    mixed = Matrix(values, rows, columns, (("N/m", "N/rad"), ("N m/m", "N m/rad")))
    assert to_csv(mixed)[""].splitlines()[1:3] == ["a,x,N/m,1.0", "a,rx,N/rad,2.0"]


def test_results_stand_together_with_all_their_reasons() -> None:
    both = SideBySide(({"gain": 1.0, "reasons": {"a": "first"}}, {"loss": {"B1": 0.5}, "reasons": {"b": "second"}}))
    assert plain(both) == {"gain": 1.0, "loss": {"B1": 0.5}, "reasons": {"a": "first", "b": "second"}}
    assert to_csv(both) == {"": "gain\r\n1.0\r\n", "loss": "name,loss\r\nB1,0.5\r\n"}


@pytest.mark.parametrize("name", ["=cmd|'/c calc'!A0", "+1+1", "-1+1", "@SUM(1)", "\t=1"])
def test_no_text_of_a_csv_file_is_a_formula(name: str) -> None:
    found = to_csv({"loss": {name: -0.5}, "labels": Matrix(np.ones((1, 1)), (name,), (name,), "m")})
    cells = [cell for text in found.values() for row in csv.reader(io.StringIO(text)) for cell in row]
    assert cells.count(f"'{name}") + cells.count(f"'{name} [m]") == 3
    assert "-0.5" in cells
