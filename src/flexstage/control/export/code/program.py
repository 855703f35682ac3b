"""A program of C that is stepped: its signals, its state, its text."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from flexstage.control.export.code.code import Code
from flexstage.control.export.code.product import MULTIPLY
from flexstage.control.export.code.text import comment, indent, number
from flexstage.models.linear.model import Channel

WARNINGS = ("-Wall", "-Wextra", "-Wpedantic", "-Werror")
FLAGS = ("-std=c99", "-O3", "-ffp-contract=off", "-fPIC", "-shared", *WARNINGS)
"""How programs are compiled. Without contraction: a product and a sum round as written, here as elsewhere."""


@dataclass(frozen=True)
class Signal:
    """A group of numbers that goes in or out: its `field` in the struct, its channels in order, and what it means."""

    field: str
    channels: tuple[Channel, ...]
    meaning: str


@dataclass(frozen=True)
class State:
    """A group of numbers kept from step to step: `field`, sizes of its axes, and what they begin with (absent: nought)."""

    field: str
    sizes: tuple[int, ...]
    start: str | None = None


@dataclass(frozen=True)
class Program:
    """C99 of fixed step: `code` whose body is run every `step` [s].

    In the body the inputs are `in->field[i]`, outputs `out->field[i]`, states `state->field[i]`. No heap, nothing but math.h; `init` and
    `step` are its functions. `about` heads both files. Empty groups are left out, for C has no arrays of size 0.
    """

    name: str
    about: tuple[str, ...]
    step: float
    inputs: tuple[Signal, ...]
    outputs: tuple[Signal, ...]
    states: tuple[State, ...]
    code: Code

    @property
    def header(self) -> str:
        """Text of the header, `<name>.h`."""
        guard, name = f"{self.name.upper()}_H", self.name
        lines = [
            *(line for text in self.about for line in comment(text)),
            f"#ifndef {guard}",
            f"#define {guard}",
            "",
            "#ifdef __cplusplus",
            'extern "C" {',
            "#endif",
            "",
            *comment("Time between two calls of the step [s]: the caller sees to it."),
            f"#define {name.upper()}_PERIOD {number(self.step)}",
            "",
            *_struct(f"{name}_input", self.inputs),
            *_struct(f"{name}_output", self.outputs),
            *_state_struct(f"{name}_state", self.states),
            *comment("Set the state to rest; call it once before the first step."),
            f"void {name}_init({name}_state *state);",
            "",
            *comment("One sample: read the inputs, write the outputs, move the state on to the next sample."),
            f"void {name}_step({name}_state *state, const {name}_input *in, {name}_output *out);",
            "",
            "#ifdef __cplusplus",
            "}",
            "#endif",
            "",
            "#endif",
        ]
        return "\n".join(lines) + "\n"

    @property
    def source(self) -> str:
        """Text of the source, `<name>.c`."""
        name = self.name
        lines = [
            *(line for text in self.about for line in comment(text)),
            f'#include "{name}.h"',
            "",
            "#include <math.h>",
            "",
            *_NO_FAST_MATH,
            *_head(self.code),
            f"void {name}_init({name}_state *state)",
            "{",
            *indent(line for state in self.states for line in _initialise(state)),
            "}",
            "",
            f"void {name}_step({name}_state *state, const {name}_input *in, {name}_output *out)",
            "{",
            *indent(self.code.body),
            "}",
        ]
        return "\n".join(lines) + "\n"


_NO_FAST_MATH = (
    "#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__) || defined(_M_FP_FAST)",
    "#error Compile without fast math: what is no finite number would not be seen, and sums would be in another order.",
    "#endif",
    "",
)


def _head(code: Code) -> list[str]:
    """Tables, headed by the product of matrices where one is used."""
    multiplied = [*MULTIPLY, ""] if any("multiply(" in line for line in code.body) else []
    return [*multiplied, *code.tables, ""] if code.tables else multiplied


def _struct(name: str, signals: Iterable[Signal]) -> list[str]:
    lines = ["typedef struct {"]
    for signal in signals:
        if signal.channels:
            listed = ", ".join(f"{channel.name} [{channel.unit}]" for channel in signal.channels)
            lines += indent([*comment(f"{signal.meaning}: {listed}"), f"double {signal.field}[{len(signal.channels)}];"])
    return [*lines, f"}} {name};", ""]


def _state_struct(name: str, states: Iterable[State]) -> list[str]:
    fields = [f"double {state.field}{''.join(f'[{size}]' for size in state.sizes)};" for state in states if all(state.sizes)]
    return ["typedef struct {", *indent(fields), f"}} {name};", ""]


def _initialise(state: State) -> list[str]:
    """Every number of a group set, axis by axis."""
    if not all(state.sizes):
        return []
    loops = [
        f"{'    ' * depth}for (int {name} = 0; {name} < {size}; {name}++)"
        for depth, (name, size) in enumerate(zip("ij", state.sizes, strict=False))
    ]
    places = "".join(f"[{name}]" for name in "ij"[: len(state.sizes)])
    return [*loops, f"{'    ' * len(loops)}state->{state.field}{places} = {'0.0' if state.start is None else state.start + places};"]
