"""A stage as a multibody system of Exudyn (J. Gerstmayr, University of Innsbruck), built from the expanded description.

Shared with flexstage: the expansion (where things are, what they weigh) and the laws of single parts. Everything else is Exudyn's: the
kinematics of bodies and markers, the assembly, the linearisation, the eigenvalues and the nonlinear static solution.

- A body is a node of six coordinates (position, Tait-Bryan angles) at the body's reference point; each mass it carries is an
  `ObjectRigidBody`.
- A link is an `ObjectConnectorRigidBodySpringDamper` between markers at the link's frame. Its Jacobian is analytic in the default
  formulation; the intrinsic formulation is differentiated numerically, and its frequencies are good to 5e-5 only.
- Locked freedoms of a link are the constrained axes of an `ObjectJointGeneric`.
- The consistent mass of a link, which a rigid body cannot have, is an `ObjectGenericODE2` on the nodes of its bodies.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TypeVar

import exudyn as exu
import numpy as np
from exudyn.itemInterface import (
    MarkerBodyRigid,
    NodeRigidBodyRxyz,
    ObjectConnectorRigidBodySpringDamper,
    ObjectGenericODE2,
    ObjectGround,
    ObjectJointGeneric,
    ObjectRigidBody,
)

from flexstage.base.number import Array
from flexstage.beams.compliance import Law, law
from flexstage.beams.mass import mass
from flexstage.mechanism.assembly.expand import Assembly, PlacedLink
from flexstage.mechanism.assembly.moving_mass import carried_masses
from flexstage.mechanism.mechanism import GROUND, PLATFORM, Mechanism
from flexstage.parts.freedom import ALL

Value = TypeVar("Value")


@dataclass
class System:
    """An Exudyn system `mbs` with the numbers of the stage's bodies, nodes and connectors in it."""

    container: exu.SystemContainer
    mbs: exu.MainSystem
    laws: dict[str, Law]
    masses: dict[str, Array]
    bodies: dict[str, int] = field(default_factory=dict)
    nodes: dict[str, int] = field(default_factory=dict)
    connectors: dict[str, int] = field(default_factory=dict)
    references: dict[str, Array] = field(default_factory=dict)


def system(mechanism: Mechanism, assembly: Assembly) -> System:
    """The stage in Exudyn, assembled; bodies in the order of our coordinates, the platform first."""
    container = exu.SystemContainer()
    result = System(container, container.AddSystem(), of_parts(law, assembly), of_parts(mass, assembly))
    result.bodies[GROUND] = result.mbs.AddObject(ObjectGround())
    result.references[GROUND] = np.zeros(3)
    for name in sorted(assembly.bodies, key=lambda name: name != PLATFORM):
        _add_body(result, mechanism, assembly, name)
    for name, link in assembly.links.items():
        _add_link(result, name, link)
    result.mbs.Assemble()
    return result


def of_parts(function: Callable[..., Value], assembly: Assembly) -> dict[str, Value]:
    """What a function gives for every link's part, computed once for links of one part."""
    links = assembly.links.items()
    found = {(id(link.part), id(link.material)): link for _, link in links}
    values = {key: function(link.part, link.material) for key, link in found.items()}
    return {name: values[id(link.part), id(link.material)] for name, link in links}


def _add_body(result: System, mechanism: Mechanism, assembly: Assembly, name: str) -> None:
    placed = assembly.bodies[name]
    node = result.mbs.AddNode(NodeRigidBodyRxyz(referenceCoordinates=[*placed.reference, 0.0, 0.0, 0.0]))
    result.nodes[name], result.references[name] = node, placed.reference
    loads = [(float(item.mass), item.centre - placed.reference, item.inertia) for item in carried_masses(mechanism, placed)]
    for kilograms, arm, inertia in loads or [(0.0, np.zeros(3), np.zeros((3, 3)))]:
        at_node = inertia + kilograms * (arm @ arm * np.eye(3) - np.outer(arm, arm))
        components = [at_node[row, column] for row, column in ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))]
        body = ObjectRigidBody(nodeNumber=node, mass=kilograms, centerOfMass=arm, inertia=components)
        result.bodies[name] = result.mbs.AddObject(body)


def _add_link(result: System, name: str, link: PlacedLink) -> None:
    markers = [_marker(result, body, link) for body in link.joins]
    connector = ObjectConnectorRigidBodySpringDamper(markerNumbers=markers, stiffness=result.laws[name].stiffness)
    result.connectors[name] = result.mbs.AddObject(connector)
    locked = result.laws[name].locked
    if locked:
        axes = [int(freedom in locked) for freedom in ALL]
        result.mbs.AddObject(ObjectJointGeneric(markerNumbers=markers, constrainedAxes=axes))
    moving = [(end, body) for end, body in enumerate(link.joins) if body != GROUND]
    ends = np.zeros((12, 6 * len(moving)))
    for number, (end, body) in enumerate(moving):
        ends[6 * end : 6 * end + 6, 6 * number : 6 * number + 6] = _end_twist(link, result.references[body])
    inertia = ends.T @ result.masses[name] @ ends
    result.mbs.AddObject(ObjectGenericODE2(nodeNumbers=[result.nodes[body] for _, body in moving], massMatrix=inertia))


def _marker(result: System, body: str, link: PlacedLink) -> int:
    place = exu.HT(rotation=link.frame.rotation, translation=link.frame.position - result.references[body])
    return result.mbs.AddMarker(MarkerBodyRigid(bodyNumber=result.bodies[body], localHT=place))


def _end_twist(link: PlacedLink, reference: Array) -> Array:
    """The twist of a link's end, in the link's frame, per twist of the body it is on: v + w x r, turned (written anew here)."""
    turn = link.frame.rotation.T
    lever = np.cross(np.eye(3), link.frame.position - reference).T
    return np.block([[turn, turn @ lever], [np.zeros((3, 3)), turn]])


def frequencies(peer: System) -> Array:
    """Undamped frequencies [Hz], by Exudyn alone."""
    values, _ = peer.mbs.ComputeODE2Eigenvalues(convert2Frequencies=True)
    return values


def matrices(peer: System) -> tuple[Array, Array]:
    """Inertia and stiffness matrix in the coordinates of Exudyn's nodes, constraints left aside."""
    inertia, stiffness, _ = peer.mbs.ComputeLinearizedSystem()
    return inertia, stiffness


def stroked(peer: System, link: str, stroke: float) -> Array:
    """Displacements and angles (6,) of the platform when the link has the free stroke [m]: Exudyn's nonlinear equilibrium."""
    settings = exu.SimulationSettings()
    settings.solution.file.write = False
    settings.staticSolver.verboseMode = 0
    settings.staticSolver.newton.relativeTolerance = 1e-9
    peer.mbs.SetObjectParameter(peer.connectors[link], "offset", [stroke, 0.0, 0.0, 0.0, 0.0, 0.0])
    peer.mbs.SolveStatic(settings)
    peer.mbs.SetObjectParameter(peer.connectors[link], "offset", [0.0] * 6)
    return np.array(peer.mbs.GetNodeOutput(peer.nodes[PLATFORM], exu.OutputVariableType.Coordinates))
