"""Kill commands that write at random moments and look at what is left: nothing half-written, no orphan, nothing after the next run.

    python benchmarks/kills.py --count 300 [--seed 1] [--start 0] [--only sweep,plan]

Each kill follows from seed and number. Commands run in copies of this process, which has loaded everything, so that the moments fall into
their work. A target is absent, as it was, or what an undisturbed run writes; processes of the command end soon after it; after
the next run the folder holds its targets alone, the folder for temporary files nothing, and the cache nothing half-written.
"""

from __future__ import annotations

import argparse
import json
import os
import random
import shutil
import signal
import sys
import tempfile
import time
import tomllib
import zipfile
from collections.abc import Callable, Sequence
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import dataclass, replace
from pathlib import Path

for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[name] = "1"
sys.path.insert(0, str(Path(__file__).parents[1]))

import h5py
import psutil
from scipy.io import loadmat

from flexstage.apps.cli import run
from flexstage.base.units.scale import X, Z, mm
from flexstage.cases.registry import case
from flexstage.control.hysteresis.example import example_record
from flexstage.experiment.formats.write import write
from flexstage.mechanism.mechanism import Link, Mechanism
from flexstage.mechanism.store import dump
from flexstage.parts.body import Body, Inertia
from flexstage.parts.rod import Rod

MARK = "FLEXSTAGE_KILLS"
OLD = b"as it was"
PATIENCE = 100.0
"""How long processes of a killed command may live on [s]: they end once they have loaded, which takes a busy machine a while."""
PROBE = b"blat"
"""What Python writes to a file, and removes, to see whether the folder for temporary files can be written to."""
STUDY = """format = "flexstage study 1"
case = "parallelogram"
variables.t = { address = "parts.leaf.thickness", from = "0.7 mm", to = "1.3 mm" }
responses.f = "frequency.platform.1"
responses.m = "mass"
sweep = { sampling = "sobol", designs = 512 }
tolerance = { copies = 64, requirements = false }
scatter.wire = { address = "leaf.thickness", normal = "4 um" }
optimise = { maximise = "f", starts = 1 }
"""
PAIRS = ".pairs"
"""Folder of the results that `design` keeps to resume."""
SPECIFICATION = """format = "flexstage specification 1"
name = "focus"
motion.x = "20 um"
payload = { mass = "0.2 kg", size = ["40 mm", "30 mm", "20 mm"] }
box = { size = ["160 mm", "100 mm", "40 mm"] }
actuators.like = "PiezoDrive SA050536"
starts = 1
requirements.frequency = "at least 300 Hz"
"""
FOUND = "1-guide-piezodrive-sa050536"
"""File name of the only answer to it."""


@dataclass(frozen=True)
class Scene:
    """A command, the files it writes, and what the next run is told besides.

    `fresh`: it refuses to write over a file; `cold`: it starts with an empty cache, so that it computes, and is killed over that too.
    """

    name: str
    words: str
    targets: str
    resumed: str = ""
    fresh: bool = False
    cold: bool = False


DOCUMENTS = "check mapping stiffness lost-motion modes response workspace drift sensitivities budget"
"""Commands that write a JSON document alone."""
SCENES = (
    *(Scene(each, f"{each} stage.toml --json {each}.json", f"{each}.json") for each in DOCUMENTS.split()),
    Scene("catalogue", "catalogue --json c.json", "c.json"),
    Scene("new", "new new.toml --case parallelogram --force", "new.toml"),
    Scene("analyse", "analyse stage.toml --report a.html --json a.json --mat a.mat", "a.html a.json a.mat"),
    Scene(
        "loop",
        "loop stage.toml --bandwidth 100Hz --export c.c --export c.fmu --export c.mat --report l.html --json l.json",
        "c.c c.h c.fmu c.mat l.html l.json",
    ),
    Scene("loop compare", "loop stage.toml --floor VC-D --compare --report l.html --json l.json", "l.html l.json"),
    Scene("loop example", "loop stage.toml --example l.toml", "l.toml"),
    Scene(
        "design",
        "design spec.toml --architecture guide -o . --report g.html --json g.json",
        f"{FOUND}.toml {FOUND}.study.toml {FOUND}.tolerance.toml g.html g.json",
    ),
    Scene("sweep", "sweep study.toml -o s.h5 --workers 2 --report s.html", "s.h5 s.html", "--resume", fresh=True),
    Scene("optimise", "optimise study.toml -o o.toml --json o.json", "o.toml o.json"),
    Scene("front", "optimise front.toml --report o.html --json o.json", "o.html o.json"),
    Scene("tolerance", "tolerance study.toml -o t.h5 --workers 1 --json t.json", "t.h5 t.json", "--resume", fresh=True),
    Scene("rig uff", "rig stage.toml --seconds 2 --model mapped -o w.uff", "w.uff"),
    Scene("rig hdf5", "rig stage.toml --seconds 2 --model mapped -o w.h5", "w.h5"),
    Scene("rig mat", "rig stage.toml --seconds 2 --model mapped -o w.mat", "w.mat"),
    Scene("rig csv", "rig stage.toml --seconds 2 --model mapped -o w.csv", "w.csv"),
    Scene("identify", "identify record.uff --report i.html --json i.json", "i.html i.json"),
    Scene("update", "update stage.toml --record record.uff --parameters leaf.thickness -o u.toml --json u.json", "u.toml u.json"),
    Scene("plan", "plan stage.toml -o p.svg", "p.svg"),
    Scene("hysteresis", "hysteresis stack.csv -o h.toml --report h.html --json h.json", "h.toml h.html h.json"),
    Scene("compare", "compare rods.toml --record rods.uff --fea --report c.html --json c.json", "c.html c.json"),
    Scene("stroke", "stroke stage.toml --drive platform.x --to 0.1mm --steps 3 --json d.json", "d.json"),
    Scene("misalign", "misalign stage.toml --instance left --steps 3 --json f.json", "f.json"),
    Scene("buckle", "buckle stage.toml --json b.json", "b.json"),
    Scene("superelement", "superelement rods.toml left -o e.npz --order 1", "e.npz", cold=True),
    Scene("cad", "cad rods.toml -o d.step --mesh d.vtu --gltf d.glb --order 1", "d.step d.vtu d.glb", cold=True),
    Scene("solid", "solid rods.toml --scope hinge --order 2 --report s.html --json s.json", "s.html s.json", cold=True),
    Scene("verify", "verify rods.toml --order 2 --report v.html --json v.json", "v.html v.json", cold=True),
    Scene("calibrate", "calibrate rods.toml -o k.toml --json k.json --order 2", "k.toml k.json", cold=True),
)
WHOLE: dict[str, Callable[[Path], object]] = {
    ".html": lambda path: path.read_text(encoding="utf-8").rstrip().endswith("</html>") or 1 / 0,
    ".json": lambda path: json.loads(path.read_bytes()),
    ".toml": lambda path: tomllib.loads(path.read_text(encoding="utf-8")),
    ".mat": loadmat,
    ".h5": lambda path: h5py.File(path, "r").close(),
    ".fmu": lambda path: zipfile.ZipFile(path).testzip() is None or 1 / 0,
}
"""How a file is looked at whose bytes depend on the run (times, stretches of a search); others are compared."""


def rods() -> Mechanism:
    """A stage of few elements: a rigid platform on two rods, pushed by a stack."""
    stage = case("parallelogram")
    links = {name: Link(("ground", "platform"), "rod", (0.0, y, 0.0), Z) for name, y in (("left", -20 * mm), ("right", 20 * mm))}
    return replace(
        stage,
        parts={"rod": Rod("steel", 30 * mm, 4 * mm), "stack": stage.parts["stack"]},
        bodies={"platform": Body(mass=0.1, centre=(0.0, 0.0, 0.0), inertia=Inertia(1e-5, 1e-5, 1e-5))},
        links=links | {"B": Link(("ground", "platform"), "stack", (-30 * mm, 0.0, 0.0), X)},
        units={},
        placements={},
        requirements={},
        tags={},
    )


def prepared(folder: Path, scenes: Sequence[Scene]) -> dict[str, dict[str, bytes]]:
    """Fill a folder with what the commands read; the files that each writes undisturbed. What they load is loaded then."""
    folder.mkdir()
    dump(case("parallelogram"), folder / "stage.toml")
    dump(rods(), folder / "rods.toml")
    (folder / "study.toml").write_text(STUDY)
    (folder / "spec.toml").write_text(SPECIFICATION)
    (folder / "front.toml").write_text(STUDY.replace('maximise = "f"', 'maximise = "f", minimise = "m"'))
    write(folder / "stack.csv", example_record())
    made = {}
    for name, record in (("stage", "record"), ("rods", "rods")):
        ended(folder, f"rig {name}.toml --seconds 2 --model mapped -o {record}.uff")
    read = set(folder.iterdir())
    for scene in scenes:
        ended(folder, scene.words)
        made[scene.name] = {each: (folder / each).read_bytes() for each in scene.targets.split()}
        for each in set(folder.iterdir()) - read:
            shutil.rmtree(each) if each.is_dir() else each.unlink()
    return made


def ended(folder: Path, words: str) -> None:
    """Run a command in this process, in a folder."""
    os.chdir(folder)
    with open(os.devnull, "w") as nowhere, redirect_stdout(nowhere), redirect_stderr(nowhere):  # noqa: PTH123
        code = run(words.split())
    if code:
        raise SystemExit(f"{words}: exit code {code}")


def begun(folder: Path, words: str, mark: str, cache: Path | None) -> int:
    """Run a command in a copy of this process; its number."""
    number = os.fork()
    if number:
        return number
    os.environ |= {MARK: mark, "TMPDIR": str(folder / "temporary")} | ({"FLEXSTAGE_CACHE": str(cache)} if cache else {})
    tempfile.tempdir = None
    log = os.open(folder.parent / "log", os.O_WRONLY | os.O_CREAT | os.O_APPEND)
    for stream in (1, 2):
        os.dup2(log, stream)
    os.chdir(folder)
    os._exit(run(words.split()))


def orphans(mark: str) -> list[psutil.Process]:
    """Processes that a command of this mark has started and that live."""
    found = []
    for each in psutil.process_iter():
        try:
            if each.pid != os.getpid() and each.status() != psutil.STATUS_ZOMBIE and each.environ().get(MARK) == mark:
                found.append(each)
        except psutil.Error:
            continue
    return found


def kill(scene: Scene, workshop: Path, made: dict[str, bytes], chance: random.Random, longest: float) -> tuple[list[str], bool]:
    """Kill a command once at a random moment and run it again; what must not be, and whether it was killed before it ended."""
    folder, cache = workshop / "killed", workshop / "cold" if scene.cold else None
    for each in (folder, workshop / "cold"):
        shutil.rmtree(each, ignore_errors=True)
    (folder / "temporary").mkdir(parents=True)
    for each in (workshop / "prepared").iterdir():
        shutil.copy(each, folder)
    inputs = {each.name for each in folder.iterdir()}
    before = dict.fromkeys(made, OLD) if not scene.fresh and chance.random() < 0.5 else {}
    for name, content in before.items():
        (folder / name).write_bytes(content)
    mark = f"{os.getpid()}-{chance.random()}"
    number = begun(folder, scene.words, mark, cache)
    time.sleep(chance.random() * longest)
    os.kill(number, signal.SIGKILL)
    killed = os.WIFSIGNALED(os.waitpid(number, 0)[1])
    wrong = [f"{name} is half-written" for name in made if not _sound(folder / name, before.get(name), made[name])]
    deadline = time.monotonic() + PATIENCE
    while (left := orphans(mark)) and time.monotonic() < deadline:
        time.sleep(0.1)
    wrong += [f"process {each.pid} lives: {' '.join(each.cmdline())[:100]}" for each in left]
    words = f"{scene.words} {scene.resumed}" if (folder / "s.h5.pieces").exists() or (folder / "t.h5.pieces").exists() else scene.words
    words = f"{words} {scene.resumed}" if any((folder / each).exists() for each in ("s.h5", "t.h5")) and words == scene.words else words
    code = os.waitstatus_to_exitcode(os.waitpid(begun(folder, words, mark, cache), 0)[1])
    wrong += [f"the next run ends with {code}"] if code else []
    wrong += [f"{name} is not there after the next run" for name in made if not _sound(folder / name, None, made[name], there=True)]
    wrong += [f"{each.name} is left" for each in folder.iterdir() if each.name not in {*inputs, *made, PAIRS}]
    wrong += [f"{each.relative_to(workshop)} is left" for each in (workshop / ("cold" if scene.cold else "cache")).rglob("*.part")]
    left_over = (each for each in (folder / "temporary").iterdir() if each.is_dir() or each.read_bytes() not in {b"", PROBE})
    return wrong + [f"temporary/{each.name} is left" for each in left_over], killed


def _sound(path: Path, before: bytes | None, made: bytes, *, there: bool = False) -> bool:
    if not path.exists():
        return before is None and not there
    found = path.read_bytes()
    if found in ({made} if before is None else {made, before}):
        return True
    try:
        WHOLE[path.suffix](path)
    except Exception:  # noqa: BLE001 whatever it is, the file is not what it says
        return False
    return True


def survey(scenes: Sequence[Scene], count: int, seed: int, start: int = 0) -> tuple[int, list[str]]:
    """Kill so many times; how many commands were killed before they ended, and what must not be."""
    wrong: list[str] = []
    killed = 0
    with tempfile.TemporaryDirectory() as place:
        workshop = Path(place)
        os.environ.setdefault("FLEXSTAGE_CACHE", str(workshop / "cache"))
        made = prepared(workshop / "prepared", scenes)
        longest: dict[str, float] = {}
        for number in range(start, start + count):
            chance = random.Random(f"{seed} {number}")  # noqa: S311 nothing secret
            scene = scenes[number % len(scenes)]
            if scene.name not in longest:
                began = time.monotonic()
                kill(scene, workshop, made[scene.name], random.Random(0), 0.0)  # noqa: S311
                longest[scene.name] = time.monotonic() - began
            found, was = kill(scene, workshop, made[scene.name], chance, longest[scene.name])
            killed += was
            wrong += [f"{number} {scene.name}: {each}" for each in found]
            print(f"{number:4} {scene.name:10} {'killed' if was else 'ended'} {'; '.join(found)}", flush=True)
        os.chdir(place)
    return killed, wrong


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=len(SCENES))
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--start", type=int, default=0)
    parser.add_argument("--only", default="")
    asked = parser.parse_args()
    killed, wrong = survey(
        [each for each in SCENES if not asked.only or each.name in asked.only.split(",")], asked.count, asked.seed, asked.start
    )
    print(f"{killed} of {asked.count} killed before they ended; {len(wrong)} findings")
    print("\n".join(wrong))
    sys.exit(bool(wrong))


if __name__ == "__main__":
    main()
