"""Detection of exchanged, inverted or scaled channels of a test, by corrections that make modes and model agree better."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
import scipy

from flexstage.base.number import Array

_ALIKE, _UNLIKE = 0.9, 0.6
"""Smallest correlation of a channel with the model after a correction, and largest correlation before."""
_LEFT = 0.25
"""Largest difference of shapes after a correction of small effect, relative to the difference before."""
_SCALED, _ALL_SCALED = 1.5, 3.0
"""Minimum scale of one channel relative to others, and of all relative to the model, whose masses are less certain."""
_LEAST = 0.02
_BOTH_INVERTED = "look inverted relative to the other outputs", "with their signs changed"
_ROUNDS = 5
_ROUNDING = 1e-9
_FEWEST = 3
_MOST_OUTPUTS, _MOST_TOGETHER = 24, 8
_COMPLETE = 0.95
"""Required similarity of shapes after two corrections together, if one is insufficient."""

Score = Callable[[Array], float]
"""Function that returns the similarity of measured shapes (p, k) to those of the model, 0 to 1."""


@dataclass(frozen=True, eq=False)
class Residues:
    """Modal gains (groups of modes, outputs, inputs) of the model (`theory`) and of the test (`measured`), in the same units.

    `inputs_known` (m,) marks the inputs with units that can be converted to the model's units. `direct` (m,) marks the known inputs that
    are not voltages. The model's gain for a voltage is uncertain, because the gain of the amplifier may be unknown.
    """

    outputs: tuple[str, ...]
    inputs: tuple[str, ...]
    theory: Array
    measured: Array
    inputs_known: Array
    direct: Array


@dataclass(frozen=True, eq=False)
class SuspectedFault:
    """Suspected fault of outputs, with its correction: channel `order[i]`, multiplied by `factors[i]`, replaces output i."""

    what: str
    how: str
    order: Array
    factors: Array
    text: str = ""

    def put_right(self, values: Array) -> Array:
        """Return the corrected values (p, ...) of the outputs."""
        return self.factors[:, None] * values[self.order]

    def then(self, other: SuspectedFault) -> SuspectedFault:
        """Combine two corrections: first this one, then `other`."""
        return SuspectedFault(
            f"{self.what} and {other.what}", "after both corrections", self.order[other.order], other.factors * self.factors[other.order]
        )


def shape_doubt(outputs: tuple[str, ...], shapes: Array, score: Score, scales: Callable[[], Array]) -> SuspectedFault | None:
    """Find the correction of `outputs` that makes the measured `shapes` (p, k) similar to the model's shapes; `None` if there is none.

    A correction exchanges two outputs, inverts one or two, or divides all by the values (p,) of `scales()`. If no single correction
    suffices, pairs of corrections are tried; with a pair, the shapes must match almost completely. The first of several equally good
    corrections is returned. If two equally good pairs have different effects, no pair is used. `scales` is called only if an improvement is
    possible.

    >>> theory = np.array([[1.0, 0.0, 0.5], [0.0, 1.0, 0.5], [0.0, 0.0, 1.0]])
    >>> theory = theory / np.linalg.norm(theory, axis=0)
    >>> alike = lambda shapes: float(np.mean(np.sum(theory * shapes, axis=0) ** 2))
    >>> shape_doubt(("S1", "S2", "S3"), theory * [[1.0], [1.0], [-1.0]], alike, lambda: np.ones(3)).text
    'S3 looks inverted: with its sign changed, the similarity of measured shapes and theory is 1.00 (0.70 as recorded)'
    """
    count = len(outputs)
    if count < _FEWEST or count > _MOST_OUTPUTS or not shapes.shape[1]:
        return None
    before = score(shapes)
    if before > 1.0 - _LEAST:
        return None  # no improvement possible
    tried = list(_remedies(outputs, scales()))
    single, alone = _best(tried, shapes, score)
    chosen, best = single, alone
    if alone < _COMPLETE and count <= _MOST_TOGETHER:
        both, together = _best([first.then(second) for first in tried for second in tried if first is not second], shapes, score, sole=True)
        if both is not None and together > _COMPLETE and 1.0 - together < _LEFT * (1.0 - alone):
            chosen, best = both, together
    gained, left = best - before, 1.0 - best
    if chosen is None or best < _ALIKE or (gained < 1.0 - _ALIKE and left > _LEFT * (1.0 - before)) or gained < _LEAST:
        return None
    text = f"{chosen.what}: {chosen.how}, the similarity of measured shapes and theory is {best:.2f} ({before:.2f} as recorded)"
    return replace(chosen, text=text)


def _best(tried: list[SuspectedFault], shapes: Array, score: Score, *, sole: bool = False) -> tuple[SuspectedFault | None, float]:
    """First of the best; with `sole` None if equally good ones differ in effect."""
    scores = np.array([score(unit_length(each.put_right(shapes))) for each in tried])
    best = np.flatnonzero(scores > np.max(scores) - 1e-6)
    if sole and any(not _same(tried[best[0]], tried[each]) for each in best):
        return None, 0.0
    return tried[best[0]], float(scores[best[0]])


def _same(one: SuspectedFault, other: SuspectedFault) -> bool:
    """Whether two corrections are equal, up to a common sign."""
    sign = np.sign(one.factors[0] * other.factors[0])
    return bool(np.all(one.order == other.order) and np.allclose(one.factors, sign * other.factors))


def unit_length(shapes: Array) -> Array:
    """Normalise shapes (p, k) to unit length.

    >>> unit_length(np.array([[3.0], [4.0]])).ravel().tolist()
    [0.6, 0.8]
    """
    return shapes / np.maximum(np.linalg.norm(shapes, axis=0), 1e-300)


def _remedies(outputs: tuple[str, ...], scales: Array) -> Iterator[SuspectedFault]:
    """Corrections: one or two outputs inverted, two exchanged, all scaled."""
    as_is, one = np.arange(len(outputs)), np.ones(len(outputs))
    pairs = list(combinations(range(len(outputs)), 2))
    for chosen in (*combinations(range(len(outputs)), 1), *pairs):
        names = " and ".join(outputs[index] for index in chosen)
        words = ("looks inverted", "with its sign changed") if len(chosen) == 1 else _BOTH_INVERTED
        yield SuspectedFault(f"{names} {words[0]}", words[1], as_is, np.where(np.isin(as_is, chosen), -1.0, 1.0))
    for first, second in pairs:
        order = as_is.copy()
        order[[first, second]] = second, first
        yield SuspectedFault(f"{outputs[first]} and {outputs[second]} look exchanged", "after exchanging them", order, one)
    wrong = [index for index, scale in enumerate(scales) if not 1.0 / _SCALED < scale < _SCALED]
    if wrong:
        listed = ", ".join(f"{outputs[index]} ({scales[index]:.3g} times)" for index in wrong)
        look = "looks" if len(wrong) == 1 else "look"
        yield SuspectedFault(f"{listed} {look} scaled relative to the other outputs", "after rescaling", as_is, 1.0 / scales)


def output_scales(theory: Array, measured: Array) -> Array:
    """Estimate the scale (p,) of every output: its `measured` amplitudes (p, groups of modes) divided by the model's amplitudes `theory`.

    The median of the scales is 1. A common factor of all amplitudes in a group of modes does not affect the result.

    >>> theory = np.array([[1.0, 2.0, 1.0], [3.0, 1.0, 2.0], [1.0, 1.0, 3.0]])
    >>> output_scales(theory, theory * [[1.0], [1.0], [1000.0]] / [1.0, 2.0, 7.0]).round(3).tolist()
    [1.0, 1.0, 1000.0]
    """
    seen = (theory > 0.1 * np.max(theory, axis=0, initial=0.0)) & (measured > 0.0)
    ratio = np.ma.masked_array(np.log(np.where(seen, measured, 1.0) / np.where(seen, theory, 1.0)), ~seen)
    rows = np.zeros(len(theory))
    for _ in range(_ROUNDS):  # alternate over rows and columns, by medians
        columns = np.ma.median(ratio - rows[:, None], axis=0).filled(0.0)
        rows = np.ma.median(ratio - columns, axis=1).filled(0.0)
    return np.exp(rows - np.percentile(rows, 50.0, method="lower"))


def gain_doubts(residues: Residues) -> tuple[str, ...]:
    """Find inputs or outputs that appear exchanged, inverted or scaled, from their modal gains.

    If exchanged outputs explain the gains better than exchanged inputs, the outputs are reported. In this case, the inputs are tested again
    after correction of the outputs.

    >>> theory = np.array([[[1.0, 0.2], [0.1, 1.0]], [[0.3, -1.0], [1.0, 0.5]]])
    >>> gain_doubts(Residues(("S1", "S2"), ("B1", "B2"), theory, theory[:, :, ::-1], *np.ones((2, 2), dtype=bool)))
    ('B1 and B2 look exchanged: after exchanging them, the correlation of their modal gains with theory is 1.00 (0.23 as recorded)',)
    """
    if not residues.inputs:
        return ()
    both = residues.theory, residues.measured
    theory, measured = (each.reshape(-1, len(residues.inputs)) for each in both)
    rows, measured_rows = (np.swapaxes(each, 1, 2).reshape(-1, len(residues.outputs)) for each in both)
    if not theory.size or len(theory) < _FEWEST:
        return ()
    likeness, outputs = _correlations(theory, measured), _correlations(rows, measured_rows)
    found = [*_exchange_doubts(residues.outputs, outputs, _correlations(rows, rows))]
    if found and _explained(outputs) > _explained(likeness):
        order, signs = _assigned(outputs)
        right = replace(residues, measured=signs[:, None] * residues.measured[:, order])
        return (*found, *gain_doubts(right))
    found = [*_exchange_doubts(residues.inputs, likeness, _correlations(theory, theory))]
    if not found:
        found += _common_scale_doubts(*_ratios(theory, measured, residues.direct))
        found += _scale_doubts(residues.inputs, *_ratios(theory, measured, residues.inputs_known))
        found += _scale_doubts(residues.outputs, *_ratios(rows, measured_rows, np.ones(len(residues.outputs), dtype=bool)))
    return tuple(found)


def _correlations(theory: Array, measured: Array) -> Array:
    sizes = np.outer(np.linalg.norm(theory, axis=0), np.linalg.norm(measured, axis=0))
    return theory.T @ measured / np.maximum(sizes, 1e-300)


def _assigned(likeness: Array) -> tuple[Array, Array]:
    """Assignment of measured channels to the model's, one to one, with signs."""
    _, order = scipy.optimize.linear_sum_assignment(-np.abs(likeness))
    return order, np.where(likeness[np.arange(len(order)), order] < 0.0, -1.0, 1.0)


def _explained(likeness: Array) -> float:
    """Lowest similarity of a channel after all corrections."""
    return float(np.min(np.abs(likeness[np.arange(len(likeness)), _assigned(likeness)[0]])))


def _exchange_doubts(names: tuple[str, ...], likeness: Array, among: Array) -> Iterator[str]:
    """Channels whose modal gains match those of another channel, or are inverted; except those with equal gains in the model."""
    order, _ = _assigned(likeness)
    own = np.diag(likeness)
    moved = [index for index in range(len(names)) if order[index] != index and own[index] < _UNLIKE]
    sure = [index for index in moved if abs(likeness[index, order[index]]) > _ALIKE and abs(among[index, order[index]]) < _ALIKE]
    if sure and len(sure) == len(moved):
        listed, best = " and ".join(names[index] for index in sure), min(abs(likeness[index, order[index]]) for index in sure)
        right = (
            "after exchanging them" if len(sure) == 2 else f"with {', '.join(f'{names[order[index]]} as {names[index]}' for index in sure)}"
        )
        yield (
            f"{listed} look exchanged: {right}, the correlation of their modal gains with theory is {best:.2f} "
            f"({float(np.mean(own[sure])):.2f} as recorded)"
        )
    inverted = [index for index in range(len(names)) if likeness[index, order[index]] < -_ALIKE]
    if inverted:
        listed = ", ".join(names[order[index]] for index in inverted)
        look = "looks" if len(inverted) == 1 else "look"
        yield f"{listed} {look} inverted: with the sign changed, the modal gains agree with theory"


def _ratios(theory: Array, measured: Array, known: Array) -> tuple[Array, Array]:
    """Measured modal gains of each channel relative to the model, and whether they are significant; both (m,)."""
    sizes = np.linalg.norm(theory, axis=0)
    sure = known & (sizes > 1e-3 * np.max(sizes)) & (np.diag(_correlations(theory, measured)) > _ALIKE)
    return np.linalg.norm(measured, axis=0) / np.maximum(sizes, 1e-300), sure


def _common_scale_doubts(ratio: Array, sure: Array) -> Iterator[str]:
    """Common scale of all gains, relative to the model's masses."""
    if np.any(sure) and not 1.0 / _ALL_SCALED < (usual := _nearest_median(ratio[sure])) < _ALL_SCALED:
        yield f"all modal gains are {usual:.3g} times as large as in theory: the unit or scale of all inputs or of all outputs looks wrong"


def _scale_doubts(names: tuple[str, ...], ratio: Array, sure: Array) -> Iterator[str]:
    """Channels whose modal gains differ in scale from those of the others."""
    if np.sum(sure) < _FEWEST:
        return
    beside = ratio / _nearest_median(ratio[sure])
    for index in np.flatnonzero(sure):
        if not 1.0 / _SCALED < beside[index] < _SCALED:
            yield f"{names[index]} looks scaled: its modal gains are {beside[index]:.3g} times as large as the other channels suggest"


def _nearest_median(ratios: Array) -> float:
    """Median; between two, the one nearer to the model's: half of the channels may be scaled."""
    both = np.percentile(ratios, 50.0, method="lower"), np.percentile(ratios, 50.0, method="higher")
    return float(min(both, key=lambda ratio: abs(np.log(ratio))))


def normalise(residues: Residues) -> Residues:
    """In each group of modes, divide the gains of model and test by the norm of the model's gains, so that all groups have equal weight.

    If the model's gains in a group are only rounding errors, all gains of the group become zero.

    >>> theory, measured = np.array([[[2.0]], [[0.0]]]), np.array([[[2.2]], [[1.0]]])
    >>> normalise(Residues(("S",), ("B",), theory, measured, *np.ones((2, 1), dtype=bool))).measured.ravel().tolist()
    [1.1, 0.0]
    """
    norm = np.linalg.norm(residues.theory, axis=(1, 2))[:, None, None]
    size = np.where(norm > _ROUNDING * np.max(norm, initial=0.0), norm, np.inf)
    return replace(residues, theory=residues.theory / size, measured=residues.measured / size)
