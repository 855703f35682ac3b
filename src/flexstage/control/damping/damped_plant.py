"""A plant with force feedback in its legs: what the loop of the pose is closed around (high authority on low authority)."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Annotated, ClassVar

import numpy as np
import scipy

from flexstage.base.finding import refuse
from flexstage.base.number import Array, Table
from flexstage.base.record import INNER, VIEW, Along, Heading, Layout
from flexstage.base.units.quantity import FREQUENCY, RATE
from flexstage.control.damping.force_feedback import ForceFeedback, damping_of_pair, most_damping
from flexstage.control.damping.legs import Leg, Pairs
from flexstage.control.plant_models.plants import ADDED, SENSED, Plant
from flexstage.control.plant_models.reduction import residualise, resonances
from flexstage.control.systems.system import System, connect, rename, select
from flexstage.models.linear.model import Channel
from flexstage.spatial.frame import COMPONENTS, FORCES

_FIRST, _LAST, _GAINS, _HALVINGS = 3e-3, 10.0, 70, 8
_SLOW, _LINES = 1e-3, 200


@dataclass(frozen=True)
class DampedMode:
    """A mode of the plant: its `frequency` [Hz] and damping `ratio` without the inner loops, and what they make of both.

    `zero` [Hz] is its frequency without the stacks' axial stiffness; `most` the damping that a single leg, or decoupled legs, can give it,
    (w - z)/(2 z), and `alone` what they give it with this gain if no other mode were near.
    """

    TABLE: ClassVar[Layout] = Layout(
        "Integral force feedback (IFF) in the legs",
        "frequency zero ratio most alone damped_frequency damped_ratio",
        notes=(
            (
                "Transmission zero z: the frequency without the stacks' axial stiffness. Maximum damping: (w - z)/(2 z), of one leg or "
                "decoupled legs. Isolated mode: with this gain, no other mode near, no damping of its own and no lag of the amplifier."
            ),
        ),
    )

    frequency: Annotated[float, FREQUENCY, Heading("mode", digits=4)]
    ratio: Annotated[float, Heading("damping ratio", unit="%")]
    zero: Annotated[float, FREQUENCY, Heading("transmission zero", digits=4)]
    damped_frequency: Annotated[float, FREQUENCY, Heading("mode with IFF", digits=4)]
    damped_ratio: Annotated[float, Heading("damping ratio with IFF", unit="%")]
    alone: Annotated[float, Heading("damping, isolated mode", unit="%")]
    most: Annotated[float, Heading("maximum damping", unit="%")]


@dataclass(frozen=True, eq=False)
class ActiveDamping:
    """Force feedback in the `legs`, by its `gain` [1/s] and the `corner` [Hz] of its high pass of that `order`.

    `modes` are those of the plant. By `coordinates`, `left_at_rest` is the share of the platform's static stiffness that is left,
    `softest` the least share below the first mode, at `softest_at` [Hz]. A leg keeps more than half its axial stiffness below `kept_below`
    [Hz] (order 1: below none). `rate` [Hz] is that of the computer that runs it, absent where it is analogue. `reached` is the least
    damping ratio of the modes that the loop feels most, as many as it has coordinates.
    """

    TABLE: ClassVar[Layout] = Layout(
        "Remaining stiffness with IFF",
        "left_at_rest softest softest_at",
        notes=("Share of the platform's static stiffness at rest, and the lowest below the first mode.",),
    )

    legs: tuple[str, ...]
    gain: Annotated[float, RATE]
    corner: Annotated[float, FREQUENCY]
    order: int
    kept_below: Annotated[float, FREQUENCY]
    modes: tuple[DampedMode, ...]
    coordinates: tuple[str, ...]
    left_at_rest: Annotated[Array, Along("coordinates"), Heading("at rest", unit="%")]
    softest: Annotated[Array, Along("coordinates"), Heading("lowest", unit="%")]
    softest_at: Annotated[Array, FREQUENCY, Along("coordinates"), Heading("at frequency", digits=4)]
    law: Annotated[ForceFeedback, INNER]
    sensed: Annotated[tuple[Leg, ...], INNER]
    reached: float
    rate: Annotated[float | None, FREQUENCY] = None

    @property
    def min_ratio(self) -> Annotated[float, VIEW]:
        """The least damping ratio of all modes of the plant."""
        return min(each.damped_ratio for each in self.modes)


def close_damping(given: Plant, law: ForceFeedback, legs: tuple[Leg, ...]) -> Plant:
    """The plant with the inner loops closed; `given` has the links' forces `<link>.fx`, which it then no longer has.

    Their strokes are added before the amplifiers, and are outputs `added.<actuator>` [m]. Inputs `sensed.<actuator>` [N] are what the
    sensors hear besides the tension.
    """
    inner = [
        law.system(each.stiffness, Channel(f"tension.{each.actuator}", "N"), Channel(f"{ADDED}.{each.actuator}", "m")) for each in legs
    ]
    heard = tuple(Channel(f"{SENSED}.{each.actuator}", "N") for each in legs)
    gone = {f"{each.sensed}.fx" for each in legs}
    kept = [name for name in given.system.output_names if name not in gone]
    count = len(law.denominator) - 1
    states = (f"damping.{each.actuator}.{number + 1}" for each in legs for number in range(count))
    return replace(
        given,
        system=around_legs(given, legs, inner, (*kept, *(f"{ADDED}.{each.actuator}" for each in legs)), heard),
        states=(*given.states, *states),
        note=f"{given.note}; force feedback in the legs of {', '.join(each.actuator for each in legs)}",
        heard=Table({f"{SENSED}.{each.actuator}": each.noise for each in legs if each.noise}),
    )


def around_legs(
    given: Plant, legs: tuple[Leg, ...], inner: Sequence[System], outputs: Iterable[str], heard: tuple[Channel, ...] = ()
) -> System:
    """The plant with an inner system around each leg, from `tension.<actuator>` [N] to an addition to its stroke; `heard` adds to it."""
    entries, links = {each.actuator: f"entry.{each.actuator}" for each in legs}, dict[str, dict[str, float]]()
    for number, (each, sign) in enumerate(zip(legs, tension_signs(given, legs), strict=True)):
        links[entries[each.actuator]] = {each.actuator: 1.0, inner[number].output_names[0]: 1.0}
        links[f"tension.{each.actuator}"] = {f"{each.sensed}.fx": sign} | ({heard[number].name: 1.0} if heard else {})
    return connect([rename(given.system, entries), *inner], links, (*given.system.inputs, *heard), outputs)


def as_felt(given: Plant, legs: tuple[Leg, ...]) -> tuple[Leg, ...]:
    """The legs with the axial stiffness that a plant's modes feel: stack and hinges in series, tension per stroke far above these modes."""
    forces = select(given.system, [each.actuator for each in legs], [f"{each.sensed}.fx" for each in legs])
    slow = np.array([not name.startswith("amplifier.") for name in given.states])
    direct = np.diag(residualise(forces, slow).D)
    return tuple(replace(each, stiffness=abs(float(value))) for each, value in zip(legs, direct, strict=True))


def tension_signs(given: Plant, legs: tuple[Leg, ...]) -> list[float]:
    """Which sign of a link's force is tension: a stroke that pushes takes it down."""
    static = select(given.system, [each.actuator for each in legs], [f"{each.sensed}.fx" for each in legs]).transfer(np.zeros(1))[0].real
    return [-float(np.sign(value)) for value in np.diag(static)]


def follow_poles(given: Plant, law: ForceFeedback, legs: tuple[Leg, ...], gains: Array) -> Array:
    """Poles (len(gains), k) [1/s] that the plant's modes come to as the gain grows through `gains`, each followed from its mode."""
    modes, found = _modal_poles(given), []
    for gain in gains:
        poles = close_damping(given, replace(law, gain=float(gain)), legs).system.poles
        poles = poles[np.imag(poles) >= -1e-9 * np.abs(poles)]
        distance = np.abs(modes[:, None] - poles[None, :])
        modes = poles[scipy.optimize.linear_sum_assignment(distance)[1]] if len(poles) >= len(modes) else poles[np.argmin(distance, axis=1)]
        found.append(modes)
    return np.array(found)


def _modal_poles(given: Plant) -> Array:
    turning, ratios = 2.0 * np.pi * given.frequencies, given.ratios
    return turning * (-ratios + 1j * np.sqrt(1.0 - ratios**2))


def gain_for(given: Plant, law: ForceFeedback, legs: tuple[Leg, ...], wanted: float) -> float:
    """The least gain [1/s] that gives the modes which the loop feels most a damping ratio of `wanted`; else that which gives them the most.

    Those are as many as the loop has coordinates. Raises `DesignError` where the inner loops are stable with no gain.
    """
    felt = felt_most(given)
    scale = 2.0 * np.pi * float(np.median(given.frequencies[felt]))
    gains = scale * np.geomspace(_FIRST, _LAST, _GAINS)
    poles = follow_poles(given, law, legs, gains)
    ratios = np.min(_ratios(poles[:, felt]), axis=1)
    steady = [close_damping(given, replace(law, gain=float(gain)), legs).system.growth < 0.0 for gain in (gains[0],)]
    if not steady[0]:
        raise refuse(
            "damping",
            f"with a gain of {gains[0]:.3g} 1/s the inner loops are unstable already",
            "Take a shorter delay and faster amplifiers",
        )
    reached = np.flatnonzero(ratios >= wanted)
    chosen = float(gains[reached[0]] if len(reached) else gains[np.argmax(ratios)])
    while close_damping(given, replace(law, gain=chosen), legs).system.growth >= 0.0:
        chosen *= 0.8
    return chosen


def felt_most(given: Plant) -> Array:
    """Places of the modes that a plant's loop feels most, as many as it has coordinates."""
    return np.argsort(-resonances(given))[: len(given.coordinates.names)]


def _ratios(poles: Array) -> Array:
    return -np.real(poles) / np.abs(poles)


def describe_damping(given: Plant, damped: Plant, law: ForceFeedback, legs: tuple[Leg, ...], pairs: Pairs) -> ActiveDamping:
    """What the inner loops do to the modes and to the platform's stiffness; `pairs` are all modes of the model."""
    gains = law.gain * np.geomspace(1e-2, 1.0, 40)
    poles = follow_poles(given, law, legs, gains)[-1]
    modes = []
    for frequency, ratio, pole in zip(given.frequencies, given.ratios, poles, strict=True):
        zero = float(pairs.others[np.argmin(np.abs(pairs.frequencies - frequency))])
        alone = damping_of_pair(law, float(frequency), zero)
        modes.append(
            DampedMode(
                frequency=float(frequency),
                ratio=float(ratio),
                zero=zero,
                damped_frequency=float(np.abs(pole)) / (2.0 * np.pi),
                damped_ratio=float(_ratios(pole)),
                alone=float(_ratios(np.array(alone))),
                most=most_damping(float(frequency), zero),
            )
        )
    lines = np.append(0.0, np.geomspace(_SLOW * given.frequencies[0], 0.5 * given.frequencies[0], _LINES))
    shares = np.abs(_compliances(given, lines)) / np.abs(_compliances(damped, lines))
    place = np.argmin(shares, axis=0)
    return ActiveDamping(
        legs=tuple(each.actuator for each in legs),
        gain=law.gain,
        corner=law.corner,
        order=law.order,
        kept_below=law.kept_below,
        modes=tuple(modes),
        coordinates=given.coordinates.names,
        left_at_rest=shares[0],
        softest=np.min(shares, axis=0),
        softest_at=lines[place],
        law=law,
        sensed=legs,
        reached=min(modes[place].damped_ratio for place in felt_most(given)),
    )


def _compliances(given: Plant, lines: Array) -> Array:
    """What the platform gives way (lines, f) along each coordinate to a force along it."""
    rows = [COMPONENTS.index(name) for name in given.coordinates.names]
    wrenches, motions = [f"platform.{FORCES[row]}" for row in rows], [f"relative.{COMPONENTS[row]}" for row in rows]
    return np.einsum("fkk->fk", select(given.system, wrenches, motions).transfer(lines))


def with_damped_modes(damped: Plant, found: ActiveDamping) -> Plant:
    """The plant with frequencies and damping ratios of its modes as the inner loops leave them, ascending."""
    frequencies = np.array([each.damped_frequency for each in found.modes])
    ratios = np.clip([each.damped_ratio for each in found.modes], 1e-6, 1.0)
    order = np.argsort(frequencies, kind="stable")
    return replace(damped, frequencies=frequencies[order], ratios=ratios[order])
