"""Records of any length in HDF5 files: modes as recursive filters, written block by block."""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np
import scipy

from tests.models.synthetic_records import Truth, truth

BLOCK = 500_000


def written(path: Path, *, seconds: float, rate: float, known: Truth | None = None, noise: float = 0.05) -> Truth:
    """A record of six white inputs and six outputs of that rate; returns the modes it is made of.

    Every mode is the recursive filter with its very poles, exp(p/rate), so that its frequency and damping are exact at any rate.
    """
    modes = known or truth()
    count, random = round(seconds * rate), np.random.default_rng(7)
    poles = np.exp(modes.poles / rate)
    gains = np.abs(1.0 - poles) ** 2
    states = [np.zeros((2, 1)) for _ in poles]
    with h5py.File(path, "w") as file:
        file.attrs["rate"] = rate
        samples = file.create_dataset("samples", (count, 12), dtype="<f4", chunks=(min(count, 8192), 12))
        samples.attrs["names"] = [f"{kind}{number}" for kind in "uy" for number in range(1, 7)]
        samples.attrs["units"] = ["V"] * 6 + ["um"] * 6
        for start in range(0, count, BLOCK):
            inputs = random.standard_normal((min(BLOCK, count - start), 6))
            motions = inputs @ modes.participation.T
            for number, (pole, gain) in enumerate(zip(poles, gains, strict=True)):
                moved, states[number] = scipy.signal.lfilter(
                    [0.0, gain], [1.0, -2.0 * pole.real, abs(pole) ** 2], motions[:, number : number + 1], axis=0, zi=states[number]
                )
                motions[:, number] = moved[:, 0]
            outputs = motions @ modes.shapes.T
            outputs += noise * np.std(outputs, axis=0) * random.standard_normal(outputs.shape)
            samples[start : start + len(inputs)] = np.hstack([inputs, outputs])
    return modes
