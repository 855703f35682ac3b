"""Body of the document of a stack's test."""

from __future__ import annotations

from flexstage.base.document import Document
from flexstage.control.hysteresis.stack_test import StackTest


def hysteresis_body(test: StackTest) -> Document:
    """What was recorded, the model with its errors, the sizes that were tried, creep where a step was recorded.

    >>> from flexstage.control.hysteresis.example import example_test
    >>> hysteresis_body(example_test())["range_v"]
    [0.0, 1000.0]
    """
    creep = test.creep
    return {
        "source": test.source,
        "channels": {name: channel.name for name, channel in zip(("volts", "stroke"), test.channels, strict=True)},
        **test.found.to_json(),
        "inverse_rms": test.undone_rms,
        "creep": None
        if creep is None
        else {
            "rate_per_decade": creep.law.rate,
            "reference_s": creep.law.reference,
            "stroke_m": creep.stroke,
            "span_s": list(creep.span),
            "rms": creep.rms,
        },
    }
