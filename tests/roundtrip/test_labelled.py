"""Labelled matrices keep names, units and values on their way into other libraries."""

from __future__ import annotations

import numpy as np

from flexstage.base.labelled import Matrix

VALUES = np.arange(12.0).reshape(2, 2, 3)


def test_to_pandas() -> None:
    frame = Matrix(VALUES[0], ("a", "b"), ("x", "y", "z"), "m").to_pandas()
    assert frame.loc["b", "z"] == 5.0
    assert list(frame.columns) == ["x", "y", "z"]


def test_to_xarray_keeps_batch_axes_and_units() -> None:
    array = Matrix(VALUES, ("a", "b"), ("x", "y", "z"), "m").to_xarray()
    assert array.dims == ("batch 1", "row", "column")
    assert array.attrs["unit"] == "m"
    np.testing.assert_array_equal(array.sel(row="b", column="x").values, VALUES[:, 1, 0])


def test_to_json() -> None:
    document = Matrix(VALUES[0], ("a", "b"), ("x", "y", "z"), "m").to_json()
    assert document == {"rows": ["a", "b"], "columns": ["x", "y", "z"], "unit": "m", "values": VALUES[0].tolist()}


def test_as_text_units_stand_as_far_out_as_they_are_alike() -> None:
    names = (("a", "b"), ("x", "y"))
    values = np.array([[1.0, -0.0], [2.5, 1e-9]])
    one, columns, rows, mixed = (
        str(Matrix(values, *names, unit))
        for unit in ("m", (("m", "1"), ("m", "1")), (("m", "m"), ("rad", "rad")), (("m", "rad"), ("rad", "m")))
    )
    assert one.splitlines() == ["   x [m]  y [m]", "a      1      0", "b    2.5  1e-09"]
    assert columns.splitlines()[0].split() == ["x", "[m]", "y"]
    assert [line.split()[:2] for line in rows.splitlines()[1:]] == [["a", "[m]"], ["b", "[rad]"]]
    assert mixed.splitlines()[2].split() == ["b", "2.5", "rad", "1e-09", "m"]


def test_as_text_a_batch_shows_its_first_design_and_nothing_is_a_line() -> None:
    assert str(Matrix(VALUES, ("a", "b"), ("x", "y", "z"), "m")) == str(Matrix(VALUES[0], ("a", "b"), ("x", "y", "z"), "m"))
    assert str(Matrix(np.zeros((0, 2)), (), ("x", "y"), ())).split() == ["x", "y"]
