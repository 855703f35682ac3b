"""Modes of records against strid, pyOMA-2 and sdypy-EMA, at test time: the extra `oracles`, which `make check-all` installs.

Tolerances of the first test are the peers' own errors on such records, rounded up. Subspace methods that do not see the inputs are not in
it: without noise they still depend on how white the inputs happen to be.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from flexstage.experiment.identification.identified import Identified
from flexstage.experiment.identification.identify import identify
from flexstage.experiment.records.record import Responses
from tests.elsewhere.identification_peers import EXTRA, PEERS, Modes, Peer, handed_over, sdypy_lscf, strid_lscf, strid_subspace
from tests.elsewhere.identification_peers import pyoma_with_inputs as pyoma
from tests.elsewhere.identification_scores import ERRORS, OURS, medians, one_record
from tests.models.identification_study import CASES, Case, assurance
from tests.models.synthetic_records import record, truth

TOLERANCES = {
    strid_subspace: ((3e-6, 5e-4, 1e-8),),
    strid_lscf: ((1e-8, 1e-6, 1e-12),),
    pyoma: ((1e-8, 1e-6, 1e-12), (5e-6, 3e-4, 1e-7)),
    sdypy_lscf: ((3e-5, 1e-3, 1e-7),),  # its normal equations of order 40 magnify rounding: another processor, other digits
}
"""Relative in frequency and damping, and 1 - MAC, in the order of each peer's ways."""
ON_RESPONSES = (strid_lscf, sdypy_lscf)
BY_CHANCE = 1.2
"""Peers that are told how many modes there are, or which of their poles are true, come as near as the noise lets anybody: of medians of
five records either may be the smaller, by a tenth as a rule."""


def present(peer: Peer) -> Peer:
    if peer.version is None:
        pytest.skip(f"{peer.package} is not installed; it belongs to {EXTRA}")
    return peer


def away(found: Identified, modes: Modes) -> tuple[float, float, float]:
    """How far flexstage's modes are from the peer's nearest, at most: frequency, damping, 1 - MAC."""
    nearest = np.argmin(np.abs(modes.frequencies[None, :] - found.frequencies[:, None]), axis=1)
    frequency = np.max(np.abs(found.frequencies / modes.frequencies[nearest] - 1.0))
    damping = np.max(np.abs(found.damping / modes.damping[nearest] - 1.0))
    return float(frequency), float(damping), float(1.0 - np.min(np.diagonal(assurance(found.shapes, modes.shapes[:, nearest]))))


@pytest.mark.parametrize("peer", [peer for peer in PEERS if peer.find in TOLERANCES], ids=lambda peer: peer.find.__name__)
def test_without_noise_all_agree(peer: Peer) -> None:
    present(peer)
    known = truth()
    made = record(known, 1, seconds=10.0, noise=0.0)
    lines = np.arange(0.0, 1024.25, 0.25)
    exact = Responses(lines, made.outputs, made.inputs, known.response(lines))
    data = replace(handed_over(made, known.frequencies), lines=lines, responses=exact.values)
    found = identify(exact if peer.find in ON_RESPONSES else made)
    assert len(found.frequencies) == 6
    for modes, limits in zip(peer.modes(data), TOLERANCES[peer.find], strict=True):
        assert all(np.array(away(found, modes)) < limits)


@pytest.mark.full
@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_nobody_is_nearer_to_the_truth(case: Case) -> None:
    for peer in PEERS:
        present(peer)
    middle = medians([one_record(case, seed) for seed in range(5)])
    compared = [index for index, what in enumerate(ERRORS) if what != "1 - MAC"]  # pyOMA-2's clusters drop imaginary parts
    for row, errors in middle.items():
        assert all(middle[OURS][compared] <= (1.0 if row[2].alone else BY_CHANCE) * errors[compared]), row
