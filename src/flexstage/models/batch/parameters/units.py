"""What units tell of derivatives: a part's stiffness and mass grow with its numbers by the powers of their own units.

Formulas know no kilogram, metre or second. Written in other units, the numbers p of a part grow by powers u(p), its feature F by u(F), so
(Euler's theorem of homogeneous functions)

    sum of u(p) p dF/dp = u(F) F        for kilogram, metre and second, u the powers of that unit.

Of the derivatives by thickness, length, width, modulus and density three follow from the others, exactly. A number that does not vary takes
part, too: only combinations of the three sums that leave it out tell something. What a feature depends on is told by steps: it comes out
complex.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from fractions import Fraction
from functools import cache
from typing import Any, get_type_hints

import numpy as np

from flexstage.base.number import Array
from flexstage.base.storage.digest import Description
from flexstage.base.units.dimension import dimension_of
from flexstage.base.units.quantity import Quantity
from flexstage.beams.mass import law_and_mass
from flexstage.mechanism.assembly.expand import PlacedLink

_STEP = 1e-20
_UNITS = ("[mass]", "[length]", "[time]")

Path = tuple[str, ...]
"""Where a number of a link's part or material stands."""


@dataclass(frozen=True)
class Told:
    """p dF/dp of a variable: `growth`, factors of the powers of F's units, times F, less `rest`, factors of p dF/dp of other variables."""

    variable: int
    growth: tuple[float, ...]
    rest: tuple[tuple[int, float], ...]

    def powers(self, kind: str, rows: Array) -> Array:
        """What F is multiplied by, for some `rows` of the numbers of a stiffness or mass."""
        size = {"stiffness": 6, "mass": 12}[kind]
        lengths = (rows // size % 6 >= 3).astype(float) + (rows % size % 6 >= 3)
        times = -2.0 if kind == "stiffness" else 0.0
        return self.growth[0] + self.growth[1] * lengths + self.growth[2] * times


def stepped_paths(link: PlacedLink, value: complex) -> list[Path]:
    """Where numbers of a link's part and material are complex; none unless they are this `value`.

    >>> from flexstage.parts.rod import Rod
    >>> rod = Rod("steel", length=1.0 + 1e-20j, diameter=0.1)
    >>> [path for path, _, found in _numbers(rod) if np.iscomplexobj(found)]
    [('length',)]
    """
    found = {path: number for path, _, number in _of_link(link) if np.iscomplexobj(number)}
    return list(found) if all(number == value for number in found.values()) else []


def told_by_units(link: PlacedLink, moved: Mapping[Path, int], order: Sequence[int]) -> dict[str, tuple[Told, ...]]:
    """What is told of stiffness and mass of a link's part, numbers at paths being variables; variables that come first in `order` first.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.mechanism.assembly.expand import expand
    >>> link = expand(double_triangle()).links["B1/front"]
    >>> moved = {("material", "young"): 0, ("material", "density"): 1, ("part", "thickness"): 2}
    >>> [(found.variable, found.growth, found.rest) for found in told_by_units(link, moved, (0, 1, 2))["mass"]]
    [(0, (0.0, 0.0, -0.5), ()), (1, (1.0, 0.0, 0.5), ())]
    """
    felt: dict[str, list[tuple[Path, Any]]] = {"stiffness": [], "mass": []}
    for path, powers, number in _of_link(link):
        if isinstance(number, float) and (number != 0.0 or path in moved):
            law, mass = law_and_mass(*_with_step(link, path, complex(number, abs(number) * _STEP or _STEP)))
            for kind, array in (("stiffness", law.stiffness), ("mass", mass)):
                if np.iscomplexobj(array):
                    felt[kind].append((path, powers))
    return {kind: tuple(_told(numbers, moved, order)) for kind, numbers in felt.items()}


def _told(felt: list[tuple[Path, Any]], moved: Mapping[Path, int], order: Sequence[int]) -> Iterator[Told]:
    if any(powers is None for _, powers in felt):
        return
    fixed = [powers for path, powers in felt if path not in moved]
    own = sorted(((moved[path], powers) for path, powers in felt if path in moved), key=lambda each: order.index(each[0]))
    table = [[powers[unit] for powers in (*fixed, *(each for _, each in own))] for unit in range(len(_UNITS))]
    for row in _reduced([line + [Fraction(unit == each) for each in range(len(_UNITS))] for unit, line in enumerate(table)]):
        left, growth = row[len(fixed) : len(fixed) + len(own)], row[len(fixed) + len(own) :]
        if not any(row[: len(fixed)]) and any(left):
            (first, _), *others = [(variable, factor) for (variable, _), factor in zip(own, left, strict=True) if factor]
            yield Told(first, tuple(map(float, growth)), tuple((variable, float(factor)) for variable, factor in others))


def _reduced(rows: list[list[Fraction]]) -> list[list[Fraction]]:
    """The rows in reduced echelon form, but for the last columns, as many as there are rows."""
    done = 0
    for column in range(len(rows[0]) - len(rows)):
        pivot = next((number for number in range(done, len(rows)) if rows[number][column]), None)
        if pivot is None:
            continue
        rows[done], rows[pivot] = rows[pivot], rows[done]
        rows[done] = [each / rows[done][column] for each in rows[done]]
        for number in set(range(len(rows))) - {done}:
            factor = rows[number][column]
            rows[number] = [each - factor * other for each, other in zip(rows[number], rows[done], strict=True)]
        done += 1
    return rows


def _of_link(link: PlacedLink) -> Iterator[tuple[Path, Any, Any]]:
    for name, own in (("part", link.part), ("material", link.material)):
        if own is not None:
            yield from (((name, *path), powers, number) for path, powers, number in _numbers(own))


def _with_step(link: PlacedLink, path: Path, value: complex) -> tuple[Any, Any]:
    """Part and material with another number at a path."""
    own = _replaced(getattr(link, path[0]), path[1:], value)
    return (own, link.material) if path[0] == "part" else (link.part, own)


def _replaced(value: Any, path: Path, number: complex) -> Any:
    if not path:
        return number
    if isinstance(value, tuple):
        place = int(path[0])
        return (*value[:place], _replaced(value[place], path[1:], number), *value[place + 1 :])
    return replace(value, **{path[0]: _replaced(getattr(value, path[0]), path[1:], number)})


def _numbers(value: Any, powers: Any = None) -> Iterator[tuple[Path, Any, Any]]:
    """Paths, powers of units (`None` where its quantity does not tell) and values of all numbers of a description."""
    if isinstance(value, Description):
        parts = [(name, getattr(value, name), own) for name, own in _quantities(type(value)).items()]
    elif isinstance(value, tuple):
        parts = [(str(place), each, powers) for place, each in enumerate(value)]
    else:
        if isinstance(value, (float, complex)):
            yield (), powers, value
        return
    for name, item, own in parts:
        yield from (((name, *path), known, number) for path, known, number in _numbers(item, own))


@cache
def _quantities(cls: type) -> dict[str, tuple[Fraction, ...] | None]:
    """The fields of a description, with the powers of the units of their quantities."""
    hints = get_type_hints(cls, include_extras=True)
    return {field.name: _powers(_quantity(hints[field.name])) for field in fields(cls)}  # type: ignore[arg-type]


def _quantity(hint: Any) -> Quantity | None:
    own = (item for item in getattr(hint, "__metadata__", ()) if isinstance(item, Quantity))
    inner = (found for item in getattr(hint, "__args__", ()) if (found := _quantity(item)) is not None)
    return next(own, None) or next(inner, None)


def _powers(quantity: Quantity | None) -> tuple[Fraction, ...] | None:
    if quantity is None or quantity.si == "mixed":
        return None
    powers = dict(dimension_of(quantity.si).powers)
    return tuple(powers.get(unit, Fraction(0)) for unit in _UNITS)
