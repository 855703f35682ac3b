"""Force feedback in the legs as C: inside a controller stepped at the legs' rate, or as a separate function."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from flexstage.base.number import Array
from flexstage.control.damping.sampled import SampledLegs
from flexstage.control.export.code.controller import LARGEST, bounded, has_volts, limited
from flexstage.control.export.code.precision import Precision
from flexstage.control.export.code.product import Code
from flexstage.control.export.code.program import Program, ProgramFunction, ProgramSetting, Signal, State
from flexstage.control.export.code.text import indent, number, table
from flexstage.control.simulation.machine import Machine
from flexstage.models.linear.model import Channel

_SWEPT, _LARGEST = 200, 1e-6


def with_legs(outer: Program, given: Machine, legs: SampledLegs) -> Program:
    """Add inner loops to a controller program, which is then stepped every `legs.step`. Pose control keeps its own, longer sampling period.

    Further inputs are `tension.<actuator>` [N], positive in tension. The output `added` contains the strokes of force feedback. The output
    `total` contains the total strokes (controller plus force feedback) within the amplifiers' limits; `volts` are the voltages of `total`.
    The last valid value replaces a tension that is not finite, and `tension_status` reports this.
    """
    strokes = {channel.name: channel for channel in given.strokes()}
    own, total = [strokes[name] for name in legs.actuators], given.strokes("total.")
    further = (
        Signal("added", tuple(Channel(f"added.{each.name}", each.unit) for each in own), "strokes added by force feedback"),
        Signal("total", total, "total strokes (controller plus force feedback), within the amplifiers' limits"),
        Signal("tension_status", tuple(Channel(f"status.tension.{each.name}", "1") for each in own), _STATUS),
    )
    before = f"Call the step every {outer.step:.12g} s"
    about = (*(line.replace(before, "Pose loop") for line in outer.about), _about(legs))
    inner = _settings(given, legs)
    tables = [line for each in inner for line in table(each.field, bounded(each, Precision.DOUBLE).values)]
    held = [State(f"held_{each.field}", (len(each.channels),)) for each in outer.outputs]
    return replace(
        outer,
        about=about,
        step=legs.step,
        inputs=(*outer.inputs, Signal("tension", tuple(Channel(f"tension.{each.name}", "N") for each in own), "tensions of the legs")),
        outputs=(*outer.outputs, *further),
        states=(*outer.states, State("turn", (1,)), *_states(given, legs), *held),
        code=Code((*outer.code.tables, *tables), tuple(_sample(outer, given, legs))),
    )


_STATUS = "for each tension: 0 valid; 1 not finite, replaced by the last valid value"


def _about(legs: SampledLegs) -> str:
    first = f"The first of {legs.turns} calls also runs the pose loop, every {legs.turns * legs.step:.12g} s, with the current readings"
    return (
        f"Call the step every {legs.step:.12g} s: it runs force feedback in the legs of {', '.join(legs.actuators)}. {first}. "
        "Tension is positive; total is the input of the amplifiers."
    )


def _states(given: Machine, legs: SampledLegs) -> tuple[State, ...]:
    own = (State(each, (len(legs.actuators),)) for each in ("tension", "slow", "slower"))
    return (*own, State("total", (len(given.actuators),)))


def _settings(given: Machine, legs: SampledLegs) -> tuple[ProgramSetting, ...]:
    named = ", ".join(legs.actuators)
    return (
        ProgramSetting("leg", legs.gains, f"g / (a k) of the legs {named} [m/N]"),
        ProgramSetting("quick", given.amplifiers.slew * legs.step, "largest change of the total stroke per sample of the legs"),
    )


def _sample(outer: Program, given: Machine, legs: SampledLegs) -> list[str]:
    keeps, places, m = [(each.field, len(each.channels)) for each in outer.outputs], _places(given, legs), len(given.actuators)
    volts = ["out->volts[j] += (stroke - out->given[j]) * per_metre[j];"] if has_volts(given) else []
    return [
        "int j;",
        "if (state->turn[0] == 0.0) {",
        *indent(outer.code.body),
        *(f"    for (j = 0; j < {size}; j++) state->held_{field}[j] = out->{field}[j];" for field, size in keeps),
        "} else {",
        *(f"    for (j = 0; j < {size}; j++) out->{field}[j] = state->held_{field}[j];" for field, size in keeps),
        "}",
        f"state->turn[0] = state->turn[0] + 1.0 < {number(legs.turns)} ? state->turn[0] + 1.0 : 0.0;",
        f"for (j = 0; j < {len(places)}; j++) {{",
        f"    out->tension_status[j] = {_good('in->tension[j]', LARGEST)} ? 0.0 : 1.0;",
        *indent(_one_leg(legs, "out->added[j]", "leg[j]", "in->tension[j]", place="j", largest=LARGEST)),
        "}",
        f"for (j = 0; j < {m}; j++) out->total[j] = out->given[j];",
        *(f"out->total[{place}] += out->added[{leg}];" for leg, place in enumerate(places)),
        f"for (j = 0; j < {m}; j++) {{",
        "    double stroke = out->total[j];",
        f"    if (!({_good('stroke', LARGEST)})) stroke = state->total[j];",
        *indent([*limited("", "quick", "total", "j"), "out->total[j] = state->total[j] = stroke;", *volts]),
        "}",
    ]


def legs_beside(outer: Program, given: Machine, legs: SampledLegs, precision: Precision) -> Program:
    """Add a separate function `<name>_damp` to a program with settings. It runs the inner loops at their own rate."""
    m, largest, places = len(given.actuators), number(precision.largest), _places(given, legs)
    volts = [f", double volts[{m}]", "volts[i] = stroke * per_metre[i] + bias[i];"] if has_volts(given) else ["", ""]
    sizes = f"const double tension[{len(places)}], double total[{m}]{volts[0]}"
    call = f"void {outer.name}_damp({outer.name}_state *state, const {outer.name}_parameters *set, {sizes})"
    flops = (6 if legs.order == 1 else 12) * len(places) + 5 * m
    notes = (
        f"Force feedback in the legs of {', '.join(legs.actuators)}. Call it every {legs.step:.12g} s, {legs.turns} times per call of "
        f"the step ({flops} additions and multiplications). It computes the total strokes (controller plus force feedback), "
        "within the amplifiers' limits, from tensions [N]. Send these strokes to the amplifiers, not the strokes of the step."
    )
    body = (
        f"double added[{m}] = {{0.0}}, gives[{len(places)}] = {{0.0}};",
        "int i;",
        f"for (i = 0; i < {len(places)} && set->enable; i++) {{",
        *indent(_one_leg(legs, "gives[i]", "set->leg[i]", "tension[i]", place="i", largest=largest)),
        "}",
        *(f"added[{place}] = gives[{leg}];" for leg, place in enumerate(places)),
        f"for (i = 0; i < {m}; i++) {{",
        "    double stroke = state->last[i] + added[i];",
        f"    if (!({_good('stroke', largest)}) || !set->enable) stroke = state->total[i];",
        *indent([*limited("set->", "quick", "total", "i"), "total[i] = state->total[i] = stroke;", volts[1]]),
        "}",
    )
    return replace(
        outer,
        states=(*outer.states, *_states(given, legs)),
        settings=(*outer.settings, *(bounded(each, precision) for each in _settings(given, legs))),
        functions=(*outer.functions, ProgramFunction(call, body, notes)),
    )


def _places(given: Machine, legs: SampledLegs) -> list[int]:
    return [given.actuators.index(name) for name in legs.actuators]


def _good(value: str, largest: str) -> str:
    """Whether a number is finite; a comparison with NaN is false."""
    return f"{value} <= {largest} && {value} >= -{largest}"


def _one_leg(legs: SampledLegs, target: str, gain: str, tension: str, *, place: str, largest: str) -> list[str]:
    """Statements of a leg's law, from a tension to a target, with states `state->slow` and `slower`."""
    share, twice = number(legs.share), number(2.0 * legs.share)
    second = [
        f"entry = {share} * slow;",
        f"slow = entry + state->slower[{place}];",
        f"state->slower[{place}] = entry + slow - {twice} * slow;",
        f"{target} -= slow;",
    ]
    return [
        "double entry, slow;",
        f"if ({_good(tension, largest)}) state->tension[{place}] = {tension};",
        f"entry = {share} * {gain} * state->tension[{place}];",
        f"slow = entry + state->slow[{place}];",
        f"state->slow[{place}] = entry + slow - {twice} * slow;",
        f"{target} = slow;",
        *(second if legs.order > 1 else []),
    ]


def legs_test(given: Machine, legs: SampledLegs, name: str) -> Sequence[str]:
    """Generate a C function that replays tensions. It returns the largest deviation from Python, divided by the largest stroke."""
    tensions, wanted = _swept(given, legs)
    m, volts = len(given.actuators), ", volts" if has_volts(given) else ""
    return [
        *table("tension", tensions),
        *table("both", wanted),
        "",
        f"double {name}_legs_worst(void);",
        f"double {name}_legs_worst(void)",
        "{",
        f"    static {name}_state state;",
        f"    static {name}_parameters set;",
        f"    static double total[{m}]{f', volts[{m}]' if volts else ''};",
        "    double worst = 0.0;",
        "    int k, i;",
        f"    {name}_init(&state, &set);",
        "    set.enable = 1;",
        f"    for (i = 0; i < {m}; i++) set.quick[i] = set.high[i] = 1.0, set.low[i] = -1.0;",
        f"    for (k = 0; k < {_SWEPT}; k++) {{",
        f"        {name}_damp(&state, &set, tension[k], total{volts});",
        f"        for (i = 0; i < {m}; i++) {{",
        "            const double off = total[i] - both[k][i];",
        "            if (!(off <= worst && off >= -worst)) worst = off < 0.0 ? -off : off;",
        "        }",
        "    }",
        f"    return worst / {number(float(np.max(np.abs(wanted))))};",
        "}",
        "",
    ]


def _swept(given: Machine, legs: SampledLegs) -> tuple[Array, Array]:
    """Tensions (n, legs), and their strokes (n, actuators), a micrometre at most."""
    times = np.arange(_SWEPT)[:, None]
    tensions = np.sin(0.1 * np.pi * times**2 / _SWEPT + np.arange(len(legs.gains))) / legs.gains
    wanted = np.zeros((_SWEPT, len(given.actuators)))
    wanted[:, _places(given, legs)] = legs.strokes(tensions)
    size = _LARGEST / np.max(np.abs(wanted))
    return size * tensions, size * wanted
