"""Prefilters of the reference: the second degree of freedom of a loop."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from flexstage.base.arguments import CheckedFields
from flexstage.base.finding import require
from flexstage.base.number import Array
from flexstage.base.record import Heading
from flexstage.base.units.quantity import FREQUENCY
from flexstage.control.controllers.law import positive_findings
from flexstage.control.plant_models.coordinates import Coordinates
from flexstage.control.systems.sampling import bilinear
from flexstage.control.systems.system import System, block_matrices, connect, static
from flexstage.models.linear.model import Channel

_PORTS = (Channel("reference", "m"),), (Channel("shaped", "m"),)


@dataclass(frozen=True)
class Prefilter(CheckedFields):
    """Reference prefilter F(s) = (1 + s/w_l) / (1 + 2 zeta s/w + s^2/w^2), w = 2 pi `frequency`, zeta = `damping`, w_l = 2 pi `lead`.

    Without a `lead` the numerator is 1. The static gain is 1. The prefilter is the second degree of freedom of a loop (Astrom and
    Haegglund, Advanced PID Control, 2006, section 3.4). A control law with strong integral action has a zero at s = -k_i/k_p, which causes
    overshoot. The prefilter F reduces the overshoot, but does not change sensitivity, margins or noise. Raises `DesignError` for numbers
    that are not positive.

    >>> gains = Prefilter(frequency=90.0, damping=1.0).system().transfer(np.array([0.0, 90.0]))
    >>> abs(gains.ravel()).round(12).tolist()  # 1/(2 zeta) there
    [1.0, 0.5]
    """

    frequency: Annotated[float, FREQUENCY, Heading("prefilter", digits=4)]
    damping: Annotated[float, Heading("prefilter damping", digits=3)] = 1.0
    lead: Annotated[float | None, FREQUENCY, Heading("prefilter lead", digits=4)] = None

    def __post_init__(self) -> None:
        super().__post_init__()
        require(positive_findings("prefilter", vars(self)))

    def system(self, step: float | None = None) -> System:
        """Return the filter from `reference` to `shaped`, by Tustin's rule (prewarped if `frequency` is below 0.4 of the sampling rate)."""
        omega = 2.0 * np.pi * self.frequency
        A = np.array([[0.0, omega], [-omega, -2.0 * self.damping * omega]])
        slope = 0.0 if self.lead is None else self.frequency / self.lead
        found = System(A, np.array([[0.0], [omega]]), np.array([[1.0, slope]]), np.zeros((1, 1)), *_PORTS)
        if step is None:
            return found
        return bilinear(found, step, self.frequency if self.frequency < 0.4 / step else None)


def with_prefilters(control: System, filters: tuple[Prefilter | None, ...], sense: Array, coordinates: Coordinates) -> System:
    """Add one prefilter per loop to a controller: the filtered reference S^+ F S r replaces the reference r.

    F are the prefilters, S = `sense` (k, f) maps coordinates to loops, and S^+ is the pseudoinverse of S. The error relative to the
    filtered reference, e + (S^+ F S - 1) r, replaces the error e. Adds inputs `reference.<c>` if the controller has no such inputs.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.control.plant_models.coordinates import coordinates
    >>> from flexstage.control.systems.system import static
    >>> from flexstage.models.ideal import ideal
    >>> gain = static(np.ones((1, 1)), (Channel("error.x", "m"),), (Channel("command.B", "m"),))
    >>> found = with_prefilters(gain, (Prefilter(90.0),), np.eye(1), coordinates(ideal(parallelogram())))
    >>> found.input_names, abs(found.transfer(np.array([90.0]))[0, 0]).round(3).tolist()  # F - 1 of the reference
    (('error.x', 'reference.x'), [1.0, 1.118])
    """
    if not any(filters):
        return control
    shaped = _shaped(filters, np.asarray(sense), coordinates, control.step)
    links: dict[str, dict[str, float]] = {}
    for name in coordinates.names:
        links[f"asked.{name}"] = {f"reference.{name}": 1.0}
        if f"error.{name}" in control.input_names:
            links[f"error.{name}"] = {f"error.{name}": 1.0, f"shaped.{name}": 1.0, f"reference.{name}": -1.0}
        if f"reference.{name}" in control.input_names:
            links[f"reference.{name}"] = {f"shaped.{name}": 1.0}
    return connect([control, shaped], links, _inputs(control, coordinates), control.output_names)


def _inputs(control: System, coordinates: Coordinates) -> tuple[Channel, ...]:
    """Inputs of the controller, with the reference before `applied`."""
    rest = [each for each in control.inputs if not each.name.startswith("reference.")]
    before = [each for each in rest if not each.name.startswith("applied.")]
    return (*before, *coordinates.motions("reference."), *rest[len(before) :])


def _shaped(filters: tuple[Prefilter | None, ...], sense: Array, coordinates: Coordinates, step: float | None) -> System:
    """References of the coordinates, filtered loop by loop."""
    parts = [static(np.eye(1), *_PORTS, step) if each is None else each.system(step) for each in filters]
    A, B, C, D = block_matrices(parts)
    back, ends = np.linalg.pinv(sense), (coordinates.motions("asked."), coordinates.motions("shaped."))
    return System(A, B @ sense, back @ C, back @ D @ sense, *ends, step)
