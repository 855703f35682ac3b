"""Centre lines of flexures at a state, and their motion in modes and at buckling."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from flexstage.base.number import Array, matvec
from flexstage.models.nonlinear.elements.condense import system
from flexstage.models.nonlinear.equilibrium import State
from flexstage.models.nonlinear.graph import FlexureState, assemble, follow
from flexstage.models.nonlinear.linearise import flexure_motions, modal_motions
from flexstage.models.nonlinear.paths.critical_load import Critical


@dataclass(frozen=True, eq=False)
class Line:
    """Centre line of a flexure in b cases, at s points; `shares` (s,) are fractions of the length, from 0 to 1.

    `place` (b, s, 3) [m] contains the points in the stage frame; `turn` (b, s, 3, 3) is the rotation of the sections from their nominal
    orientation.
    """

    shares: Array
    place: Array
    turn: Array


@dataclass(frozen=True, eq=False)
class Motions:
    """Small motions about a state: twists (k, n, 6) of bodies at their reference points, and twists (k, s, 6) of flexures' centre lines."""

    bodies: Array
    lines: dict[str, Array]


def centre_lines(state: State) -> dict[str, Line]:
    """Compute the centre lines of all flexures by name, at their integration points and at both ends.

    The first axis is the axis of cases, of length 1 for a single state.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.models.nonlinear.equilibrium import equilibrium
    >>> from flexstage.models.nonlinear.stage import nonlinear
    >>> result = centre_lines(equilibrium(nonlinear(parallelogram()), {"platform.fx": 100.0}))
    >>> result["left"].place.shape
    (1, 12, 3)
    """
    return dict(_lines(state))


def _lines(state: State) -> Iterator[tuple[str, Line]]:
    whole = assemble(state.model, state.pose, state.loads, state.hold)
    for group, bent in zip(state.model.flexures, whole.bent, strict=True):
        shares = np.concatenate([[0.0], bent.lies.rule.points, [1.0]])
        start = np.moveaxis(state.pose.position[:, group.first], 1, 0) + bent.onset
        end = start - bent.onset + bent.lever
        inner = start[..., None, :] + group.law.length[:, None, None, None] * matvec(bent.frame[..., None, :, :], bent.lies.place)
        place = np.concatenate([start[..., None, :], inner, end[..., None, :]], axis=-2)
        drawn = group.turn.mT[:, None, None]
        turned = bent.frame[..., None, :, :] @ bent.lies.turn @ drawn
        ends = (np.moveaxis(state.pose.turn[:, each], 1, 0)[..., None, :, :] for each in (group.first, group.second))
        first, second = ends
        turn = np.concatenate([first, turned, second], axis=-3)
        for number, name in enumerate(group.names):
            yield name, Line(shares, place[number], turn[number])


def mode_motions(state: State, shapes: Array, locked: Sequence[str] = ()) -> Motions:
    """Compute the real motions of mode shapes (n, k) of `linearise(state, locked=locked)`, in the first case."""
    bodies, lines = modal_motions(state, np.real(shapes), locked)
    return Motions(bodies, lines)


def critical_motion(critical: Critical) -> Motions:
    """Compute the buckling mode about the last stable state, as motion of all bodies and flexures.

    If a single flexure buckles between fixed ends, only this flexure moves.
    """
    state = critical.state
    whole = assemble(state.model, state.pose, state.loads, state.hold)
    motions = np.zeros((1, len(state.model.bodies) + 1, 6))
    own = critical.link != ""
    motions[0, :-1] = 0.0 if own else critical.shape
    lines: dict[str, Array] = {}
    for group, bent in zip(state.model.flexures, whole.bent, strict=True):
        inner = (follow(group, bent, motions) - bent.answer.still)[:, 0]
        if critical.link in group.names:
            place = group.names.index(critical.link)
            inner[place] = _softest(bent, place)
        lines |= flexure_motions(group, bent, motions[0], inner)
    return Motions(motions[:, :-1], {name: each[None] for name, each in lines.items()})


def _softest(bent: FlexureState, place: int) -> Array:
    """Amplitudes, force and moment of the own system of one flexure that are nearest to zero resistance."""
    matrix = system(bent.tangent)[place, 0]
    return np.linalg.svd(matrix)[2][-1]
