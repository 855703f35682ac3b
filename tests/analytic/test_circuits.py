"""Coils in series on one amplifier (push-pull): one input, forces with their polarity, electrical numbers by Kirchhoff's laws."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import flexstage as fs
from flexstage.analysis.workspace.force_workspace import force_workspace
from flexstage.control.plant_models.electronics import sampling_chain
from flexstage.experiment.virtual_rig.rig import rig
from flexstage.experiment.virtual_rig.setup import NoiseDrive, RigSetup
from flexstage.mechanism.assembly.expand import expand
from flexstage.mechanism.checks import check
from flexstage.mechanism.mechanism import GROUND, PLATFORM, Link, Mechanism
from flexstage.models.ideal import ideal
from flexstage.models.linear.frequency import transfer
from flexstage.models.linear.port import ports
from flexstage.models.linear.static import static_gain
from flexstage.models.lumped import lumped
from flexstage.models.nonlinear.equilibrium import equilibrium
from flexstage.models.nonlinear.linearise import linearise
from flexstage.models.nonlinear.stage import nonlinear

WHOLE = fs.case("voice-coil-stage")
TWIST = tuple(f"platform.{name}" for name in ("x", "y", "z", "rx", "ry", "rz"))
LEFT, RIGHT = (-0.03, 0.0, 0.0), (0.03, 0.0, 0.0)
X, BACK = (1.0, 0.0, 0.0), (-1.0, 0.0, 0.0)


def driven(**links: Link) -> Mechanism:
    """The stage with other motors."""
    others = {name: link for name, link in WHOLE.links.items() if name != "motor"}
    return replace(WHOLE, links=others | links)


def coil(at: tuple[float, float, float], along: tuple[float, float, float], circuit: str | None = None) -> Link:
    return Link((GROUND, PLATFORM), "coil", at, along, circuit=circuit)


PAIR = driven(left=coil(LEFT, X, "pair"), right=coil(RIGHT, BACK, "-pair"))
"""One coil pushes from the left, the other, of opposite polarity, pulls from the right."""
APART = driven(left=coil(LEFT, X), right=coil(RIGHT, BACK))
SAME_WAY = driven(left=coil(LEFT, X, "pair"), right=coil(RIGHT, BACK, "pair"))


def gains(stage: Mechanism, inputs: tuple[str, ...]) -> np.ndarray:
    model = lumped(stage)
    assert stage.damping is not None
    return transfer(model, ports(model, TWIST, inputs), np.array([0.0, 10.0, 300.0]), stage.damping)


def test_push_pull_is_twice_one_coil_at_the_same_current() -> None:
    apart, pair = gains(APART, ("left", "right")), gains(PAIR, ("pair",))
    largest = np.max(np.abs(apart))
    np.testing.assert_allclose(pair[..., 0], 2.0 * apart[..., 0], atol=1e-9 * largest)
    np.testing.assert_allclose(pair[..., 0], apart[..., 0] - apart[..., 1], atol=1e-9 * largest)
    np.testing.assert_allclose(gains(SAME_WAY, ("pair",)), 0.0, atol=1e-9 * largest)
    assert expand(PAIR).actuators == {"pair": "left"}
    assert ideal(PAIR).thrust.ravel() == pytest.approx([20.0])


def test_a_circuit_may_have_the_name_of_its_first_link() -> None:
    named = driven(left=coil(LEFT, X), right=coil(RIGHT, BACK, "-left"))
    np.testing.assert_allclose(gains(named, ("left",)), gains(PAIR, ("pair",)), rtol=1e-12)


def test_resistance_voltage_heat_and_travel_are_those_of_a_series() -> None:
    """V = 2 R i, P = 2 i^2 R, each coil as warm as alone; i_max = V/(2 R), slew V/(2 L); travel is that of each."""
    one = replace(WHOLE.parts["coil"], voltage=12.0)  # type: ignore[type-var]
    single, pair = (replace(stage, parts={**WHOLE.parts, "coil": one}) for stage in (WHOLE, PAIR))
    found, alone = (force_workspace(stage, ideal(stage), lumped(stage)) for stage in (pair, single))
    gain = static_gain(lumped(pair), ("platform.x",), ("pair",)).values.item()
    bounds, own = (dict(zip(each.bounds.columns, each.bounds.values[0], strict=True)) for each in (found, alone))
    assert bounds["pair voltage"] == pytest.approx(gain * 12.0 / (2.0 * 5.0), rel=1e-9)
    assert bounds["pair continuous current"] == pytest.approx(2.0 * own["motor continuous current"], rel=1e-6)
    assert bounds["pair travel"] == pytest.approx(own["motor travel"], rel=1e-6)
    current = found.current.values.item()
    assert found.voltage.values.item() == pytest.approx(10.0 * current, rel=1e-9)
    assert found.power.values.item() == pytest.approx(10.0 * current**2, rel=1e-9)
    assert found.rise.values.item() == pytest.approx(current**2 * 5.0 * 10.0, rel=1e-9)
    amplifier = sampling_chain(pair).amplifiers["pair"]
    assert (amplifier.high, amplifier.slew) == (pytest.approx(1.2), pytest.approx((12.0 - 0.5 * 10.0 * 1.2) / 2e-3))


def test_the_nonlinear_model_and_the_rig_drive_the_circuit() -> None:
    about = linearise(equilibrium(nonlinear(PAIR), {"pair": 1e-3}))
    found, expected = (static_gain(model, ("platform.x",), ("pair",)).values.item() for model in (about, lumped(PAIR)))
    assert found == pytest.approx(expected, rel=1e-2)
    record = rig(PAIR, lumped(PAIR), RigSetup(seconds=1.0, rate=512.0, drive=NoiseDrive(current=1e-2, band=(0.0, 200.0))))
    assert [each.name for each in record.inputs] == ["pair"]
    assert fs.loads(fs.dumps(PAIR)).links["right"].circuit == "-pair"


@pytest.mark.parametrize(
    ("links", "text"),
    [
        ({"left": coil(LEFT, X, "no name")}, 'invalid name "no name"'),
        ({"left": Link((GROUND, PLATFORM), "leaf", LEFT, X, (0.0, 0.0, 1.0), circuit="pair")}, "exerts no force"),
        ({"left": coil(LEFT, X), "right": coil(RIGHT, X, "left")}, 'a link or an instance also has the name "left"'),
        ({"left": coil(LEFT, X, "pair"), "right": replace(coil(RIGHT, X, "pair"), part="other")}, "Use one part for all links"),
    ],
)
def test_what_no_circuit_is_made_of_is_refused(links: dict[str, Link], text: str) -> None:
    stage = replace(driven(**links), parts={**WHOLE.parts, "other": fs.ForceActuator()})
    assert text in "; ".join(map(str, check(stage)))
