"""Check and drawing of whole stages in separate processes: a crash of the CAD kernel ends only the separate process."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from flexstage.base.finding import Finding
from flexstage.mechanism.mechanism import Mechanism
from flexstage.solid.fea.jobs.install import require_installed
from flexstage.solid.fea.jobs.progress import Stage
from flexstage.solid.fea.jobs.remote import Limits, Pool, work_all
from flexstage.solid.fea.jobs.worker import Call, Job

_LIMITS = Limits(seconds=600.0)


@dataclass(frozen=True, eq=False)
class _Drawing(Job):
    """A stage to draw as a STEP file."""

    mechanism: Mechanism

    @property
    def name(self) -> str:
        """The stage's name."""
        return self.mechanism.name or "stage"

    def work(self, call: Call) -> Any:
        """The file."""
        call.report(Stage.DRAWING, 0.0)
        from flexstage.solid.exchange.step import step

        return step(self.mechanism)


@dataclass(frozen=True, eq=False)
class _Checking(_Drawing):
    """A stage whose outlines are checked against each other."""

    def work(self, call: Call) -> tuple[Finding, ...]:
        """The findings."""
        call.report(Stage.DRAWING, 0.0)
        from flexstage.solid.fea.geometry.contact import contact_findings

        return contact_findings(self.mechanism)


def contacts_apart(mechanisms: Sequence[Mechanism], pool: Pool | None = None) -> list[tuple[Finding, ...]]:
    """Return the results of `contact_findings` for stages, computed in parallel in separate processes or in the processes of a `pool`.

    Raises `DesignError` if a process crashes or takes too long.
    """
    return _results_of([_Checking(mechanism) for mechanism in mechanisms], pool)


def step_apart(mechanism: Mechanism) -> bytes:
    """Compute the result of `step` in a separate process. Raises `DesignError` if the process crashes or takes too long."""
    return _results_of([_Drawing(mechanism)])[0]


def _results_of(jobs: Sequence[_Drawing], pool: Pool | None = None) -> list[Any]:
    require_installed()
    results: dict[_Drawing, Any] = {}
    work_all(jobs, results.__setitem__, _LIMITS, pool=pool)
    return [results[job] for job in jobs]
