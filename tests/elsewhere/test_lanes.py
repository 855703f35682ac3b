"""The kernel of many designs for other processors than this one: narrower vectors, and NEON on an emulated processor where there is one."""

from __future__ import annotations

import ctypes
import re
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

import hatch_build
from flexstage.base.processes.native import HEADERS, KERNELS, Lanes, library_path, processor_lanes
from flexstage.cases.double_triangle import double_triangle
from flexstage.models.batch.engine import plan
from flexstage.models.batch.family import numbers_of
from flexstage.models.batch.kernel import Job, kernel, kernel_job, solve_designs

HERE, KERNEL = Path(__file__).parent, KERNELS[0]
NAMES = ("parts.neck.thickness", "B2/front.thickness", "placements.B1-B3.pattern.radius", "materials.steel.density")
FLAGS = (*hatch_build.FLAGS[:3], "-Wall", "-Wextra", "-Werror", f"-I{HEADERS}")
PACKED = {"avx512": r"vfn?m(?:add|sub)\d+pd .*%[xz]mm", "avx2": r"vfn?m(?:add|sub)\d+pd .*%[xy]mm", "sse2": r"\bmulpd"}
ARM, EMULATOR, ROOT = "aarch64-linux-gnu-gcc", "qemu-aarch64", "/usr/aarch64-linux-gnu"


def drawn(width: int) -> tuple[np.ndarray, Job]:
    """Eleven designs (no whole number of vectors) as the kernel of this processor solves them, and as a task for so many lanes."""
    family, library = plan(double_triangle(), NAMES), kernel()
    assert library is not None
    values = family.family.nominal * (1.0 + np.random.default_rng(3).uniform(-0.05, 0.05, (11, len(NAMES))))
    task = (family.tables, numbers_of(family.family, values), family.starts[0], family.choice)
    return solve_designs(library, *task)[0], kernel_job(width, *task)


def agree(found: Job, known: np.ndarray) -> None:
    """To rounding of the results, which are proved to 1e-6."""
    assert (found.results["good"][:11] == 1).all()
    np.testing.assert_allclose(found.results["values"][:, :11].T, known, rtol=1e-12)


@pytest.mark.full
@pytest.mark.skipif("kernel() is None", reason="no kernel")
@pytest.mark.parametrize("lanes", processor_lanes(), ids=lambda lanes: lanes.name)
def test_all_lanes_give_what_the_widest_give(lanes: Lanes) -> None:
    made = library_path(KERNEL, lanes)
    library = ctypes.CDLL(str(made))
    library.flexstage_width.restype = library.flexstage_modes.restype = ctypes.c_int64
    width = library.flexstage_width()
    assert width == {"avx512": 8, "avx2": 4, "sse2": 2}[lanes.name]
    known, job = drawn(width)
    assert library.flexstage_modes(ctypes.byref(job.task)) == 0
    agree(job, known)
    if shutil.which("objdump"):
        code = subprocess.run(["objdump", "-d", "--no-show-raw-insn", str(made)], check=True, capture_output=True, text=True).stdout
        packed, single = (len(re.findall(PACKED[lanes.name].replace("pd", each), code)) for each in ("pd", "sd"))
        assert packed > 2000  # whole vectors of designs an instruction, not one
        assert packed > 50 * single


@pytest.mark.full
@pytest.mark.skipif("kernel() is None or not all(map(shutil.which, (ARM, EMULATOR)))", reason=f"no {ARM} or no {EMULATOR} here: not run")
def test_neon_gives_what_this_processor_gives(tmp_path: Path) -> None:
    driver, task, results = tmp_path / "driver", tmp_path / "task", tmp_path / "results"
    subprocess.run([ARM, *FLAGS, "-static", "-o", str(driver), str(HERE / "lanes_driver.c"), str(KERNEL), "-lm"], check=True)
    known, job = drawn(2)
    task.write_bytes(written(job))
    ran = subprocess.run([EMULATOR, str(driver), str(task), str(results)], check=True, capture_output=True, text=True)
    assert ran.stdout.strip() == "2"
    start, content = 0, results.read_bytes()
    for array in job.results.values():
        array[:] = np.frombuffer(content, array.dtype, array.size, start).reshape(array.shape)
        start += array.nbytes
    agree(job, known)
    code = subprocess.run([ARM.replace("gcc", "objdump"), "-d", str(driver)], check=True, capture_output=True, text=True).stdout
    assert code.count("fmla\tv") + code.count("fmls\tv") > 400  # two designs an instruction, not one


def written(job: Job) -> bytes:
    """A task and its arrays as the driver reads them."""
    content = bytes(job.task)
    parts = [len(content).to_bytes(8, "little"), content]
    for name, array in {**job.arrays, **job.results}.items():
        bytes_of = array if array.flags.c_contiguous else padded(array)
        place = getattr(type(job.task), name).offset
        parts += [each.to_bytes(8, "little") for each in (place, bytes_of.nbytes, int(name in job.results))]
        parts.append(bytes_of.tobytes())
    return b"".join(parts)


def padded(rows: np.ndarray) -> np.ndarray:
    """Rows that stand apart, with what is between them."""
    whole = np.zeros((rows.shape[0], rows.strides[0] // rows.itemsize))
    whole[:, : rows.shape[1]] = rows
    return whole
