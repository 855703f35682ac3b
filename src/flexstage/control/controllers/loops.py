"""Coordinates of single loops: actuators, platform motions, or modes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from flexstage.analysis.dynamics.modes import Modes
from flexstage.base.arguments import check_arguments
from flexstage.base.finding import refuse
from flexstage.base.number import Array, first_design
from flexstage.control.plant_models.coordinates import Coordinates
from flexstage.spatial.frame import COMPONENTS

_DEPENDENT = 1e-6


@dataclass(frozen=True, eq=False)
class Loops:
    """Coordinates of k single loops: loop errors = `sense` (k, f) times coordinate errors, strokes = `drive` (n, k) times loop commands.

    Loop errors and loop commands are in metres. In static equilibrium, a loop's pose equals its command, except for lost motion.
    """

    names: tuple[str, ...]
    sense: Array
    drive: Array
    coordinates: Coordinates


@check_arguments
def actuator_loops(coordinates: Coordinates) -> Loops:
    """Define one loop for each actuator: `sense` is R_a, the matrix from coordinates to strokes, and `drive` is the unit matrix.

    Raises `DesignError` if there are more actuators than coordinates: some of the loops' integrators would then not be observable.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.control.plant_models.coordinates import coordinates
    >>> from flexstage.models.ideal import ideal
    >>> actuator_loops(coordinates(ideal(double_triangle()))).names
    ('B1', 'B2', 'B3', 'B4', 'B5', 'B6')
    """
    actuators, motions = len(coordinates.actuators), len(coordinates.names)
    if actuators > motions:
        what = f"more actuators than coordinates (got {actuators} for {motions}): {actuators - motions} integrators are unobservable"
        raise refuse("actuator coordinates", what, "Close the loops in platform or modal coordinates")
    return Loops(coordinates.actuators, coordinates.strokes, np.eye(actuators), coordinates)


@check_arguments
def platform_loops(coordinates: Coordinates, strokes: Array | None = None) -> Loops:
    """Define one loop for each platform motion, with `sense` = S and `drive` = R_a S^-1.

    The diagonal matrix S multiplies rotations by the stage's length. The matrix R_a maps coordinates to strokes. If the matrix `strokes`
    (n, f) is specified, it replaces R_a, for example by gains that correct lost motion.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.control.plant_models.coordinates import coordinates
    >>> from flexstage.models.ideal import ideal
    >>> found = platform_loops(coordinates(ideal(double_triangle())))
    >>> found.names, found.sense.diagonal().round(4).tolist()
    (('x', 'y', 'z', 'rx', 'ry', 'rz'), [1.0, 1.0, 1.0, 0.1443, 0.1443, 0.1443])
    """
    drive = coordinates.strokes if strokes is None else strokes
    return Loops(coordinates.names, np.diag(coordinates.scale), drive / coordinates.scale, coordinates)


def loop_modes(found: Modes, coordinates: Coordinates) -> tuple[int, ...]:
    """Select the modes for modal loops: one per coordinate, with the largest contributions to static compliance along the coordinates.

    A mode with the platform twist phi and the angular frequency omega contributes |S phi|^2 / omega^2 to the compliance; S converts
    rotations to lengths. The mode with the largest contribution is selected first. For each further mode, only the component of S phi
    orthogonal to the selected modes counts. Returns ascending indices. Raises `DesignError` for too few modes.

    >>> from flexstage.control.plant_models.coordinates import coordinates
    >>> from flexstage.analysis.dynamics.modes import modes
    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.models.ideal import ideal
    >>> from flexstage.models.lumped import lumped
    >>> loop_modes(modes(lumped(parallelogram())), coordinates(ideal(parallelogram())))  # the first mode moves vertically
    (1,)
    """
    rows = [COMPONENTS.index(name) for name in coordinates.names]
    scaled = np.real(first_design(found.platform_shapes, 2))[rows] * coordinates.scale[:, None]
    with np.errstate(divide="ignore", invalid="ignore"):  # a mode at 0 Hz: none is independent of it
        compliant = scaled / first_design(found.frequencies, 1)
    triangle, order = scipy.linalg.qr(compliant, mode="r", pivoting=True, check_finite=False)
    sizes = np.abs(np.diag(triangle))
    count = np.count_nonzero(sizes > _DEPENDENT * np.max(sizes, initial=0.0))
    if count == len(rows):
        return tuple(sorted(order[: len(rows)].tolist()))
    what = f"too few independent modes (got {count} of {len(found.names)} modes, expected {len(rows)})"
    raise refuse("modal coordinates", what, "Compute more modes, or close the loops in platform coordinates")


@check_arguments
def modal_loops(coordinates: Coordinates, shapes: Array, strokes: Array | None = None) -> Loops:
    """Define one loop for each of the platform's modes, with `sense` = Phi^-1 and `drive` = R_a Phi.

    `shapes` (6, f) contains the platform's twists in these modes. They are the columns of `Modes.platform_shapes` that `loop_modes`
    selects; their scale is arbitrary. Phi contains the components of these twists along the coordinates. Each twist is scaled so that its
    largest component is 1, with rotations multiplied by the stage's length. The matrix R_a maps coordinates to strokes; if the matrix
    `strokes` (n, f) is specified, it replaces R_a. With massless links the loops are exactly decoupled oscillators with a static gain of 1.
    Lost motion and the masses of the actuation units cause crosstalk. Raises `DesignError` for shapes that do not span the coordinates.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.control.plant_models.coordinates import coordinates
    >>> from flexstage.models.ideal import ideal
    >>> found = modal_loops(coordinates(ideal(parallelogram())), np.eye(6)[:, :1])
    >>> found.names, found.sense.tolist()
    (('mode1',), [[1.0]])
    """
    rows = [COMPONENTS.index(name) for name in coordinates.names]
    scaled = np.asarray(shapes, dtype=float)[rows] * coordinates.scale[:, None]
    if scaled.shape[1] != len(rows):
        what = f"wrong number of modes (got {scaled.shape[1]}, expected {len(rows)}: {', '.join(coordinates.names)})"
        raise refuse("modal coordinates", what, "Use as many platform modes as coordinates, for example the lowest")
    scaled = scaled / np.max(np.abs(scaled), axis=0)
    values = np.linalg.svd(scaled, compute_uv=False)
    if not values[-1] > _DEPENDENT * values[0]:
        what = f"the platform's motions in these modes are not independent: the smallest singular value is {values[-1] / values[0]:.2g}"
        raise refuse("modal coordinates", f"{what} of the largest", "Use other modes, or close the loops in platform coordinates")
    drive = coordinates.strokes if strokes is None else strokes
    names = tuple(f"mode{number + 1}" for number in range(len(rows)))
    return Loops(names, np.linalg.inv(scaled) * coordinates.scale, drive / coordinates.scale @ scaled, coordinates)
