"""Report sections on modes and frequency responses."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from flexstage.analysis.complete import Analysis
from flexstage.analysis.dynamics.modes import Modes
from flexstage.show.display import number, percent
from flexstage.show.figures.export import to_svg
from flexstage.show.figures.reading import Spot, reading
from flexstage.show.figures.response import response_figure
from flexstage.show.figures.style import THIRD
from flexstage.show.page import BlockRow, Folded, Picture, Prose, Section, section
from flexstage.show.scene.pictures import mode_picture
from flexstage.show.table import Table, first_design
from flexstage.show.tables.modes import mode_table
from flexstage.show.tables.response import response_table
from flexstage.show.viewer.data import StageData
from flexstage.show.viewer.motions import Group

_SHAPES = 6
_LEAST, _NAMED = 0.01, 4
SHAPES = (
    "The amplitude is arbitrary. Dashed: the undeformed platform. Blue arrow: translation. Red arrow: rotation. In-plane modes are "
    "seen from above."
)


def mode_section(analysis: Analysis, data: StageData) -> Section | None:
    """Make the section on modes, with pictures of the mode shapes of the platform; `None` for the ideal model.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.show.viewer.data import still_data
    >>> from flexstage.analysis.complete import Model, analyse
    >>> mode_section(analyse(double_triangle(), Model.IDEAL), still_data(double_triangle())) is None
    True
    """
    modes = analysis.modes
    if modes is None or not modes.names:
        return None
    text = "Undamped modes with fixed actuators. Local modes with frequencies near the platform modes are listed too."
    shapes = tuple(_shapes(modes, data))
    gallery = [BlockRow(shapes, narrow=True), Prose(SHAPES)] if shapes else []
    return section("Modes", [Prose(text), mode_table(modes), *gallery])


def _shapes(modes: Modes, data: StageData) -> Iterator[Picture]:
    frequencies, motions = first_design(modes.frequencies, 1), {each.name: each for each in data.motions if each.group is Group.MODE}
    for index in modes.platform[:_SHAPES]:
        figure = mode_picture(data, motions[str(index + 1)], width=THIRD)
        if figure is not None:
            caption = f"{index + 1}: {modes.names[index]}, {number(float(frequencies[index]))} Hz; kinetic energy: {_shares(modes, index)}"
            yield Picture(to_svg(figure, f"mode{index + 1}", caption), caption, f"mode {index + 1}")


def _shares(modes: Modes, index: int) -> str:
    """Kinetic-energy fractions of a mode: the platform, units and other bodies above one per cent."""
    shares: dict[str, float] = {}
    for name, energy in zip(modes.bodies, first_design(modes.energies, 2)[:, index], strict=True):
        owner = name.partition("/")[0]
        shares[owner] = shares.get(owner, 0.0) + float(energy)
    ranked = sorted((each for each in shares.items() if each[1] >= _LEAST), key=lambda each: -round(each[1], 3))
    texts = [f"{name} {percent(share, 2 if share < 0.1 else 3)}" for name, share in ranked[:_NAMED]]
    return ", ".join(texts) + (", others" if len(ranked) > _NAMED else "")


def response_section(analysis: Analysis) -> Section | None:
    """Make the section on frequency responses to strokes and to ground motion; `None` without results.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.analysis.complete import Model, analyse
    >>> response_section(analyse(double_triangle(), Model.IDEAL)) is None
    True
    """
    shown = (
        (
            analysis.response,
            "strokes",
            "Response of the platform to the strokes",
            "Platform motion per actuator input: each output for the actuator that moves it most. Dotted: the platform's modes.",
        ),
        (
            analysis.transmissibility,
            "ground",
            "Transmissibility from the ground to the platform",
            "Transmissibility: absolute motion of the platform per absolute motion of the ground.",
        ),
    )
    blocks, tables = list[Picture | Folded](), list[Table]()
    for response, name, title, caption in shown:
        if response is not None and np.size(response.values):
            figure = response_figure(response, analysis.modes)
            blocks.append(Picture(to_svg(figure, name, title), caption, reading=reading(figure, _mode_spots(analysis.modes))))
            tables.append(response_table(response))
    if tables:
        blocks.append(Folded("Gains and peaks", tuple(tables)))
    return section("Frequency responses", blocks)


def _mode_spots(modes: Modes | None) -> Iterator[Spot]:
    """The platform's modes, which the page's viewer plays."""
    if modes is not None:
        frequencies = first_design(modes.frequencies, 1)
        for index in modes.platform:
            text = f"mode {index + 1}, {modes.names[index]}, {number(float(frequencies[index]))} Hz"
            yield Spot(float(frequencies[index]), text, plays=f"mode {index + 1}")
