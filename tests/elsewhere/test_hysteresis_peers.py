"""Bouc-Wen by an integrator of differential equations, Preisach by relays and by quadrature: neither shares code with ours."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
import scipy
from scipy.optimize import brentq

from flexstage.control.hysteresis.models.bouc_wen import BoucWen
from tests.laws.preisach import preisach


def swept(time):
    """Volts and their rate: two sines, so that turning points lie at all heights."""
    volts = 500.0 + 300.0 * np.sin(2.0 * np.pi * time) + 180.0 * np.sin(5.3 * 2.0 * np.pi * time)
    rate = 300.0 * 2.0 * np.pi * np.cos(2.0 * np.pi * time) + 180.0 * 5.3 * 2.0 * np.pi * np.cos(5.3 * 2.0 * np.pi * time)
    return volts, rate


def turning_times(end):
    """Times at which the rate is 0, so that the integrator stops where its right-hand side is not smooth."""
    fine = np.linspace(0.0, end, 20001)
    rates = swept(fine)[1]
    brackets = [(fine[place], fine[place + 1]) for place in np.flatnonzero(rates[1:] * rates[:-1] < 0.0)]
    return [0.0, *(brentq(lambda time: swept(time)[1], low, high, xtol=1e-15) for low, high in brackets), end]


@pytest.mark.parametrize("gamma", [-2e-3, 0.0, 4e-3])
def test_bouc_wen_against_an_integrator(gamma):
    gain, lag, beta = 2.5e-7, 4e-8, 4e-3

    def right(time, state):
        rate = swept(time)[1]
        return lag * rate - beta * np.abs(rate) * state - gamma * rate * np.abs(state)

    plant = BoucWen([gain], [lag], [beta], [gamma])
    times, wanted = [0.0], [0.0]
    for start, stop in pairwise(turning_times(2.0)):
        samples = np.linspace(start, stop, 12)[1:]
        crossing = lambda _, state: state[0]  # noqa: E731 - the integrator wants a function it can ask where h is 0
        solved = scipy.integrate.solve_ivp(
            right, (start, stop), wanted[-1:], "DOP853", samples, events=crossing, rtol=3e-14, atol=1e-20, max_step=2e-3
        )
        times += samples.tolist()
        wanted += solved.y[0].tolist()
    volts = swept(np.array(times))[0]
    ours = gain * volts - plant.run(volts, np.array([[volts[0], 0.0]]))
    assert np.max(np.abs(ours - wanted)) < 1e-9 * np.ptp(gain * volts)


def test_preisach_against_relays():
    """A grid of relays, each switched one by one: agrees as far as a grid can, and twice as well on one twice as fine."""
    plant = preisach(150e-6, (0.0, 1000.0), 0.15)
    volts = np.random.default_rng(2).uniform(0.0, 1000.0, 40)
    ours = plant.run(volts)
    errors = [np.sqrt(np.mean((of_relays(plant, volts, count) - ours) ** 2)) / 150e-6 for count in (60, 240)]
    assert errors[1] < 2e-3
    assert errors[1] < 0.4 * errors[0]


def of_relays(plant, volts, count):
    edges = np.linspace(0.0, 1000.0, count + 1)
    middle = 0.5 * (edges[1:] + edges[:-1])
    alpha, beta = np.meshgrid(middle, middle, indexing="ij")
    shares = np.tril(np.ones((count, count))) - 0.5 * np.eye(count)
    weights = density(plant, alpha, beta) * shares * (edges[1] - edges[0]) ** 2
    on = np.zeros((count, count), dtype=bool)
    found = []
    for value in volts:
        on = (on | (alpha <= value)) & (beta < value)
        found.append(plant.slope[0] * value + np.sum(weights[on]))
    return np.array(found)


def density(plant, alpha, beta):
    middle = (alpha + beta - 1000.0) / 1000.0
    return plant.density[0] * np.exp(-(alpha - beta) / plant.decay[0]) * (1.0 - plant.tilt[0] * middle - plant.bulge[0] * middle**2)


@pytest.mark.parametrize(("alpha", "beta"), [(1000.0, 0.0), (700.0, 650.0), (400.0, 10.0)])
def test_everett_against_quadrature(alpha, beta):
    plant = preisach(150e-6, (0.0, 1000.0), 0.15)
    wanted, _ = scipy.integrate.dblquad(
        lambda low, high: density(plant, high, low), beta, alpha, beta, lambda high: high, epsabs=0.0, epsrel=1e-12
    )
    found = plant.everett(np.array([alpha]), np.array([beta]))
    assert found[0] == pytest.approx(wanted, rel=1e-9)
