"""Stages read as solids, each once a session."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import ngsolve

from flexstage.base.number import Array
from flexstage.cases.registry import case
from flexstage.mechanism.mechanism import Mechanism
from flexstage.solid.fea.jobs.parts import Parts, Ways
from flexstage.solid.fea.meshing.fineness import Fineness, Reduction
from flexstage.solid.fea.solver.field import Columns, Field, factorise_kinds
from flexstage.solid.results.read import SolidRead, read_solid, solids

COARSE = Reduction(Fineness(grading=0.6, order=2))  # at 0.8 elements of order two leave the first mode 1.4e-3 from that of another mesh


@cache
def read(name: str) -> tuple[Mechanism, SolidRead]:
    """A shipped case and its coarse solid model (order two), from no cache."""
    stage = case(name)
    return stage, read_solid(stage, COARSE, solids(Ways(cache=None)))


def solver(space: Field, form: ngsolve.BilinearForm) -> Callable[[Array], Array]:
    """A function of forces (n, k) or (n,) on a whole mesh that returns displacements, zero at fixed degrees of freedom."""
    solve = factorise_kinds(space, [form])
    return lambda forces: solve(Columns.of(forces.reshape(len(forces), -1))).reshape(forces.shape)


def parts_of(found: SolidRead) -> Parts:
    """The components of a solid model with their superelements."""
    return tuple((each.component, each.element) for each in found.placed)
