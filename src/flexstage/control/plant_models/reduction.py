"""Modal truncation of a plant with static correction for the other modes."""

from __future__ import annotations

from dataclasses import replace
from itertools import compress

import numpy as np

from flexstage.base.number import Array
from flexstage.control.plant_models.plants import Plant
from flexstage.control.systems.system import System, select

_REPEATED = 1e-3


def reduce_modes(given: Plant, wanted: Array) -> Plant:
    """Keep the modes marked in `wanted` (k,), and as many of the strongest modes as loop coordinates; residualise the others.

    Repeated modes are retained together. Omitted states x follow the inputs u statically, x = -A^-1 B u with the system matrices A and B,
    so that every static gain is preserved (residualisation: Green and Limebeer, Linear Robust Control, 1995, section 9.2).

    >>> from flexstage.control.example import integral_loop
    >>> plant = integral_loop().plant
    >>> found = reduce_modes(plant, resonances(plant) >= 0.5)
    >>> len(plant.frequencies), len(found.frequencies), len(found.system.A)
    (3, 1, 3)
    """
    kept = _kept_modes(given, wanted)
    if np.all(kept):
        return given
    known = mode_names(given)
    slow = np.array([not name.startswith("mode") or kept[known.index(name.rstrip("'"))] for name in given.states])
    count = int(np.sum(kept))
    return replace(
        given,
        system=residualise(given.system, slow),
        states=tuple(compress(given.states, slow)),
        frequencies=given.frequencies[kept],
        ratios=given.ratios[kept],
        left_out=given.left_out + len(kept) - count,
        note=f"{given.note}; {count} {'mode' if count == 1 else 'modes'} retained, the others as a static term",
    )


def resonances(given: Plant) -> Array:
    """Compute the resonance peak (k,) of every mode in the response from strokes to pose; the static gain of this response is 1.

    With strokes and pose expressed as platform motions in lengths, the peak is |c| |b| / (2 zeta omega^2), with the modal output c, the
    modal input b, the damping ratio zeta and the angular frequency omega. The peak of a mode at 0 Hz is infinite.

    >>> from flexstage.control.example import integral_loop
    >>> resonances(integral_loop().plant).round(1).tolist()  # the guide's mode: about 1/(2 zeta) = 50
    [0.0, 49.5, 0.0]
    """
    loop = given.coordinates
    modal = np.array([name.startswith("mode") for name in given.states])
    stage = residualise(select(given.system, given.actuators, loop.gaps), modal)
    names = [*compress(given.states, modal)]
    sizes = np.zeros(len(given.frequencies))
    for index, (name, frequency, ratio) in enumerate(zip(mode_names(given), given.frequencies, given.ratios, strict=True)):
        place, rate = names.index(name), names.index(f"{name}'")
        shape = loop.scale * (loop.pose @ stage.C[:, place])
        force = (stage.B[rate] @ loop.strokes) / loop.scale
        damped = 2.0 * max(ratio, 1e-6) * (2.0 * np.pi * frequency) ** 2
        size = np.linalg.norm(shape) * np.linalg.norm(force)
        sizes[index] = size / damped if damped > 0.0 else np.inf
    return sizes


def _kept_modes(given: Plant, wanted: Array) -> Array:
    """Requested modes, whole groups of repeated modes, and at least as many as loop coordinates."""
    kept = wanted.copy()
    order = np.argsort(-resonances(given))
    kept[order[: len(given.coordinates.names)]] = True
    same = np.diff(given.frequencies) < _REPEATED * given.frequencies[1:]
    for index in (*np.flatnonzero(same), *np.flatnonzero(same)[::-1]):
        kept[index] = kept[index + 1] = kept[index] or kept[index + 1]
    return kept


def mode_names(given: Plant) -> list[str]:
    """List the names of the states that are modal displacements, in order."""
    return [name for name in given.states if name.startswith("mode") and not name.endswith("'")]


def residualise(system: System, slow: Array) -> System:
    """Residualise a system: keep the states marked in `slow` (n,), and let all others follow statically."""
    fast = ~slow
    if not np.any(fast):
        return system
    inner = system.A[np.ix_(fast, fast)]
    states = -np.linalg.solve(inner, system.A[np.ix_(fast, slow)])
    driven = -np.linalg.solve(inner, system.B[fast])
    across = system.A[np.ix_(slow, fast)]
    return replace(
        system,
        A=system.A[np.ix_(slow, slow)] + across @ states,
        B=system.B[slow] + across @ driven,
        C=system.C[:, slow] + system.C[:, fast] @ states,
        D=system.D + system.C[:, fast] @ driven,
    )
