"""From the numbers that vary between designs to features, and their exact derivatives.

A derivative is a complex step through the models' own formulas. Two variables that no feature shares are stepped together: a feature that
comes out complex knows whose step that is, as the type of an array says what it was made of. What units tell (`units`) is not stepped.
"""

from __future__ import annotations

import contextlib
import itertools
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from flexstage.base.finding import DesignError
from flexstage.base.number import Array
from flexstage.mechanism.addresses.address import get, set_value
from flexstage.mechanism.addresses.locate import Place, locate
from flexstage.mechanism.addresses.path import MATRICES, replace_member
from flexstage.mechanism.assembly.expand import expand
from flexstage.mechanism.mechanism import Mechanism
from flexstage.models.batch.parameters.features import (
    NOUGHT,
    Feature,
    Rows,
    Standpoint,
    Topology,
    distinct_links,
    features,
    pack,
    put,
    standpoint,
    stepped_features,
    topology,
)
from flexstage.models.batch.parameters.units import Path, Told, stepped_paths, told_by_units

_STEP = 1e-20
_OF_BODIES = frozenset({"first", "second", "inertia"})
_TRIALS = 12
"""Designs near the nominal one that are tried at most."""

Key = tuple[str, int]
"""A feature by kind and owner."""

Draw = Callable[[tuple[Array, ...]], Mechanism]
"""What makes a description of numbers (...), real or complex, one array each."""


@dataclass(frozen=True, eq=False)
class Change:
    """A feature that a variable changes, and which `rows` of its numbers; of symmetric matrices the upper half stands for both.

    Where a mass is `mirrored`, what one end has stands for the other, too.
    """

    variable: int
    place: Feature
    rows: Array
    mirrored: bool = False

    @property
    def key(self) -> Key:
        """The feature by kind and owner."""
        return self.place.key


@dataclass(frozen=True, eq=False)
class Family:
    """Designs that differ in P numbers, around a `mechanism`; `nominal` (P,) are its own.

    The numbers are those at `addresses`, or what `draw` makes descriptions of; then addresses are their names. Features are told from a
    `standpoint`: no arm changes where a centre of mass does. `touched` says which features each number is in, `changes` which of their
    numbers; `together` which are stepped in one pass.
    """

    mechanism: Mechanism
    addresses: tuple[str, ...]
    nominal: Array
    topology: Topology
    standpoint: Standpoint
    touched: tuple[frozenset[Key], ...]
    together: tuple[tuple[int, ...], ...]
    draw: Draw | None = None

    @cached_property
    def widest(self) -> tuple[Change, ...]:
        """Every change there can be, by variable."""
        places = self.topology.changing
        return tuple(
            Change(number, place, _upper(place)) for number, keys in enumerate(self.touched) for place in places if place.key in keys
        )

    @cached_property
    def located(self) -> tuple[Place, ...]:
        """Where the addresses point."""
        return tuple(locate(self.mechanism, address) for address in self.addresses)

    @cached_property
    def dividing(self) -> list[int]:
        """Numbers that formulas may divide by: those of parts, of drawn families all."""
        return [
            at for at, keys in enumerate(self.touched) if self.draw is not None or any(kind in {"stiffness", "mass"} for kind, _ in keys)
        ]

    @cached_property
    def told(self) -> Mapping[Key, tuple[Told, ...]]:
        """Which derivatives of stiffnesses and masses follow from others by units; of drawn families none."""
        moved: dict[int, dict[Path, list[int]]] = {}
        for variable, keys in enumerate(self.touched if self.draw is None else ()):
            owners = {owner for kind, owner in keys if kind in {"stiffness", "mass"}}
            if owners:
                value = _stepped(float(self.nominal[variable]))
                links = distinct_links(expand(set_value(self.mechanism, self.addresses[variable], value)))
                for owner in owners:
                    paths = stepped_paths(links[owner], value)
                    for path in paths:
                        moved.setdefault(owner, {}).setdefault(path, []).extend([variable] * (1 if len(paths) == 1 else 2))
        order = sorted(range(len(self.touched)), key=lambda variable: -len(self.touched[variable]))
        links = distinct_links(expand(self.mechanism))
        return {
            (kind, owner): told
            for owner, paths in moved.items()
            for kind, told in told_by_units(links[owner], {path: each[0] for path, each in paths.items() if len(each) == 1}, order).items()
        }

    @cached_property
    def dropped(self) -> Mapping[int, tuple[Change, ...]]:
        """By variable: what of bodies and their places is not among the changes. Where outlines overlap otherwise it may not be zero."""
        known = {(change.variable, change.place.start): change.rows for change in self.changes}
        found: dict[int, tuple[Change, ...]] = {}
        for change in self.widest:
            rows = np.setdiff1d(change.rows, known.get((change.variable, change.place.start), []), assume_unique=True)
            if change.place.kind in _OF_BODIES and len(rows):
                found[change.variable] = (*found.get(change.variable, ()), replace(change, rows=rows))
        return found

    @cached_property
    def wide(self) -> tuple[Change, ...]:
        """The changes of parts, mirrored or not, and axes, and all there can be of bodies and their places."""
        return tuple(
            sorted(
                (
                    *(change for change in self.moving if change.place.kind not in _OF_BODIES),
                    *(c for c in self.widest if c.place.kind in _OF_BODIES),
                ),
                key=lambda change: (change.variable, change.place.start),
            )
        )

    @cached_property
    def moving(self) -> tuple[Change, ...]:
        """Every change that is not zero at three designs near the nominal one: others are zero by the form of the formulas, or by units.

        Every one there can be where no three of them can be described.
        """
        own = _near_slopes(self)
        if own.shape[1] < 3:
            return self.widest
        moves = np.split((own != 0.0).any(axis=1), np.cumsum([len(change.rows) for change in self.widest], dtype=int))[:-1]
        felt = [rows & ~self._is_told_nought(change) for change, rows in zip(self.widest, moves, strict=True)]
        return tuple(replace(change, rows=change.rows[rows]) for change, rows in zip(self.widest, felt, strict=True) if rows.any())

    def _is_told_nought(self, change: Change) -> Array:
        """Which rows of a change are zero, as units tell."""
        own = [item for item in self.told.get(change.key, ()) if item.variable == change.variable and not item.rest]
        powers = [item.powers(change.place.kind, change.rows) for item in own]
        return np.any(np.array(powers).reshape(len(own), len(change.rows)) == 0.0, axis=0)

    @cached_property
    def near(self) -> Array | None:
        """Features' numbers (features, 1) of a design near the nominal one; none where none can be described."""
        for trial in _trials(self)[1:]:
            with contextlib.suppress(DesignError):
                return numbers_of(self, trial[None])
        return None

    @cached_property
    def mirrored(self) -> frozenset[int]:
        """The parts whose masses are the same seen from either end, to the bit, in the nominal design and near it."""
        known = [numbers for numbers in (numbers_of(self, self.nominal[None]), self.near) if numbers is not None]
        masses = [place for place in self.topology.features if place.kind == "mass"]
        return frozenset(place.owner for place in masses if len(known) > 1 and all(is_mirrored(each, place).all() for each in known))

    @cached_property
    def changes(self) -> tuple[Change, ...]:
        """What moves, of mirrored masses one end."""
        return tuple(
            replace(change, rows=change.rows[MIRROR[change.rows] >= change.rows], mirrored=True)
            if change.place.kind == "mass" and change.place.owner in self.mirrored
            else change
            for change in self.moving
        )


def _mirror() -> tuple[Array, Array]:
    """Of each number of a mass the one that the other end has, in the upper half, and the sign between them: angles about y and z turn."""
    row, column = np.divmod(np.arange(144), 12)
    other = np.sort(np.stack([(row + 6) % 12, (column + 6) % 12]), axis=0)
    turning = np.isin(np.arange(12) % 6, (4, 5))
    return 12 * other[0] + other[1], np.where(turning[row] == turning[column], 1.0, -1.0)


MIRROR, MIRROR_SIGN = _mirror()


def is_mirrored(numbers: Array | Rows, place: Feature) -> Array:
    """Of which designs (features, b) a mass is the same seen from either end, to the bit.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> found = family(double_triangle(), ())
    >>> mass = next(place for place in found.topology.features if place.kind == "mass")
    >>> is_mirrored(numbers_of(found, np.zeros((1, 0))), mass).tolist()
    [True]
    """
    own = numbers[place.slots]
    rows = np.flatnonzero((np.arange(144) < MIRROR) & (np.arange(144) // 12 <= np.arange(144) % 12))
    return np.asarray((own[rows] == MIRROR_SIGN[rows, None] * own[MIRROR[rows]]).all(axis=0))


def _near_slopes(family_: Family) -> Array:
    """Derivatives (rows, n) of all that may change, at three designs near the nominal one, or at fewer where no more can be described."""
    trials = _trials(family_)
    try:
        return _slopes(family_, trials[:3], family_.widest, {}, {})[0][:]
    except DesignError:
        told = (slopes for trial in trials for slopes in _told_slopes(family_, trial))
        return np.concatenate(list(itertools.islice(told, 3)), axis=1)


def _trials(family_: Family) -> Array:
    """The nominal design and others near it, in which no two numbers change alike."""
    number = np.arange(len(family_.nominal)) + 1.0
    scale = np.where(family_.nominal != 0.0, 0.01 * family_.nominal, 1e-4)
    steps = np.stack([0.0 * number, np.cos(number), -0.7 * np.cos(number), *(np.cos(turns * number) for turns in range(2, _TRIALS))])
    return np.asarray(family_.nominal + steps * scale)


def _told_slopes(family_: Family, design: Array) -> Iterator[Array]:
    """Those of one design, if it can be described."""
    with contextlib.suppress(DesignError):
        yield _slopes(family_, design[None], family_.widest, {}, {})[0][:]


def _upper(place: Feature) -> Array:
    rows = np.arange(int(np.prod(place.shape)))
    if not place.symmetric:
        return rows
    return rows[rows // place.shape[-1] <= rows % place.shape[-1]]


def family(mechanism: Mechanism, addresses: tuple[str, ...]) -> Family:
    """The family of a design and the addresses of the numbers that vary; raises `DesignError` for addresses there are none of.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> found = family(double_triangle(), ("parts.neck.thickness", "parts.foot_notch.thickness", "materials.steel.young"))
    >>> found.together  # the thicknesses of two parts in one pass, the modulus, which is in both, in another
    ((0, 1), (2,))
    """
    nominal = np.array([get(mechanism, address) for address in addresses])
    plain = _without_requirements(mechanism)
    for address, value in zip(addresses, nominal, strict=True):
        plain = set_value(plain, address, float(value))
    stepped = [set_value(plain, address, _stepped(value)) for address, value in zip(addresses, nominal, strict=True)]
    return _family(plain, addresses, nominal, stepped)


def drawn_family(draw: Draw, names: tuple[str, ...], nominal: Array) -> Family:
    """The family of the descriptions that `draw` makes of numbers with these names, around those of the `nominal` ones (P,).

    All of one topology. Derivatives pass through it: it must take complex numbers, and make nothing complex that does not depend on them.

    >>> from flexstage.cases.registry import Variant
    >>> hexapod = Variant("hexapod")
    >>> found = drawn_family(lambda values: hexapod.mechanism_at({"slope": values[0]}), ("slope",), np.array([0.8]))
    >>> numbers_of(found, np.array([[0.8], [0.9]])).shape[1]
    2
    """
    own = tuple(np.asarray(float(value)) for value in nominal)
    stepped = [draw((*own[:number], _step(own[number]), *own[number + 1 :])) for number in range(len(own))]
    return replace(_family(_without_requirements(draw(own)), names, np.asarray(nominal, float), stepped), draw=draw)


def _family(plain: Mechanism, names: tuple[str, ...], nominal: Array, stepped: list[Mechanism]) -> Family:
    """The family around a description, with those that have a complex step in each number."""
    assembly = expand(plain)
    seen = standpoint(assembly)
    touched = tuple(_complex(each, seen) for each in stepped)
    return Family(plain, names, nominal, topology(assembly), seen, touched, tuple(_together(touched)))


def _step(value: Array) -> Array:
    return value + 1j * (abs(value) * _STEP or _STEP)


def _complex(mechanism: Mechanism, seen: Standpoint) -> frozenset[Key]:
    """Features that come out complex."""
    return frozenset(key for key, array in features(mechanism, seen).items() if np.iscomplexobj(array))


def _without_requirements(mechanism: Mechanism) -> Mechanism:
    return replace(mechanism, requirements={})


def _stepped(value: float) -> complex:
    return complex(value, abs(value) * _STEP or _STEP)


def _together(touched: tuple[frozenset[Key], ...]) -> Iterator[tuple[int, ...]]:
    left = list(range(len(touched)))
    while left:
        seen: set[Key] = set()
        group: list[int] = []
        for number in left:
            if not touched[number] & seen:
                seen |= touched[number]
                group.append(number)
        yield tuple(group)
        left = [number for number in left if number not in group]


def describe(family_: Family, values: Array) -> Mechanism:
    """The description of many designs, from their numbers (b, P).

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> found = family(double_triangle(), ("parts.neck.thickness",))
    >>> describe(found, np.array([[1e-3], [2e-3]])).parts["neck"].thickness.tolist()
    [0.001, 0.002]
    """
    columns = tuple(values.T)
    return family_.draw(columns) if family_.draw is not None else _set(family_, family_.mechanism, dict(enumerate(columns)))


def _set(family_: Family, mechanism: Mechanism, values: Mapping[int, Array]) -> Mechanism:
    for number, value in values.items():
        address, place = family_.addresses[number], family_.located[number]
        plain = not place.owners and not place.number and not set(MATRICES) & set(place.path)
        mechanism = replace_member(mechanism, place.path, value) if plain else set_value(mechanism, address, value)
    return mechanism


def numbers_of(family_: Family, values: Array) -> Array:
    """The features' numbers (features, b) of designs given by (b, P).

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> found = family(double_triangle(), ("parts.neck.thickness",))
    >>> numbers_of(found, np.array([[1e-3], [2e-3]])).shape[1]
    2
    """
    return rows_of(family_, values)[:]


def rows_of(family_: Family, values: Array) -> Rows:
    """The same as the engine keeps them.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> found = family(double_triangle(), ("parts.neck.thickness",))
    >>> rows_of(found, np.array([[1e-3], [2e-3]])).shape[1]
    2
    """
    return pack(features(describe(family_, values), family_.standpoint), family_.topology.features, len(values))


@dataclass(frozen=True, eq=False)
class Slopes:
    """Derivatives (rows of all changes, b) of features by variables; `missed` (b,): designs that change where these changes say nothing.

    `still` (features,), where it is told: which of the numbers that were told beside them are the same in all designs.
    """

    changes: tuple[Change, ...]
    values: Array | Rows
    missed: Array
    still: Array | None = None

    def take(self, designs: Array | slice) -> Slopes:
        """Those of some designs."""
        return Slopes(self.changes, self.values[:, designs], self.missed[designs], self.still)


def slopes_of(family_: Family, values: Array, *, wide: bool = False) -> Slopes:
    """Derivatives of the features by every number that varies.

    With `wide` all that can change of bodies and their places, not what changes near the nominal design only: where outlines overlap
    otherwise, more does.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> found = family(double_triangle(), ("materials.steel.young",))
    >>> value = np.array([[200e9]])
    >>> slopes = slopes_of(found, value)  # stiffness is proportional to the modulus
    >>> bool(np.allclose(slopes.values[:6] * 200e9, numbers_of(found, value)[:36:7]))
    True
    """
    return numbers_and_slopes(family_, values, wide=wide)[1]


def numbers_and_slopes(family_: Family, values: Array, *, wide: bool = False) -> tuple[Rows, Slopes]:
    """The features' numbers, as `numbers_of` gives them to rounding, and their derivatives, as `slopes_of` does.

    What is stepped has its number as its real part and is not computed once more, but where a number of a part is nought.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> found, value = family(double_triangle(), ("parts.neck.thickness",)), np.array([[1e-3]])
    >>> bool(np.allclose(numbers_and_slopes(found, value)[0], numbers_of(found, value), rtol=1e-12, atol=0.0))
    True
    """
    changes = family_.wide if wide else family_.changes
    found, missed, numbers, still = _slopes(family_, values, changes, family_.told, {} if wide else family_.dropped)
    if not wide:
        for place in family_.topology.features:
            if place.kind == "mass" and place.owner in family_.mirrored:
                missed |= ~is_mirrored(numbers, place)
    nought = np.flatnonzero((values[:, family_.dividing] == 0.0).any(axis=1))  # a quotient by a step alone is not that by nought
    if len(nought):
        numbers[:, nought], still = numbers_of(family_, values[nought]), None
    _follow(family_, values, numbers, Slopes(changes, found, missed))
    lost = np.flatnonzero((values[:, [item.variable for told in family_.told.values() for item in told]] == 0.0).any(axis=1))
    if len(lost):
        found[:, lost] = _slopes(family_, values[lost], changes, {}, {})[0][:]
    return numbers, Slopes(changes, found, missed, still)


def _follow(family_: Family, values: Array, numbers: Rows, slopes: Slopes) -> None:
    """Write the derivatives that follow from others by units."""
    places = {(change.variable, *change.key): (at, change) for at, change in starts(slopes.changes)}
    for key, told in family_.told.items():
        for item in told:
            at, change = places.get((item.variable, *key), (0, None))
            if change is None:
                continue
            found = item.powers(key[0], change.rows)[:, None] * numbers[change.place.start + change.rows]
            for other, factor in item.rest:
                start, stepped = places.get((other, *key), (0, None))
                if stepped is not None:
                    _, to, of = np.intersect1d(change.rows, stepped.rows, assume_unique=True, return_indices=True)
                    found[to] -= factor * values[:, other] * slopes.values[start + of]
            slopes.values[at : at + len(change.rows)] = found / np.where(values[:, item.variable] != 0.0, values[:, item.variable], np.nan)


def starts(changes: tuple[Change, ...]) -> Iterator[tuple[int, Change]]:
    """The row that each change begins at among those of all, with the change.

    >>> list(starts(()))
    []
    """
    start = 0
    for change in changes:
        yield start, change
        start += len(change.rows)


def _slopes(
    family_: Family,
    values: Array,
    changes: tuple[Change, ...],
    told: Mapping[Key, tuple[Told, ...]],
    dropped: Mapping[int, tuple[Change, ...]],
) -> tuple[Rows, Array, Rows, Array]:
    """The derivatives (rows of the changes, b), but for those that units tell; in which designs what is `dropped` changes; the numbers.

    And which of the numbers are the same in all designs.
    """
    features_ = {place.key: place for place in family_.topology.features}
    numbers, missed = Rows(family_.topology.count, len(values)), np.zeros(len(values), dtype=bool)
    still = np.zeros(family_.topology.count, dtype=bool)
    result = Rows(sum(len(change.rows) for change in changes), len(values))
    places: dict[int, list[tuple[int, Change]]] = {}
    for start, change in starts(changes):
        if all(change.variable != item.variable for item in told.get(change.key, ())):
            places.setdefault(change.variable, []).append((start, change))
    wanted = {number: {change.key for _, change in own} for number, own in places.items()}
    for number, others in dropped.items():
        if any(number in group and any(other in wanted for other in group) for group in family_.together):
            wanted.setdefault(number, set()).update(change.key for change in others)
    for group, arrays in _stepped_features(family_, values, wanted):
        for key in arrays.keys() & features_.keys():
            still[features_[key].slots] = put(numbers, features_[key], arrays[key])
        for number in group:
            for at, change in (each for each in places.get(number, ()) if each[1].key in arrays):
                rates = np.imag(_flat(arrays[change.key], change)).T[change.rows]
                result[at : at + len(change.rows)] = rates.reshape(len(change.rows), -1) / width(family_, number)
            for change in (each for each in dropped.get(number, ()) if np.iscomplexobj(arrays.get(each.key, 0.0))):
                missed |= _does_change(arrays[change.key], change, width(family_, number) / abs(family_.nominal[number] or 1.0))
    return result, missed, numbers, still


def _does_change(array: Array, change: Change, step: float) -> Array:
    """In which designs a feature changes by a `step` of a number, over its nominal value, by more than rounding."""
    flat = _flat(array, change)
    rate = np.abs(np.imag(flat[..., change.rows])) / step
    return np.asarray(np.any(rate > NOUGHT * np.max(np.abs(np.real(flat)), axis=-1, keepdims=True), axis=-1))


def _stepped_features(family_: Family, values: Array, wanted: Mapping[int, set[Key]]) -> Iterator[tuple[tuple[int, ...], dict[Key, Array]]]:
    """By group of numbers stepped together features that are wanted, some at a time; with the first group those that are wanted of none."""
    mechanism = describe(family_, values)
    groups = [group for group in family_.together if not wanted.keys().isdisjoint(group)]
    asked = [set().union(*(wanted.get(number, ()) for number in group)) for group in groups]
    if not groups:
        yield (), features(mechanism, family_.standpoint)
        return
    asked[0] |= {place.key for place in family_.topology.features}.difference(*asked)
    stepped = [step_numbers(family_, mechanism, values, group) for group in groups]
    keys = [lambda kind, owner, own=own: (kind, owner) in own for own in asked]
    yield from ((groups[place], arrays) for place, arrays in stepped_features(stepped, family_.standpoint, keys))


def _flat(array: Array, change: Change) -> Array:
    """A feature's numbers along one axis."""
    return array.reshape(*array.shape[: array.ndim - len(change.place.shape)], -1)


def step_numbers(family_: Family, mechanism: Mechanism, values: Array, group: tuple[int, ...]) -> Mechanism:
    """The description of the same designs with a complex step in every number of a group.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> found, value = family(double_triangle(), ("parts.neck.thickness",)), np.array([[1e-3]])
    >>> step_numbers(found, found.mechanism, value, (0,)).parts["neck"].thickness
    array([0.001+1.54e-23j])
    """
    steps = {number: values[:, number] + 1j * width(family_, number) for number in group}
    if family_.draw is not None:
        return family_.draw(tuple({**dict(enumerate(values.T)), **steps}.values()))
    return _set(family_, mechanism, steps)


def width(family_: Family, number: int) -> float:
    """Width of the complex step of a number: small beside its nominal value.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> width(family(double_triangle(), ("materials.steel.young",)), 0) < 1e-8
    True
    """
    return float(abs(family_.nominal[number])) * _STEP or _STEP
