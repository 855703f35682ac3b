"""The scene: rasters against ray casting, skins closed, platforms seen through, plans with their dimensions."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from flexstage.base.number import Array
from flexstage.cases.double_triangle import SM_REF_A, double_triangle
from flexstage.cases.registry import case
from flexstage.mechanism.mechanism import GROUND
from flexstage.show.figures.style import canvas
from flexstage.show.plan import plan_figure
from flexstage.show.scene.pictures import stage_picture
from flexstage.show.scene.raster import nearest, normals, planes, visible_lines
from flexstage.show.scene.skin import DrawnSurface, Kind, extrude, loft, pierce, rectangle
from flexstage.show.scene.stage import scene
from flexstage.show.scene.view import Side, fit, pixels, view, write
from flexstage.show.viewer.data import still_data
from flexstage.spatial.frame import Frame
from flexstage.spatial.rotation import exponential
from tests.conftest import examples
from tests.show.stages import NAMES, analysed, seldom

UNIT = st.floats(-1.0, 1.0, allow_nan=False)
VECTOR = st.tuples(UNIT, UNIT, UNIT).map(np.array)
SIZES = st.tuples(*[st.floats(0.1, 0.6)] * 3)


def box(centre: Array, size: tuple[float, float, float], turn: Array) -> DrawnSurface:
    rings = extrude(0.5 * size[0] * np.array([-1.0, 1.0]), [rectangle(size[1], size[2])] * 2)
    return loft(rings).placed(Frame(exponential(turn), centre))


BOXES = st.lists(st.tuples(VECTOR, SIZES, VECTOR).map(lambda item: box(*item)), min_size=1, max_size=5)


def volume(skin: DrawnSurface) -> float:
    a, b, c = skin.points[skin.triangles].transpose(1, 0, 2)
    return float(np.sum(a * np.cross(b, c)) / 6.0)


def flux(skin: DrawnSurface) -> Array:
    a, b, c = skin.points[skin.triangles].transpose(1, 0, 2)
    return 0.5 * np.sum(np.cross(b - a, c - a), axis=0)


@examples(12)
@given(BOXES)
def test_the_nearest_triangle_is_the_one_that_a_ray_meets_first(boxes: list[DrawnSurface]) -> None:
    """Of all pixels whose ray does not pass within a hair of an edge."""
    shape = (24, 32)
    corners = np.concatenate([skin.points[skin.triangles] for skin in boxes]) * [10.0, 10.0, 10.0] + [16.0, 12.0, 0.0]
    found, depth = nearest(corners, shape)
    row, column = np.indices(shape) + 0.5
    ray = np.stack([column, row], axis=-1)[..., None, :]
    here, after = corners[..., :2], np.roll(corners, -1, axis=1)[..., :2]
    side = [
        (after[:, k, 0] - here[:, k, 0]) * (ray[..., 1] - here[:, k, 1]) - (after[:, k, 1] - here[:, k, 1]) * (ray[..., 0] - here[:, k, 0])
        for k in range(3)
    ]
    inside = np.all(np.array(side) > 0.0, axis=0) | np.all(np.array(side) < 0.0, axis=0)
    clear = np.all(np.abs(side) > 1e-3, axis=(0, -1))
    across, down, level = planes(corners, corners[..., 2]).T
    met = np.where(inside, across * column[..., None] + down * row[..., None] + level, -np.inf).max(axis=-1)
    assert np.array_equal(np.isfinite(met)[clear], (found >= 0)[clear])
    seen = clear & (found >= 0)
    assert np.allclose(depth[seen], met[seen], rtol=0.0, atol=1e-3)


@examples(12)
@given(BOXES)
def test_solids_are_closed_and_face_outward(boxes: list[DrawnSurface]) -> None:
    for skin in boxes:
        assert np.linalg.norm(flux(skin)) < 1e-9
        assert volume(skin) > 0.0
        towards = normals(skin.points[skin.triangles] * [1.0, -1.0, 1.0])
        middle = skin.points[skin.triangles].mean(axis=1) - skin.points.mean(axis=0)
        assert np.all(np.sum(towards * middle, axis=1) > 0.0)


def test_a_pierced_prism_has_the_volume_that_is_left() -> None:
    bottom = np.column_stack([rectangle(2.0, 3.0), np.zeros(4)])
    both = bottom + np.array([0.0, 0.5])[:, None, None] * [0.0, 0.0, 1.0]
    skin = pierce(both, both * [0.5, 0.5, 1.0])
    assert volume(skin) == pytest.approx(0.75 * 3.0)
    assert np.linalg.norm(flux(skin)) < 1e-12
    assert len(skin.edges) == 4 * 4 + 2 * 4


def test_lines_behind_a_face_are_hidden_and_those_on_it_are_not() -> None:
    depth = np.full((9, 9), 5.0)
    for level, shown in ((5.0, 9), (4.5, 9), (2.0, 0), (7.0, 9)):
        assert visible_lines(np.array([[[0.5, 4.5, level], [8.5, 4.5, level]]]), depth).sum() == shown


def image_of(data: object, side: Side = Side.TOP) -> Array:
    (image,) = stage_picture(data, side=side, names=False).axes[0].images  # type: ignore[arg-type]
    return np.asarray(image.get_array())


def test_the_platform_is_seen_through_and_nothing_is_seen_beside_the_stage() -> None:
    image = image_of(still_data(double_triangle()))
    assert not image[0, 0].any()
    opacity = set(np.unique(image[..., 3]).tolist())
    assert opacity == {0, 107, 255}  # nothing, the platform alone (0.42), all else


@pytest.mark.parametrize("side", Side)
def test_pixels_are_where_the_axes_have_them(side: Side) -> None:
    seen, axes = view(side), fit(canvas(3.0, 2.0).add_axes((0.0, 0.0, 1.0, 1.0)), np.array([-5.0, -5.0]), np.array([5.0, 5.0]))
    points = np.random.default_rng(3).uniform(-4e-3, 4e-3, (7, 3))
    places, (height, width) = pixels(axes, points, seen)
    shares = axes.transAxes.inverted().transform(axes.transData.transform(seen.project(points)))
    assert np.allclose(places[:, :2] / [width, height], shares * [1.0, -1.0] + [0.0, 1.0])
    assert np.allclose(seen.axes @ seen.axes.T, np.eye(3))


@pytest.mark.parametrize("name", [seldom(name) for name in NAMES])
def test_every_link_body_and_gauge_is_seen(name: str) -> None:
    from flexstage.mechanism.assembly.expand import expand

    mechanism = analysed(name).mechanism
    assembly = expand(mechanism)
    names = {piece.name for piece in scene(mechanism).pieces}
    assert set(assembly.links) <= names
    assert set(assembly.gauges) <= names
    assert {address for placed in assembly.bodies.values() for address in placed.solids} <= names
    assert {label.text for label in scene(mechanism).labels} == {*assembly.actuators, *assembly.gauges}


@pytest.mark.parametrize("name", ["voice-coil-xy", "tip-tilt", "steering-mirror"])
def test_links_stand_on_the_ground_where_they_begin(name: str) -> None:
    from flexstage.mechanism.assembly.expand import expand

    mechanism = case(name)
    feet = {piece.name: piece.skin.points for piece in scene(mechanism).pieces if piece.name.endswith(" foot")}
    on_ground = {name: link for name, link in expand(mechanism).links.items() if link.joins[0] == GROUND}
    assert on_ground
    for link_name, link in on_ground.items():
        middle = feet[f"{link_name} foot"].mean(axis=0)
        assert (middle - link.frame.position) @ link.frame.rotation[:, 0] <= 1e-12


def test_massless_bodies_are_bars_between_their_joints() -> None:
    names = {piece.name for piece in scene(double_triangle(SM_REF_A)).pieces if piece.kind is Kind.BODY}
    assert "B4/lever" in names
    assert "B4/pole" in names


def test_the_plan_carries_its_dimensions() -> None:
    mechanism = double_triangle()
    texts = {text.get_text() for axes in plan_figure(mechanism, still_data(mechanism)).axes for text in axes.texts}
    assert {"R 85", "R 120", "R 130", "340.64", "90°", "−90°", "envelope 380 × 380", "clear opening 110 × 110", "B1", "S6"} <= texts


@pytest.mark.parametrize("inches", [2.0, 7.0])
def test_names_cover_no_other_names(inches: float) -> None:
    """Boxes of names as they are drawn, in a narrow picture and in a wide one."""
    drawn, seen, figure = scene(double_triangle()), view(Side.ISOMETRIC), canvas(inches, inches)
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set(xlim=(-200.0, 200.0), ylim=(-200.0, 200.0), aspect="equal")
    write(axes, drawn.labels, seen)
    boxes = [text.get_window_extent() for text in axes.texts]
    assert len(boxes) == 12
    assert not [pair for pair in combinations(boxes, 2) if pair[0].overlaps(pair[1])]
