"""What a fuzzer feeds to readers, by kind: sound examples, how they are altered and read. An input follows from seed and number alone."""

from __future__ import annotations

import ctypes
import functools
import io
import json
import random
import tempfile
import tomllib
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from datetime import date, datetime, time
from itertools import islice
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import scipy.io

from flexstage.base.finding import DesignError
from flexstage.cases.registry import CASES
from flexstage.control.study.file import example, loads_setup
from flexstage.experiment.formats.read import read
from flexstage.experiment.records.options import Arrays, FaultTolerance, Kind, Options
from flexstage.experiment.records.record import Channel, Record, Role, in_memory
from flexstage.mechanism.assembly.expand import expand
from flexstage.mechanism.store import dumps, loads, round_to_digits
from flexstage.studies.optimisation.file import load_optimisation
from flexstage.studies.sweeps.example import neck_study
from flexstage.studies.sweeps.execution.store import gather, read_results
from flexstage.studies.sweeps.file import loads_study
from flexstage.studies.tolerances.file import loads_tolerance
from tests.roundtrip.designs import TEXT
from tests.roundtrip.mutation import altered, mutated, noise, reshaped
from tests.roundtrip.records import awkward_record, awkward_responses, write_version_73
from tests.roundtrip.records import write_form as write

GUIDE = """format = "flexstage 1"
name = "guide"
[parts.leaf]
kind = "leaf"
material = "steel"
length = "60 mm"
width = "20 mm"
thickness = "0.3 mm"
[parts.push]
kind = "restricted"
elastic = ["x"]
part = { kind = "piezo", stroke = "10 um", stiffness = "100 N/um", length = "10 mm", diameter = "5 mm" }
[materials.steel]
young = "200 GPa"
poisson = 0.3
density = "7800 kg/m^3"
[bodies.platform]
mass = "2.5 kg"
centre = ["0 mm", "0 mm", "10 mm"]
inertia = { xx = "1 g m^2", yy = "2 g m^2", zz = "3 g m^2" }
[links]
left = { joins = ["ground", "platform"], part = "leaf", at = ["-30 mm", "0 mm", "0 mm"], along = "z", bends = "y" }
right = { joins = ["ground", "platform"], part = "leaf", at = ["30 mm", "0 mm", "0 mm"], along = "z", bends = "y" }
push = { joins = ["ground", "platform"], part = "push", at = ["0 mm", "0 mm", "10 mm"], along = "x" }
"""
STUDY = """format = "flexstage study 1"
name = "leaves"
case = "parallelogram"
responses = { m = "mass", f = "frequency.platform.1", guide = "stiffness.x", loss = "loss.B" }
limits = { mass = "at most 14 kg", "stroke.x" = "at least 1 um at corner" }
"""
SWEEP = """sweep = { sampling = "latin hypercube", designs = 700, seed = 3 }
[variables]
young = { address = "materials.aluminium.young", from = "-10 %", to = "10 %" }
leaf = { address = ["parts.leaf.length", "parts.leaf.width"], from = "40 mm", to = "0.06 m", levels = 3 }
"""
OPTIMISE = SWEEP.partition("\n")[2] + '[optimise]\nmaximise = "f"\nstarts = 2\nseed = 1\n'
TOLERANCE = """tolerance = { copies = 64, requirements = false, crosstalk = false, yield = "90 %" }
[scatter]
wire = { address = "parts.leaf.thickness", normal = "5 um" }
wear = { address = "links.left.thickness", uniform = "5 um" }
"""
_ALL = frozenset(FaultTolerance)
SETUP = """format = "flexstage loop 1"
model = "lumped"
rate = "10 kHz"
delay = "100 us"
modes = 20
seconds = "0.5 s"
compensate = ["lost-motion", "load"]
amplifier = { resistance = "50 ohm", current = "0.2 A", slew = "100 V/ms", noise = "2 uV/Hz^0.5", bits = 18 }
gauges = { noise = "0.05 nm/Hz^0.5", resolution = "0.1 nm", bandwidth = "5 kHz", filter_order = 2, filter_corner = "4 kHz" }
hysteresis = { width = "15 %", plant = "bouc-wen", creep = "2 %" }
[floor]
x = { criterion = "VC-D" }
y = { acceleration = ["3 um/s^2/Hz^0.5"] }
z = { frequencies = ["1 Hz", "10 Hz", "100 Hz"], velocity = ["1 um/s/Hz^0.5", "0.5 um/s/Hz^0.5", "0.1 um/s/Hz^0.5"] }
[controller]
kind = "pid"
coordinates = "modal"
bandwidth = "30 Hz"
sensitivity = 2
notches = [{ frequency = "106 Hz", depth = 0.1, damping = 0.5 }]
[trajectory]
"""
TRAJECTORIES = (
    'kind = "step"\namplitude = { x = "1 um", rz = "10 urad" }\nspeed = "1 mm/s"\nacceleration = "0.2 m/s^2"\njerk = "100 m/s^3"\n',
    'kind = "raster"\nlength = "20 um"\npitch = "2 um"\nlines = 8\nspeed = "0.2 mm/s"\nacceleration = "1 m/s^2"\nfast = "y"\nslow = "x"\n',
    'kind = "spiral"\nradius = "4 um"\npitch = "0.5 um"\nspeed = "0.2 mm/s"\nfirst = "z"\nsecond = "x"\n',
    'kind = "sine"\nfrequency = "10 Hz"\nperiods = 4\namplitude = { x = "1 um" }\n',
    'kind = "file"\nfile = "path.csv"\n',
)
WAYS = (
    Options(),
    Options(accept_faults=_ALL, rate=50.0),
    Options(kind=Kind.RESPONSES, accept_faults=_ALL),
    Options(rate=50.0, arrays=Arrays(samples=("*[uy]",))),
)
"""How every record is read: as it is, with everything allowed, as a record and as responses, with arrays that are named."""
_MOST = 50
"""Blocks that are read of one, however long a damaged file says that it is."""
_RATE, _LENGTH = 100.0, 60


@dataclass(frozen=True)
class Fuzzed:
    """A kind of input: `made` from chance, `tried` as it is read; the ending of its file, "" for text that is read as such."""

    made: Callable[[random.Random], bytes]
    tried: Callable[[Any], None]
    ending: str = ""


def one_input(kind: str, seed: int, number: int) -> bytes:
    """An input of a kind, the same whenever it is asked for."""
    return KINDS[kind].made(random.Random(f"{kind} {seed} {number}"))  # noqa: S311 (nothing secret)


def tried(kind: str, content: bytes, folder: Path) -> None:
    """Read an input; whatever is wrong with it must end in a `DesignError`."""
    known = KINDS[kind]
    if not known.ending:
        known.tried(content.decode("utf-8", "replace"))
        return
    path = folder / f"input{known.ending}"
    path.write_bytes(content)
    known.tried(path)


# --- texts in TOML ---


def toml(value: Any) -> str:
    """A tree as a TOML text: tables in one line, below the first."""
    if isinstance(value, dict):
        return "".join(f"{json.dumps(str(key))} = {inline(each)}\n" for key, each in value.items())
    return inline(value)


def inline(value: Any) -> str:
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{json.dumps(str(key))} = {inline(each)}" for key, each in value.items()) + " }"
    if isinstance(value, list):
        return "[" + ", ".join(map(inline, value)) + "]"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return json.dumps(value)
    return value.isoformat() if isinstance(value, (date, datetime, time)) else str(value)


def altered_text(texts: Iterable[str], chance: random.Random) -> bytes:
    """A text altered by characters, lines and words, or as a tree; or noise."""
    draw = chance.random()
    if draw < 0.02:
        return noise(chance)
    text = chance.choice(tuple(texts))
    if draw < 0.5:
        return mutated(text, chance).encode("utf-8", "surrogatepass")
    return toml(reshaped(tree_of(text), chance)).encode("utf-8", "surrogatepass")


@functools.cache
def parsed(text: str) -> str:
    return json.dumps(tomllib.loads(text), default=str)


def tree_of(text: str) -> Any:
    return json.loads(parsed(text))


@functools.cache
def shipped() -> tuple[str, ...]:
    return tuple(dumps(round_to_digits(case.build())) for case in CASES.values())


def a_design(chance: random.Random) -> bytes:
    return altered_text(shipped() if chance.random() < 0.03 else (TEXT, GUIDE), chance)


def try_design(text: str) -> None:
    expand(loads(text))


def a_study(chance: random.Random) -> bytes:
    return altered_text([STUDY + chance.choice((SWEEP, OPTIMISE, TOLERANCE))], chance)


def try_study(text: str) -> None:
    if "scatter" in text:
        loads_tolerance(text)
    else:
        study = loads_study(text)
        if "optimise" in text:
            load_optimisation(study)


def a_setup(chance: random.Random) -> bytes:
    return altered_text(setups(), chance)


@functools.cache
def setups() -> tuple[str, ...]:
    """The example as it is shipped, and with most that is commented out there written in, one trajectory each."""
    return (example(), *(SETUP + trajectory for trajectory in TRAJECTORIES))


# --- records ---


def bytes_of(name: str, what: Any, form: str) -> bytes:
    with tempfile.TemporaryDirectory() as folder:
        write(Path(folder) / name, what, form)
        return (Path(folder) / name).read_bytes()


@functools.cache
def plain_record() -> Record:
    draw = np.random.default_rng(3)
    channels = (Channel("u1", "V", Role.INPUT), Channel("S1", "um", Role.OUTPUT), Channel("S2", "um", Role.OUTPUT))
    return in_memory(channels, _RATE, np.round(draw.standard_normal((_LENGTH, 3)), 4))


@functools.cache
def tables() -> tuple[bytes, ...]:
    lines = [f"{row / _RATE:.2f};{a:.4f};{b:.4f}" for row, (a, b, _) in enumerate(plain_record().values)]
    german = "\n".join(["Messung", "time;u1;S1", "s;V;um", *(line.replace(".", ",") for line in lines)])
    blanks = "\n".join(["% 100 Hz", "% u1 S1", *(line.partition(";")[2].replace(";", " ") for line in lines)])
    written = (bytes_of("a.csv", each, "csv") for each in (plain_record(), awkward_record(length=_LENGTH), awkward_responses()))
    return (german.encode(), blanks.encode(), *written)


@functools.cache
def universal() -> tuple[bytes, ...]:
    whole = (plain_record(), awkward_record(length=_LENGTH), awkward_responses(), awkward_responses(coherence=False))
    return tuple(bytes_of("a.uff", each, form) for each in whole for form in ("uff", "uff-ascii"))


@functools.cache
def hierarchical() -> tuple[bytes, ...]:
    """The same small file with every superblock there is."""
    found = [hdf_of(version) for version in ("earliest", "v108", "v110")]
    return (*found, *([] if (one := superblock_one()) is None else [one]), bytes_of("a.h5", plain_record(), "hdf5"))


def fill(file: h5py.File) -> None:
    file["test/u"], file["test/y"] = np.arange(50.0), np.arange(50.0)
    file.create_dataset("test/z", data=np.arange(500.0), chunks=(100,), compression="gzip", shuffle=True)
    file["test"].attrs["fs"], file["test/y"].attrs["unit"] = 50.0, "um"
    file["names"] = ["a", "bc"]
    file["table"] = np.zeros(50, dtype=[("t", "f8"), ("gap", "f4")])


def hdf_of(version: str) -> bytes:
    with tempfile.TemporaryDirectory() as folder:
        with h5py.File(Path(folder) / "a.h5", "w", libver=(version, "latest")) as file:
            fill(file)
        return (Path(folder) / "a.h5").read_bytes()


def superblock_one() -> bytes | None:
    """A file of version 1, which h5py makes only through its library; None where that cannot be found."""
    libraries = sorted((Path(h5py.__file__).parents[1] / "h5py.libs").glob("libhdf5-*"))
    if not libraries:
        return None
    make, access = h5py.h5p.create(h5py.h5p.FILE_CREATE), h5py.h5p.create(h5py.h5p.FILE_ACCESS)
    access.set_libver_bounds(h5py.h5f.LIBVER_EARLIEST, h5py.h5f.LIBVER_LATEST)
    ctypes.CDLL(str(libraries[0])).H5Pset_istore_k(ctypes.c_int64(make.id), ctypes.c_uint(64))
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "a.h5"
        with h5py.File(h5py.h5f.create(bytes(path), h5py.h5f.ACC_TRUNC, make, access)) as file:
            fill(file)
        return path.read_bytes()


@functools.cache
def matrices() -> tuple[bytes, ...]:
    cell = np.empty(3, dtype=object)
    cell[:] = ["V", "um", "um"]
    values = {"fs": 50.0, "u": np.arange(50.0), "y": np.ones((50, 2)), "test": {"fs": 50.0, "h": np.ones(5, complex)}, "units": cell}
    found: list[bytes] = []
    for form, pressed in (("5", False), ("5", True), ("4", False)):
        stream = io.BytesIO()
        only = {name: value for name, value in values.items() if form == "5" or name in ("fs", "u", "y")}
        scipy.io.savemat(stream, only, format=form, do_compression=pressed)
        found.append(stream.getvalue())
    return (*found, *(bytes_of("a.mat", each, "mat") for each in (plain_record(), awkward_responses())), version_73())


def version_73() -> bytes:
    with tempfile.TemporaryDirectory() as folder:
        values = {"samples": plain_record().values, "rate": _RATE, "names": ("u1", "S1", "S2"), "test": {"h": np.ones((5, 1), complex)}}
        return write_version_73(Path(folder) / "a.mat", values).read_bytes()


def try_any_record(path: Path) -> None:
    """In all ways, to the last sample; the first refusal is the input's, unless another way reads it."""
    refusals: list[DesignError] = []
    for options in WAYS:
        try:
            found = read(path, options)
            if isinstance(found, Record):
                for _ in islice(found.blocks(4096), _MOST):
                    pass
        except DesignError as error:
            refusals.append(error)
            if "it is damaged" in str(error):  # a library that crashed or hung: the other ways would, too
                break
    if len(refusals) == len(WAYS) or "it is damaged" in str(refusals[-1:]):
        raise refusals[0]


@functools.cache
def results() -> tuple[bytes, ...]:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "a.h5"
        gather(path, neck_study(), 256)
        return (path.read_bytes(),)


def damaged(sources: Callable[[], tuple[bytes, ...]]) -> Callable[[random.Random], bytes]:
    """Bytes of one of these files, altered."""

    def made(chance: random.Random) -> bytes:
        return altered(chance.choice(sources()), chance)

    return made


KINDS: dict[str, Fuzzed] = {
    "designs": Fuzzed(a_design, try_design),
    "studies": Fuzzed(a_study, try_study),
    "setups": Fuzzed(a_setup, lambda text: (loads_setup(text), None)[1]),
    "results": Fuzzed(damaged(results), lambda path: (read_results(path), None)[1], ".h5"),
    "tables": Fuzzed(damaged(tables), try_any_record, ".csv"),
    "universal": Fuzzed(damaged(universal), try_any_record, ".uff"),
    "hdf5": Fuzzed(damaged(hierarchical), try_any_record, ".h5"),
    "mat": Fuzzed(damaged(matrices), try_any_record, ".mat"),
}


def sound(kind: str) -> tuple[bytes, ...]:
    """What inputs of a kind are made from."""
    texts = {"designs": (TEXT, GUIDE), "studies": tuple(STUDY + each for each in (SWEEP, OPTIMISE, TOLERANCE)), "setups": setups()}
    sources = {"results": results, "tables": tables, "universal": universal, "hdf5": hierarchical, "mat": matrices}
    return tuple(map(str.encode, texts[kind])) if kind in texts else sources[kind]()
