"""Labelled matrices keep names, units and values on their way into other libraries."""

from __future__ import annotations

import numpy as np

import flexstage as fs

VALUES = np.arange(12.0).reshape(2, 2, 3)


def test_to_pandas() -> None:
    frame = fs.Matrix(VALUES[0], ("a", "b"), ("x", "y", "z"), "m").to_pandas()
    assert frame.loc["b", "z"] == 5.0
    assert list(frame.columns) == ["x", "y", "z"]


def test_to_xarray_keeps_batch_axes_and_units() -> None:
    array = fs.Matrix(VALUES, ("a", "b"), ("x", "y", "z"), "m").to_xarray()
    assert array.dims == ("batch 1", "row", "column")
    assert array.attrs["unit"] == "m"
    np.testing.assert_array_equal(array.sel(row="b", column="x").values, VALUES[:, 1, 0])


def test_to_json() -> None:
    document = fs.Matrix(VALUES[0], ("a", "b"), ("x", "y", "z"), "m").to_json()
    assert document == {"rows": ["a", "b"], "columns": ["x", "y", "z"], "unit": "m", "values": VALUES[0].tolist()}
