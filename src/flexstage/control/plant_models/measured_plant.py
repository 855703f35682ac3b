"""Plant identified in a test: modes and delay from strokes to gauges are identified, all other responses follow from the model."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
import scipy

from flexstage.base.finding import Finding, require, suggest_nearest
from flexstage.base.number import Array
from flexstage.base.units.dimension import dimension_of
from flexstage.control.plant_models.coordinates import Coordinates
from flexstage.control.plant_models.plants import Plant
from flexstage.control.plant_models.reduction import mode_names
from flexstage.control.systems.system import System, block_matrices, connect, lag, select
from flexstage.experiment.identification.diagnosis.lateness import common_delay
from flexstage.experiment.identification.identified import Identified
from flexstage.experiment.identification.residues import modal_sum
from flexstage.experiment.records.record import Channel as Recorded
from flexstage.experiment.records.unit import same_dimension, unit_problem
from flexstage.mechanism.mechanism import GROUND
from flexstage.models.linear.eigen import eigen
from flexstage.models.linear.model import Channel, LinearModel

_ALIKE, _APART = 0.7, 0.5
_BESIDE = 0.05
_LEAST = 0.5
_BELOW = 1.2


def measured_plant(given: Plant, model: LinearModel, found: Identified) -> Plant:
    """Replace the model's response from strokes to gauges by the identified modes, static term and delay.

    The new response is the sum of the identified modes and a matrix D, followed by the gauges' specified lags and an identified delay. D is
    the remainder of the identified response: a real constant, fitted up to the highest mode (for force actuators, over the whole band). D
    also contains the effect of the modes above the test's band. The identified response includes amplifiers and filters, so the hardware of
    the result omits them. The identified delay is added to the loop's delay. Platform motion in a loop coordinate is computed from the
    gauge readings. Ground motion and wrenches act on the model, whose modes have the frequency and damping of the paired identified modes.

    Raises `DesignError` if inputs and outputs are not the stage's actuators and gauges, and if the modes do not match the stage.
    """
    require(_channel_findings(given.coordinates, found))
    pairs = pair_modes(given, model, found)
    require(_stage_findings(given, found, pairs))
    rows, columns, outer, inner = channel_places(given.coordinates, found)
    lags = 2.0 * np.pi * np.array([given.hardware.sensors[name].bandwidth for name in given.gauges])
    ahead = _before_lags(found, rows, lags)
    late = common_delay(ahead)
    delay = 0.0 if late is None else late.value
    participation = ahead.participation * np.exp(ahead.poles * delay)[:, None]
    direct = _static_term(ahead, participation, delay, mass_line=given.coordinates.forced)[np.ix_(rows, columns)]
    sizes = outer[:, None], 1.0 / inner
    moved = _modal_system(
        found.poles, ahead.shapes[rows] * sizes[0], participation[:, columns] * sizes[1], direct * sizes[0] * sizes[1], given
    )
    seen = lag(moved.outputs, lags / (2.0 * np.pi), given.coordinates.readings("measured."))
    driven = connect([moved, seen], {}, given.coordinates.commands(), seen.output_names)
    hardware = replace(
        given.hardware,
        delay=given.hardware.delay + delay,
        amplifiers={name: replace(each, bandwidth=np.inf) for name, each in given.hardware.amplifiers.items()},
        sensors={name: replace(each, filter_order=0) for name, each in given.hardware.sensors.items()},
    )
    system = _together(given, driven, _retuned(given, pairs, found))
    driven_by = "inputs" if given.coordinates.forced else "strokes"
    copies = (len(system.A) - len(driven.A)) // max(1, len(given.states))
    return Plant(
        system=system,
        states=(
            *(f"mode{number + 1}{mark}" for number in range(len(found.poles)) for mark in ("", "'")),
            *(f"gauge.{name}" for name, each in zip(given.gauges, lags, strict=True) if np.isfinite(each)),
            *(f"design{number + 1}.{name}" for number in range(copies) for name in given.states),
        ),
        coordinates=given.coordinates,
        hardware=hardware,
        frequencies=found.frequencies,
        ratios=found.damping,
        left_out=0,
        note=f"{driven_by} to gauges as measured: {len(found.poles)} modes, delay {1e6 * delay:.4g} us; ground motion by the model",
        provenance=found.provenance,
    )


def pair_modes(given: Plant, model: LinearModel, found: Identified) -> list[tuple[int, int]]:
    """Pair model modes with identified modes, if their modal assurance (MAC) at the gauges exceeds 0.7.

    Returns the indices of a model mode (among the plant's retained modes) and of an identified mode for each pair.

    The two frequencies of a pair differ by less than a factor of e^0.5. Modes with close frequencies mix. An identified shape is therefore
    compared with the space spanned by the model mode and all model modes within 5 % of its frequency.
    """
    shapes = np.real(model.output[model.output_index(given.coordinates.gauges)] @ eigen(model).shapes[:, _kept(given)])
    seen = found.real_shapes[channel_places(given.coordinates, found)[0]].T
    columns = range(len(given.frequencies))
    assurance = np.array([[_assurance(each, shapes, given.frequencies, column) for column in columns] for each in seen])
    assurance = assurance.reshape(len(seen), len(columns))
    apart = np.abs(np.log(found.frequencies[:, None] / given.frequencies))
    solved = zip(*scipy.optimize.linear_sum_assignment(1.0 - assurance + apart), strict=True)
    return [(mode, other) for other, mode in solved if assurance[other, mode] > _ALIKE and apart[other, mode] < _APART]


def _kept(given: Plant) -> list[int]:
    """Indices of the model modes retained in the plant."""
    return [int(name.removeprefix("mode")) - 1 for name in mode_names(given)]


def _assurance(seen: Array, shapes: Array, frequencies: Array, column: int) -> float:
    near = np.abs(frequencies / frequencies[column] - 1.0) < _BESIDE
    basis = scipy.linalg.orth(shapes[:, near])
    return np.sum((basis.T @ seen) ** 2) / np.sum(seen**2)


def _stage_findings(given: Plant, found: Identified, pairs: list[tuple[int, int]]) -> Iterator[Finding]:
    if not len(found.frequencies):
        yield Finding("--record", "no identified mode", "Record longer, or increase the drive: see flexstage identify")
        return
    below = found.frequencies <= _BELOW * given.frequencies[min(len(given.coordinates.names), len(given.frequencies)) - 1]
    count, alike = np.sum(below), sum(below[other] for _, other in pairs)
    ours = ", ".join(f"{each:.4g}" for each in given.frequencies[:6])
    theirs = ", ".join(f"{each:.4g}" for each in found.frequencies[:6])
    if not count:
        what = f"all identified modes ({theirs} Hz) are above the stage's first modes ({ours} Hz): probably another stage or a short record"
        yield Finding("--record", what, "Record longer or in a lower band, or use the design of the tested stage")
    elif alike < _LEAST * count or not pairs:
        what = f"only {alike} of the {count} lowest identified modes ({theirs} Hz) match the stage ({ours} Hz): probably another stage"
        yield Finding("--record", what, "Use the design of the tested stage; check for exchanged channels with flexstage identify --stage")


def _channel_findings(loop: Coordinates, found: Identified) -> Iterator[Finding]:
    """Findings for missing channels, and units that contradict the stage's."""
    units = {each.name: each.unit for each in (*loop.commands(), *loop.readings())}
    for kind, wanted, there in (("input", loop.actuators, found.inputs), ("output", loop.gauges, found.outputs)):
        names = [channel.name for channel in there]
        for name in wanted:
            if name not in names:
                yield Finding(
                    f"--record: {name}",
                    f"no {kind} channel in the record has this name",
                    f"{suggest_nearest(name, names)}; a loop needs all actuators and gauges",
                )
                continue
            unit = there[names.index(name)].unit
            if unit_problem(unit) is not None or not same_dimension(unit, units[name]):
                what = f'wrong unit (got "{unit}", expected {units[name]})'
                yield Finding(
                    f"--record: {name}", what, "Record free strokes (or inputs of force actuators) and gauge readings, with their units"
                )


def channel_places(loop: Coordinates, found: Identified) -> tuple[list[int], list[int], Array, Array]:
    """Find the channels of a loop in a test: rows of the gauges, columns of the actuators, and unit factors of both."""
    rows = [[channel.name for channel in found.outputs].index(name) for name in loop.gauges]
    columns = [[channel.name for channel in found.inputs].index(name) for name in loop.actuators]
    return rows, columns, _sizes(found.outputs, rows, loop.readings()), _sizes(found.inputs, columns, loop.commands())


def _sizes(channels: tuple[Recorded, ...], chosen: list[int], own: tuple[Channel, ...]) -> Array:
    pairs = zip(chosen, own, strict=True)
    return np.array([float(dimension_of(channels[number].unit).size / dimension_of(each.unit).size) for number, each in pairs])


def _before_lags(found: Identified, rows: list[int], lags: Array) -> Identified:
    """Identified residues and responses with the gauges' lags removed, 1 + s/omega_g, and the delay restored."""
    every = np.full(len(found.outputs), np.inf)
    every[rows] = lags
    back = found.participation * np.exp(-found.poles * found.delay)[:, None]
    shapes = found.shapes * (1.0 + found.poles / every[:, None])
    lines = 2j * np.pi * found.responses.frequencies
    values = found.responses.values * (1.0 + lines[:, None] / every)[:, :, None]
    return replace(found, shapes=shapes, participation=back, responses=replace(found.responses, values=values), delay=0.0)


def _static_term(found: Identified, participation: Array, delay: float, *, mass_line: bool) -> Array:
    """Residual real constant (p, m) of the responses after the modes, by least squares up to the highest mode.

    With the `mass_line`, all lines count, by relative errors: loops on forces cross over above the modes, where the motion is small.
    """
    lines = found.responses.frequencies
    highest = np.inf if mass_line else np.max(found.frequencies)
    chosen = (lines >= found.band[0]) & (lines <= min(found.band[1], highest))
    lines = lines[chosen]
    earlier = np.exp(2j * np.pi * lines * delay)[:, None, None]
    modal = modal_sum(lines, found.poles, found.shapes, participation)
    left = found.responses.values[chosen] * earlier - modal
    away = np.min(np.abs(lines[:, None] / found.frequencies - 1.0) / found.damping, axis=1)
    weights = np.broadcast_to(np.minimum(away / 5.0, 1.0)[:, None, None] ** 2, left.shape)
    weights = weights / np.abs(modal) ** 2 if mass_line else weights
    return np.real(np.sum(weights * left, axis=0)) / np.sum(weights, axis=0)


def _modal_system(poles: Array, shapes: Array, drives: Array, direct: Array, given: Plant) -> System:
    """Real system of sum phi l/(s - p) + conjugate + D, two states per mode: z' = p z + l u, y = 2 Re(phi z)."""
    count, sizes = len(poles), np.abs(poles)  # states of the size of the motion, not of its rate over it
    A = scipy.linalg.block_diag(*([[pole.real, -pole.imag], [pole.imag, pole.real]] for pole in poles))
    B = np.stack([np.real(drives), np.imag(drives)], axis=1) / sizes[:, None, None]
    C = 2.0 * sizes[:, None] * np.stack([np.real(shapes), -np.imag(shapes)], axis=-1)
    inputs, outputs = given.coordinates.commands(), given.coordinates.readings("ahead.")
    return System(A, B.reshape(2 * count, -1), C.reshape(-1, 2 * count), direct, inputs, outputs)


def _retuned(given: Plant, pairs: list[tuple[int, int]], found: Identified) -> System:
    """Model system with frequency and damping of its modes replaced by the identified ones.

    Ground stiffness scales with the squared frequency, ground damping with the rate: the stage still follows slow ground motion.
    """
    A, B = given.system.A.copy(), given.system.B.copy()
    ground = [column for column, name in enumerate(given.system.input_names) if name.startswith(f"{GROUND}.")]
    for mode, other in pairs:
        name = f"mode{_kept(given)[mode] + 1}"
        place, rate = given.states.index(name), given.states.index(f"{name}'")
        omega = 2.0 * np.pi * float(found.frequencies[other])
        stiffer, damped = -(omega**2) / A[rate, place], -2.0 * found.damping[other] * omega / A[rate, rate]
        pushed = (B[rate, ground] - A[rate, rate] * B[place, ground]) * stiffer
        A[rate, place], A[rate, rate] = A[rate, place] * stiffer, A[rate, rate] * damped
        B[place, ground] *= damped
        B[rate, ground] = pushed + A[rate, rate] * B[place, ground]
    return replace(given.system, A=A, B=B)


def _together(given: Plant, driven: System, rest: System) -> System:
    """Combined outputs: gaps by both; loop coordinates from the gauges for strokes; all other motions by the model."""
    loop, names, gaps = given.coordinates, rest.output_names, given.coordinates.gaps
    measured = dict(zip(gaps, np.eye(len(gaps)), strict=True))
    measured |= {f"{kind}.{name}": row for kind in ("platform", "relative") for name, row in zip(loop.names, loop.pose, strict=True)}
    inside = [name for name in names if name not in measured]
    others = [name for name in rest.input_names if name not in loop.actuators]
    parts = [driven, *([select(rest, loop.actuators, inside)] if inside else []), select(rest, others, names)]
    A, B, C, D = block_matrices(parts)
    own = [measured.get(name, np.zeros(len(gaps))) for name in names]
    total = np.hstack([own, *([_same(names, inside)] if inside else []), np.eye(len(names))])
    entry = _same([name for part in parts for name in part.input_names], rest.input_names)
    return System(A, B @ entry, total @ C, total @ D @ entry, rest.inputs, rest.outputs)


def _same(rows: Sequence[str], columns: Sequence[str]) -> Array:
    """Matrix with 1 at equal names."""
    return np.array([[float(row == column) for column in columns] for row in rows])
