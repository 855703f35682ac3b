"""The report of a stack's test: one HTML file that stands alone."""

from __future__ import annotations

from flexstage.base.version import __version__
from flexstage.control.hysteresis.show.figures import stack_figure
from flexstage.control.hysteresis.show.tables import stack_tables
from flexstage.control.hysteresis.stack_test import StackTest
from flexstage.show.display import percent
from flexstage.show.figures.export import to_svg
from flexstage.show.page import Head, Headline, Picture, Prose, page, section
from flexstage.show.tables.caveats import warning_table

_METHOD = (
    "A generalised Prandtl-Ishlinskii model: plays of fixed thresholds, weights of 0 or more by least squares, a monotone envelope of the "
    "volts before them. Its size is the smallest whose error on parts of the record kept from the fit is within 5 % of the best. Samples "
    "from before the plays are known are left out. The inverse is exact; how far its volts are from those applied is the model's error."
)


def hysteresis_report(test: StackTest) -> str:
    """A stack's test as a page of HTML: loops with the model, its error, the inverse, tables.

    >>> from flexstage.control.hysteresis.example import example_test
    >>> hysteresis_report(example_test())[:15]
    '<!doctype html>'
    """
    drawn = to_svg(stack_figure(test), "stack", "Loops of the stack with the model, the model's error, and the volts of the inverse")
    caption = "Grey the record, blue the model and its error; green the volts that the inverse gives for the recorded strokes."
    stack, plays = stack_tables(test)
    sections = [
        section("Hysteresis", [Picture(drawn, caption), stack, Prose(_METHOD)]),
        section("Warnings", [warning_table(test.hysteresis.warnings)]),
        section("Model", [plays]),
    ]
    named = test.source or "record"
    origin = (("record", named), ("model", "measured"), ("flexstage", __version__))
    width, error = (percent(each, 3) for each in (test.hysteresis.width, test.hysteresis.rms))
    said = Headline(f"Loops are {width} of the stroke wide; the model follows them to {error}, rms.")
    return page(Head(named, "Hysteresis of a stack", origin, said), sections)
