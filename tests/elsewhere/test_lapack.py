"""LAPACK, sparse products and assignments without the rest of scipy: its results to the last bit."""

import subprocess
import sys

import numpy as np
import pytest
import scipy

from flexstage.base import lapack
from flexstage.base.assignment import assignment
from flexstage.base.sparse import Compressed


@pytest.mark.parametrize("order", ["C", "F"])
@pytest.mark.parametrize("size", [1, 2, 7, 33, 114])
def test_results_are_those_of_scipy(size, order):
    random = np.random.default_rng(size)
    matrix = np.array(random.standard_normal((size, size)), order=order)
    definite = np.array(matrix @ matrix.T + size * np.eye(size), order=order)
    root = scipy.linalg.cholesky(definite, lower=True)
    np.testing.assert_array_equal(lapack.cholesky(definite), root)
    for triangle, lower in ((root, True), (root.T, False)):
        for right in (matrix, matrix.T, matrix[0]):
            known = scipy.linalg.solve_triangular(triangle, right, lower=lower)
            np.testing.assert_array_equal(lapack.solve_triangular(triangle, right, lower=lower), known)
    few = min(3, size)
    known = scipy.linalg.eigh(definite, subset_by_index=[0, few - 1])[1]
    np.testing.assert_array_equal(lapack.lowest_shapes(definite, few), known)
    for each in (matrix, matrix[: size // 2 + 1], matrix[:, : size // 2 + 1]):
        for found, expected in zip(lapack.pivoted_qr(each), scipy.linalg.qr(each, pivoting=True), strict=True):
            np.testing.assert_array_equal(found, expected)


def test_a_matrix_that_is_not_definite_and_a_singular_triangle_are_refused():
    with pytest.raises(np.linalg.LinAlgError, match="not positive definite"):
        lapack.cholesky(np.array([[1.0, 0.0], [0.0, -1.0]]))
    with pytest.raises(np.linalg.LinAlgError, match="singular"):
        lapack.solve_triangular(np.zeros((2, 2)), np.ones(2), lower=True)


@pytest.mark.parametrize("kind", [np.int32, np.int64])
@pytest.mark.parametrize("size", [1, 7, 60])
def test_products_are_those_of_scipy(size, kind):
    random = np.random.default_rng(size)
    half = scipy.sparse.random_array((size, size), density=0.3, format="csr", rng=random)
    known = (half + half.T).tocsr()
    matrix = Compressed(known.indptr.astype(np.int64), known.indices.astype(kind), known.data, size)
    vectors = random.standard_normal((size, 3))
    for form in (vectors, np.asfortranarray(vectors)):
        np.testing.assert_array_equal(matrix @ form, known @ vectors)
        np.testing.assert_array_equal(matrix.symmetric_times(form), known @ vectors)
    few = np.where(np.arange(size)[:, None] % 3 == 1, vectors, 0.0)
    np.testing.assert_array_equal(matrix.symmetric_times(few), known[few.any(axis=1)].T @ few[few.any(axis=1)])
    np.testing.assert_allclose(matrix.symmetric_times(few), known @ few, rtol=0, atol=1e-14)


def test_vectors_of_another_length_are_refused():
    with pytest.raises(ValueError, match="vectors of 3 entries for a matrix of 2 columns"):
        Compressed(np.arange(3), np.arange(2), np.ones(2), 2) @ np.ones((3, 1))


def test_entries_of_a_row_stand_in_the_order_of_their_columns():
    random = np.random.default_rng(1)
    rows, values = random.integers(0, 7, 30), random.standard_normal(30)
    known = scipy.sparse.csr_array((values, (rows, np.arange(30))), (9, 30))
    found = Compressed.of_entries(rows, values, 9)
    for mine, other in ((found.starts, known.indptr), (found.columns, known.indices), (found.values, known.data)):
        np.testing.assert_array_equal(mine, other)


def test_assignments_are_those_of_scipy():
    random = np.random.default_rng(0)
    for shape in ((1, 1), (3, 7), (7, 3), (20, 20)):
        cost = random.integers(0, 4, shape).astype(float)
        np.testing.assert_array_equal(assignment(cost), scipy.optimize.linear_sum_assignment(cost))


@pytest.mark.parametrize(
    ("asked", "packages"),
    [
        ("from flexstage.base.lapack import pivoted_qr as f; f(numpy.eye(2))", {"scipy.linalg"}),
        ("from flexstage.base.assignment import assignment as f; f(numpy.eye(2))", {"scipy.optimize"}),
        (
            "from flexstage.base.sparse import Compressed as f; f(numpy.arange(3), numpy.arange(2), numpy.ones(2), 2) @ numpy.eye(2)",
            {"scipy.sparse"},
        ),
        ("from flexstage.solid.fea import contact, reduce", {"scipy.linalg", "scipy.sparse", "scipy.spatial"}),
    ],
)
def test_the_rest_of_scipy_is_not_loaded(asked, packages):
    code = f"import sys, numpy; {asked}; loaded = {packages!r} & set(sys.modules); assert not loaded, loaded"
    subprocess.run([sys.executable, "-c", code], check=True)
