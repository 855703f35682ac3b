"""Tests of a stage as identified ones, made from its modes: realistic deviations, no record in between."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexstage.analysis.complete import platform_modes
from flexstage.analysis.dynamics.response import response
from flexstage.experiment.identification.identified import Identified
from flexstage.experiment.records.record import Channel, Responses, Role
from flexstage.mechanism.mechanism import Mechanism
from flexstage.models.lumped import lumped


@dataclass(frozen=True)
class Noise:
    """Relative standard deviations: of each frequency, of theory's frequencies (one factor a group of repeated modes), of low responses."""

    frequency: float = 2e-4
    model: float = 0.0
    response: float = 2e-3


def made(built: Mechanism, seed: int = 0, noise: Noise = Noise()) -> Identified:
    """What a test of the stage as it was built would give: its platform modes at the gauges, and its responses up to 60 Hz."""
    random = np.random.default_rng(seed)
    model = lumped(built)
    found = platform_modes(built, model)
    chosen = list(found.platform)
    gauges = tuple(channel.name for channel in model.outputs if "." not in channel.name)
    exact = found.frequencies[chosen]
    groups = np.concatenate([[0], np.cumsum(np.diff(exact) > 1e-2 * exact[1:])])
    theory = exact * np.exp(noise.model * random.standard_normal(6)[groups])
    order = np.argsort(measured := theory * (1.0 + noise.frequency * random.standard_normal(6)))
    shapes = (model.output[list(model.output_index(gauges))] @ found.shapes[:, chosen])[:, order]
    largest = shapes[np.argmax(np.abs(shapes), axis=0), np.arange(6)]
    shapes = shapes / largest
    driven = model.input_matrix[:, list(model.input_index(model.strokes))]
    felt = (found.shapes[:, chosen][:, order] * largest).T @ driven / (4j * np.pi * exact[order, None])  # residues of M q'' + K q = B u
    outputs = tuple(Channel(name, "um", Role.OUTPUT) for name in gauges)
    inputs = tuple(Channel(name, "um", Role.INPUT) for name in model.strokes)
    lines = np.linspace(0.0, 60.0, 241)
    low = response(model, gauges, model.strokes, lines).values
    low = low + noise.response * (random.standard_normal(low.shape) + 1j * random.standard_normal(low.shape))
    return Identified(
        frequencies=measured[order],
        damping=np.full(6, 0.01),
        shapes=shapes.astype(complex),
        participation=felt,
        frequency_deviations=noise.frequency * measured[order],
        damping_deviations=np.full(6, 1e-4),
        shape_deviations=np.full(shapes.shape, 1e-3),
        widening=np.ones(6),
        significance=np.full(6, 100.0),
        outputs=outputs,
        inputs=inputs,
        close=(),
        residuals=np.zeros((2, len(outputs), len(inputs))),
        responses=Responses(lines, outputs, inputs, low, source="made.uff"),
        stabilisation=(),
        band=(20.0, 400.0),
        noise=np.ones(len(outputs)),
        data_warnings=(),
        provenance="made",
    )
