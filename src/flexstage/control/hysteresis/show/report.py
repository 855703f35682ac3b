"""Report of a stack's test: one self-contained HTML file."""

from __future__ import annotations

from flexstage.base.version import __version__
from flexstage.control.hysteresis.show.figures import stack_figure
from flexstage.control.hysteresis.show.tables import stack_tables
from flexstage.control.hysteresis.stack_test import StackTest
from flexstage.show.display import percent
from flexstage.show.page import Head, Headline, Prose, page, picture, section
from flexstage.show.tables.caveats import warning_table

_METHOD = (
    "The generalised Prandtl-Ishlinskii model applies a monotonic envelope to the voltage, then play operators with fixed thresholds and "
    "weights of 0 or more. It is fitted by least squares. The smallest model is used whose cross-validation error is at most 1.05 times "
    "the least. Samples that depend on the unknown history are omitted. The inverse is exact: its voltage error is due to the model error."
)


def hysteresis_report(test: StackTest) -> str:
    """Return the HTML report of a stack's test: loops with the model, model error, inverse model, tables.

    >>> from flexstage.control.hysteresis.example import example_test
    >>> hysteresis_report(example_test())[:15]
    '<!doctype html>'
    """
    description = "Loops of the stack with the model, the model's error, and the voltage of the inverse model"
    caption = "Grey: record. Blue: model and its error. Green: voltage of the inverse model for the recorded strokes."
    stack, plays = stack_tables(test)
    sections = [
        section("Hysteresis", [picture(stack_figure(test), "stack", description, caption), stack, Prose(_METHOD)]),
        section("Warnings", [warning_table(test.hysteresis.warnings)]),
        section("Model", [plays]),
    ]
    named = test.source or "record"
    origin = (("record", named), ("model", "measured"), ("flexstage", __version__))
    width, error = (percent(each, 3) for each in (test.hysteresis.width, test.hysteresis.rms))
    said = Headline(f"The loop width is {width} of the stroke. The rms model error is {error}.")
    return page(Head(named, "Hysteresis of a stack", origin, said), sections)
