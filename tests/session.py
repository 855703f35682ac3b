"""What is set up once a process for all tests and examples: threads, the cache, processes that wait."""

from __future__ import annotations

import os
from types import FunctionType

import pytest
from threadpoolctl import threadpool_limits


@pytest.fixture(scope="session", autouse=True)
def _one_blas_thread():
    with threadpool_limits(limits=1):
        yield


@pytest.fixture(scope="session", autouse=True)
def _kept_processes():
    """Processes for jobs are kept from test to test: those that reduce solids, to which limits of memory are set, and the others."""
    from flexstage.base import jobs
    from flexstage.control.study import compare
    from flexstage.solid.fea import remote
    from flexstage.studies.sweeps import work
    from tests.kept import Workers

    solids, others = Workers(), Workers()
    results = FunctionType(jobs.results.__code__, vars(jobs) | {"Worker": others})
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(remote, "Worker", solids)
        patch.setattr(work, "results", results)
        patch.setattr(compare, "results", results)
        yield
    solids.end()
    others.end()


@pytest.fixture(scope="session", autouse=True)
def _own_cache(tmp_path_factory: pytest.TempPathFactory):
    """Tests begin with an empty cache of superelements, one for all processes of a run, and leave the user's alone."""
    own = tmp_path_factory.getbasetemp()
    run = own.parent if "PYTEST_XDIST_WORKER" in os.environ else own
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("FLEXSTAGE_CACHE", str(run / "cache"))
        patch.setattr(os, "fsync", lambda _: None)  # what tests write need not outlive a power cut
        yield
