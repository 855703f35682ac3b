"""Legs of a stage for inner loops: links with a tension sensor, and the model without the legs' axial stiffness."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import chain

import numpy as np
import scipy

from flexstage.base.finding import Finding, refuse, require, suggest_nearest
from flexstage.base.number import Array
from flexstage.mechanism.assembly.expand import Assembly, expand
from flexstage.mechanism.assembly.pattern import copy_names
from flexstage.mechanism.assembly.sight import link_names
from flexstage.mechanism.mechanism import LinkProbe, Mechanism
from flexstage.models.linear.eigen import eigen
from flexstage.models.linear.model import LinearModel

_NEXT_TO_NOTHING = 1e-9


@dataclass(frozen=True)
class Leg:
    """Leg of an actuator: `link` is its stack, with axial `stiffness` [N/m]; `sensed` is the link whose tension is measured.

    `noise` [N/Hz^(1/2)] and `lag` [Hz] belong to the strain gauge of the leg; both are None for a force sensor.
    """

    actuator: str
    link: str
    sensed: str
    stiffness: float
    noise: float | None = None
    lag: float | None = None


def legs(mechanism: Mechanism, model: LinearModel, gauges: tuple[str, ...] = (), asked: str = "damping") -> tuple[Leg, ...]:
    """Return the legs of all actuators that impose a stroke along their link. Each has a force sensor at its stack, or a strain gauge.

    With `gauges`, returns only the legs that have one of these strain gauges. A gauge on a stack also reads the free stroke; therefore the
    commanded stroke is subtracted from the reading. A gauge elsewhere in the leg reads only the tension. Raises `DesignError` for stages
    without stacks, models without link forces, and gauges outside the legs. `asked` is the key that the first two errors name.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.models.lumped import lumped
    >>> legs(parallelogram(), lumped(parallelogram()))[0].sensed
    'B/pzt'
    """
    assembly, outputs = expand(mechanism), {each.name for each in model.outputs}
    strokes = assembly.strokes
    require(_findings(assembly, model, outputs, asked))
    placed = _places(mechanism)
    require(_gauge_findings(gauges, placed))
    found = {name: Leg(name, link, link, _axial(model, link)) for name, link in strokes.items()}
    for gauge in gauges:
        link = placed[gauge]
        owner = next((name for name, stack in strokes.items() if link == stack or _unit(link) == _unit(stack) != ""), None)
        if owner is None:
            raise refuse(f"damping.gauges {gauge}", f"{link} is not in a leg of an actuator", "Use a gauge in a leg")
        part = assembly.gauges[gauge].gauge
        noise = None if part.noise_density is None else float(part.noise_density) * _axial(model, link)
        found[owner] = replace(found[owner], sensed=link, noise=noise, lag=None if part.bandwidth is None else float(part.bandwidth))
    sensed = {placed[gauge] for gauge in gauges}
    return tuple(each for each in found.values() if not gauges or each.sensed in sensed)


def without_stiffness(model: LinearModel, found: tuple[Leg, ...], left: float = 0.0) -> LinearModel:
    """Multiply the axial stiffness of the legs' stacks by `left`, but at least by 1e-9. Free motions then have a frequency of nearly 0 Hz.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.models.lumped import lumped
    >>> model = lumped(parallelogram())
    >>> bare = without_stiffness(model, legs(parallelogram(), model))
    >>> bool(eigen(bare).values[0] < 0.1 * eigen(model).values[0])
    True
    """
    changed = dict(model.stiffness)
    for each in found:
        law = np.array(changed[each.link].law, dtype=float)
        law[..., 0, 0] *= max(left, _NEXT_TO_NOTHING)
        changed[each.link] = replace(changed[each.link], law=law)
    return replace(model, stiffness=changed)


@dataclass(frozen=True, eq=False)
class Pairs:
    """Pairs of modes of two models: `frequencies` (k,) [Hz] of the first model, `others` (k,) [Hz] of the second."""

    frequencies: Array
    others: Array

    def nearest(self, frequencies: Array) -> Pairs:
        """Return the pairs nearest to frequencies (m,) [Hz] of the first model."""
        places = np.argmin(np.abs(self.frequencies - frequencies[:, None]), axis=1)
        return Pairs(self.frequencies[places], self.others[places])


def pair_zeros(model: LinearModel, found: tuple[Leg, ...]) -> Pairs:
    """Pair modes with the legs' axial stiffness and modes without, by the mass-weighted similarity of their shapes.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.models.lumped import lumped
    >>> model = lumped(parallelogram())
    >>> pairs = pair_zeros(model, legs(parallelogram(), model))
    >>> pairs.frequencies[:2].round(1).tolist(), pairs.others[:2].round(1).tolist()
    ([875.4, 1674.4], [875.4, 190.0])
    """
    return pair_modes(model, without_stiffness(model, found))


def pair_modes(model: LinearModel, other: LinearModel) -> Pairs:
    """Pair modes of two models with equal masses, by the mass-weighted similarity of their shapes."""
    stiff, soft = eigen(model), eigen(other)
    alike = (stiff.shapes.T @ model.inertia_matrix @ soft.shapes) ** 2
    rows, columns = scipy.optimize.linear_sum_assignment(-alike)
    frequencies = np.sqrt(stiff.values) / (2.0 * np.pi)
    others = np.sqrt(np.maximum(soft.values, 0.0)) / (2.0 * np.pi)
    return Pairs(frequencies[rows], others[columns])


def _axial(model: LinearModel, link: str) -> float:
    return float(np.real(np.asarray(model.stiffness[link].law)[..., 0, 0]))


def _unit(link: str) -> str:
    return link.rpartition("/")[0]


def _places(mechanism: Mechanism) -> Mapping[str, str]:
    """Links of individual strain gauges by gauge name."""
    probes = ((key, place.link) for key, place in mechanism.gauges.items() if isinstance(place, LinkProbe))
    return dict(chain.from_iterable(zip(copy_names(key), link_names(link), strict=True) for key, link in probes))


def _findings(assembly: Assembly, model: LinearModel, outputs: set[str], asked: str) -> Iterator[Finding]:
    if not assembly.strokes:
        what = "no actuator has a stack in its leg"
        yield Finding(asked, what, f"Omit {asked}, and use a PID controller for force actuators")
        return
    untold = [name for name, link in assembly.strokes.items() if link not in model.stiffness or f"{link}.fx" not in outputs]
    if untold:
        what = f"the model provides no forces in the legs of {', '.join(untold)}"
        yield Finding(asked, what, 'Use model = "lumped", at the nominal position')
    for name, link in assembly.strokes.items():
        along = np.asarray(assembly.actuator(name).free_deformation)
        if link in model.stiffness and np.any(np.abs(along[..., 1:]) > 0.0):
            yield Finding(asked, f"{name} moves across its link, not along it", "Use an actuator with its stroke along the link")


def _gauge_findings(gauges: tuple[str, ...], placed: Mapping[str, str]) -> Iterator[Finding]:
    for name in gauges:
        if name not in placed:
            yield Finding(f"damping.gauges {name}", "unknown strain gauge", suggest_nearest(name, placed))
