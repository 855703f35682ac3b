"""Laws as C for a processor of its own: single loops whose gains can be changed, or any law in modal form."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy

from flexstage.base.number import Array
from flexstage.control.controllers.decentralised import Decentralised
from flexstage.control.controllers.law import Law, tracking_rate
from flexstage.control.controllers.pi import PI
from flexstage.control.controllers.pid import PID
from flexstage.control.controllers.prefilter import with_prefilters
from flexstage.control.export.code.modal import modal_form
from flexstage.control.export.code.product import Term, product
from flexstage.control.export.code.text import number, table
from flexstage.control.simulation.fused import parts
from flexstage.control.simulation.machine import Machine
from flexstage.control.systems.system import System, static
from flexstage.models.linear.model import Channel

_SPARSE = 0.2


@dataclass(frozen=True)
class Core:
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


def law_as_c(given: Machine, law: Decentralised | None) -> Core:
    """The law of a machine: single loops under PI or PID as such, any other in modal form."""
    is_single = law is not None and all(isinstance(each, (PI, PID)) for each in law.laws)
    return _single_loops(given, law) if law is not None and is_single else _modal(given)


@dataclass(frozen=True)
class _Product:
    """A sum of products: its tables, statements and what they add and multiply."""

    tables: tuple[str, ...]
    body: tuple[str, ...]
    flops: int


def mixed(name: str, target: str, terms: Sequence[Term], size: int) -> _Product:
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


def _modal(given: Machine) -> Core:
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
    first = mixed("begin", known, [(lead, "state->last"), (begin[:, :count], wanted), (begin[:, count:], pose)], n)
    command = mixed("command", "out->command", [(linear.command, known), (linear.command_r, wanted), (linear.command_q, pose)], m)
    entering = [(linear.from_reference, wanted), (linear.from_pose, pose), (linear.from_applied, "applied")]
    after = mixed("following", "next_z", [(A, known), *entering], n)
    tables = (*first.tables, *command.tables, *after.tables)
    return Core((("z", n),), (), tables, (), (), first.body, command.body, after.body, command.flops + after.flops)


def _single_loops(given: Machine, law: Decentralised) -> Core:
    """Single loops: the gains of their laws are parameters, notches, prefilters and what is fed forward are fixed."""
    behind, ahead = _notches(law, given.step), _ahead(law, given.step)
    laws = [_as_pid(each) for each in law.laws]
    sizes = _Sizes(len(laws), len(given.names), len(given.actuators))
    k, f, m = sizes.loops, sizes.coordinates, sizes.actuators
    found = _loop_products(law, behind, ahead, sizes)
    prepared = _prepare(found, sizes, _direct(given.step))
    arrays = {"ahead": f + m, "apparent": f, "error": k, "rate": k, "direct": k, "raw": k, "notched": k, "led": k, "rest": m}
    return Core(
        (("x", k), ("d", k), ("e", k), ("n", len(behind.A)), ("f", len(ahead.A))),
        _gains(law, laws, given.step),
        (*_derivative_tables(laws, given.step), *(line for each in found.values() for line in each.tables)),
        tuple(f"double {array}[{size}];" for array, size in arrays.items()),
        (*found["ahead"].body, *prepared),
        _begin(found, sizes, _direct(given.step)),
        _command(found, sizes),
        _after(found, sizes, given.step),
        sum(found[each].flops for each in _EVERY_STEP) + 17 * k + f + m,
    )


@dataclass(frozen=True)
class _Sizes:
    """How many loops, coordinates and actuators there are."""

    loops: int
    coordinates: int
    actuators: int


_EVERY_STEP = ("ahead", "sense", "notched", "driven", "led", "after", "shaped")


def _loop_products(law: Decentralised, behind: System, ahead: System, sizes: _Sizes) -> dict[str, _Product]:
    """Every sum of products of single loops, by name: those of every step, and those with which they begin."""
    loops, k, n, s = law.loops, sizes.loops, len(behind.A), len(ahead.A)
    drive, back = np.asarray(loops.drive), np.linalg.pinv(loops.drive)
    sums: dict[str, tuple[str, list[Term], int]] = {
        "ahead": ("ahead", [(ahead.C, "state->f"), (ahead.D, "state->wanted")], sizes.coordinates + sizes.actuators),
        "sense": ("error", [(np.asarray(loops.sense), "apparent")], k),
        "notched": ("notched", [(behind.C, "state->n"), (behind.D, "raw")], k),
        "driven": ("out->command", [(drive, "notched")], sizes.actuators),
        "led": ("led", [(back, "applied")], k),
        "after": ("next_n", [(behind.A, "state->n"), (behind.B, "raw")], n),
        "shaped": ("next_f", [(ahead.A, "state->f"), (ahead.B, "state->wanted")], s),
        "back": ("raw", [(back, "rest")], k),
        "settled": ("state->n", [(_settled(behind), "raw")], n),
        "still": ("state->f", [(_settled(ahead), "state->wanted")], s),
    }
    return {name: mixed(name, *each) for name, each in sums.items()}


def _direct(step: float) -> str:
    """What a law answers to its error at once."""
    return f"(set->proportional[i] + set->integral[i] * {number(0.5 * step)}) * error[i] + set->derivative[i] * rate[i]"


def _prepare(found: dict[str, _Product], sizes: _Sizes, direct: str) -> tuple[str, ...]:
    return (
        f"for (i = 0; i < {sizes.coordinates}; i++) apparent[i] = out->error[i] + ahead[i];",
        *found["sense"].body,
        f"for (i = 0; i < {sizes.loops}; i++) rate[i] = lead[i] * (error[i] - state->d[i]);",
        f"for (i = 0; i < {sizes.loops}; i++) direct[i] = {direct};",
    )


def _begin(found: dict[str, _Product], sizes: _Sizes, direct: str) -> tuple[str, ...]:
    """States at rest under what is seen, integrators so that the command is that given last."""
    k, f, m = sizes.loops, sizes.coordinates, sizes.actuators
    return (
        *found["still"].body,
        *found["ahead"].body,
        f"for (i = 0; i < {f}; i++) apparent[i] = out->error[i] + ahead[i];",
        *found["sense"].body,
        f"for (i = 0; i < {k}; i++) state->d[i] = error[i];",
        f"for (i = 0; i < {k}; i++) rate[i] = 0.0;",
        f"for (i = 0; i < {k}; i++) direct[i] = {direct};",
        f"for (i = 0; i < {m}; i++) rest[i] = state->last[i] - ahead[{f} + i];",
        *found["back"].body,
        *found["settled"].body,
        f"for (i = 0; i < {k}; i++) state->x[i] = raw[i] - direct[i];",
    )


def _command(found: dict[str, _Product], sizes: _Sizes) -> tuple[str, ...]:
    return (
        f"for (i = 0; i < {sizes.loops}; i++) raw[i] = state->x[i] + direct[i];",
        *found["notched"].body,
        *found["driven"].body,
        f"for (i = 0; i < {sizes.actuators}; i++) out->command[i] += ahead[{sizes.coordinates} + i];",
    )


def _after(found: dict[str, _Product], sizes: _Sizes, step: float) -> tuple[str, ...]:
    return (
        *found["led"].body,
        f"for (i = 0; i < {sizes.loops}; i++) {{",
        f"    next_x[i] = state->x[i] + set->integral[i] * {number(step)} * error[i] + set->tracking[i] * led[i];",
        "    next_d[i] = slow[i] * state->d[i] + (1.0 - slow[i]) * error[i];",
        "    next_e[i] = error[i];",
        "}",
        *found["after"].body,
        *found["shaped"].body,
    )


def _gains(law: Decentralised, laws: list[PID], step: float) -> tuple[tuple[str, Array, str], ...]:
    """What may be changed at run time, with its unit."""
    follows = [step * tracking_rate(each.tracking_time, step) if each.integral else 0.0 for each in laws]
    return (
        ("proportional", np.array([each.proportional for each in laws]), f"gains of the loops {', '.join(law.loops.names)} [1]"),
        ("integral", np.array([each.integral for each in laws]), "[1/s]"),
        ("derivative", np.array([each.derivative for each in laws]), "[s]"),
        ("tracking", np.array(follows), "share by which an integrator follows, in a sample, what a limit took"),
    )


def _derivative_tables(laws: list[PID], step: float) -> tuple[str, ...]:
    """The low-pass filters of derivatives in samples: what is kept of a state, and how quickly it follows."""
    corners = np.array([2.0 * np.pi * each.filter if each.derivative else 0.0 for each in laws])
    slow = (1.0 - 0.5 * corners * step) / (1.0 + 0.5 * corners * step)
    return (*table("slow", slow), *table("lead", corners / (1.0 + 0.5 * corners * step)))


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
