"""Series of noise have the spectra they are made of, and a simulated loop the variances of its noise budget."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import scipy

from flexstage.analysis.dynamics.random_response import Rate, Spectrum
from flexstage.base.finding import DesignError
from flexstage.base.number import Table
from flexstage.cases.parallelogram import parallelogram
from flexstage.control.example import integral
from flexstage.control.noise import noise_budget
from flexstage.control.plant_models.electronics import AmplifierSettings, GaugeSettings, sampling_chain
from flexstage.control.plant_models.plants import plant
from flexstage.control.simulation.machine import machine
from flexstage.control.simulation.noise import noise_series, series
from flexstage.control.simulation.run import simulate
from flexstage.control.systems.closed import loop
from tests.laws.shared import ideal, lumped

STEP = 1e-4
RATE = 40e3
"""So fast that the lowest resonance, 1.5 kHz, feels the straight lines between samples of the floor by 0.5 % only."""
SPECTRA = {
    "white": Spectrum(2e-18),
    "table": Spectrum(np.array([1e-16, 1e-18, 1e-20]), np.array([20.0, 200.0, 2000.0])),
    "acceleration": Spectrum(np.array([1e-8, 1e-8]), np.array([10.0, 1000.0]), Rate.ACCELERATION),
}


@pytest.mark.parametrize("name", SPECTRA)
def test_periodograms_are_the_spectra(name):
    """Welch's averages of n segments scatter by 1/n^(1/2): mean ratio 1, none beyond five deviations."""
    values = series(SPECTRA[name], 400_000, STEP, (3,))
    frequencies, density = scipy.signal.welch(values, 1.0 / STEP, nperseg=4000, noverlap=0, window="hann", detrend=False)
    inside = (frequencies > 30.0) & (frequencies < 900.0)
    ratio = density[inside] / SPECTRA[name].at(frequencies[inside])
    assert np.mean(ratio) == pytest.approx(1.0, abs=0.01)
    assert np.max(np.abs(ratio - 1.0)) < 5.0 / 10.0


def test_series_are_gaussian_and_their_own():
    one, again, other = (series(SPECTRA["white"], 100_000, STEP, (seed,)) for seed in (1, 1, 2))
    assert np.array_equal(one, again)
    assert abs(np.corrcoef(one, other)[0, 1]) < 5.0 / 100_000**0.5
    scaled = one / np.std(one)
    assert np.mean(scaled**4) == pytest.approx(3.0, abs=0.1)
    assert np.std(one) == pytest.approx((2e-18 * 5e3) ** 0.5, rel=0.02)


def test_names_and_seeds_of_noise():
    one = small_loop().plant
    found, more = noise_series(one, {}, 100, seed=4), noise_series(one, {"ground.x": SPECTRA["white"]}, 100, seed=4)
    assert all(np.array_equal(found[name], more[name]) for name in found)  # what else there is does not matter
    with pytest.raises(DesignError, match=r"ground\.q: unknown motion of the ground"):
        noise_series(one, {"ground.q": SPECTRA["white"]}, 100)
    with pytest.raises(DesignError, match="the loop is continuous"):
        noise_series(replace(one, hardware=replace(one.hardware, rate=None, delay=0.0)), {}, 100)


def small_loop(resolution: float = 2e-10):
    stage = parallelogram()
    gauges = GaugeSettings(noise_density=1e-11, resolution=resolution, filter_order=2, filter_corner=6000.0)
    amplifiers = AmplifierSettings(bandwidth=1000.0, noise_density=1e-5)
    given = sampling_chain(stage, rate=RATE, delay=15e-6, gauges=gauges, amplifiers=amplifiers)
    one = plant(lumped(stage), ideal(stage), given, modes=3)
    return loop(one, integral(one, 100.0))


KINDS = {"floor": ("ground.",), "gauge noise": ("noise.S",), "amplifier noise": ("noise.B",), "all": ("ground.", "noise.")}


@pytest.mark.parametrize(
    "kind", [*(pytest.param(each, marks=pytest.mark.full) for each in ("floor", "amplifier noise")), "gauge noise", "all"]
)
def test_the_simulated_variance_is_that_of_the_budget(kind):
    """Of each source alone, and of all with rounding: eight seeds, their mean within four deviations (and 1 % for straight lines)."""
    closed = small_loop()
    floor = {"ground.x": Spectrum(np.array([1e-18, 1e-21]), np.array([5.0, 1500.0]))}
    count = 10_000
    outputs = ("relative.x", "platform.x")
    budget = noise_budget(closed, floor, (0.5 * RATE / count, 0.5 * RATE), outputs)
    known = machine(closed.plant, closed.controller, motions=outputs)
    known = known if kind == "all" else replace(known, resolution=np.zeros(1))
    squares = []
    for seed in range(8):
        every = noise_series(closed.plant, floor, count, seed)
        own = {name: values for name, values in every.items() if name.startswith(KINDS[kind])}
        found = simulate(known, np.zeros((count, 1)), own).motions[1000:]
        squares.append(np.mean(found**2, axis=0))
    expected = budget.rms**2 if kind == "all" else np.array([budget.by_kind.at(output, kind) for output in outputs])
    mean, deviation = np.mean(squares, axis=0), np.std(squares, axis=0, ddof=1) / 8.0**0.5
    assert np.all(np.abs(mean - expected) < 4.0 * deviation + 0.01 * expected), (mean / expected, deviation / expected)
    assert np.all(deviation < 0.1 * expected)


def test_densities_of_white_sources_add_up_to_their_mean_squares():
    """One-sided, up to half the sampling rate; by trapezoids over the budget's own frequencies, so to a hundredth."""
    budget = noise_budget(small_loop(), {}, (0.1, 0.5 * RATE), ("relative.x", "platform.x"))
    assert len(budget.sources) > 2
    widths = np.diff(budget.frequencies)[:, None, None]
    areas = np.sum(0.5 * (budget.density[1:] + budget.density[:-1]) * widths, axis=0)
    np.testing.assert_allclose(areas, budget.squares, rtol=0.01)
    beyond = noise_budget(small_loop(), {}, (0.1, 2.0 * RATE), ("relative.x", "platform.x"))
    assert np.all(beyond.squares == budget.squares)
    assert not np.any(beyond.density[beyond.frequencies > 0.5 * RATE])  # aliased below, and counted once


@pytest.mark.parametrize("density", [1e-13, 1e-11])
def test_readings_move_from_sample_to_sample_as_the_budget_says(density):
    """Of the loop without rounding, all its noise simulated: eight seeds, their mean within four deviations."""
    closed = small_loop()
    sensors = Table({"S": replace(closed.plant.hardware.sensors["S"], noise_density=density)})
    plant = replace(closed.plant, hardware=replace(closed.plant.hardware, sensors=sensors))
    closed = loop(plant, closed.controller)
    floor, count = {"ground.x": Spectrum(np.array([1e-18, 1e-21]), np.array([5.0, 1500.0]))}, 4000
    budget = noise_budget(closed, floor, (0.5 * RATE / count, 0.5 * RATE), ("relative.x",))
    known = replace(machine(plant, closed.controller, motions=("relative.x",)), resolution=np.zeros(1))
    readings = (simulate(known, np.zeros((count, 1)), noise_series(plant, floor, count, seed)).readings[500:, 0] for seed in range(8))
    squares = [np.mean(np.diff(each) ** 2) for each in readings]
    expected = (budget.changes[0] * sensors["S"].resolution) ** 2
    assert abs(np.mean(squares) - expected) < 4.0 * np.std(squares, ddof=1) / 8.0**0.5 + 0.01 * expected
    assert bool(budget.slowly_rounding) == (expected < 1e-20)  # half a step of 0.2 nm


@pytest.mark.parametrize("change", [0.25, 0.5])
def test_rounding_errors_of_successive_samples_correlate_as_the_criterion_says(change):
    """Of Gaussian numbers far wider than a step: 6/pi^2 sum exp(-2 pi^2 k^2 s^2)/k^2, whose first term tells where white noise ends."""
    random, count = np.random.default_rng(3), 400_000
    first = 50.0 * random.standard_normal(count)
    errors = [each - np.rint(each) for each in (first, first + change * random.standard_normal(count))]
    orders = np.arange(1, 20)
    expected = 6.0 / np.pi**2 * np.sum(np.exp(-2.0 * (np.pi * orders * change) ** 2) / orders**2)
    found = 12.0 * np.mean(errors[0] * errors[1])
    assert abs(found - expected) < 4.0 / np.sqrt(count)
    assert (expected < 0.01) == (change >= 0.5)


def test_rounding_is_white_from_half_a_step_on():
    budget = noise_budget(small_loop(), {}, (1.0, 100.0), ("relative.x",))
    assert [replace(budget, changes=np.array([change])).slowly_rounding for change in (0.0, 0.49, 0.51, np.nan)] == [("S",), ("S",), (), ()]
    assert replace(budget, changes=np.zeros(1), squares=0.0 * budget.squares).slowly_rounding == ()  # its rounding reaches no output


def test_steps_of_a_converter_are_no_motion_of_a_reading():
    """Rounding dithers nothing, whose ever it is: a reading that rests on a step of the converter moves by its noise alone."""
    closed = small_loop()
    amplifiers = Table({"B": replace(closed.plant.hardware.amplifiers["B"], step=1e-7)})
    stepped = loop(replace(closed.plant, hardware=replace(closed.plant.hardware, amplifiers=amplifiers)), closed.controller)
    smooth, rough = (noise_budget(each, {}, (1.0, 100.0), ("relative.x",)) for each in (closed, stepped))
    assert rough.rms[0] > 10.0 * smooth.rms[0]
    assert rough.changes == smooth.changes
