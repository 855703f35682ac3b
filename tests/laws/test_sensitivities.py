"""Complex-step sensitivities against central finite differences; cluster means at repeated modes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import flexstage as fs
from flexstage.cases.double_triangle import SM_REF_A, SM_REF_B, double_triangle
from flexstage.cases.registry import case
from flexstage.mechanism.addresses.address import addresses, get, set_value
from flexstage.models.linear.static import static_gain
from flexstage.show.tables.sensitivities import loss_sensitivity_table

MODES = 6


def _frequencies_loss_and_gain(stage: fs.Mechanism) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The gain: how much of its own stroke each actuator moves the platform by, read back by the ideal mapping."""
    model, kinematics = fs.lumped(stage), fs.ideal(stage)
    frequencies = fs.modes(model).frequencies[:MODES]
    moved = static_gain(model, tuple(f"platform.{name}" for name in kinematics.coordinates), kinematics.actuators).values
    return frequencies, np.diag(fs.lost_motion(kinematics, model).loss.values), np.diag(kinematics.mapping.values @ moved)


def _differences(stage: fs.Mechanism, address: str, step: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    value = get(stage, address)
    high = _frequencies_loss_and_gain(set_value(stage, address, value + step))
    low = _frequencies_loss_and_gain(set_value(stage, address, value - step))
    frequencies, loss, gain = ((more - less) / (2 * step) for more, less in zip(high, low, strict=True))
    return frequencies, loss, gain


def _means(values: np.ndarray, groups: tuple[tuple[int, ...], ...]) -> np.ndarray:
    return np.concatenate([np.full(len(group), values[list(group)].mean()) for group in groups])


ADDRESSES = [
    "horizontal/front.thickness",
    "B2/front.thickness",
    "parts.neck.profile.length",
    "parts.lever_notch.profile.radius",
    "parts.pole_neck.thickness",
    "parts.stack_vertical.stiffness",
    "parts.stack_horizontal.diameter",
    "materials.steel.young",
    "materials.steel.poisson",
    "materials.steel.density",
    "bodies.platform.solids.plate.size.x",
    "units.vertical.links.pivot.at.z",
    "units.vertical.links.front.at.x",
    "units.vertical.bodies.lever.solids.left.at.y",
    "placements.B4-B6.pattern.radius",
    "placements.B4-B6.pattern.turn",
    "placements.B1-B3.pattern.turn",
    "B5/pivot.at.z",
]


@pytest.mark.parametrize("address", ADDRESSES)
def test_against_finite_differences(address: str) -> None:
    stage = double_triangle(SM_REF_B)
    exact = fs.sensitivities(stage, (address,), modes=MODES)
    value = abs(get(stage, address)) or 0.1
    slope, loss, gain = _differences(stage, address, 1e-5 * value)
    found = _means(slope, exact.clusters)
    np.testing.assert_allclose(exact.frequency[0] * value, found * value, atol=2e-6 * exact.frequencies.max())
    np.testing.assert_allclose(exact.loss[0] * value, loss * value, atol=2e-8)
    np.testing.assert_allclose(exact.gain[0] * value, gain * value, atol=2e-8)
    assert np.max(np.abs(exact.frequency[0] * value)) > 1e-6


@pytest.mark.parametrize(
    ("kinds", "power"), [((".young", ".stiffness", ".bending_rigidity"), 0.5), ((".density", ".mass"), -0.5)], ids=["stiffness", "mass"]
)
def test_all_stiffness_or_all_mass_together_scale_frequencies_by_their_root(kinds: tuple[str, ...], power: float) -> None:
    """Whatever the stage, relative sensitivities add up to +-1/2; strokes are lost by ratios of stiffness, so those of loss to nothing."""
    stage = double_triangle(SM_REF_B)
    names = tuple(name for name in addresses(stage) if name.endswith(kinds) and get(stage, name) is not None)
    found = fs.sensitivities(stage, names, modes=MODES)
    np.testing.assert_allclose(found.relative_frequency.values.sum(axis=0), power, rtol=1e-7)
    np.testing.assert_allclose(found.relative_loss.values.sum(axis=0), 0.0, atol=1e-9)


def test_a_symmetric_change_keeps_clusters_and_a_single_one_splits_them() -> None:
    stage = double_triangle(SM_REF_B)
    exact = fs.sensitivities(stage, ("horizontal/front.thickness", "B2/front.thickness"), modes=MODES)
    pairs = [slopes for slopes in exact.one_sided if slopes.shape[1] == 2]
    assert len(pairs) == 2
    for slopes in pairs:
        np.testing.assert_allclose(slopes[0, 0], slopes[0, 1], rtol=1e-6)
    assert abs(pairs[1][1, 0] - pairs[1][1, 1]) > 1e-3 * abs(pairs[1][1, 1])


def test_a_cluster_at_the_end_is_whole() -> None:
    """Half a pair has no derivative: its shape is any of the plane that both span."""
    names = ("B2/front.thickness",)
    whole = fs.sensitivities(double_triangle(), names, modes=6)
    pair = next(group for group in whole.clusters if len(group) == 2)
    cut = fs.sensitivities(double_triangle(), names, modes=pair[0] + 1)
    assert cut.clusters[-1] == pair
    np.testing.assert_allclose(cut.frequency, whole.frequency[:, : pair[-1] + 1])


def test_copies_add_up_to_the_shared_part() -> None:
    stage = double_triangle(SM_REF_A)
    copies = fs.sensitivities(stage, tuple(f"B{number}/front.thickness" for number in (1, 2, 3)), modes=MODES)
    shared = fs.sensitivities(stage, ("horizontal/front.thickness",), modes=MODES)
    np.testing.assert_allclose(copies.frequency.sum(axis=0), shared.frequency[0], rtol=1e-7, atol=1e-6)


def test_every_number_of_the_stage_has_a_finite_sensitivity() -> None:
    stage = double_triangle(SM_REF_B)
    exact = fs.sensitivities(stage, modes=MODES)
    assert exact.parameters == addresses(stage)
    assert np.all(np.isfinite(exact.frequency))
    assert np.all(np.isfinite(exact.loss))


@pytest.mark.parametrize(
    ("address", "message"),
    [
        ("parts.neck", "not a single number"),
        ("vertical/front.at", "not a single number"),
        ("neck.thicknes", 'unknown name "thicknes". Use thickness'),
        ("max_mode_frequency", ""),
    ],
)
def test_only_single_numbers_have_sensitivities(address: str, message: str) -> None:
    stage = double_triangle(SM_REF_B)
    if not message:
        assert np.all(fs.sensitivities(stage, (address,), modes=1).frequency == 0.0)
        return
    with pytest.raises(fs.DesignError, match=message):
        fs.sensitivities(stage, (address,), modes=1)


def test_numbers_that_are_not_stated_have_no_sensitivity() -> None:
    with pytest.raises(fs.DesignError, match=r"parts\.stack_vertical\.preload: not specified in the description\. Specify it"):
        fs.sensitivities(double_triangle(SM_REF_B), ("parts.stack_vertical.preload",), modes=1)


def test_without_enough_actuators_the_frequencies_are_still_given() -> None:
    """Two of three posts of the tip-tilt mount: frequencies as before, against finite differences; no gains, and the reason."""
    stage = case("tip-tilt")
    place = {("P1-P2" if name == "P1-P3" else name): placement for name, placement in stage.placements.items()}
    stage = replace(stage, placements=place, requirements={})
    address = "parts.leaf.thickness"
    found = fs.sensitivities(stage, (address,), modes=MODES)
    value = get(stage, address)
    high, low = (fs.modes(fs.lumped(set_value(stage, address, value * factor))).frequencies[:MODES] for factor in (1 + 1e-5, 1 - 1e-5))
    np.testing.assert_allclose(
        found.frequency[0], _means((high - low) / (2e-5 * value), found.clusters), rtol=1e-5, atol=1e-5 * found.frequencies.min() / value
    )
    assert found.actuators == ()
    assert found.gain.shape == found.loss.shape == (1, 0)
    assert "2 strokes do not determine the platform's 3 ideal motions" in found.missing["lost_motion"]
    assert loss_sensitivity_table(found) is None


def test_nothing_is_missing_from_an_actuated_stage() -> None:
    found = fs.sensitivities(double_triangle(SM_REF_B), ("parts.neck.thickness",), modes=1)
    assert dict(found.missing) == {}
    assert found.loss.shape == (1, 6)
