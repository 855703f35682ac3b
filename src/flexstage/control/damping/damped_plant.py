"""Plant with force feedback in its legs (low authority) inside the pose loop (high authority)."""

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
    """Mode of the plant: `frequency` [Hz] and damping `ratio` without the inner loops, `damped_frequency` and `damped_ratio` with them.

    `zero` z [Hz] is the mode's frequency without the stacks' axial stiffness. `most` is the maximum damping ratio for one leg or decoupled
    legs: (w - z)/(2 z), with w = `frequency`. `alone` is the damping ratio that the present gain would give this mode without other modes.
    """

    TABLE: ClassVar[Layout] = Layout(
        "Integral force feedback (IFF) in the legs",
        "frequency zero ratio most alone damped_frequency damped_ratio",
        notes=(
            (
                "The mode frequency is w, or z (transmission zero) without the stacks' axial stiffness. The maximum damping (w - z)/(2 z) "
                "holds for one leg or decoupled legs. Damping, isolated mode: without other modes, structural damping and amplifier lag."
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
    """Integral force feedback in the `legs` with `gain` [1/s]; its high-pass filter has a `corner` frequency [Hz] and an `order`.

    `modes` are the plant's modes. For each of the `coordinates`, `left_at_rest` is the fraction of the platform's static stiffness that
    remains with the feedback. `softest` is the lowest remaining fraction of the dynamic stiffness, at frequencies up to half the first
    modal frequency; it occurs at `softest_at` [Hz]. Below the frequency `kept_below` [Hz], a leg keeps more than half its axial stiffness.
    `rate` [Hz] is the sampling rate, None for analogue feedback. `reached` is the lowest damping ratio of the dominant modes. The dominant
    modes are the modes with the largest residues, as many as the loop has coordinates.
    """

    TABLE: ClassVar[Layout] = Layout(
        "Remaining stiffness with IFF",
        "left_at_rest softest softest_at",
        notes=(
            "Fraction of the platform's stiffness that remains at 0 Hz, and the smallest fraction below half the first mode's frequency.",
        ),
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
        """Lowest damping ratio of all modes of the plant."""
        return min(each.damped_ratio for each in self.modes)


def close_damping(given: Plant, law: ForceFeedback, legs: tuple[Leg, ...]) -> Plant:
    """Close the inner loops of a plant. The plant's outputs must include the link forces `<link>.fx`, which the result omits.

    The inner loops add their strokes to the inputs of the amplifiers; these strokes are also outputs `added.<actuator>` [m]. The inputs
    `sensed.<actuator>` [N] are noise, added to the measured tensions.
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
    """Connect an inner system to each leg, from its tension [N] to an added stroke. The inputs `heard` are noise, added to the tensions."""
    entries, links = {each.actuator: f"entry.{each.actuator}" for each in legs}, dict[str, dict[str, float]]()
    for number, (each, sign) in enumerate(zip(legs, tension_signs(given, legs), strict=True)):
        links[entries[each.actuator]] = {each.actuator: 1.0, inner[number].output_names[0]: 1.0}
        links[f"tension.{each.actuator}"] = {f"{each.sensed}.fx": sign} | ({heard[number].name: 1.0} if heard else {})
    return connect([rename(given.system, entries), *inner], links, (*given.system.inputs, *heard), outputs)


def with_series_stiffness(given: Plant, legs: tuple[Leg, ...]) -> tuple[Leg, ...]:
    """Return the legs with the effective stiffness of stack and hinges in series: tension divided by stroke far above the plant's modes."""
    slow = np.array([not name.startswith("amplifier.") for name in given.states])
    direct = np.diag(residualise(_forces(given, legs), slow).D)
    return tuple(replace(each, stiffness=abs(float(value))) for each, value in zip(legs, direct, strict=True))


def tension_signs(given: Plant, legs: tuple[Leg, ...]) -> list[float]:
    """Return the signs (1 or -1) that convert link forces to tensions: a positive stroke reduces the tension."""
    return [-float(np.sign(value)) for value in np.diag(_forces(given, legs).transfer(np.zeros(1))[0].real)]


def _forces(given: Plant, legs: tuple[Leg, ...]) -> System:
    """System from the legs' strokes to their link forces."""
    return select(given.system, [each.actuator for each in legs], [f"{each.sensed}.fx" for each in legs])


def follow_poles(given: Plant, law: ForceFeedback, legs: tuple[Leg, ...], gains: Array) -> Array:
    """Compute the root locus of the plant's modes (columns): their poles [1/s], tracked for increasing `gains` (rows)."""
    turning, ratios, found = 2.0 * np.pi * given.frequencies, given.ratios, []
    modes = turning * (-ratios + 1j * np.sqrt(1.0 - ratios**2))
    for gain in gains:
        poles = close_damping(given, replace(law, gain=float(gain)), legs).system.poles
        poles = poles[np.imag(poles) >= -1e-9 * np.abs(poles)]
        distance = np.abs(modes[:, None] - poles[None, :])
        modes = poles[scipy.optimize.linear_sum_assignment(distance)[1]] if len(poles) >= len(modes) else poles[np.argmin(distance, axis=1)]
        found.append(modes)
    return np.array(found)


def gain_for(given: Plant, law: ForceFeedback, legs: tuple[Leg, ...], wanted: float) -> float:
    """Compute the lowest gain [1/s] that gives all dominant modes (see `dominant_modes`) at least the damping ratio `wanted`.

    If no gain reaches `wanted`, returns the gain of maximum damping. If the inner loops are unstable at the gain found, the gain is reduced
    until they are stable. Raises `DesignError` if the inner loops are unstable even at the lowest gain tried.
    """
    dominant = dominant_modes(given)
    scale = 2.0 * np.pi * float(np.median(given.frequencies[dominant]))
    gains = scale * np.geomspace(_FIRST, _LAST, _GAINS)
    poles = follow_poles(given, law, legs, gains)
    ratios = np.min(_ratios(poles[:, dominant]), axis=1)
    if close_damping(given, replace(law, gain=float(gains[0])), legs).system.growth >= 0.0:
        raise refuse(
            "damping",
            f"the inner loops are unstable even at a gain of {gains[0]:.3g} 1/s",
            "Use a shorter delay and faster amplifiers",
        )
    reached = np.flatnonzero(ratios >= wanted)
    chosen = float(gains[reached[0]] if len(reached) else gains[np.argmax(ratios)])
    while close_damping(given, replace(law, gain=chosen), legs).system.growth >= 0.0:
        chosen *= 0.8
    return chosen


def dominant_modes(given: Plant) -> Array:
    """Return the indices of the dominant modes: those with the largest residues in a plant's loop, as many as there are coordinates."""
    return np.argsort(-resonances(given))[: len(given.coordinates.names)]


def _ratios(poles: Array) -> Array:
    return -np.real(poles) / np.abs(poles)


def describe_damping(given: Plant, damped: Plant, law: ForceFeedback, legs: tuple[Leg, ...], pairs: Pairs) -> ActiveDamping:
    """Summarise the inner loops' effect on modes and platform stiffness.

    `pairs` pairs each mode with axial leg stiffness and a mode without this stiffness.
    """
    gains = law.gain * np.geomspace(1e-2, 1.0, 40)
    poles = follow_poles(given, law, legs, gains)[-1]
    modes = []
    columns = (given.frequencies, given.ratios, pairs.nearest(given.frequencies).others)
    for frequency, ratio, zero, pole in zip(*(each.tolist() for each in columns), poles, strict=True):
        alone = damping_of_pair(law, frequency, zero)
        modes.append(
            DampedMode(
                frequency=frequency,
                ratio=ratio,
                zero=zero,
                damped_frequency=float(np.abs(pole)) / (2.0 * np.pi),
                damped_ratio=float(_ratios(pole)),
                alone=float(_ratios(np.array(alone))),
                most=most_damping(frequency, zero),
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
        reached=min(modes[place].damped_ratio for place in dominant_modes(given)),
    )


def _compliances(given: Plant, lines: Array) -> Array:
    """Compliance (lines, f) of the platform along each coordinate."""
    rows = [COMPONENTS.index(name) for name in given.coordinates.names]
    wrenches, motions = [f"platform.{FORCES[row]}" for row in rows], [f"relative.{COMPONENTS[row]}" for row in rows]
    return np.einsum("fkk->fk", select(given.system, wrenches, motions).transfer(lines))


def with_damped_modes(damped: Plant, found: ActiveDamping) -> Plant:
    """Replace the plant's modal frequencies and damping ratios by the values with closed inner loops, in ascending order."""
    frequencies = np.array([each.damped_frequency for each in found.modes])
    ratios = np.clip([each.damped_ratio for each in found.modes], 1e-6, 1.0)
    order = np.argsort(frequencies, kind="stable")
    return replace(damped, frequencies=frequencies[order], ratios=ratios[order])
