"""LAPACK, assignments and zeros without the rest of scipy: its results to the last bit; minima are where scipy finds them."""

import subprocess
import sys

import numpy as np
import pytest
import scipy

from flexstage.base import lapack
from flexstage.base.assignment import assignment
from flexstage.base.minimum import descend, lowest, root
from flexstage.control.study.runs import _REPEATED, _STUDENT


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


def test_assignments_are_those_of_scipy():
    random = np.random.default_rng(0)
    for shape in ((1, 1), (3, 7), (7, 3), (20, 20)):
        cost = random.integers(0, 4, shape).astype(float)
        np.testing.assert_array_equal(assignment(cost), scipy.optimize.linear_sum_assignment(cost))


def test_zeros_are_those_of_scipy():
    for place in np.linspace(0.1, 2.9, 9).tolist():
        found = root(lambda x, place=place: np.tanh(3.0 * (x - place)), 0.0, 3.0, within=1e-12)
        assert found == scipy.optimize.brentq(lambda x, place=place: np.tanh(3.0 * (x - place)), 0.0, 3.0, xtol=1e-12)
    with pytest.raises(ValueError, match="sign"):
        root(lambda x: x * x + 1.0, -1.0, 1.0, within=1e-9)


@pytest.mark.parametrize("sharp", [1.0, 30.0])
def test_minima_are_where_scipy_finds_them(sharp):
    """Logarithms of sums of exponentials: convex, and at a sharpness of 30 nearly with kinks."""
    random = np.random.default_rng(int(sharp))
    for size in (1, 2, 6):
        rows, start = random.standard_normal((4 * size, size)), random.standard_normal(size)
        rows -= np.mean(rows, axis=0)  # so that there is a minimum

        def soft(place, rows=rows):
            weights = scipy.special.softmax(sharp * rows @ place)
            return float(scipy.special.logsumexp(sharp * rows @ place)) / sharp + 0.01 * place @ place, rows.T @ weights + 0.02 * place

        place, value = descend(soft, start, within=1e-9)
        known = scipy.optimize.minimize(soft, start, jac=True, method="BFGS", options={"gtol": 1e-9})
        np.testing.assert_allclose(place, known.x, atol=1e-7)
        np.testing.assert_allclose([value, soft(place)[0]], known.fun, rtol=1e-13)


def test_a_descent_ends_on_a_kink_and_a_search_within_its_tolerance():
    place, _ = descend(lambda x: (float(np.sum(np.abs(x - 1.0))), np.sign(x - 1.0)), np.array([3.3, -2.2]), within=1e-9)
    np.testing.assert_allclose(place, 1.0, atol=1e-6)
    assert abs(lowest(lambda x: abs(x - 0.3), -1.0, 2.0, within=1e-9) - 0.3) < 1e-9


def test_students_t_is_that_of_scipy():
    assert scipy.special.stdtrit(_REPEATED - 1, 0.975) == _STUDENT


@pytest.mark.parametrize(
    ("asked", "package"),
    [
        ("from flexstage.base.lapack import pivoted_qr as f; f(numpy.eye(2))", "scipy.linalg"),
        ("from flexstage.base.assignment import assignment as f; f(numpy.eye(2))", "scipy.optimize"),
        ("from flexstage.base.minimum import root as f; f(lambda x: x - 1.0, 0.0, 3.0, within=1e-9)", "scipy.optimize"),
    ],
)
def test_the_rest_of_scipy_is_not_loaded(asked, package):
    subprocess.run([sys.executable, "-c", f"import sys, numpy; {asked}; assert {package!r} not in sys.modules"], check=True)
