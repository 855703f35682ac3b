"""Limits of small displacements of linear models: rotation of hinges, bending of leaves, motion of the platform.

Linear kinematics neglect the terms theta^2/2 of a lever's rotation theta, and (u/L)^2/2 of the deflection u of a leaf of length L.
The limit is an error of 1 % (0.141 rad) or, if smaller, the angle at which the faces of a notch touch.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np

from flexstage.analysis.workspace.stroke import SingleAxis
from flexstage.base.finding import Finding
from flexstage.base.number import Array, Number, first_design
from flexstage.base.units.quantity import LENGTH, RATIO
from flexstage.base.units.unit import show
from flexstage.mechanism.assembly.expand import PlacedLink, expand
from flexstage.mechanism.mechanism import PLATFORM, Mechanism
from flexstage.models.linear.kinematics import Kinematics
from flexstage.parts.part import Part, inner
from flexstage.parts.profile import single
from flexstage.parts.shape import Shaped

ERROR = 0.01
"""Accepted relative error of linear models due to terms of second order."""
_ATOM = 1e-10
"""Smallest reported shortening [m]."""


@dataclass(frozen=True)
class SecondOrder:
    """Second-order error of linear kinematics over a box of motions: the largest relative `error`, which occurs in the part `link`.

    `shortening` is the foreshortening [m] of the bent leaf or rod `shortened` (empty if there is none). It displaces a guide sideways.
    `held_twice` is true if the stage has redundant constraints, which may also stretch flexures.
    """

    error: Annotated[float, RATIO]
    link: str
    why: str
    held_twice: bool = False
    shortening: Annotated[float, LENGTH] = 0.0
    shortened: str = ""

    @property
    def text(self) -> str:
        """Sentence on the error of linear kinematics. Changes of stiffness and frequencies may be larger than this error.

        >>> SecondOrder(0.0002, "left", "bends by 0.02 of its length").text.partition(". ")[0]
        'Over the strokes the error of linear kinematics is up to 0.02 % (left bends by 0.02 of its length)'
        """
        cause = ", as redundant constraints stretch flexures" if self.held_twice else ""
        aside = (
            f", not including the foreshortening of {self.shortened} by {show(self.shortening, LENGTH, digits=2)}"
            if self.shortening > _ATOM
            else ""
        )
        what = f"Over the strokes the error of linear kinematics is up to {100.0 * self.error:.2g} %"
        more = f"Stiffness and frequencies may change by more{cause}: see flexstage stroke"
        return f"{what} ({self.link} {self.why}){aside}. {more}."


@dataclass(frozen=True, eq=False)
class SmallMotion:
    """Rotation `turn` [rad] and `bend` (deflection divided by length) of every link and the platform, for unit coordinates (L, f).

    `limit` (L) is the largest permitted rotation [rad]. At this rotation, notch faces touch if `closes` is true; otherwise, the
    second-order error reaches its limit. `span` (L) [m] is the bending length of a part, zero if the part bends at a point.
    """

    coordinates: tuple[str, ...]
    names: tuple[str, ...]
    turn: Array
    bend: Array
    limit: Array
    closes: tuple[bool, ...]
    span: Array

    def _moved(self, command: Mapping[str, Number]) -> tuple[Array, Array]:
        """Rotation [rad] and bend (L) of every link over a box of commands (half widths)."""
        half = np.array([float(np.max(np.abs(command.get(name, 0.0)))) for name in self.coordinates])
        return self.turn @ half, self.bend @ half

    def use(self, command: Mapping[str, Number]) -> tuple[float, str]:
        """Return the largest ratio of rotation or bend to its limit, and the link's name, for a box of displacements (half widths)."""
        turned, bent = self._moved(command)
        shares = np.maximum(turned / self.limit, bent / _SMALL)
        worst = int(np.argmax(shares > (1.0 - 1e-9) * np.max(shares)))
        return float(shares[worst]), self.names[worst]

    def second_order(self, command: Mapping[str, Number]) -> SecondOrder:
        """Return half the square of the largest rotation or bend in a box of displacements (half widths).

        The foreshortening of a leaf or rod of length L is 3 u^2 / (5 L) + L theta^2 / 24. The rotation between the ends is theta. The
        deflection u is the displacement between the two ends, after each end is extended rigidly to the middle.
        """
        turned, bent = self._moved(command)
        worst = int(np.argmax(np.round(np.maximum(turned, bent), 12)))
        bends = bent[worst] > turned[worst]
        why = f"bends by {bent[worst]:.3g} of its length" if bends else f"turns by {1e3 * turned[worst]:.3g} mrad"
        shorter = self.span * (0.6 * bent**2 + turned**2 / 24.0)
        most = int(np.argmax(np.round(shorter, 15)))
        shortened = self.names[most] if shorter[most] > 0.0 else ""
        error = 0.5 * float(max(turned[worst], bent[worst])) ** 2
        return SecondOrder(error, self.names[worst], why, shortening=float(shorter[most]), shortened=shortened)

    def doubt(self, command: Mapping[str, Number]) -> str:
        """Return the reason why linear models are invalid for a box of displacements; empty if they are valid."""
        share, name = self.use(command)
        if share <= 1.0:
            return ""
        place = self.names.index(name)
        turned, bent = (float(each[place]) for each in self._moved(command))
        if turned / self.limit[place] < bent / _SMALL:
            return f"{name} bends by {bent:.3g} of its length; above {_SMALL:.3g}, the error of linear models exceeds {100.0 * ERROR:g} %"
        why = "its faces touch" if self.closes[place] else f"the error of linear models exceeds {100.0 * ERROR:g} %"
        return f"{name} turns by {1e3 * turned:.4g} mrad; above {1e3 * self.limit[place]:.4g} mrad, {why}"

    def warnings(self, single: SingleAxis) -> Iterator[Finding]:
        """Yield warnings for single-axis strokes beyond small motions, with the usable stroke."""
        for name, stroke in zip(single.coordinates, np.atleast_2d(single.symmetric)[0], strict=True):
            doubt = self.doubt({name: float(stroke)})
            if doubt:
                unit = "rad" if name.startswith("r") else "m"
                left = float(stroke) / self.use({name: float(stroke)})[0]
                what = f"at the full stroke of +-{float(stroke):.4g} {unit}, {doubt}"
                yield Finding(f"stroke.{name}", what, f"Use +-{left:.4g} {unit} at most")


_SMALL = float(np.sqrt(2.0 * ERROR))


def second_order(mechanism: Mechanism, kinematics: Kinematics, command: Mapping[str, Number] | None) -> SecondOrder | None:
    """Compute the second-order error over a box of motions; None if there is no box, or if no part rotates or bends.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.ideal import ideal
    >>> second_order(double_triangle(), ideal(double_triangle()), {"x": 50e-6}).link
    'B4/lower'
    """
    if not command or not kinematics.coordinates:
        return None
    result = small_motion(mechanism, kinematics).second_order(command)
    return replace(result, held_twice=bool(kinematics.redundant)) if result.error else None


def small_motion(mechanism: Mechanism, kinematics: Kinematics) -> SmallMotion:
    """Compute the small-motion limits of the ideal motions; for a batch, the limits of the first design.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.ideal import ideal
    >>> stage = double_triangle()
    >>> small_motion(stage, ideal(stage)).doubt({"x": 50e-6})
    ''
    """
    assembly = expand(mechanism)
    moved = {name: np.real(first_design(kinematics.strains[name], 2)) for name in assembly.links}
    turn = [np.linalg.norm(each[3:], axis=0) for each in moved.values()]
    spans = {name: _span(assembly.links[name]) for name in moved}
    bend = [np.linalg.norm(each[1:3], axis=0) / spans[name] for name, each in moved.items()]
    closing = [_closing(link.part) for link in assembly.links.values()]
    platform = np.real(first_design(kinematics.motion, 2))
    return SmallMotion(
        coordinates=kinematics.coordinates,
        names=(*assembly.links, PLATFORM),
        turn=np.stack([*turn, np.linalg.norm(platform[3:], axis=0)]),
        bend=np.stack([*bend, np.zeros(platform.shape[-1])]),
        limit=np.array([*(min(_SMALL, each) for each in closing), _SMALL]),
        closes=(*(each < _SMALL for each in closing), False),
        span=np.array([*(each if np.isfinite(each) else 0.0 for each in spans.values()), 0.0]),
    )


def _span(link: PlacedLink) -> float:
    """Bending length of a part; infinite for bending at a point."""
    part = inner(link.part)
    return single(part.span) if isinstance(part, Shaped) and part.slender else np.inf


def _closing(part: Part) -> float:
    own = inner(part)
    return own.closing if isinstance(own, Shaped) else np.inf
