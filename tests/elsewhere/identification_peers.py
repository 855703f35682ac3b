"""Modes of a record by other programs: strid (G. T. Frøseth), pyOMA-2 (D. P. Pasca, D. F. Margoni), sdypy-EMA (University of Ljubljana).

Each is used as its manual says, with settings that suited it best among those tried on these records (orders 10 to 60, 10 to 40 block rows,
spectra of 1 to 8 s), and is helped where it needs it:

- Where a user picks poles in a diagram, all poles of one order are given back, for whoever compares to pick with the truth at hand.
  pyOMA-2 also chooses by itself, by clustering.
- Records are decimated by two for subspace methods, as pyOMA-2's manual advises: all modes must lie well below 512 Hz then.
- Methods on frequency responses get our H1. strid's own `find_frf_matrix` gives its conjugate (scipy's `csd` conjugates its first argument,
  strid means its second), and there its pLSCF finds no stable poles.
- sdypy-EMA takes rows of responses of one input: all 36 are stacked, which suits it better, and shapes are the first left singular
  vectors of the 6x6 residues. Its `select_closest_poles` moves away from closely spaced modes: the poles of one order that are nearest
  to the true frequencies are chosen instead, as clicks in its chart would.
"""

from __future__ import annotations

import logging
import os
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version

import numpy as np
from scipy.optimize import linear_sum_assignment

from flexstage.experiment.identification.evidence import choose_segments
from flexstage.experiment.records.record import Record
from flexstage.experiment.spectral.cross_spectra import spectra
from flexstage.experiment.spectral.transfer import h1

os.environ["TQDM_DISABLE"] = "1"  # their progress bars
os.environ.setdefault("MPLBACKEND", "Agg")

EXTRA = "the extra `oracles`, which `make setup-oracles` installs"
HIGHEST = 0.2
"""Of the sampling rate: what decimation by two leaves as it was."""


@dataclass(frozen=True)
class Data:
    """What is handed over: samples (n, m) and (n, p), H1 (f, p, m) at its lines, and frequencies for whoever must be told where to look."""

    rate: float
    inputs: np.ndarray
    outputs: np.ndarray
    lines: np.ndarray
    responses: np.ndarray
    frequencies: np.ndarray


@dataclass(frozen=True)
class Modes:
    """Frequencies (k,) in Hz, damping ratios (k,), shapes (p, k)."""

    frequencies: np.ndarray
    damping: np.ndarray
    shapes: np.ndarray


@dataclass(frozen=True)
class Way:
    """One way to use a package; `alone` where it chooses the modes by itself."""

    text: str
    alone: bool = False


@dataclass(frozen=True)
class Peer:
    """A package, and what it finds in each of several ways that share one computation."""

    package: str
    ways: tuple[Way, ...]
    find: Callable[[Data], tuple[Modes, ...]]

    @property
    def version(self) -> str | None:
        """The version installed; None without."""
        try:
            return version(self.package)
        except PackageNotFoundError:
            return None

    def modes(self, data: Data) -> tuple[Modes, ...]:
        """What it finds, a way each; its warnings (poles at nought, a limit that is no line) are its own."""
        with warnings.catch_warnings(), np.errstate(all="ignore"):  # pyOMA-2 changes numpy's settings when it is imported
            warnings.simplefilter("ignore")
            return self.find(data)


def handed_over(record: Record, frequencies: np.ndarray) -> Data:
    values = record.samples.read(0, record.samples.length)
    count = len(record.inputs)
    found = h1(spectra(record, choose_segments([record])))
    return Data(record.rate, values[:, :count], values[:, count:], found.frequencies, found.values, frequencies)


def decimated(data: Data) -> tuple[np.ndarray, np.ndarray]:
    """Inputs and outputs at half the rate, through the same filter."""
    from scipy.signal import decimate

    assert max(data.frequencies) < HIGHEST * data.rate
    return decimate(data.inputs, 2, axis=0), decimate(data.outputs, 2, axis=0)


def strid_subspace(data: Data) -> tuple[Modes, ...]:
    """Combined deterministic-stochastic subspace identification, 20 block rows as in its manual."""
    import strid

    inputs, outputs = decimated(data)
    found = strid.CombinedDeterministicStochasticSID(inputs.T, outputs.T, data.rate / 2.0)
    system = found.perform(24, 20)
    for method in [each for kind in type(found).__mro__ for each in vars(kind).values() if hasattr(each, "cache_clear")]:
        method.cache_clear()  # they keep what they return for good: gigabytes after some twenty records
    return (_of_strid(strid.Mode.find_modes_from_ss(*system, data.rate / 2.0)),)


def strid_lscf(data: Data) -> tuple[Modes, ...]:
    """Poly-reference LSCF of order 30 on H1 up to a quarter of the sampling rate."""
    import strid

    inside = data.lines <= data.rate / 4.0
    found = strid.PolyReferenceLSCF(np.moveaxis(data.responses[inside], 0, 2), data.rate / 2.0)
    return (_of_strid(strid.Mode.find_modes_from_rmfd(*found.perform(30, max_order=30), data.rate / 2.0)),)


def _of_strid(modes: list) -> Modes:
    kept = [mode for mode in modes if mode.eigenvalue.imag > 0.0 > mode.eigenvalue.real and mode.xi < 0.1]
    shapes = np.array([mode.v for mode in kept]).reshape(len(kept), -1).T
    return Modes(np.array([mode.f for mode in kept]), np.array([mode.xi for mode in kept]), shapes)


def pyoma_with_inputs(data: Data) -> tuple[Modes, ...]:
    """Covariance-driven subspace identification that sees the inputs ("OMA with exogenous input")."""
    inputs, outputs = decimated(data)
    return _pyoma(outputs, data.rate / 2.0, method="IOcov", U=inputs)


def pyoma_outputs_only(data: Data) -> tuple[Modes, ...]:
    """Covariance-driven subspace identification that sees the outputs alone."""
    return _pyoma(decimated(data)[1], data.rate / 2.0, method="cov")


def _pyoma(outputs: np.ndarray, rate: float, **how: object) -> tuple[Modes, ...]:
    """Modes of its clusters, chosen without help, and its poles of order 12, which says that there are six modes; 40 block rows."""
    from pyoma2.algorithms.data.run_params import Clustering, SSIRunParams
    from pyoma2.algorithms.ssi import SSI
    from pyoma2.setup.single import SingleSetup

    logging.getLogger("pyoma2").setLevel(logging.ERROR)
    setup = SingleSetup(outputs, fs=rate)
    found = SSI(name="ssi", run_params=SSIRunParams(br=40, ordmax=60, step=2, **how))
    setup.add_algorithms(found)
    setup.run_all()
    found.add_clustering(Clustering(name="own", quick="hier_avg"))
    found.run_clustering("own")
    own, every, order = found.result.clustering_results["own"], found.result, 12 // 2
    kept = np.isfinite(every.Fn_poles[:, order])
    picked = (every.Fn_poles[kept, order], every.Xi_poles[kept, order], every.Phi_poles[kept, order].T)
    return Modes(np.asarray(own.Fn), np.asarray(own.Xi), np.asarray(own.Phi)), Modes(*picked)


def sdypy_lscf(data: Data) -> tuple[Modes, ...]:
    """LSCF of order 40 with a common denominator, then LSFD, on H1 of 60 to 512 Hz."""
    from sdypy import EMA

    outputs, inputs = data.responses.shape[1:]
    rows = np.moveaxis(data.responses, 0, 2).reshape(outputs * inputs, -1)
    order = 40
    found = EMA.Model(rows, data.lines, lower=60, upper=512, pol_order_high=order, frf_form="receptance")
    found.get_poles(show_progress=False)
    poles = found.all_poles[order - 1]
    stable = np.flatnonzero((poles.imag > 0.0) & (poles.real < 0.0) & (-poles.real < 0.1 * np.abs(poles)))
    away = np.abs(np.abs(poles[stable]) / (2.0 * np.pi) - data.frequencies[:, None])
    chosen = stable[linear_sum_assignment(away)[1]]
    found.pole_ind = np.array([[order - 1, index] for index in chosen])
    residues = found.get_constants()[1][:, : len(chosen)]
    shapes = [np.linalg.svd(residue.reshape(outputs, inputs))[0][:, 0] for residue in residues.T]
    poles = poles[chosen]
    return (Modes(np.abs(poles) / (2.0 * np.pi), -poles.real / np.abs(poles), np.array(shapes).T),)


PEERS = (
    Peer("strid", (Way("subspace with inputs, picked"),), strid_subspace),
    Peer("strid", (Way("pLSCF on our H1, picked"),), strid_lscf),
    Peer("pyOMA-2", (Way("SSI with inputs, its clusters", alone=True), Way("SSI with inputs, told order, picked")), pyoma_with_inputs),
    Peer("pyOMA-2", (Way("SSI, outputs only, its clusters", alone=True), Way("SSI, outputs only, told order, picked")), pyoma_outputs_only),
    Peer("sdypy-EMA", (Way("LSCF on our H1, picked"),), sdypy_lscf),
)
