"""Channels of a test that look exchanged, inverted or scaled: what the modes would say if they were not."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
import scipy

from flexstage.base.number import Array

_ALIKE, _UNLIKE = 0.9, 0.6
"""Correlation of a channel with theory's that a doubt must lead to, and that it must do without."""
_LEFT = 0.25
"""Share of what shapes lack of theory's that may be left where what they gain is less than a tenth."""
_SCALED, _ALL_SCALED = 1.5, 3.0
"""How many times larger than others one channel must be to be named, and than theory's all: its masses are less sure."""
_LEAST = 0.02
_BOTH_INVERTED = "look inverted against the others", "with their signs changed"
_ROUNDS = 5
_FEWEST = 3
_MOST_OUTPUTS, _MOST_TOGETHER = 24, 8
_COMPLETE = 0.95
"""How alike two doubts together must make shapes, where one alone does not."""

Score = Callable[[Array], float]
"""How alike theory and measured shapes (p, k) are, 0 to 1."""


@dataclass(frozen=True, eq=False)
class Residues:
    """Modal gains (groups, outputs, inputs) of theory and test, in the same units; `inputs_known` (m,) whose units lead to theory's.

    `direct` (m,) are inputs in the actuator's own quantity or a force: before voltages an amplifier may be missing.
    """

    outputs: tuple[str, ...]
    inputs: tuple[str, ...]
    theory: Array
    measured: Array
    inputs_known: Array
    direct: Array


@dataclass(frozen=True, eq=False)
class Doubt:
    """What looks wrong with outputs, in words; put right, output i is `factors[i]` times what is called `order[i]`."""

    what: str
    how: str
    order: Array
    factors: Array
    text: str = ""

    def put_right(self, values: Array) -> Array:
        """Values (p, ...) of the outputs as they would be without it."""
        return self.factors[:, None] * values[self.order]

    def then(self, other: Doubt) -> Doubt:
        """Both."""
        return Doubt(f"{self.what} and {other.what}", "put right", self.order[other.order], other.factors * self.factors[other.order])


def shape_doubt(outputs: tuple[str, ...], shapes: Array, score: Score, scales: Callable[[], Array] | None = None) -> Doubt | None:
    """What makes shapes alike that are unlike as they are: two outputs exchanged, one or two inverted, or all divided by `scales` (p,).

    Where none of these does, two of them together are tried, and must leave almost nothing. Of several that say as much the first counts;
    of two together that name others as well, none. `scales` are worked out only where something is left to gain.

    >>> theory = np.array([[1.0, 0.0, 0.5], [0.0, 1.0, 0.5], [0.0, 0.0, 1.0]])
    >>> theory = theory / np.linalg.norm(theory, axis=0)
    >>> alike = lambda shapes: float(np.mean(np.sum(theory * shapes, axis=0) ** 2))
    >>> shape_doubt(("S1", "S2", "S3"), theory * [[1.0], [1.0], [-1.0]], alike).text
    'S3 looks inverted: with its sign changed, measured shapes are like theory to 1.00, as they are to 0.70'
    """
    count = len(outputs)
    if count < _FEWEST or count > _MOST_OUTPUTS or not shapes.shape[1]:
        return None
    before = score(shapes)
    if before > 1.0 - _LEAST:
        return None  # nothing is left to gain
    tried = list(_remedies(outputs, None if scales is None else scales()))
    single, alone = _best(tried, shapes, score)
    chosen, best = single, alone
    if alone < _COMPLETE and count <= _MOST_TOGETHER:
        both, together = _best([first.then(second) for first in tried for second in tried if first is not second], shapes, score, sole=True)
        if both is not None and together > _COMPLETE and 1.0 - together < _LEFT * (1.0 - alone):
            chosen, best = both, together
    gained, left = best - before, 1.0 - best
    if chosen is None or best < _ALIKE or (gained < 1.0 - _ALIKE and left > _LEFT * (1.0 - before)) or gained < _LEAST:
        return None
    text = f"{chosen.what}: {chosen.how}, measured shapes are like theory to {best:.2f}, as they are to {before:.2f}"
    return replace(chosen, text=text)


def _best(tried: list[Doubt], shapes: Array, score: Score, *, sole: bool = False) -> tuple[Doubt | None, float]:
    """The first of the best; `sole`: none where others as good do something else."""
    scores = np.array([score(unit_length(each.put_right(shapes))) for each in tried])
    best = np.flatnonzero(scores > np.max(scores) - 1e-6)
    if sole and any(not _same(tried[best[0]], tried[each]) for each in best):
        return None, 0.0
    return tried[best[0]], float(scores[best[0]])


def _same(one: Doubt, other: Doubt) -> bool:
    """Whether two do the same, up to the sign of all."""
    sign = np.sign(one.factors[0] * other.factors[0])
    return bool(np.all(one.order == other.order) and np.allclose(one.factors, sign * other.factors))


def unit_length(shapes: Array) -> Array:
    """Shapes (p, k) of unit length.

    >>> unit_length(np.array([[3.0], [4.0]])).ravel().tolist()
    [0.6, 0.8]
    """
    return shapes / np.maximum(np.linalg.norm(shapes, axis=0), 1e-300)


def _remedies(outputs: tuple[str, ...], scales: Array | None) -> Iterator[Doubt]:
    """One or two outputs inverted, two exchanged, all scaled."""
    as_is, one = np.arange(len(outputs)), np.ones(len(outputs))
    pairs = list(combinations(range(len(outputs)), 2))
    for chosen in (*combinations(range(len(outputs)), 1), *pairs):
        names = " and ".join(outputs[index] for index in chosen)
        words = ("looks inverted", "with its sign changed") if len(chosen) == 1 else _BOTH_INVERTED
        yield Doubt(f"{names} {words[0]}", words[1], as_is, np.where(np.isin(as_is, chosen), -1.0, 1.0))
    for first, second in pairs:
        order = as_is.copy()
        order[[first, second]] = second, first
        yield Doubt(f"{outputs[first]} and {outputs[second]} look exchanged", "the other way round", order, one)
    wrong = [] if scales is None else [index for index, scale in enumerate(scales) if not 1.0 / _SCALED < scale < _SCALED]
    if wrong and scales is not None:
        listed = ", ".join(f"{outputs[index]} ({scales[index]:.3g} times)" for index in wrong)
        look = "looks" if len(wrong) == 1 else "look"
        yield Doubt(f"{listed} {look} scaled against the others", "divided by that", as_is, 1.0 / scales)


def output_scales(theory: Array, measured: Array) -> Array:
    """How much larger each output (p, groups) is measured than theory has it, against the usual one; groups may have any size.

    >>> theory = np.array([[1.0, 2.0, 1.0], [3.0, 1.0, 2.0], [1.0, 1.0, 3.0]])
    >>> output_scales(theory, theory * [[1.0], [1.0], [1000.0]] / [1.0, 2.0, 7.0]).round(3).tolist()
    [1.0, 1.0, 1000.0]
    """
    seen = (theory > 0.1 * np.max(theory, axis=0, initial=0.0)) & (measured > 0.0)
    ratio = np.ma.masked_array(np.log(np.where(seen, measured, 1.0) / np.where(seen, theory, 1.0)), ~seen)
    rows = np.zeros(len(theory))
    for _ in range(_ROUNDS):  # rows and columns in turn, by medians
        columns = np.ma.median(ratio - rows[:, None], axis=0).filled(0.0)
        rows = np.ma.median(ratio - columns, axis=1).filled(0.0)
    return np.exp(rows - np.percentile(rows, 50.0, method="lower"))


def gain_doubts(residues: Residues) -> tuple[str, ...]:
    """Inputs or outputs that look exchanged or inverted, and such that look scaled, by their part in the modes.

    Where an exchange on either side would do, the side counts that leaves less; inputs are looked at anew when outputs are put right.

    >>> theory = np.array([[[1.0, 0.2], [0.1, 1.0]], [[0.3, -1.0], [1.0, 0.5]]])
    >>> gain_doubts(Residues(("S1", "S2"), ("B1", "B2"), theory, theory[:, :, ::-1], *np.ones((2, 2), dtype=bool)))
    ('B1 and B2 look exchanged: the other way round, their parts in the modes are like theory to 1.00, as they are to 0.23',)
    """
    if not residues.inputs:
        return ()
    both = residues.theory, residues.measured
    theory, measured = map(_columns, both)
    rows, measured_rows = (_columns(np.swapaxes(each, 1, 2)) for each in both)
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


def _columns(values: Array) -> Array:
    """Every channel of the last axis as one vector, each group of modes of theory's size."""
    return values.reshape(-1, values.shape[2])


def _correlations(theory: Array, measured: Array) -> Array:
    sizes = np.outer(np.linalg.norm(theory, axis=0), np.linalg.norm(measured, axis=0))
    return theory.T @ measured / np.maximum(sizes, 1e-300)


def _assigned(likeness: Array) -> tuple[Array, Array]:
    """Which measured channel is most like each of theory's, no one twice, and with which sign."""
    _, order = scipy.optimize.linear_sum_assignment(-np.abs(likeness))
    return order, np.where(likeness[np.arange(len(order)), order] < 0.0, -1.0, 1.0)


def _explained(likeness: Array) -> float:
    """How alike the channel that is least so is, all put right."""
    return float(np.min(np.abs(likeness[np.arange(len(likeness)), _assigned(likeness)[0]])))


def _exchange_doubts(names: tuple[str, ...], likeness: Array, among: Array) -> Iterator[str]:
    """Channels whose part in the modes is another's, or its own inverted; not those that theory has alike."""
    order, _ = _assigned(likeness)
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


def _ratios(theory: Array, measured: Array, known: Array) -> tuple[Array, Array]:
    """How much larger each channel's part in the modes is measured than theory has it, and whether that is sure; both (m,)."""
    sizes = np.linalg.norm(theory, axis=0)
    sure = known & (sizes > 1e-3 * np.max(sizes)) & (np.diag(_correlations(theory, measured)) > _ALIKE)
    return np.linalg.norm(measured, axis=0) / np.maximum(sizes, 1e-300), sure


def _common_scale_doubts(ratio: Array, sure: Array) -> Iterator[str]:
    """All gains together: not as large as theory's masses lead to."""
    if np.any(sure) and not 1.0 / _ALL_SCALED < (usual := _nearest_median(ratio[sure])) < _ALL_SCALED:
        yield f"all gains are {usual:.3g} times theory's: the unit or the scale of all inputs or of all outputs looks wrong"


def _scale_doubts(names: tuple[str, ...], ratio: Array, sure: Array) -> Iterator[str]:
    """Channels whose part in the modes is not as large as that of the others leads one to expect."""
    if np.sum(sure) < _FEWEST:
        return
    beside = ratio / _nearest_median(ratio[sure])
    for index in np.flatnonzero(sure):
        if not 1.0 / _SCALED < beside[index] < _SCALED:
            yield f"{names[index]} looks scaled: its part in the modes is {beside[index]:.3g} times what that of the others leads to"


def _nearest_median(ratios: Array) -> float:
    """The median; between two, the one nearer to theory's: half of the channels may be scaled."""
    both = np.percentile(ratios, 50.0, method="lower"), np.percentile(ratios, 50.0, method="higher")
    return float(min(both, key=lambda ratio: abs(np.log(ratio))))


def normalise(residues: Residues) -> Residues:
    """Both divided, group by group, by theory's size, so that every mode counts alike."""
    size = np.maximum(np.linalg.norm(residues.theory, axis=(1, 2)), 1e-300)[:, None, None]
    return replace(residues, theory=residues.theory / size, measured=residues.measured / size)
