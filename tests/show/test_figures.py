"""Figures: what is drawn is what was computed, and every file is sound."""

from __future__ import annotations

import base64
import json
import re
import xml.etree.ElementTree as ET
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from matplotlib.path import Path
from matplotlib.transforms import IdentityTransform

from flexstage.analysis.linear_statics.statics import directional
from flexstage.show.figures.budget import energy_figure, error_figure, loss_figure
from flexstage.show.figures.directional import directional_figure
from flexstage.show.figures.export import share_styles, to_png, to_svg
from flexstage.show.figures.pen import course
from flexstage.show.figures.reading import Spot, reading
from flexstage.show.figures.response import response_figure
from flexstage.show.figures.spectrum import spectrum_figure
from flexstage.show.figures.style import canvas, style_context
from flexstage.show.figures.workspace import workspace_figure
from flexstage.show.tables.lost_motion import budget_table
from flexstage.show.tables.response import leading_curves
from tests.show.stages import analysed


def sound(figure: object, name: str) -> str:
    text = to_svg(figure, name, "a & b")
    ET.fromstring(text.replace("<svg ", '<svg xmlns="http://www.w3.org/2000/svg" ', 1))  # noqa: S314  our own text
    assert "metadata" not in text
    assert "DejaVu" not in text
    assert len(text) < 60_000
    return text


@pytest.mark.parametrize("name", ["double-triangle", "xy-stage-floating", "tip-tilt-four"])
def test_every_case_can_be_drawn(name: str) -> None:
    analysis = analysed(name)
    if analysis.statics is not None:
        sound(directional_figure(analysis.statics), "a")
    if analysis.lost_motion is not None:
        sound(loss_figure(analysis.lost_motion), "b")
        sound(energy_figure(analysis.lost_motion), "c")
    if analysis.modes is not None:
        sound(spectrum_figure(analysis.modes), "d")
    if analysis.response is not None:
        sound(response_figure(analysis.response, analysis.modes), "e")
    if analysis.error_budget is not None:
        sound(error_figure(analysis.error_budget), "f")
    if analysis.workspace is not None and (figure := workspace_figure(analysis.workspace)) is not None:
        sound(figure, "g")


def test_bars_add_up_to_the_losses() -> None:
    lost = analysed("double-triangle").lost_motion
    assert lost is not None
    axes = loss_figure(lost).axes[0]
    ends = np.zeros(6)
    for bar in (path.vertices for bars in axes.collections for path in bars.get_paths()):
        ends[round(np.ptp(bar[:, 1]) / 2.0 + bar[:, 1].min())] += np.ptp(bar[:, 0])
    assert np.allclose(ends, 100.0 * np.diagonal(lost.loss.values), rtol=1e-12)


def test_bars_name_the_links_of_other_units_as_the_table_does() -> None:
    """A horizontal actuator loses to hinges of the vertical ones, each with a colour of its own."""
    lost = analysed("double-triangle").lost_motion
    assert lost is not None
    figure = loss_figure(lost)
    told = [text.get_text() for text in figure.legends[0].get_texts()]
    table = budget_table(lost)
    assert table is not None
    assert {name for name in told if "/" in name} == {row[0] for row in table.texts() if "/" in row[0]} != set()
    colours = [tuple(bars.get_facecolor()[0]) for bars in figure.axes[0].collections]
    assert len(set(colours)) == len(told)


def test_the_polar_plot_shows_principal_axes() -> None:
    from dataclasses import replace

    statics = analysed("double-triangle").statics
    assert statics is not None
    # The tensor that fits the paper's Table 1, A = 41.89, B = 0.10, C = 3.74 um at 100 N: stiffest across 44 degrees.
    tensor = np.linalg.inv(np.array([[41.99, 3.74], [3.74, 41.79]]) * 1e-8)
    figure = directional_figure(replace(statics, free=directional(tensor)))
    labels = [text.get_text() for text in figure.axes[0].get_legend().get_texts()]
    assert labels[1] == "others free: 2.621 along 134°, 2.191 across"


def test_compaction_keeps_points_within_a_tenth() -> None:
    points = np.random.default_rng(3).uniform(0.0, 400.0, (40, 2))
    path = "M " + " L ".join(f"{x:.6f} {y:.6f}" for x, y in points) + " z"
    short = course(Path([*points, points[0]], closed=True), IdentityTransform(), 500.0)
    found = re.search(r"M([^a-z]*l[^a-z]*)z", short)
    assert found is not None
    numbers = [float(each) for each in re.findall(r"-?(?:\d+\.?\d*|\.\d+)", found[1])]
    steps = np.array(numbers).reshape(-1, 2)
    assert np.max(np.abs(np.cumsum(steps, axis=0) - (points * [1.0, -1.0] + [0.0, 500.0]))) <= 0.05 + 1e-9
    assert len(short) < 0.6 * len(path)


def test_marks_of_one_look_are_one_path_and_stand_where_matplotlib_puts_them() -> None:
    x = np.linspace(0.0, 1.0, 5)
    with style_context():
        figure = canvas(3.0, 2.0)
        axes = figure.add_axes((0.2, 0.2, 0.7, 0.7))
        axes.plot(x, x**2, "s", color="#009988")
    text = sound(figure, "marks")
    mark, places = re.findall(r'<marker id="([^"]+)".*?<path d="M([^"]+)"', text)[-1]  # the first are the marks of the axes
    assert f"marker:url(#{mark})" in text
    ends = axes.transData.transform(np.stack([x, x**2], axis=1)) * 72.0 / figure.dpi
    assert np.allclose(np.array(places.split(), dtype=float).reshape(-1, 2), np.stack([ends[:, 0], 144.0 - ends[:, 1]], axis=1), atol=0.051)


def test_pictures_of_a_page_share_their_styles_and_keep_their_looks() -> None:
    """Every element has the rules it had by itself; a name that a user gave is no class."""
    alone = [to_svg(spectrum_figure(found), name, 'class="one-0"') for name in ("one", "two") if (found := analysed("parallelogram").modes)]
    page, sheet = share_styles("".join(alone))
    looks = dict(re.findall(r"\.([\w-]+)\{([^}]*)\}", "".join(alone)))
    shared = dict(re.findall(r"\.([\w-]+)\{([^}]*)\}", sheet))
    before, after = (re.findall(r' class="([^"]+)"', text) for text in ("".join(alone), page))
    assert [looks[each] for each in before] == [shared[each] for each in after]
    assert len(shared) == len(set(looks.values())) < len(looks)
    assert "<style>" not in page
    assert page.count("class=&quot;one-0&quot;") == 2


def test_what_styles_refer_to_is_in_the_page_that_shares_them() -> None:
    """Marks of the same look in four axes: their style has a place of its own, so that their new name reaches it."""
    with style_context():
        figure = canvas(3.0, 3.0)
        for axes in figure.subplots(2, 2).ravel():
            axes.plot([0.0, 1.0], [0.0, 1.0])
    page, sheet = share_styles(sound(figure, "n"))
    assert set() != set(re.findall(r"url\(#([^)]+)\)", page + sheet)) <= set(re.findall(r' id="([^"]+)"', page))


def straight(axes: Any) -> None:
    axes.plot([1.0, 2.0, 5.0], [0.003, 0.2, 0.1], "o-")
    axes.set(xlabel="time [s]", ylabel="stroke [µm]")
    axes.tick_params(labelsize=6.0, pad=1.0, length=5.0)


def logarithmic(axes: Any) -> None:
    axes.loglog([0.8, 20.0, 3000.0], [1e-3, 20.0, 5.0])
    axes.set(xlabel="frequency [Hz]", ylabel="magnitude")
    axes.grid(which="minor", linewidth=0.2)


def named(axes: Any) -> None:
    axes.barh(range(3), [1.0, -2.0, 4.0])
    axes.set_yticks(range(3), ["B1", "lever_notch.rz", "a\nb"])
    axes.set_xticks([0.0, 3.0], ["none", "three"], rotation=90, fontsize=5)
    axes.invert_yaxis()
    axes.grid(visible=False, axis="y")
    axes.set(xlim=(-1.0, 3.5), xlabel="share", ylabel="link")


def on_the_right(axes: Any) -> None:
    axes.plot([1.0e6, 1.0e6 + 1.0], [3.0, 4.0])
    axes.yaxis.tick_right()
    axes.set(xlabel="x", ylabel="y")


@pytest.mark.parametrize("draw", [straight, logarithmic, named, on_the_right])
def test_writing_svg_leaves_the_figure_unchanged(draw: Callable[[Any], None]) -> None:
    with style_context():
        figure = canvas(3.0, 2.0)
        draw(figure.add_axes((0.3, 0.3, 0.6, 0.6)))
    before = to_png(figure)
    sound(figure, "n")
    assert to_png(figure) == before


def test_a_dollar_sign_is_a_dollar_sign() -> None:
    with style_context():
        figure = canvas(1.0, 1.0)
        figure.add_subplot().set_xlabel("$x^2$ & <b>")
    assert "$x^2$ &amp; &lt;b&gt;" in to_svg(figure, "n", "d")


def test_png_is_reproducible() -> None:
    modes = analysed("parallelogram").modes
    assert modes is not None
    assert to_png(spectrum_figure(modes)) == to_png(spectrum_figure(modes))


def test_a_reading_has_the_numbers_and_the_places_of_what_is_drawn() -> None:
    """Of every curve the values that the figure was given; where the page puts them is where matplotlib does, to a hundredth of a point."""
    found = analysed("parallelogram")
    assert found.response is not None
    figure = response_figure(found.response, found.modes)
    told = json.loads(reading(figure, [Spot(10.0, "here", 1.0)]))
    assert told["spots"] == [{"x": 10.0, "text": "here", "y": 1.0, "panel": 0}]
    assert told["along"] == "frequency [Hz]"
    columns = ["magnitude [µm/µm]", "magnitude [µrad/µm]"]
    assert [panel["name"] for panel in told["panels"]] == [*columns, "phase [°]", "phase [°]"]
    upper, _, lower, _ = told["panels"]
    assert [each["name"] for each in upper["curves"]] == [each["name"] for each in lower["curves"]]
    size = np.frombuffer(base64.b64decode(upper["curves"][0]["y"]), "<f4")
    assert np.allclose(size, np.abs(leading_curves(found.response)[0].values), rtol=1e-6)
    (over,) = told["over"]
    assert np.array_equal(np.frombuffer(base64.b64decode(over), "<f4"), found.response.frequencies.astype("<f4"))
    assert {each["x"] for panel in told["panels"] for each in panel["curves"]} == {0}
    for panel, axes in zip(told["panels"], figure.axes, strict=True):
        (left, top, width, height), (low, high), (bottom, above) = panel["box"], panel["x"], panel["y"]
        ends = axes.transData.transform([(low, bottom), (high, above)]) * 72.0 / figure.dpi
        whole = 72.0 * figure.get_size_inches()[1]
        assert np.allclose(
            [left, top + height, left + width, top], [ends[0][0], whole - ends[0][1], ends[1][0], whole - ends[1][1]], atol=0.02
        )
