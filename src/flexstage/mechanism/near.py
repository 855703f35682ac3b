"""Nearness: which outlines of a stage may meet, found from their boxes."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product

import numpy as np

from flexstage.base.number import Array, first_design
from flexstage.mechanism.outline import Outline


def near_pairs(boxes: Sequence[Outline], within: float) -> list[tuple[int, int]]:
    """Pairs of outlines whose boxes come nearer than `within` [m], by the 15 separating directions of two boxes.

    >>> from flexstage.spatial.frame import Frame
    >>> boxes = [Outline("", Frame(np.eye(3), np.array([x, 0.0, 0.0])), np.ones(3)) for x in (0.0, 1.5, 4.0)]
    >>> near_pairs(boxes, 0.6), near_pairs(boxes, 0.4)
    ([(0, 1)], [])
    """
    if not boxes:
        return []
    turns = np.array([first_design(np.real(box.frame.rotation), 2) for box in boxes])
    centres = np.array([first_design(np.real(box.frame.position), 1) for box in boxes])
    halves = np.array([0.5 * first_design(np.real(box.size), 1) for box in boxes])
    reach = (np.abs(turns) @ halves[..., None])[..., 0]
    apart = np.abs(centres[:, None] - centres) - reach[:, None] - reach
    first, second = np.nonzero(np.triu(np.all(apart <= within, axis=-1), k=1))
    kept = separations((turns[first], centres[first], halves[first]), (turns[second], centres[second], halves[second])) <= within
    return [(int(one), int(other)) for one, other in zip(first[kept], second[kept], strict=True)]


def separations(ones: tuple[Array, Array, Array], others: tuple[Array, Array, Array]) -> Array:
    """A lower bound (k,) of the distances of boxes, given as rotations (k, 3, 3), centres and half sizes (k, 3) [m]; below 0: they meet.

    >>> box = np.eye(3)[None], np.zeros((1, 3)), np.full((1, 3), 0.5)
    >>> other = np.eye(3)[None], np.array([[2.0, 0.0, 0.0]]), np.full((1, 3), 0.5)
    >>> separations(box, other).tolist()
    [1.0]
    """
    (turn, centre, half), (face, middle, size) = ones, others
    edges = [np.cross(turn[..., i], face[..., j]) for i, j in product(range(3), range(3))]
    directions = np.stack([*(turn[..., i] for i in range(3)), *(face[..., i] for i in range(3)), *edges], axis=1)
    lengths = np.linalg.norm(directions, axis=-1, keepdims=True)
    units = np.divide(directions, lengths, out=np.zeros_like(directions), where=lengths > 1e-6)
    between = np.abs(np.einsum("kai,ki->ka", units, middle - centre))
    own = np.einsum("kaj,kj->ka", np.abs(units @ turn), half) + np.einsum("kaj,kj->ka", np.abs(units @ face), size)
    return np.max(np.where(lengths[..., 0] > 1e-6, between - own, -np.inf), axis=1)
