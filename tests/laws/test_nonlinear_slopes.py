"""Slopes at large displacements against what dimensions alone say.

What only forces and moduli move depends on their ratio: slopes by the modulus are those by all loads, reversed. A stage whose lengths,
forces and moments are s, s^2 and s^3 times as large moves s times as far.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

import flexstage as fs
from flexstage.base.processes.native import SWITCH
from flexstage.cases.parallelogram import parallelogram
from flexstage.mechanism.addresses.address import get, set_value
from flexstage.models.nonlinear.compiled import kernel
from flexstage.models.nonlinear.elements.strain import strains
from flexstage.models.nonlinear.equilibrium import State, equilibria, equilibrium
from flexstage.models.nonlinear.gradients import evaluate_designs, gradients
from flexstage.models.nonlinear.linearise import linearise
from flexstage.models.nonlinear.paths.critical_load import critical_load
from flexstage.models.nonlinear.stage import nonlinear
from tests.laws.test_nonlinear import LEAF, NONE, SPACE, UNIT, guide, loads
from tests.laws.test_nonlinear_extremes import stage, wrenches

SHARES = np.array([[1.0 + 1e-4], [1.0 - 1e-4]])


def moved_by_loads(mechanism: fs.Mechanism, wrench: np.ndarray, powers: tuple[int, ...] = (1, 1, 1, 1, 1, 1)) -> np.ndarray:
    """The slope (6,) of the platform's twist by a factor on the loads, or by its powers."""
    found = equilibrium(nonlinear(mechanism), loads(wrench * SHARES**powers)).twist()
    return (found[0] - found[1]) / 2e-4


@pytest.mark.parametrize("seed", [0, 4, 8, *(pytest.param(each, marks=pytest.mark.full) for each in (1, 2, 5))])
def test_slopes_by_the_modulus_are_those_by_forces(seed: int):
    """Leaves, rods and notches anywhere."""
    rng = np.random.default_rng([11, seed])
    mechanism = stage(rng)
    wrench = 0.03 * wrenches(rng, nonlinear(mechanism), 1)[0]
    (found,) = gradients(mechanism, ["materials.steel.young"], State.twist, loads(wrench))
    expected = -moved_by_loads(mechanism, wrench)
    assert found * mechanism.materials["steel"].young == pytest.approx(expected, abs=1e-7 * np.max(np.abs(expected)))


LENGTHS = (
    *(f"parts.leaf.{name}" for name in ("length", "thickness", "width")),
    *(f"links.{link}.at.{axis}" for link in ("left", "right") for axis in ("x", "y")),
    *(f"bodies.platform.{place}.x" for place in ("centre", "reference")),
)


def test_slopes_by_all_lengths_are_a_larger_stage():
    wrench = SPACE * UNIT
    state = equilibrium(nonlinear(guide()), loads(wrench))
    found = gradients(guide(), LENGTHS, State.twist, loads(wrench))
    values = np.array([get(guide(), name) for name in LENGTHS])
    larger = values @ found + moved_by_loads(guide(), wrench, (2, 2, 2, 3, 3, 3))
    expected = np.concatenate([state.displacement(), np.zeros(3)])
    assert larger == pytest.approx(expected, abs=1e-6 * np.max(np.abs(state.twist())))


def scaled_by_the_modulus(results: Callable[[State], np.ndarray], powers: list[float]) -> None:
    """Of a held stage frequencies go with the root of the modulus, forces, stresses and critical loads with the modulus."""
    held = {"platform.y": 0.01}
    expected = results(equilibrium(nonlinear(guide()), hold=held))
    (found,) = gradients(guide(), ["materials.steel.young"], results, hold=held)
    scale = np.maximum(np.abs(expected), 1e-3 * np.max(np.abs(expected)))
    assert np.max(np.abs(200e9 * found - np.array(powers) * expected) / scale) < 1e-6


def test_slopes_of_frequencies_forces_and_stresses():
    scaled_by_the_modulus(lambda state: fs.modes(linearise(state)).frequencies[:3], [0.5] * 3)
    scaled_by_the_modulus(lambda state: np.array([*state.reactions, *state.wrench("left")[:3]]), [1.0] * 4)
    scaled_by_the_modulus(lambda state: strains(state).stress, [1.0] * 2)


@pytest.mark.full
def test_slopes_of_critical_loads():
    scaled_by_the_modulus(lambda state: np.array([critical_load(state.model, {"platform.fx": -1.0}).factor]), [1.0])


def test_a_batch_of_designs_is_its_designs():
    thicknesses = np.array([0.4e-3, 0.5e-3, 0.6e-3])
    found = evaluate_designs(set_value(guide(), "parts.leaf.thickness", thicknesses), State.twist, loads(SPACE * UNIT * [[1.0], [0.5]]))
    assert found.shape == (3, 2, 6)
    alone = equilibrium(nonlinear(set_value(guide(), "parts.leaf.thickness", 0.6e-3)), loads(SPACE * UNIT)).twist()
    assert found[2, 0] == pytest.approx(alone, abs=1e-14)
    assert LEAF.thickness == thicknesses[1]


def everywhere_larger(mechanism: fs.Mechanism, factor: float) -> fs.Mechanism:
    """A stage with other moduli, stacks and places: all that is asked of links about centres and of held coordinates differs."""
    softer = {name: replace(each, young=each.modulus / factor) for name, each in mechanism.materials.items()}
    stacks = {
        name: replace(part, stiffness=factor * part.stiffness) for name, part in mechanism.parts.items() if isinstance(part, fs.Piezo)
    }
    links = {name: replace(link, at=tuple(factor * place for place in link.at or NONE)) for name, link in mechanism.links.items()}
    return replace(mechanism, materials=softer, parts={**mechanism.parts, **stacks}, links=links)


@pytest.mark.parametrize("compiled", [True, False])
@pytest.mark.parametrize("seed", [0, pytest.param(1, marks=pytest.mark.full), None])
def test_designs_in_one_run_are_each_by_itself(seed: int | None, compiled: bool, monkeypatch: pytest.MonkeyPatch):
    """Random stages of flexures under loads, and one with a stack, hinges and held coordinates: to the bit, in numpy to 1e-12."""
    rng = np.random.default_rng([29, seed or 0])
    base = parallelogram() if seed is None else stage(rng)
    models = [nonlinear(everywhere_larger(base, factor)) for factor in (1.0, 1.02, 0.97)]
    given = {"B": np.array([5e-6, 8e-6])} if seed is None else loads(0.02 * wrenches(rng, models[0], 2))
    hold = [{"platform.rz": 1e-4 * place, "platform.y": 1e-6} for place in range(3)] if seed is None else {}
    if not compiled:
        monkeypatch.setenv(SWITCH, "off")
    kernel.cache_clear()
    together = equilibria(models, given, hold=hold)
    alone = [equilibrium(model, given, hold=hold[place] if seed is None else {}) for place, model in enumerate(models)]
    monkeypatch.undo()
    kernel.cache_clear()
    for one, other in zip(together, alone, strict=True):
        assert one.converged.all()
        assert one.pose.position == pytest.approx(other.pose.position, rel=0.0, abs=0.0 if compiled else 1e-12)
        assert one.iterations.tolist() == other.iterations.tolist()
        assert one.reactions == pytest.approx(other.reactions, rel=0.0 if compiled else 1e-9, abs=0.0)


def test_designs_of_another_structure_are_refused_by_name():
    other = guide()
    other = replace(other, links={"left": other.links["left"], "far": other.links["right"]})
    with pytest.raises(fs.DesignError, match=r"design 2: flexures differ from the first design: far of kind .* instead of right of kind"):
        equilibria([nonlinear(guide()), nonlinear(other)])


def test_slopes_are_by_numbers_that_are_stated():
    with pytest.raises(fs.DesignError, match="not a single number"):
        gradients(guide(), ["parts.leaf"], State.twist)
