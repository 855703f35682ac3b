"""Results in other programs: CSV, pandas, xarray and MATLAB have the numbers of the document, under its names."""

from __future__ import annotations

import io

import numpy as np
import pytest
import scipy.io
from hypothesis import given
from hypothesis import strategies as st

from flexstage.analysis.lost_motion import LostMotion, lost_motion
from flexstage.analysis.random_response import Spectrum, random_response
from flexstage.base.document import plain
from flexstage.base.labelled import Matrix
from flexstage.base.record import SideBySide
from flexstage.base.sheet import Sheet, parts
from flexstage.cases.registry import case
from flexstage.models.ideal import ideal
from flexstage.models.lumped import lumped
from flexstage.show.matlab import to_mat
from flexstage.show.sheets import to_csv, to_pandas, to_xarray

STAGE = case("parallelogram")
MODEL = lumped(STAGE)


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
