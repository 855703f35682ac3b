"""Linear systems with named inputs and outputs, continuous or sampled."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Annotated

import numpy as np
import scipy

from flexstage.base.arguments import CheckedFields
from flexstage.base.finding import Finding, refuse, require, suggest_nearest, unknown_names
from flexstage.base.number import Array
from flexstage.base.record import INNER, VIEW, Called
from flexstage.base.units.quantity import TIME
from flexstage.models.linear.model import Channel
from flexstage.models.linear.state_space import StateSpace

_SINGULAR = 1e-12
_CHUNK = 2_000_000
_FEW = 12
"""Number of points below which solving one by one costs less than row by row."""


def names_of(channels: Iterable[Channel]) -> tuple[str, ...]:
    """Return the names of channels."""
    return tuple(channel.name for channel in channels)


@dataclass(frozen=True, eq=False)
class System(CheckedFields):
    """Linear system x' = A x + B u, y = C x + D u; with a `step` T [s]: x[k+1] = A x[k] + B u[k], y[k] = C x[k] + D u[k].

    The matrices are A (n, n), B (n, m), C (p, n), D (p, m) in SI units; `inputs` and `outputs` have unique names and units. Raises
    `DesignError` for shapes that do not match, and for repeated names.
    """

    A: Annotated[Array, VIEW]
    B: Annotated[Array, VIEW]
    C: Annotated[Array, VIEW]
    D: Annotated[Array, VIEW]
    inputs: Annotated[tuple[Channel, ...], INNER]
    outputs: Annotated[tuple[Channel, ...], INNER]
    step: Annotated[float | None, TIME] = None

    def __post_init__(self) -> None:
        super().__post_init__()
        require(_findings(self))

    @property
    def input_names(self) -> Annotated[tuple[str, ...], Called("inputs")]:
        """Names of the inputs."""
        return names_of(self.inputs)

    @property
    def output_names(self) -> Annotated[tuple[str, ...], Called("outputs")]:
        """Names of the outputs."""
        return names_of(self.outputs)

    @cached_property
    def poles(self) -> Array:
        """Eigenvalues (n,) of A: in 1/s, or in the z plane for a sampled system."""
        return np.linalg.eigvals(self.A)

    @property
    def growth(self) -> float:
        """Spectral abscissa [1/s], the largest growth rate: Re(p) of a pole p, or ln|p| / T in a sampled system; negative if stable."""
        poles = self.poles
        if not len(poles):
            return -np.inf
        return float(np.max(np.real(poles)) if self.step is None else np.log(max(np.max(np.abs(poles)), 1e-300)) / self.step)

    @property
    def balanced(self) -> tuple[Array, Array, Array, Array]:
        """Matrices A, B and C after balancing, and the scale factors (n,) of the states."""
        A, (scale, _) = scipy.linalg.matrix_balance(self.A, permute=False, separate=True)
        return A, self.B / scale[:, None], self.C * scale, scale

    @cached_property
    def schur_form(self) -> tuple[Array, Array, Array]:
        """Matrices T, Q^H B and C Q of the complex Schur form A = Q T Q^H (T triangular), after balancing."""
        if not np.any(np.tril(self.A, -1)):  # single-loop laws are already triangular
            return self.A.astype(complex), self.B.astype(complex), self.C.astype(complex)
        A, B, C, _ = self.balanced
        triangle, vectors = scipy.linalg.schur(A.astype(complex), output="complex")[:2]
        return triangle, vectors.conj().T @ B, C @ vectors

    def _points(self, frequencies: Array) -> Array:
        turning = 2j * np.pi * np.asarray(frequencies, dtype=float)
        return turning if self.step is None else np.exp(turning * self.step)

    def transfer(self, frequencies: Array) -> Array:
        """Compute the frequency response H = C (lambda - A)^-1 B + D, (f, p, m) at `frequencies` (f,) [Hz].

        lambda = j omega, or e^{j omega T} for a sampled system. The states are balanced first, because modal velocities are about a
        thousand times larger than modal displacements. Without balancing, the solution would lose accuracy by a factor of about a thousand.
        """
        A, B, C, _ = self.balanced
        points = self._points(frequencies)
        shifted = points[:, None, None] * np.eye(len(A)) - A
        return C @ np.linalg.solve(shifted, np.broadcast_to(B.astype(complex), (len(points), *B.shape))) + self.D

    def sweep(self, frequencies: Array, columns: slice = slice(None)) -> Array:
        """Compute the frequency response at many frequencies, for the inputs in `columns`.

        The result at infinite frequency is D (continuous systems only). The method is one Schur decomposition, then back substitution with
        n^2 operations per point; A may be defective. Elements that are zero by symmetry contain rounding errors in proportion to the
        largest element.
        """
        frequencies, direct = np.asarray(frequencies, dtype=float), self.D[:, columns]
        points = self._points(np.where(np.isfinite(frequencies), frequencies, 0.0))
        triangle, entry, exit_ = self.schur_form
        entry = entry[:, columns]
        size = max(1, _CHUNK // max(1, entry.size))
        pieces = [_respond(triangle, entry, exit_, points[start : start + size]) for start in range(0, len(points), size)]
        found = np.concatenate(pieces) + direct if pieces else np.zeros((0, *direct.shape), complex)
        return np.where(np.isfinite(frequencies)[:, None, None], found, direct)


def _respond(triangle: Array, entry: Array, exit_: Array, points: Array) -> Array:
    """C (lambda - T)^-1 B at points (f,): a few one by one, many row by row."""
    if len(points) <= _FEW and len(triangle):
        return np.stack([exit_ @ scipy.linalg.blas.ztrsm(1.0, point * np.eye(len(triangle)) - triangle, entry) for point in points])
    (size, width), shifted = entry.shape, points[:, None] - np.diag(triangle)
    solved = np.zeros((size, len(points) * width), complex)
    for row in range(size - 1, -1, -1):
        above = triangle[row, row + 1 :] @ solved[row + 1 :]
        solved[row] = ((entry[row] + above.reshape(len(points), width)) / shifted[:, row, None]).ravel()
    return np.moveaxis((exit_ @ solved).reshape(len(exit_), len(points), width), 0, 1)


def _findings(system: System) -> Iterable[Finding]:
    states, width, height = len(system.A), len(system.inputs), len(system.outputs)
    for name, shape in (("A", (states, states)), ("B", (states, width)), ("C", (height, states)), ("D", (height, width))):
        found = np.shape(getattr(system, name))
        if found != shape:
            yield Finding(
                f"matrix {name}",
                f"wrong shape (got {found}, expected {shape} for these states, inputs and outputs)",
                "Use matrices of matching shapes",
            )
    for kind, names in (("input", system.input_names), ("output", system.output_names)):
        if len({*names}) < len(names):
            for name in sorted({name for name in names if names.count(name) > 1}):
                yield Finding(name, f"{names.count(name)} {kind}s have this name", "Rename all but one")
    if system.step is not None and not 0.0 < system.step < np.inf:
        yield Finding("step", f"must be positive (got {system.step:g} s)", "Use a positive time, or none for a continuous system")


def from_state_space(space: StateSpace) -> System:
    """Convert a stage's state space to a system.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.models.linear.port import ports
    >>> from flexstage.models.linear.state_space import state_space
    >>> from flexstage.models.lumped import lumped
    >>> model = lumped(parallelogram())
    >>> found = from_state_space(state_space(model, ports(model, ["S"], ["B"]), model.damping, modes=2))
    >>> found.output_names, found.A.shape, found.growth < 0.0
    (('S',), (4, 4), True)
    """
    return System(space.A, space.B, space.C, space.D, space.inputs, space.outputs)


def static(gain: Array, inputs: tuple[Channel, ...], outputs: tuple[Channel, ...], step: float | None = None) -> System:
    """Construct the static system y = `gain` u, gain (p, m).

    >>> volt, metre = (Channel("u", "V"),), (Channel("y", "m"),)
    >>> static(np.array([[3.0]]), volt, metre).transfer(np.array([1.0])).real.tolist()
    [[[3.0]]]
    """
    return System(np.zeros((0, 0)), np.zeros((0, len(inputs))), np.zeros((len(outputs), 0)), np.asarray(gain), inputs, outputs, step)


def lag(channels: tuple[Channel, ...], bandwidths: Array, outputs: tuple[Channel, ...]) -> System:
    """Construct parallel first-order lags y = u / (1 + s / (2 pi f)), -3 dB at `bandwidths` (m,) [Hz]; infinite: no lag.

    >>> found = lag((Channel("u", "m"),), np.array([100.0]), (Channel("y", "m"),))
    >>> np.abs(found.transfer(np.array([0.0, 100.0]))).ravel().round(4).tolist()
    [1.0, 0.7071]
    """
    bandwidths = np.asarray(bandwidths, dtype=float)
    slow = np.isfinite(bandwidths)
    rates, chosen = 2.0 * np.pi * bandwidths[slow], np.eye(len(channels))[slow]
    return System(-np.diag(rates), rates[:, None] * chosen, chosen.T, np.diag(1.0 * ~slow), channels, outputs)


def rename(system: System, names: Mapping[str, str]) -> System:
    """Rename some inputs and outputs of a system.

    >>> one = static(np.eye(1), (Channel("u", "m"),), (Channel("y", "m"),))
    >>> rename(one, {"u": "stroke"}).input_names
    ('stroke',)
    """
    changed = [tuple(replace(each, name=names.get(each.name, each.name)) for each in group) for group in (system.inputs, system.outputs)]
    return replace(system, inputs=changed[0], outputs=changed[1])


def select(system: System, inputs: Iterable[str], outputs: Iterable[str]) -> System:
    """Return the system with only these inputs and outputs, in this order. Raises `DesignError` for unknown names.

    >>> two = static(np.array([[1.0, 2.0]]), (Channel("a", "m"), Channel("b", "m")), (Channel("y", "m"),))
    >>> select(two, ["b"], ["y"]).D.tolist()
    [[2.0]]
    """
    columns, rows = _indices(inputs, system.input_names, "input"), _indices(outputs, system.output_names, "output")
    return replace(
        system,
        B=system.B[:, columns],
        C=system.C[rows],
        D=system.D[np.ix_(rows, columns)],
        inputs=tuple(system.inputs[each] for each in columns),
        outputs=tuple(system.outputs[each] for each in rows),
    )


def _indices(names: Iterable[str], known: tuple[str, ...], kind: str) -> list[int]:
    names = tuple(names)
    require(unknown_names(names, known, kind))
    return [known.index(name) for name in names]


def reachable(system: System) -> System:
    """Remove the states that no input reaches, according to the nonzero pattern of the matrices."""
    own, reached = np.any(system.B != 0.0, axis=1), np.zeros(0, bool)
    while not np.array_equal(own, reached):
        reached = own
        own = own | np.any(system.A[:, own] != 0.0, axis=1)
    return system if np.all(own) else replace(system, A=system.A[np.ix_(own, own)], B=system.B[own], C=system.C[:, own])


Terms = Mapping[str, float]
"""Weighted sum of signals: the factor of each signal by its name."""


def connect(systems: Iterable[System], links: Mapping[str, Terms], inputs: tuple[Channel, ...], outputs: Iterable[str]) -> System:
    """Connect systems by signal names: every input in `links` is a weighted sum of outputs and of the new system's `inputs`.

    An input without an entry in `links` is connected to the new input, or to the output, with the same name. The inputs are u = F y + G w,
    with outputs y, new inputs w and the weights F and G; therefore u = (I - F D)^-1 (F C x + G w). Raises `DesignError` for inputs that
    remain unconnected, unknown names, different steps, and an algebraic loop (I - F D singular).

    >>> unit = Channel("r", "m")
    >>> integrator = System(np.zeros((1, 1)), np.eye(1), np.eye(1), np.zeros((1, 1)), (Channel("e", "m"),), (Channel("y", "m"),))
    >>> closed = connect([integrator], {"e": {"r": 1.0, "y": -1.0}}, (unit,), ["y"])
    >>> closed.A.tolist(), closed.B.tolist()
    ([[-1.0]], [[1.0]])
    """
    parts = tuple(systems)
    whole = _append(parts)
    require(_link_findings(whole, links, inputs))
    wired = {name: links.get(name, {name: 1.0}) for name in whole.input_names}
    rows, external = whole.output_names, names_of(inputs)
    feedback, entry = (
        np.array([[terms.get(name, 0.0) for name in names] for terms in wired.values()]).reshape(len(wired), len(names))
        for names in (rows, external)
    )
    solve = np.eye(len(wired)) - feedback @ whole.D
    if np.min(np.abs(np.linalg.eigvals(solve)), initial=1.0) < _SINGULAR:
        raise refuse("loop", "an algebraic loop of gain 1 has no solution", "Add a delay or a lag to the loop")
    states, driven = np.linalg.solve(solve, feedback @ whole.C), np.linalg.solve(solve, entry)
    closed = System(
        whole.A + whole.B @ states, whole.B @ driven, whole.C + whole.D @ states, whole.D @ driven, inputs, whole.outputs, whole.step
    )
    return select(closed, external, outputs)


def block_matrices(parts: Sequence[System]) -> Iterator[Array]:
    """Return the block-diagonal matrices A, B, C and D of independent systems."""
    return (scipy.linalg.block_diag(*(getattr(part, name) for part in parts)) for name in "ABCD")


def _append(parts: tuple[System, ...]) -> System:
    steps = {part.step for part in parts}
    if len(steps) != 1:
        shown = ", ".join(sorted("continuous" if step is None else f"{step:g} s" for step in steps))
        raise refuse("systems", f"the steps differ: {shown}", "Use the same step for all")
    return System(
        *block_matrices(parts),
        inputs=tuple(channel for part in parts for channel in part.inputs),
        outputs=tuple(channel for part in parts for channel in part.outputs),
        step=parts[0].step,
    )


def _link_findings(whole: System, links: Mapping[str, Terms], inputs: tuple[Channel, ...]) -> Iterable[Finding]:
    external = names_of(inputs)
    sources = (*external, *whole.output_names)
    for name in links:
        yield from unknown_names([name], whole.input_names, "input")
        for term in links[name]:
            if term not in sources:
                yield Finding(f"link to {name}", f"unknown signal '{term}'", suggest_nearest(term, sources))
    for name in whole.input_names:
        if name not in links and name not in sources:
            yield Finding(name, "this input is not connected", "Add a link, or list it among the inputs")
    for name in external:
        if name in whole.output_names:
            yield Finding(name, "an input and an output have this name", "Rename the input or the output")
