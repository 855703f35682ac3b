"""Checking and drawing whole stages in processes of their own: the CAD kernel may crash or hang, and takes nothing with it there."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass

from flexstage.base.finding import Finding
from flexstage.mechanism.mechanism import Mechanism
from flexstage.solid.fea.install import require_solver
from flexstage.solid.fea.progress import Stage
from flexstage.solid.fea.remote import Limits, work_all
from flexstage.solid.fea.worker import Call, Job

_LIMITS = Limits(seconds=600.0)


@dataclass(frozen=True, eq=False)
class _Drawing(Job):
    """A stage to draw as a STEP file."""

    mechanism: Mechanism

    @property
    def name(self) -> str:
        """The stage's name."""
        return self.mechanism.name or "stage"

    def work(self, call: Call) -> bytes:
        """The file."""
        call.report(Stage.DRAWING, 0.0)
        from flexstage.solid.exchange.step import step

        return step(self.mechanism)


@dataclass(frozen=True, eq=False)
class _Checking(_Drawing):
    """A stage whose outlines are checked against each other."""

    clearance: float

    def work(self, call: Call) -> bytes:
        """The findings as JSON."""
        call.report(Stage.DRAWING, 0.0)
        from flexstage.solid.fea.contact import contact_findings

        return json.dumps([asdict(finding) for finding in contact_findings(self.mechanism, self.clearance)]).encode()


def contact_apart(mechanism: Mechanism, clearance: float = 0.0, limits: Limits = _LIMITS) -> tuple[Finding, ...]:
    """What `contact_findings` finds, in a process of its own. Raises `DesignError` where that crashes or takes too long."""
    return tuple(Finding(**item) for item in json.loads(_result_of(_Checking(mechanism, clearance), limits)))


def step_apart(mechanism: Mechanism, limits: Limits = _LIMITS) -> bytes:
    """What `step` writes, in a process of its own. Raises `DesignError` where that crashes or takes too long."""
    return _result_of(_Drawing(mechanism), limits)


def _result_of(job: Job, limits: Limits) -> bytes:
    require_solver()
    results: list[bytes] = []
    work_all([job], lambda _job, data: results.append(data), limits)
    return results[0]
