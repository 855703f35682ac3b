"""Report sections on sources: the description with its provenance, known limits, references."""

from __future__ import annotations

from flexstage.analysis.caveats import part_warnings
from flexstage.analysis.complete import Analysis, Model
from flexstage.beams.validity import validity
from flexstage.mechanism.mechanism import Mechanism, StructuralDamping
from flexstage.parts.neck import Neck
from flexstage.parts.notch import Notch
from flexstage.show.display import NO_VALUE, percent
from flexstage.show.page import Block, Folded, Prose, Section, fold, section
from flexstage.show.scene.primitives import first_value
from flexstage.show.table import PAGE_ROWS, Column, Table, text_table
from flexstage.show.tables.description import provenance_table, source_table, value_tables
from flexstage.spatial.frame import COMPONENTS

_LIMITS = {
    Model.IDEAL: (
        "Ideal model: rigid bodies, perfect hinges, and small motions about the undeformed configuration. No stiffness, loads or modes."
    ),
    Model.MAPPED: (
        "Mapped model of Shin & Moon: springs along the strokes under a rigid platform, massless units, no bending of hinges. It has "
        "no lost motion, no local modes and no crosstalk."
    ),
    Model.LUMPED: (
        "Lumped model: rigid bodies connected by hinges with 6x6 compliances from beam theory. It holds for small displacements, and for "
        "frequencies below the first resonance of each part. Real plates and levers are elastic, which makes the stage softer."
    ),
}
_PAPER = "Shin & Moon, Static and Dynamic Analyses of a 6-DOF Ultra-Precision Parallel Mechanism: mappings, unit stiffness, Eq. 28."
_NOTCH = (
    "J. M. Paros, L. Weisbord, How to design flexure hinges, Machine Design 37, 1965; Y. Wu, Z. Zhou, Review of Scientific Instruments 73, "
    "2002: circular notches."
)
_NECK = "S. T. Smith, Flexures, 2000: toroidal necks, notch factor."
_CENTRE = "J. Loncaric, Normal forms of stiffness and compliance matrices, IEEE J. Robotics and Automation 3, 1987: centre of stiffness."
_DAMPING = "E. E. Ungar, E. M. Kerwin, J. Acoustical Society of America 34, 1962: equivalent modal damping of loss factors."


def description_section(mechanism: Mechanism) -> Section | None:
    """Make the section of all values of the description with unit and source.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> description_section(double_triangle()).title
    'Description and provenance'
    """
    text = "Stated: printed in a source. Derived: computed from stated values. Assumed: chosen, or without a tag."
    values: tuple[Block, ...] = value_tables(mechanism, PAGE_ROWS)
    return section(
        "Description and provenance",
        [
            Prose(text),
            provenance_table(mechanism),
            source_table(mechanism),
            Folded("Every value", values),
            fold("Requirements as written", text_table("Requirements", ["requirement", "demand"], mechanism.requirements)),
        ],
    )


def limit_section(analysis: Analysis) -> Section | None:
    """Make the section on limits: simplifications of the model, and missing results with reasons.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.analysis.complete import Model, analyse
    >>> limit_section(analyse(double_triangle(), Model.IDEAL)).title
    'Limits'
    """
    blocks: list[Block | None] = [Prose(_LIMITS[analysis.model])]
    if not part_warnings(analysis.mechanism):
        blocks.append(Prose("All parts are inside the range in which beam theory was compared with 3-D elasticity."))
    blocks.append(_missing_table(analysis))
    accuracy = error_of_theory_table(analysis.mechanism) if analysis.model is not Model.IDEAL else None
    return section("Limits", [*blocks, accuracy])


def _missing_table(analysis: Analysis) -> Table | None:
    missing = dict(analysis.missing)
    if analysis.workspace is not None:
        missing |= {f"workspace: {name}": reason for name, reason in analysis.workspace.reasons.items()}
    return text_table("Missing results", ["result", "reason"], {name.replace("_", " "): reason for name, reason in missing.items()})


def error_of_theory_table(mechanism: Mechanism) -> Table | None:
    """Tabulate the expected error of beam theory in the compliance of each part, relative to 3-D elasticity; `None` if unknown.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> error_of_theory_table(double_triangle()).texts()[0]
    ['part', 'x', 'y', 'z', 'rx', 'ry', 'rz']
    """
    materials = mechanism.materials
    known = {name: validity(part, name, materials.get(getattr(part, "material", ""))).errors for name, part in mechanism.parts.items()}
    rows = {
        name: [percent(first_value(errors[axis]), 2) if axis in errors else NO_VALUE for axis in COMPONENTS]
        for name, errors in known.items()
        if errors
    }
    note = "Negative: beam theory is too stiff. Components without a number were not compared with 3-D elasticity."
    return text_table("Model error of beam theory in the compliance of the parts", ["part", *map(Column, COMPONENTS)], rows, notes=[note])


def reference_section(analysis: Analysis) -> Section | None:
    """Make the section of references for the equations.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.analysis.complete import Model, analyse
    >>> len(reference_section(analyse(double_triangle(), Model.IDEAL)).blocks)
    1
    """
    parts = analysis.mechanism.parts.values()
    elastic = analysis.model is not Model.IDEAL
    used = [_PAPER]
    used += [_NOTCH] if elastic and any(isinstance(part, Notch) for part in parts) else []
    used += [_NECK] if elastic and any(isinstance(part, Notch | Neck) for part in parts) else []
    used += [_CENTRE] if analysis.statics is not None else []
    used += [_DAMPING] if isinstance(analysis.mechanism.damping, StructuralDamping) else []
    return section("References", [Prose(text) for text in used])
