"""Report sections of tests: data, identified modes, responses, coherence, stabilisation, shapes on the stage, comparison with models."""

from __future__ import annotations

from collections.abc import Iterator

from flexstage.experiment.comparison import Compared
from flexstage.experiment.identification.identified import Identified
from flexstage.experiment.pipeline import Identification
from flexstage.experiment.shapes_on_stage import StageShapes
from flexstage.experiment.show.comparison_figures import compare_figure
from flexstage.experiment.show.figures import (
    LARGEST,
    coherence_figure,
    density_figure,
    estimator_figure,
    focus,
    response_matrix_figure,
    stabilisation_figure,
)
from flexstage.experiment.show.tables import (
    data_warning_table,
    identified_table,
    measured_shape_table,
    motion_explained_text,
    recorded_table,
)
from flexstage.show.display import number
from flexstage.show.figures.export import to_svg
from flexstage.show.figures.style import THIRD
from flexstage.show.page import Block, BlockRow, Picture, Prose, Section, fold, section
from flexstage.show.scene.pictures import mode_picture
from flexstage.show.sections.dynamics import SHAPES
from flexstage.show.sections.stage import joined_viewers, platform_modes
from flexstage.show.table import Table, result_table
from flexstage.show.viewer.data import StageData
from flexstage.show.viewer.motions import Group, Motion, Skeleton

_FLOOR = (
    "No input was recorded. Modes are stable poles of covariance-driven stochastic subspace identification, band by band. Intervals follow "
    "from the scatter between forty blocks, to first order. Shapes are divided by their largest component; their mass scaling is unknown."
)


def found_section(seen: Identification) -> Section | None:
    """Make the section of identified modes, and of the limits of the data."""
    text = (
        "Candidates are the stable poles of the poly-reference least-squares complex frequency-domain estimator, applied to the responses "
        "(H1 for records). Each group of close candidates is fitted by maximum likelihood to the transforms of whole records, or to the "
        "measured responses. Insignificant modes are omitted."
    )
    found = seen.found
    text = text if found.inputs else _FLOOR
    shapes = measured_shape_table(found) if len(found.frequencies) else None
    blocks = [
        recorded_table(seen.test),
        data_warning_table(found.data_warnings),
        identified_table(found),
        result_table(found.peaks),
        shapes,
    ]
    return section("Modes found", [*blocks, Prose(text)])


def response_data_section(seen: Identification) -> Section | None:
    """Make the section of responses (data and fit) and of their estimators; without recorded inputs, the section of amplitude densities."""
    found = seen.found
    if not found.inputs:
        picture = to_svg(density_figure(found), "measured-densities", "Amplitude density of outputs over frequency, and the modes found")
        return section("Densities", [Picture(picture, "Amplitude densities of the outputs (at most six). Dotted: modes found.")])
    drawn = to_svg(response_matrix_figure(found), "measured-responses", "Responses of outputs to inputs: data and fit")
    caption = "Responses: magnitude, and phase below it. Grey: data (H1 for records); blue: fit. Columns are inputs, rows are outputs."
    cut = max(len(found.outputs), len(found.inputs)) > LARGEST
    caption += f" At most {LARGEST} of {len(found.outputs)} outputs and {len(found.inputs)} inputs are shown." if cut else ""
    others = [each for each in (seen.second, seen.ratio) if each is not None]
    estimators: Block | None = None
    if others and seen.spectra is not None:
        picture = to_svg(estimator_figure(found.responses, others, focus(found)), "estimators", "Comparison of response estimates")
        text = (
            "Response of each output (at most six) to its dominant input. H1 assumes noise at outputs, H2 assumes noise at inputs. "
            "G_ij/G_ii (Eq. 29 of Shin & Moon) equals H1 for a single input and for uncorrelated inputs."
        )
        estimators = Picture(picture, text)
    return section("Responses", [Picture(drawn, caption), fold("H1, H2 and the ratio of Shin & Moon", estimators)])


def coherence_section(seen: Identification) -> Section | None:
    """Make the section of ordinary and multiple coherence; `None` if there is neither."""
    if seen.found.responses.coherence is None and seen.multiple is None:
        return None
    known = seen.spectra
    lines = None if known is None else known.frequencies
    drawn = to_svg(coherence_figure(seen.found, seen.multiple, lines), "coherence", "Coherence of outputs with inputs over frequency")
    cut = ""
    if known is not None:
        window = known.segments.window.value.capitalize()
        cut = f" Segments of the multiple coherence: {number(known.segments.seconds, 4)} s, {window} window, {known.averages} averages."
    caption = (
        "Multiple coherence: fraction of output power that all inputs explain. Ordinary coherence: fraction of output power that one input "
        "explains. At most six outputs and six inputs are shown." + cut
    )
    return section("Coherence", [Picture(drawn, caption)])


def stabilisation_section(found: Identified) -> Section | None:
    """Make the section of the stabilisation diagram; `None` if the identification has no stabilisation data."""
    if not found.stabilisation:
        return None
    drawn = to_svg(stabilisation_figure(found), "stabilisation", "Stabilisation diagram: poles by order and frequency")
    caption = (
        "Poles of models of increasing order. A pole is stable if it differs from a pole of a lower order by less than 0.2 % in frequency "
        "and 5 % in damping, and if the MAC of the participations of the two poles exceeds 0.98."
    )
    return section("Stabilisation", [Picture(drawn, caption)])


def measured_shape_section(found: Identified, shapes: StageShapes, data: StageData) -> Section | None:
    """Make the section that shows measured shapes as stage motions, or the reason why they are missing; `None` if there are no modes."""
    if not len(found.frequencies):
        return None
    if shapes.missing:
        return section("Shapes on the stage", [Prose(f"Not drawn: {shapes.missing}.")])
    note = (
        f"Computed from {', '.join(shapes.used)} with the inverse mapping of the ideal stage; bodies move as if hinges were ideal. "
        f"{motion_explained_text(shapes.explained)} {SHAPES}"
    )
    return section("Shapes on the stage", [BlockRow(tuple(_pictures(found, data)), narrow=True), Prose(note)])


def measured_motions(found: Identified, shapes: StageShapes, bones: Skeleton) -> tuple[Motion, ...]:
    """Convert the measured shapes to motions for the viewer; empty if the shapes cannot be mapped to the stage."""
    return tuple(
        Motion(
            Group.MODE,
            f"measured {index + 1}",
            f"measured {index + 1}  {number(float(frequency))} Hz",
            bones.at_origin({name: twist[:, index] for name, twist in shapes.motions.items()}),
            f"as measured, damping {number(100.0 * float(found.damping[index]), 3)} %",
            float(frequency),
        )
        for index, frequency in enumerate(found.frequencies if not shapes.missing else ())
    )


def pair_section(found: Compared, data: StageData) -> Section | None:
    """Make the section of paired model and measured modes, animated side by side; `None` if no pair can be drawn."""
    theory, known = platform_modes(data), {each.name for each in data.motions}
    partners = [
        (f"mode {theory[mode.number - 1].name}", f"mode measured {mode.experiment.number}")
        for mode in found.modes
        if mode.experiment is not None and mode.number <= len(theory) and f"measured {mode.experiment.number}" in known
    ]
    text = "Left: theory; right: the paired mode of the experiment. Signs are arbitrary; repeated modes may be mixed."
    joined = joined_viewers(partners)
    return None if joined is None else section("Side by side", [joined, Prose(text)])


def _pictures(found: Identified, data: StageData) -> Iterator[Picture]:
    motions = {each.name: each for each in data.motions}
    for number_of, (frequency, damping) in enumerate(zip(found.frequencies, found.damping, strict=True), start=1):
        figure = mode_picture(data, motions[f"measured {number_of}"], width=THIRD)
        if figure is not None:
            caption = f"{number_of}: {number(float(frequency))} Hz, damping {number(100.0 * float(damping), 3)} %"
            yield Picture(to_svg(figure, f"measured{number_of}", caption), caption, f"mode measured {number_of}")


def compare_section(found: Compared) -> Section | None:
    """Make the section of model, finite elements and test: figure, tables, warnings."""
    drawn = to_svg(compare_figure(found), "compared", "Frequencies of theory, FEA and experiment")
    shown = "theory, FEA and experiment" if found.fea is not None else "theory and experiment"
    caption = f"Above: frequencies of {shown}. Below: difference from the experiment. Whiskers and bands: 95 % intervals of the experiment."
    return section("Theory and experiment", [Picture(drawn, caption), *compare_tables(found)])


def compare_tables(found: Compared) -> tuple[Table | None, ...]:
    """List the tables of a comparison, in order."""
    modes = result_table(found.modes, notes=found.notes, provenance=found.provenance)
    return modes, result_table(found.repeated), result_table(found.further), data_warning_table(found.data_warnings)
