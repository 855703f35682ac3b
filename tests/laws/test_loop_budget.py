"""Laws of noise in loops: Lyapunov against quadrature, aliasing against a finer clock, and Parseval against simulation."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from flexstage.analysis.dynamics.random_response import Rate, Spectrum, quadrature
from flexstage.base.finding import DesignError
from flexstage.base.number import Table
from flexstage.cases.parallelogram import parallelogram
from flexstage.cases.registry import case
from flexstage.control.example import integral, integral_loop
from flexstage.control.noise import disturbance_response, noise_budget
from flexstage.control.plant_models.electronics import AmplifierSettings, GaugeSettings, Sensor, sampling_chain
from flexstage.control.plant_models.plants import plant, sensor_filter
from flexstage.control.systems.closed import loop
from flexstage.control.systems.system import select
from flexstage.control.white_noise import Kind, held_noise, mean_squares, white_system
from tests.conftest import examples
from tests.laws.loops import random_loop, stable_loop
from tests.laws.shared import ideal, lumped

SEEDS = st.integers(0, 10_000)
OUTPUTS = ("relative.x", "pose.x", "command.B")


def _relative(closed):
    return tuple(f"relative.{name}" for name in closed.plant.coordinates.names)


def _square(closed, kind, name, found):
    """One source's mean squares (p,)."""
    return next(found.squares[:, place] for place, source in enumerate(found.sources) if source.kind is kind and source.channel == name)


def _panels(low, high, poles):
    """Ends of panels dense around each pole (rates, 1/s)."""
    offsets = np.concatenate([-(3.0 ** np.arange(7)), [0.0], 3.0 ** np.arange(7)])
    near = (np.abs(poles.imag)[:, None] + np.abs(poles.real)[:, None] * offsets).ravel() / (2.0 * np.pi)
    return np.unique(np.concatenate([np.geomspace(low, high, 200), [low, high], near[(near > low) & (near < high)]]))


@given(SEEDS)
@examples(2)
def test_rounding_is_its_integral(seed):
    """A white sequence of variance q has the density 2 q T up to half the sampling rate."""
    closed = stable_loop(seed)
    found, outputs = noise_budget(closed, {}, (1.0, 400.0), _relative(closed)), _relative(closed)
    step = closed.step
    rates = np.log(closed.system.poles[np.abs(closed.system.poles) > 1e-9].astype(complex)) / step
    nodes, weights = quadrature(np.concatenate([[0.0], _panels(1e-6, 0.5 / step, rates)]))
    for name in closed.plant.gauges:
        size = np.abs(select(closed.system, [f"noise.{name}"], outputs).transfer(nodes)[:, :, 0]) ** 2
        resolution = closed.plant.hardware.sensors[name].resolution
        assert np.allclose(
            weights @ size * 2.0 * step * resolution**2 / 12.0, _square(closed, Kind.ROUNDING, name, found), atol=0.0, rtol=1e-8
        )


@given(SEEDS)
@examples(2)
def test_amplifier_noise_is_its_integral(seed):
    """What an amplifier stirs between the samples, by Lyapunov and over all frequencies, those that alias included."""
    closed = stable_loop(seed)
    outputs = _relative(closed)
    found = noise_budget(closed, {}, (1.0, 400.0), outputs)
    step, end = closed.step, 2e5
    rates = np.log(closed.system.poles[np.abs(closed.system.poles) > 1e-9].astype(complex)) / step
    ends = [_panels(1e-4, end, np.concatenate([closed.plant.system.poles, rates]))]
    near = ends[0][ends[0] < 0.5 / step]
    ends += [np.abs(number / step + sign * near) for number in range(1, 8) for sign in (-1.0, 1.0)]
    nodes, weights = quadrature(np.unique(np.concatenate(ends)))
    for name in closed.plant.actuators:
        size = np.abs(disturbance_response(closed, (name,), outputs, nodes)[:, :, 0]) ** 2
        density = closed.plant.hardware.amplifiers[name].noise_density
        assert np.allclose(weights @ size * density**2, _square(closed, Kind.AMPLIFIER, name, found), atol=0.0, rtol=1e-4)


def _filtered(rate, **settings):
    """One axis with an amplifier's and a gauge's lag, and a filter."""
    given = sampling_chain(
        parallelogram(),
        rate=rate,
        delay=70e-6 if rate else 0.0,
        amplifiers=AmplifierSettings(bandwidth=1500.0, noise_density=1e-4, bits=12),
        gauges=GaugeSettings(filter_order=2, filter_corner=1500.0, **settings),
    )
    return integral_loop(150.0, given)


def _gauge_square(closed, aliases):
    """Mean squares (p,) of a gauge's noise, white before lag and filter: |H(e^{j omega T}) F(j omega)|^2 n^2 over all frequencies."""
    rate, poles = closed.plant.hardware.rate, closed.system.poles
    rates = poles if rate is None else np.log(poles[np.abs(poles) > 1e-9].astype(complex)) * rate
    ends = [np.array([0.0]), _panels(1e-6, 1e6, np.concatenate([closed.plant.system.poles, rates]))]
    near = ends[1][ends[1] < 2500.0]
    ends += [np.abs(number * rate + sign * near) for number in range(1, aliases) for sign in (-1.0, 1.0)]
    nodes, weights = quadrature(np.unique(np.concatenate(ends)))
    through = sensor_filter(closed.plant).transfer(nodes)
    size = np.abs(select(closed.system, ["noise.S"], OUTPUTS).transfer(nodes) @ through)[:, :, 0] ** 2
    return weights @ size * closed.plant.hardware.sensors["S"].noise_density ** 2


def test_gauge_noise_is_its_integral():
    closed = _filtered(5e3)
    found = noise_budget(closed, {}, (1.0, 400.0), OUTPUTS)
    assert np.allclose(_gauge_square(closed, 6), _square(closed, Kind.GAUGE, "S", found), atol=0.0, rtol=2e-6)


def test_what_enters_at_the_samples_is_its_integral():
    """A gauge without lag: n^2 up to half the rate; rounding of gauge and converter: q^2/12, which is 2 T q^2/12 over frequency."""
    given = sampling_chain(parallelogram(), rate=5e3, delay=70e-6, amplifiers=AmplifierSettings(bits=12))
    closed = integral_loop(150.0, replace(given, sensors=Table({"S": Sensor(noise_density=3e-12, resolution=2e-10)})))
    found = noise_budget(closed, {}, (1e-3, 2500.0), OUTPUTS)
    rates = np.log(closed.system.poles[np.abs(closed.system.poles) > 1e-9].astype(complex)) / closed.step
    nodes, weights = quadrature(np.concatenate([[0.0], _panels(1e-6, 2500.0, rates)]))
    sizes = np.abs(select(closed.system, ["noise.S", "noise.B"], OUTPUTS).transfer(nodes)) ** 2
    step, rounding = closed.plant.hardware.amplifiers["B"].step, 2.0 * closed.step / 12.0
    known = ((Kind.GAUGE, "S", 9e-24), (Kind.ROUNDING, "S", rounding * 4e-20), (Kind.CONVERTER, "B", rounding * step**2))
    for place, (kind, name, density) in enumerate(known):
        whole = weights @ sizes[:, :, 1 if name == "B" else 0] * density
        assert np.allclose(whole, _square(closed, kind, name, found), atol=0.0, rtol=1e-8)
        drawn = np.trapezoid(found.density[:, :, place], found.frequencies, axis=0)
        assert np.allclose(drawn, found.squares[:, place], atol=0.0, rtol=0.02)


def test_fast_samples_are_a_continuous_loop():
    """Gauge and amplifier noise at 200 kHz, and over all frequencies of the loop without samples, which has no budget."""
    continuous = _filtered(None)
    given = sampling_chain(
        parallelogram(),
        rate=2e5,
        amplifiers=AmplifierSettings(bandwidth=1500.0, noise_density=1e-4),
        gauges=GaugeSettings(filter_order=2, filter_corner=1500.0),
    )
    fast = noise_budget(integral_loop(150.0, given), {}, (1.0, 400.0), OUTPUTS)
    assert np.allclose(_square(None, Kind.GAUGE, "S", fast), _gauge_square(continuous, 0), atol=0.0, rtol=2e-3)
    nodes, weights = quadrature(_panels(1e-4, 2e5, np.concatenate([continuous.plant.system.poles, continuous.system.poles])))
    driven = np.abs(disturbance_response(continuous, ("B",), OUTPUTS, nodes)[:, :, 0]) ** 2
    density = continuous.plant.hardware.amplifiers["B"].noise_density
    assert np.allclose(_square(None, Kind.AMPLIFIER, "B", fast), weights @ driven * density**2, atol=0.0, rtol=2e-3)
    with pytest.raises(DesignError, match="the loop is continuous"):
        noise_budget(continuous, {}, (1.0, 400.0), OUTPUTS)


def test_noise_left_by_a_step():
    """Covariances over two steps are those over one, moved, and added; fast and slow poles together."""
    A = np.array([[-1e6, 0.0, 3.0], [5.0, -0.1, 1e4], [0.0, -1e4, -0.1]])
    from scipy.linalg import expm

    B = np.array([[1.0, 0.0], [0.0, 2.0], [0.5, 1.0]])
    once, twice = (held_noise(A, B, step) for step in (1e-3, 2e-3))
    moved = expm(A * 1e-3)
    assert np.allclose(twice @ twice.T, once @ once.T + moved @ once @ once.T @ moved.T, atol=0.0, rtol=1e-9)
    assert np.isclose((once @ once.T)[0, 0], 1.0 / 2e6, atol=0.0, rtol=1e-4)


def test_floor_through_a_filter():
    """A floor of a known process: white noise through a resonance, by Lyapunov with the resonance among the states, and as a spectrum."""
    closed = _filtered(5e3)
    name, low, high = "ground.x", 0.05, 20_000.0
    natural, ratio = 2.0 * np.pi * 30.0, 0.2
    A = np.array([[0.0, 1.0, 0.0], [-(natural**2), -2.0 * ratio * natural, 0.0], [natural, 0.0, -natural]])
    B, C = np.array([[0.0], [natural**2], [0.0]]), np.array([[0.0, 0.0, 1.0]])
    column = closed.plant.system.input_names.index(name)
    grid = np.geomspace(low, high, 3000)
    shape = (
        np.abs(
            natural**2
            / (natural**2 - (2.0 * np.pi * grid) ** 2 + 4.0j * np.pi * ratio * natural * grid)
            / (1.0 + 2j * np.pi * grid / natural)
        )
        ** 2
    )
    found = noise_budget(closed, {name: Spectrum(1e-18 * shape, grid)}, (low, high), ("relative.x",))
    square = _square(closed, Kind.FLOOR, name, found)[0]
    assert np.isclose(square, _by_states(closed, column, (A, B * np.sqrt(0.5e-18), C)), atol=0.0, rtol=2e-5)


def _by_states(closed, column, process):
    """Mean square of the motion with the floor's process among the states of plant and loop, all exact over a step."""
    from scipy.linalg import expm, solve_discrete_lyapunov

    A, B, C = process
    stage, size = closed.plant.system, len(closed.plant.system.A)
    joined = np.block([[stage.A, stage.B[:, [column]] @ C], [np.zeros((len(A), size)), A]])
    moved = expm(joined * closed.step)
    noise = held_noise(joined, np.vstack([np.zeros((size, 1)), B]), closed.step)
    whole = closed.system
    inner = select(whole, ["noise.S"], ["relative.x"])
    gauge, motion = (stage.D[stage.output_names.index(name), column] * C for name in ("gap.S", "relative.x"))
    total = np.zeros((len(whole.A) + len(A),) * 2)
    total[: len(whole.A), : len(whole.A)], total[len(whole.A) :, len(whole.A) :] = whole.A, moved[size:, size:]
    total[: len(whole.A), len(whole.A) :] = inner.B @ gauge
    total[:size, len(whole.A) :] += moved[:size, size:]
    spread = np.zeros((len(total), noise.shape[1]))
    spread[:size], spread[len(whole.A) :] = noise[:size], noise[size:]
    seen = np.concatenate([inner.C[0], (motion + inner.D @ gauge).ravel()])
    return seen @ solve_discrete_lyapunov(total, spread @ spread.T) @ seen


def _two_axes():
    stage = case("xy-stage")
    given = sampling_chain(stage, rate=10e3, delay=80e-6, amplifiers=AmplifierSettings(bandwidth=2000.0, noise_density=2e-4, bits=10))
    one = plant(lumped(stage), ideal(stage), given, modes=3)
    return loop(one, integral(one, 200.0))


def test_budget_is_what_simulation_shows():
    """Parseval: the sum of all sources' variances and that of 200 runs of the loop agree within their statistical error."""
    closed = _two_axes()
    outputs = ("relative.x", "relative.y")
    found = noise_budget(closed, {}, (1.0, 1000.0), outputs)
    assert set(found.kinds) == {Kind.GAUGE, Kind.ROUNDING, Kind.AMPLIFIER, Kind.CONVERTER}
    system, _ = white_system(closed, outputs)
    random, runs, samples, settled = np.random.default_rng(5), 200, 1200, 400
    state, squares = np.zeros((len(system.A), runs)), np.zeros((len(outputs), runs))
    for number in range(samples):
        white = random.normal(size=(len(system.inputs), runs))
        squares += (system.C @ state + system.D @ white) ** 2 if number >= settled else 0.0
        state = system.A @ state + system.B @ white
    variances = squares / (samples - settled)
    error = np.std(variances, axis=1) / np.sqrt(runs - 1.0)
    assert np.all(error < 0.03 * found.rms**2)
    assert np.all(np.abs(np.mean(variances, axis=1) - found.rms**2) < 4.0 * error)


def test_sources_add_up():
    closed = _filtered(5e3)
    floor, band = {"ground.x": Spectrum(1e-18), "ground.rz": Spectrum(1e-16, rate=Rate.VELOCITY)}, (0.1, 2500.0)
    found = noise_budget(closed, floor, band)
    assert np.allclose(found.rms**2, np.sum(found.by_kind.values, axis=1), atol=0.0, rtol=1e-14)
    alone = [noise_budget(closed, {name: spectrum}, band) for name, spectrum in floor.items()]
    floors = sum(one.squares[:, -1] for one in alone)
    assert np.allclose(
        floors,
        atol=0.0,
        b=np.sum([found.squares[:, place] for place, source in enumerate(found.sources) if source.kind is Kind.FLOOR], axis=0),
    )
    assert np.allclose(np.trapezoid(np.sum(found.density[:, 0], axis=-1), found.frequencies), found.rms[0] ** 2, atol=0.0, rtol=0.02)


def test_amplifiers_without_lag_count_over_the_band():
    given = sampling_chain(parallelogram(), rate=5e3, delay=1e-4, amplifiers=AmplifierSettings(noise_density=1e-4))
    found = [noise_budget(integral_loop(100.0, given), {}, (0.1, high), ("relative.x",)) for high in (100.0, 10_000.0)]
    assert any("have no lag" in note for note in found[0].notes)
    small, large = (_square(None, Kind.AMPLIFIER, "B", one)[0] for one in found)
    assert 0.0 < small < large < np.inf


def test_unstable_loops_and_wrong_floors_are_refused():
    closed = next(found for seed in range(50) if (found := random_loop(seed)).system.growth > 1.0)
    with pytest.raises(DesignError, match=r"no rms values for an unstable loop: .* grows at"):
        noise_budget(closed, {}, (1.0, 100.0))
    with pytest.raises(DesignError, match=r"ground\.q: unknown motion of the ground"):
        noise_budget(_filtered(5e3), {"ground.q": Spectrum(1e-18)}, (1.0, 100.0))
    with pytest.raises(DesignError, match=r"band: invalid band \(got 100 Hz to 1 Hz\)\. Use 0 < low < high in Hz"):
        noise_budget(_filtered(5e3), {"ground.x": Spectrum(1e-18)}, (100.0, 1.0))


def test_what_is_not_stated_is_said():
    closed = _filtered(5e3)
    bare = replace(closed.plant.hardware, sensors=Table({"S": replace(closed.plant.hardware.sensors["S"], noise_density=None)}))
    found = noise_budget(replace(closed, plant=replace(closed.plant, hardware=bare)), {}, (1.0, 100.0))
    assert any(note.startswith("the noise of S is not specified") for note in found.notes)
    assert not any("half a step" in note for note in found.notes)  # the amplifier's noise moves the reading
    silent = replace(bare, amplifiers=Table({}))
    still = noise_budget(replace(closed, plant=replace(closed.plant, hardware=silent)), {}, (1.0, 100.0))
    assert any("A reading at rest may be wrong by half a step (0.25 nm)" in note for note in still.notes)
    assert still.slowly_rounding == ("S",)
    assert not any("half a step" in note for note in noise_budget(closed, {}, (1.0, 100.0)).notes)
    assert Kind.GAUGE not in found.kinds


def test_mean_square_of_a_resonance():
    """S omega/(4 zeta) two-sided: white force through a resonance of gain 1."""
    closed = stable_loop(3, rate=None)
    system = select(closed.system, ["noise.B1"], ["relative.x"])
    natural, ratio = 30.0, 0.02
    matrix = np.array([[0.0, 1.0], [-(natural**2), -2.0 * ratio * natural]])
    resonance = replace(system, A=matrix, B=np.array([[0.0], [natural**2]]), C=np.array([[1.0, 0.0]]), D=np.zeros((1, 1)))
    assert np.isclose(mean_squares(resonance)[0, 0], natural / (4.0 * ratio), atol=0.0, rtol=1e-10)
