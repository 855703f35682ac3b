"""Block elimination of the constraints of a large stage, body by body: the computing time is proportional to the number of bodies.

A pivoted QR decomposition of the six columns of a body splits the rows that contain the body. Some rows give the body's coordinates from
the coordinates of its neighbours. The other rows no longer contain the body and constrain only its neighbours.

A coordinate without a row is a free internal mode. A zero row is a redundant constraint. Bodies with the fewest neighbours are eliminated
first, so that free internal modes involve few bodies. The platform and the strokes are kept.
"""

from __future__ import annotations

import heapq
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy

from flexstage.base.number import Array
from flexstage.base.sparse import Sparse
from flexstage.models.linear.elimination import Elimination, echelon, eliminate, null_space

_RANK = 1e-9


@dataclass(frozen=True, eq=False)
class _Group:
    """Rows (m, c) over some `blocks` of coordinates, as combinations `shares` (m, k) of the constraints `made` (k,)."""

    blocks: tuple[int, ...]
    rows: Array
    made: Array
    shares: Array


@dataclass(frozen=True, eq=False)
class _Solution:
    """Coordinates of a block: `free` ones are idle; the `bound` ones follow from these and from the coordinates of `others`, in order."""

    free: Array
    bound: Array
    own: Array
    others: tuple[int, ...]
    rest: Array


@dataclass(frozen=True, eq=False)
class ConstraintSolution:
    """Solution of the constraints: the motions of N coordinates that satisfy them.

    `last` is the last elimination, of the platform's coordinates and the strokes. `idle` contains one free internal mode, a row (N,), for
    each unconstrained coordinate. `redundant` contains, for each state of self-stress, the indices of its constraints.
    """

    last: Elimination
    idle: tuple[Sparse, ...]
    redundant: tuple[tuple[int, ...], ...]


def eliminate_blocks(rows: Sequence[Sparse], scale: Array, bodies: int, strokes: int) -> ConstraintSolution:
    """Eliminate constraints, each a row (1, N), on the twists of `bodies` bodies (the platform first) and on the strokes.

    `scale` (N,) makes the coordinates comparable.

    >>> rows = [Sparse(np.array([0, 6]), np.array([[1.0, -1.0]]), 12), Sparse(np.array([6]), np.array([[1.0]]), 12)]
    >>> result = eliminate_blocks([*rows, rows[1]], np.ones(12), bodies=2, strokes=0)
    >>> len(result.last.independent), len(result.idle), result.redundant
    (5, 5, ((1, 2),))
    """
    starts = np.concatenate([6 * np.arange(bodies), 6 * bodies + np.arange(strokes + 1)])
    groups = {number: _group(row, number, scale, starts) for number, row in enumerate(rows)}
    near: dict[int, set[int]] = {block: set() for block in range(bodies + strokes)}
    for number, group in groups.items():
        for block in group.blocks:
            near[block].add(number)
    solutions: dict[int, _Solution] = {}
    stresses: list[tuple[Array, Array]] = []
    depth = dict.fromkeys(near, 0)
    heap = [(_degree(groups, near[block]), block) for block in range(1, bodies)]
    heapq.heapify(heap)
    while heap:
        cost, block = heapq.heappop(heap)
        current = depth[block] + _degree(groups, near[block])
        if cost != current:
            heapq.heappush(heap, (current, block))
            continue
        own = _take(groups, near, block)
        solutions[block], left = _eliminate(block, _join(own, block, starts), starts, stresses)
        for other in solutions[block].others:
            depth[other] = max(depth[other], depth[block] + 1)
        if left is not None:
            key = len(rows) + block
            groups[key] = left
            for other in left.blocks:
                near[other].add(key)
    return _solved(list(groups.values()), solutions, stresses, scale=scale, starts=starts, bodies=bodies)


def _take(groups: dict[int, _Group], near: dict[int, set[int]], block: int) -> list[_Group]:
    """Remove and return the groups of rows of a block."""
    numbers = sorted(near.pop(block))
    own = [groups.pop(number) for number in numbers]
    for other in {each for group in own for each in group.blocks} - {block}:
        near[other].difference_update(numbers)
    return own


def _group(row: Sparse, number: int, scale: Array, starts: Array) -> _Group:
    """A constraint by its blocks, scaled to unit size."""
    touched = np.unique(np.searchsorted(starts, row.columns, side="right") - 1)
    widths, places = _places(touched, starts)
    values = np.zeros((1, int(widths.sum())))
    blocks = np.searchsorted(starts, row.columns, side="right") - 1
    offset = dict(zip(touched.tolist(), places.tolist(), strict=True))
    for column, block, value in zip(row.columns, blocks, row.values[0], strict=True):
        values[0, offset[int(block)] + column - starts[block]] += value * scale[column]
    size = float(np.linalg.norm(values))
    return _Group(tuple(touched.tolist()), values / (size or 1.0), np.array([number]), np.ones((1, 1)))


def _places(blocks: Array, starts: Array) -> tuple[Array, Array]:
    """Widths of blocks, and their offsets in concatenation."""
    widths = starts[blocks + 1] - starts[blocks]
    return widths, (np.cumsum(widths) - widths).astype(int)


def _degree(groups: dict[int, _Group], numbers: set[int]) -> int:
    return len({block for number in numbers for block in groups[number].blocks})


def _join(groups: Sequence[_Group], first: int | None, starts: Array) -> _Group:
    """Stack groups over the union of their blocks, with one of them first."""
    others = sorted({block for group in groups for block in group.blocks} - {first})
    blocks = np.array([*([] if first is None else [first]), *others], dtype=int)
    made = np.unique(np.concatenate([group.made for group in groups])) if groups else np.zeros(0, dtype=int)
    widths, places = _places(blocks, starts)
    offset = dict(zip(blocks.tolist(), places.tolist(), strict=True))
    count = sum(len(group.rows) for group in groups)
    rows, shares = np.zeros((count, int(widths.sum()))), np.zeros((count, len(made)))
    row = 0
    for group in groups:
        span = slice(row, row + len(group.rows))
        column = 0
        for block in group.blocks:
            width = int(starts[block + 1] - starts[block])
            rows[span, offset[block] : offset[block] + width] = group.rows[:, column : column + width]
            column += width
        shares[span, np.searchsorted(made, group.made)] = group.shares
        row += len(group.rows)
    return _Group(tuple(blocks.tolist()), rows, made, shares)


def _eliminate(block: int, group: _Group, starts: Array, stresses: list[tuple[Array, Array]]) -> tuple[_Solution, _Group | None]:
    """Body coordinates from its rows, and the rows that do not contain it; zero rows are self-stress states."""
    width = int(starts[block + 1] - starts[block])
    others = group.blocks[1:]
    if not len(group.rows):
        every = np.arange(width)
        return _Solution(every, every[:0], np.zeros((0, width)), (), np.zeros((0, 0))), None
    turn, triangle, order = scipy.linalg.qr(group.rows[:, :width], pivoting=True)
    rank = int(np.sum(np.abs(np.diag(triangle)) > _RANK))
    remainder, shares = turn.T @ group.rows[:, width:], turn.T @ group.shares
    solved = -np.linalg.solve(triangle[:rank, :rank], np.concatenate([triangle[:rank, rank:], remainder[:rank]], axis=1))
    free = width - rank
    solution = _Solution(order[rank:], order[:rank], solved[:, :free], others, solved[:, free:])
    vanished = np.max(np.abs(remainder[rank:]), axis=1, initial=0.0) < _RANK
    stresses += [(group.made, share) for share in shares[rank:][vanished]]
    kept = remainder[rank:][~vanished]
    return solution, _Group(others, kept, group.made, shares[rank:][~vanished]) if len(kept) else None


def _solved(
    groups: list[_Group], solutions: dict[int, _Solution], stresses: list[tuple[Array, Array]], *, scale: Array, starts: Array, bodies: int
) -> ConstraintSolution:
    kept = [0, *range(bodies, len(starts) - 1)]
    columns = np.concatenate([np.arange(starts[block], starts[block + 1]) for block in kept])
    whole = _join(groups, None, starts)
    rows = np.zeros((len(whole.rows), len(columns)))
    own = np.concatenate([np.arange(starts[block], starts[block + 1]) for block in whole.blocks]) if whole.blocks else columns[:0]
    rows[:, np.searchsorted(columns, own)] = whole.rows
    if len(rows):
        sizes = np.linalg.norm(rows, axis=1)
        sizes = np.where(sizes > 0.0, sizes, 1.0)
        stresses += [(whole.made, state @ whole.shares) for state in null_space((rows / sizes[:, None]).T).T / sizes]
    last = eliminate(rows / scale[columns], scale[columns], keep=tuple(range(6)))
    return ConstraintSolution(last, tuple(_idle_motions(solutions, starts, scale)), _named(stresses))


def _idle_motions(solutions: dict[int, _Solution], starts: Array, scale: Array) -> list[Sparse]:
    """A motion for every free coordinate, with all coordinates that follow from it."""
    names = list(solutions)
    place = {block: number for number, block in enumerate(names)}
    follow: dict[int, list[int]] = {}
    for block, solution in solutions.items():
        for other in solution.others:
            follow.setdefault(other, []).append(block)
    motions: list[Sparse] = []
    for block, solution in solutions.items():
        if not len(solution.free):
            continue
        moved = {block: np.zeros((int(starts[block + 1] - starts[block]), len(solution.free)))}
        moved[block][solution.free] = np.eye(len(solution.free))
        moved[block][solution.bound] = solution.own
        heap = [-place[each] for each in follow.get(block, ())]
        heapq.heapify(heap)
        while heap:
            each = names[-heapq.heappop(heap)]
            if each in moved:
                continue
            motion = _following(solutions[each], moved, starts, each, len(solution.free))
            if np.any(np.abs(motion) > _RANK):
                moved[each] = motion
                for later in follow.get(each, ()):
                    heapq.heappush(heap, -place[later])
        columns = np.concatenate([np.arange(starts[each], starts[each + 1]) for each in moved])
        values = np.concatenate(list(moved.values())) * scale[columns, None]
        motions += [Sparse(columns, values[:, [number]].T, len(scale)) for number in range(values.shape[1])]
    return motions


def _following(solution: _Solution, moved: dict[int, Array], starts: Array, block: int, count: int) -> Array:
    """Motion of a block by the blocks that have moved, its own free coordinates at zero."""
    result = np.zeros((int(starts[block + 1] - starts[block]), count))
    column = 0
    for other in solution.others:
        width = int(starts[other + 1] - starts[other])
        if other in moved:
            result[solution.bound] += solution.rest[:, column : column + width] @ moved[other]
        column += width
    return result


def _named(stresses: list[tuple[Array, Array]]) -> tuple[tuple[int, ...], ...]:
    """The constraints of each self-stress state; states with common constraints are separated if possible."""
    if not stresses:
        return ()
    parts: list[tuple[int, ...]] = []
    for members in _connected([made[np.abs(share) > _RANK] for made, share in stresses]):
        made = np.unique(np.concatenate([stresses[member][0] for member in members]))
        states = np.zeros((len(members), len(made)))
        for row, member in enumerate(members):
            states[row, np.searchsorted(made, stresses[member][0])] = stresses[member][1]
        parts += [tuple(made[np.abs(state) > 1e2 * _RANK].tolist()) for state in echelon(states)]
    return tuple(parts)


def _connected(sets: list[Array]) -> list[list[int]]:
    """Number sets by connected components of common members."""
    owners = np.repeat(np.arange(len(sets)), [len(each) for each in sets])
    members = len(sets) + np.concatenate(sets)
    size = int(np.max(members, initial=len(sets) - 1)) + 1
    joined = scipy.sparse.coo_array((np.ones(len(members)), (owners, members)), (size, size))
    part = scipy.sparse.csgraph.connected_components(joined, directed=False)[1][: len(sets)]
    return sorted((np.flatnonzero(part == number).tolist() for number in np.unique(part)), key=max)
