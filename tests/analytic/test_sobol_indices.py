"""Effects of variables against the Ishigami function, whose indices are known in closed form (Ishigami and Homma, ISUMA 1990)."""

import numpy as np
import pytest

from flexstage.studies.sweeps.effects import Effects, effects
from flexstage.studies.sweeps.execution.store import Results
from flexstage.studies.sweeps.plan import Plan, Sampling, shares
from flexstage.studies.sweeps.show.tables import share_table

A, B = 7.0, 0.1
ALONE = np.array([0.5 * (1.0 + B * np.pi**4 / 5.0) ** 2, A**2 / 8.0, 0.0])
TOGETHER = B**2 * np.pi**8 * (1.0 / 18.0 - 1.0 / 50.0)
VARIANCE = ALONE.sum() + TOGETHER


def ishigami(sampling: Sampling, count: int, seed: int = 1) -> Effects:
    plan = Plan(sampling, 3, count=count, seed=seed)
    at = np.pi * (2.0 * shares(plan, 0, plan.designs) - 1.0)
    value = np.sin(at[:, 0]) + A * np.sin(at[:, 1]) ** 2 + B * at[:, 2] ** 4 * np.sin(at[:, 0])
    names, units = (("a", "b", "c"), ("y", "still")), (("", "", ""), ("", ""))
    made = Results(np.arange(len(at)), at, np.column_stack([value, np.ones(len(at))]), {}, names, units, len(at), {}, "")
    return effects(made, plan)


def test_indices_of_saltelli_plan():
    found = ishigami(Sampling.SALTELLI, 4096)
    assert found.total is not None
    np.testing.assert_allclose(found.first[:, 0], ALONE / VARIANCE, atol=0.015)
    np.testing.assert_allclose(found.total[:, 0], (ALONE + TOGETHER * np.array([1.0, 0.0, 1.0])) / VARIANCE, atol=0.01)
    assert np.all(np.isnan(found.first[:, 1]))  # what does not vary has no shares


@pytest.mark.parametrize("sampling", [Sampling.SOBOL, Sampling.LATIN_HYPERCUBE])
def test_correlation_ratios_of_other_plans(sampling):
    found = ishigami(sampling, 8192)
    assert found.total is None
    np.testing.assert_allclose(found.first[:, 0], ALONE / VARIANCE, atol=0.03)
    np.testing.assert_allclose(found.mean, [A / 2.0, 1.0], atol=0.05)
    np.testing.assert_allclose(found.deviation[0] ** 2, VARIANCE, rtol=4.0 * np.sqrt(2.5 / 8192))  # four standard errors, kurtosis 3.5


def test_a_handful_of_designs_tells_no_shares():
    found = ishigami(Sampling.LATIN_HYPERCUBE, 6)
    assert np.all(np.isnan(found.first))


def test_stated_standard_errors_are_the_scatter_of_the_indices():
    """Of the index that scatters most, over independent plans; the scatter of Sobol points is at most that of random ones."""
    found = [ishigami(Sampling.SALTELLI, 256, seed) for seed in range(40)]
    every = np.array([np.concatenate([each.first[:, 0], each.total[:, 0]]) for each in found])
    scatter = np.max(np.std(every, axis=0, ddof=1))
    assert 0.3 < scatter / np.mean([each.errors[0, 0] for each in found]) < 1.2


def test_correlation_ratios_are_freed_of_chance_as_in_one_way_analysis_of_variance():
    """Epsilon squared, 1 - MS_within / MS_total (Kelley, PNAS 21 (1935) 554), over bins of equal counts."""
    plan = Plan(Sampling.LATIN_HYPERCUBE, 1, count=96, seed=2)
    at = shares(plan, 0, plan.designs)
    value = at + np.random.default_rng(1).standard_normal(at.shape)
    found = effects(Results(np.arange(len(at)), at, value, {}, (("a",), ("y",)), (("",), ("",)), len(at), {}, ""), plan)
    bins = np.sum(np.isfinite(found.places[0]))
    groups = [value[rows, 0] for rows in np.array_split(np.argsort(at[:, 0]), bins)]
    within = sum(np.sum((each - np.mean(each)) ** 2) for each in groups) / (len(at) - bins)
    assert bins > 2
    assert found.first[0, 0] == pytest.approx(1.0 - within / np.var(value, ddof=1), rel=1e-12)


def test_what_a_variable_leaves_unexplained_is_no_interaction_alone():
    """A line over two bins is a step: three quarters of its variance; the note on the remainder names variation within bins."""
    plan = Plan(Sampling.SOBOL, 1, count=16)
    at = shares(plan, 0, 16)
    found = effects(Results(np.arange(16), at, at, {}, (("x",), ("y",)), (("m",), ("m",)), 16, {}, ""), plan)
    assert found.first[0, 0] == pytest.approx(0.75, abs=0.05)
    assert "variation within bins" in share_table(found).notes[0]
