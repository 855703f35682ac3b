"""Cache of the compliance matrices of hinges by content: each matrix is computed once on a machine."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from flexstage.base.finding import DesignError, Finding
from flexstage.solid.fea.geometry.piece import form_digest, medium
from flexstage.solid.fea.hinges.hinge_form import HingeForm, HingeSolid
from flexstage.solid.fea.jobs.cache import HINGES
from flexstage.solid.fea.jobs.memory import Counts, needed
from flexstage.solid.fea.jobs.parts import Ways, obtain
from flexstage.solid.fea.jobs.reducing import StoredJob
from flexstage.solid.fea.jobs.worker import Call
from flexstage.solid.fea.meshing.estimate import Accuracy

_SECONDS, _PER_WIDTH, _WIDEST = 0.3, 0.04, 50.0
"""CPU time [s] of a hinge, time for each unit of width / thickness, and limit of this ratio, because elements of wider hinges are flat."""


@dataclass(frozen=True, eq=False)
class HingeJob(StoredJob):
    """Job that computes the compliance matrix of a hinge in a separate process; `called` is the user's name of the hinge."""

    called: str
    form: HingeForm
    asked: Accuracy

    stored = HINGES

    @property
    def name(self) -> str:
        """The hinge's name."""
        return self.called

    @property
    def order(self) -> int:
        """The lowest element order for which the error is estimated."""
        return min(self.asked.orders[0] + 1, self.asked.orders[1])

    def seconds(self) -> float:
        """Return the usual CPU time [s] of several solutions; it increases with the width of the hinge."""
        throat = self.form.part.throat
        return _SECONDS + _PER_WIDTH * min(float(np.real(throat.area / throat.thinnest**2)), _WIDEST)

    def summary(self, found: HingeSolid) -> str:
        """Describe the computed hinge in one line."""
        return f"hinge {self.name}: error {100.0 * found.error:.2g} %, {found.freedoms:,} unknowns of order {found.order}"

    def needed(self, counts: Counts) -> float:
        """Return the memory [bytes] of the solutions up to `order`; the memory of higher orders and finer meshes is not estimated."""
        return needed(counts, self.order, 6)

    def refusal(self, counts: Counts, limit: float) -> Finding | None:
        """Return an error if the coarsest mesh needs more memory [bytes] than `limit`."""
        if self.needed(counts) <= limit:
            return None
        what = f"its coarsest mesh needs about {self.needed(counts) / 1e9:.3g} GB at order {self.order} ({limit / 1e9:.3g} GB available)"
        return Finding(self.name, what, "Free memory, or increase --memory")

    def work(self, call: Call) -> HingeSolid:
        """Compute the compliance matrix; error messages contain the user's name of the hinge."""
        from flexstage.solid.fea.hinges.hinge import hinge_compliance

        try:
            return hinge_compliance(self.form.part, self.form.material, self.asked, told=call, roots=self.form.roots)
        except DesignError as error:
            kind = f"the {self.form.part.kind}"
            raise DesignError(replace(each, where=each.where.replace(kind, self.name, 1)) for each in error.findings) from None


def hinges_from_cache(forms: Mapping[str, HingeForm], accuracy: Accuracy, ways: Ways) -> dict[str, HingeSolid]:
    """Return the 6x6 compliance matrices of hinges by name. Missing matrices are computed in parallel processes, and stored immediately.

    The solver is needed only for missing matrices. Raises a `DesignError` that lists all failures.

    >>> hinges_from_cache({}, Accuracy(), Ways())
    {}
    """
    jobs = hinge_jobs(forms, accuracy)
    found = obtain(jobs, ways)
    return {job.name: found[job.key] for job in jobs}


def hinge_jobs(forms: Mapping[str, HingeForm], accuracy: Accuracy) -> list[HingeJob]:
    """Make a job for each hinge."""
    return [HingeJob(_key(form, accuracy), name, form, accuracy) for name, form in forms.items()]


def _key(form: HingeForm, accuracy: Accuracy) -> str:
    own = medium(form.material)
    stiffness = (own.young, own.poisson, own.tensor)
    return hashlib.sha256(f"{form_digest(form.part)} {stiffness} {form.roots} {accuracy}".encode()).hexdigest()[:32]
