"""Kernels are built at installation, once for each width of vectors, and loaded only where they are of the sources that are there."""

from __future__ import annotations

import platform
import shutil
from pathlib import Path

import pytest

import hatch_build
from flexstage.base.finding import DesignError
from flexstage.base.processes import native
from flexstage.base.processes.native import (
    HEADERS,
    KERNELS,
    kernel_lanes,
    kernel_library,
    library_path,
    library_sources,
    machine_lanes,
    processor_lanes,
    sources_digest,
)

needs_compiler = pytest.mark.skipif(hatch_build.find_compiler() is None, reason="no compiler of C")


@needs_compiler
@pytest.mark.parametrize("source", KERNELS, ids=lambda source: source.parent.name)
def test_where_there_is_a_compiler_kernels_load_for_every_width_of_this_processor(source: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for lanes in processor_lanes():
        monkeypatch.setenv("FLEXSTAGE_KERNEL", lanes.name)
        library = kernel_library(source)
        assert library is not None, f"{library_path(source, lanes)}: make setup-dev"
        assert library_sources(library) == sources_digest(source)


def example(folder: Path, number: int = 42) -> Path:
    source = folder / "kernel.c"
    source.write_text(f'#include "lanes.h"\nint number(void);\nint number(void) {{ return {number}; }}\n')
    return source


@needs_compiler
def test_a_kernel_is_built_once_and_again_when_its_sources_change(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    compiler, lanes = hatch_build.find_compiler(), machine_lanes()[-1]
    monkeypatch.setenv("FLEXSTAGE_KERNEL", lanes.name)
    assert compiler is not None
    path = hatch_build.build(compiler, example(tmp_path), lanes)
    assert path is not None
    made = path.stat().st_mtime_ns
    assert hatch_build.build(compiler, example(tmp_path), lanes) == path
    assert path.stat().st_mtime_ns == made
    found = kernel_library(example(tmp_path))
    assert found is not None
    assert found.number() == 42
    assert kernel_library(example(tmp_path, 43)) is None  # what is there is of other sources
    hatch_build.build(compiler, example(tmp_path, 43), lanes)
    assert path.stat().st_mtime_ns != made
    assert [each.name for each in tmp_path.iterdir() if each.suffix == ".part"] == []


@needs_compiler
def test_what_the_compiler_refuses_is_left_out(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    source = tmp_path / "kernel.c"
    source.write_text("int number(void) {")
    assert hatch_build.build(hatch_build.find_compiler() or (), source, machine_lanes()[-1]) is None
    assert "error" in capsys.readouterr().err
    assert kernel_library(source) is None


def test_without_a_compiler_nothing_is_built(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    source, stale = example(tmp_path), tmp_path / "kernel-sse2.so"
    stale.write_bytes(b"no library at all")
    monkeypatch.setenv("CC", "no-such-compiler")
    monkeypatch.setattr(hatch_build, "KERNELS", (source,))
    assert hatch_build.build_kernels() == []
    assert not stale.exists()


def test_what_is_no_library_is_not_loaded(tmp_path: Path) -> None:
    library_path(example(tmp_path), kernel_lanes()).write_bytes(b"no library at all")
    assert kernel_library(tmp_path / "kernel.c") is None


def test_off_does_without(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("FLEXSTAGE_KERNEL", "off")
    assert [kernel_library(source) for source in KERNELS] == [None, None]


def test_the_digest_covers_headers(tmp_path: Path) -> None:
    before = sources_digest(example(tmp_path))
    shutil.copy(HEADERS / "lanes.h", tmp_path / "own.h")
    assert sources_digest(example(tmp_path)) != before


AVX512 = frozenset(["avx512f", "avx512dq", "avx512vl", "avx2", "fma", "sse2"])


@pytest.mark.parametrize(
    ("machine", "features", "found"),
    [
        ("x86_64", AVX512, ["avx512", "avx2", "sse2"]),
        ("x86_64", AVX512 - {"avx512dq"}, ["avx2", "sse2"]),
        ("x86_64", frozenset(), ["sse2"]),
        ("aarch64", frozenset({"asimd"}), ["neon"]),
        ("arm64", frozenset(), ["neon"]),
        ("riscv64", frozenset(), ["plain"]),
    ],
)
def test_lanes_are_asked_of_the_processor(
    machine: str, features: frozenset[str], found: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("FLEXSTAGE_KERNEL", raising=False)
    monkeypatch.setattr(platform, "machine", lambda: machine)
    monkeypatch.setattr(native, "_features", lambda: features)
    assert [each.name for each in processor_lanes()] == found
    assert kernel_lanes().name == found[0]
    for name in found:
        monkeypatch.setenv("FLEXSTAGE_KERNEL", name)
        assert kernel_lanes().name == name


def test_lanes_that_the_processor_has_not_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(platform, "machine", lambda: "x86_64")
    monkeypatch.setattr(native, "_features", lambda: AVX512 - {"avx512vl"})
    monkeypatch.setenv("FLEXSTAGE_KERNEL", "avx512")
    with pytest.raises(DesignError, match=r"FLEXSTAGE_KERNEL: unsupported value \(got avx512, expected avx2, sse2 or off\)"):
        kernel_lanes()
