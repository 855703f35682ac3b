"""Report sections of the solid model: hinges, units and stage by finite elements, comparison with theory, pictures of deformed solids."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import TYPE_CHECKING

from flexstage.analysis.complete import platform_modes
from flexstage.analysis.dynamics.pairing import Moving, Pair, pair_modes
from flexstage.analysis.trust import TheoryCheck
from flexstage.mechanism.mechanism import Mechanism
from flexstage.models.lumped import lumped
from flexstage.show.display import number
from flexstage.show.figures.directional import directional_figure
from flexstage.show.figures.export import to_svg
from flexstage.show.page import Block, BlockRow, Folded, Headline, Picture, Prose, Section, section
from flexstage.show.sections.stage import joined_viewers
from flexstage.show.tables.modes import mode_table
from flexstage.show.tables.statics import centre_table, direction_table, principal_table, stiffness_table
from flexstage.show.viewer.data import still_data
from flexstage.show.viewer.motions import Group, Motion, Skeleton, body_twists
from flexstage.solid.results.stage import worst_strokes
from flexstage.solid.results.surface import Surface, mode_surfaces, stress_surfaces
from flexstage.solid.show.skin_figures import skin_figure
from flexstage.solid.show.tables import (
    block_table,
    command_table,
    hinge_matrices,
    hinge_table,
    solid_unit_table,
    stress_table,
    verdict_table_of,
    verification_table,
)

if TYPE_CHECKING:
    from flexstage.solid.results.hinges import SolidHinge
    from flexstage.solid.results.resolution import Converged
    from flexstage.solid.results.stage import SolidStage
    from flexstage.solid.results.units import SolidUnit
    from flexstage.solid.results.verification import Verification

_STRESS_EXPONENT = 0.4


def hinge_section(found: Mapping[str, SolidHinge]) -> Section | None:
    """Make the section of hinges: the 6x6 compliance matrix of every distinct hinge; `None` without hinges.

    >>> hinge_section({}) is None
    True
    """
    if not found:
        return None
    matrices = tuple(hinge_matrices(found))
    return section("Hinges", [hinge_table(found), Folded("Full compliance matrices (6x6)", matrices)])


def unit_section(found: Converged[dict[str, SolidUnit]]) -> Section | None:
    """Make the section of isolated units, with their stress at the full stroke."""
    blocks: list[Block | None] = [solid_unit_table(found)]
    for name, unit in found.result.items():
        stroke = float(unit.strokes[-1])
        caption = f"Von Mises stress of the {name} unit at full stroke, with its output guided. Displacements are magnified."
        picture = _stress_picture(stress_surfaces(unit.read, unit.motion, {unit.copy: stroke}), f"unit-{name}", caption)
        table, stress = command_table(name, unit), stress_table(f"Stress in the {name} unit at full stroke", unit.stress)
        blocks.append(table if stress is None else BlockRow((picture, table, stress)))
    return section("Isolated units", blocks)


def _stress_picture(surfaces: Iterable[Surface], name: str, caption: str) -> Picture:
    shown = [replace(each, values=1e-6 * each.values) for each in surfaces]
    return Picture(to_svg(skin_figure(shown, "MPa", exponent=_STRESS_EXPONENT), name, caption), caption)


def stage_solid_section(found: Converged[SolidStage]) -> Section | None:
    """Make the section of the whole stage: stiffness, modes and stress."""
    from flexstage.solid.results.resolution import NOT_ESTIMATED  # takes long to import

    stage = found.result
    worst = max(found.errors, key=lambda name: found.errors[name], default=None)
    error = "unknown without a coarser result" if worst is None else f"{100.0 * found.errors[worst]:.2g} % ({worst})"
    if found.unestimated:
        error += f". For {', '.join(found.unestimated)}, {NOT_ESTIMATED}"
    text = (
        f"Finite elements of order {found.order}: {stage.read.elements} elements and {stage.read.freedoms} unknowns in the distinct "
        f"components, {len(stage.read.model.coordinates)} coordinates after reduction. Largest estimated error, from a coarser "
        f"resolution: {error}."
    )
    polar = to_svg(directional_figure(stage.statics), "solid-polar", "Stiffness by direction in the plane")
    table = stress_table("Highest stress", stage.stress)
    stress = [] if table is None else [BlockRow((_worst_stress(stage), table))]
    return section(
        "The whole stage",
        [
            Prose(text),
            stiffness_table(stage.statics),
            principal_table(stage.statics),
            Picture(polar, "Stiffness in the plane by direction of the force."),
            Folded("Stiffness by angle, centre of stiffness", (direction_table(stage.statics), centre_table(stage.statics))),
            mode_table(stage.modes),
            BlockRow(tuple(_mode_pictures(stage)), narrow=True),
            block_table(stage),
            *stress,
        ],
    )


def _mode_pictures(stage: SolidStage) -> Iterator[Picture]:
    for index in stage.modes.platform:
        figure = skin_figure(mode_surfaces(stage.read, stage.modes.shapes[:, index]), "")
        caption = f"{stage.modes.names[index]}, {stage.modes.frequencies[index]:.1f} Hz: displacement divided by the largest."
        yield Picture(to_svg(figure, f"solid{index}", caption), caption)


def _worst_stress(stage: SolidStage) -> Picture:
    assert stage.worst is not None  # noqa: S101  every stress has a worst corner
    caption = "Von Mises stress with permanent load, at the strokes with the highest stress of the weakest link; magnified displacements."
    return _stress_picture(stress_surfaces(stage.read, stage.worst, worst_strokes(stage)), "stress", caption)


def verification_headline(found: Verification) -> Headline:
    """Make the headline of a verification; it is `good` if theory suffices for all quantities of the last group (the stage)."""
    rows = list(found.groups.values())[-1]
    return Headline(found.headline, all(row.trust in {TheoryCheck.EITHER, TheoryCheck.THEORY} for row in rows))


def solid_motions(mechanism: Mechanism, stage: SolidStage, theory: Mapping[int, Pair] = MappingProxyType({})) -> tuple[Motion, ...]:
    """Convert the platform modes by FEA to motions for a viewer; remarks describe the paired modes by theory (`theory`)."""
    return fea_motions(still_data(mechanism).bones, Moving(stage.modes, stage.read.model), theory)


def fea_motions(bones: Skeleton, moving: Moving, theory: Mapping[int, Pair] = MappingProxyType({})) -> tuple[Motion, ...]:
    """Convert the platform modes of any finite-element model to motions for a viewer with the bodies `bones` (see `solid_motions`)."""
    found: list[Motion] = []
    for index in moving.modes.platform:
        twists = body_twists(moving.model, None, moving.modes.shapes[:, index], tuple(bones.references))
        frequency = float(moving.modes.frequencies[index])
        pair = theory.get(index)
        theory_text = "" if pair is None else f"; theory {number(pair.frequency)} Hz, modal assurance {pair.assurance:.3f}"
        label = f"FEA {index + 1}  {number(frequency)} Hz  {moving.modes.names[index]}"
        found.append(Motion(Group.MODE, f"fea {index + 1}", label, bones.at_origin(twists), f"by finite elements{theory_text}", frequency))
    return tuple(found)


def paired_with_theory(mechanism: Mechanism, stage: SolidStage) -> tuple[Mapping[int, Pair], Section | None]:
    """Pair modes by theory with modes by finite elements; return the pairs by index, and a section that shows paired modes side by side."""
    model = lumped(mechanism)
    pairs = pair_modes(Moving(stage.modes, stage.read.model), Moving(platform_modes(mechanism, model), model))
    alike = {index: pairs[index] for index in stage.modes.platform if index in pairs and pairs[index].reliable}
    partners = [(f"mode {pair.index + 1}", f"mode fea {index + 1}") for index, pair in alike.items()]
    text = "The selected mode is shown next to its paired mode: theory left, finite elements right. Bodies are rigid; signs are arbitrary."
    joined = joined_viewers(partners)
    return pairs, None if joined is None else section("Modes side by side", [joined, Prose(text)])


def verification_section(found: Verification) -> Section | None:
    """Make the section that compares theory with finite elements and begins with the verdicts as text."""
    tables = [verification_table(rows) for rows in found.groups.values()]
    return section("Theory and finite elements", [verdict_table_of(found), *tables])
