"""The whole controller as C where legs have force feedback: the pose every so many samples, the legs in each of them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from flexstage.control.damping.sampled import SampledLegs
from flexstage.control.export.code.code import Code, statements
from flexstage.control.export.code.controller import clamp, has_range, has_slew, has_volts
from flexstage.control.export.code.program import Program, Signal, State
from flexstage.control.export.code.text import indent, number, table
from flexstage.control.simulation.machine import Machine
from flexstage.models.linear.model import Channel

_LARGEST = number(np.finfo(float).max)
_STATUS = "for each tension: 0 taken; 1 it is no finite number, the last good one is held"


def with_legs(outer: Program, given: Machine, legs: SampledLegs) -> Program:
    """A controller's program with the inner loops in it, stepped every `legs.step`; what it tells of the pose stays in between.

    Further inputs are the `tension.<actuator>` [N]; further outputs what is `added` by the inner loops, the `total` stroke within the
    amplifiers' limits (`volts`, where they are told, are its), and what became of each tension.
    """
    strokes = {channel.name: channel for channel in given.strokes()}
    own = [strokes[name] for name in legs.actuators]
    return replace(
        outer,
        about=(
            *(line.replace(f"One call of the step every {outer.step:.12g} s", "Loop of the pose") for line in outer.about),
            _about(legs),
        ),
        step=legs.step,
        inputs=(*outer.inputs, Signal("tension", tuple(Channel(f"tension.{each.name}", "N") for each in own), "tensions of the legs")),
        outputs=(
            *outer.outputs,
            Signal("added", tuple(Channel(f"added.{each.name}", each.unit) for each in own), "added by force feedback"),
            Signal("total", given.strokes("total."), "strokes of both loops, within what the amplifiers give"),
            Signal("tension_status", tuple(Channel(f"status.tension.{each.name}", "1") for each in own), _STATUS),
        ),
        states=(*outer.states, *_states(outer, legs, len(given.actuators))),
        code=Code(outer.code.tables) + _tables(given, legs) + _sample(outer, given, legs),
    )


def _period(step: float) -> str:
    return f"One call of the step every {step:.12g} s"


def _about(legs: SampledLegs) -> str:
    first = f"of {legs.turns} the first runs the loop of the pose, every {legs.turns * legs.step:.12g} s, from the readings of then"
    return (
        f"{_period(legs.step)}: {first}; all run force feedback in the legs of {', '.join(legs.actuators)}. "
        "Tension counts positive; total is what the amplifiers shall give."
    )


def _states(outer: Program, legs: SampledLegs, actuators: int) -> tuple[State, ...]:
    count = len(legs.actuators)
    inner = (
        State("turn", (1,)),
        State("tension", (count,)),
        State("slow", (count,)),
        State("slower", (count,)),
        State("total", (actuators,)),
    )
    return (*inner, *(State(f"held_{each.field}", (len(each.channels),)) for each in outer.outputs))


def _tables(given: Machine, legs: SampledLegs) -> Code:
    lines = table("leg", legs.gains)
    lines += table("quick", given.amplifiers.slew * legs.step) if has_slew(given) else []
    return Code(tuple(lines))


def _sample(outer: Program, given: Machine, legs: SampledLegs) -> Code:
    keeps = [(each.field, len(each.channels)) for each in outer.outputs]
    places = [given.actuators.index(name) for name in legs.actuators]
    return statements(
        "int j;",
        "if (state->turn[0] == 0.0) {",
        *indent(outer.code.body),
        *(f"    for (j = 0; j < {size}; j++) state->held_{field}[j] = out->{field}[j];" for field, size in keeps),
        "} else {",
        *(f"    for (j = 0; j < {size}; j++) out->{field}[j] = state->held_{field}[j];" for field, size in keeps),
        "}",
        f"state->turn[0] = state->turn[0] + 1.0 < {number(legs.turns)} ? state->turn[0] + 1.0 : 0.0;",
        f"for (j = 0; j < {len(places)}; j++) {{",
        *indent(_one_leg(legs)),
        "}",
        f"for (j = 0; j < {len(given.actuators)}; j++) out->total[j] = out->given[j];",
        *(f"out->total[{place}] += out->added[{leg}];" for leg, place in enumerate(places)),
        f"for (j = 0; j < {len(given.actuators)}; j++) {{",
        *indent(_total(given)),
        "}",
    )


def _one_leg(legs: SampledLegs) -> list[str]:
    return [
        "double entry, slow;",
        f"out->tension_status[j] = fabs(in->tension[j]) <= {_LARGEST} ? 0.0 : 1.0;",
        f"if (fabs(in->tension[j]) <= {_LARGEST}) state->tension[j] = in->tension[j];",
        *law_lines(legs, "out->added[j]", "leg[j]", "j"),
    ]


def law_lines(legs: SampledLegs, target: str, gain: str, place: str) -> list[str]:
    """Statements of a leg's law, with `entry` and `slow` declared: to a target from `state->tension`, on with `state->slow` and `slower`.

    >>> law_lines(SampledLegs(("B",), np.ones(1), 0.25, 1, 1e-4, 1), "y", "g", "0")[0]
    'entry = 0.25 * g * state->tension[0];'
    """
    share, twice = number(legs.share), number(2.0 * legs.share)
    lines = [
        f"entry = {share} * {gain} * state->tension[{place}];",
        f"slow = entry + state->slow[{place}];",
        f"state->slow[{place}] = entry + slow - {twice} * slow;",
        f"{target} = slow;",
    ]
    if legs.order == 1:
        return lines
    return [
        *lines,
        f"entry = {share} * slow;",
        f"slow = entry + state->slower[{place}];",
        f"state->slower[{place}] = entry + slow - {twice} * slow;",
        f"{target} -= slow;",
    ]


def _total(given: Machine) -> list[str]:
    lines = ["double stroke = out->total[j];", f"if (!(fabs(stroke) <= {_LARGEST})) stroke = state->total[j];"]
    lines += clamp("high[j]", "low[j]") if has_range(given) else []
    lines += clamp("state->total[j] + quick[j]", "state->total[j] - quick[j]") if has_slew(given) else []
    lines.append("out->total[j] = state->total[j] = stroke;")
    return [*lines, *(["out->volts[j] += (stroke - out->given[j]) / gain[j];"] if has_volts(given) else [])]
