"""Modes: frequencies, shapes, names, and which of them are the platform's."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexstage.base.labelled import Matrix
from flexstage.base.number import Array, first_design
from flexstage.readings.linear.eigen import Eigen, eigen
from flexstage.readings.linear.model import LinearModel
from flexstage.spatial.frame import COMPONENTS

_PLATFORM = "platform"
_IN_PLANE = [0, 1, 5]
_NAMES = ("x", "y", "z", "tilt", "tilt", "yaw")
_LOCAL_WINDOW = 1.5


@dataclass(frozen=True, eq=False)
class Modes:
    """Undamped modes of a stage, ascending.

    `frequencies` (..., k) [Hz]; `shapes` (..., n, k) mass-normalised; `platform_shapes` (..., 6, k) the platform's twist; `share` (..., k)
    kinetic energy of the platform body over the total; `bodies` names the rows of `energies` (..., b, k), the share of every body and
    link. `names`, `in_plane` and `platform` (indices of the platform's modes) are those of the first design. `margin` is the largest share
    not chosen.
    """

    frequencies: Array
    shapes: Array
    platform_shapes: Array
    share: Array
    bodies: tuple[str, ...]
    energies: Array
    names: tuple[str, ...]
    in_plane: tuple[bool, ...]
    platform: tuple[int, ...]
    margin: float
    limit: float
    coordinates: tuple[str, ...]
    provenance: str

    @property
    def platform_frequencies(self) -> Array:
        """Frequencies of the platform's modes (..., 6) [Hz]."""
        return self.frequencies[..., list(self.platform)]

    @property
    def local(self) -> tuple[int, ...]:
        """Modes that are not the platform's, below 1.5 times its highest one."""
        if not self.platform:
            return ()
        highest = first_design(self.platform_frequencies, 1)[-1]
        frequencies = first_design(self.frequencies, 1)
        return tuple(
            index for index in range(len(self.names)) if index not in self.platform and frequencies[index] < _LOCAL_WINDOW * highest
        )


def modes(model: LinearModel, *, limit: float = np.inf, count: int = 6, cluster: float = 1e-6) -> Modes:
    """Modes of the undamped model (Eq. 28 of Shin & Moon).

    The platform's modes are the `count` largest platform shares below `limit` [Hz] (absent: of all modes); modes closer than `cluster`
    (relative) are kept together, and within such a cluster the basis is turned so that shapes follow the platform's axes. Small
    motions.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.readings.mapped import mapped
    >>> modes(mapped(double_triangle())).names[:4]
    ('tilt', 'tilt', 'z', 'yaw')
    """
    platform = model.output[..., model.output_index(tuple(f"{_PLATFORM}.{name}" for name in COMPONENTS)), :]
    solved = _aligned(platform, eigen(model), cluster)
    frequencies = np.sqrt(solved.values) / (2.0 * np.pi)
    bodies, energies, components = _energies(model, solved)
    share = energies[..., bodies.index(_PLATFORM), :] if _PLATFORM in bodies else np.zeros_like(frequencies)
    chosen, margin = _chosen(first_design(share, 1), first_design(frequencies, 1), limit, count, cluster)
    names, in_plane = _named(bodies, first_design(energies, 2), components)
    return Modes(
        frequencies=frequencies,
        shapes=solved.shapes,
        platform_shapes=platform @ solved.shapes,
        share=share,
        bodies=bodies,
        energies=energies,
        names=names,
        in_plane=in_plane,
        platform=chosen,
        margin=margin,
        limit=limit,
        coordinates=model.coordinates,
        provenance=model.provenance,
    )


def clusters(values: Array, gap: float) -> list[list[int]]:
    """Group ascending values whose relative gap to the next is below `gap`.

    >>> clusters(np.array([1.0, 1.0 + 1e-9, 2.0]), 1e-6)
    [[0, 1], [2]]
    """
    groups: list[list[int]] = []
    for index, value in enumerate(values):
        if groups and value - values[groups[-1][-1]] <= gap * value:
            groups[-1].append(index)
        else:
            groups.append([index])
    return groups


def _aligned(platform: Array, solved: Eigen, gap: float) -> Eigen:
    """Turn the basis of repeated modes so that their platform shapes separate along the axes (first design's clusters)."""
    shapes = np.array(solved.shapes)
    weighted = (platform @ shapes) * np.array([1.0, 1.0, 1.0, 0.1, 0.1, 0.1])[:, None]
    for group in clusters(first_design(solved.values, 1), 2.0 * gap):
        if not 1 < len(group) <= len(COMPONENTS):  # six motions of the platform cannot tell more shapes apart
            continue
        seen = weighted[..., group]
        leading = np.sort(np.argsort(-np.round(np.sum(first_design(seen, 2) ** 2, axis=1), 9), kind="stable")[: len(group)])
        turn, _ = np.linalg.qr(np.swapaxes(seen[..., leading, :], -1, -2))
        sign = np.sign(np.sum((seen @ turn)[..., leading, :] * np.eye(len(group)), axis=-2, keepdims=True))
        shapes[..., group] = shapes[..., group] @ turn * np.where(sign == 0.0, 1.0, sign)
    return Eigen(solved.values, shapes)


def _energies(model: LinearModel, solved: Eigen) -> tuple[tuple[str, ...], Array, Array]:
    """Names of bodies and links, their energy shares (..., b, k), and by component (b, 6, k) for the first design."""
    rows, components = [], []
    for item in model.inertia.values():
        seen = item.operator @ solved.shapes
        products = seen * (item.law @ seen)
        rows.append(np.sum(products, axis=-2))
        components.append(_by_component(first_design(products, 2)))
    values = np.stack(np.broadcast_arrays(*rows), axis=-2)
    return tuple(model.inertia), values / np.sum(values, axis=-2, keepdims=True), np.stack(components)


def _by_component(products: Array) -> Array:
    """Sums (6, k) over the twists in the rows; energy within an elastic body belongs to no component."""
    rows, count = products.shape
    return products.reshape(-1, 6, count).sum(axis=0) if rows in {6, 12} else np.zeros((6, count))


def _chosen(share: Array, frequencies: Array, limit: float, count: int, gap: float) -> tuple[tuple[int, ...], float]:
    """Indices of the largest shares below the limit, clusters whole; and the largest share left out."""
    groups = [group for group in clusters(frequencies, gap) if frequencies[group[0]] < limit]
    groups.sort(key=lambda group: -float(np.mean(share[group])))
    chosen: list[int] = []
    for group in groups:
        if len(chosen) >= count:
            break
        chosen += group
    left = [share[index] for group in groups for index in group if index not in chosen]
    return tuple(sorted(chosen)), float(max(left, default=0.0))


def _named(bodies: tuple[str, ...], energies: Array, components: Array) -> tuple[tuple[str, ...], tuple[bool, ...]]:
    """Names of modes by the component that carries most of their main body's energy, and whether that motion is in plane."""
    main = np.argmax(energies, axis=0)
    if _PLATFORM in bodies:
        platform = bodies.index(_PLATFORM)
        main = np.where(energies[platform] >= 0.5 * np.max(energies, axis=0), platform, main)
    parts = components[main, :, np.arange(len(main))]
    in_plane = np.sum(parts[:, _IN_PLANE], axis=1) > 0.5 * np.sum(parts, axis=1)
    names = (
        _NAMES[component] if bodies[body] == _PLATFORM else f"{bodies[body]} local"
        for body, component in zip(main, np.argmax(parts, axis=1), strict=True)
    )
    return tuple(names), tuple(in_plane.tolist())


def modal_assurance(first: Array, second: Array, weight: Array | None = None) -> Matrix:
    """Modal assurance criterion |a^T W b|^2 / (a^T W a)(b^T W b) of shapes (n, k) and (n, m); W (n, n) defaults to the unit matrix.

    Allemang & Brown 1982. Shapes that mix translations and rotations need a weight (the inertia matrix).

    >>> modal_assurance(np.eye(2), np.array([[1.0], [1.0]])).values.round(12).ravel().tolist()
    [0.5, 0.5]
    """
    metric = np.eye(first.shape[-2]) if weight is None else weight
    cross = np.abs(np.conj(np.swapaxes(first, -1, -2)) @ metric @ second) ** 2
    own = [np.real(np.sum(np.conj(shape) * (metric @ shape), axis=-2)) for shape in (first, second)]
    values = cross / (own[0][..., :, None] * own[1][..., None, :])
    rows, columns = (tuple(str(index + 1) for index in range(shape.shape[-1])) for shape in (first, second))
    return Matrix(values, rows, columns, "1")


def subspace_angle(first: Array, second: Array, weight: Array | None = None) -> float:
    """Largest principal angle [rad] between the spaces of shapes (n, k) and (n, m): how far repeated modes agree as subspaces.

    >>> round(subspace_angle(np.eye(3)[:, :2], np.eye(3)[:, :2] @ np.array([[1.0, 1.0], [1.0, -1.0]])), 7)
    0.0
    """
    half = np.eye(first.shape[-2]) if weight is None else np.linalg.cholesky(weight).T
    left, right = (np.linalg.qr(half @ shape)[0] for shape in (first, second))
    distance = right - left @ (left.conj().T @ right)
    return float(np.arcsin(np.clip(np.linalg.norm(distance, 2), 0.0, 1.0)))
