"""Channels of a test that look exchanged, inverted or scaled: what the modes would say if they were not."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from flexstage.base.number import Array

_ALIKE, _UNLIKE = 0.9, 0.6
"""Correlation of a channel with theory's that a doubt must lead to, and that it must do without."""
_SCALED = 1.5
_FEWEST = 3
_MOST_OUTPUTS = 24

Score = Callable[[Array], float]
"""How alike theory and measured shapes (p, k) are, 0 to 1."""


@dataclass(frozen=True, eq=False)
class Residues:
    """Modal gains (groups, outputs, inputs) of theory and test, in the same units; `inputs_known` (m,) whose units lead to theory's."""

    outputs: tuple[str, ...]
    inputs: tuple[str, ...]
    theory: Array
    measured: Array
    inputs_known: Array


def shape_doubts(outputs: tuple[str, ...], shapes: Array, score: Score) -> tuple[str, ...]:
    """Outputs that make shapes alike when two of them are exchanged, or one is inverted, and are unlike as they stand.

    >>> theory = np.array([[1.0, 0.0, 0.5], [0.0, 1.0, 0.5], [0.0, 0.0, 1.0]])
    >>> theory = theory / np.linalg.norm(theory, axis=0)
    >>> alike = lambda shapes: float(np.mean(np.sum(theory * shapes, axis=0) ** 2))
    >>> shape_doubts(("S1", "S2", "S3"), theory * [[1.0], [1.0], [-1.0]], alike)
    ('S3 looks inverted: with its sign changed, measured shapes are like theory to 1.00, as they are to 0.70',)
    """
    count = len(outputs)
    if count < _FEWEST or count > _MOST_OUTPUTS or not shapes.shape[1]:
        return ()
    tried = [
        *((_flipped(shapes, index), f"{outputs[index]} looks inverted: with its sign changed") for index in range(count)),
        *(
            (_exchanged(shapes, pair), f"{outputs[pair[0]]} and {outputs[pair[1]]} look exchanged: the other way round")
            for pair in combinations(range(count), 2)
        ),
    ]
    before = score(shapes)
    scores = [score(each) for each, _ in tried]
    best = int(np.argmax(scores))
    if scores[best] < _ALIKE or scores[best] < before + (1.0 - _ALIKE):
        return ()
    return (f"{tried[best][1]}, measured shapes are like theory to {scores[best]:.2f}, as they are to {before:.2f}",)


def _flipped(shapes: Array, index: int) -> Array:
    signs = np.ones((len(shapes), 1))
    signs[index] = -1.0
    return signs * shapes


def _exchanged(shapes: Array, pair: tuple[int, int]) -> Array:
    order = list(range(len(shapes)))
    order[pair[0]], order[pair[1]] = order[pair[1]], order[pair[0]]
    return shapes[order]


def gain_doubts(residues: Residues) -> tuple[str, ...]:
    """Inputs that look exchanged or inverted, and inputs and outputs that look scaled, by their part in the modes.

    >>> theory = np.array([[[1.0, 0.2], [0.1, 1.0]], [[0.3, -1.0], [1.0, 0.5]]])
    >>> gain_doubts(Residues(("S1", "S2"), ("B1", "B2"), theory, theory[:, :, ::-1], np.ones(2, dtype=bool)))
    ('B1 and B2 look exchanged: the other way round, their parts in the modes are like theory to 1.00, as they are to 0.23',)
    """
    theory, measured = (_columns(each) for each in (residues.theory, residues.measured))
    if not theory.size or len(theory) < _FEWEST:
        return ()
    likeness = _correlations(theory, measured)
    found = [*_misnamed(residues.inputs, likeness, _correlations(theory, theory))]
    if not found:
        found += _scaled(residues.inputs, theory, measured, residues.inputs_known)
        rows = _columns(np.swapaxes(residues.theory, 1, 2)), _columns(np.swapaxes(residues.measured, 1, 2))
        found += _scaled(residues.outputs, *rows, np.ones(len(residues.outputs), dtype=bool))
    return tuple(found)


def _columns(values: Array) -> Array:
    """Every channel of the last axis as one vector, each group of modes of theory's size."""
    return values.reshape(-1, values.shape[2])


def _correlations(theory: Array, measured: Array) -> Array:
    sizes = np.outer(np.linalg.norm(theory, axis=0), np.linalg.norm(measured, axis=0))
    return theory.T @ measured / np.maximum(sizes, 1e-300)


def _misnamed(names: tuple[str, ...], likeness: Array, among: Array) -> Iterator[str]:
    """Channels whose part in the modes is another's, or its own inverted; not those that theory has alike."""
    from scipy.optimize import linear_sum_assignment

    _, order = linear_sum_assignment(-np.abs(likeness))
    own = np.diag(likeness)
    moved = [index for index in range(len(names)) if order[index] != index and own[index] < _UNLIKE]
    sure = [index for index in moved if abs(likeness[index, order[index]]) > _ALIKE and abs(among[index, order[index]]) < _ALIKE]
    if sure and len(sure) == len(moved):
        listed, best = " and ".join(names[index] for index in sure), min(abs(likeness[index, order[index]]) for index in sure)
        right = "the other way round" if len(sure) == 2 else ", ".join(f"{names[order[index]]} for {names[index]}" for index in sure)
        yield (
            f"{listed} look exchanged: {right}, their parts in the modes are like theory to {best:.2f}, "
            f"as they are to {float(np.mean(own[sure])):.2f}"
        )
    inverted = [index for index in range(len(names)) if likeness[index, order[index]] < -_ALIKE]
    if inverted:
        listed = ", ".join(names[order[index]] for index in inverted)
        look = "looks" if len(inverted) == 1 else "look"
        yield f"{listed} {look} inverted: with the sign changed, the part in the modes is like theory's"


def _scaled(names: tuple[str, ...], theory: Array, measured: Array, known: Array) -> Iterator[str]:
    """Channels whose part in the modes is not as large as that of the others leads one to expect."""
    sizes = np.linalg.norm(theory, axis=0)
    sure = known & (sizes > 1e-3 * np.max(sizes)) & (np.diag(_correlations(theory, measured)) > _ALIKE)
    if np.sum(sure) < _FEWEST:
        return
    ratio = np.linalg.norm(measured, axis=0) / np.maximum(sizes, 1e-300)
    usual = float(np.median(ratio[sure]))
    for index in np.flatnonzero(sure):
        if not 1.0 / _SCALED < ratio[index] / usual < _SCALED:
            yield f"{names[index]} looks scaled: its part in the modes is {ratio[index] / usual:.3g} times what that of the others leads to"


def sized(residues: Residues) -> Residues:
    """Both divided, group by group, by theory's size, so that every mode counts alike."""
    size = np.maximum(np.linalg.norm(residues.theory, axis=(1, 2)), 1e-300)[:, None, None]
    return replace(residues, theory=residues.theory / size, measured=residues.measured / size)
