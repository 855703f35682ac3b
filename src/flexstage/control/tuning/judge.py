"""Evaluation of a sampled loop in all axes, for shifts of its modes."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from flexstage.base.number import Array
from flexstage.control.systems.closed import pose_controller
from flexstage.control.systems.system import System, connect
from flexstage.control.tuning.spec import Judgement
from flexstage.control.tuning.view import View

_ROUNDING = 1e-9
_COARSE = 8
"""Stride of a first, coarse check of frequencies: a loop that exceeds the peak there needs no further check."""


def judge_loop(seen: View, control: System, gains: Array | None = None) -> Judgement:
    """Evaluate stability by eigenvalues, the peak sensitivity over all frequencies of the view, and each loop's bandwidth.

    `gains` are the result of `open_gains`, if it is already known.

    >>> from flexstage.control.controllers.loops import platform_loops
    >>> from flexstage.control.example import integral_loop
    >>> from flexstage.control.tuning.view import view
    >>> closed = integral_loop(gain=100.0)
    >>> found = judge_loop(view(closed.plant, platform_loops(closed.plant.coordinates), 0.02), closed.controller)
    >>> found.stable, round(found.bandwidths[0], 1)  # near 100/(2 pi)
    (True, 15.7)
    """
    gains = open_gains(seen, control) if gains is None else gains
    peaks = [highest_gain(_sensitivity(seen, each)) for each in gains]
    growths = [closed_growth(system, control) for system in seen.systems]
    worst = int(np.argmax(growths)) if max(growths) >= 0.0 else int(np.argmax([peak for peak, _ in peaks]))
    return Judgement(
        bandwidths=own_bandwidths(seen, gains),
        peak=max(peak for peak, _ in peaks),
        frequency=float(seen.frequencies[peaks[worst][1]]),
        growth=float(max(growths)),
        offset=seen.offsets[worst],
    )


def keeps_peak(seen: View, control: Callable[[], System], gains: Array, peak: float) -> bool:
    """Check that `judge_loop` finds a stable loop with a sensitivity of at most `peak`; the fastest checks come first.

    `control` constructs the controller; it is not called if a coarse check shows too high a peak.

    >>> from flexstage.control.controllers.loops import platform_loops
    >>> from flexstage.control.example import integral_loop
    >>> from flexstage.control.tuning.view import view
    >>> closed = integral_loop(gain=100.0)
    >>> seen = view(closed.plant, platform_loops(closed.plant.coordinates), 0.02)
    >>> [keeps_peak(seen, lambda: closed.controller, open_gains(seen, closed.controller), peak) for peak in (1.01, 10.0)]
    [False, True]
    """
    return (
        all(highest_gain(_sensitivity(seen, each[::_COARSE]))[0] <= peak for each in gains)
        and all(closed_growth(system, control()) < 0.0 for system in seen.systems)
        and all(highest_gain(_sensitivity(seen, each))[0] <= peak for each in gains)
    )


def own_bandwidths(seen: View, gains: Array) -> tuple[float, ...]:
    """Find the first frequency [Hz] at which the gain of each loop of the nominal plant falls through 1."""
    return tuple(crossing_frequency(seen.frequencies, np.abs(gains[0, :, loop, loop])) for loop in range(len(seen.loops.names)))


def _sensitivity(seen: View, gains: Array) -> Array:
    """Sensitivity S (f, k, k) of poses, rotations times the stage's length, from open loops in loop coordinates."""
    poses = seen.loops.coordinates.scale[:, None] * np.linalg.inv(seen.loops.sense)
    return poses @ np.linalg.inv(np.eye(gains.shape[-1]) + gains) @ np.linalg.inv(poses)


def open_gains(seen: View, control: System) -> Array:
    """Compute the open-loop responses L (v, f, k, k) in loop coordinates; the sensitivity is (I + L)^-1.

    >>> from flexstage.control.controllers.loops import platform_loops
    >>> from flexstage.control.example import integral_loop
    >>> from flexstage.control.tuning.view import view
    >>> closed = integral_loop(gain=100.0)
    >>> open_gains(view(closed.plant, platform_loops(closed.plant.coordinates), 0.0), closed.controller).shape[2:]
    (1, 1)
    """
    whole = pose_controller(control, seen.loops.coordinates, seen.loops.sense)
    return seen.responses @ whole.sweep(seen.frequencies, slice(len(seen.loops.names)))


def closed_growth(plant: System, control: System) -> float:
    """Compute the growth rate [1/s] of the fastest growing motion (negative: decay) of a plant (commands to pose) under a controller.

    >>> from flexstage.control.controllers.pose_plant import pose_plant
    >>> from flexstage.control.example import integral_loop
    >>> closed = integral_loop()
    >>> abs(closed_growth(pose_plant(closed.plant), closed.controller) / closed.system.growth - 1.0) < 1e-6
    True
    """
    return closed_system(plant, control).growth


def closed_system(plant: System, control: System) -> System:
    """Connect a plant (commands to pose) with a controller, without inputs or outputs.

    >>> from flexstage.control.controllers.pose_plant import pose_plant
    >>> from flexstage.control.example import integral_loop
    >>> len(closed_system(pose_plant(integral_loop().plant), integral_loop().controller).poles)
    9
    """
    errors = {f"error.{name.partition('.')[2]}": {name: -1.0} for name in plant.output_names}
    links = {name: errors.get(name, {}) for name in control.input_names if name not in plant.output_names}
    return connect([plant, control], links, (), ())


def highest_gain(matrices: Array) -> tuple[float, int]:
    """Find the largest singular value of f matrices (f, k, k), and the index of the matrix that has it.

    Two bounds exclude most matrices before eigenvalues are computed. The upper bound for a matrix M is the square root of the largest row
    sum of |M^H M|. The lower bound is the norm of the longest column of all matrices.

    >>> highest_gain(np.array([[[1.0, 0.0], [0.0, 1.0]], [[0.0, 3.0], [0.0, 4.0]]]))
    (5.0, 1)
    """
    squares = np.conj(matrices.mT) @ matrices
    sizes = np.abs(squares)
    reached = np.max(np.einsum("fkk->fk", sizes))
    places = np.flatnonzero(np.max(np.sum(sizes, axis=-1), axis=-1) >= reached * (1.0 - _ROUNDING))
    values = np.linalg.eigvalsh(squares[places])[:, -1]
    return float(np.sqrt(np.max(values))), int(places[np.argmax(values)])


def crossing_frequency(frequencies: Array, gains: Array) -> float:
    """Find the first frequency where a gain falls through 1, log-interpolated; 0 if it starts below 1, infinite if it stays above.

    >>> round(crossing_frequency(np.array([1.0, 10.0, 100.0]), np.array([10.0, 1.25, 0.1])), 2)
    12.26
    """
    below = gains < 1.0
    first = int(np.argmax(below))
    if not below[first]:
        return np.inf
    if not first:
        return 0.0
    ends = slice(first - 1, first + 1)
    return float(np.exp(np.interp(0.0, -np.log(gains[ends]), np.log(frequencies[ends]))))


def first_rise(sizes: Array, frequencies: Array) -> float:
    """Find the first frequency at which `sizes` rises through 1, interpolated in the logarithms of `sizes` and `frequencies`.

    Returns the last frequency if `sizes` never reaches 1, and the first frequency if `sizes` begins at 1 or above.

    >>> round(first_rise(np.array([0.1, 0.8, 10.0]), np.array([1.0, 10.0, 100.0])), 2)
    12.26
    """
    above = np.flatnonzero(sizes >= 1.0)
    if not len(above) or not above[0]:
        return float(frequencies[0 if len(above) else -1])
    ends = slice(int(above[0]) - 1, int(above[0]) + 1)
    return float(np.exp(np.interp(0.0, np.log(sizes[ends]), np.log(frequencies[ends]))))
