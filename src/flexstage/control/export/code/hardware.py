"""A controller as C for a processor of its own: either precision, gains in RAM, enable without a bump, the same bits everywhere."""

from __future__ import annotations

from dataclasses import dataclass

from flexstage.base.finding import refuse
from flexstage.control.controllers.decentralised import Decentralised
from flexstage.control.damping.sampled import SampledLegs
from flexstage.control.export.code.hardware_laws import law_as_c
from flexstage.control.export.code.hardware_legs import LegWriter
from flexstage.control.export.code.hardware_writer import Writer, replay_program
from flexstage.control.export.code.precision import Precision, count_constants, typed
from flexstage.control.export.code.text import identifier, number
from flexstage.control.simulation.machine import Machine
from flexstage.control.simulation.result import Simulated

FLAGS = ("-std=c99", "-O2", "-ffp-contract=off", "-Wall", "-Wextra", "-Wpedantic", "-Werror")
"""How it is to be compiled: without contraction, products and sums round as written."""
NO_INVERSE = ("the inverse of a hysteresis has no form for it", 'Leave "hysteresis" out of compensate, or take --export')


@dataclass(frozen=True)
class Hardware:
    """Texts of the files, and what a step takes: additions and multiplications (`flops`), `state`, `parameters` and `tables` [bytes]."""

    header: str
    source: str
    test: str
    flops: int
    state: int
    parameters: int
    tables: int


def hardware_code(
    given: Machine,
    law: Decentralised | None,
    tested: Simulated,
    *,
    name: str,
    precision: Precision,
    about: str = "",
    legs: SampledLegs | None = None,
) -> Hardware:
    """The controller of a machine as C99 for hardware; `law` where it is one of single loops under PI or PID, whose gains can be changed.

    Any other law is in modal form with fixed gains. `tested` is a simulation of the machine: a test beside the code replays its reference
    and readings and compares the strokes. In the step there is no call of a library and no heap; sums have one order; rounding is to
    nearest, contraction off, subnormals kept: finite inputs give the same bits on every processor of IEEE 754. With `legs` there is a
    second function, `<name>_damp`, for force feedback in samples of its own; the test replays tensions too. Raises `DesignError` for an
    inverse of hysteresis, which has no such form.
    """
    if given.compensation is not None:
        raise refuse("--hardware", *NO_INVERSE)
    core = law_as_c(given, law)
    name = identifier(name)
    inner = None if legs is None else LegWriter(given, legs, name, number(precision.largest))
    writer = Writer(given, core, name, precision, about, inner)
    return Hardware(
        header=typed(writer.header(), precision),
        source=typed(writer.source(), precision),
        test=typed(replay_program(given, tested, name, precision, inner), precision),
        flops=int(writer.flops),
        state=precision.bytes * writer.numbers + 4,
        parameters=precision.bytes * writer.settings + 4,
        tables=precision.bytes * count_constants((*core.tables, *writer.tables())),
    )
