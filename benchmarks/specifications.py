"""From specifications to stages: answers with their values by better models, excluded pairs, and processor seconds.

The command as users run it, one specification after the other. The coils and amplified actuators are assumed families, no products: force
of a coil grows with the root of its power, motor constants are about 1.9 N/sqrt(W) at 10 g.

    python benchmarks/specifications.py [seed | scanner | mirror | z | xy | impossible ...] [--prove]
"""

from __future__ import annotations

import os

for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[name] = "1"

import argparse
import json
import resource
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

SPECIFICATIONS = {
    "seed": """
        motion = { x = "50 um", y = "50 um", z = "150 um", rx = "733 urad", ry = "733 urad", rz = "244 urad" }
        payload = { mass = "1 kg", size = ["300 mm", "300 mm", "5 mm"] }
        box = { size = ["380 mm", "380 mm", "115 mm"], opening = ["110 mm", "110 mm"] }
        actuators.like = ["PSt 1000/10/150 VS18", "PSt 1000/16/200 VS25"]
        requirements.frequency = "at least 100 Hz" """,
    "scanner": """
        motion = { x = "50 um", y = "50 um" }
        payload = { mass = "30 g", size = ["30 mm", "30 mm", "5 mm"] }
        box = { size = ["260 mm", "260 mm", "40 mm"] }
        requirements.frequency = "at least 1 kHz" """,
    "mirror": """
        motion = { rx = "5 mrad", ry = "5 mrad" }
        payload = { mass = "24 g", size = ["25 mm", "25 mm", "6 mm"] }
        box = { size = ["80 mm", "80 mm", "150 mm"] }
        make.thinnest = "0.15 mm"
        requirements.frequency = "at least 500 Hz" """,
    "z": """
        motion.z = "0.5 mm"
        payload = { mass = "2 kg", size = ["80 mm", "60 mm", "40 mm"] }
        box = { size = ["200 mm", "120 mm", "120 mm"] }
        requirements.unwanted = "at least 100 Hz" """,
    "xy": """
        motion = { x = "5 mm", y = "5 mm" }
        payload = { mass = "0.3 kg", size = ["80 mm", "80 mm", "15 mm"] }
        box = { size = ["300 mm", "300 mm", "120 mm"] }
        make.thinnest = "0.15 mm"
        requirements.unwanted = "at least 80 Hz" """,
    "impossible": """
        motion = { x = "0.5 mm", y = "0.5 mm" }
        payload = { mass = "1 kg", size = ["60 mm", "60 mm", "20 mm"] }
        box = { size = ["120 mm", "120 mm", "40 mm"] }
        requirements.frequency = "at least 500 Hz" """,
}
COILS = {  # force constant N/A, continuous A, ohm, coil g, magnet g, travel mm, K/W
    "coil M": (10.0, 1.5, 5.0, 32.0, 150.0, 12.0, 8.0),
    "coil XL": (32.0, 2.5, 5.0, 180.0, 950.0, 26.0, 3.0),
}
SHELLS = {"shell 300": (300.0, 2.0, 160.0), "shell 1000": (1000.0, 0.35, 300.0)}  # um, N/um, g


def catalogue() -> str:
    """The assumed actuators as a catalogue file."""
    coils = (
        f'[coils."{each}"]\nforce_constant = "{force} N/A"\ncontinuous_current = "{current} A"\nresistance = "{ohm} ohm"\n'
        f'mass = "{coil} g"\nmagnet_mass = "{magnet} g"\ntravel = "{travel} mm"\nthermal_resistance = "{warm} K/W"\n'
        'temperature_rise = "80 K"\n'
        for each, (force, current, ohm, coil, magnet, travel, warm) in COILS.items()
    )
    shells = (
        f'[amplified."{each}"]\nstroke = "{stroke} um"\nmass = "{mass} g"\n'
        f'diagonal = ["{k} N/um", "{0.7 * k} N/um", "{1.5 * k} N/um", "{80 * k} N m/rad", "{48 * k} N m/rad", "{32 * k} N m/rad"]\n'
        for each, (stroke, k, mass) in SHELLS.items()
    )
    return "\n".join([*coils, *shells])


def run(name: str, options: list[str]) -> None:
    """Run one specification and print its answers."""
    with tempfile.TemporaryDirectory() as folder:
        head = f'format = "flexstage specification 1"\nname = "{name}"\ncatalogue = "lab.toml"\n'
        lines = "\n".join(line.strip() for line in SPECIFICATIONS[name].splitlines())
        (Path(folder) / "lab.toml").write_text(catalogue())
        (Path(folder) / "spec.toml").write_text(head + lines + "\n")
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        words = [sys.executable, "-m", "flexstage", "design", "spec.toml", "-o", "answers", "--json", "answers.json", *options]
        ended = subprocess.run(words, cwd=folder, capture_output=True, text=True, check=False)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        spent = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        print(f"\n== {name}: exit code {ended.returncode}, {spent:.1f} s of processor")
        path = Path(folder) / "answers.json"
        if not path.exists():
            print(ended.stderr)
            return
        found: dict[str, Any] = json.loads(path.read_text())
    for each in found["answers"]:
        print(f"   {each['architecture']} with {each['actuator']}: {text(each)}")
    for each in found["failed"]:
        print(f"   failed: {each['architecture']} with {each['actuator']}: {each['violation']} {each['requirements'] or each['reason']}")
    for each in found["impossible"]:
        print(f"   impossible: {each['architecture']} with {each['actuator']}: {each['shortfall']['reason']}")


def text(answer: dict[str, Any]) -> str:
    """Frequencies and width of an answer by all models, its searches and warnings."""
    keys = [key for key in answer["values"] if key in {"frequency.1", "frequency.unwanted"}]
    models = [model for model in ("values", "elastic", "displaced", "verified") if answer[model]]
    values = [f"{key} {', '.join(f'{model} {answer[model][key]:.1f}' for model in models if key in answer[model])} Hz" for key in keys]
    width = 1e3 * answer["values"]["envelope.x"]
    return f"{'; '.join(values)}; {width:.1f} mm wide; {answer['rounds']} searches; {len(answer['warnings'])} warnings"


def main() -> None:
    """Run the specifications that are named, or all."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", metavar="NAME", help="of a specification; default: all")
    parser.add_argument("--prove", action="store_true", help="finite elements of the first three answers")
    given = parser.parse_args()
    for each in given.names or SPECIFICATIONS:
        run(each, ["--prove"] if given.prove else [])


if __name__ == "__main__":
    main()
