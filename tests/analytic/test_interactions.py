"""Sobol indices and interactions against functions whose decompositions are known in closed form.

Ishigami and Homma's function sin x1 + a sin^2 x2 + b x3^4 sin x1 over (-pi, pi)^3 with a = 7, b = 0.1 (ISUMA 1990, 398): of its variance
V1 = (1 + b pi^4 / 5)^2 / 2, V2 = a^2 / 8 and V13 = 8 b^2 pi^8 / 225 nothing else is part. A product x1 x2 over (0, 1)^2: S1 = S2 = 3/7,
S12 = 1/7; over (-1, 1)^2: S12 = 1.
"""

import numpy as np
import pytest

from flexstage.studies.sweeps.effects import effects
from flexstage.studies.sweeps.execution.store import Results
from flexstage.studies.sweeps.interactions import paired_shares, second_order, single_effects
from flexstage.studies.sweeps.plan import Plan, Sampling, shares

PAIRS = ([0, 0, 1], [1, 2, 2])
SALTELLI = Plan(Sampling.SALTELLI, 3, 2048, pairs=True)


def ishigami(at):
    x = np.pi * (2.0 * at - 1.0)
    return np.sin(x[:, 0]) + 7.0 * np.sin(x[:, 1]) ** 2 + 0.1 * x[:, 2] ** 4 * np.sin(x[:, 0])


FIRST, SECOND, BOTH = 0.5 * (1.0 + 0.1 * np.pi**4 / 5.0) ** 2, 49.0 / 8.0, 8.0 * 0.01 * np.pi**8 / 225.0
TOTAL = FIRST + SECOND + BOTH


def found(plan, function, failing=()):
    at = shares(plan, 0, plan.designs)
    values = function(at)[:, None]
    values[list(failing)] = np.nan
    names = tuple("abcdef"[: plan.dimensions]), ("y",)
    return effects(Results(np.arange(len(at)), at, values, {}, names, (("1",) * plan.dimensions, ("1",)), len(at), {}, ""), plan)


@pytest.mark.parametrize("failing", [(), range(7, 8000, 501)])
def test_indices_of_first_second_and_total_order_are_those_in_closed_form(failing):
    """Rows with designs that failed are left out; the others tell the same."""
    seen = found(SALTELLI, ishigami, failing)
    np.testing.assert_allclose(seen.first[:, 0], np.array([FIRST, SECOND, 0.0]) / TOTAL, atol=0.015)
    np.testing.assert_allclose(seen.total[:, 0], np.array([FIRST + BOTH, SECOND, BOTH]) / TOTAL, atol=0.015)
    np.testing.assert_allclose(seen.pairs[PAIRS][:, 0], np.array([0.0, BOTH, 0.0]) / TOTAL, atol=0.015)


@pytest.mark.parametrize(
    "plan", [Plan(Sampling.SALTELLI, 3, 2048), *(Plan(each, 3, 4096) for each in (Sampling.SOBOL, Sampling.LATIN_HYPERCUBE))]
)
def test_pairs_are_told_by_any_plan(plan):
    """Bins miss what happens within them: shares come out lower, never where there are none."""
    seen = found(plan, ishigami).pairs[PAIRS][:, 0]
    assert 0.7 * BOTH / TOTAL < seen[1] < BOTH / TOTAL
    assert max(seen[0], seen[2]) < 0.005


def test_a_grid_is_decomposed_exactly():
    """On n levels a product over (-1, 1) is interaction alone, over (0, 1) what its mean squares say; what is left over is none."""
    centred = found(Plan(Sampling.GRID, 3, levels=(5, 4, 3)), lambda at: (2.0 * at[:, 0] - 1.0) * (2.0 * at[:, 1] - 1.0) + at[:, 2])
    assert centred.first[:2, 0] == pytest.approx([0.0, 0.0], abs=1e-12)
    assert centred.first[2, 0] + centred.pairs[0, 1, 0] == pytest.approx(1.0, rel=1e-12)
    product = found(Plan(Sampling.GRID, 2, levels=(41, 41)), lambda at: at[:, 0] * at[:, 1])
    assert product.first[0, 0] + product.first[1, 0] < 1.0
    smooth = found(Plan(Sampling.SALTELLI, 2, 4096, pairs=True), lambda at: at[:, 0] * at[:, 1])
    np.testing.assert_allclose([*smooth.first[:, 0], smooth.pairs[0, 1, 0]], np.array([3.0, 3.0, 1.0]) / 7.0, atol=0.01)


@pytest.mark.parametrize(
    "plan", [Plan(Sampling.MONTE_CARLO, 3, 512), Plan(Sampling.SALTELLI, 3, 256, pairs=True), Plan(Sampling.GRID, 3, levels=(4, 3, 5))]
)
def test_what_adds_up_does_not_interact(plan):
    """And its main effects are drawn without the scatter of the other variables."""
    seen = found(plan, lambda at: np.exp(at[:, 0]) + 3.0 * at[:, 1] ** 2 - 5.0 * at[:, 2])
    assert np.nanmax(np.abs(seen.pairs)) < 0.01
    slopes = np.diff(seen.means[2, :, 0]) / np.diff(seen.places[2])
    np.testing.assert_allclose(slopes[np.isfinite(slopes)], -5.0, rtol=0.2)


def test_what_cells_explain_by_chance_is_taken_off_as_in_an_analysis_of_variance():
    """Two levels each, eight designs a cell: a sum of squares of 32 c^2 with one degree of freedom, errors with 28 of 32 less 4 cells."""
    step, error, spread = 0.3, np.array([1.0, -1.0, 2.0, -2.0, 0.5, -0.5, 1.5, -1.5]), 4.0 * 15.0
    at = np.array([[i + 0.05 * k + 0.02 * j, j + 0.05 * k + 0.02 * i] for i in (0, 1) for j in (0, 1) for k in range(8)])
    values = np.array([step * (-1.0) ** (i + j) + error[k] for i in (0, 1) for j in (0, 1) for k in range(8)])[:, None]
    share = paired_shares(at, values, grid=False)[0, 1, 0]
    assert share == pytest.approx((32.0 * step**2 - spread / 28.0) / (32.0 * step**2 + spread), rel=1e-12)


def test_effects_of_uneven_bins_are_about_their_mean_over_the_designs():
    chance = np.random.default_rng(4)
    bins = [chance.choice(3, 60, p=[0.6, 0.3, 0.1]), chance.choice(2, 60, p=[0.8, 0.2])]
    own = [np.array([1.0, 4.0, -3.0]), np.array([2.0, 7.0])]
    values = own[0][bins[0]] + own[1][bins[1]]
    for effect, known, group in zip(single_effects(bins, values[:, None]), own, bins, strict=True):
        np.testing.assert_allclose(effect[:, 0], known - known[group].mean(), rtol=0.0, atol=1e-12)


def test_the_error_of_a_pair_that_only_adds_up_is_that_of_its_rows():
    """Of x1 + x2 a row is (a1 - b1) (b2 - a2)/V, of variance 1: the error is 1/n^(1/2), and the index 0 within four of them."""
    count = 4096
    first, second = np.random.default_rng(5).random((2, count, 2))
    swapped = [np.where(np.arange(2) == place, other, own) for own, other in ((first, second), (second, first)) for place in range(2)]
    blocks = np.stack([first, second, *swapped]).sum(axis=-1, keepdims=True)
    index, error = second_order(blocks, 2)
    assert error[0] == pytest.approx(1.0 / np.sqrt(count), rel=0.1)
    assert abs(index[0, 1, 0]) < 4.0 / np.sqrt(count)


def test_how_a_pair_acts_is_seen():
    """x1 x2 over (-1, 1): downwards where x2 is low, upwards where it is high."""
    (seen,) = found(Plan(Sampling.SOBOL, 2, 1024), lambda at: (2.0 * at[:, 0] - 1.0) * (2.0 * at[:, 1] - 1.0)).strongest
    slopes = np.mean(np.diff(seen.means, axis=1) / np.diff(seen.places), axis=1)
    np.testing.assert_allclose(slopes, 2.0 * (2.0 * seen.levels - 1.0), atol=0.15)
    assert seen.share > 0.9


def test_a_response_that_does_not_vary_has_no_effects():
    still = found(Plan(Sampling.LATIN_HYPERCUBE, 2, 64), lambda at: 14.0 + 1e-15 * at[:, 0])
    assert np.all(np.isnan(still.first))
    assert np.all(np.isnan(still.pairs))
    assert still.strongest == ()
