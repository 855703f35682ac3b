"""Highest von Mises stress at every link and body of a stage modelled as solids, with safety factors."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from flexstage.base.notebook import InNotebook
from flexstage.base.number import Array
from flexstage.base.record import INNER, Along, Heading
from flexstage.base.units.quantity import PRESSURE, RATIO
from flexstage.mechanism.assembly.expand import Assembly, expand
from flexstage.parts.piezo import Piezo
from flexstage.solid.fea.solver.assemble import Placed
from flexstage.solid.fea.solver.surface import element_coordinates, piece_vertices, stresses, von_mises
from flexstage.solid.results.read import SolidRead

SHARP_CORNERS = "At sharp inner corners the true stress is infinite: the computed stress grows with the resolution."
SILENT = 1e3
"""Stress [Pa] below which the stress counts as zero."""


@dataclass(frozen=True, eq=False)
class LinkStress(InNotebook):
    """Highest von Mises stress (L,) [Pa] on the surface of links and bodies, except stacks, over some load cases.

    `case` (L,) is the number of the load case with the highest stress. `yield_stress` (L,) [Pa] is the lowest of yield stress, fatigue
    limit and allowable stress (NaN: unknown); for a body, it is the lowest value of its solids. At sharp inner corners the true stress is
    infinite, and the computed stress grows with the resolution.
    """

    names: tuple[str, ...]
    highest: Annotated[Array, PRESSURE, Along("names"), Heading("highest stress", digits=4)]
    case: Array
    yield_stress: Annotated[Array, PRESSURE, Along("names"), Heading("yield", digits=5)]

    @property
    def safety(self) -> Annotated[Array, RATIO, Along("names"), Heading(digits=4)]:
        """Safety factor (L,): yield stress divided by highest stress."""
        return self.yield_stress / self.highest

    @property
    def weakest(self) -> str:
        """Name of the link or body with the smallest safety factor, or with the highest stress if no yield stress is known."""
        return self.names[self._weakest]

    @property
    def worst_case(self) -> int:
        """Load case with the highest stress of the weakest link or body."""
        return int(self.case[self._weakest])

    @property
    def _weakest(self) -> int:
        safety = self.safety
        return int(np.argmax(self.highest) if np.isnan(safety).all() else np.nanargmin(safety))

    @property
    def peak(self) -> Annotated[float, INNER, PRESSURE, Heading("stress", digits=4)]:
        """Highest stress of the weakest link or body [Pa]; zero below 1 kPa."""
        found = float(self.highest[self._weakest])
        return found if found >= SILENT else 0.0

    @property
    def least_safety(self) -> Annotated[float, INNER, RATIO, Heading("safety", digits=4)]:
        """Safety factor of the weakest link or body; NaN without stress."""
        return float(self.safety[self._weakest]) if self.peak else np.nan

    def largest(self, count: int) -> LinkStress:
        """Select the links and bodies with the highest stress, highest first, at most `count`."""
        order = np.argsort(-self.highest, kind="stable")[:count]
        return LinkStress(tuple(self.names[index] for index in order), self.highest[order], self.case[order], self.yield_stress[order])

    def at(self, name: str) -> float:
        """Return the highest stress of one link or body [Pa]."""
        return float(self.highest[self.names.index(name)])


def link_stress(read: SolidRead, motion: Array, strokes: Mapping[str, Array]) -> LinkStress | None:
    """Compute the highest stress of links and bodies over k load cases; `None` if only stacks have a shape.

    `motion` (N, k) are the model's coordinates in the load cases; `strokes` maps each input to its strokes (k,) [m] in these cases.
    """
    assembly = expand(read.mechanism)
    by_link = {assembly.actuators[name]: values for name, values in strokes.items()}
    found = [row for item in read.placed for row in _component(item, element_coordinates(item, motion, by_link), assembly)]
    if not found:
        return None
    names, highest, case = zip(*found, strict=True)
    limits = [_yield(read, assembly, name) for name in names]
    return LinkStress(tuple(names), np.array(highest), np.array(case), np.array(limits))


def _component(item: Placed, coordinates: Array, assembly: Assembly) -> Iterator[tuple[str, float, int]]:
    chosen = [(name, at) for name, at in piece_vertices(item) if name not in assembly.links or not _is_stack(assembly, name)]
    if chosen:
        worst = np.array([von_mises(stresses(item, coordinates[:, [case]])[:, :, 0]) for case in range(coordinates.shape[1])])
        for name, at in chosen:
            highest = worst[:, at].max(axis=1)
            yield name, float(highest.max()), int(np.argmax(highest))


def _is_stack(assembly: Assembly, name: str) -> bool:
    return isinstance(assembly.links[name].part, Piezo)


def _yield(read: SolidRead, assembly: Assembly, name: str) -> float:
    """The limit of a link, or the lowest one of a body's solids."""
    link, known = assembly.links.get(name), read.mechanism.materials
    materials = [known[each.solid.material] for each in assembly.bodies[name].solids.values()] if link is None else [link.material]
    return float(np.min([np.nan if each is None or each.limit is None else float(np.real(each.limit)) for each in materials]))
