"""Stages read as solids, each once a session."""

from __future__ import annotations

from functools import cache

from flexstage.cases.registry import case
from flexstage.mechanism.mechanism import Mechanism
from flexstage.solid.fea.jobs.parts import Parts, Ways
from flexstage.solid.fea.meshing.fineness import Fineness, Reduction
from flexstage.solid.results.read import SolidRead, read_solid, solids

COARSE = Reduction(Fineness(grading=0.6, order=2))  # at 0.8 elements of order two leave the first mode 1.4e-3 from that of another mesh


@cache
def read(name: str) -> tuple[Mechanism, SolidRead]:
    """A shipped case and its coarse solid model (order two), from no cache."""
    stage = case(name)
    return stage, read_solid(stage, COARSE, solids(Ways(cache=None)))


def parts_of(found: SolidRead) -> Parts:
    """The components of a solid model with their superelements."""
    return tuple((each.component, each.element) for each in found.placed)
