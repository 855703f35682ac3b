"""Outputs of a commit beside those of the working tree: what changed, number by number.

    python -m tools.compare_outputs BASE [--only PATTERN]

The commands of compare_outputs.toml run on both sides with the same kernels and one thread. JSON, MAT, HDF5, tables, the text of pages and
all other files must be equal bit by bit. Intended differences are stated in the tables below; every other difference, and what is left out,
has a line. Outputs are kept in the user's cache: those of a commit for good, those of the working tree until a file of src changes.
"""

from __future__ import annotations

import argparse
import hashlib
import os
import re
import shlex
import shutil
import signal
import socket
import subprocess
import sys
import time
import tomllib
from collections import Counter, defaultdict
from collections.abc import Generator, Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import groupby, pairwise
from pathlib import Path
from subprocess import DEVNULL, PIPE, Popen
from typing import TextIO

import numpy as np
from filelock import FileLock
from platformdirs import user_cache_path

from tools.differences import DIFFERENT, EQUAL, RENAMED, SKIPPED, WITHIN, Meant, Rule, compared_folders, respelled

ROOT = Path(__file__).resolve().parents[1]
CACHE = user_cache_path("flexstage", appauthor=False) / "compare-outputs"

# What a change means to differ: regular expression at BASE -> replacement in the working tree, or the reason. Empty where nothing should.
WORDS: Mapping[str, str] = {}  # of command lines and of the files that they read
TEXTS: Mapping[str, str] = {**WORDS}  # of terminal, HTML and other text
PATHS: Mapping[str, str] = {}  # in JSON, MAT, HDF5 and tables
ALONE: Mapping[str, str] = {}  # paths of one side only, and why
RULES: tuple[Rule, ...] = ()  # numbers whose arithmetic or its order changed

FIXED = {each: os.environ.get(each, kernel) for each, kernel in (("OPENBLAS_CORETYPE", "Haswell"), ("FLEXSTAGE_KERNEL", "avx2"))}
"""Kernels of BLAS and of flexstage on both sides, unless the environment names others."""
KERNELS = "-".join(FIXED.values())
WAIT = 60.0
"""Longest wait for an answer of a server [s]."""


@dataclass(frozen=True)
class Task:
    """Commands that run one after another in a folder, with the files they begin with."""

    name: str
    commands: tuple[str, ...]
    files: Mapping[str, str]

    def spelled(self, words: Mapping[str, str]) -> Task:
        """The same in other words."""
        commands = tuple(respelled(each, words) for each in self.commands)
        return Task(self.name, commands, {name: respelled(text, words) for name, text in self.files.items()})


def tasks(pattern: str) -> Iterator[Task]:
    """All that is run whose name `pattern` finds."""
    stated = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))
    files = {**stated["files"], "stack.csv": stack()}
    for run, each in stated["runs"].items():
        for case in each.get("cases", [""]):
            lines = each["commands"].strip().replace("{case}", case)
            name = f"{run}-{case}".rstrip("-")
            if re.search(pattern, name):
                yield Task(name, tuple(lines.split("\n")), {file: text.lstrip() for file, text in files.items() if file in lines})


def stack() -> str:
    """Record of a stack that goes to and fro, as a table: the sum of six plays."""
    turns = (0, 1000, 0, 1000, 100, 900, 200, 800, 300, 700, 400, 600, 500, 1000, 0, 700, 0, 400, 0)
    volts = np.concatenate([np.linspace(start, stop, 50, endpoint=False) for start, stop in pairwise(turns)])
    widths, plays, lines = 40.0 * np.arange(6), np.zeros(6), ["time [s],u [V],y [um]"]
    for number, each in enumerate(volts):
        plays = np.clip(plays, each - widths, each + widths)
        lines.append(f"{0.01 * number:.2f},{each:.1f},{plays @ (0.1, 0.01, 0.01, 0.01, 0.01, 0.01):.6f}")
    return "\n".join(lines) + "\n"


@contextmanager
def whole(folder: Path) -> Generator[Path | None]:
    """A folder to fill that is then `folder`, or None where that is there already: made once, whoever else wants it at the same time."""
    folder.parent.mkdir(parents=True, exist_ok=True)
    with FileLock(folder.with_name(f"{folder.name}.lock")):
        if folder.is_dir():
            yield None
            return
        begun = folder.with_name(f"{folder.name}.part")
        shutil.rmtree(begun, ignore_errors=True)
        begun.mkdir()
        yield begun
        begun.rename(folder)


@dataclass(frozen=True)
class Side:
    """Where one side's source is, what runs it, and where its outputs are kept."""

    source: Path
    python: Path
    kept: Path

    def outputs(self, task: Task) -> Path:
        """Folder of what the task wrote; it runs now if it has not run whole."""
        folder = self.kept / f"{task.name}-{hashlib.sha256(repr(task).encode()).hexdigest()[:8]}"
        with whole(folder) as begun:
            if begun is not None:
                (begun / "out").mkdir()
                (begun / "cache").mkdir()
                for name, text in task.files.items():
                    (begun / "out" / name).write_text(text, encoding="utf-8")
                for number, line in enumerate(task.commands, 1):
                    self._run(line, begun, f"{number:02}-{line.split()[0].lstrip('-')}")
                shutil.rmtree(begun / "cache", ignore_errors=True)
        return folder / "out"

    def _run(self, line: str, folder: Path, name: str) -> None:
        """Run one command; what it writes to its streams and its exit code become files as well."""
        fixed = FIXED | dict.fromkeys(("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS", "PYTHONNOUSERSITE"), "1")
        fixed |= {"PYTHONPATH": str(self.source / "src"), "FLEXSTAGE_CACHE": str(folder / "cache")}
        fixed |= {"COLUMNS": "120", "TERM": "dumb", "LC_ALL": "C.UTF-8", "TZ": "UTC"}
        line, _, lines = line.partition(" < ")
        words = [str(self.python), "-m", "flexstage", *shlex.split(line)]
        out = folder / "out"
        with Popen(words, cwd=out, env=os.environ | fixed, stdin=DEVNULL, stdout=PIPE, stderr=PIPE, encoding="utf-8") as running:
            try:
                said = talk(running, (out / lines).read_text(encoding="utf-8")) if lines else ""
                answers, errors = running.communicate()
            except BaseException:
                running.kill()
                raise
        (out / f"{name}.stdout").write_text(answers, encoding="utf-8")
        (out / f"{name}.stderr").write_text(f"exit code {running.returncode}\n{said}{errors}", encoding="utf-8")


def talk(server: Popen[str], lines: str) -> str:
    """Send lines to a server that names its port first, then interrupt it; all that it said.

    A line with "?" has an answer, whose lines end with a blank but for the last. "QUERY ~ PATTERN" is repeated until the answer matches.
    """
    said = [server.stderr.readline() if server.stderr else ""]
    if (port := re.search(r":(\d+):", said[0])) is None:
        return said[0]
    with socket.create_connection(("127.0.0.1", int(port[1])), WAIT) as connection, connection.makefile("rw", encoding="latin-1") as stream:
        for line in lines.splitlines():
            query, _, pattern = line.partition(" ~ ")
            answer = _ask(stream, query)
            while pattern and not re.fullmatch(pattern, answer.strip()):
                answer = _ask(stream, query)
            said.append(f"{line}\n{'' if pattern else answer}")
    server.send_signal(signal.SIGINT)
    return "".join(said)


def _ask(stream: TextIO, query: str) -> str:
    """The answer to a line, empty where it is no query."""
    stream.write(f"{query}\n")
    stream.flush()
    answer = stream.readline() if "?" in query else ""
    while answer.endswith(" \n"):
        answer += stream.readline()
    return answer


def _command(*words: str | Path) -> str:
    return subprocess.run(words, stdout=subprocess.PIPE, text=True, check=True, cwd=ROOT).stdout.strip()


def base_side(commit: str) -> Side:
    """A commit, laid out beside; with an environment of its own where it needs other packages."""
    source, python, needed = CACHE / commit / "source", Path(sys.executable), "requirements/runtime.txt"
    with whole(source) as begun:
        if begun is not None:
            _command("git", "archive", "--output", begun / "all.tar", commit)
            shutil.unpack_archive(begun / "all.tar", begun, filter="data")
            (begun / "all.tar").unlink()
    if (source / needed).read_bytes() != (ROOT / needed).read_bytes():
        _command("make", "-C", source, "setup-runtime")
        python = source / ".venv" / "bin" / "python"
    _command("env", "-C", source, python, "-c", "import hatch_build; hatch_build.build_kernels()")
    return Side(source, python, CACHE / commit / KERNELS)


def head_side() -> Side:
    """The working tree as it is now, copied, so that it may be changed meanwhile; of earlier ones, outputs of the last day are kept."""
    digest = hashlib.sha256()
    for path in sorted(each for each in (ROOT / "src").rglob("*") if each.is_file() and each.suffix != ".pyc"):
        digest.update(f"{path} {path.stat().st_size}\n".encode() + path.read_bytes())
    tree = CACHE / f"tree-{hashlib.sha256(str(ROOT).encode()).hexdigest()[:12]}" / digest.hexdigest()[:12]
    for each in tree.parent.glob("*"):
        if each != tree and each.stat().st_mtime < time.time() - 86400.0:
            shutil.rmtree(each)
    with whole(tree / "source") as begun:
        if begun is not None:
            shutil.copytree(ROOT / "src", begun / "src", ignore=shutil.ignore_patterns("__pycache__"))
    return Side(tree / "source", Path(sys.executable), tree / KERNELS)


def main() -> int:
    """Run both sides and tell the differences; the exit code is 1 where there are any."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("base", metavar="BASE", help="commit to compare with")
    parser.add_argument("--only", default="", metavar="PATTERN", help="runs whose names this regular expression finds")
    asked = parser.parse_args()
    signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background jobs, and the servers they start, ignore it else
    old, new = base_side(_command("git", "rev-parse", f"{asked.base}^{{commit}}")[:12]), head_side()
    meant = Meant(TEXTS, PATHS, RULES, ALONE)
    states, told = dict[str, Counter[str]](), defaultdict[str, list[str]](list)
    with ThreadPoolExecutor(2) as pool:
        begun = [(each.name, pool.submit(old.outputs, each), pool.submit(new.outputs, each.spelled(WORDS))) for each in tasks(asked.only)]
        for name, first, second in begun:
            found = list(compared_folders(name, first.result(), second.result(), meant))
            states[name] = Counter(state for _, (state, _) in found)
            for where, (state, text) in found:
                if state in (DIFFERENT, SKIPPED):
                    told[f"{state}: {text}"].append(where)
            print(f"{name}: {_verdict(states[name])}", file=sys.stderr, flush=True)
    for text, places in told.items():
        print(f"{places[0]}{f' (and {len(places) - 1} more)' if len(places) > 1 else ''}: {text}")
    for verdict, runs in groupby(sorted(states, key=lambda each: _verdict(states[each])), lambda each: _verdict(states[each])):
        print(f"{verdict}: {', '.join(runs)}")
    counts = sum(states.values(), Counter[str]())
    print(f"{sum(os.times()[2:4]):.0f} s of processor time in commands that ran now", file=sys.stderr)
    print(f"compared {counts.total()}:", ", ".join(f"{counts[state]} {state}" for state in (EQUAL, RENAMED, WITHIN, DIFFERENT, SKIPPED)))
    return int(counts[DIFFERENT] > 0)


def _verdict(states: Mapping[str, int]) -> str:
    """What the findings of a run come to."""
    if states.get(DIFFERENT):
        return DIFFERENT
    return "equal by the tables of what is meant" if states.get(RENAMED) or states.get(WITHIN) else EQUAL


if __name__ == "__main__":
    sys.exit(main())
