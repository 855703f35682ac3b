"""What is set up once a process for all tests and examples: threads, the cache."""

from __future__ import annotations

import os

import pytest
from threadpoolctl import threadpool_limits


@pytest.fixture(scope="session", autouse=True)
def _one_blas_thread():
    with threadpool_limits(limits=1):
        yield


@pytest.fixture(scope="session", autouse=True)
def _own_cache(tmp_path_factory: pytest.TempPathFactory):
    """Tests begin with an empty cache of superelements, one for all processes of a run, and leave the user's alone."""
    own = tmp_path_factory.getbasetemp()
    cache = (own.parent if "PYTEST_XDIST_WORKER" in os.environ else own) / "cache"
    cache.mkdir(mode=0o700, exist_ok=True)
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("FLEXSTAGE_CACHE", str(cache))
        patch.setattr(os, "fsync", lambda _: None)  # what tests write need not outlive a power cut
        yield
