"""Inputs and outputs of a stage. Names and order are the same for all elastic models, so that results can be compared by name.

Inputs: strokes and forces of the actuators; wrenches on the platform and the named points.

Outputs:

- twists of the platform, the points and all other bodies;
- gauge readings;
- stress resultants of every link, at its centre in its frame;
- wrenches at the ports of superelements, in their frames.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from flexstage.base.number import Array
from flexstage.mechanism.assembly.expand import Assembly
from flexstage.mechanism.assembly.sight import PlacedGauge, Sight
from flexstage.mechanism.mechanism import PLATFORM
from flexstage.models.linear.model import Channel
from flexstage.spatial.frame import COMPONENTS, FORCES, TWIST_UNITS, WRENCH_UNITS, Frame


@dataclass(frozen=True, eq=False)
class Place:
    """Point (..., 3) [m] of a body, in stage axes, where a twist is an output or a wrench is an input."""

    body: str
    point: Array


@dataclass(frozen=True, eq=False)
class Motions:
    """Matrices (..., 6, n) that give the twists of bodies from n model coordinates.

    `bodies` contains the matrix of each body at its reference point. The function `at` returns the matrix of a body at a frame.
    """

    bodies: Mapping[str, Array]
    at: Callable[[str, Frame], Array]


def wrench_places(assembly: Assembly) -> dict[str, Place]:
    """Return the points where wrenches act: the platform's reference point and the named points.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.mechanism.assembly.expand import expand
    >>> list(wrench_places(expand(parallelogram())))
    ['platform', 'corner']
    """
    points = {name: Place(body, point) for name, (body, point) in assembly.points.items()}
    return {PLATFORM: Place(PLATFORM, assembly.bodies[PLATFORM].reference), **points}


def twist_places(assembly: Assembly) -> dict[str, Place]:
    """Return the points where twists are outputs: the points of wrenches, and the reference points of all other bodies.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.mechanism.assembly.expand import expand
    >>> list(twist_places(expand(parallelogram())))
    ['platform', 'corner', 'B/base', 'B/tip']
    """
    others = {name: Place(name, body.reference) for name, body in assembly.bodies.items() if name != PLATFORM}
    return wrench_places(assembly) | others


def input_channels(assembly: Assembly) -> tuple[Channel, ...]:
    """List the inputs: strokes and forces by actuator, then wrenches by point.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.mechanism.assembly.expand import expand
    >>> [channel.name for channel in input_channels(expand(parallelogram()))][:3]
    ['B', 'platform.fx', 'platform.fy']
    """
    drives = (Channel(name, assembly.actuator(name).input.si) for name in assembly.actuators)
    return (*drives, *_components(wrench_places(assembly), FORCES, WRENCH_UNITS))


def output_channels(assembly: Assembly) -> tuple[Channel, ...]:
    """List the outputs: twists by point, gauges, stress resultants by link, wrenches of bodies on ports (`frame.left.fx`).

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.mechanism.assembly.expand import expand
    >>> result = output_channels(expand(parallelogram()))
    >>> result[0].name, result[-1].name, len(result) == 6 * (4 + 5) + 1  # places, links, a gauge
    ('platform.x', 'B/front.mz', True)
    """
    return (
        *_components(twist_places(assembly), COMPONENTS, TWIST_UNITS),
        *(Channel(name, gauge.unit) for name, gauge in assembly.gauges.items()),
        *_components(wrench_owners(assembly), FORCES, WRENCH_UNITS),
    )


def wrench_owners(assembly: Assembly) -> tuple[str, ...]:
    """List the elements whose wrenches are outputs: the links, then the ports of superelements.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.mechanism.assembly.expand import expand
    >>> wrench_owners(expand(parallelogram()))[:2]
    ('left', 'right')
    """
    return (*assembly.links, *(f"{name}.{port}" for name, item in assembly.superelements.items() for port in item.ports))


def _components(owners: Iterable[str], names: tuple[str, ...], units: tuple[str, ...]) -> list[Channel]:
    return [Channel(f"{owner}.{name}", unit) for owner in owners for name, unit in zip(names, units, strict=True)]


def absolute(assembly: Assembly) -> Array:
    """Return a mask (p,) of the outputs that change if the whole stage moves rigidly with the ground: only twists.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.mechanism.assembly.expand import expand
    >>> int(absolute(expand(parallelogram())).sum())  # six of each of four places
    24
    """
    return np.arange(len(output_channels(assembly))) < len(COMPONENTS) * len(twist_places(assembly))


def place_twists(places: Mapping[str, Place], motions: Motions) -> list[Array]:
    """Compute the twist (..., 6, n) at every point, in stage axes.

    >>> still = Motions({"platform": np.zeros((6, 2))}, lambda body, frame: np.ones((6, 2)))
    >>> places = {"platform": Place("platform", np.zeros(3)), "corner": Place("platform", np.ones(3))}
    >>> [float(twist.sum()) for twist in place_twists(places, still)]
    [0.0, 12.0]
    """
    return [
        motions.bodies[name] if name == place.body else motions.at(place.body, Frame(np.eye(3), place.point))
        for name, place in places.items()
    ]


def gauge_rows(assembly: Assembly, motions: Motions) -> list[Array]:
    """Compute the reading (..., 1, n) of every gauge per coordinate: weighted body motions relative to the base, along or about an axis.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.mechanism.assembly.expand import expand
    >>> alone = Motions({}, lambda body, frame: np.full((6, 1), float(body == "platform")))
    >>> [row.tolist() for row in gauge_rows(expand(parallelogram()), alone)]
    [[[1.0]]]
    """
    return [reading(gauge, motions.at) for gauge in assembly.gauges.values()]


def reading(gauge: PlacedGauge, at: Callable[[str, Frame], Array]) -> Array:
    """Compute the reading (..., 1, n) of a gauge per coordinate; `at` returns the twist (..., 6, n) of a body at a frame."""
    first, *others = (see(sight, at) for sight in gauge.sights)
    return sum(others, first)


def see(sight: Sight, at: Callable[[str, Frame], Array]) -> Array:
    """Compute the contribution (..., 1, n) of one term (`Sight`) to the reading of a gauge or to the motion at a stop."""
    rows = slice(sight.component, sight.component + 1)
    motion = at(sight.body, sight.frame)[..., rows, :] - at(sight.base, sight.foot)[..., rows, :]
    return np.asarray(sight.weight)[..., None, None] * motion


def imposed_strokes(assembly: Assembly, deformations: Mapping[str, Array]) -> dict[str, Array]:
    """Compute, for each stroke actuator's link, the deformation (..., r, m) per unit of each input.

    `deformations` (..., r) contains, by link, the deformation per unit stroke. Columns of other inputs are zero.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.mechanism.assembly.expand import expand
    >>> imposed_strokes(expand(parallelogram()), {"B/pzt": np.array([1.0, 0.0])})["B/pzt"][:, :2].tolist()
    [[1.0, 0.0], [0.0, 0.0]]
    """
    inputs = np.eye(len(input_channels(assembly)))
    numbers = {name: number for number, name in enumerate(assembly.actuators)}
    return {link: deformations[link][..., None] * inputs[numbers[name]] for name, link in assembly.strokes.items()}


def exerted_wrenches(assembly: Assembly) -> dict[str, Array]:
    """Compute the wrench (..., 6, m) of each input on the second body of each force actuator's link, in the link frame.

    The opposite wrench acts on the first body. Both wrenches act at the link's centre.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.mechanism.assembly.expand import expand
    >>> exerted_wrenches(expand(parallelogram()))  # a stack alone
    {}
    """
    inputs = np.eye(len(input_channels(assembly)))
    numbers = {name: number for number, name in enumerate(assembly.actuators)}
    return {link: wrench[..., None] * inputs[numbers[name]] for link, (name, wrench) in assembly.pushes.items()}
