"""Geometric tests of near outlines by CAD; each test is evaluated once for all instances."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from flexstage.base.finding import Finding
from flexstage.spatial.frame import Frame

Answer = tuple[str, str]
"""Description of a problem, and advice."""


@dataclass(frozen=True, eq=False)
class Question:
    """A geometric test of the item `where`: the function `ask` returns the errors. Questions with the same `key` are evaluated once."""

    key: str
    where: str
    ask: Callable[[], Iterable[Answer]]


def findings_of(questions: Iterable[Question]) -> Iterator[Finding]:
    """Evaluate each distinct question once. Report the errors of a question at its first location, with the names of its other locations.

    >>> asked = [Question("a", name, lambda: [("it is loose", "Hold it")]) for name in ("B1/front", "B2/front")]
    >>> [str(finding) for finding in findings_of(asked)]
    ['B1/front: it is loose (also B2/front). Hold it.']
    """
    same: dict[str, list[Question]] = {}
    for question in questions:
        same.setdefault(question.key, []).append(question)
    for first, *others in same.values():
        alike = f" (also {', '.join(other.where for other in others)})" if others else ""
        for what, advice in first.ask():
            yield Finding(first.where, f"{what}{alike}", advice)


def relative_frame(frame: Frame, base: Frame) -> Frame:
    """Return a frame relative to a `base` frame, rounded so that all instances of a unit have equal frames.

    >>> relative_frame(Frame(np.eye(3), np.ones(3)), Frame(np.eye(3), np.array([1.0, 0.0, 0.0]))).position.tolist()
    [0.0, 1.0, 1.0]
    """
    back = np.real(base.rotation).T
    rotation, position = back @ np.real(frame.rotation), back @ (np.real(frame.position) - np.real(base.position))
    return Frame(np.round(rotation, 12) + 0.0, np.round(position, 12) + 0.0)


def frame_key(frame: Frame) -> str:
    """Format a frame as a string, equal for frames that differ only by rounding error.

    >>> frame_key(Frame(np.eye(3), np.zeros(3))) == frame_key(Frame(np.eye(3), np.full(3, 1e-13)))
    True
    """
    numbers = np.round(np.concatenate([np.ravel(frame.rotation), frame.position]), 9) + 0.0
    return ",".join(f"{value:.9f}" for value in numbers)


def distance_text(millimetres: float) -> str:
    """Format a length [mm] as text; lengths below a millimetre are in um.

    >>> distance_text(0.012), distance_text(2.5)
    ('12 um', '2.5 mm')
    """
    return f"{1e3 * millimetres:.3g} um" if millimetres < 1.0 else f"{millimetres:.4g} mm"
