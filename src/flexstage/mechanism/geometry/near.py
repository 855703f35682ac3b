"""Proximity: candidate pairs of outlines by their bounding boxes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from flexstage.base.number import first_design
from flexstage.mechanism.geometry.outline import Outline
from flexstage.spatial.convex import Boxes, separations


def near_pairs(boxes: Sequence[Outline], within: float) -> list[tuple[int, int]]:
    """Return index pairs of outlines whose boxes are nearer than `within` [m] along all 15 separating axes of two boxes.

    >>> from flexstage.spatial.frame import Frame
    >>> boxes = [Outline("", Frame(np.eye(3), np.array([x, 0.0, 0.0])), np.ones(3)) for x in (0.0, 1.5, 4.0)]
    >>> near_pairs(boxes, 0.6), near_pairs(boxes, 0.4)
    ([(0, 1)], [])
    """
    if not boxes:
        return []
    drawn = Boxes(
        np.array([first_design(np.real(box.frame.rotation), 2) for box in boxes]),
        np.array([first_design(np.real(box.frame.position), 1) for box in boxes]),
        np.array([0.5 * first_design(np.real(box.size), 1) for box in boxes]),
    )
    reach = (np.abs(drawn.turns) @ drawn.halves[..., None])[..., 0]
    apart = np.abs(drawn.centres[:, None] - drawn.centres) - reach[:, None] - reach
    first, second = np.nonzero(np.triu(np.all(apart <= within, axis=-1), k=1))
    kept = separations(drawn.pick(first), drawn.pick(second)) <= within
    return [(int(one), int(other)) for one, other in zip(first[kept], second[kept], strict=True)]
