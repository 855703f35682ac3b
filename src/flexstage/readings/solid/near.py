"""Nearness: which outlines of a stage may meet, found from their boxes before any CAD; questions about them asked once for all copies."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from flexstage.base.finding import Finding
from flexstage.base.number import Array
from flexstage.mechanism.outline import Outline
from flexstage.spatial.frame import Frame

Answer = tuple[str, str]
"""What is wrong, and what to do."""


@dataclass(frozen=True, eq=False)
class Question:
    """Something to `ask` CAD about `where`; questions of one `key` have one answer and are asked once."""

    key: str
    where: str
    ask: Callable[[], Iterable[Answer]]


def answered(questions: Iterable[Question]) -> Iterator[Finding]:
    """Ask each distinct question and tell its findings at the first place, naming the places alike.

    >>> asked = [Question("a", name, lambda: [("it is loose", "Hold it")]) for name in ("B1/front", "B2/front")]
    >>> [str(finding) for finding in answered(asked)]
    ['B1/front: it is loose (alike: B2/front). Hold it.']
    """
    same: dict[str, list[Question]] = {}
    for question in questions:
        same.setdefault(question.key, []).append(question)
    for first, *others in same.values():
        alike = f" (alike: {', '.join(other.where for other in others)})" if others else ""
        for what, advice in first.ask():
            yield Finding(first.where, f"{what}{alike}", advice)


def near_pairs(boxes: Sequence[Outline], within: float) -> list[tuple[int, int]]:
    """Pairs of outlines whose boxes come nearer than `within` [m], by the 15 separating directions of two boxes.

    >>> boxes = [Outline("", Frame(np.eye(3), np.array([x, 0.0, 0.0])), np.ones(3)) for x in (0.0, 1.5, 4.0)]
    >>> near_pairs(boxes, 0.6), near_pairs(boxes, 0.4)
    ([(0, 1)], [])
    """
    if not boxes:
        return []
    turns = np.array([np.real(box.frame.rotation) for box in boxes])
    centres = np.array([np.real(box.frame.position) for box in boxes])
    halves = np.array([0.5 * np.real(box.size) for box in boxes])
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


def seen_from(frame: Frame, base: Frame) -> Frame:
    """A frame in the axes of another one, without the last bits of rounding, so that copies come out equal.

    >>> seen_from(Frame(np.eye(3), np.ones(3)), Frame(np.eye(3), np.array([1.0, 0.0, 0.0]))).position.tolist()
    [0.0, 1.0, 1.0]
    """
    back = np.real(base.rotation).T
    rotation, position = back @ np.real(frame.rotation), back @ (np.real(frame.position) - np.real(base.position))
    return Frame(np.round(rotation, 12) + 0.0, np.round(position, 12) + 0.0)


def frame_key(frame: Frame) -> str:
    """A frame as text, equal for copies that differ by rounding.

    >>> frame_key(Frame(np.eye(3), np.zeros(3))) == frame_key(Frame(np.eye(3), np.full(3, 1e-13)))
    True
    """
    numbers = np.round(np.concatenate([np.ravel(frame.rotation), frame.position]), 9) + 0.0
    return ",".join(f"{value:.9f}" for value in numbers)


def distance_text(millimetres: float) -> str:
    """A length as a reader wants it: in um below a millimetre.

    >>> distance_text(0.012), distance_text(2.5)
    ('12 um', '2.5 mm')
    """
    return f"{1e3 * millimetres:.3g} um" if millimetres < 1.0 else f"{millimetres:.4g} mm"
