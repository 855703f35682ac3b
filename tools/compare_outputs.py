"""Outputs of a commit beside those of the working tree: what changed, number by number.

    python -m tools.compare_outputs BASE [--only PATTERN]

The commands of compare_outputs.toml run on both sides with one BLAS kernel and one thread. JSON, MAT, HDF5, the text of tables and all
other files must be equal bit by bit. What is left out, and what is meant to differ, is stated in the tables below; all else is told, a
line a difference. Outputs are kept in the user's cache: those of a commit for good, those of the working tree until a file of src changes.
"""

from __future__ import annotations

import argparse
import hashlib
import os
import re
import shlex
import shutil
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

import numpy as np
from filelock import FileLock
from platformdirs import user_cache_path

from tools.differences import DIFFERENT, EQUAL, RENAMED, SKIPPED, WITHIN, Meant, Rule, compared_folders, respelled

ROOT = Path(__file__).resolve().parents[1]


# What is meant to differ: regular expression at BASE -> what it is in the working tree.
WORDS: Mapping[str, str] = {r"--reading": "--model", r"^reading = ": "model = "}  # of command lines and of the files that they read
TEXTS: Mapping[str, str] = {  # of terminal, HTML and other text
    r"(?<!gauge's )\breading\b(?! that is no| closes no|, then each|\[)": "model",  # not those of the C code
    r"(for all|What|connect) readings": r"\1 models",
    "The theories a stage can be read by": "Models of theory",
    "theory that the stage is read by as": "of the stage as",
    "^flexstage result 1$": "flexstage result 2",
    r"\bAmplifying\b": "AmplifierSetup",  # classes in schemas
    r"\bControlling\b": "ControllerSetup",
    r"\bGauging\b": "GaugeSetup",
    r"\bShaking\b": "VibrationSetup",
    r"\bCommanded\b(?! less)": "TrajectorySetup",
    "&quot;": "&#34;",
    "&#x27;": "&#39;",
    r"(^|>)Room($|<)": r"\1Clearance\2",
    "Forces, strength and room": "Forces, strength and clearance",
    r"^(# [a-z0-9-]+: .*\.)$": "#:schema ./flexstage.schema.json\n\\1",
    r"^(# flexstage check \S+ .*)$": "\\1\n# flexstage schema > flexstage.schema.json lets an editor check this file while you type.",
}
PATHS: Mapping[str, str] = {  # in JSON, MAT and HDF5
    r"\breading$": "model",
    r"^(frequency|gain|loss)(?=\.(rows|columns|unit|values))": r"\1_slopes",
    r"^([a-z-]+\.)?method$": r"\1provenance",
    r"\bplatform_modes": "platform",
    r"^((?:[a-z-]+\.)?)gain_matrix": r"\1gain",
    r"\bin_plane_tensor_free$": "free",
    r"\bin_plane_tensor$": "held",
    r"\bin_plane_tensor_free": "free.tensor",
    r"\bin_plane_tensor": "held.tensor",
    r"\bcentre_of_stiffness_m": "centre_m",
    r"\bprincipal_free\.": "free.",
    r"\bprincipal\.": "held.",
    r"\b(held|free)\.stiffness_n_per_m": r"\1.principal_n_per_m",
    r"\bstiffest_direction_rad": "angle_rad",
    r"^(workspace\.)?room\b": r"\1clearance",
    r"\bredundant$": "redundant[].constraints",
    r"\bsingle_axis_corrected": "corrected",
    r"\bsingle_axis": "single",
    r"\b(single|corrected)\.limiting\.(\w+)$": r"\1.coordinates.\2.limiting",
    r"\bgauge_range": "gauges",
    r"\bgauges\.fits\.": "gauges.gauges.",
    r"\b(gauges\.gauges\.[^.]+)$": r"\1.fits",
    r"\bpose_resolution": "resolution",
    r"\b(resolution|platform_lines)(?=\.(rows|columns|unit|values))": r"\1.table",
    r"\bpolytope\.vertices": "polytope.poses.values",
    r"(?<!units\.)\b(drive|stack_lines)\.(?!actuators)": r"\1.actuators.",
    r"(axial|lateral)_stiffness_n_per_m": r"\1_n_per_m",
    r"\bstress\.least_safety": "stress.least",
    r"\bstress\.strokes": "stress.worst_strokes",
    r"\bleast_factor": "least",
    r"\bbuckling\.ends\.(.+)$": r"buckling.links.\1.ends",
    r"\bstage\.dead_load": "stage.dead",
    r"\bstage\.worst_strokes": "stage.worst",
    r"\bmaximum_load_n": "maximum_n",
    r"\btensile_limit_n": "tensile_n",
    r"\bloads(\.actuators\..*\.)(least|largest)_compression": r"bearing\1\2",
    r"\bloads(\.actuators\..*\.(usage|pull))": r"bearing\1",
    r"mapped_stiffness_n_per_m": "series_n_per_m",
    r"^test\[\]": "files[]",
    r"^(files\[\])\.seconds": r"\1.duration_s",
    r"^(files\[\])\.samples": r"\1.length",
    r"^close$": "close_modes",
    r"^shapes\b": "shape_matrix",
    r"^spectra\.(window|overlap)": r"spectra.segments.\1",
    r"^spectra\.independent_averages": "spectra.independent",
    r"^spectra\.(mean_multiple_coherence)": r"\1",
    r"^((?:compared\.)?modes\[\])\.theory_over_experiment": r"\1.difference",
    r"^((?:compared\.)?modes\[\])\.fea_over_experiment": r"\1.fea_difference",
    r"^((?:compared\.)?(?:modes|further)\[\]\.(?:fea_)?)modal_assurance": r"\1assurance",
    r"^((?:compared\.)?repeated\[\])\.modes": r"\1.numbers",
    r"^((?:compared\.)?repeated\[\])\.largest_angle_rad": r"\1.angle_rad",
    r"^chi_square\.before": "chi_square_before",
    r"^chi_square\.after": "chi_square",
    r"^chi_square\.data": "freedoms",
    r"^chi_square\.(probability)": r"\1",
    r"\bplatform_shapes": "twists",
    r"^(units\.[^.]+\.)(stroke|command|output)_m$": r"\1\2s_m",
    r"^(units\.[^.]+\.)?stress\.(?!names\.)(.+)\.von_mises_pa$": r"\1stress.names.\2.highest_pa",
    r"^(units\.[^.]+\.)?stress\.(?!names\.)(.+)\.yield_pa$": r"\1stress.names.\2.yield_stress_pa",
    r"^(units\.[^.]+\.)?stress\.(?!names\.)([^.]+)\.safety$": r"\1stress.names.\2.safety",
    r"^parts\.([^.]+)\.over_beam_theory$": r"over_beam_theory.\1",
    r"^parts\.([^.]+)\.(links|roots|compliance|stiffness|separable|errors?|order|elements|freedoms)\b": r"hinges.\1.\2",
    r"\bground_source$": "ground.source",
    r"^(drift\.)?ground$": r"\1ground.material",
    r"^scatter\[\]\.(shape|size|within)": r"scatter[].distribution.\1",
    r"^yield\.lines\[\]\.(kept|copies|share|interval)": r"yield.lines[].yield.\1",
    r"^failures\[\]\.copy": "failures[].design",
    r"^plant\.(coordinates|actuators|gauges)$": r"plant.coordinates.\1",
    r"^plant\.coordinates\.coordinates$": "plant.coordinates.names",
    r"^plant\.(rate_hz|delay_s)$": r"plant.hardware.\1",
    r"^plant\.modes_hz$": "plant.frequencies_hz",
    r"^plant\.modes_left_out$": "plant.left_out",
    r"^plant\.highest": "highest",
    r"^controller\.state_space": "controller.system",
    r"^(controller\.loops\.\w+)\.(?!notches)": r"\1.law.",
    r"^(controller\.loops\..*\.law\.(?:integral|gain))$": r"\1_per_s",
    r"^(controller\.loops\..*\.law\.(?:derivative|tracking|tracking_time))$": r"\1_s",
    r"^(controller\.loops\..*\.law\.filter)$": r"\1_hz",
    r"^((?:controller|disk_margin|stability)\b.*\.frequency)$": r"\1_hz",
    r"^stability\.(growth_all_modes)$": r"\1_per_s",
    r"^(stability\.least\.growth)$": r"\1_per_s",
    r"^reasons\.disk$": "reasons.disk_margin",
    r"^(reasons\.)?margins\.": r"\1margins.loops.",
    r"^bandwidths\.": "bandwidths.coordinates.",
    r"^hysteresis\.": "hysteresis.actuators.",
    r"^static_errors\.(mapped|lumped)_gains": "static_errors.other_gains",
    r"^noise\.(simulated_)": r"\1",
    r"^runs\[\]\.course$": "runs[].course.name",
    r"^runs\[\]\.moved$": "runs[].course.moved",
    r"^runs\[\]\.(saturated|slewing)\.(\w+)$": r"runs[].simulated.actuators.\2.\1",
    r"^runs\[\]\.out_of_range\.(\w+)$": r"runs[].simulated.gauges.\1.out_of_range",
    r"^(range_v|stroke_m|rms|largest|validation|width|drift|branches|inner)$": r"hysteresis.\1",
    r"^model\.": "hysteresis.plays.",
}
GONE: Mapping[str, str] = {  # paths that stand at BASE only, and where the same is now
    r"^stiffness\.(reasons\.)?dead_load$": "of the lumped model alone",
    r"\bcrosstalk\.": "the entries of `transfer` beside its diagonal",
    r"^(workspace\.)?strokes\.": "`limits`, actuator by actuator",
    r"\bmap_error\.worst": "the first column of its `table`",
    r"\bprincipal(_free)?$": "null, where `held` or `free` is",
    r"^parameters\[\]": "`parameters` by address",
    r"\b(?:room|clearance)\.intrusions\.": "a list",
    r"^trials$": "`hysteresis.trials`, a record each",
}
COME: Mapping[str, str] = {  # paths that stand in the working tree only
    r"\bprovenance$": "each result says where it comes from",
    r"^(workspace\.)?limits\.": "strokes, actuator by actuator",
    r"\bcorner\.command|\bpolytope\.poses\.(rows|columns|unit)": "names of rows and columns",
    r"\b(platform_lines\.coordinates|stress\.links|units\.[^.]+\.unit|actuators)$": "names of rows and columns",
    r"\b(resolution\.inverse|clearance\.extreme|buckling\.stage\.(strokes_m|stiffens))": "fields of the result that were not told",
    r"^(budget\.)?ground\.": "which material the ground was taken as",
    r"\bclearance\.intrusions\[\]": "a list",
    r"^(workspace\.)?bearing$": "null, where `loads` is",
    r"^parameters\.": "`parameters` by address",
    r"\bvariables\[\]\.(logarithmic|levels|step|parameters)$": "fields of a variable that were not told",
    r"^(margins|peaks)\.cut$|^bandwidths\..*\.(complementary|half_rejection)_hz$|\.other_model$": "fields of the loop that were not told",
    r"^plant\.coordinates\.(units|length_m)$|\bcourse\.duration_s$|^hysteresis\.(known_from|actuators\..*\.improvement)$": "the same",
    r"^hysteresis\.trials\[\]": "a record each",
}
RULES: tuple[Rule, ...] = (  # numbers whose arithmetic or its order changed; searched() gives those of searches
    Rule(r"(room|clearance)\.intrusions$", "was by body, is a list", np.inf),
    Rule(r"^printed/01-schema", "designs name the packages that they need", np.inf),
    Rule(r"^printed/02-schema", "classes have other names, and are sorted by them", np.inf),
    Rule(r"^test-.*provenance$", "a digest of what was identified", np.inf),
    Rule(
        r"^(test-[a-z-]+|records)/.*\.json:",
        "the background is summed once: the search ends within its tolerance",
        1e-6,
    ),
    Rule(r"\bbuckling\.", "products of a beam's shapes are summed as products of matrices"),
)

KERNEL = os.environ.get("OPENBLAS_CORETYPE", "Haswell")


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
                for name, text in task.files.items():
                    (begun / "out" / name).write_text(text, encoding="utf-8")
                for number, line in enumerate(task.commands, 1):
                    self._run(line, begun, f"{number:02}-{line.split()[0]}")
                shutil.rmtree(begun / "cache", ignore_errors=True)
        return folder / "out"

    def _run(self, line: str, folder: Path, name: str) -> None:
        """Run one command; what it says and its exit code become files as well."""
        fixed = dict.fromkeys(("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS", "PYTHONNOUSERSITE"), "1")
        fixed |= {"PYTHONPATH": str(self.source / "src"), "FLEXSTAGE_CACHE": str(folder / "cache")}
        fixed |= {"OPENBLAS_CORETYPE": KERNEL, "COLUMNS": "120", "TERM": "dumb", "LC_ALL": "C.UTF-8", "TZ": "UTC"}
        words = [str(self.python), "-m", "flexstage", *shlex.split(line)]
        done = subprocess.run(words, cwd=folder / "out", env=os.environ | fixed, capture_output=True, encoding="utf-8", check=False)
        (folder / "out" / f"{name}.stdout").write_text(done.stdout, encoding="utf-8")
        (folder / "out" / f"{name}.stderr").write_text(f"exit code {done.returncode}\n{done.stderr}", encoding="utf-8")


def _command(*words: str | Path) -> str:
    return subprocess.run(words, stdout=subprocess.PIPE, text=True, check=True, cwd=ROOT).stdout.strip()


def base_side(commit: str, cache: Path) -> Side:
    """A commit, laid out beside; with an environment of its own where it needs other packages."""
    source, python, needed = cache / commit / "source", Path(sys.executable), "requirements/runtime.txt"
    with whole(source) as begun:
        if begun is not None:
            _command("git", "archive", "--output", begun / "all.tar", commit)
            shutil.unpack_archive(begun / "all.tar", begun, filter="data")
            (begun / "all.tar").unlink()
    if (source / needed).read_bytes() != (ROOT / needed).read_bytes():
        _command("make", "-C", source, "setup-runtime")
        python = source / ".venv" / "bin" / "python"
    return Side(source, python, cache / commit / KERNEL)


def head_side(cache: Path) -> Side:
    """The working tree as it is now, copied, so that it may be changed meanwhile; of earlier ones, outputs of the last day are kept."""
    digest = hashlib.sha256()
    for path in sorted(each for each in (ROOT / "src").rglob("*") if each.is_file() and each.suffix != ".pyc"):
        digest.update(f"{path} {path.stat().st_size}\n".encode() + path.read_bytes())
    tree = cache / f"tree-{hashlib.sha256(str(ROOT).encode()).hexdigest()[:12]}" / digest.hexdigest()[:12]
    for each in tree.parent.glob("*"):
        if each != tree and each.stat().st_mtime < time.time() - 86400.0:
            shutil.rmtree(each)
    with whole(tree / "source") as begun:
        if begun is not None:
            shutil.copytree(ROOT / "src", begun / "src", ignore=shutil.ignore_patterns("__pycache__"))
    return Side(tree / "source", Path(sys.executable), tree / KERNEL)


def main() -> int:
    """Run both sides and tell the differences; the exit code is 1 where there are any."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("base", metavar="BASE", help="commit to compare with")
    parser.add_argument("--only", default="", metavar="PATTERN", help="runs whose names this regular expression finds")
    asked = parser.parse_args()
    cache = user_cache_path("flexstage", appauthor=False) / "compare-outputs"
    old, new = base_side(_command("git", "rev-parse", f"{asked.base}^{{commit}}")[:12], cache), head_side(cache)
    meant = Meant(TEXTS, PATHS, RULES, GONE, COME)
    states, told = dict[str, Counter[str]](), defaultdict[str, list[str]](list)
    with ThreadPoolExecutor(2) as pool:
        begun = [(each.name, pool.submit(old.outputs, each), pool.submit(new.outputs, each.spelled(WORDS))) for each in tasks(asked.only)]
        for name, first, second in begun:
            found = list(compared_folders(name, first.result(), second.result(), meant))
            states[name] = Counter(state for _, (state, _) in found)
            for where, (state, text) in found:
                if state == DIFFERENT:
                    told[text].append(where)
            print(f"{name}: {_verdict(states[name])}", file=sys.stderr, flush=True)
    for text, places in told.items():
        print(f"{places[0]}{f' (and {len(places) - 1} more)' if len(places) > 1 else ''}: {text}")
    for verdict, runs in groupby(sorted(states, key=lambda each: _verdict(states[each])), lambda each: _verdict(states[each])):
        print(f"{verdict}: {', '.join(runs)}")
    counts = sum(states.values(), Counter[str]())
    print(f"compared {counts.total()}:", ", ".join(f"{counts[state]} {state}" for state in (EQUAL, RENAMED, WITHIN, DIFFERENT, SKIPPED)))
    return int(counts[DIFFERENT] > 0)


def _verdict(states: Mapping[str, int]) -> str:
    """What the findings of a run come to."""
    if states.get(DIFFERENT):
        return DIFFERENT
    return "equal by the tables of what is meant" if states.get(RENAMED) or states.get(WITHIN) else EQUAL


if __name__ == "__main__":
    sys.exit(main())
