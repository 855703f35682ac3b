"""The report of the answers to a specification: a self-contained HTML file."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from flexstage.base.version import __version__
from flexstage.show.figures.export import to_svg
from flexstage.show.figures.style import FULL, SERIES, Margins, canvas, panels, style_context
from flexstage.show.page import Block, BlockRow, Head, Headline, Picture, page, section
from flexstage.show.scene.pictures import stage_picture
from flexstage.show.table import result_table
from flexstage.show.viewer.data import still_data
from flexstage.studies.synthesis.answers import Answers, joint_front
from flexstage.studies.synthesis.search import Answer, FrontPoint
from flexstage.studies.synthesis.show.tables import answer_tables

_BOUND = "Frequency and width of the designs. Dashed lines: bound of the frequency for any mechanism with these actuators and this payload."


def answer_report(found: Answers) -> str:
    """Write the answers as an HTML page: tables, frequencies below their bounds, a picture of each stage.

    >>> from flexstage.studies.synthesis.specification import example
    >>> "No stage meets" in answer_report(Answers(example(), (), (), ()))
    True
    """
    tables = list(answer_tables(found))
    points = joint_front(found)
    excluded = tables[2:] if points else tables[1:]
    bounded = [(each, each.efficiency) for each in found.answers if each.efficiency]
    caption = "frequency and width of the designs found"
    picture = Picture(to_svg(bound_figure(bounded), "bound", caption), _BOUND) if bounded else None
    fronts = list[Any]()
    if points:
        fronts = [tables[1], Picture(to_svg(front_figure(found, points), "front", "front of both goals"), "Front of both goals.")]
    stages = [BlockRow(tuple(_stage_blocks(each, number))) for number, each in enumerate(found.answers, 1)]
    count = len(found.answers)
    said = Headline(f"{count} stage{'' if count == 1 else 's'} meet{'s' if count == 1 else ''} the specification.", count > 0)
    sections = [
        section("Answers", [tables[0], picture]),
        section("Front", fronts),
        section("Stages", stages),
        section("Excluded pairs", excluded),
    ]
    head = Head(found.specification.name, "Answers to a specification", (("flexstage", __version__),), said)
    return page(head, [each for each in sections if each is not None])


def bound_figure(answers: list[tuple[Answer, float]]) -> Any:
    """Draw the first frequency of each answer, and the bound of this frequency, against its width. Efficiency is (frequency/bound)^2."""
    with style_context():
        figure = canvas(FULL, 2.9)
        ax = panels(figure, 1, 1, Margins(left=0.75, bottom=0.5, right=0.2))[0, 0]
        for number, (each, efficiency) in enumerate(answers):
            color, width = SERIES[number % len(SERIES)], 1e3 * each.values["envelope.x"]
            ax.plot(width, each.values["frequency.1"], "o", color=color, label=f"{each.architecture}, {each.actuator}")
            ax.axhline(each.values["frequency.1"] / efficiency**0.5, color=color, linewidth=0.8, linestyle="--")
        ax.set_ylim(bottom=0.0)
        ax.set_xlabel("width [mm]")
        ax.set_ylabel("first natural frequency [Hz]")
        ax.legend()
    return figure


def front_figure(found: Answers, points: Sequence[tuple[Answer, FrontPoint]]) -> Any:
    """Draw the designs of the joint front in the plane of both goals, with one colour for each pair."""
    (_, key), (_, second) = found.specification.goal, found.specification.second_goal or ("", "")
    with style_context():
        figure = canvas(FULL, 2.9)
        ax = panels(figure, 1, 1, Margins(left=0.75, bottom=0.5, right=0.2))[0, 0]
        for number, answer in enumerate(dict.fromkeys(answer for answer, _ in points)):
            own = [(point.second, point.goal) for each, point in points if each is answer]
            ax.plot(*zip(*own, strict=True), "o-", color=SERIES[number % len(SERIES)], label=f"{answer.architecture}, {answer.actuator}")
        ax.set_xlabel(f"{second} [{points[0][1].unit}]")
        ax.set_ylabel(f"{key} [{points[0][0].unit}]")
        ax.legend()
    return figure


def _stage_blocks(answer: Answer, number: int) -> Iterator[Block]:
    """The picture of an answer, and the sensitivities of its binding limits."""
    name = f"{number}: {answer.architecture} with {answer.actuator}"
    yield Picture(to_svg(stage_picture(still_data(answer.stage), width=4.4), f"answer{number}", name), f"{name}.")
    if (table := result_table(answer.binding, title=f"Binding limits of {name}")) is not None:
        yield table
