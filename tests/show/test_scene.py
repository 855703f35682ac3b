"""The scene: depth order against ray casting, areas kept by cuts, hidden pieces hidden, motions rigid."""

from __future__ import annotations

import re
from itertools import combinations, pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from flexstage.base.number import Array
from flexstage.cases.double_triangle import SM_REF_A, double_triangle
from flexstage.cases.registry import case
from flexstage.mechanism.addresses.address import get, set_value
from flexstage.mechanism.mechanism import GROUND
from flexstage.show.figures.style import canvas
from flexstage.show.plan import plan_figure, plan_picture
from flexstage.show.scene.facet import Facet, Kind, Paint, extrude, loft, rectangle
from flexstage.show.scene.hidden import are_visible
from flexstage.show.scene.inner import outer
from flexstage.show.scene.order import partition, sort_by_depth
from flexstage.show.scene.stage import displace, largest_motion, scene
from flexstage.show.scene.view import Side, order_facets, rejoin, view, write
from flexstage.spatial.rotation import exponential
from tests.conftest import examples
from tests.show.stages import NAMES, analysed, seldom

UNIT = st.floats(-1.0, 1.0, allow_nan=False)
VECTOR = st.tuples(UNIT, UNIT, UNIT).map(np.array)
SIZES = st.tuples(*[st.floats(0.1, 0.6)] * 3)


def box(centre: Array, size: tuple[float, float, float], turn: Array, name: str) -> list[Facet]:
    rings = extrude(0.5 * size[0] * np.array([-1.0, 1.0]), [rectangle(size[1], size[2])] * 2)
    return loft(rings @ exponential(turn).T + centre, Paint(Kind.BODY, (name, name), name))


BOXES = st.lists(st.tuples(VECTOR, SIZES, VECTOR), min_size=1, max_size=5).map(
    lambda items: [facet for number, item in enumerate(items) for facet in box(*item, str(number))]
)


def area(facet: Facet) -> float:
    arms = facet.points - facet.points[0]
    return 0.5 * float(np.linalg.norm(np.cross(arms[1:-1], arms[2:]).sum(axis=0)))


def covers(facet: Facet, eye: Array, ray: Array) -> bool:
    """Whether the line through `ray` along `eye` meets the inside of a facet, away from its edges."""
    after = np.roll(facet.points, -1, axis=0)
    sides = np.array([np.cross(b - a, ray - a) @ eye for a, b in zip(facet.points, after, strict=True)])
    return bool(np.all(sides > 1e-6) or np.all(sides < -1e-6))


def depth(facet: Facet, eye: Array, ray: Array) -> float:
    return float((facet.points[0] - ray) @ facet.normal / (eye @ facet.normal))


@examples(18, 600)
@given(BOXES, VECTOR.filter(lambda eye: np.linalg.norm(eye) > 0.1), VECTOR)
def test_depth_order_agrees_with_ray_casting(facets: list[Facet], eye: Array, ray: Array) -> None:
    """Of facets that face the eye: no others are drawn."""
    eye = eye / np.linalg.norm(eye)
    pieces = list(sort_by_depth(partition(facets, 2.0), eye))
    met = [piece for piece in pieces if piece.normal @ eye > 1e-3 and covers(piece, eye, ray)]
    depths = [depth(piece, eye, ray) for piece in met]
    assert all(later >= earlier - 1e-6 for earlier, later in pairwise(depths))


@examples(18, 600)
@given(BOXES)
def test_cuts_keep_areas(facets: list[Facet]) -> None:
    pieces = list(sort_by_depth(partition(facets, 2.0), np.array([0.0, 0.0, 1.0])))
    for facet in facets:
        own = [area(piece) for piece in pieces if piece is facet or piece.whole is facet]
        assert sum(own) == pytest.approx(area(facet), rel=1e-9)


@examples(18, 600)
@given(BOXES)
def test_solids_are_closed_and_face_outward(facets: list[Facet]) -> None:
    for name in {facet.paint.name for facet in facets}:
        own = [facet for facet in facets if facet.paint.name == name]
        total = sum(area(facet) * facet.normal for facet in own)
        assert np.linalg.norm(total) < 1e-9
        volume = sum(area(facet) * float(facet.normal @ facet.points[0]) for facet in own) / 3.0
        assert volume > 0.0


def painted(polygons: list[Array], shown: list[bool]) -> Array:
    """Index of the last polygon drawn at points of a raster that lies between that of `are_visible`."""
    x, y = np.meshgrid(np.linspace(-0.93, 0.91, 71), np.linspace(-0.92, 0.94, 73))
    result = np.full(x.shape, -1)
    for index, polygon in enumerate(polygons):
        if shown[index]:
            inside = np.ones(x.shape, dtype=bool)
            for a, b in zip(polygon, np.roll(polygon, -1, axis=0), strict=True):
                inside &= (b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0]) >= 0.0
            result[inside] = index
    return result


def _box(name: str, low: tuple[float, float, float], high: tuple[float, float, float]) -> list[Facet]:
    corners = 0.5 * (np.array(low) + high) + extrude(np.array([-0.5, 0.5]), [rectangle(1.0, 1.0)] * 2) * (np.array(high) - low)
    return loft(corners, Paint(Kind.PLATFORM, ("platform", "platform"), name))


def test_faces_between_outlines_of_a_body_are_left_out() -> None:
    """Of a plate with a smaller lug below and a strip along a part of its side, twice the two contacts; the skin stays closed."""
    plate, lug = _box("plate", (0, 0, 0), (6, 4, 1)), _box("lug", (1, 1, -2), (3, 2, 0))
    strip, apart = _box("strip", (2, 4, 0), (7, 5, 1)), _box("apart", (0, 0, 2), (6, 4, 3))  # the strip stands over the plate's end
    everything = plate + lug + strip + apart
    skin = outer(everything)
    assert sum(map(area, everything)) - sum(map(area, skin)) == pytest.approx(2.0 * (2.0 * 1.0 + 4.0 * 1.0))
    flux = sum(float((f.points[0] @ f.normal) * area(f)) for f in skin) / 3.0
    assert flux == pytest.approx(6 * 4 * 1 + 2 * 1 * 2 + 5 * 1 * 1 + 6 * 4 * 1)
    assert outer(plate + apart) == plate + apart


@examples(18, 600)
@given(st.lists(st.tuples(UNIT, UNIT, st.floats(0.05, 0.8), st.floats(0.05, 0.8)), min_size=1, max_size=9))
def test_hidden_pieces_do_not_show(items: list[tuple[float, float, float, float]]) -> None:
    polygons = [np.array([x, y]) + rectangle(width, height) for x, y, width, height in items]
    shown = are_visible(polygons, [True] * len(polygons))
    whole, less = painted(polygons, [True] * len(polygons)), painted(polygons, shown)
    # The raster decides within its pitch: what it drops may show by less than that, at an edge.
    assert np.mean(whole != less) < 0.01


def test_translucent_pieces_are_made_whole_only_where_nothing_stands_before_them() -> None:
    plate = loft(np.array([0.0, 0.1])[:, None, None] * [0.0, 0.0, 1.0] + _square(1.0), Paint(Kind.PLATFORM, ("p", "p"), "p"))
    below = loft(np.array([-1.0, -0.5])[:, None, None] * [0.0, 0.0, 1.0] + _square(0.2), Paint(Kind.BODY, ("b", "b"), "b"))
    above = loft(np.array([0.5, 0.6])[:, None, None] * [0.0, 0.0, 1.0] + _square(0.2), Paint(Kind.BODY, ("a", "a"), "a"))
    seen = view(Side.TOP)
    for solids, last in ((below, "p"), (above, "a")):
        order = sort_by_depth(partition([*plate, *solids], 2.0), seen.axes[2])
        facing = [facet for facet in order if facet.normal[2] > 0.5]
        assert rejoin(facing, seen)[-1].paint.name == last


def _square(size: float) -> Array:
    return np.column_stack([rectangle(size, size), np.zeros(4)])


@pytest.mark.parametrize("name", [seldom(name) for name in NAMES])
def test_a_stage_moved_as_one_keeps_its_shape(name: str) -> None:
    still = scene(analysed(name).mechanism)
    turn = np.array([0.2, -0.1, 0.3])
    twists = {body: np.concatenate([np.cross(turn, reference), turn]) for body, reference in still.references.items()}
    moving = [facet for facet in still.facets if set(facet.paint.carriers) <= set(twists)]
    moved = displace(moving, still, twists, 1e-3)
    for before, after in zip(moving, moved, strict=True):
        assert np.allclose(after.points - before.points, 1e-3 * np.cross(turn, before.points), atol=1e-15)
    assert largest_motion(still, twists) > 0.0


@pytest.mark.parametrize("name", [seldom(name) for name in NAMES])
def test_every_link_body_and_gauge_is_seen(name: str) -> None:
    from flexstage.mechanism.assembly.expand import expand

    mechanism = analysed(name).mechanism
    assembly = expand(mechanism)
    names = {facet.paint.name for facet in scene(mechanism).facets}
    assert set(assembly.links) <= names
    assert set(assembly.gauges) <= names
    assert {address for placed in assembly.bodies.values() for address in placed.solids} <= names
    assert {label.text for label in scene(mechanism).labels} == {*assembly.actuators, *assembly.gauges}


@pytest.mark.parametrize("name", ["voice-coil-xy", "tip-tilt", "steering-mirror"])
def test_links_stand_on_the_ground_where_they_begin(name: str) -> None:
    from flexstage.mechanism.assembly.expand import expand

    mechanism = case(name)
    feet = {facet.paint.name: facet.points for facet in scene(mechanism).facets if facet.paint.name.endswith(" foot")}
    on_ground = {name: link for name, link in expand(mechanism).links.items() if link.joins[0] == GROUND}
    assert on_ground
    for link_name, link in on_ground.items():
        middle = feet[f"{link_name} foot"].mean(axis=0)
        assert (middle - link.frame.position) @ link.frame.rotation[:, 0] <= 1e-12


def test_massless_bodies_are_bars_between_their_joints() -> None:
    names = {facet.paint.name for facet in scene(double_triangle(SM_REF_A)).facets if facet.paint.kind is Kind.BODY}
    assert "B4/lever" in names
    assert "B4/pole" in names


@pytest.mark.parametrize("side", Side)
def test_only_facets_that_face_the_viewer_are_drawn(side: Side) -> None:
    seen = view(side)
    assert np.allclose(seen.axes @ seen.axes.T, np.eye(3))
    facets = order_facets(scene(double_triangle()), seen)
    assert facets
    assert all(len(facet.points) == 2 or facet.normal @ seen.axes[2] > 0.0 for facet in facets)


@pytest.mark.parametrize("side", [Side.TOP, Side.ISOMETRIC])
def test_stages_of_very_many_parts_show_the_outline_of_each(side: Side, monkeypatch: pytest.MonkeyPatch) -> None:
    """It covers all facets of its solid in the picture, its corners are corners of those, and the farthest come first."""
    seen, drawn = view(side), scene(double_triangle())
    assert not drawn.is_large
    monkeypatch.setattr("flexstage.show.scene.stage.ORDERED", 100)
    areas = [facet for facet in order_facets(drawn, seen) if len(facet.points) > 2]
    solids: dict[str, list[Array]] = {}
    for facet in drawn.facets:
        if len(facet.points) > 2:
            solids.setdefault(facet.paint.name, []).append(facet.points)
    assert sorted(facet.paint.name for facet in areas) == sorted(solids)
    for facet in areas:
        points, corners = (seen.project(each) for each in (np.concatenate(solids[facet.paint.name]), facet.points))
        sides = np.roll(corners, -1, axis=0) - corners
        beside = sides[:, :1] * (points[None, :, 1] - corners[:, 1:]) - sides[:, 1:] * (points[None, :, 0] - corners[:, :1])
        assert np.all(beside >= -1e-5 * np.sqrt(np.sum(sides**2, axis=1))[:, None])
        assert all(np.min(np.sum((points - corner) ** 2, axis=1)) < 1e-20 for corner in corners)
    depths = [facet.points.mean(axis=0) @ seen.axes[2] for facet in areas if facet.paint.kind is not Kind.PLATFORM]
    assert depths == sorted(depths)


def test_the_plan_carries_its_dimensions() -> None:
    """As a file of its own and in a page."""
    mechanism = double_triangle()
    texts = {text.get_text() for axes in plan_figure(mechanism, scene(mechanism)).axes for text in axes.texts}
    assert set(re.findall(r"<text[^>]*>([^<]+)<", plan_picture(mechanism, scene(mechanism)).svg("plan", "plan"))) == texts - {""}
    assert {"R 85", "R 120", "R 130", "340.64", "90°", "−90°", "envelope 380 × 380", "clear opening 110 × 110", "B1", "S6"} <= texts


def test_bodies_that_stand_as_they_did_are_not_built_anew():
    """Facets of bodies are those of the last design where only a hinge changed, and others where an outline did."""

    def built(stage):
        return [facet for facet in scene(stage).facets if facet.paint.kind in {Kind.BODY, Kind.PLATFORM}]

    stage = double_triangle()
    changed = ("parts.neck.thickness", "bodies.platform.solids.plate.size.z")
    before, hinged, grown = built(stage), *(built(set_value(stage, where, 1.01 * get(stage, where))) for where in changed)
    assert all(one is other for one, other in zip(before, hinged, strict=True))
    known = {id(facet): facet.paint.kind for facet in before}
    assert {known.get(id(facet)) for facet in grown} == {Kind.BODY, None}


@pytest.mark.parametrize("inches", [2.0, 7.0])
def test_names_cover_no_other_names(inches):
    """Boxes of names as they are drawn, in a narrow picture and in a wide one."""
    drawn, seen, figure = scene(double_triangle()), view(Side.ISOMETRIC), canvas(inches, inches)
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set(xlim=(-200.0, 200.0), ylim=(-200.0, 200.0), aspect="equal")
    write(axes, drawn.labels, seen)
    boxes = [text.get_window_extent() for text in axes.texts]
    assert len(boxes) == 12
    assert not [pair for pair in combinations(boxes, 2) if pair[0].overlaps(pair[1])]
