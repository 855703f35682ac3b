"""Figures: what is drawn is what was computed, and every file is sound."""

from __future__ import annotations

import base64
import io
import json
import re
import xml.etree.ElementTree as ET
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from PIL import Image

from flexstage.analysis.linear_statics.statics import directional
from flexstage.show.figures.budget import energy_figure, error_figure, loss_figure
from flexstage.show.figures.directional import directional_figure
from flexstage.show.figures.export import to_png, to_svg
from flexstage.show.figures.reading import Spot, reading
from flexstage.show.figures.response import response_figure
from flexstage.show.figures.style import INK, canvas, style_context
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
    for bar in axes.patches:
        ends[round(bar.get_y() + 0.5 * bar.get_height())] += bar.get_width()
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
    colours = [bars.patches[0].get_facecolor() for bars in figure.axes[0].containers]
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


def test_identifiers_of_a_figure_are_its_own_and_what_refers_to_them_finds_them() -> None:
    """Of the same figure under two names; a colour, a font or an identifier that a user wrote stays text."""
    with style_context():
        figure = canvas(3.0, 3.0)
        for axes in figure.subplots(2, 2).ravel():
            axes.plot([0.0, 1.0], [0.0, 1.0], "s")
            axes.set_title(f"id=\"a_1\" {INK} 'DejaVu' 1.2345 ")
    both = [to_svg(figure, name, "d") for name in ("one", "two")]
    own = [set(re.findall(r' id="([^"]+)"', text)) for text in both]
    assert own[0].isdisjoint(own[1])
    for text, names in zip(both, own, strict=True):
        assert set() != set(re.findall(r"url\(#([^)]+)\)|href=\"#([^\"]+)\"", text))
        assert {one or other for one, other in re.findall(r"url\(#([^)]+)\)|href=\"#([^\"]+)\"", text)} <= names
        assert text.count(f"id=\"a_1\" {INK} 'DejaVu' 1.2345 <") == 4


def test_an_image_stands_where_matplotlib_puts_it_and_colours_are_those_of_the_page() -> None:
    image = np.full((3, 5, 4), 255, dtype=np.uint8)
    with style_context():
        figure = canvas(2.0, 1.0)
        axes = figure.add_axes((0.25, 0.5, 0.5, 0.25))
        axes.set_axis_off()
        axes.imshow(image, interpolation="none", aspect="auto")
        axes.plot([0.0, 1.0], [0.0, 1.0], color=INK)
    text = sound(figure, "image")
    found = re.search(r'<image [^>]*width="([\d.]+)" height="([\d.]+)"[^>]*transform="matrix\(([^)]+)\)"', text)
    assert found is not None
    wide, high, (a, b, c, d, x, y) = float(found[1]), float(found[2]), map(float, found[3].split())
    assert (b, c) == (0.0, 0.0)
    assert [x, y, a * wide, d * high] == pytest.approx([36.0, 18.0, 72.0, 18.0], abs=0.02)
    assert f"stroke: var(--ink,{INK})" in text
    assert "image-rendering" not in text


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
    statics = analysed("parallelogram").statics
    assert statics is not None
    assert to_png(directional_figure(statics)) == to_png(directional_figure(statics))


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


def test_an_image_keeps_its_colours_and_a_name_its_quotes() -> None:
    """Colours of few kinds go into a table, opacity among them; a style within a text is no style."""
    drawn = np.random.default_rng(3).integers(0, 256, (40, 4), dtype=np.uint8)[np.arange(1200).reshape(30, 40) % 40]
    named = ' style="fill: #1f2a37"'
    with style_context():
        figure = canvas(40.0 / 72.0, 30.0 / 72.0)
        axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
        axes.set_axis_off()
        axes.imshow(drawn, interpolation="none", aspect="auto")
        for place in range(9):
            axes.text(place, place, named)
    text = to_svg(figure, "a", "b")
    assert text.count(named) == 9
    found = re.findall(r"data:image/png;base64,([\w+/=]+)", text)
    pixels = np.asarray(Image.open(io.BytesIO(base64.b64decode(found[0]))).convert("RGBA"))
    shown = drawn[..., 3] > 0
    assert np.array_equal(pixels[shown], drawn[shown]) or np.array_equal(pixels[::-1][shown], drawn[shown])
