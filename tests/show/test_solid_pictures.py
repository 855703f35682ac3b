"""Pictures and tables of solids."""

from __future__ import annotations

import base64
import re

import numpy as np
import pytest
from matplotlib.collections import PolyCollection

from flexstage.show.scene.view import Side
from flexstage.solid.results.stress import LinkStress
from flexstage.solid.results.surface import Surface
from flexstage.solid.results.verification import Row
from flexstage.solid.show.skin_figures import png_picture, skin_figure
from flexstage.solid.show.tables import stress_table, verification_table


def triangle(height: float, value: float) -> Surface:
    places = np.array([[0.0, 0.0, height], [1.0, 0.0, height], [0.0, 1.0, height]])
    return Surface(places, np.array([[0, 1, 2]]), np.full(3, value))


@pytest.mark.parametrize("order", [(0.0, 1.0), (1.0, 0.0)])
def test_the_nearest_face_is_drawn_last(order: tuple[float, float]) -> None:
    figure = skin_figure([triangle(height, height) for height in order], "", side=Side.TOP)
    (faces,) = [item for item in figure.axes[0].collections if isinstance(item, PolyCollection)]
    colours = faces.get_facecolors()
    assert len(colours) > 100  # large faces are divided
    yellow = colours[:, 0] > colours[:, 2]  # viridis: high values
    assert not yellow[: len(yellow) // 2].any()
    assert yellow[len(yellow) // 2 :].all()


def test_dividing_keeps_the_area() -> None:
    figure = skin_figure([triangle(0.0, 1.0)], "MPa", side=Side.TOP)
    (faces,) = [item for item in figure.axes[0].collections if isinstance(item, PolyCollection)]
    corners = np.array([path.vertices[:3] for path in faces.get_paths()])
    edges = corners[:, 1:] - corners[:, :1]
    assert np.abs(np.linalg.det(edges)).sum() / 2.0 == pytest.approx(0.5e6)  # mm^2


def test_a_picture_is_a_png_with_its_caption_escaped() -> None:
    found = png_picture(skin_figure([triangle(0.0, 1.0)], "MPa"), 'a < "b"')
    data = re.search(r"base64,([^\"]+)\"", found.svg)
    assert data is not None
    assert base64.b64decode(data[1])[1:4] == b"PNG"
    assert 'alt="a &lt; &quot;b&quot;"' in found.svg


def test_stress_is_listed_highest_first_and_silence_not_at_all() -> None:
    found = LinkStress(("a", "b"), np.array([1e6, 2e6]), np.array([0, 0]), np.array([np.nan, 4e6]))
    table = stress_table("Stress", found)
    assert table is not None
    assert table.texts()[1:] == [["b", "2", "4", "2"], ["a", "1", "-", "-"]]
    assert found.weakest == "b"
    assert stress_table("Stress", LinkStress(("a",), np.array([1.0]), np.array([0]), np.array([4e6]))) is None


def test_a_comparison_shows_what_there_is() -> None:
    row = Row("unit", "loss", "1", 0.03, 0.035, 0.001, calibrated=0.0349)
    table = verification_table((row,))
    assert table is not None
    heads, line = table.texts()
    assert heads == ["figure", "theory", "calibrated", "FEA", "FEA error", "theory error", "calibrated error", "trust"]
    assert line == ["loss", "3 %", "3.49 %", "3.5 %", "0.1 %", "-14.3 %", "-0.286 %", "calibrated theory"]
