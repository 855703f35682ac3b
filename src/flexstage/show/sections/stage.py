"""The stage in pictures: above the corner, from three sides, and as a dimensioned plan."""

from __future__ import annotations

from collections.abc import Sequence

from flexstage.mechanism.mechanism import Mechanism
from flexstage.show.page import Abreast, Joined, Legend, Picture, Prose, Section, Viewer, fold, section
from flexstage.show.plan import plan_picture, rings
from flexstage.show.scene.pictures import stage_picture
from flexstage.show.scene.stage import Scene, scene
from flexstage.show.scene.view import Side, legend
from flexstage.show.tables.description import composition_table, link_table
from flexstage.show.viewer.data import StageData
from flexstage.show.viewer.motions import PLATFORM_MODE, Group, Motion

_WIDTH = 4.4
_LARGE = "So many parts are drawn by their convex outlines as seen, each before those whose middles lie farther away."
_SIDES = (
    (Side.TOP, "top", "From above."),
    (Side.FRONT, "front", "From the front, along +y."),
    (Side.RIGHT, "right", "From the right, along −x."),
)


def stage_section(seen: Scene, *, motion: str = "", ghost: str = "", said: str = "") -> Section | None:
    """The stage as it is seen first, from its scene: the page's data "stage", beginning with `motion`, and those called `ghost` behind it.

    `said` is what stands below it.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.show.scene.stage import scene
    >>> stage_section(scene(double_triangle())).title
    'The stage'
    """
    corner = stage_picture(seen).svg("corner", "The stage from above its front corner")
    caption = "Rigid bodies as described, the platform translucent; where a hinge lies off the outline of its body, a thin line joins them."
    viewer = Viewer("stage", (Picture(corner, f"{caption} {_LARGE}" if seen.is_large else caption),), motion, ghost)
    return section("The stage", [viewer, Legend(legend(seen)), Prose(said) if said else None])


def turning_section(mechanism: Mechanism, data: StageData) -> Section | None:
    """The stage as it is seen first, beginning with its first motion; `data` are the page's "stage".

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.show.viewer.data import stage_data
    >>> turning_section(double_triangle(), stage_data(double_triangle())).title
    'The stage'
    """
    return stage_section(scene(mechanism), motion=first_motion(data))


def platform_modes(data: StageData) -> tuple[Motion, ...]:
    """The motions that are modes of the platform, ascending.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.show.viewer.data import stage_data
    >>> [each.name for each in platform_modes(stage_data(double_triangle()))]
    ['1', '2', '3', '4', '5', '6']
    """
    return tuple(each for each in data.motions if each.group is Group.MODE and each.remark.startswith(PLATFORM_MODE))


def joined_viewers(partners: Sequence[tuple[str, str]]) -> Joined | None:
    """Two viewers of the stage that play partners of each other, beginning with the first; `None` without any.

    >>> joined_viewers([]) is None
    True
    """
    if not partners:
        return None
    one, other = partners[0]
    return Joined((Viewer("stage", (), one), Viewer("stage", (), other)), tuple(partners))


def first_motion(data: StageData) -> str:
    """The motion that a viewer begins with: the lowest mode of the platform, else what there is, else none.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.show.viewer.data import stage_data
    >>> first_motion(stage_data(double_triangle()))
    'mode 1'
    """
    ranked = sorted(data.motions, key=lambda each: (each.group is not Group.MODE, not each.remark.startswith(PLATFORM_MODE)))
    return f"{ranked[0].group.value} {ranked[0].name}" if ranked else ""


def drawing_section(mechanism: Mechanism, seen: Scene) -> Section | None:
    """The stage from three sides, its plan, and what it consists of; `seen` is its scene.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.show.scene.stage import scene
    >>> drawing_section(double_triangle(), scene(double_triangle())).title
    'Drawings and composition'
    """
    sides = tuple(_side(seen, *each) for each in _SIDES)
    plan = plan_picture(mechanism, seen).svg("plan", "Dimensioned plan of the stage")
    plan_caption = " ".join(["Plan, dimensions in mm.", *_ring_texts(mechanism), *([_LARGE] if seen.is_large else [])])
    return section(
        "Drawings and composition",
        [
            Abreast((sides[0], Abreast(sides[1:]))),
            Picture(plan, plan_caption),
            composition_table(mechanism),
            fold("Links in the design file", link_table(mechanism)),
        ],
    )


def _side(seen: Scene, side: Side, name: str, caption: str) -> Picture:
    return Picture(stage_picture(seen, side=side, width=_WIDTH, names=side is Side.TOP).svg(name, caption), caption)


def _ring_texts(mechanism: Mechanism) -> list[str]:
    """Where the units and gauges on circles stand."""
    result: list[str] = []
    for ring in rings(mechanism):
        names = " to ".join(dict.fromkeys((*ring.names[:1], *ring.names[-1:])))
        step = f", every {ring.step:g}°" if len(ring.names) > 1 else ""
        result.append(f"{names}: radius {ring.radius:g} mm, first at {ring.first:g}°{step}.")
    return result
