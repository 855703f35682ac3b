"""Thermal expansion coefficients of bodies and parts of a stage."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from flexstage.base.finding import Finding, refuse, require, suggest_nearest
from flexstage.base.number import Number
from flexstage.base.storage.digest import digest
from flexstage.mechanism.assembly.expand import Assembly, PlacedLink, expand
from flexstage.mechanism.drawn import as_drawn
from flexstage.mechanism.mechanism import GROUND, NOT_GROWING, Mechanism
from flexstage.parts.mass import solid_properties
from flexstage.parts.part import counter_of, inner, material_of, span
from flexstage.parts.profile import single
from flexstage.parts.shape import Shaped

_STATED, _ASKED = "as specified", "as requested"


@dataclass(frozen=True)
class Ground:
    """Material of the ground for thermal expansion (`None`: no expansion), and where it is specified."""

    material: str | None
    source: str

    @property
    def stated(self) -> bool:
        """Whether the material is specified in the description or the call."""
        return self.source in (_STATED, _ASKED)


@dataclass(frozen=True, eq=False)
class Expansion:
    """Expansion coefficients [1/K] of the `bodies`, including the ground, and of the `parts` that have a length.

    `taken` is the assumed material of each body, and the source of this assumption (solids or links). `ground` is the material of the
    ground.
    """

    bodies: Mapping[str, Number]
    parts: Mapping[str, tuple[Number, Number]]
    taken: Mapping[str, str]
    ground: Ground


def expansion(mechanism: Mechanism, ground: str | None = None) -> Expansion:
    """Compute all expansion coefficients; `ground` names the ground's material (default: `ground_of`; `none`: no expansion).

    A body has the material of its heaviest solid; a body without solids has the common material of its links. Compliance matrices expand
    like the drawn parts that they replace. Expansion is neglected for compliance matrices that replace no part, ideal joints, springs,
    shear piezos and amplified actuators. Raises `DesignError` with a list of all materials and stacks without a coefficient and all bodies
    of unknown material.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> result = expansion(double_triangle(), ground="steel")
    >>> result.bodies["platform"], result.taken["platform"]
    (1.03e-05, 'steel, of its solids')
    """
    assembly = expand(mechanism)
    advice = "Compute it in the finite-element program that exported the matrices"
    require(Finding(name, "thermal expansion of the superelement unknown", advice) for name in assembly.superelements)
    choices = {name: _body_material(mechanism, assembly, name) for name in assembly.bodies}
    floor = ground_of(mechanism, ground)
    if floor.material is not None:
        choices[GROUND] = (floor.material, floor.source)
    require([*_unknown(mechanism, choices), *_unstated_findings(mechanism, assembly, choices)])
    bodies = {name: _or_nan(mechanism.materials[material].expansion) for name, (material, _) in choices.items()}
    drawn = {name: as_drawn(mechanism, link) for name, link in assembly.links.items()}
    parts = {name: (coefficient(link), span(link.part)) for name, link in drawn.items() if _grows(link)}
    taken = {name: f"{material}, {source}" for name, (material, source) in choices.items()}
    return Expansion({GROUND: 0.0, **bodies}, parts, {GROUND: f"no expansion, {floor.source}", **taken}, floor)


def _or_nan(value: Number | None) -> Number:
    return np.nan if value is None else value


def ground_of(mechanism: Mechanism, asked: str | None = None) -> Ground:
    """Return the ground's material: `asked` (`none`: no expansion), else as in the description, else the material of parts on the ground.

    The parts on the ground are the outlines of the ground or, without outlines, the links on the ground; they must all have the same
    material. Raises `DesignError` if their materials differ, or if they have no material.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> ground_of(double_triangle())
    Ground(material='steel', source='material of all links on it')
    """
    given = asked if asked is not None else mechanism.ground
    if asked is not None and asked not in (NOT_GROWING, *mechanism.materials):
        raise refuse("ground", f"unknown material {asked}", suggest_nearest(asked, (NOT_GROWING, *mechanism.materials)))
    if given is not None:
        return Ground(None if given == NOT_GROWING else given, _STATED if asked is None else _ASKED)
    assembly = expand(mechanism)
    solids = _distinct(mechanism, (placed.solid.material for placed in assembly.ground.values()))
    links = _link_materials(mechanism, assembly, GROUND)
    if len(solids) == 1:
        return Ground(solids[0], "material of all its outlines")
    if not solids and len(links) == 1:
        return Ground(links[0], "material of all links on it")
    result = f"its outlines are of {', '.join(solids)}" if solids else f"the links on it are of {', '.join(links) or 'no material'}"
    example = (*solids, *links, *mechanism.materials, "steel")[0]
    advice = f'Specify the material in the design: ground = "{example}"; "{NOT_GROWING}" means no expansion'
    raise refuse("ground", f"thermal expansion unknown: {result}", advice)


def coefficient(link: PlacedLink) -> Number:
    """Return the expansion coefficient of a link's part [1/K]; NaN if unspecified.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> coefficient(expand(double_triangle()).links["B1/pzt"])
    -3e-06
    """
    return _or_nan(getattr(inner(link.part) if link.material is None else link.material, "expansion", None))


def _grows(link: PlacedLink) -> bool:
    return isinstance(inner(link.part), Shaped)


def _body_material(mechanism: Mechanism, assembly: Assembly, name: str) -> tuple[str, str]:
    """Material of a body and its source; an empty name if unknown."""
    solids = {address.removeprefix(f"{name}."): placed.solid for address, placed in assembly.bodies[name].solids.items()}
    if len(_distinct(mechanism, (solid.material for solid in solids.values()))) == 1:
        return next(iter(solids.values())).material, "of its solids"
    if solids:
        weights = {key: single(solid_properties(each, mechanism.materials[each.material].density).mass) for key, each in solids.items()}
        heaviest = max(weights, key=weights.__getitem__)
        return solids[heaviest].material, f"of its heaviest solid, {heaviest}"
    result = _link_materials(mechanism, assembly, name)
    if len(result) == 1:
        return result[0], "of its links"
    return "", f"no solids, and its links are of {', '.join(result) or 'no material'}"


def _link_materials(mechanism: Mechanism, assembly: Assembly, body: str) -> list[str]:
    parts = [as_drawn(mechanism, link).part for link in assembly.links.values() if body in link.joins]
    return _distinct(mechanism, (name for part in parts if (name := material_of(part)) is not None and counter_of(part) is None))


def _distinct(mechanism: Mechanism, names: Iterable[str]) -> list[str]:
    """Distinct materials by name; equal ones (of mounted stages) once."""
    known = {digest(mechanism.materials.get(name, name), physics=True): name for name in sorted(set(names), reverse=True)}
    return sorted(known.values())


def _unknown(mechanism: Mechanism, choices: Mapping[str, tuple[str, str]]) -> list[Finding]:
    findings: list[Finding] = []
    for name, (material, source) in choices.items():
        if not material:
            findings.append(Finding(name, f"thermal expansion unknown: {source}", "Add a solid of its material to the body"))
        elif material not in mechanism.materials:
            findings.append(Finding(name, f"unknown material {material}", suggest_nearest(material, mechanism.materials)))
    return findings


def _unstated_findings(mechanism: Mechanism, assembly: Assembly, choices: Mapping[str, tuple[str, str]]) -> list[Finding]:
    used = {material for material, _ in choices.values()}
    used |= {name for name in (material_of(as_drawn(mechanism, link).part) for link in assembly.links.values()) if name is not None}
    materials = [name for name in sorted(used) if name in mechanism.materials and mechanism.materials[name].expansion is None]
    stacks = [
        link.link.part for link in assembly.links.values() if _grows(link) and link.material is None and np.isnan(coefficient(link)).any()
    ]
    missing = {f"materials.{name}": "10.3e-6 1/K" for name in materials} | {f"parts.{name}": "-3e-6 1/K" for name in stacks}
    what = "thermal expansion coefficient missing, required for drift"
    return [Finding(where, what, f'Add e.g. expansion = "{example}"') for where, example in missing.items()]
