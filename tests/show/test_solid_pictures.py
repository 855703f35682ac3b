"""Pictures and tables of solids."""

from __future__ import annotations

import numpy as np
import pytest

from flexstage.base.number import Array
from flexstage.show.scene.view import Side
from flexstage.solid.results.stress import LinkStress
from flexstage.solid.results.surface import Surface
from flexstage.solid.results.verification import Row
from flexstage.solid.show.skin_figures import skin_figure
from flexstage.solid.show.tables import stress_table, verification_table


def triangle(height: float, value: float) -> Surface:
    places = np.array([[0.0, 0.0, height], [1.0, 0.0, height], [0.0, 1.0, height]])
    return Surface(places, np.array([[0, 1, 2]]), np.full(3, value))


def seen_from_above(*surfaces: Surface) -> Array:
    return np.asarray(skin_figure(surfaces, "MPa", side=Side.TOP).axes[0].images[0].get_array())


@pytest.mark.parametrize("order", [(0.0, 1.0), (1.0, 0.0)])
def test_the_nearest_face_is_seen(order: tuple[float, float]) -> None:
    """Its value is the highest, which viridis shows as yellow."""
    image = seen_from_above(*(triangle(height, height) for height in order))
    colours = np.unique(image[image[..., 3] > 0], axis=0)
    assert len(colours) == 1
    assert colours[0, 0] > 2 * colours[0, 2]


def test_faces_cover_their_area_and_colours_run_between_their_corners() -> None:
    one = triangle(0.0, 1.0)
    image = seen_from_above(Surface(one.places, one.triangles, np.array([0.0, 1.0, 0.0])))
    assert np.mean(image[..., 3] > 0) == pytest.approx(0.5 / 1.06**2, rel=0.01)  # 0.03 of room on all sides
    row = image[-image.shape[0] // 4]
    inside = row[row[:, 3] > 0]
    assert len(np.unique(inside, axis=0)) > 50


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
