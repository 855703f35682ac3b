"""Processes beside the caller: a call outlives the process that died over it, and no process outlives its caller."""

from __future__ import annotations

import operator
import subprocess
import sys
from pathlib import Path

import psutil
import pytest

from flexstage.base.processes.jobs import Word, Worker
from flexstage.base.processes.pool import CallError, results

DIES_ONCE = """
import os, pathlib
try:
    pathlib.Path({mark!r}).touch(exist_ok=False)
except FileExistsError:
    pass
else:
    os.abort()
"""
KEPT_BUSY = """
import time
from flexstage.base.processes.jobs import Worker
class Busy:
    def __reduce__(self):
        return time.sleep, (1000.0,)
print(Worker(Busy()).process.pid, flush=True)
time.sleep(1000.0)
"""


class Executed:
    """What a process runs as it reads it, and then is None."""

    def __init__(self, text: str) -> None:
        self.text = text

    def __reduce__(self) -> tuple[object, ...]:
        return exec, (self.text,)


def test_a_call_over_which_a_process_died_is_given_to_another(tmp_path: Path) -> None:
    call = (Executed(DIES_ONCE.format(mark=str(tmp_path / "mark"))),)
    assert list(results(operator.is_, [call, (None,)], 1)) == [(call, False), ((None,), False)]


def test_a_call_over_which_processes_die_again_and_again_is_given_up() -> None:
    with pytest.raises(CallError) as caught:
        list(results(operator.is_, [(Executed("import os; os.abort()"),)], 1))
    assert caught.value.error is None


def test_who_asks_a_process_that_another_thread_ended_hears_its_end() -> None:
    worker = Worker(operator.is_)
    worker.end()
    worker.ask(None)
    assert worker.heard.get()[1] is Word.ENDED


@pytest.mark.skipif(sys.platform == "win32", reason="kills as POSIX does")
def test_a_busy_process_ends_with_a_caller_that_is_killed() -> None:
    caller = subprocess.Popen([sys.executable, "-P", "-c", KEPT_BUSY], stdout=subprocess.PIPE, text=True)
    with caller:
        assert caller.stdout is not None
        worker = psutil.Process(int(caller.stdout.readline()))
        caller.kill()
    assert psutil.wait_procs([worker], timeout=60)[1] == []
