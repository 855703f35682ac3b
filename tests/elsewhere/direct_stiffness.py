"""The lumped model of a stage written a second time: plainly, on single designs, by energies, from the description's own words.

Nothing of flexstage's geometry, expansion, mass properties, incidence or assembly is used: only the description's data and, of the beams,
the 6x6 and 12x12 of single parts. The ground is a body like any other here (the last), so that what its motion does can be read off.

A body is a place for six unit motions; a motion gives every end of a link, every centre of mass and every gauge a velocity v + w x r. Then
K_ij = sum of e_i . k e_j and M_ij = sum of m v_i . v_j + w_i . J w_j + the links' own.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from flexstage.beams.compliance import law
from flexstage.beams.mass import mass
from flexstage.mechanism.assembly.pattern import InstanceOrientation, Polar
from flexstage.mechanism.mechanism import Link, Mechanism
from flexstage.parts.body import Body
from flexstage.parts.gauge import SensorSense
from flexstage.parts.piezo import Piezo

AXES = ("x", "y", "z", "rx", "ry", "rz")


@dataclass
class Place:
    """Where something stands: the axes as columns, and the origin."""

    turn: np.ndarray
    at: np.ndarray

    def of(self, point):
        return self.turn @ np.array(point, dtype=float) + self.at

    def direction(self, vector):
        return self.turn @ np.array(vector, dtype=float)


@dataclass
class Direct:
    """Matrices by name of coordinate (`platform.x`), the ground's six last; `natural_...` add up magnitudes, the measure of rounding."""

    coordinates: list[str]
    stiffness: np.ndarray
    natural_stiffness: np.ndarray
    inertia: np.ndarray
    natural_inertia: np.ndarray
    rigid: np.ndarray
    strokes: dict[str, np.ndarray] = field(default_factory=dict)
    gauges: dict[str, np.ndarray] = field(default_factory=dict)
    resultants: dict[str, np.ndarray] = field(default_factory=dict)
    own: dict[str, np.ndarray] = field(default_factory=dict)


def direct(mechanism: Mechanism) -> Direct:
    bodies, links = _drawn(mechanism)
    points = {name: _reference(name, body, place, links, mechanism) for name, (body, place) in bodies.items()}
    points["ground"] = points["platform"]
    names = ["platform", *(name for name in bodies if name != "platform"), "ground"]
    zeros = [np.zeros((6 * len(names), 6 * len(names))) for _ in range(4)]
    result = Direct([f"{name}.{axis}" for name in names for axis in AXES], *zeros, _together(names, points))
    for name, (link, place, joins) in links.items():
        _add_link(result, mechanism, name, link, [_motions(names, points, body, place) for body in joins])
    for name, (body, place) in bodies.items():
        _add_body(result, mechanism, body, place, _velocities(names, points, name, _centre(mechanism, body, place)))
    for name, place, probe in _probes(mechanism):
        sign = 1.0 if probe.positive is SensorSense.OPENS else -1.0
        seen = [_motions(names, points, body, place)[0] for body in (probe.body, probe.base)]
        result.gauges[name] = sign * (seen[0] - seen[1])
    return result


def _together(names, points):
    """The motion (N, 6) of all bodies when they move with the ground as one."""
    return np.vstack([np.vstack(_velocities(["ground"], points, "ground", points[name])) for name in names])


def _add_link(result, mechanism, name, link, ends):
    part = mechanism.parts[link.part]
    material = mechanism.materials.get(getattr(part, "material", None))
    stiffness, inertia = law(part, material).stiffness, mass(part, material)
    strain, both = ends[1] - ends[0], np.vstack(ends)
    result.stiffness += strain.T @ stiffness @ strain
    result.natural_stiffness += np.abs(strain).T @ np.abs(stiffness) @ np.abs(strain)
    result.inertia += both.T @ inertia @ both
    result.natural_inertia += np.abs(both).T @ np.abs(inertia) @ np.abs(both)
    result.resultants[name], result.own[name] = stiffness @ strain, stiffness
    if isinstance(part, Piezo):
        result.strokes[name] = strain.T @ stiffness[:, 0]


def _add_body(result, mechanism, body, place, velocities):
    if body.mass is None:
        assert not body.solids, "outlines are not written a second time"
        return
    v, w = velocities
    tensor = place.turn @ _tensor(body) @ place.turn.T
    result.inertia += body.mass * v.T @ v + w.T @ tensor @ w
    result.natural_inertia += body.mass * np.abs(v).T @ np.abs(v) + np.abs(w).T @ np.abs(tensor) @ np.abs(w)


def _tensor(body):
    """Moments on the diagonal, products negative beside it."""
    if body.inertia is None:
        return np.zeros((3, 3))
    i = body.inertia
    return np.array([[i.xx, -i.xy, -i.xz], [-i.xy, i.yy, -i.yz], [-i.xz, -i.yz, i.zz]])


def _velocities(names, points, body, point):
    """Velocity and angular velocity (3, N) at a point of a body for unit motions of every coordinate."""
    v, w = np.zeros((3, 6 * len(names))), np.zeros((3, 6 * len(names)))
    start = 6 * names.index(body)
    for axis in range(3):
        unit = np.eye(3)[axis]
        v[:, start + axis] = unit
        v[:, start + 3 + axis] = np.cross(unit, point - points[body])
        w[:, start + 3 + axis] = unit
    return v, w


def _motions(names, points, body, place):
    v, w = _velocities(names, points, body, place.at)
    return np.vstack([place.turn.T @ v, place.turn.T @ w])


def _drawn(mechanism):
    """Every body and link of the stage with where it stands; names of a unit's own bodies belong to its copy."""
    stage = Place(np.eye(3), np.zeros(3))
    bodies = {name: (body, stage) for name, body in mechanism.bodies.items()}
    links = {name: (link, _standing(link, stage), link.joins) for name, link in mechanism.links.items()}
    for key, placement in mechanism.placements.items():
        unit = mechanism.units[placement.unit]
        for copy, place in _copies(key, placement.pattern):
            bodies |= {f"{copy}/{name}": (body, place) for name, body in unit.bodies.items()}
            for name, link in unit.links.items():
                joins = [f"{copy}/{body}" if body in unit.bodies else body for body in link.joins]
                links[f"{copy}/{name}"] = (link, _standing(link, place), joins)
    return bodies, links


def _standing(link: Link, outer: Place) -> Place:
    return Place(outer.turn @ _turn(link.along, link.bends), outer.of(link.at))


def _turn(along, up):
    """x along, z up as far as it is perpendicular; without `up` the z axis, or y for a link that stands upright."""
    x = np.array(along, dtype=float)
    x /= np.linalg.norm(x)
    z = np.array(up if up is not None else ((0, 1, 0) if abs(x[2]) > np.cos(np.radians(5)) else (0, 0, 1)), dtype=float)
    z -= (z @ x) * x
    z /= np.linalg.norm(z)
    return np.column_stack([x, np.cross(z, x), z])


def _copies(key, pattern):
    if not isinstance(pattern, Polar):
        return [(key, Place(_turn(pattern.along, pattern.up), np.array(pattern.at, dtype=float)))]
    first, _, last = key.partition("-")
    stem = first.rstrip("0123456789")
    numbers = range(int(first[len(stem) :]), int(last[len(stem) :] if last else first[len(stem) :]) + 1)
    step = 2.0 * np.pi / len(numbers) if pattern.step is None else pattern.step
    return [(f"{stem}{number}", _on_circle(pattern, pattern.first + step * count)) for count, number in enumerate(numbers)]


def _on_circle(pattern, angle):
    outward, around, up = np.array([np.cos(angle), np.sin(angle), 0]), np.array([-np.sin(angle), np.cos(angle), 0]), np.array([0, 0, 1])
    x = {
        InstanceOrientation.OUTWARD: outward,
        InstanceOrientation.INWARD: -outward,
        InstanceOrientation.TANGENT: around,
        InstanceOrientation.AXIS: up,
    }[pattern.facing]
    z = -outward if pattern.facing is InstanceOrientation.AXIS else up
    c, s = np.cos(pattern.turn), np.sin(pattern.turn)
    about = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    return Place(about @ np.column_stack([x, np.cross(z, x), z]), pattern.radius * outward + pattern.height * up)


def _centre(mechanism, body: Body, place: Place):
    return place.of(body.centre or (0.0, 0.0, 0.0))


def _reference(name, body, place, links, mechanism):
    """As stated, else the centre of mass, else the mean of the joints."""
    if body.reference is not None:
        return place.of(body.reference)
    if body.mass is not None:
        return _centre(mechanism, body, place)
    return np.mean([place.at for _, place, joins in links.values() if name in joins], axis=0)


def _probes(mechanism):
    return [(name, place, probe) for key, probe in mechanism.gauges.items() for name, place in _copies(key, probe.pattern)]
