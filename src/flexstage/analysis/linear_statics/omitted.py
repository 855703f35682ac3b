"""Model error of a simpler theory: the effect of each degree of freedom of a part that the theory locks or frees."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated

from flexstage.base.units.quantity import RATIO
from flexstage.mechanism.assembly.likeness import drawn_units
from flexstage.mechanism.mechanism import GROUND, PLATFORM, Mechanism
from flexstage.mechanism.restrict import Freedoms, restrict
from flexstage.models.linear.model import LinearModel
from flexstage.models.linear.static import static_gain
from flexstage.models.lumped import Masses, lumped, variants
from flexstage.parts.compliance_matrix import Joint
from flexstage.parts.freedom import ALL, Freedom

Restrictions = Mapping[str, tuple[Freedoms, Freedoms]]


@dataclass(frozen=True)
class Omitted:
    """Responses of a simple theory and the full theory, and the effect of each omitted degree of freedom.

    `changes` are the changes of the simple response if a single degree of freedom (`lever_notch.x`) becomes elastic. `interaction` is the
    effect of combinations: the full response, minus the simple response and all `changes`.
    """

    output: str
    input: str
    simple: float
    full: float
    changes: Mapping[str, float]

    @property
    def interaction(self) -> Annotated[float, RATIO]:
        """Full response minus simple response, minus the separate effects of all single degrees of freedom."""
        return self.full - self.simple - sum(self.changes.values())

    @property
    def unexplained(self) -> Annotated[float, RATIO]:
        """Magnitude of `interaction`, divided by the magnitude of the full response."""
        return abs(self.interaction / self.full)


def omitted(mechanism: Mechanism, simple: Restrictions, channel: tuple[str, str]) -> Omitted:
    """Compare the static response of an output to an input (names in `channel`) for restricted parts and for full parts.

    `simple` maps parts or links (`vertical/pivot`) to their elastic and their free degrees of freedom; all other degrees of freedom are
    locked. One at a time, each locked or freed degree of freedom is made elastic. Batches are not supported.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.cases.double_triangle import EQUATION_3
    >>> from flexstage.mechanism.restrict import isolate
    >>> unit = isolate(double_triangle(), "B4", guide=(0.0, 0.0, 1.0))
    >>> omitted(unit, EQUATION_3, ("platform.z", "B4")).unexplained < 1e-3
    True
    """
    parts = {name for unit in drawn_units(mechanism).values() for link in unit.links.values() for name in (link.part,)}
    known = {
        name: freedoms
        for name, freedoms in simple.items()
        if "/" in name or (name in parts and not isinstance(mechanism.parts[name], Joint))
    }
    simplified = restrict(mechanism, known)
    given = [(name, freedom) for name in known for freedom in ALL if freedom not in known[name][0]]
    kept = [{}, *({_part(simplified, name): _with(known[name], freedom)} for name, freedom in given)]
    base, *gains = (_gain(model, channel) for model in variants(simplified, kept, Masses.PLATFORM))
    changes = {f"{name}.{freedom.value}": gain - base for (name, freedom), gain in zip(given, gains, strict=True)}
    return Omitted(*channel, base, _gain(lumped(mechanism, Masses.PLATFORM), channel), changes)


def lever_theory(mechanism: Mechanism, name: str) -> Restrictions:
    """Return the restrictions of links that equation 3 of Shin & Moon assumes for a lever unit: axial springs and a rotating ground pivot.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> [freedom.value for freedom in lever_theory(double_triangle(), "vertical")["vertical/pivot"][0]]
    ['rz']
    """
    links = drawn_units(mechanism)[name].links
    joined = [body for link in links.values() for body in link.bodies]
    known: dict[str, tuple[Freedoms, Freedoms]] = {}
    for key, link in links.items():
        part = mechanism.parts[link.part]
        intended = link.free if link.free is not None else part.intended
        turns = GROUND in link.bodies and any(joined.count(body) > 2 for body in link.bodies if body not in (GROUND, PLATFORM))
        if not isinstance(part, Joint):
            known[f"{name}/{key}"] = (intended, ()) if turns else ((Freedom.X,), intended)
    return known


def _part(simplified: Mechanism, name: str) -> str:
    """Restricted part for a part's name or a link's address."""
    unit, _, link = name.rpartition("/")
    return drawn_units(simplified)[unit].links[link].part if "/" in name else name


def _with(kept: tuple[Freedoms, Freedoms], freedom: Freedom) -> tuple[Freedoms, Freedoms]:
    elastic, free = kept
    return (*elastic, freedom), tuple(item for item in free if item is not freedom)


def _gain(model: LinearModel, channel: tuple[str, str]) -> float:
    return float(static_gain(model, channel[:1], channel[1:]).values[0, 0])
