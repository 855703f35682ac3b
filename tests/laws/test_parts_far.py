"""Laws of parts of all kinds at large displacements: at rest they are the linear model's, and so is what their own weight does."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import flexstage as fs
from flexstage.analysis.loaded.stability import prestress
from flexstage.analysis.loaded.strained import left_out
from flexstage.analysis.workspace.load import dead_loads
from flexstage.mechanism.assembly.pattern import Pose
from flexstage.mechanism.mechanism import Force, Link, Mechanism, Stop
from flexstage.models.linear.static import displacement, static_gain
from flexstage.parts.part import Part
from flexstage.spatial.frame import COMPONENTS, FORCES
from tests.show.zoo import PARTS

STEEL = fs.Material(young=200e9, poisson=0.3, density=7750.0)
MEMBRANE = fs.Membrane("steel", 8e-3, 30e-3, 0.2e-3, mass=0.01)
GIVEN = fs.ComplianceMatrix(
    compliance=tuple(tuple(row) for row in np.diag([1e-7, 1e-6, 1e-6, 1e-2, 1e-2, 1e-2]).tolist()), free=(), mass=0.03
)
KINDS: dict[str, Part] = {**PARTS, "membrane": MEMBRANE, "given": GIVEN, "stack": fs.Piezo(60e-6, 50e6, 0.04, 0.01, mass=0.05)}
LOOSE = ("ball", "coil", "spring")
"""Kinds that hold a body in some directions only: they are tried between a body and the ground that others hold too."""
LEAFY = {"leaf": 1.2e-2, "cross": 4e-3, "wheel": 4e-3, "folded": 2e-2}
"""Twist, with the lumped model's one decay 1 % too soft in leaves two to three times as long as wide; and shear at the clamps."""
NAMES = tuple(f"platform.{each}" for each in COMPONENTS), tuple(f"platform.{each}" for each in FORCES)


def stage(part: Part, kind: str) -> Mechanism:
    """A part to the right of the ground, a heavy body at its end; loose parts beside a rod."""
    body = fs.Body(mass=0.2, inertia=fs.Inertia(1e-4, 2e-4, 3e-4), centre=(0.03, 0.01, 0.005), reference=(0.02, 0.0, 0.0))
    links = {"own": Link(("ground", "platform"), "own", (0.0, 0.0, 0.0), (1.0, 0.0, 0.0), bends=(0.0, 0.0, 1.0))}
    parts: dict[str, Part] = {"own": part}
    if kind in LOOSE:
        parts["rod"] = fs.Rod("steel", 0.03, 0.003)
        links["rod"] = Link(("ground", "platform"), "rod", (0.0, 0.02, 0.0), (1.0, 0.0, 0.0), bends=(0.0, 0.0, 1.0))
    return Mechanism("kind", materials={"steel": STEEL}, parts=parts, bodies={"platform": body}, links=links, gravity=(1.0, -9.0, 3.0))


@pytest.mark.parametrize("kind", sorted(KINDS))
def test_at_rest_and_under_its_weight_it_is_the_linear_models(kind: str) -> None:
    whole = stage(KINDS[kind], kind)
    linear, model = fs.lumped(whole), fs.nonlinear(whole)
    near = fs.linearise(fs.equilibrium(model, weight=0.0, stated=0.0))
    gains = [static_gain(each, *NAMES).values for each in (near, linear)]
    size, leafy = np.sqrt(np.outer(*[np.abs(np.diag(gains[1]))] * 2)), LEAFY.get(kind, 1e-6)
    assert np.max(np.abs(gains[0] - gains[1]) / size) < leafy
    share = 1e-5
    load = dead_loads(whole, linear)["own weight"]
    sag = linear.output[linear.output_index(NAMES[0])] @ displacement(linear, load[..., None])[:, 0]
    found = fs.equilibrium(model, weight=share, stated=0.0).twist() / share
    scale = np.sqrt(np.diag(gains[1]) * np.max(sag**2 / np.diag(gains[1])))
    assert np.max(np.abs(found - sag) / scale) < max(leafy, 1e-3)


def test_contacts_that_lift_and_stops_that_are_passed_are_told() -> None:
    """A ball is pressed on its seat or pulled off it; a rod's end goes less and more than 0.1 mm to a stop, and away from it."""
    ball = fs.nonlinear(stage(KINDS["ball"], "ball"))
    assert list(left_out(fs.equilibrium(ball, {"platform.fx": -100.0}, weight=0.0))) == []
    for pull in (0.2, 400.0):  # the rod gives way by little, so that the preload is nearly all gone as it stands
        assert [each.where for each in left_out(fs.equilibrium(ball, {"platform.fx": pull}, weight=0.0))] == ["own"]
    whole = stage(KINDS["rod"], "rod")
    flexible = static_gain(fs.lumped(whole), *NAMES).values[1, 1]
    place = Pose(at=(0.02, 0.0, 0.0), along=(0.0, 1.0, 0.0))
    turned = Stop("ground", replace(place, along=(0.0, -1.0, 0.0)), gap=1e-4, base="platform")  # the same gap seen from its other side
    for stop in (Stop("platform", place, gap=1e-4), turned):
        model = fs.nonlinear(replace(whole, stops={"end": stop}))
        for goes, told in ((0.9e-4, []), (-1.5e-4, []), (1.5e-4, ["end"])):
            state = fs.equilibrium(model, {"platform.fy": goes / flexible}, weight=0.0)
            assert [each.where for each in left_out(state)] == told


AXIAL: dict[str, Part] = {
    "bushing": fs.Spring(diagonal=(1e9, 2e4, 3e4, 50.0, 60.0, 70.0)),
    "strut": fs.Spring(diagonal=(1e9, 2e4, 3e4, 50.0, 60.0, 70.0), length=0.03),
    "stack": fs.Piezo(60e-6, 5e9, 0.04, 0.01),
    "given": replace(GIVEN, compliance=tuple(tuple(row) for row in np.diag([1e-10, 1e-6, 1e-6, 1e-2, 1e-2, 1e-2]).tolist())),
}
"""Kinds that hardly stretch: what stretch does to their arms is none of their geometric stiffness."""


@pytest.mark.parametrize("kind", sorted(AXIAL))
def test_a_force_along_it_changes_its_stiffness_as_linearised_buckling_has_it(kind: str) -> None:
    """The slope of the compliance by the force: what two models of the loaded stage, written apart, must share."""
    step, slopes = 1e-3, []
    still = replace(stage(AXIAL[kind], kind), gravity=(0.0, 0.0, 0.0))
    pulled = [
        replace(still, forces={"pull": Force("platform", at=(0.03, 0.0, 0.0), force=(sign * step, 0.0, 0.0))}) for sign in (1.0, -1.0)
    ]
    for loaded in (lambda each: prestress(each, fs.lumped(each)), lambda each: fs.linearise(fs.equilibrium(fs.nonlinear(each)))):
        ahead, back = (static_gain(loaded(each), *NAMES).values for each in pulled)
        slopes.append((ahead - back) / (2.0 * step))
    assert np.max(np.abs(slopes[1] - slopes[0])) < 2e-3 * np.max(np.abs(slopes[0]))
