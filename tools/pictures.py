"""The pictures of the documentation, drawn anew from the shipped stage: `make pictures` writes docs/pictures.

Run with `--png FOLDER` to look at them: the same pictures as PNG.
"""

from __future__ import annotations

import argparse
import re
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cache, partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from threadpoolctl import threadpool_limits

import flexstage as fs
from flexstage.analysis.complete import platform_modes
from flexstage.analysis.dynamics.modes import clusters
from flexstage.beams.compliance import compliance
from flexstage.cases.double_triangle import double_triangle
from flexstage.control.hysteresis.example import example_test
from flexstage.control.hysteresis.show.figures import stack_figure
from flexstage.control.show.figures.diagram import loop_diagram
from flexstage.control.show.figures.frequency import open_loop_figure
from flexstage.control.show.figures.noise import noise_share_figure
from flexstage.control.show.figures.time import path_figure
from flexstage.control.show.sections import diagram_of
from flexstage.control.study.choices import Compensation, Criterion
from flexstage.control.study.setup import Floor, GaugeSetup, LoopSetup, RasterMotion, VibrationSetup
from flexstage.control.study.study import LoopStudy, loop_study
from flexstage.experiment import NoiseDrive, RigSetup, Search, Sensing
from flexstage.experiment.identification.identified import Identified
from flexstage.experiment.show.comparison_figures import compare_figure
from flexstage.experiment.show.figures import stabilisation_figure
from flexstage.mechanism.addresses.address import get, set_value
from flexstage.show.figures.budget import loss_figure
from flexstage.show.figures.directional import directional_figure
from flexstage.show.figures.export import to_png, to_svg
from flexstage.show.figures.response import response_figure
from flexstage.show.figures.style import FULL, INK, MUTED, PAPER, SERIES, canvas, style_context
from flexstage.show.plan import plan_figure
from flexstage.show.scene.pictures import stage_picture
from flexstage.show.scene.skin import Kind
from flexstage.show.scene.view import Side, draw, edges_of, fit, triad, view, write
from flexstage.show.viewer.data import stage_data, still_data
from flexstage.show.viewer.motions import Group
from flexstage.solid.fea.meshing.fineness import Fineness, Reduction
from flexstage.solid.results.read import STANDARD_SOLIDS, read_solid
from flexstage.solid.results.surface import mode_surfaces
from flexstage.solid.show.skin_figures import skin_figure
from flexstage.spatial.frame import COMPONENTS, transport
from flexstage.studies.optimisation.file import load_optimisation
from flexstage.studies.optimisation.search.optimum import optimise
from flexstage.studies.optimisation.show.figures import convergence_figure
from flexstage.studies.sweeps.definition import Study
from flexstage.studies.sweeps.effects import Effects
from flexstage.studies.sweeps.effects import effects as effects_of
from flexstage.studies.sweeps.execution.run import Run, sweep
from flexstage.studies.sweeps.file import loads_study
from flexstage.studies.sweeps.show.figures import effects_figure
from flexstage.studies.sweeps.show.interaction_figures import strongest_figure
from flexstage.studies.tolerances.file import loads_tolerance
from flexstage.studies.tolerances.run import Toleranced, tolerance
from flexstage.studies.tolerances.show.figures import distributions_figure
from tests.analytic import test_paros_weisbord, test_smith_toroid
from tests.analytic.closed_forms import (
    paros_weisbord_rotation_simplified,
    schotborgh_rotation_stiffness,
    smith_toroid_rotation_stiffness,
)
from tests.analytic.hinges import UNIT, circular, diagonal, error
from tests.docs.pages import blocks
from tools.gallery import SHOWN

PICTURES = Path(__file__).resolve().parents[1] / "docs" / "pictures"
_OF_THE_PAGE = re.compile(r"var\(--\w+,\s*([^)]+)\)")
_SWAY = 0.03
"""Largest motion of a drawn mode [m]."""
_SIDES = ((Side.ISOMETRIC, (0, 0)), (Side.TOP, (0, 1)), (Side.FRONT, (1, 0)), (Side.RIGHT, (1, 1)))


def stage() -> Any:
    """The double-triangular stage from three sides and above the corner, all to one scale but for the corner."""
    drawn = still_data(double_triangle())
    with style_context():
        figure = canvas(FULL, 0.68 * FULL)
        panels = figure.subplots(
            2, 2, height_ratios=(2.6, 1.0), gridspec_kw={"left": 0, "right": 1, "bottom": 0, "top": 1, "wspace": 0, "hspace": 0}
        )
        for side, place in _SIDES:
            seen, axes = view(side), panels[place]
            _framed(axes, drawn.mesh.points, side)
            draw(axes, drawn, seen)
            write(axes, drawn.labels if side in (Side.ISOMETRIC, Side.TOP) else (), seen)
            triad(axes, seen)
    return figure


def _framed(axes: Any, points: Any, side: Side, gap: float = 12.0) -> None:
    flat = view(side).project(points)
    fit(axes, flat.min(axis=0) - gap, flat.max(axis=0) + gap)


def guide() -> Any:
    """The parallelogram of the page on theory."""
    return stage_picture(still_data(fs.case("parallelogram")))


def six_by_six() -> Any:
    """The compliance of the leaf of the page on theory, at its centre and at its end, by that along it."""
    length, steel = 30 * fs.mm, fs.Material(young=200e9, poisson=0.3, density=7750.0)
    at_centre = compliance(fs.Leaf("steel", length=length, thickness=0.5 * fs.mm, width=10 * fs.mm), steel)
    sizes = np.array([1.0] * 3 + [length] * 3)
    with style_context():
        figure = canvas(FULL, 3.5)
        for axes, place, title in zip(figure.subplots(1, 2), (0.0, 0.5 * length), ("at its centre", "at its end"), strict=True):
            moved = transport(np.array([place, 0.0, 0.0]))
            seen = moved @ at_centre @ moved.T * np.outer(sizes, sizes)
            _cells(axes, seen / seen[0, 0], title)
    return figure


def _cells(axes: Any, values: Any, title: str) -> None:
    """A matrix as cells, darker the larger the entry by orders of magnitude; what is zero stays empty."""
    sizes = np.ma.masked_less(np.abs(values), 1e-6)
    axes.pcolormesh(np.ma.log10(sizes), cmap="Blues", vmin=-2.0, vmax=7.0, edgecolors=PAPER, linewidth=1.0)
    for row, column in np.argwhere(~sizes.mask):
        value = values[row, column]
        said = f"{value:.0f}" if abs(value) >= 10.0 else f"{value:.2g}"
        axes.text(column + 0.5, row + 0.5, said, ha="center", va="center", fontsize=6.5, color=PAPER if abs(value) > 2e4 else INK)
    axes.set_xticks(np.arange(6) + 0.5, ["Fx", "Fy", "Fz", "Mx", "My", "Mz"])
    axes.set_yticks(np.arange(6) + 0.5, list(COMPONENTS))
    axes.invert_yaxis()
    axes.grid(visible=False)
    axes.set_aspect("equal")
    axes.set_title(title)


def margins() -> Any:
    """The curve of a loop in the complex plane, and what keeps it from -1."""
    omega = np.geomspace(0.3, 30.0, 4000)
    loop = 0.9 / (1j * omega) / (1.0 - (omega / 4.0) ** 2 + 1j * omega / 2.5) * np.exp(-0.15j * omega)
    crossing = int(np.argmin(np.abs(np.abs(loop) - 1.0)))
    negative = int(np.flatnonzero((loop.imag[:-1] < 0.0) & (loop.imag[1:] >= 0.0))[0])
    nearest = int(np.argmin(np.abs(1.0 + loop)))
    turn = np.linspace(0.0, 2.0 * np.pi, 361)
    with style_context():
        figure = canvas(0.62 * FULL, 0.56 * FULL)
        axes = figure.add_axes((0.02, 0.02, 0.96, 0.96))
        axes.plot(np.cos(turn), np.sin(turn), color=MUTED, linewidth=0.7, linestyle="--")
        axes.plot(loop.real, loop.imag, color=SERIES[0])
        distance = abs(1.0 + loop[nearest])
        axes.plot(-1.0 + distance * np.cos(turn), distance * np.sin(turn), color=SERIES[3], linewidth=0.8)
        axes.plot([-1.0, loop[nearest].real], [0.0, loop[nearest].imag], color=SERIES[3], linewidth=0.8)
        angle = np.linspace(np.pi, np.pi + float(np.angle(-loop[crossing])), 60)
        axes.plot(0.8 * np.cos(angle), 0.8 * np.sin(angle), color=SERIES[2])
        axes.plot([0.0, loop[crossing].real], [0.0, loop[crossing].imag], color=SERIES[2], linewidth=0.8)
        axes.plot([loop[negative].real, 0.0], [0.0, 0.0], color=SERIES[1], linewidth=2.0)
        axes.plot([-1.0], [0.0], marker="x", color=INK)
        said = (
            (-1.08, 0.07, "-1", INK),
            (0.34, 0.07, "1 / gain margin", SERIES[1]),
            (0.98 * np.cos(angle[20]), 0.98 * np.sin(angle[20]) - 0.06, "phase\nmargin", SERIES[2]),
            (-1.4, 0.7, "1 / peak of S", SERIES[3]),
            (0.86, 0.82, "|L| = 1", MUTED),
            (-0.6, -1.5, "L(f)", SERIES[0]),
        )
        for x, y, text, colour in said:
            axes.text(x, y, text, color=colour, ha="center", fontsize=7.5)
        axes.axhline(0.0, color=MUTED, linewidth=0.5)
        axes.axvline(0.0, color=MUTED, linewidth=0.5)
        axes.set_xlim(-1.9, 1.2)
        axes.set_ylim(-1.6, 1.15)
        axes.set_aspect("equal")
        axes.set_axis_off()
    return figure


def sine() -> Any:
    """The response of the parallelogram's platform to its stack."""
    model = fs.lumped(fs.case("parallelogram"))
    frequencies = np.geomspace(10.0, 4000.0, 800)
    return response_figure(fs.response(model, ["platform.x"], ["B"], frequencies, damping=fs.ModalDamping(0.01)), fs.modes(model))


def modes() -> Any:
    """The platform's modes, exaggerated, over its outline at rest; of repeated ones the first."""
    model, seen = fs.lumped(double_triangle()), view(Side.ISOMETRIC)
    found = fs.modes(model)
    data = stage_data(double_triangle(), found=found)
    motions = {motion.name: motion for motion in data.motions if motion.group is Group.MODE}
    shown = (Kind.PLATFORM, Kind.BODY, Kind.HINGE, Kind.DRIVE)
    groups = [group for group in clusters(found.frequencies, 1e-6) if set(group) <= set(found.platform)]
    with style_context():
        figure = canvas(FULL, 0.58 * FULL)
        for axes, group in zip(
            figure.subplots(2, 2, gridspec_kw={"left": 0, "right": 1, "bottom": 0, "wspace": 0}).flat, groups, strict=True
        ):
            motion = motions[str(group[0] + 1)]
            moved = data.mesh.points + _SWAY / data.reach(motion) * data.mesh.displacement(motion.twists)
            _framed(axes, np.concatenate([data.mesh.points, moved]), Side.ISOMETRIC)
            axes.plot(*edges_of(data, seen, Kind.PLATFORM).T, color=MUTED, linewidth=0.5, linestyle="--")
            draw(axes, data, seen, moved, shown)
            times = ", twice" if len(group) == 2 else ""
            axes.set_title(f"{found.names[group[0]]}, {found.frequencies[group[0]]:.1f} Hz{times}")
    return figure


def plan() -> Any:
    """The dimensioned plan."""
    mechanism = double_triangle()
    return plan_figure(mechanism, still_data(mechanism))


def xy_plan() -> Any:
    """The dimensioned plan of the stage in docs/blank-sheet.md."""
    with TemporaryDirectory() as place:
        for block in blocks("docs/blank-sheet.md"):
            if (name := block.word("file")) is not None:
                Path(place, name).write_text(block.text, encoding="utf-8")
        mechanism = fs.load(Path(place, "third.toml"))
    return plan_figure(mechanism, still_data(mechanism))


def polar() -> Any:
    """Stiffness in the plane by direction."""
    return directional_figure(fs.statics(fs.lumped(double_triangle())))


def budget() -> Any:
    """Lost motion by hinge."""
    mechanism = double_triangle()
    return loss_figure(fs.lost_motion(fs.ideal(mechanism), fs.lumped(mechanism)))


def hinge_errors() -> Any:
    """How far beam theory and the closed forms are off, over t/R, for circular notches and toroidal necks."""
    with style_context():
        figure = canvas(FULL, 2.9)
        figure.subplots_adjust(left=0.09, right=0.99, bottom=0.17, top=0.9, wspace=0.1)
        notch, neck = figure.subplots(1, 2, sharey=True)
        _curves(notch, notch_errors(), "circular notch, 2-D elements")
        _curves(neck, neck_errors(), "toroidal neck, axisymmetric elements")
        notch.set_ylabel("error of the compliance [%]")
    return figure


def far_motion() -> Any:
    """Stiffness along x of the case for long travel and how far its table sinks, over the stroke, by each of three models."""
    values, stage = np.linspace(-5e-3, 5e-3, 21), fs.case("long-travel-xy")
    plain = replace(stage, parts={**stage.parts, "leaf": replace(stage.parts["leaf"], section=fs.LeafSection.BEAM)})
    drawn = 1.0 / fs.statics(fs.lumped(stage)).compliance.at("platform.x", "platform.fx")
    with style_context():
        figure = canvas(FULL, 2.9)
        figure.subplots_adjust(left=0.09, right=0.99, bottom=0.17, top=0.9, wspace=0.28)
        stiff, low = figure.subplots(1, 2)
        for (label, each), color in zip({"leaves as plates": stage, "leaves as beams": plain}.items(), SERIES, strict=False):
            found = fs.stroke(fs.load_path(fs.nonlinear(each), "platform.x", values)).along
            for axes, column, factor in ((stiff, "stiffness", 1.0), (low, "platform.z", 1e3)):
                axes.plot(1e3 * values, factor * found.values[:, found.columns.index(column)], color=color, label=label)
        for axes, level, title in ((stiff, drawn, "stiffness along x [N/m]"), (low, 0.0, "z of the table [mm]")):
            axes.axhline(level, color=MUTED, linestyle="--", label="as drawn, unloaded")
            axes.set_title(title)
            axes.set_xlabel("x [mm]")
        stiff.set_ylim(400.0, 850.0)
        stiff.legend(loc="center")
    return figure


def _curves(axes: Any, curves: Mapping[str, list[tuple[float, float]]], title: str) -> None:
    axes.axhline(0.0, color=INK, linewidth=0.6)
    for number, (name, points) in enumerate(curves.items()):
        places, values = zip(*points, strict=True)
        axes.plot(
            places, values, marker="o", markersize=3.0, color=SERIES[number], linestyle=("-", "-", "-", "--", ":")[number], label=name
        )
    axes.set_title(title)
    axes.set_xlabel("neck thickness over radius, t/R")
    axes.set_ylim(-23.0, 17.0)
    axes.legend(loc="upper left")


def notch_errors() -> dict[str, list[tuple[float, float]]]:
    """Error in percent over t/R, by curve."""
    curves: dict[str, list[tuple[float, float]]] = {
        name: [] for name in ("x, beam", "rz, beam", "y, beam", "rz, Paros-Weisbord simplified", "rz, Schotborgh")
    }
    for ratio, rz, _, _, _, x, _, y, _ in test_paros_weisbord.TABLE:
        found, size = diagonal(circular(ratio), UNIT), (1.0, 1.0, ratio, 1.0)
        simple, fitted = paros_weisbord_rotation_simplified(*size), 1.0 / schotborgh_rotation_stiffness(*size)
        pairs = ((found[0], x), (found[5], rz), (found[1], y), (simple, rz), (fitted, rz))
        for points, (ours, true) in zip(curves.values(), pairs, strict=True):
            points.append((ratio, float(error(ours, true))))
    return curves


def neck_errors() -> dict[str, list[tuple[float, float]]]:
    """The same for toroidal necks."""
    curves: dict[str, list[tuple[float, float]]] = {name: [] for name in ("x, beam", "rz, beam", "rz, Smith")}
    for ratio, rz, _, _, x, _ in test_smith_toroid.TABLE:
        found = diagonal(fs.Neck("m", thickness=ratio, profile=fs.Circular(1.0)), UNIT)
        pairs = ((found[0], x), (found[5], rz), (1.0 / smith_toroid_rotation_stiffness(1.0, ratio, 1.0), rz))
        for points, (ours, true) in zip(curves.values(), pairs, strict=True):
            points.append((ratio, float(error(ours, true))))
    return curves


_THICKNESS = "parts.neck.thickness"


@cache
def _tested() -> Identified:
    """Modes from a test on the virtual rig of a stage whose horizontal necks came out 5 % too thick."""
    stage = double_triangle()
    built = set_value(stage, _THICKNESS, 1.05 * get(stage, _THICKNESS))
    setup = RigSetup(seconds=60.0, seed=1, drive=NoiseDrive(stroke=0.5 * fs.um), sensing=Sensing(density=5.0 * fs.nm))
    return fs.experiment.identify(fs.experiment.rig(built, fs.lumped(built), setup), Search(band=(80.0, 220.0)))


def stabilisation() -> Any:
    """The stabilisation diagram of that test."""
    return stabilisation_figure(_tested())


def compared() -> Any:
    """That test beside the theory of the stage as designed."""
    return compare_figure(fs.experiment.compare(double_triangle(), _tested()))


def solid() -> Any:
    """The first mode of the stage as a solid, by elements of order two, coloured by displacement."""
    read = read_solid(double_triangle(), Reduction(Fineness(order=2)), STANDARD_SOLIDS)
    found = platform_modes(double_triangle(), read.model)
    return skin_figure(mode_surfaces(read, found.shapes[:, found.platform[0]]), "")


def hysteresis() -> Any:
    """A stack's loops, the model and the inverse."""
    return stack_figure(example_test())


@cache
def _study(name: str) -> tuple[Study, Effects]:
    """A study in docs/studies.md, and what its variables do."""
    study = loads_study(next(block.text for block in blocks("docs/studies.md") if block.word("file") == name))
    with TemporaryDirectory() as place:
        return study, effects_of(sweep(study, Path(place) / "results.h5", Run(workers=1)), study.plan)


def effects() -> Any:
    """What variables do."""
    return effects_figure(*_study("study.toml"))


def strongest() -> Any:
    """How the strongest pairs act."""
    return strongest_figure(*_study("arms.toml"))


def optimum() -> Any:
    """How the searches of docs/optimise.md converge."""
    study = loads_study(next(block.text for block in blocks("docs/optimise.md") if block.word("file") == "study.toml"))
    return convergence_figure(optimise(study, load_optimisation(study)))


@cache
def _made() -> Toleranced:
    """The study in docs/tolerance.md, with as many copies as histograms need."""
    text = next(block.text for block in blocks("docs/tolerance.md") if block.word("file") == "made.toml")
    return tolerance(loads_tolerance(text.replace("copies = 96", "copies = 1024")), how=Run(workers=1))


def made() -> Any:
    """What copies of the shipped stage do, against their limits."""
    return distributions_figure(_made())


@cache
def _loop() -> LoopStudy:
    """The loop of the shipped stage on a floor of class VC-D, along a raster."""
    shaken = VibrationSetup(criterion=Criterion.VC_D)
    setup = LoopSetup(
        floor=Floor(shaken, shaken, shaken),
        gauges=GaugeSetup(noise=0.1 * fs.nm),
        compensate=(Compensation.LOST_MOTION, Compensation.REFERENCE),
        trajectory=RasterMotion(length=20e-6, pitch=2e-6, speed=0.2e-3, acceleration=0.02),
    )
    return loop_study(double_triangle(), setup)


def loop() -> Any:
    """The block diagram of that loop."""
    return loop_diagram(diagram_of(_loop()))


def loop_frequency() -> Any:
    """Its open loops."""
    seen = _loop().curves
    assert seen is not None  # noqa: S101 (its loop is closed)
    return open_loop_figure(seen, _loop().settled.plant.frequencies[:6])


def loop_raster() -> Any:
    """The raster as it is followed."""
    return path_figure(_loop().runs[0].simulated, ("x", "y"))


def loop_noise() -> Any:
    """Whose the noise at rest is."""
    return noise_share_figure(_loop().noise)


DRAWN: Mapping[str, tuple[Callable[[], Any], str]] = {
    "stage": (stage, "the double-triangular stage from above the corner, from above, from the front and from the right"),
    "guide": (guide, "a platform on two straight flexures, pushed by one stack"),
    "sine": (
        sine,
        "response of the platform to the stack over frequency: level, a peak at 1674 Hz, then falling",
    ),
    "six-by-six": (six_by_six, "compliance of a leaf: at its centre nearly diagonal, at its end with couplings of forces and rotations"),
    "margins": (margins, "a loop's curve in the complex plane, with its gain margin, its phase margin and its distance from -1"),
    "plan": (plan, "dimensioned plan of the double-triangular stage"),
    "xy-plan": (xy_plan, "dimensioned plan of an XY stage with three piezo struts and three gauges"),
    "polar": (polar, "stiffness of the double-triangular stage in the plane by direction: circles"),
    "budget": (budget, "lost motion of the six actuators by hinge"),
    "modes": (modes, "shapes of the platform's six modes"),
    "stabilisation": (stabilisation, "poles over the order of the model; those that stay become modes"),
    "compared": (compared, "frequencies of six modes by theory and as measured, and how far theory is off"),
    "hysteresis": (hysteresis, "loops of a stack with the model over them, the model's error, and the volts of the inverse"),
    "tolerance": (made, "distributions of lost motion and frequency over copies of the stage, with limits"),
    "effects": (effects, "mean frequency, lost motion and mass over the thickness of necks, plate and notch"),
    "strongest": (strongest, "lost motion over the arm, for thin and thick notches"),
    "optimum": (optimum, "the lowest frequency over accepted designs of three searches, and where each variable goes in its range"),
    "loop": (
        loop,
        "block diagram of a control loop: what the computer does, then hold, amplifiers, stacks, stage and gauges",
    ),
    "loop-frequency": (loop_frequency, "magnitude and phase of the open loops over frequency; notches hold down the modes of the stage"),
    "loop-raster": (loop_raster, "a raster as commanded and as followed, its error magnified"),
    "loop-noise": (loop_noise, "shares of floor, gauges and rounding in the noise of each motion at rest"),
    "far-motion": (
        far_motion,
        "stiffness along x and height of a table on leaves over 5 mm both ways, as drawn and at large displacements",
    ),
    "hinge-errors": (hinge_errors, "error of beam theory against finite elements over thickness over radius"),
}


def _shipped(name: str) -> Any:
    """A case of the gallery."""
    return stage_picture(still_data(fs.case(name)), width=0.7 * FULL)


RASTER: Mapping[str, Callable[[], Any]] = {"solid": solid} | {f"case-{name}": partial(_shipped, name) for name in SHOWN}
"""Pictures of thousands of triangles."""


def standing_alone(svg: str) -> str:
    """An SVG that was made to stand inside a page, as a file of its own: with a name space and colours of its own."""
    svg = _OF_THE_PAGE.sub(r"\1", svg)
    svg = re.sub(r'style="(?:--width:[^;"]+;)?max-width', f'style="background:{PAPER};max-width', svg, count=1)
    return svg.replace("<svg ", '<svg xmlns="http://www.w3.org/2000/svg" font-family="DejaVu Sans, Verdana, sans-serif" ', 1)


def main() -> None:
    """Write all pictures."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--png", type=Path, help="folder for PNGs to look at, instead of the pages' pictures")
    folder = parser.parse_args().png
    with threadpool_limits(limits=1):
        for name, figure in RASTER.items():
            ((folder or PICTURES) / f"{name}.png").write_bytes(to_png(figure()))
        for name, (figure, said) in DRAWN.items():
            if folder:
                (folder / f"{name}.png").write_bytes(to_png(figure()))
            else:
                (PICTURES / f"{name}.svg").write_text(standing_alone(to_svg(figure(), name, said)), encoding="utf-8")


if __name__ == "__main__":
    main()
