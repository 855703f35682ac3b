"""Large displacements against Exudyn: a cross hinge of two leaves, there of geometrically exact beam elements (J. Gerstmayr).

Elements of constant strain between rigid nodes, 16 and 32 a leaf, extrapolated by Richardson; runs with 64 differ from that by
2e-7. Exudyn knows no section but a beam's: the leaves here are beams too, without what twist stretches (trapeze effect and Wagner's term).
"""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("exudyn", reason="Exudyn has no wheels for this interpreter")

import exudyn as exu
from exudyn.itemInterface import (
    Force,
    MarkerBodyRigid,
    MarkerNodeRigid,
    NodeRigidBodyRxyz,
    ObjectBeamGeometricallyExact,
    ObjectGround,
    ObjectJointGeneric,
    ObjectRigidBody,
    Torque,
)

import flexstage as fs
from flexstage.base.number import Array
from flexstage.base.units.scale import Z
from flexstage.parts.leaf import LeafSection
from flexstage.parts.section import Rectangle, cowper_rectangle
from flexstage.spatial.rotation import exponential, logarithm

STEEL = fs.Material(young=200e9, poisson=0.3, density=0.0)
LEAF = fs.Leaf("steel", length=0.08, thickness=0.35e-3, width=0.03, section=LeafSection.BEAM)
SIDES = {"low": (1.0, -0.02), "high": (-1.0, 0.02)}
"""Each leaf's inclination to x, in units of 45 degrees, and its height [m]."""


def hinge() -> fs.Mechanism:
    """Leaves that cross in the middle, one above the other."""
    links = {
        name: fs.Link(("ground", "platform"), "leaf", (0.0, 0.0, height), (1.0, sign, 0.0), bends=Z)
        for name, (sign, height) in SIDES.items()
    }
    body = fs.Body(mass=1.0, inertia=fs.Inertia(1.0, 1.0, 1.0), reference=(0.0, 0.0, 0.0))
    return fs.Mechanism("", {"steel": STEEL}, {"leaf": LEAF}, {"platform": body}, links, gravity=(0.0, 0.0, 0.0))


def ours(wrench: Array) -> Array:
    """Displacement and rotation vector (6,) of the platform."""
    model = fs.nonlinear(hinge())
    plain = tuple(
        replace(each, law=replace(each.law, stretch=0.0 * each.law.stretch, trapeze=0.0 * each.law.trapeze)) for each in model.flexures
    )
    loads = dict(zip([f"platform.{name}" for name in ("fx", "fy", "fz", "mx", "my", "mz")], wrench, strict=True))
    return fs.equilibrium(replace(model, flexures=plain), loads).twist()


def theirs(wrench: Array, count: int) -> Array:
    """The same by `count` elements a leaf."""
    mbs = exu.SystemContainer().AddSystem()
    ground = mbs.AddObject(ObjectGround())
    node = mbs.AddNode(NodeRigidBodyRxyz(referenceCoordinates=[0.0] * 6))
    platform = mbs.AddObject(ObjectRigidBody(nodeNumber=node, mass=1.0, inertia=[1.0, 1.0, 1.0, 0.0, 0.0, 0.0]))
    for sign, height in SIDES.values():
        _leaf(mbs, (ground, platform), sign * 0.25 * np.pi, height, count)
    marker = mbs.AddMarker(MarkerNodeRigid(nodeNumber=node))
    mbs.AddLoad(Force(markerNumber=marker, loadVector=wrench[:3]))
    mbs.AddLoad(Torque(markerNumber=marker, loadVector=wrench[3:]))
    mbs.Assemble()
    settings = exu.SimulationSettings()
    settings.solution.file.write = False
    settings.staticSolver.verboseMode = 0
    settings.staticSolver.numberOfLoadSteps = 4
    settings.staticSolver.newton.relativeTolerance = 1e-10
    settings.staticSolver.newton.absoluteTolerance = 1e-9
    mbs.SolveStatic(settings)
    turn = np.reshape(mbs.GetNodeOutput(node, exu.OutputVariableType.RotationMatrix), (3, 3))
    return np.concatenate([mbs.GetNodeOutput(node, exu.OutputVariableType.Displacement), logarithm(turn)])


def _leaf(mbs: exu.MainSystem, bodies: tuple[int, int], angle: float, height: float, count: int) -> None:
    section = Rectangle(LEAF.thickness, LEAF.width, cowper_rectangle(0.3))
    along, across = 200e9, 200e9 / 2.6
    beam = exu.BeamSection()
    lateral = across * section.area / section.shear
    beam.stiffnessMatrix = np.diag(
        [along * section.area, lateral, lateral, across * section.torsion, along * section.inertia_y, along * section.inertia_z]
    )
    beam.massPerLength = 1.0
    turn = exponential(np.array([0.0, 0.0, angle]))
    places = [(share - 0.5) * LEAF.length * turn[:, 0] + [0.0, 0.0, height] for share in np.linspace(0.0, 1.0, count + 1)]
    nodes = [mbs.AddNode(NodeRigidBodyRxyz(referenceCoordinates=[*place, 0.0, 0.0, angle])) for place in places]
    for pair in itertools.pairwise(nodes):
        mbs.AddObject(ObjectBeamGeometricallyExact(nodeNumbers=list(pair), length=LEAF.length / count, sectionData=beam))
    for body, place, end in ((bodies[0], places[0], nodes[0]), (bodies[1], places[-1], nodes[-1])):
        fixed = mbs.AddMarker(MarkerBodyRigid(bodyNumber=body, localHT=exu.HT(rotation=turn, translation=place)))
        moving = mbs.AddMarker(MarkerNodeRigid(nodeNumber=end))
        mbs.AddObject(ObjectJointGeneric(markerNumbers=[fixed, moving], constrainedAxes=[1] * 6))


@pytest.mark.parametrize("wrench", [(0.0, 0.0, 0.0, 0.0, 0.0, 0.2), (1.0, 2.0, 5.0, 0.05, -0.1, 0.18)], ids=["plane", "space"])
def test_a_cross_hinge_turns_by_twenty_degrees(wrench: tuple[float, ...]) -> None:
    """1.3 mm and 0.37 rad; every component is compared with the largest of its kind."""
    loads = np.array(wrench)
    coarse, fine = (theirs(loads, count) for count in (16, 32))
    found, expected = ours(loads).reshape(2, 3), (fine + (fine - coarse) / 3.0).reshape(2, 3)
    assert (np.max(np.abs(found - expected), axis=1) < 1e-6 * np.max(np.abs(expected), axis=1)).all()
