"""Fixed-step C program: signals, state, settings, text."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from flexstage.base.number import Array
from flexstage.control.export.code.product import MULTIPLY, Code
from flexstage.control.export.code.text import comment, indent, number, table
from flexstage.models.linear.model import Channel

WARNINGS = ("-Wall", "-Wextra", "-Wpedantic", "-Werror")
FLAGS = ("-std=c99", "-O3", "-ffp-contract=off", "-fPIC", "-shared", *WARNINGS)
"""Compiler flags. Contraction (fused multiply-add) is off: products and sums are rounded equally on every computer."""


@dataclass(frozen=True)
class Signal:
    """Group of input or output numbers: its `field` in the struct, its channels in order, and its meaning."""

    field: str
    channels: tuple[Channel, ...]
    meaning: str


@dataclass(frozen=True)
class State:
    """Group of state numbers: its `field` in the struct, its array sizes, and the table of its initial values (default: zero)."""

    field: str
    sizes: tuple[int, ...]
    start: str | None = None


@dataclass(frozen=True, eq=False)
class ProgramSetting:
    """Group of numbers adjustable between steps: its `field` in the struct, its initial values, and its meaning."""

    field: str
    values: Array
    meaning: str = ""


@dataclass(frozen=True)
class ProgramFunction:
    """Further function of a program: its declaration, its body lines, and its notes."""

    call: str
    body: tuple[str, ...]
    notes: str


@dataclass(frozen=True)
class Program:
    """Fixed-step C99 program: the body of `code` is run every `step` [s].

    The header declares `<name>_input`, `_output`, `_state`, `<name>_init(state)` and `<name>_step(state, in, out)`. All numbers are
    doubles, in SI units. The code uses no heap memory, and no static variables except tables. With `settings`, the init and step functions
    have a further argument of the type `<name>_parameters` (settings and an enable flag), and call no library function.
    """

    name: str
    about: tuple[str, ...]
    step: float
    inputs: tuple[Signal, ...]
    outputs: tuple[Signal, ...]
    states: tuple[State, ...]
    code: Code
    settings: tuple[ProgramSetting, ...] = ()
    functions: tuple[ProgramFunction, ...] = ()

    @property
    def header(self) -> str:
        """Text of the header, `<name>.h`."""
        guard, name = f"{self.name.upper()}_H", self.name
        init, step = self._calls
        lines = [
            *(line for text in self.about for line in comment(text)),
            f"#ifndef {guard}",
            f"#define {guard}",
            "",
            "#ifdef __cplusplus",
            'extern "C" {',
            "#endif",
            "",
            *comment("Time between two calls of the step [s]; the caller must keep it."),
            f"#define {name.upper()}_PERIOD {number(self.step)}",
            "",
            *_signals(f"{name}_input", self.inputs),
            *_signals(f"{name}_output", self.outputs),
            *_struct(f"{name}_state", [_array(each) for each in self.states if all(each.sizes)], ["int is_on;"] if self.settings else []),
            *self._parameters(),
            *comment("Initialise the state; call once before the first step."),
            f"{init};",
            "",
            *comment("One sample: read the inputs, write the outputs, advance the state."),
            f"{step};",
            *(line for each in self.functions for line in ("", *comment(each.notes), f"{each.call};")),
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
        init, step = self._calls
        functions = [(step, self.code.body), *((each.call, each.body) for each in self.functions)]
        lines = [
            *(line for text in self.about for line in comment(text)),
            f'#include "{self.name}.h"',
            "",
            "#include <float.h>" if self.settings else "#include <math.h>",
            "",
            *_NO_FAST_MATH,
            *(_ROUNDED if self.settings else ()),
            "",
            *(MULTIPLY if any("multiply(" in line for line in self.code.body) else ()),
            *(_IS_FINITE if any("is_finite(" in line for line in self.code.body) else ()),
            *self.code.tables,
            "",
            *_defined(init, [*(line for each in self.states for line in _initialise(each)), *self._first_settings()]),
            *(line for call, body in functions for line in _defined(call, body)),
        ]
        return "\n".join(lines) + "\n"

    @property
    def _calls(self) -> tuple[str, str]:
        """Declarations of the initialisation and the step."""
        name = self.name
        changed, read = (f", {name}_parameters *set", f" const {name}_parameters *set,") if self.settings else ("", "")
        step = f"void {name}_step({name}_state *state,{read} const {name}_input *in, {name}_output *out)"
        return f"void {name}_init({name}_state *state{changed})", step

    def _parameters(self) -> list[str]:
        if not self.settings:
            return []
        arrays = [line for each in self.settings for line in (*comment(each.meaning), f"double {each.field}[{len(each.values)}];")]
        notes = comment("Adjustable between two steps; enable is 0 or 1.")
        return [f"typedef double {self.name}_real;", "", *notes, *_struct(f"{self.name}_parameters", arrays, ("int enable;",))]

    def _first_settings(self) -> list[str]:
        lines = ["state->is_on = 0;", "set->enable = 0;"] if self.settings else []
        for each in self.settings:
            lines += table(f"first_{each.field}", each.values)
            lines.append(f"for (int i = 0; i < {len(each.values)}; i++) set->{each.field}[i] = first_{each.field}[i];")
        return lines


_NO_FAST_MATH = (
    "#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__) || defined(_M_FP_FAST)",
    "#error Compile without fast math: it disables the check for non-finite numbers and reorders sums.",
    "#endif",
)
_ROUNDED = (
    "#if defined(FLT_EVAL_METHOD) && FLT_EVAL_METHOD != 0",
    "#error Compile so that numbers are rounded to their type, for example with -mfpmath=sse.",
    "#endif",
)
_IS_FINITE = (
    "static int is_finite(const double *values, int count)",
    "{",
    "    int i;",
    "    for (i = 0; i < count && values[i] - values[i] == 0.0; i++) continue;",
    "    return i == count;",
    "}",
)


def _defined(call: str, body: Iterable[str]) -> list[str]:
    return [call, "{", *indent(body), "}", ""]


def _signals(name: str, signals: Iterable[Signal]) -> list[str]:
    lines: list[str] = []
    for signal in signals:
        if signal.channels:
            listed = ", ".join(f"{channel.name} [{channel.unit}]" for channel in signal.channels)
            lines += [*comment(f"{signal.meaning}: {listed}"), f"double {signal.field}[{len(signal.channels)}];"]
    return _struct(name, lines)


def _struct(name: str, lines: Iterable[str], last: Iterable[str] = ()) -> list[str]:
    return ["typedef struct {", *indent([*lines, *last]), f"}} {name};", ""]


def _array(state: State) -> str:
    return f"double {state.field}{''.join(f'[{size}]' for size in state.sizes)};"


def _initialise(state: State) -> list[str]:
    """Statements that set every number of a group, axis by axis."""
    if not all(state.sizes):
        return []
    names = "ij"[: len(state.sizes)]
    loops = [
        f"{'    ' * depth}for (int {name} = 0; {name} < {size}; {name}++)"
        for depth, (name, size) in enumerate(zip(names, state.sizes, strict=True))
    ]
    places = "".join(f"[{name}]" for name in names)
    return [*loops, f"{'    ' * len(loops)}state->{state.field}{places} = {'0.0' if state.start is None else state.start + places};"]
