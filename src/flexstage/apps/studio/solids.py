"""Comparison of theory with finite elements in the studio. Finite-element results are read from the cache of a verification."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from flexstage.analysis.dynamics.pairing import Moving, Pair, pair_modes
from flexstage.analysis.dynamics.solid_modes import FeaModes
from flexstage.apps.studio.design.reading import finite
from flexstage.apps.studio.protocol import Fact, SolidMode, SolidModes
from flexstage.apps.studio.results import bench, drawn
from flexstage.base.finding import DesignError
from flexstage.beams.compliance import compliance
from flexstage.mechanism.assembly.expand import PlacedLink
from flexstage.mechanism.mechanism import Mechanism
from flexstage.show.display import number, percent
from flexstage.solid.fea.jobs.cache import HINGES, Cache, find
from flexstage.solid.fea.jobs.hinge_cache import hinge_jobs
from flexstage.solid.results.hinges import accuracy_of, as_drawn, distinct_hinges, turned_forms
from flexstage.solid.results.modes import fea_modes_from_cache
from flexstage.solid.show.sections import fea_motions
from flexstage.spatial.frame import COMPONENTS

_ABSENT = "The cache contains no finite-element results of this stage: start Verify to compute them"
_VERIFIED = 0.01
"""Default accuracy of `verify`."""


def solid_modes(text: str, file: str) -> SolidModes:
    """Return the platform modes by finite elements, each with the paired mode of the lumped model."""
    known = bench(text, file)
    found = fea_modes_from_cache(known.mechanism, Cache())
    if found is None:
        return SolidModes((), _ABSENT)
    pairs = pair_modes(Moving(found.modes, found.model), Moving(known.modes, known.model))
    return SolidModes(tuple(_modes(text, file, found, pairs)), "")


def _modes(text: str, file: str, found: FeaModes, pairs: dict[int, Pair]) -> Iterator[SolidMode]:
    shown = drawn(text, file)
    motions = fea_motions(shown.bones, Moving(found.modes, found.model), pairs)
    errors = (*found.errors, *[None] * len(motions))
    for index, motion, error in zip(found.modes.platform, motions, errors, strict=False):
        frequency, pair = float(found.modes.frequencies[index]), pairs.get(index)
        alike = pair if pair is not None and pair.reliable else None
        yield SolidMode(
            index + 1,
            frequency,
            finite(error),
            found.modes.names[index],
            None if alike is None else alike.index + 1,
            None if alike is None else alike.frequency,
            None if alike is None else alike.frequency / frequency - 1.0,
            None if pair is None else pair.assurance,
            shown.motion_document(motion),
        )


def hinge_facts(mechanism: Mechanism, link: PlacedLink) -> tuple[Fact, ...]:
    """Compare the direct compliances of a link by beam theory with those by finite elements, if `verify` has stored them."""
    try:
        known = {name: each for name, each in distinct_hinges(mechanism).items() if link.drawn in each.links}
        jobs = hinge_jobs(turned_forms(known), accuracy_of(_VERIFIED, None))
        stored = {job.name: find(Cache(), job.key, job.name, HINGES) for job in jobs}
        return tuple(fact for name, each in known.items() for fact in _facts(link, stored[name], each))
    except DesignError:  # a part without a shape, or without a compliance in theory
        return ()


def _facts(link: PlacedLink, stored: Any, hinge: Any) -> Iterator[Fact]:
    if stored is None:
        return
    solid = as_drawn(hinge, stored)
    theory = np.real(np.diag(compliance(link.part, link.material)))  # pyright: ignore[reportArgumentType]
    for index, axis in enumerate(COMPONENTS):
        if solid.separable[index]:
            unit, own = "m/N" if index < 3 else "rad/(N m)", float(solid.found.compliance[index, index])
            off = percent(float(theory[index]) / own - 1.0, 2)
            yield Fact(f"compliance {axis}", f"theory {number(float(theory[index]))}, finite elements {number(own)} {unit}: {off}")
