"""What holds for every test: one BLAS thread, and how many examples a law is tried on."""

from __future__ import annotations

import gc
import linecache
import os
import signal
import sys
from collections.abc import Generator
from pathlib import Path

# Before numpy is imported; the limit below catches libraries that were loaded earlier all the same.
for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[name] = "1"

import pytest
from _pytest.assertion import rewrite
from _pytest.doctest import DoctestModule
from hypothesis import HealthCheck, Phase, settings
from hypothesis.internal.conjecture import providers

# Else Hypothesis also tries numbers it finds in the code of whatever modules are loaded by then, but for those of a path with "test" in it:
# what a law is tried on would depend on which tests ran before it in this process, and on where the tree lies.
providers._get_local_constants = lambda: providers._local_constants

# A script that runs the tests in its background ignores interrupts, and so would every process that a test starts and interrupts.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)

# Each of the thousand doctests would look whether any file that was read before has changed meanwhile.
_look_whether_changed = linecache.checkcache
linecache.checkcache = lambda filename=None: None if filename is None else _look_whether_changed(filename)

FULL = os.environ.get("FLEXSTAGE_TESTS") == "full"
QUICK = os.environ.get("FLEXSTAGE_TESTS") == "quick"
STROKELESS = {"xy-stage-floating", "tilt-stage", "voice-coil-stage", "mirror-mount", "telescope-mount", "leaf-guide", "resonator"}
STROKELESS |= {"quad-suspension", "voice-coil-xy", "z-stage", "spiral-stage", "steering-mirror", "long-travel-xy"}
"""Cases whose motion strokes do not determine: there are too few, or none."""

# Laws build whole mechanisms: drawing one is slow by nature, and no test has a time limit. They are drawn once for all laws, by the first
# one that asks (tests/laws/shared.py), which takes a `given` within another.
_SLOW = [HealthCheck.too_slow, HealthCheck.data_too_large, HealthCheck.nested_given]
# Shrinking a failing random stage takes minutes and says little more than the stage itself.
_PHASES = (Phase.explicit, Phase.reuse, Phase.generate)
settings.register_profile("default", max_examples=15, deadline=None, derandomize=True, suppress_health_check=_SLOW, phases=_PHASES)
# Ten times the usual counts: all full tests end within about an hour of two cores.
settings.register_profile("full", max_examples=150, deadline=None, derandomize=True, suppress_health_check=_SLOW)
settings.load_profile("full" if FULL else "default")


def examples(count: int) -> settings:
    """Settings of a test whose random examples are costly: their number, ten times as many in the full tests."""
    return settings(max_examples=10 * count if FULL else count)


def pytest_configure(config: pytest.Config) -> None:
    """Fixtures of this file would be those of `tests` alone; examples in docstrings stand in `src`."""
    config.pluginmanager.import_plugin("tests.session")


def pytest_sessionstart(session: pytest.Session) -> None:
    """Processes that collect the same files translate a share of them each beforehand, so that none is translated twice."""
    given = getattr(session.config, "workerinput", None)
    if given is None or sys.dont_write_bytecode:
        return
    folders = [Path(each.partition("::")[0]) for each in session.config.args]
    files = sorted({path for folder in folders for path in folder.rglob("test_*.py")})
    for path in files[int(given["workerid"].removeprefix("gw")) :: given["workercount"]]:
        _translate(path.resolve(), session.config)


def _translate(path: Path, config: pytest.Config) -> None:
    place = rewrite.get_cache_dir(path) / (path.name[:-3] + rewrite.PYC_TAIL)
    if rewrite._read_pyc(path, place) is None and rewrite.try_makedirs(place.parent):
        source, code = rewrite._rewrite_test(path, config)
        rewrite._write_pyc(config.stash[rewrite.assertstate_key], code, source, place)


@pytest.hookimpl(wrapper=True)
def pytest_collect_file() -> Generator[None, list[pytest.Collector], list[pytest.Collector]]:
    """Tests have no examples in their docstrings: none are looked for here, only in `src`."""
    found = yield
    return [each for each in found if not isinstance(each, DoctestModule)]


def pytest_collection_finish() -> None:
    """Thousands of tests and modules stay to the end: the collector need not look through them again and again."""
    gc.collect()
    gc.freeze()
    gc.set_threshold(20_000, 20, 20)


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Skip the full tests unless asked for: `make check-all`."""
    if not FULL:
        for item in items:
            if item.get_closest_marker("full"):
                item.add_marker(pytest.mark.skip(reason="full counts: make check-all"))
