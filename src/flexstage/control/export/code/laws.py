"""Control laws as C: single loops with adjustable gains, or any law as matrices, in modal form for embedded processors."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import reduce

import numpy as np
import scipy

from flexstage.base.number import Array
from flexstage.control.controllers.decentralised import Decentralised, filtered
from flexstage.control.controllers.law import tracking_rate
from flexstage.control.controllers.pi import PI
from flexstage.control.controllers.pid import PID
from flexstage.control.controllers.prefilter import with_prefilters
from flexstage.control.export.code.modal import modal_form
from flexstage.control.export.code.product import product
from flexstage.control.export.code.program import ProgramSetting
from flexstage.control.export.code.text import number, table
from flexstage.control.simulation.machine import Machine
from flexstage.control.simulation.parts import Parts, parts
from flexstage.control.systems.system import System, block_matrices, names_of, select, static
from flexstage.models.linear.model import Channel


@dataclass(frozen=True)
class Core:
    """Controller as C code: state arrays with sizes, settings, and statements.

    `locals` are declared at the head of the step. `command` computes the command from errors and states. `begin` sets the states so that
    the command equals the last applied stroke. `next` computes the next states into arrays `next_<state>`. `tables` are declared at file
    level.
    """

    states: tuple[tuple[str, int], ...]
    tables: tuple[str, ...]
    command: tuple[str, ...]
    next: tuple[str, ...]
    flops: int
    begin: tuple[str, ...] = ()
    settings: tuple[ProgramSetting, ...] = ()
    locals: tuple[str, ...] = ()
    prepare: tuple[str, ...] = ()


def law_as_c(given: Machine, law: Decentralised | None) -> Core:
    """Generate the controller of a loop as C code: individual loops for PI and PID, modal form for any other controller."""
    laws = [] if law is None else [_as_pid(each) for each in law.laws if isinstance(each, (PI, PID))]
    if law is not None and len(laws) == len(law.laws):
        return _single_loops(given, law, laws)
    linear = parts(replace(given, controller=modal_form(given.controller)))
    core, begin = matrix_core(linear), product("begin", "state->z", _start(linear), len(linear.controller))
    return replace(core, tables=(*core.tables, *begin.tables), begin=begin.body)


def matrix_core(linear: Parts) -> Core:
    """Generate any controller from its matrices. The command is C z + ..., the next states are A z + ..., with the states z.

    >>> from flexstage.control.example import integral_loop
    >>> from flexstage.control.simulation.machine import machine
    >>> example = integral_loop()
    >>> matrix_core(parts(machine(example.plant, example.controller))).states
    (('z', 1),)
    """
    known, wanted, pose, states = "state->z", "state->wanted", "out->pose", len(linear.controller)
    terms = [(linear.command, known), (linear.command_r, wanted), (linear.command_q, pose)]
    command = product("command", "out->command", terms, len(linear.command))
    entering = [(linear.from_reference, wanted), (linear.from_pose, pose), (linear.from_applied, "applied")]
    after = product("following", "next_z", [(linear.controller, known), *entering], states)
    return Core((("z", states),), (*command.tables, *after.tables), command.body, after.body, command.flops + after.flops)


def _start(linear: Parts) -> list[tuple[Array, str]]:
    """Equilibrium states for the present inputs; integrators such that the command equals the last applied one."""
    A, f = linear.controller, linear.from_reference.shape[1]
    slow = np.abs(np.diag(A) - 1.0) < 1e-9
    slow &= np.count_nonzero(np.abs(A) > 1e-300, axis=1) == 1
    fast = np.flatnonzero(~slow)
    entry = np.hstack([linear.from_reference, linear.from_pose])
    rest, lead = np.zeros_like(entry), np.zeros((len(A), len(linear.command)))
    rest[fast] = np.linalg.lstsq(np.eye(len(fast)) - A[np.ix_(fast, fast)], entry[fast], rcond=None)[0]
    lead[slow] = np.linalg.pinv(linear.command[:, slow])
    begin = rest - lead @ (linear.command @ rest + np.hstack([linear.command_r, linear.command_q]))
    return [(lead, "state->last"), (begin[:, :f], "state->wanted"), (begin[:, f:], "out->pose")]


def _single_loops(given: Machine, law: Decentralised, laws: list[PID]) -> Core:
    """Single loops: gains are settings; notches, prefilters and feedforward are fixed."""
    step, sense, drive = given.step, law.loops.sense, law.loops.drive
    behind, ahead = _notches(law, step), _ahead(law, step)
    k, f, m, n, s = len(laws), len(given.names), len(given.actuators), len(behind.A), len(ahead.A)
    back, half, whole = np.linalg.pinv(drive), number(0.5 * step), number(step)
    shaped = product("ahead", "ahead", [(ahead.C, "state->f"), (ahead.D, "state->wanted")], f + m)
    sensed = product("error", "error", [(sense, "apparent")], k)
    notched = product("notched", "notched", [(behind.C, "state->n"), (behind.D, "raw")], k)
    driven = product("driven", "out->command", [(drive, "notched")], m)
    led = product("led", "led", [(back, "applied")], k)
    after = product("next_n", "next_n", [(behind.A, "state->n"), (behind.B, "raw")], n)
    shape = product("next_f", "next_f", [(ahead.A, "state->f"), (ahead.B, "state->wanted")], s)
    undriven = product("raw", "raw", [(back, "rest")], k)
    settled = product("settled", "state->n", [(_settled(behind), "raw")], n)
    still = product("still", "state->f", [(_settled(ahead), "state->wanted")], s)
    each_step = (shaped, sensed, notched, driven, led, after, shape)
    seen = (*shaped.body, f"for (i = 0; i < {f}; i++) apparent[i] = out->error[i] + ahead[i];", *sensed.body)
    direct = (
        f"for (i = 0; i < {k}; i++) direct[i] = (set->proportional[i] + set->integral[i] * {half}) * error[i] + "
        "set->derivative[i] * rate[i];"
    )
    arrays = {"ahead": f + m, "apparent": f, "error": k, "rate": k, "direct": k, "raw": k, "notched": k, "led": k, "rest": m}
    return Core(
        (("x", k), ("d", k), ("e", k), ("n", n), ("f", s)),
        (*_derivative_tables(laws, step), *(line for each in (*each_step, undriven, settled, still) for line in each.tables)),
        (
            f"for (i = 0; i < {k}; i++) raw[i] = state->x[i] + direct[i];",
            *notched.body,
            *driven.body,
            f"for (i = 0; i < {m}; i++) out->command[i] += ahead[{f} + i];",
        ),
        (
            *led.body,
            f"for (i = 0; i < {k}; i++) {{",
            f"    next_x[i] = state->x[i] + set->integral[i] * {whole} * error[i] + set->tracking[i] * led[i];",
            "    next_d[i] = slow[i] * state->d[i] + (1.0 - slow[i]) * error[i];",
            "    next_e[i] = error[i];",
            "}",
            *after.body,
            *shape.body,
        ),
        sum(each.flops for each in each_step) + 17 * k + f + m,
        begin=(
            *still.body,
            *seen,
            f"for (i = 0; i < {k}; i++) state->d[i] = error[i];",
            f"for (i = 0; i < {k}; i++) rate[i] = 0.0;",
            direct,
            f"for (i = 0; i < {m}; i++) rest[i] = state->last[i] - ahead[{f} + i];",
            *undriven.body,
            *settled.body,
            f"for (i = 0; i < {k}; i++) state->x[i] = raw[i] - direct[i];",
        ),
        settings=_gains(law, laws, step),
        locals=tuple(f"double {array}[{size}];" for array, size in arrays.items()),
        prepare=(*seen, f"for (i = 0; i < {k}; i++) rate[i] = lead[i] * (error[i] - state->d[i]);", direct),
    )


def _settled(system: System) -> Array:
    """Equilibrium states (s, m) of a system for unit inputs: (I - A)^-1 B."""
    return np.linalg.solve(np.eye(len(system.A)) - system.A, system.B)


def _gains(law: Decentralised, laws: list[PID], step: float) -> tuple[ProgramSetting, ...]:
    """Settings that may change at run time, with their units."""
    meanings = {
        "proportional": f"proportional gains of the loops {', '.join(law.loops.names)} [1]",
        "integral": "integral gains [1/s]",
        "derivative": "derivative gains [s]",
    }
    follows = [step * tracking_rate(each.tracking_time, step) if each.integral else 0.0 for each in laws]
    return (
        *(ProgramSetting(name, np.array([getattr(each, name) for each in laws]), meaning) for name, meaning in meanings.items()),
        ProgramSetting("tracking", np.array(follows), "anti-windup: correction per sample over (applied - commanded)"),
    )


def _derivative_tables(laws: list[PID], step: float) -> tuple[str, ...]:
    """Sampled low-pass filters of derivatives: decay factor of the state, and input rate."""
    corners = np.array([2.0 * np.pi * each.filter if each.derivative else 0.0 for each in laws])
    slow = (1.0 - 0.5 * corners * step) / (1.0 + 0.5 * corners * step)
    return (*table("slow", slow), *table("lead", corners / (1.0 + 0.5 * corners * step)))


def _as_pid(law: PI | PID) -> PID:
    """PI as a PID without derivative."""
    return law if isinstance(law, PID) else PID(law.proportional, law.integral, 0.0, 1.0, law.tracking)


def _notches(law: Decentralised, step: float) -> System:
    """Notches of all loops in modal form."""
    port = (Channel("raw", "m"),)
    groups = [[each.system(step) for each in group] for group in law.notches or ((),) * len(law.laws)]
    chains = [modal_form(reduce(filtered, group, static(np.eye(1), port, port, step))) for group in groups]
    names = tuple(Channel(f"loop{place}", "m") for place in range(len(chains)))
    A, B, C, D = block_matrices(chains)
    return System(A, B, C, D, names, names, step)


def _ahead(law: Decentralised, step: float) -> System:
    """Prefilters and feedforward: from the reference to the additions to errors and commands."""
    coordinates = law.loops.coordinates
    f, m = len(coordinates.names), len(coordinates.actuators)
    wanted = coordinates.motions("reference.")
    outputs = tuple(Channel(f"out{place}", "m") for place in range(f + m))
    forward = np.zeros((m, f)) if law.feedforward is None else np.asarray(law.feedforward)
    plain = static(scipy.linalg.block_diag(np.eye(f), forward), (*coordinates.motions("error."), *wanted), outputs, step)
    whole = with_prefilters(plain, law.prefilters, law.loops.sense, coordinates)
    return select(whole, names_of(wanted), whole.output_names)
