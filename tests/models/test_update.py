"""Updating: known changes of a stage come back from tests of it, with deviations that hold, or as not identifiable."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
import scipy

from flexstage.base.finding import DesignError
from flexstage.cases.double_triangle import double_triangle
from flexstage.cases.parallelogram import parallelogram
from flexstage.experiment.comparison import compare
from flexstage.experiment.pipeline import identification, usable_measurement
from flexstage.experiment.records.record import Channel
from flexstage.experiment.updating.fit import Problem, gauss_newton
from flexstage.experiment.updating.free import Prior, free
from flexstage.experiment.updating.gains import _extrapolate_to_zero, measured_gains
from flexstage.experiment.updating.rows import ModeRow, follow_modes, frequency_slopes, gain_slopes, mode_rows, start_design, static_gains
from flexstage.experiment.updating.tables import residual_table
from flexstage.experiment.updating.text import updated_text
from flexstage.experiment.updating.update import Identifiability, Updated, update
from flexstage.experiment.virtual_rig.inputs import InputQuantity
from flexstage.experiment.virtual_rig.rig import rig
from flexstage.experiment.virtual_rig.setup import RigSetup, Sensing
from flexstage.mechanism.addresses.address import get, set_value, tag_of
from flexstage.mechanism.mechanism import Mechanism
from flexstage.mechanism.store import dumps, loads
from flexstage.models.lumped import lumped
from tests.conftest import FULL
from tests.models.made_tests import Noise, made

STAGE = double_triangle()
NECK = "parts.neck.thickness"
LEVER = "parts.lever_notch.thickness"
FRONT = "vertical/front.thickness"
EXACT = Noise(frequency=1e-7, response=0.0)


def changed(**shares: float) -> Mechanism:
    """The stage with its numbers (by last two names) multiplied."""
    full = {"neck": NECK, "lever": LEVER, "front": FRONT, "density": "materials.steel.density", "stack": "parts.stack_vertical.stiffness"}
    result = STAGE
    for name, share in shares.items():
        result = set_value(result, full[name], share * get(result, full[name]))
    return result


def errors(found: Updated, true: Mechanism) -> np.ndarray:
    """Logarithms of true values over those found, by parameter."""
    return np.log([get(true, name) for name in found.addresses] / found.after)


# --- what the issue asks for ---------------------------------------------------------------------------------------------------------


def test_a_neck_five_per_cent_thicker_is_found_to_half_a_per_cent() -> None:
    found = update(STAGE, made(changed(neck=1.05)), ["neck.thickness"])
    assert found.changes[0] == pytest.approx(0.05, abs=0.005)
    assert found.deviations[0] < 0.005
    assert found.verdicts == ("identified",)
    assert found.chi_square < found.chi_square_before / 20.0
    assert found.residuals[2].name == "mode 4 (yaw)"
    assert abs(found.residuals[2].misfit_after) < 1.0 < abs(found.residuals[2].misfit_before)


def test_a_neck_is_found_in_a_record_of_the_virtual_rig() -> None:
    built = changed(neck=1.05)
    test = rig(built, lumped(built), RigSetup(seconds=12.0, seed=5, sensing=Sensing(density=5e-9)))
    found = update(STAGE, identification(usable_measurement([test])).found, [NECK])
    assert found.changes[0] == pytest.approx(0.05, abs=0.005)
    assert found.identifiability == (Identifiability.WELL,)


def test_lever_and_front_hinge_are_not_identifiable_from_frequencies_and_say_so() -> None:
    built = changed(lever=1.05, front=0.96)
    found = update(STAGE, made(built), [LEVER, FRONT])
    front = found.addresses.index(FRONT)
    assert found.identifiability[front] is Identifiability.NOT
    assert found.verdicts[front] == f"not identifiable from frequencies; only in combination with {LEVER}"
    assert np.all(np.abs(errors(found, built)) < 1.96 * found.deviations)
    assert found.correlations.values[0, 1] < -0.9
    assert found.singular[1] < 0.01
    assert found.singular[0] > 1.0
    for number in found.parameters:  # what is left of a number's prior variance is that of the combinations it has a part in
        parts = [each.direction[number.address] ** 2 * each.prior_variance_left for each in found.combinations]
        assert number.prior_variance_left == pytest.approx(sum(parts), rel=1e-9)


def test_from_static_gains_they_are() -> None:
    built = changed(lever=1.05, front=0.96)
    found = update(STAGE, made(built), [LEVER, FRONT], Prior(gain_error=1e-3))
    lever, front = (found.addresses.index(name) for name in (LEVER, FRONT))
    assert found.identifiability[lever] is Identifiability.WELL
    assert found.identifiability[front] is not Identifiability.NOT
    assert np.all(np.abs(errors(found, built)) < 1.96 * found.deviations)
    assert found.deviations[lever] < 0.015
    assert found.freedoms == 4 + 36
    gain = next(each for each in found.residuals if each.unit != "Hz" and abs(each.measured) < 0.5 * each.scale)
    assert gain.misfit_after == pytest.approx((gain.measured - gain.after) / (gain.deviation * gain.scale))
    for count in (2, 14):  # the table says to what errors of gains are relative, however many it lists
        notes = residual_table(replace(found, residuals=found.residuals[:4] + (gain,) * count)).notes
        assert any("relative to the measured frequency, or to the largest measured gain of the actuator" in note for note in notes)


@pytest.mark.full  # necks are found in a record always
def test_gains_from_a_record_in_volts() -> None:
    built = changed(lever=1.05)
    setup = RigSetup(seconds=20.0, seed=2, sensing=Sensing(density=1e-9), input_quantity=InputQuantity.VOLTAGE)
    experiment = identification(usable_measurement([rig(built, lumped(built), setup)])).found
    gauges = tuple(channel.name for channel in experiment.outputs)
    gains = measured_gains(built, lumped(built), experiment, gauges)
    theory = static_gains(start_design(built, ()), gains)
    np.testing.assert_allclose(gains.values, theory, atol=4.0 * float(np.max(gains.deviations)))
    assert np.max(gains.deviations) < 0.01 * np.max(theory)
    found = update(STAGE, experiment, [LEVER], Prior(gain_error=1e-3))
    assert abs(errors(found, built)[0]) < 1.96 * found.deviations[0]


# --- deviations hold -----------------------------------------------------------------------------------------------------------------


COPIES = 8 if FULL else 2


def test_errors_are_as_large_as_stated() -> None:
    """Numbers drawn from their priors, frequencies with the stated errors: the whitened errors are normal."""
    random = np.random.default_rng(7)
    known, names = Prior(prior=0.02, model_error=1e-3), ["neck", "density", "stack"]
    total, chances = 0.0, list[float]()
    for seed in range(COPIES):
        built = changed(**dict(zip(names, np.exp(known.prior * random.standard_normal(3)), strict=True)))
        found = update(STAGE, made(built, seed, Noise(model=1e-3)), [NECK, "steel.density", "stack_vertical.stiffness"], known)
        error = errors(found, built)
        total += float(error @ np.linalg.solve(found.covariance, error))
        chances.append(found.probability)
    low, high = scipy.stats.chi2.ppf([0.005, 0.995], 3 * COPIES)
    assert low < total < high
    assert scipy.stats.combine_pvalues(chances).pvalue > 0.005


def test_chi_square_tells_of_what_is_not_modelled() -> None:
    built = changed(density=1.2)
    found = update(STAGE, made(built), [NECK], Prior(prior=0.05))
    assert found.probability < 1e-6
    assert any("Specify a model error above" in warning for warning in found.data_warnings)
    told = update(STAGE, made(built), ["steel.density"])
    assert told.probability > 0.01
    tenth = scipy.stats.chi2.ppf(0.9, len(told.residuals))  # priors are data too: each makes up for the number that it is of
    assert replace(told, chi_square=tenth).probability == pytest.approx(0.1, rel=1e-9)


def test_more_prior_is_left_where_it_is_narrower() -> None:
    experiment = made(changed(neck=1.05))
    wide, narrow = (update(STAGE, experiment, [NECK], Prior(priors={"neck.thickness": share})) for share in (0.1, 0.001))
    assert wide.remaining_variance[0] < 0.01
    assert narrow.remaining_variance[0] > 0.9
    assert narrow.verdicts == ("not identifiable from frequencies",)
    assert narrow.changes[0] < 0.01


# --- repeated modes ------------------------------------------------------------------------------------------------------------------


def test_three_copies_are_told_together_only() -> None:
    """The mean of a repeated pair, a symmetric function, moves alike with all three copies."""
    names = [f"B{number}/front.thickness" for number in (1, 2, 3)]
    found = update(STAGE, made(changed(neck=1.02), noise=EXACT), names)
    assert found.identifiability == (Identifiability.NOT,) * 3
    assert np.ptp(found.changes) < 1e-6
    assert found.singular[0] > 5.0
    assert found.singular[1] < 1e-3


def test_the_error_of_a_pairs_mean_frequency_is_that_of_two_independent_frequencies() -> None:
    """By simulation: the logarithm of sqrt(mean f^2) of a pair whose frequencies scatter by 1 and 2 %."""
    experiment = made(STAGE, noise=EXACT)
    pair = next(row for row in mode_rows(STAGE, compare(STAGE, experiment), experiment) if len(row.measured) == 2)
    first, second = pair.measured
    spread = experiment.frequency_deviations.copy()
    spread[[first, second]] = experiment.frequencies[[first, second]] * (0.01, 0.02)
    noisy = replace(experiment, frequency_deviations=spread)
    found = next(row for row in mode_rows(STAGE, compare(STAGE, noisy), noisy) if row.measured == pair.measured)
    drawn = experiment.frequencies[[first, second]] + spread[[first, second]] * np.random.default_rng(2).standard_normal((40_000, 2))
    assert found.deviation == pytest.approx(np.std(0.5 * np.log(np.mean(drawn**2, axis=1))), rel=0.02)


def test_slopes_are_those_of_differences_also_through_a_split_pair() -> None:
    stage = set_value(STAGE, "B1/front.thickness", 1.002 * get(STAGE, NECK))
    names = (NECK, "B1/front.thickness", "materials.steel.density")
    freed = free(stage, names)
    here = start_design(
        freed.mechanism, (ModeRow("tilt", (0, 1), (), 0.0, 0.0), ModeRow("z", (2,), (), 0.0, 0.0), ModeRow("xy", (4, 5), (), 0.0, 0.0))
    )
    gains = measured_gains(STAGE, lumped(STAGE), made(STAGE, noise=EXACT), ("S1", "S4"))
    exact, exact_gains = frequency_slopes(here, freed.names), gain_slopes(here, freed.names, gains)
    step = 1e-5
    for index, name in enumerate(freed.names):
        ends = [follow_modes(here, freed.multiply(sign * step * np.eye(len(names))[index])) for sign in (1.0, -1.0)]
        moved = np.log(ends[0].frequencies / ends[1].frequencies) / (2.0 * step)
        np.testing.assert_allclose(exact[:, index] * get(freed.mechanism, name), moved, atol=1e-8)
        moved_gains = (static_gains(ends[0], gains) - static_gains(ends[1], gains)) / (2.0 * step)
        np.testing.assert_allclose(exact_gains[..., index] * get(freed.mechanism, name), moved_gains, atol=1e-7)


def test_crossing_modes_stay_with_their_rows() -> None:
    """Yaw, above z, is brought below it by a smaller radius of the units that hold it."""
    rows = (ModeRow("z", (2,), (0,), 1.0, 0.0), ModeRow("yaw", (3,), (1,), 1.0, 0.0))
    here, radius = start_design(STAGE, rows), get(STAGE, "placements.B1-B3.pattern.radius")
    for share in np.linspace(0.98, 0.82, 9):
        here = follow_modes(here, set_value(STAGE, "placements.B1-B3.pattern.radius", share * radius))
    assert here.modes == ((3,), (2,))
    assert here.frequencies[1] < here.frequencies[0]


# --- the design file -----------------------------------------------------------------------------------------------------------------


def test_the_new_file_keeps_comments_and_says_where_values_are_from() -> None:
    text = dumps(STAGE, {"parts.neck": "As drawn."})
    found = update(STAGE, made(changed(neck=1.05)), [NECK, "vertical/front.thickness"])
    after = updated_text(text, found, "test 7.uff")
    stage = loads(after)
    assert "# As drawn." in after
    for name, value in zip(found.addresses, found.after, strict=True):
        assert get(stage, name) == pytest.approx(value, rel=1e-6)
    assert tag_of(stage, NECK).startswith("derived update test 7.uff, +- 0.3")
    assert tag_of(stage, "vertical/front.thickness").startswith("derived update test 7.uff, ")
    assert tag_of(stage, "parts.neck.width") == tag_of(STAGE, "parts.neck.width")
    back = set_value(stage, NECK, get(STAGE, NECK))
    back = replace(back, overrides={}, tags=STAGE.tags)
    assert back == STAGE


# --- bad input -----------------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("names", "known", "said"),
    [
        ((), Prior(), "no parameter is free"),
        (("neck.thicknes",), Prior(), "Use thickness"),
        (("front.thickness",), Prior(), "Write horizontal/front.thickness or vertical/front.thickness"),
        (("horizontal/frnt.thickness",), Prior(), "Use front"),
        (("parts.neck",), Prior(), "not a single number"),
        (("platform.mass",), Prior(), "the body's mass follows from its solids"),
        (("horizontal/front.at.y",), Prior(), "horizontal/front.at.y: zero has no relative uncertainty"),
        (("neck.thickness", NECK), Prior(), "named twice"),
        (("steel.yield_stress",), Prior(), "has no effect on the compared frequencies"),
        (("steel.yield_stress",), Prior(gain_error=1e-3), "has no effect on the compared frequencies and gains"),
        ((NECK,), Prior(prior=0.0), r"out of range \(got 0\)"),
        ((NECK,), Prior(priors={"steel.density": 0.1}), "not among the free parameters"),
        ((NECK, "neck.width", "steel.density", "steel.young", LEVER), Prior(), r"too few data for 5 free parameters \(got 4: "),
    ],
)
def test_bad_questions_are_refused(names: Sequence[str], known: Prior, said: str) -> None:
    with pytest.raises(DesignError, match=said):
        update(STAGE, made(STAGE), names, known)


def test_tests_that_do_not_fit_are_refused() -> None:
    experiment = made(STAGE)
    other = tuple(replace(channel, name=f"gap {channel.name}") for channel in experiment.outputs)
    with pytest.raises(DesignError, match="unknown output"):
        update(STAGE, replace(experiment, outputs=other), [NECK])
    none = replace(experiment, frequencies=np.zeros(0), shapes=np.zeros((6, 0)), frequency_deviations=np.zeros(0))
    with pytest.raises(DesignError, match="none of the 0 identified modes matches a platform mode"):
        update(STAGE, replace(none, damping=np.zeros(0), damping_deviations=np.zeros(0)), [NECK])


def test_gains_need_units_actuators_and_low_lines() -> None:
    experiment, known = made(STAGE), Prior(gain_error=1e-3)
    bare = tuple(Channel(channel.name, "", channel.role) for channel in experiment.inputs)
    with pytest.raises(DesignError, match="does not fit a gauge or an actuator"):
        update(STAGE, replace(experiment, inputs=bare), [LEVER], known)
    turned = (replace(experiment.outputs[0], unit="mrad"), *experiment.outputs[1:])  # a displacement gauge does not read an angle
    with pytest.raises(DesignError, match='S1: its unit "mrad" does not fit'):
        update(STAGE, replace(experiment, outputs=turned), [LEVER], known)
    named = tuple(replace(channel, name=f"u{channel.name}") for channel in experiment.inputs)
    with pytest.raises(DesignError, match="no input of the record has the name of an actuator"):
        update(STAGE, replace(experiment, inputs=named), [LEVER], known)
    few = replace(experiment.responses, frequencies=100.0 + experiment.responses.frequencies)
    with pytest.raises(DesignError, match=r"too few lines below .*\(got 0"):
        update(STAGE, replace(experiment, responses=few), [LEVER], known)


def test_a_search_without_end_is_refused() -> None:
    uphill = Problem(lambda place, _: place, lambda place: 3.0 - place, lambda _: np.array([[-1.0]]))
    with pytest.raises(DesignError, match="still change by"):
        gauss_newton(uphill, np.zeros(1), np.zeros(1))


def test_steps_that_lead_up_are_halved() -> None:
    """Theory 20 atan 4 u and data 0: from 1.5 a whole Gauss-Newton step leads to -9.4, and from there back; the end is 0."""
    found = gauss_newton(
        Problem(lambda u, _: u, lambda u: -20.0 * np.arctan(4.0 * u), lambda u: np.diag(80.0 / (1.0 + 16.0 * u**2))),
        np.array([1.5]),
        np.array([1.5]),
    )
    assert found.parameters == pytest.approx([0.0], abs=1e-9)
    assert found.cost == pytest.approx(0.0, abs=1e-12)


def test_designs_that_cannot_be_read_shorten_the_step() -> None:
    def state(place: np.ndarray, _: np.ndarray) -> np.ndarray:
        if place[0] > 0.6:
            raise DesignError([])
        return place

    steeper = Problem(state, lambda u: 100.0 * (1.75 - u - 5.0 * u**2), lambda u: 100.0 * (1.0 + 10.0 * u[:, None]))  # first step: to 1.75
    assert gauss_newton(steeper, np.zeros(1), np.zeros(1)).parameters[0] == pytest.approx(0.5, abs=1e-3)


def test_gains_are_led_back_past_the_lowest_mode() -> None:
    """A mode g/(1 - x^2), its neighbours' and lags' r + q x^2: at rest exactly g + r; a polynomial alone would not be."""
    lines = np.linspace(0.02, 0.35, 60)
    mode, rest, curve = (np.array([[0.9, -0.2]]), np.array([[0.1, 0.5]]), np.array([[0.05, -0.3]]))
    values = mode / (1.0 - lines[:, None, None] ** 2) + rest + curve * lines[:, None, None] ** 2
    found, deviations = _extrapolate_to_zero(lines, values)
    np.testing.assert_allclose(found, mode + rest, atol=1e-12)
    assert np.max(deviations) < 1e-12


def test_deviations_of_gains_are_the_scatter_of_lines_of_windowed_records() -> None:
    """Errors of neighbouring lines correlate through Hann's window; those of independent lines have 1/1.94 of the variance stated."""
    random, window = np.random.default_rng(3), np.sin(np.pi * np.arange(256) / 256.0) ** 2
    found = []
    for _ in range(20):
        drive, noise = (np.fft.rfft(window * random.standard_normal(shape)) for shape in ((10, 256), (50, 10, 256)))
        away = np.real(np.sum(noise * np.conj(drive), axis=1) / np.sum(np.abs(drive) ** 2, axis=0))[:, 3:23]
        found.append(_extrapolate_to_zero(np.linspace(0.02, 0.35, 20), away.T[..., None]))
    errors, deviations = np.mean(np.square(found), axis=(0, 2, 3))
    assert errors == pytest.approx(deviations, rel=0.2)
    independent = _extrapolate_to_zero(np.linspace(0.02, 0.35, 8), random.standard_normal((8, 2000, 1)))
    errors, deviations = np.mean(np.square(independent), axis=(1, 2))
    assert 1.94 * errors == pytest.approx(deviations, rel=0.2)


def test_nothing_is_said_of_numbers_where_theory_and_test_contradict_each_other() -> None:
    plain = made(STAGE)
    names = {"B1": "B4", "B4": "B1"}
    renamed = tuple(replace(channel, name=names.get(channel.name, channel.name)) for channel in plain.responses.inputs)
    test = replace(plain, inputs=renamed, responses=replace(plain.responses, inputs=renamed))
    found = update(STAGE, test, [NECK], Prior(gain_error=0.02))
    assert found.chi_square > 1e3
    assert found.identifiability == (Identifiability.WITHHELD,)
    assert found.verdicts[0].startswith("withheld: chi-square ")
    assert f"{found.parameters[0].address}: {found.verdicts[0]}." in found.notes
    assert any("look exchanged" in each for each in found.data_warnings)
    assert "theory and test contradict each other" in updated_text(dumps(STAGE), found, "test.uff")


def test_a_design_with_other_coordinates_is_no_step() -> None:
    here = start_design(STAGE, (ModeRow("z", (2,), (0,), 126.0, 1e-4),))
    with pytest.raises(DesignError, match="the changed parameters give the model"):
        follow_modes(here, parallelogram())
