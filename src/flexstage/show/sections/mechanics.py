"""Report sections on kinematics, stiffness and lost motion."""

from __future__ import annotations

from flexstage.analysis.complete import Analysis
from flexstage.show.figures.budget import energy_figure, loss_figure
from flexstage.show.figures.directional import directional_figure
from flexstage.show.figures.export import to_svg
from flexstage.show.page import Block, BlockRow, Folded, Picture, Prose, Section, fold, section
from flexstage.show.table import matrix_table, optional, result_table
from flexstage.show.tables.deflection import deflection_table
from flexstage.show.tables.kinematics import (
    freedom_table,
    gauge_table,
    mapping_table,
    mobility_table,
    motion_table,
)
from flexstage.show.tables.lost_motion import (
    budget_table,
    correction_table,
    crosstalk_table,
    energy_table,
    gain_table,
    loss_table,
    parasitic_table,
)
from flexstage.show.tables.statics import (
    centre_table,
    compliance_table,
    direction_table,
    freedom_stiffness_table,
    mass_tables,
    principal_table,
    stiffness_table,
)
from flexstage.show.tables.units import omitted_table


def kinematics_section(analysis: Analysis) -> Section | None:
    """Make the section on kinematics: mobility, mappings, free internal modes and redundant constraints.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.analysis.complete import Model, analyse
    >>> kinematics_section(analyse(double_triangle(), Model.IDEAL)).title
    'Kinematics'
    """
    kinematics = analysis.kinematics
    maps: list[Block] = [gauge_table(kinematics)] if kinematics.gauges else []
    if kinematics.actuated:
        jacobian = matrix_table("Platform motion per stroke, J = V R_a^-1", kinematics.jacobian)
        maps = [mapping_table(kinematics), Folded("Platform motion per stroke; gauge mapping", (jacobian, *maps))]
    text = (
        "The ideal stage has rigid bodies, and hinges that are free about their intended axes and locked about all others. Mappings apply "
        "to small motions about the undeformed configuration, at the platform's reference point."
    )
    return section(
        "Kinematics",
        [
            Prose(text),
            mobility_table(kinematics),
            *maps,
            motion_table(kinematics),
            Folded("Free DOFs of the links in the ideal model", (freedom_table(kinematics),)),
            fold("Free internal modes and redundant constraints", result_table(kinematics.idle), result_table(kinematics.redundant)),
        ],
    )


def stiffness_section(analysis: Analysis) -> Section | None:
    """Make the section on the platform's stiffness and compliance, also by direction; `None` for the ideal model.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.analysis.complete import Model, analyse
    >>> stiffness_section(analyse(double_triangle(), Model.IDEAL)) is None
    True
    """
    statics = analysis.statics
    if statics is None:
        return None
    polar = to_svg(directional_figure(statics), "polar", "Stiffness by direction in the plane")
    sag = () if analysis.deflection is None else (deflection_table(analysis.deflection),)
    caption = "In-plane stiffness by direction, with other motions free, as in a push test, and with other motions fixed."
    return section(
        "Stiffness",
        [
            Prose("Stiffness of the platform at its reference point, with fixed actuators."),
            stiffness_table(statics),
            optional(freedom_stiffness_table, analysis.freedoms),
            principal_table(statics),
            BlockRow((Picture(polar, caption), BlockRow((centre_table(statics), *sag)))),
            result_table(analysis.units or {}),
            fold(
                "Compliance, in-plane stiffness against direction, mass, spring constants of the lever units",
                compliance_table(statics),
                direction_table(statics),
                *(() if analysis.mass is None else mass_tables(analysis.mass)),
                result_table({name: unit.lever for name, unit in (analysis.units or {}).items() if unit.lever is not None}),
            ),
        ],
    )


def lost_motion_section(analysis: Analysis) -> Section | None:
    """Make the section on lost motion: transmission ratios, loss of each part, corrected mapping; `None` without results.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.analysis.complete import Model, analyse
    >>> lost_motion_section(analyse(double_triangle(), Model.IDEAL)) is None
    True
    """
    lost = analysis.lost_motion
    if lost is None:
        return None
    text = (
        "Lost motion is the loss of ideal motion due to elasticity. By virtual work, the contribution of a link is its force "
        "times its deformation in the ideal motion. The contributions add up exactly to the loss."
    )
    loss = to_svg(loss_figure(lost), "loss", "Lost motion by actuator and part")
    energy = to_svg(energy_figure(lost), "energy", "Strain energy by actuator and part")
    pictures = [
        Picture(loss, "Lost motion of each actuator by part and axis of its unit."),
        Picture(energy, "Strain energy by part when one actuator expands and no other load acts."),
    ]
    return section(
        "Lost motion",
        [
            Prose(text),
            loss_table(lost),
            *(pictures if lost.budget else []),
            parasitic_table(lost),
            fold("Lost motion and energy by part", budget_table(lost), energy_table(lost)),
            Folded("Gains, crosstalk, corrected mapping", (gain_table(lost), crosstalk_table(lost), correction_table(lost))),
            *[
                fold(f"Terms in the transmission ratio of unit {name} that Eq. 3 of Shin & Moon omits", omitted_table(unit.omitted))
                for name, unit in (analysis.units or {}).items()
                if unit.omitted is not None
            ],
        ],
    )
