"""Stabilisation: poles that recur as the order increases, and automatic candidates for modes."""

from __future__ import annotations

import itertools
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from flexstage.base.number import Array
from flexstage.experiment.identification.lscf import Poles

_NEAR = 0.02
_ALIKE = 0.5
_COINCIDENT = 0.3
_SHARE = 0.4
_STABLE_FREQUENCY, _STABLE_DAMPING, _STABLE_PARTICIPATION = 0.002, 0.05, 0.98


@dataclass(frozen=True, eq=False)
class Candidate:
    """Candidate for a mode: its pole in Hz (rad/s divided by 2 pi), its participation (m,), and the number of `orders` with this pole."""

    pole: complex
    participation: Array
    orders: int


@dataclass(frozen=True, eq=False)
class Stabilisation:
    """Stabilisation diagram: for every pole its order, frequency in Hz, damping ratio and stability relative to a lower order.

    `stable` is 0 for a new pole, 1 for a stable frequency (0.2 %), 2 for stable frequency and damping (5 %), and 3 if the
    participation is also stable (MAC of 0.98).
    """

    orders: Array
    frequencies: Array
    damping: Array
    stable: Array


class _Step(NamedTuple):
    """Pole of a track at one order."""

    order: int
    pole: complex
    participation: Array
    stable: int


def stabilisation(found: tuple[Poles, ...], highest_damping: float) -> tuple[Stabilisation, tuple[Candidate, ...]]:
    """Build the diagram of poles of increasing order, and the candidates: poles found at two fifths of the orders or more.

    A track is one pole followed from order to order. A pole continues the track of lower orders that is most similar in pole and
    participation together. A track contains at most one pole of each order, so that two close modes remain two tracks. Participations of
    repeated poles are arbitrary vectors of a common plane and differ between orders. If possible, all candidates are therefore taken from
    the same order.

    >>> one = [Poles(order, np.array([-0.1 + 10j]), np.ones((1, 1))) for order in range(1, 6)]
    >>> diagram, candidates = stabilisation(tuple(one), 0.1)
    >>> diagram.stable.tolist(), candidates[0].orders
    ([0, 3, 3, 3, 3], 5)
    """
    tracks: list[list[_Step]] = []
    for poles in found:
        values = poles.values / (2.0 * np.pi)
        chosen = np.flatnonzero(poles.damping < highest_damping)
        _continue_tracks(tracks, values[chosen], poles.participation[chosen], poles.order)
    steps = sorted(itertools.chain(*tracks), key=lambda step: (step.order, step.pole.imag))
    values = np.array([step.pole for step in steps], dtype=complex)
    diagram = Stabilisation(
        orders=np.array([step.order for step in steps], dtype=int),
        frequencies=np.abs(values),
        damping=-np.real(values) / np.maximum(np.abs(values), 1e-300),
        stable=np.array([step.stable for step in steps], dtype=int),
    )
    needed = max(2, round(_SHARE * len(found)))
    lasting = [track for track in tracks if len(track) >= needed]
    members = Counter(step.order for track in lasting for step in track)
    common = max((poles.order for poles in found), key=lambda order: (members[order], order))
    return diagram, tuple(_candidate(track, common) for track in lasting)


def merge(sweeps: Iterable[tuple[Candidate, ...]]) -> tuple[Candidate, ...]:
    """Merge candidates of overlapping bands, sorted by frequency; of duplicates, the one found at more orders is kept.

    Candidates of the same band are never duplicates.

    >>> twice = [(Candidate(-1 + 100j, np.array([1.0]), 3),), (Candidate(-1.1 + 100.1j, np.array([1.0]), 5),)]
    >>> [candidate.orders for candidate in merge(twice)]
    [5]
    """
    kept: list[tuple[int, Candidate]] = []
    numbered = [(number, candidate) for number, sweep in enumerate(sweeps) for candidate in sweep]
    for number, candidate in sorted(numbered, key=lambda each: -each[1].orders):
        if not any(sweep != number and _is_double(candidate, other) for sweep, other in kept):
            kept.append((number, candidate))
    return tuple(sorted((candidate for _, candidate in kept), key=lambda each: each.pole.imag))


def vector_assurance(first: Array, second: Array) -> float:
    """Compute the assurance (MAC) of two complex vectors a and b: |a^H b|^2 / (a^H a b^H b).

    >>> vector_assurance(np.array([1.0, 1.0j]), np.array([2.0, 2.0j]))
    1.0
    """
    own = float(np.vdot(first, first).real * np.vdot(second, second).real)
    return float(abs(np.vdot(first, second)) ** 2 / own) if own > 0.0 else 0.0


def _is_double(first: Candidate, second: Candidate) -> bool:
    width = max(-first.pole.real, -second.pole.real)
    return abs(first.pole - second.pole) < width and vector_assurance(first.participation, second.participation) > 0.8


def _continue_tracks(tracks: list[list[_Step]], values: Array, participations: Array, order: int) -> None:
    pairs: list[tuple[float, int, int]] = []
    for number, track in enumerate(tracks):
        for index, value in enumerate(values):
            away = abs(value - track[-1].pole) / abs(value)
            similar = vector_assurance(participations[index], track[-1].participation)
            coincident = abs(value - track[-1].pole) < -_COINCIDENT * value.real
            if away < _NEAR and (similar > _ALIKE or coincident):
                pairs.append((away / _NEAR + 1.0 - similar, number, index))
    taken: dict[int, int] = {}
    for _, number, index in sorted(pairs):
        if index not in taken and number not in taken.values():
            stable = _stability(tracks[number][-1], values[index], participations[index])
            tracks[number].append(_Step(order, complex(values[index]), participations[index], stable))
            taken[index] = number
    tracks += [[_Step(order, value, participations[index], 0)] for index, value in enumerate(values) if index not in taken]


def _stability(before: _Step, value: complex, participation: Array) -> int:
    checks = (
        abs(abs(value) / abs(before.pole) - 1.0) < _STABLE_FREQUENCY,
        abs(value.real / before.pole.real - 1.0) < _STABLE_DAMPING,
        vector_assurance(participation, before.participation) > _STABLE_PARTICIPATION,
    )
    return next((level for level, good in enumerate(checks) if not good), 3)


def _candidate(track: list[_Step], common: int) -> Candidate:
    """Member of the common order; without one, that nearest to the median of the upper half of the orders."""
    late = track[len(track) // 2 :]
    values = np.array([step.pole for step in late])
    middle = np.median(np.real(values)) + 1j * np.median(np.imag(values))
    typical = late[int(np.argmin(np.abs(values - middle)))]
    chosen = next((step for step in track if step.order == common), typical)
    return Candidate(chosen.pole, chosen.participation, len(track))
