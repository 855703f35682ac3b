"""Report sections with pictures of the stage: animated, from three sides, and as a dimensioned plan."""

from __future__ import annotations

from collections.abc import Sequence

from flexstage.mechanism.mechanism import Mechanism
from flexstage.show.figures.export import to_svg
from flexstage.show.page import BlockRow, JoinedViewers, Legend, Picture, Prose, Section, Viewer, fold, section
from flexstage.show.plan import plan_figure, rings
from flexstage.show.scene.pictures import stage_picture
from flexstage.show.scene.view import Side, legend
from flexstage.show.tables.description import composition_table, link_table
from flexstage.show.viewer.data import StageData
from flexstage.show.viewer.motions import PLATFORM_MODE, Group, Motion

_WIDTH = 4.4
_SIDES = (
    (Side.TOP, "top", "From above."),
    (Side.FRONT, "front", "From the front, along +y."),
    (Side.RIGHT, "right", "From the right, along −x."),
)


def stage_section(data: StageData, *, motion: str | None = None, said: str = "") -> Section | None:
    """Make the section of the animated stage, which is named "stage" in the page.

    The animation starts with `motion`, by default the `first_motion` of the data. `said` is the text below the stage.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.show.viewer.data import still_data
    >>> stage_section(still_data(double_triangle())).title
    'The stage'
    """
    caption = "The platform is translucent. A thin line connects a hinge to its body if the outline of the body does not reach the hinge."
    picture = Picture(to_svg(stage_picture(data), "corner", "The stage from above its front corner"), caption)
    viewer = Viewer("stage", (picture,), first_motion(data) if motion is None else motion)
    return section("The stage", [viewer, Legend(legend(data)), Prose(said) if said else None])


def platform_modes(data: StageData) -> tuple[Motion, ...]:
    """Return the motions that are modes of the platform, by ascending frequency.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.show.viewer.data import stage_data
    >>> [each.name for each in platform_modes(stage_data(double_triangle()))]
    ['1', '2', '3', '4', '5', '6']
    """
    return tuple(each for each in data.motions if each.group is Group.MODE and each.remark.startswith(PLATFORM_MODE))


def joined_viewers(partners: Sequence[tuple[str, str]]) -> JoinedViewers | None:
    """Make two viewers of the stage with paired motions, starting with the first pair; `None` without pairs.

    >>> joined_viewers([]) is None
    True
    """
    if not partners:
        return None
    one, other = partners[0]
    return JoinedViewers((Viewer("stage", (), one), Viewer("stage", (), other)), tuple(partners))


def first_motion(data: StageData) -> str:
    """Return the motion that a viewer shows first: the platform's lowest mode, else the first mode or motion, else an empty string.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.show.viewer.data import stage_data
    >>> first_motion(stage_data(double_triangle()))
    'mode 1'
    """
    ranked = sorted(data.motions, key=lambda each: (each.group is not Group.MODE, not each.remark.startswith(PLATFORM_MODE)))
    return f"{ranked[0].group.value} {ranked[0].name}" if ranked else ""


def drawing_section(mechanism: Mechanism, data: StageData) -> Section | None:
    """Make the section of drawings: the stage from three sides, the dimensioned plan, and the list of parts.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.show.viewer.data import still_data
    >>> drawing_section(double_triangle(), still_data(double_triangle())).title
    'Drawings and composition'
    """
    first, *others = (
        Picture(to_svg(stage_picture(data, side=side, width=_WIDTH, names=side is Side.TOP), name, caption), caption)
        for side, name, caption in _SIDES
    )
    plan = to_svg(plan_figure(mechanism, data), "plan", "Dimensioned plan of the stage")
    return section(
        "Drawings and composition",
        [
            BlockRow((first, BlockRow(tuple(others)))),
            Picture(plan, " ".join(["Plan, dimensions in mm.", *_ring_texts(mechanism)])),
            composition_table(mechanism),
            fold("Links in the design file", link_table(mechanism)),
        ],
    )


def _ring_texts(mechanism: Mechanism) -> list[str]:
    """Radii and angles of the units and gauges on circles."""
    result: list[str] = []
    for ring in rings(mechanism):
        names = " to ".join(dict.fromkeys((*ring.names[:1], *ring.names[-1:])))
        step = f", every {ring.step:g}°" if len(ring.names) > 1 else ""
        result.append(f"{names}: radius {ring.radius:g} mm, first at {ring.first:g}°{step}.")
    return result
