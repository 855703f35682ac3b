"""Laws of the mapped model's chains: what bears an actuator's load, by statics alone, is its strut; and ideal joints give way nowhere."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given

from flexstage.base.finding import DesignError
from flexstage.beams.compliance import compliance
from flexstage.cases.parallelogram import parallelogram
from flexstage.mechanism.assembly.expand import expand
from flexstage.mechanism.assembly.pattern import Pose
from flexstage.mechanism.mechanism import GROUND, PLATFORM, Link, Mechanism, Placement, Unit
from flexstage.models.linear.static import static_gain
from flexstage.models.mapped import chain_compliance, computed_stiffness, mapped
from flexstage.parts.body import Body, Inertia
from flexstage.parts.compliance_matrix import Joint
from flexstage.parts.freedom import Freedom
from flexstage.parts.material import Material
from flexstage.parts.neck import Neck
from flexstage.parts.piezo import Piezo
from flexstage.parts.profile import Circular
from flexstage.spatial.frame import COMPONENTS, transport
from tests.conftest import examples
from tests.laws.shared import ideal
from tests.laws.strategies import actuated_platforms

ALONG = (1.0, 0.0, 0.0)


@examples(10)
@given(actuated_platforms())
def test_what_bears_the_load_of_a_straight_strut_is_the_strut(mechanism):
    assembly, kinematics = expand(mechanism), ideal(mechanism)
    if len(kinematics.actuators) > kinematics.mobility:
        return  # redundant strokes: statics does not share a load among them
    for name, drive in assembly.actuators.items():
        if mechanism.placements[name].unit == "direct":
            assert np.isclose(1.0 / chain_compliance(assembly, kinematics, name), computed_stiffness(assembly, drive), rtol=1e-6)


def bent():
    """A stack that pushes a slide; beside its line a neck takes the push on to the platform, which slides too."""
    return Mechanism(
        "bent",
        materials={"metal": Material(2e11, 0.3, 7800.0)},
        parts={
            "stack": Piezo(stroke=1e-5, stiffness=2e7, length=0.02, diameter=0.008),
            "neck": Neck("metal", 0.002, Circular(0.004)),
            "slide": Joint((Freedom.X,)),
            "ball": Joint((Freedom.RX, Freedom.RY, Freedom.RZ)),
        },
        bodies={"cart": Body(), PLATFORM: Body(mass=1.0, inertia=Inertia(1e-3, 1e-3, 1e-3), points={"tip": (0.1, 0.05, 0.0)})},
        links={
            "pzt": Link((GROUND, "tip"), "stack", (0.0, 0.0, 0.0), ALONG),
            "pin": Link(("tip", "cart"), "ball", (0.01, 0.0, 0.0), ALONG),
            "rail": Link((GROUND, "cart"), "slide", (0.02, 0.0, 0.0), ALONG, (0.0, 0.0, 1.0)),
            "front": Link(("cart", PLATFORM), "neck", (0.05, 0.03, 0.0), ALONG),
            "guide": Link((GROUND, PLATFORM), "slide", (0.08, 0.03, 0.0), ALONG, (0.0, 0.0, 1.0)),
        },
    )


def test_a_chain_beside_its_line_with_ideal_joints_is_its_elastic_links():
    stage = replace(bent(), bodies={**bent().bodies, "tip": Body()})
    neck = compliance(stage.parts["neck"], stage.materials["metal"])[0, 0]
    model = mapped(stage)
    assert np.isclose(model.stiffness_matrix[0, 0], 1.0 / (neck + 1.0 / 2e7), rtol=1e-9)
    own = {name: link for name, link in stage.links.items() if name != "guide"}
    bodies = {name: body for name, body in stage.bodies.items() if name != PLATFORM}
    units = replace(
        stage,
        bodies={PLATFORM: stage.bodies[PLATFORM]},
        links={"guide": stage.links["guide"]},
        units={"drive": Unit(bodies, own)},
        placements={"B": Placement("drive", Pose())},
    )
    assert np.isclose(mapped(units).stiffness_matrix[0, 0], model.stiffness_matrix[0, 0], rtol=1e-12)


def test_named_points_move_with_the_platform():
    stage = parallelogram()
    model = mapped(stage)
    points = expand(stage).points
    assert points
    twist = static_gain(model, [f"{PLATFORM}.{axis}" for axis in COMPONENTS], ["platform.fx"]).values
    for name, (_, point) in points.items():
        found = static_gain(model, [f"{name}.{axis}" for axis in COMPONENTS], ["platform.fx"]).values
        arm = transport(point - expand(stage).bodies[PLATFORM].reference)
        np.testing.assert_allclose(found, arm @ twist, atol=1e-18)
        back = static_gain(model, ["platform.x"], [f"{name}.f{axis}" for axis in "xyz"]).values
        forth = static_gain(model, [f"{name}.{axis}" for axis in "xyz"], ["platform.fx"]).values
        np.testing.assert_allclose(back[0], forth[:, 0], atol=1e-18)


def test_what_statics_does_not_tell_is_refused_by_name():
    stage = replace(bent(), bodies={**bent().bodies, "tip": Body()})
    twin = replace(stage.links["front"], at=(0.05, -0.03, 0.0))
    with pytest.raises(DesignError, match="pzt"):
        mapped(replace(stage, links={**stage.links, "twin": twin}))
