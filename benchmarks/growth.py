"""How cost grows: with bodies, designs, samples and hinges as solids; a process each size, seconds and memory.

    python benchmarks/growth.py [bodies | trees | designs | samples | hinges] [SIZES ...] [--printed FILE] [--figure FILE]

Bodies: models, statics, modes and drift of coiled chains; trees: the same of bodies that branch in two. What bounds each: expanding the
description and the links' operators grow with the bodies; the factor of the stiffness hardly does in chains and trees; the modes take some
300 solves of it. Below 60 bodies matrices are dense.
Designs: six platform frequencies of the shipped stage over four numbers, features fitted once; what is found is let go, as a study
writes it.
Samples: spectra of one drive and one reading, taken from a source that makes them as they are asked for, in segments of a second.
Hinges: the 6x6 of so many notches by finite elements to 1 %, all of another thickness, none from a cache.

Seconds are those of the processor, all processes together, and in the last column but one those that went by; memory is that of the largest
process. `--figure` draws them, of what runs and of what `--printed` holds from earlier.
"""

from __future__ import annotations

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import argparse
import itertools
import re
import resource
import subprocess
import sys
import time
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

SIZES = {
    "bodies": (10, 30, 100, 300, 1000, 3000, 10000),
    "trees": (100, 1000, 10000),
    "designs": (10**3, 10**4, 10**5, 10**6, 10**7),
    "samples": (10**4, 10**5, 10**6, 10**7, 10**8),
    "hinges": (1, 3, 10, 30, 100),
}
_OF_BODIES = ("describe", "lumped", "statics", "modes", "drift", "ideal")
STEPS = {
    "bodies": _OF_BODIES,
    "trees": _OF_BODIES,
    "designs": ("fit", "solve"),
    "samples": ("open", "spectra"),
    "hinges": ("describe", "solve"),
}
NUMBERS = ("parts.neck.thickness", "parts.foot_notch.thickness", "parts.pole_neck.profile.radius", "placements.B1-B3.pattern.radius")
PORTION, RATE = 100_000, 10_000.0


def chain(count: int) -> object:
    """A coil of bodies of 0.1 kg, each joined to the next one by a steel rod, the last one the platform."""
    import numpy as np

    angles = 0.3 * np.arange(count + 1)
    places = np.column_stack([0.1 * np.cos(angles), 0.1 * np.sin(angles), 0.002 * np.arange(count + 1)])
    return joined(places, range(count), platform=count)


def tree(count: int) -> object:
    """Bodies that branch in two each, 30 mm from one to the next in directions of chance; the platform is the last one."""
    import numpy as np

    steps = np.random.default_rng(4).normal(size=(count + 1, 3))
    places = np.zeros((count + 1, 3))
    parents = [0, *(max(1, number // 2) for number in range(2, count + 1))]
    for number, parent in enumerate(parents, start=1):
        places[number] = places[parent] + 0.03 * steps[number] / np.linalg.norm(steps[number])
    return joined(places, parents, platform=count)


def joined(places: object, parents: object, platform: int) -> object:
    """Bodies at places (from 1 on), each joined to its parent by a steel rod; 0 is the ground."""
    import numpy as np

    import flexstage as fs

    names = ["ground", *("platform" if number == platform else f"b{number}" for number in range(1, len(places)))]
    inertia = fs.Inertia(1e-5, 1e-5, 1e-5)
    bodies = {
        name: fs.Body(mass=0.1, centre=tuple(at), inertia=inertia, reference=tuple(at))
        for name, at in zip(names[1:], places[1:], strict=True)
    }
    links = {}
    for number, parent in enumerate(parents, start=1):
        along, middle = places[number] - places[parent], 0.5 * (places[number] + places[parent])
        ends = (names[parent], names[number])
        links[f"r{number}"] = fs.Link(ends, "rod", at=tuple(middle), along=tuple(along / np.linalg.norm(along)))
    steel = fs.Material(young=200e9, poisson=0.3, density=7800.0, expansion=1.1e-5)
    rod = fs.Rod("steel", length=0.03, diameter=0.004)
    return fs.Mechanism("joined", materials={"steel": steel}, parts={"rod": rod}, bodies=bodies, links=links, gravity=(0.0, 0.0, 0.0))


def bodies(count: int) -> Iterator[None]:
    """Step by step, the models and analyses of a coil."""
    return analysed(chain(count))


def trees(count: int) -> Iterator[None]:
    """Step by step, the models and analyses of a tree."""
    return analysed(tree(count))


def analysed(stage: object) -> Iterator[None]:
    """Its models and analyses."""
    import flexstage as fs

    yield
    model = fs.lumped(stage)
    yield
    fs.statics(model)
    yield
    fs.modes(model)
    yield
    fs.drift(stage, model, ground="none")
    yield
    fs.ideal(stage)
    yield


def designs(count: int) -> Iterator[None]:
    """The plan of the shipped stage over four numbers, then its designs, portion by portion."""
    import numpy as np

    from flexstage.cases.double_triangle import double_triangle
    from flexstage.mechanism.addresses.address import get
    from flexstage.models.batch.engine import plan, platform_modes

    stage = double_triangle()
    own = np.array([get(stage, name) for name in NUMBERS])
    found = plan(stage, NUMBERS, ranges=(0.95 * own, 1.05 * own))
    yield
    random = np.random.default_rng(0)
    for first in range(0, count, PORTION):
        platform_modes(found, own * random.uniform(0.95, 1.05, (min(PORTION, count - first), len(own))))
    yield


@dataclass(frozen=True)
class Noise:
    """A drive of white noise and a reading that follows it, made as they are read."""

    length: int

    def read(self, start: int, stop: int) -> object:
        """Both channels from one sample to another."""
        import numpy as np

        drive = np.random.default_rng(start).standard_normal(stop - start)
        return np.stack([drive, 2.0 * drive], axis=1)


def samples(count: int) -> Iterator[None]:
    """The spectra of one reading."""
    import flexstage as fs

    ends = (fs.experiment.Channel("u", "V", fs.experiment.Role.INPUT), fs.experiment.Channel("y", "um", fs.experiment.Role.OUTPUT))
    record = fs.experiment.Record(ends, RATE, Noise(count))
    yield
    fs.experiment.spectra(record, fs.experiment.Segments(min(1.0, 0.1 * count / RATE)))
    yield


def hinges(count: int) -> Iterator[None]:
    """The 6x6 of notches, each a little thicker than the one before."""
    import flexstage as fs
    from flexstage.solid.fea.hinges.hinge_form import HingeForm
    from flexstage.solid.fea.hinges.roots import Roots
    from flexstage.solid.fea.jobs.parts import Ways
    from flexstage.solid.results.hinges import hinges as solid_hinges

    steel = fs.Material(young=200e9, poisson=0.3, density=7800.0, expansion=1.1e-5)
    notches = [fs.Notch("steel", 1e-3 * (1.0 + 0.002 * number), 0.01, fs.Circular(0.003)) for number in range(count)]
    forms = {f"notch {number}": HingeForm(notch, steel, Roots(first=True, second=True)) for number, notch in enumerate(notches)}
    yield
    solid_hinges(ways=Ways(cache=None))(forms)
    yield


OF: dict[str, Callable[[int], Iterator[None]]] = {
    "bodies": bodies,
    "trees": trees,
    "designs": designs,
    "samples": samples,
    "hinges": hinges,
}


def spent() -> float:
    """Seconds of the processor so far, of this process and of those that it has ended."""
    return sum(os.times()[:4])


def measure(what: str, count: int) -> None:
    """Seconds of every step, those that went by in all, and memory of the largest process, in one line; what is refused, and why."""
    from flexstage.base.finding import DesignError

    start, times, refused = time.monotonic(), [spent()], ""
    try:
        for _ in OF[what](count):
            times.append(spent())  # noqa: PERF401 (those before what is refused count)
    except DesignError as error:
        refused = f"  {STEPS[what][len(times) - 1]} is refused: {error}"
    steps = [f"{after - before:10.2f}" for before, after in itertools.pairwise(times)] + ["         -"] * (
        1 + len(STEPS[what]) - len(times)
    )
    elapsed = time.monotonic() - start
    memory = max(resource.getrusage(each).ru_maxrss for each in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)) / 1e3
    print(f"{count:12,}{''.join(steps)}{times[-1] - times[0]:10.2f}{elapsed:12.2f}{memory:10.0f}{refused}", flush=True)


def draw(curves: dict[str, list[tuple[float, float, float]]], file: str) -> None:
    """Seconds and megabytes over size, both logarithmic, as SVG."""
    from matplotlib.ticker import LogLocator

    from flexstage.show.figures.export import to_svg
    from flexstage.show.figures.style import canvas, style_context

    with style_context():
        figure = canvas(9.0, 3.6)
        for place, (axis, title) in enumerate(zip(figure.subplots(1, 2), ("processor time [s]", "memory [MB]"), strict=True), start=1):
            for what, rows in curves.items():
                axis.loglog([row[0] for row in rows], [row[place] for row in rows], marker="o", markersize=3, label=what)
            axis.set(xlabel="how many", title=title)
            for each in (axis.xaxis, axis.yaxis):
                each.set_major_formatter("{x:g}")
                each.set_minor_formatter("")
            if place == 2:
                axis.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))  # little more than a decade
        figure.legend(*axis.get_legend_handles_labels(), loc="outside right upper")
    svg = to_svg(figure, "growth", "processor time and memory over the number of bodies, designs, samples and hinges")
    Path(file).write_text(re.sub(r"var\([^,]*, *([^)]*)\)", r"\1", svg).replace("<svg ", '<svg xmlns="http://www.w3.org/2000/svg" ', 1))


def read_printed(lines: Iterable[str]) -> dict[str, list[tuple[float, float, float]]]:
    """Size, seconds and megabytes of every line that was printed, by what it is about."""
    curves: dict[str, list[tuple[float, float, float]]] = {}
    what = ""
    for words in (line.split() for line in lines):
        if words and words[0] in SIZES:
            what = words[0]
        elif words:
            seconds, _, memory = words[1 + len(STEPS[what]) :][:3]
            curves.setdefault(what, []).append((float(words[0].replace(",", "")), float(seconds), float(memory)))
    return curves


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("words", nargs="*", help="bodies, trees, designs, samples or hinges; sizes")
    parser.add_argument("--printed")
    parser.add_argument("--figure")
    asked = parser.parse_args()
    kinds = [word for word in asked.words if word in SIZES]
    sizes = [int(float(word)) for word in asked.words if word not in SIZES]
    printed = Path(asked.printed).read_text().splitlines() if asked.printed else []
    for what in kinds or ([] if asked.printed else ["bodies"] if sizes else SIZES):
        printed += [f"{what:>12}" + "".join(f"{each:>10}" for each in STEPS[what]) + f"{'sum [s]':>10}{'elapsed [s]':>12}{'[MB]':>10}"]
        print(printed[-1], flush=True)
        for count in sizes or SIZES[what]:
            line = subprocess.run([sys.executable, __file__, "--one", what, str(count)], check=True, capture_output=True, text=True).stdout
            printed += [line]
            print(line, end="", flush=True)
    if asked.figure:
        draw(read_printed(printed), asked.figure)


if __name__ == "__main__":
    if sys.argv[1:2] == ["--one"]:
        measure(sys.argv[2], int(sys.argv[3]))
    else:
        main()
