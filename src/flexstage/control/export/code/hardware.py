"""A controller as C for a processor of its own: either precision, gains in RAM, enable without a bump, the same bits everywhere."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import Enum

import numpy as np
import scipy

from flexstage.base.finding import refuse
from flexstage.base.number import Array
from flexstage.control.controllers.decentralised import Decentralised
from flexstage.control.controllers.law import Law, tracking_rate
from flexstage.control.controllers.pi import PI
from flexstage.control.controllers.pid import PID
from flexstage.control.controllers.prefilter import with_prefilters
from flexstage.control.damping.sampled import SampledLegs
from flexstage.control.export.code.controller import clamp, has_volts
from flexstage.control.export.code.hardware_legs import LegWriter
from flexstage.control.export.code.modal import modal_form
from flexstage.control.export.code.product import MULTIPLY, Term, product
from flexstage.control.export.code.text import comment, identifier, indent, number, table
from flexstage.control.simulation.fused import parts
from flexstage.control.simulation.machine import Machine
from flexstage.control.simulation.result import Simulated
from flexstage.control.system import System, static
from flexstage.models.linear.model import Channel

FLAGS = ("-std=c99", "-O2", "-ffp-contract=off", "-Wall", "-Wextra", "-Wpedantic", "-Werror")
"""How it is to be compiled: without contraction, products and sums round as written."""
NO_INVERSE = ("the inverse of a hysteresis has no form for it", 'Leave "hysteresis" out of compensate, or take --export')
_SPARSE = 0.2
_CONSTANT = re.compile(r"(?<![\w.])(\d+\.\d*(?:e[+-]?\d+)?|\d+e[+-]?\d+)(?![\w.])")


class Precision(Enum):
    """The type of the controller's numbers."""

    SINGLE = "float32"
    DOUBLE = "float64"

    @property
    def word(self) -> str:
        """The type in C."""
        return "float" if self is Precision.SINGLE else "double"

    @property
    def bytes(self) -> int:
        """Bytes of a number."""
        return 4 if self is Precision.SINGLE else 8

    @property
    def tolerance(self) -> float:
        """How far outputs may be from the simulation's, of the largest: rounding of some hundred samples that add up."""
        return 1e-4 if self is Precision.SINGLE else 1e-11


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


@dataclass(frozen=True)
class _Core:
    """The law as C: arrays of its state with their sizes, of its parameters with their values, and its statements.

    `locals` are declared at the head; `command` follows from errors and states, `begin` sets states so that the command is that given
    last, `next` states go to arrays `next_<state>`. `functions` stand at the file's level.
    """

    states: tuple[tuple[str, int], ...]
    parameters: tuple[tuple[str, Array, str], ...]
    tables: tuple[str, ...]
    locals: tuple[str, ...]
    prepare: tuple[str, ...]
    begin: tuple[str, ...]
    command: tuple[str, ...]
    next: tuple[str, ...]
    flops: int


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
    core = _loops(given, law) if law is not None and all(isinstance(each, (PI, PID)) for each in law.laws) else _modal(given)
    name = identifier(name)
    inner = None if legs is None else LegWriter(given, legs, name, number(_largest(precision)))
    writer = _Writer(given, core, name, precision, about, inner)
    return Hardware(
        header=_typed(writer.header(), precision),
        source=_typed(writer.source(), precision),
        test=_typed(_test(given, tested, name, precision, inner), precision),
        flops=int(writer.flops),
        state=precision.bytes * writer.numbers + 4,
        parameters=precision.bytes * writer.settings + 4,
        tables=precision.bytes * len(_CONSTANT.findall(" ".join((*core.tables, *writer.tables())))),
    )


def _typed(lines: Sequence[str], precision: Precision) -> str:
    """Text in a precision: constants and their type."""
    text = "\n".join(lines) + "\n"
    if precision is Precision.DOUBLE:
        return text
    text = re.sub(r"\bdouble\b", "float", text)
    return _CONSTANT.sub(r"\1f", _apart(text)).replace("\0", "")


def _apart(text: str) -> str:
    """Numbers in comments are left as they are: marked so that they are no numbers."""
    return re.sub(r"/\*.*?\*/", lambda match: re.sub(r"(\d)", "\\1\0", match.group()), text, flags=re.DOTALL)


# --- laws ---


@dataclass(frozen=True)
class _Product:
    """A sum of products: its tables, statements and what they add and multiply."""

    tables: tuple[str, ...]
    body: tuple[str, ...]
    flops: int


def _mixed(name: str, target: str, terms: Sequence[Term], size: int) -> _Product:
    """target = sum of products: written out where a matrix is sparse, by tables where it is dense."""
    used = [(np.asarray(matrix), vector) for matrix, vector in terms if np.any(matrix)]
    dense = [each for each in used if np.count_nonzero(each[0]) > 36 and np.count_nonzero(each[0]) > _SPARSE * each[0].size]
    sparse = [each for each in used if not any(each is other for other in dense)]
    tables: tuple[str, ...] = ()
    body: tuple[str, ...] = ()
    for start in range(0, size, 1):
        rows = [(matrix[[start]], vector) for matrix, vector in sparse]
        body += tuple(line.replace("TARGET[0]", f"{target}[{start}]") for line in product(name, "TARGET", rows, 1).body)
    for count, (matrix, vector) in enumerate(dense):
        groups = -(-size // 8)
        padded = np.zeros((8 * groups, matrix.shape[1]))
        padded[:size] = matrix
        tables += tuple(table(f"{name}_{count}", padded.reshape(groups, 8, -1).transpose(0, 2, 1).reshape(-1, 8)))
        body += (
            "{",
            f"    double sum[{8 * groups}] = {{0.0}};",
            f"    multiply(&{name}_{count}[0][0], {groups}, {matrix.shape[1]}, {vector}, sum);",
            f"    for (i = 0; i < {size}; i++) {target}[i] += sum[i];",
            "}",
        )
    flops = 2 * sum(int(np.count_nonzero(matrix)) for matrix, _ in sparse) + 2 * sum(matrix.size for matrix, _ in dense)
    return _Product(tables, body, flops)


def _settled(system: System) -> Array:
    """States (s, m) in which a system rests under inputs of one: (I - A)^-1 B."""
    return np.linalg.solve(np.eye(len(system.A)) - system.A, system.B) if len(system.A) else np.zeros_like(system.B)


def _modal(given: Machine) -> _Core:
    """Any law: z+ = A z + ..., in modal form; begun at rest under what is seen, its integrators so that the command is that given last."""
    linear = parts(replace(given, controller=modal_form(given.controller)))
    A, n, m = linear.controller, len(linear.controller), len(given.actuators)
    slow = np.abs(np.diag(A) - 1.0) < 1e-9
    slow &= np.count_nonzero(np.abs(A) > 1e-300, axis=1) == 1
    fast = np.flatnonzero(~slow)
    rest = np.zeros((n, 2 * len(given.names)))
    entry = np.hstack([linear.from_reference, linear.from_pose])
    rest[fast] = np.linalg.lstsq(np.eye(len(fast)) - A[np.ix_(fast, fast)], entry[fast], rcond=None)[0]
    lead = np.zeros((n, m))
    lead[slow] = np.linalg.pinv(linear.command[:, slow]) if np.any(slow) else 0.0
    direct = linear.command @ rest + np.hstack([linear.command_r, linear.command_q])
    begin = rest - lead @ direct
    count = len(given.names)
    known, wanted, pose = "state->z", "state->wanted", "out->pose"
    first = _mixed("begin", known, [(lead, "state->last"), (begin[:, :count], wanted), (begin[:, count:], pose)], n)
    command = _mixed("command", "out->command", [(linear.command, known), (linear.command_r, wanted), (linear.command_q, pose)], m)
    entering = [(linear.from_reference, wanted), (linear.from_pose, pose), (linear.from_applied, "applied")]
    after = _mixed("following", "next_z", [(A, known), *entering], n)
    tables = (*first.tables, *command.tables, *after.tables)
    return _Core((("z", n),), (), tables, (), (), first.body, command.body, after.body, command.flops + after.flops)


def _loops(given: Machine, law: Decentralised) -> _Core:
    """Single loops: the gains of their laws are parameters, notches, prefilters and what is fed forward are fixed."""
    k, step, loops = len(law.laws), given.step, law.loops
    behind = _notches(law, step)
    ahead = _ahead(law, step)
    laws = [_as_pid(each) for each in law.laws]
    corners = np.array([2.0 * np.pi * each.filter if each.derivative else 0.0 for each in laws])
    slow = (1.0 - 0.5 * corners * step) / (1.0 + 0.5 * corners * step)
    lead = corners / (1.0 + 0.5 * corners * step)
    drive, back = np.asarray(loops.drive), np.linalg.pinv(loops.drive)
    f, m = len(given.names), len(given.actuators)
    products = (
        _mixed("ahead", "ahead", [(ahead.C, "state->f"), (ahead.D, "state->wanted")], f + m),
        _mixed("sense", "error", [(np.asarray(loops.sense), "apparent")], k),
        _mixed("notched", "notched", [(behind.C, "state->n"), (behind.D, "raw")], k),
        _mixed("driven", "out->command", [(drive, "notched")], m),
        _mixed("led", "led", [(back, "applied")], k),
        _mixed("after", "next_n", [(behind.A, "state->n"), (behind.B, "raw")], len(behind.A)),
        _mixed("shaped", "next_f", [(ahead.A, "state->f"), (ahead.B, "state->wanted")], len(ahead.A)),
        _mixed("back", "raw", [(back, "rest")], k),
        _mixed("settled", "state->n", [(_settled(behind), "raw")], len(behind.A)),
        _mixed("still", "state->f", [(_settled(ahead), "state->wanted")], len(ahead.A)),
    )
    body = [each.body for each in products]
    direct = f"(set->proportional[i] + set->integral[i] * {number(0.5 * step)}) * error[i] + set->derivative[i] * rate[i]"
    prepare = (
        f"for (i = 0; i < {f}; i++) apparent[i] = out->error[i] + ahead[i];",
        *body[1],
        f"for (i = 0; i < {k}; i++) rate[i] = lead[i] * (error[i] - state->d[i]);",
        f"for (i = 0; i < {k}; i++) direct[i] = {direct};",
    )
    begin = (
        *body[9],
        *body[0],
        f"for (i = 0; i < {f}; i++) apparent[i] = out->error[i] + ahead[i];",
        *body[1],
        f"for (i = 0; i < {k}; i++) state->d[i] = error[i];",
        f"for (i = 0; i < {k}; i++) rate[i] = 0.0;",
        f"for (i = 0; i < {k}; i++) direct[i] = {direct};",
        f"for (i = 0; i < {m}; i++) rest[i] = state->last[i] - ahead[{f} + i];",
        *body[7],
        *body[8],
        f"for (i = 0; i < {k}; i++) state->x[i] = raw[i] - direct[i];",
    )
    command = (
        f"for (i = 0; i < {k}; i++) raw[i] = state->x[i] + direct[i];",
        *body[2],
        *body[3],
        f"for (i = 0; i < {m}; i++) out->command[i] += ahead[{f} + i];",
    )
    after = (
        *body[4],
        f"for (i = 0; i < {k}; i++) {{",
        f"    next_x[i] = state->x[i] + set->integral[i] * {number(step)} * error[i] + set->tracking[i] * led[i];",
        "    next_d[i] = slow[i] * state->d[i] + (1.0 - slow[i]) * error[i];",
        "    next_e[i] = error[i];",
        "}",
        *body[5],
        *body[6],
    )
    gains = (
        ("proportional", np.array([each.proportional for each in laws]), f"gains of the loops {', '.join(loops.names)} [1]"),
        ("integral", np.array([each.integral for each in laws]), "[1/s]"),
        ("derivative", np.array([each.derivative for each in laws]), "[s]"),
        (
            "tracking",
            np.array([step * tracking_rate(each.tracking_time, step) if each.integral else 0.0 for each in laws]),
            "share by which an integrator follows, in a sample, what a limit took",
        ),
    )
    arrays = {"ahead": f + m, "apparent": f, "error": k, "rate": k, "direct": k, "raw": k, "notched": k, "led": k, "rest": m}
    return _Core(
        (("x", k), ("d", k), ("e", k), ("n", len(behind.A)), ("f", len(ahead.A))),
        gains,
        (*table("slow", slow), *table("lead", lead), *(line for each in products for line in each.tables)),
        tuple(f"double {array}[{size}];" for array, size in arrays.items()),
        (*body[0], *prepare),
        begin,
        command,
        after,
        sum(each.flops for each in products[:7]) + 17 * k + f + m,
    )


def _as_pid(law: Law) -> PID:
    """A PI as a PID without a derivative."""
    if isinstance(law, PI):
        return PID(law.proportional, law.integral, 0.0, 1.0, law.tracking)
    if isinstance(law, PID):
        return law
    raise TypeError(law)


def _notches(law: Decentralised, step: float) -> System:
    """All loops' notches, from their laws to what they drive, in modal form."""
    chains = [_chain([each.system(step) for each in group], step) for group in law.notches or ((),) * len(law.laws)]
    names = [Channel(f"loop{place}", "m") for place in range(len(chains))]
    matrices = [np.asarray(scipy.linalg.block_diag(*(getattr(each, name) for each in chains))) for name in "ABCD"]
    states = sum(len(each.A) for each in chains)
    shapes = ((states, states), (states, len(chains)), (len(chains), states), (len(chains), len(chains)))
    A, B, C, D = (np.reshape(matrix, shape) for matrix, shape in zip(matrices, shapes, strict=True))
    return System(A, B, C, D, tuple(names), tuple(names), step)


def _chain(filters: Sequence[System], step: float) -> System:
    """Filters in a row, in modal form."""
    port = (Channel("raw", "m"),)
    found = static(np.eye(1), port, port, step)
    for each in filters:
        A = np.block([[found.A, np.zeros((len(found.A), len(each.A)))], [each.B @ found.C, each.A]])
        found = System(A, np.vstack([found.B, each.B @ found.D]), np.hstack([each.D @ found.C, each.C]), each.D @ found.D, port, port, step)
    return modal_form(found)


def _ahead(law: Decentralised, step: float) -> System:
    """From the reference to what is added to errors and to commands: prefilters and what is fed forward."""
    coordinates = law.loops.coordinates
    f, m = len(coordinates.names), len(coordinates.actuators)
    inputs = tuple(Channel(f"error.{name}", "m") for name in coordinates.names)
    wanted = tuple(Channel(f"reference.{name}", "m") for name in coordinates.names)
    outputs = tuple(Channel(f"out{place}", "m") for place in range(f + m))
    forward = np.zeros((m, f)) if law.feedforward is None else np.asarray(law.feedforward)
    plain = static(
        np.vstack([np.hstack([np.eye(f), np.zeros((f, f))]), np.hstack([np.zeros((m, f)), forward])]), (*inputs, *wanted), outputs, step
    )
    whole = with_prefilters(plain, law.prefilters, np.asarray(law.loops.sense), coordinates)
    columns = [whole.input_names.index(channel.name) for channel in wanted]
    return replace(whole, B=whole.B[:, columns], D=whole.D[:, columns], inputs=wanted)


# --- text ---


@dataclass(frozen=True)
class _Writer:
    """Header and source of a controller."""

    given: Machine
    core: _Core
    name: str
    precision: Precision
    about: str
    legs: LegWriter | None

    @property
    def _sizes(self) -> tuple[int, int, int]:
        return len(self.given.names), len(self.given.gauges), len(self.given.actuators)

    @property
    def states(self) -> tuple[tuple[str, int], ...]:
        """Arrays that are kept."""
        f, g, m = self._sizes
        return (*self.core.states, ("last", m), ("seen", g), ("wanted", f), *(self.legs.states if self.legs else ()))

    @property
    def settings_arrays(self) -> tuple[tuple[str, Array, str], ...]:
        """Arrays that may be changed at run time."""
        amplifiers = self.given.amplifiers
        return (
            *self.core.parameters,
            ("low", amplifiers.low, "limits of the strokes (or inputs)"),
            ("high", amplifiers.high, ""),
            ("most", amplifiers.slew * self.given.step, "largest change in a sample"),
            *(self.legs.settings if self.legs else ()),
        )

    @property
    def numbers(self) -> int:
        """Numbers of the state."""
        return sum(size for _, size in self.states)

    @property
    def settings(self) -> int:
        """Numbers of the parameters."""
        return sum(len(values) for _, values, _ in self.settings_arrays)

    @property
    def flops(self) -> int:
        """Additions, multiplications and divisions of a step."""
        f, _, m = self._sizes
        return self.core.flops + 2 * int(np.count_nonzero(self.given.pose)) + f + 7 * m

    def tables(self) -> list[str]:
        """Tables of what is not linear."""
        lines = table("reach", np.minimum(self.given.reach, _largest(self.precision)))
        if np.any(self.given.amplifiers.step):
            lines += table("converter", self.given.amplifiers.step)
        if has_volts(self.given):
            lines += [*table("per_metre", 1.0 / self.given.amplifiers.gain), *table("bias", self.given.amplifiers.bias)]
        return lines

    def _outputs(self) -> tuple[tuple[str, int, str], ...]:
        f, g, m = self._sizes
        volts = (("volts", m, "for the amplifiers [V]"),) if has_volts(self.given) else ()
        status = "readings, then references: 0 taken; held instead, 1 it is no finite number, 2 it is beyond the range"
        return (
            ("pose", f, "pose seen"),
            ("error", f, "reference less pose"),
            ("command", m, "command of the law"),
            ("asked", m, "asked of the amplifiers"),
            ("given", m, "within their limits"),
            *volts,
            ("status", f + g, status),
        )

    def header(self) -> list[str]:
        """Lines of the header."""
        name, guard = self.name, f"{self.name.upper()}_H"
        size, given = self.precision.bytes, self.given
        memory = f"state {size * self.numbers + 4}, parameters {size * self.settings + 4} bytes"
        ports = (("inputs", given.names), ("gauges", given.gauges), ("actuators", given.actuators))
        notes = (
            f"Controller of a positioning stage, generated by flexstage: {self.precision.value}, C99, SI units. The step calls nothing.",
            *((self.about,) if self.about else ()),
            f"One call of the step every {given.step:.12g} s: {self.flops} additions and multiplications. Memory: {memory}.",
            "Compile with -ffp-contract=off, without fast mathematics, flush to zero off: finite inputs give the same bits everywhere.",
            "Not enabled, it holds the strokes given last. Enabled, its states are set so that it goes on from them without a bump.",
            "; ".join(f"{kind} {', '.join(names)}" for kind, names in ports),
        )
        gains = "int loop, double proportional, double integral, double derivative"
        setter = [
            *comment("Change the gains of a loop without a bump: its integrator takes over what the direct part loses."),
            f"void {name}_set_gains({name}_state *state, {name}_parameters *set, {gains});",
        ]
        return [
            *(line for text in notes for line in comment(text)),
            f"#ifndef {guard}",
            f"#define {guard}",
            "",
            f"#define {name.upper()}_PERIOD {number(self.given.step)}",
            f"typedef double {name}_real;",
            "",
            *_struct(
                f"{name}_input", [("reference", len(self.given.names), "wanted pose"), ("reading", len(self.given.gauges), "readings")]
            ),
            *_struct(f"{name}_output", self._outputs()),
            *_struct(f"{name}_state", [(each, size, "") for each, size in self.states], "int is_on;"),
            *comment("What may be changed between two steps; enable is 0 or 1."),
            *_struct(f"{name}_parameters", [(each, len(values), text) for each, values, text in self.settings_arrays], "int enable;"),
            f"void {name}_init({name}_state *state, {name}_parameters *set);",
            f"void {name}_step({name}_state *state, const {name}_parameters *set, const {name}_input *in, {name}_output *out);",
            *(setter if self.core.parameters else []),
            *(self.legs.header() if self.legs else []),
            "",
            "#endif",
        ]

    def source(self) -> list[str]:
        """Lines of the source."""
        name, body = self.name, self._step()
        used = [*MULTIPLY, ""] if any("multiply(" in line for line in body) else []
        return [
            f'#include "{name}.h"',
            "#include <float.h>",
            "",
            "#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__) || defined(_M_FP_FAST)",
            "#error Compile without fast math: what is no finite number would not be seen, and sums would be in another order.",
            "#endif",
            "#if defined(FLT_EVAL_METHOD) && FLT_EVAL_METHOD != 0",
            "#error Compile so that numbers are rounded to their type, for example with -mfpmath=sse.",
            "#endif",
            "",
            *_IS_FINITE,
            "",
            *used,
            *self.core.tables,
            *self.tables(),
            "",
            *self._init(),
            "",
            f"void {name}_step({name}_state *state, const {name}_parameters *set, const {name}_input *in, {name}_output *out)",
            "{",
            *indent(body),
            "}",
            *self._setter(),
            *(self.legs.source() if self.legs else []),
        ]

    def _init(self) -> list[str]:
        name = self.name
        lines = [f"void {name}_init({name}_state *state, {name}_parameters *set)", "{", "    int i;"]
        lines += [f"    for (i = 0; i < {size}; i++) state->{each}[i] = 0.0;" for each, size in self.states if size]
        for each, values, _ in self.settings_arrays:
            bounded = np.clip(values, -_largest(self.precision), _largest(self.precision))
            lines += [f"    {line}" for line in table(f"first_{each}", bounded)]
            lines.append(f"    for (i = 0; i < {len(values)}; i++) set->{each}[i] = first_{each}[i];")
        return [*lines, "    state->is_on = 0;", "    set->enable = 0;", "}"]

    def _step(self) -> list[str]:
        f, g, m = self._sizes
        core, largest = self.core, number(_largest(self.precision))
        pose = _mixed("seen", "out->pose", [(self.given.pose, "state->seen")], f)
        following = [(each, size) for each, size in core.states if size]
        finite = " && ".join(f"is_finite(next_{each}, {size})" for each, size in following) or "1"
        return [
            f"double applied[{m}];",
            *(f"double next_{each}[{size}];" for each, size in following),
            *core.locals,
            *pose.tables,
            "int i;",
            *_taken(g, "in->reading[i]", "reach[i]", "seen", place="i", largest=largest),
            *_taken(f, "in->reference[i]", largest, "wanted", place=f"{g} + i", largest=largest),
            *pose.body,
            f"for (i = 0; i < {f}; i++) out->error[i] = state->wanted[i] - out->pose[i];",
            "if (!set->enable || !state->is_on) {",
            *indent(core.begin),
            "}",
            "state->is_on = set->enable;",
            *core.prepare,
            *core.command,
            f"for (i = 0; i < {m}; i++) {{",
            *indent(self._actuator(largest)),
            "}",
            "if (!set->enable) return;",
            *core.next,
            f"if ({finite}) {{",
            *(f"    for (i = 0; i < {size}; i++) state->{each}[i] = next_{each}[i];" for each, size in following),
            "}",
        ]

    def _actuator(self, largest: str) -> list[str]:
        half = number(1.5 * 2.0 ** (23 if self.precision is Precision.SINGLE else 52))
        lines = ["double stroke = out->command[i];"]
        if np.any(self.given.amplifiers.step):
            lines.append(f"if (converter[i] > 0.0) stroke = ((stroke / converter[i] + {half}) - {half}) * converter[i];")
        lines += [
            f"if (!(stroke <= {largest} && stroke >= -{largest}) || !set->enable) stroke = state->last[i];",
            "out->asked[i] = stroke;",
            *clamp("set->high[i]", "set->low[i]"),
            *clamp("state->last[i] + set->most[i]", "state->last[i] - set->most[i]"),
            "out->given[i] = state->last[i] = stroke;",
            "applied[i] = stroke - out->asked[i];",
        ]
        return [*lines, *(["out->volts[i] = stroke * per_metre[i] + bias[i];"] if has_volts(self.given) else []), "(void)applied;"]

    def _setter(self) -> list[str]:
        if not self.core.parameters:
            return []
        half = number(0.5 * self.given.step)
        name = self.name
        arguments = f"{name}_state *state, {name}_parameters *set, int loop, double proportional, double integral, double derivative"
        return [
            "",
            f"void {name}_set_gains({arguments})",
            "{",
            "    const double rate = lead[loop] * (state->e[loop] - state->d[loop]);",
            "    state->x[loop] += (set->proportional[loop] - proportional) * state->e[loop];",
            f"    state->x[loop] += (set->integral[loop] - integral) * {half} * state->e[loop];",
            "    state->x[loop] += (set->derivative[loop] - derivative) * rate;",
            "    set->proportional[loop] = proportional;",
            "    set->integral[loop] = integral;",
            "    set->derivative[loop] = derivative;",
            "}",
        ]


_IS_FINITE = (
    "static int is_finite(const double *values, int count)",
    "{",
    "    int i;",
    "    for (i = 0; i < count && values[i] - values[i] == 0.0; i++) continue;",
    "    return i == count;",
    "}",
)


def _largest(precision: Precision) -> float:
    return float(np.finfo(np.float32 if precision is Precision.SINGLE else np.float64).max)


def _taken(count: int, value: str, reach: str, kept: str, *, place: str, largest: str) -> list[str]:
    """Numbers that come in, if they are good; a comparison with NaN is false."""
    return [
        f"for (i = 0; i < {count}; i++) {{",
        f"    const double value = {value};",
        f"    const int is_good = value <= {reach} && value >= -{reach};",
        f"    out->status[{place}] = is_good ? 0.0 : value <= {largest} && value >= -{largest} ? 2.0 : 1.0;",
        f"    if (is_good) state->{kept}[i] = value;",
        "}",
    ]


def _struct(name: str, arrays: Sequence[tuple[str, int, str]], last: str = "") -> list[str]:
    lines = ["typedef struct {"]
    for field, size, text in arrays:
        if size:
            lines += indent([*(comment(text) if text else []), f"double {field}[{size}];"])
    return [*lines, *([f"    {last}"] if last else []), f"}} {name};", ""]


def _test(given: Machine, tested: Simulated, name: str, precision: Precision, legs: LegWriter | None) -> list[str]:
    """A program that replays a simulated loop: how far strokes are from it, and a hash of all outputs' bits; then tensions of legs."""
    rows, upper = len(tested.times), name.upper()
    f, g, m = len(given.names), len(given.gauges), len(given.actuators)
    scale = max(float(np.max(np.abs(tested.given))), 1e-300)
    allowed = precision.tolerance + 1.01 * float(np.max(given.amplifiers.step)) / scale
    return [
        *comment(f"A loop of {rows} samples as flexstage simulates it: {name}_worst is at most {allowed:.3g} of the largest stroke."),
        f'#include "{name}.h"',
        "",
        *table("reference", tested.reference),
        *table("reading", tested.readings),
        *table("given", tested.given),
        "",
        f"double {name}_worst(unsigned long long *hash);",
        f"double {name}_worst(unsigned long long *hash)",
        "{",
        f"    static {name}_state state;",
        f"    static {name}_parameters set;",
        f"    static {name}_input in;",
        f"    static {name}_output out;",
        "    double worst = 0.0;",
        "    unsigned long byte;",
        "    int k, i;",
        "    *hash = 14695981039346656037ULL;",
        f"    {name}_init(&state, &set);",
        "    set.enable = 1;",
        "    state.is_on = 1;",
        f"    for (k = 0; k < {rows}; k++) {{",
        f"        for (i = 0; i < {f}; i++) in.reference[i] = reference[k][i];",
        f"        for (i = 0; i < {g}; i++) in.reading[i] = reading[k][i];",
        f"        {name}_step(&state, &set, &in, &out);",
        f"        for (i = 0; i < {m}; i++) {{",
        "            const double off = out.given[i] - given[k][i];",
        "            if (!(off <= worst && off >= -worst)) worst = off < 0.0 ? -off : off;",
        "        }",
        "        for (byte = 0; byte < sizeof out; byte++) *hash = (*hash ^ ((const unsigned char *)&out)[byte]) * 1099511628211ULL;",
        "    }",
        f"    return worst / {number(scale)};",
        "}",
        "",
        *(legs.test() if legs else []),
        f"#ifdef {upper}_MAIN",
        "#include <stdio.h>",
        "int main(void)",
        "{",
        "    unsigned long long hash;",
        f"    double worst = {name}_worst(&hash);",
        *([f"    if (!({name}_legs_worst() <= worst)) worst = {name}_legs_worst();"] if legs else []),
        '    printf("%.3e %016llx\\n", (double)worst, hash);'.replace("(double)", "1.0 * "),
        f"    return !(worst <= {number(allowed)});",
        "}",
        "#endif",
    ]
