"""Natural modes: frequencies, shapes, names, and the selection of platform modes."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np

from flexstage.base.arguments import check_arguments
from flexstage.base.labelled import Matrix
from flexstage.base.notebook import Result
from flexstage.base.number import Array, argsort_descending, first_design, index_of_largest
from flexstage.base.record import INNER, VIEW, Heading, Layout, Mark
from flexstage.base.units.quantity import FREQUENCY, SHARE
from flexstage.models.batch.choice import Choice, choose, compliance_root, participation, platform_rows
from flexstage.models.linear.eigen import ALL_MODES, Eigen, lowest_modes, sign_weights
from flexstage.models.linear.model import LinearModel
from flexstage.spatial.frame import COMPONENTS, TWIST_UNITS

_PLATFORM = "platform"
_IN_PLANE = [0, 1, 5]
_NAMES = ("x", "y", "z", "tilt", "tilt", "yaw")
_LOCAL_WINDOW = 1.5
_REPEATED = 1e-6
_ROUNDING = 1e3 * float(np.finfo(float).eps)
_EQUAL = 1e-6
_LISTED = 24
_ROLES = {"platform": Mark.PASS, "local, near": Mark.WARN, "local": Mark.FAINT}
_NUMBERED = re.compile(r"([^\d/]+)(0|[1-9]\d*)(|/.*| \(link\))")


@dataclass(frozen=True, eq=False)
class Mode:
    """One mode: a `platform` mode, a `local` mode near a platform mode, or another mode.

    `platform_share` is the platform's fraction of the kinetic energy. `compliance_share` is the mode's fraction of the platform's static
    compliance, along the platform's motion in this mode. `energy_share` lists the bodies and links with a kinetic-energy fraction of at
    least 1 %, largest first.
    """

    TABLE: ClassVar[Layout] = Layout("Modes", "number frequency name platform_share compliance_share plane role")

    number: Annotated[int, Heading("mode")]
    frequency: Annotated[float, FREQUENCY]
    name: str
    platform_share: Annotated[float, SHARE, Heading("kinetic-energy fraction")]
    compliance_share: Annotated[float, SHARE]
    in_plane: bool
    platform: bool
    local: bool
    energy_share: Mapping[str, float]

    @property
    def plane(self) -> Annotated[str, INNER]:
        """Whether the motion is in plane or out of plane."""
        return "in plane" if self.in_plane else "out of plane"

    @property
    def role(self) -> Annotated[str, INNER, Heading(mark=_ROLES.__getitem__)]:
        """Role in words: "platform", "local, near" (a local mode near the platform modes) or "local"."""
        return "platform" if self.platform else "local, near" if self.local else "local"


class Modes(Result):
    """Undamped natural modes of a stage, sorted by frequency.

    The stage has k modes and n coordinates. `frequencies` (..., k) are in Hz, `shapes` (..., n, k) are mass-normalised, `platform_shapes`
    (..., 6, k) are the platform's twists. `share` (..., k) is the kinetic-energy fraction of the platform body, and `compliance_share`
    (..., k) is each mode's fraction of the platform's static compliance. `energies` (..., b, k) are the kinetic-energy fractions of b
    bodies and links, named in `bodies`. `chosen` (..., k) marks platform modes.

    `names`, `in_plane` and `platform` (indices of the platform modes) describe the modes of the first design. A local mode in which several
    bodies have equal energy fractions is named after all of them. `limit` determines only the number of listed modes. If `partial`, the
    stage is large and only its lowest modes were computed.
    """

    frequencies: Array
    shapes: Array
    platform_shapes: Array
    share: Array
    compliance_share: Array
    chosen: Array
    bodies: Annotated[tuple[str, ...], INNER]
    energies: Array
    names: Annotated[tuple[str, ...], INNER]
    in_plane: Annotated[tuple[bool, ...], INNER]
    platform: tuple[int, ...]
    limit: Annotated[float, FREQUENCY]
    coordinates: Annotated[tuple[str, ...], INNER]
    provenance: str
    partial: Annotated[bool, INNER] = False

    @property
    def modes(self) -> Annotated[tuple[Mode, ...], VIEW]:
        """Listed modes of the first design, ascending."""
        return tuple(map(self.mode, range(self.listed)))

    def mode(self, index: int) -> Mode:
        """Return one mode of the first design."""
        values = (self.frequencies, self.share, self.compliance_share)
        frequency, share, compliance = (float(first_design(each, 1)[index]) for each in values)
        energies = first_design(self.energies, 2)[:, index]
        bodies = {self.bodies[place]: float(energies[place]) for place in argsort_descending(energies, 1e-6) if energies[place] >= 0.01}
        platform, local = index in self.platform, index in self.local
        return Mode(index + 1, frequency, self.names[index], share, compliance, self.in_plane[index], platform, local, bodies)

    @property
    def listed(self) -> Annotated[int, VIEW]:
        """Number of listed modes: all modes below `limit` and all modes up to the last `platform` or `local` mode, but at least 24."""
        below = int(np.sum(first_design(self.frequencies, 1) < self.limit)) if np.isfinite(self.limit) else 0
        last = max((*self.local, *self.platform), default=-1) + 1
        return min(len(self.names), max(below, last, _LISTED))

    @property
    def computed(self) -> Annotated[int, VIEW]:
        """Number of computed modes: all modes, or only the lowest modes of a large stage."""
        return len(self.names)

    def dominant_bodies(self, index: int) -> tuple[str, float]:
        """Return the body or link (several if equal) with the largest energy fraction in a mode of the first design, and this fraction."""
        shares = first_design(self.energies, 2)[:, index]
        most = np.flatnonzero(shares >= np.max(shares) - _EQUAL)
        return _set([self.bodies[place] for place in most]), float(np.sum(shares[most]))

    @property
    def twists(self) -> Annotated[Matrix, VIEW]:
        """Mass-normalised platform twist in each listed mode."""
        columns = tuple(str(number + 1) for number in range(self.listed))
        units = tuple((f"{unit}/kg^0.5",) * self.listed for unit in TWIST_UNITS)
        return Matrix(self.platform_shapes[..., : self.listed], COMPONENTS, columns, units)

    @property
    def platform_frequencies(self) -> Array:
        """Platform frequencies (..., 6) [Hz], ascending; NaN if a design has fewer platform modes."""
        ordered = np.sort(np.where(self.chosen, self.frequencies, np.nan), axis=-1)
        return ordered[..., : int(np.max(np.sum(self.chosen, axis=-1), initial=0))]

    @property
    def highest(self) -> float:
        """Highest platform frequency below `limit` [Hz], of the first design; if none is below `limit`, the lowest platform frequency."""
        frequencies = first_design(self.platform_frequencies, 1)
        return float(max(frequencies[frequencies < self.limit], default=frequencies[0]))

    @property
    def local(self) -> Annotated[tuple[int, ...], VIEW]:
        """Local modes below 1.5 times the frequency of the highest platform mode."""
        if not self.platform:
            return ()
        highest = first_design(self.platform_frequencies, 1)[-1]
        frequencies = first_design(self.frequencies, 1)
        return tuple(
            index for index in range(len(self.names)) if index not in self.platform and frequencies[index] < _LOCAL_WINDOW * highest
        )


@check_arguments
def modes(model: LinearModel, *, limit: float = np.inf, cluster: float = _REPEATED) -> Modes:
    """Compute the undamped natural modes of a model (Shin & Moon, equation 28).

    The modal compliances are summed in ascending order of frequency. In some directions of platform motion, this sum exceeds a tenth of the
    static compliance. A mode that increases the number of these directions is a platform mode (see `models.batch.choice`). Modes with a
    relative frequency difference below `cluster` form a cluster. The basis of a cluster is rotated: shapes with platform motion are aligned
    with the platform's axes, other shapes with the coordinates that move most. The result contains all computed modes; `limit` [Hz] affects
    only `Modes.listed`. Displacements are small. For a large stage (`LinearModel.is_sparse`, above 900 degrees of freedom), only about 30
    of the lowest modes are computed.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.mapped import mapped
    >>> modes(mapped(double_triangle())).names[:4]
    ('tilt', 'tilt', 'z', 'yaw')
    """
    platform = platform_rows(model)
    solved = lowest_modes(model)
    partial = model.is_sparse and len(model.coordinates) > ALL_MODES
    groups = repeated_groups(first_design(solved.values, 1), cluster)
    solved, moving = _align(platform, solved, groups, sign_weights(model.coordinates))
    frequencies = np.sqrt(solved.values) / (2.0 * np.pi)
    bodies, energies, components = _energies(model, solved)
    share = energies[..., bodies.index(_PLATFORM), :] if _PLATFORM in bodies else np.zeros_like(frequencies)
    platform_shapes = platform @ solved.shapes
    still = solved.values == 0.0
    elastic = np.where(still, np.inf, solved.values)
    parts = participation(compliance_root(model, platform), platform_shapes, elastic)
    flat = (elastic.reshape(-1, solved.values.shape[-1]), parts.reshape(-1, *parts.shape[-2:]))
    floating = still & np.any(np.abs(platform_shapes) > 0.0, axis=-2)
    count = Choice().count - int(np.sum(floating))
    chosen = floating | choose(*flat, Choice(count, cluster)).mask.reshape(frequencies.shape)
    own = first_design(chosen, 1)
    together = _together(bodies, first_design(energies, 2), components, list(zip(groups, moving, strict=True)), own)
    names, in_plane = _name_modes(bodies, *together, own)
    return Modes(
        frequencies=frequencies,
        shapes=solved.shapes,
        platform_shapes=platform_shapes,
        share=share,
        compliance_share=np.where(floating, 1.0, np.sum(parts**2, axis=-2)),
        chosen=chosen,
        bodies=bodies,
        energies=energies,
        names=names,
        in_plane=in_plane,
        platform=tuple(np.flatnonzero(own).tolist()),
        limit=limit,
        coordinates=model.coordinates,
        provenance=model.provenance
        + (f", the lowest {len(names)} modes of {len(model.coordinates):,} degrees of freedom" if partial else ""),
        partial=partial,
    )


def clusters(values: Array, gap: float) -> list[list[int]]:
    """Return groups of indices of ascending values; within a group, neighbouring values have relative differences below `gap`.

    >>> clusters(np.array([1.0, 1.0 + 1e-9, 2.0]), 1e-6)
    [[0, 1], [2]]
    """
    return _split(values, gap * values)


def repeated_groups(values: Array, gap: float = _REPEATED) -> list[list[int]]:
    """Return groups of indices of ascending eigenvalues omega^2 whose frequencies agree within `gap` or rounding error.

    The solver computes 1/omega^2. The relative rounding error of omega^2 is therefore proportional to omega^2 divided by the least
    eigenvalue.

    >>> repeated_groups(np.array([1.0, 1.0 + 1e-9, 2.0]))
    [[0, 1], [2]]
    """
    least = values[values > 0.0][:1] if np.any(values == 0.0) else values[:1]
    return _split(values, (2.0 * gap + _ROUNDING * values / least) * values if len(least) else gap * values)


def _split(values: Array, slack: Array) -> list[list[int]]:
    """Groups of ascending values with gaps of at most their slack."""
    starts = 1 + np.flatnonzero(~(np.diff(values) <= slack[1:]))
    return [each.tolist() for each in np.split(np.arange(len(values)), starts)] if len(values) else []


def average(values: Array, groups: list[list[int]]) -> Array:
    """Replace every value (k,) by the mean of its group.

    >>> average(np.array([1.0, 3.0, 5.0]), [[0, 1], [2]]).tolist()
    [2.0, 2.0, 5.0]
    """
    return np.concatenate([np.full(len(group), np.mean(values[group])) for group in groups])


def _align(platform: Array, solved: Eigen, groups: list[list[int]], weights: Array) -> tuple[Eigen, list[int]]:
    """Rotate the basis of repeated modes to platform axes; also return the number of modes of each group that move the platform.

    In each group (of the first design), shapes with platform motion come first, along x, y, ...; shapes without it follow the coordinates
    that move most.
    """
    shapes, moving = np.array(solved.shapes), list[int]()
    own = np.array([1.0, 1.0, 1.0, 0.1, 0.1, 0.1])[:, None]
    alone = np.max(first_design(own * (platform @ shapes), 2) ** 2, axis=0) > _EQUAL**2 * np.max(
        first_design(weights[:, None] * shapes, 2) ** 2, axis=0
    )
    for group in groups:
        if len(group) == 1:
            moving.append(int(alone[group[0]]))
            continue
        seen, every = own * (platform @ shapes[..., group]), weights[:, None] * shapes[..., group]
        size = float(np.max(np.sum(first_design(every, 2) ** 2, axis=1)))
        leading = np.sort(_leading(first_design(seen, 2), _EQUAL**2 * size, np.eye(len(group))))
        moving.append(len(leading))
        rows = seen[..., leading, :]
        if len(leading) < len(group):
            rest = np.linalg.qr(first_design(rows, 2).T, mode="complete")[0][:, len(leading) :] if len(leading) else np.eye(len(group))
            rows = np.concatenate([rows, every[..., _leading(first_design(every, 2), 0.0, rest), :]], axis=-2)
        turn, upper = np.linalg.qr(rows.mT)
        shapes[..., group] = shapes[..., group] @ turn * np.where(np.linalg.diagonal(upper) < 0.0, -1.0, 1.0)[..., None, :]
    return Eigen(solved.values, shapes), moving


def _leading(rows: Array, least: float, basis: Array) -> Array:
    """Indices of the rows (n, k) that span them within `basis` (k, m), longest remaining first, with squares above `least`."""
    left, result = rows @ basis, list[int]()
    while len(result) < basis.shape[1]:
        squares = np.sum(left**2, axis=1)
        row = int(np.argmax(squares >= (1.0 - _EQUAL) * np.max(squares)))
        if squares[row] <= least:
            break
        result.append(row)
        left = left - np.outer(left @ left[row], left[row]) / squares[row]
    return np.array(result, dtype=int)


def _energies(model: LinearModel, solved: Eigen) -> tuple[tuple[str, ...], Array, Array]:
    """Names of bodies and links, their energy shares (..., b, k), and by component (b, 6, k) for the first design."""
    rows, components = [], []
    for item in model.inertia.values():
        seen = item.operator @ solved.shapes
        products = seen * (item.law @ seen)
        rows.append(np.sum(products, axis=-2))
        components.append(_by_component(first_design(products, 2)))
    values = np.stack(np.broadcast_arrays(*rows), axis=-2)
    shares = values / np.sum(values, axis=-2, keepdims=True)
    return tuple(model.inertia), np.where(np.abs(shares) > np.finfo(float).eps, shares, 0.0), np.stack(components)


def _by_component(products: Array) -> Array:
    """Sums (6, k) over the twists in the rows; without energy within elastic bodies."""
    rows, count = products.shape
    return products.reshape(-1, 6, count).sum(axis=0) if rows in {6, 12} else np.zeros((6, count))


def _together(
    bodies: tuple[str, ...], energies: Array, components: Array, groups: list[tuple[list[int], int]], chosen: Array
) -> tuple[Array, Array]:
    """Energy shares (b, k) and components (b, 6, k) as means over repeated modes, independent of their basis.

    The first modes of each group move the platform: components of platform modes stay separate.
    """
    energies, components = energies.copy(), components.copy()
    for group, count in (each for each in groups if len(each[0]) > 1):
        moving = group[:count]
        main = _main(bodies, np.mean(energies[:, moving], axis=1, keepdims=True), np.any(chosen[moving]))[0] if count else -1
        own = main >= 0 and bodies[main] == _PLATFORM
        if own:
            energies[:, moving] = np.mean(energies[:, moving], axis=1, keepdims=True)
        rest = group[count:] if own else group
        if rest:
            energies[:, rest] = np.mean(energies[:, rest], axis=1, keepdims=True)
            components[..., rest] = np.mean(components[..., rest], axis=-1, keepdims=True)
    return energies, components


def _main(bodies: tuple[str, ...], energies: Array, chosen: Array | np.bool_) -> Array:
    """Main body of modes (k): the platform for `chosen` ones, and if it has half of the largest share (b, k)."""
    main = index_of_largest(energies.T, _EQUAL)
    if _PLATFORM not in bodies:
        return main
    platform = bodies.index(_PLATFORM)
    least = np.where(chosen, 0.0, 0.5 * np.max(energies, axis=0) - _EQUAL)
    return np.where((energies[platform] > 0.0) & (energies[platform] >= least), platform, main)


def _name_modes(bodies: tuple[str, ...], energies: Array, components: Array, chosen: Array) -> tuple[tuple[str, ...], tuple[bool, ...]]:
    """Names of modes by the component with most energy of their main body, and whether this motion is in plane."""
    main = _main(bodies, energies, chosen)
    parts = components[main, :, np.arange(len(main))]
    in_plane = np.sum(parts[:, _IN_PLANE], axis=1) > (0.5 + _EQUAL) * np.sum(parts, axis=1)
    names = (
        _NAMES[component] if bodies[body] == _PLATFORM else f"{_set(_equal(bodies, shares))} local"
        for body, component, shares in zip(
            main, index_of_largest(parts, _EQUAL * np.max(parts, axis=1, keepdims=True)), energies.T, strict=True
        )
    )
    return tuple(names), tuple(in_plane.tolist())


def _equal(bodies: tuple[str, ...], shares: Array) -> list[str]:
    """Bodies with the largest share, in their order."""
    return [bodies[place] for place in np.flatnonzero(shares >= np.max(shares) - _EQUAL) if bodies[place] != _PLATFORM]


def _set(names: list[str]) -> str:
    """Names in one text, consecutive instances as a range: `B1-B3/tip`."""
    parts = [_NUMBERED.fullmatch(name) for name in names]
    copies: dict[tuple[str, ...], list[int]] = {}
    for name, result in zip(names, parts, strict=True):
        copies.setdefault((name,) if result is None else (result[1], result[3]), []).append(0 if result is None else int(result[2]))
    return ", ".join(text for key, numbers in copies.items() for text in _range(key, numbers))


def _range(key: tuple[str, ...], numbers: list[int]) -> list[str]:
    if len(key) == 1:
        return list(key)
    head, tail = key
    if len(numbers) > 1 and sorted(numbers) == list(range(min(numbers), max(numbers) + 1)):
        return [f"{head}{min(numbers)}-{head}{max(numbers)}{tail}"]
    return [f"{head}{number}{tail}" for number in numbers]


def modal_assurance(first: Array, second: Array, weight: Array | None = None) -> Matrix:
    """Compute the modal assurance criterion (MAC) |a^T W b|^2 / ((a^T W a) (b^T W b)) of shapes a (n, k) and b (n, m).

    The `weight` W (n, n) defaults to the unit matrix.

    Shapes with both translations and rotations need a weight, e.g. the inertia matrix. Reference: Allemang & Brown 1982.

    >>> modal_assurance(np.eye(2), np.array([[1.0], [1.0]])).values.round(12).ravel().tolist()
    [0.5, 0.5]
    """
    metric = np.eye(first.shape[-2]) if weight is None else weight
    cross = np.abs(np.conj(first.mT) @ metric @ second) ** 2
    own = [np.real(np.sum(np.conj(shape) * (metric @ shape), axis=-2)) for shape in (first, second)]
    values = cross / (own[0][..., :, None] * own[1][..., None, :])
    rows, columns = (tuple(str(index + 1) for index in range(shape.shape[-1])) for shape in (first, second))
    return Matrix(values, rows, columns, "1")
