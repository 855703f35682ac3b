"""Native code is loaded only from where its user alone can write, only whole, and built anew where it is not."""

from __future__ import annotations

import hashlib
import os
import platform
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

from flexstage.base.finding import DesignError
from flexstage.base.processes import native
from flexstage.base.processes.jobs import environment
from flexstage.base.processes.native import Recipe, compile_source, compiler, folder_defect, kernel_lanes, kernel_recipe, key, load_library

pytestmark = pytest.mark.skipif(compiler() is None, reason="no compiler of C")
owners = pytest.mark.skipif(not hasattr(os, "geteuid"), reason="files have no owners here")
FLAGS = ("-fPIC", "-shared")


def recipe(number: int = 42) -> Recipe:
    return Recipe("an example", {"one.c": f"int number(void); int number(void) {{ return {number}; }}"}, FLAGS)


def ask(number: int = 42) -> int:
    return load_library(recipe(number), lambda library: library.number() == number).number()


@pytest.fixture
def cache(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Path:
    monkeypatch.setenv("FLEXSTAGE_CACHE", str(tmp_path / "cache"))
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "temporary"))
    (tmp_path / "temporary").mkdir()
    return tmp_path / "cache" / "native"


def libraries(cache: Path) -> list[Path]:
    return sorted(cache.glob("*.so"))


class Count:
    """How often the compiler was called to build."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.built, run = 0, subprocess.run

        def counted(command, *rest, **named):
            self.built += "-o" in command
            return run(command, *rest, **named)

        monkeypatch.setattr("flexstage.base.processes.native.subprocess.run", counted)


def test_it_is_built_once_and_kept_for_its_user_alone(cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    count = Count(monkeypatch)
    assert [ask(), ask(), ask(43)] == [42, 42, 43]
    assert count.built == len(libraries(cache)) == 2
    assert {path.name for path in cache.iterdir()} == {"lock", *(path.name for path in libraries(cache))}
    if hasattr(os, "geteuid"):
        assert {path.stat().st_mode & 0o077 for path in (cache, *cache.iterdir())} == {0}


APART = Path(__file__).parents[2]
ASKED = [sys.executable, "-c", "from tests.roundtrip.test_native import ask; print(ask())"]
SPOILED = {"emptied": slice(0), "cut off": slice(4000), "without its last byte": slice(-1), "without its first": slice(1, None)}


def ask_apart() -> int:
    """In a process of its own: within one, a library that was loaded is not loaded again under the same name."""
    done = subprocess.run(ASKED, capture_output=True, text=True, check=True, env=environment(), cwd=APART)
    return int(done.stdout)


def put(path: Path, content: bytes) -> None:
    """Not into the same file: it is mapped by this process."""
    path.unlink(missing_ok=True)
    path.write_bytes(content)
    path.chmod(0o700)


@pytest.mark.parametrize("kind", SPOILED)
def test_what_was_altered_is_built_anew(cache: Path, kind: str) -> None:
    assert ask() == 42
    (path,) = libraries(cache)
    whole = path.read_bytes()
    put(path, whole[SPOILED[kind]])
    assert ask_apart() == 42
    assert libraries(cache) == [path]
    assert path.read_bytes() == whole


def test_another_library_under_its_name_is_not_loaded(cache: Path) -> None:
    assert ask() == 42
    (path,) = libraries(cache)
    whole = path.read_bytes()
    put(path, compile_source(recipe(666)))
    assert ask_apart() == 42
    assert path.read_bytes() == whole


def test_a_whole_one_that_does_not_load_is_built_anew_once(cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert ask() == 42
    (path,) = libraries(cache)
    path.unlink()
    garbage = b"no library at all"
    put(path.with_name(f"{path.stem.rpartition('-')[0]}-{hashlib.sha256(garbage).hexdigest()[:32]}.so"), garbage)
    count = Count(monkeypatch)
    assert ask() == 42
    assert count.built == 1
    assert libraries(cache) == [path]


@owners
@pytest.mark.parametrize("mode", [0o770, 0o707, 0o720, 0o1777])
def test_a_folder_that_others_may_write_to_is_not_used(cache: Path, mode: int) -> None:
    ask(7)
    cache.chmod(mode)
    before = libraries(cache)
    assert "others may write" in folder_defect(cache)
    assert ask(8) == 8
    assert libraries(cache) == before
    cache.chmod(0o700)
    cache.parent.chmod(mode & 0o777)
    assert "others may write" in folder_defect(cache)
    assert not list(Path(tempfile.gettempdir()).iterdir())


@owners
def test_a_folder_of_somebody_else_is_not_used(cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    ask(9)
    before = libraries(cache)
    other = os.geteuid() + 4321
    with monkeypatch.context() as patch:
        patch.setattr(os, "geteuid", lambda: other)
        assert "belongs to user" in folder_defect(cache)
        assert ask(10) == 10
    assert libraries(cache) == before


@owners
@pytest.mark.parametrize("spoil", [lambda path: path.chmod(0o722), lambda path: path.replace(path.with_name("a")) and path.symlink_to("a")])
def test_a_file_that_others_may_write_to_is_not_loaded(cache: Path, monkeypatch: pytest.MonkeyPatch, spoil) -> None:
    ask(11)
    spoil(libraries(cache)[0])
    count = Count(monkeypatch)
    assert ask(11) == 11
    assert count.built == 1
    assert not libraries(cache)[0].is_symlink()
    assert libraries(cache)[0].stat().st_mode & 0o077 == 0


def test_where_nothing_can_be_kept_it_is_built_each_time(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("FLEXSTAGE_CACHE", str(tmp_path / "file" / "cache"))
    assert "cannot be made" in folder_defect(tmp_path / "file" / "cache")
    assert ask(12) == 12
    assert [path.name for path in tmp_path.iterdir()] == ["file"]


def test_what_never_works_is_refused_and_leaves_nothing(cache: Path, tmp_path: Path) -> None:
    with pytest.raises(DesignError, match=r"what .* makes of an example does not work"):
        load_library(recipe(), lambda library: library.number() == 43)
    with pytest.raises(DesignError, match=r"does not work .*undefined symbol"):
        load_library(recipe(), lambda library: library.no_such_function() == 42)
    with pytest.raises(DesignError, match=r"(?s)refuses an example.*error"):
        load_library(Recipe("an example", {"one.c": "int number(void) {"}, FLAGS), lambda _: True)
    assert not list((tmp_path / "temporary").iterdir())
    assert not list(cache.glob(".building-*"))


def test_what_killed_builders_left_is_removed(cache: Path) -> None:
    ask(13)
    (cache / ".building-dead").mkdir()
    (cache / ".building-dead" / "one.c").write_text("")
    ask(14)
    assert not list(cache.glob(".building-*"))


def test_builders_at_once_build_one(cache: Path) -> None:
    several = [subprocess.Popen(ASKED, stdout=subprocess.PIPE, text=True, env=environment(), cwd=APART) for _ in range(3)]
    assert [each.communicate(timeout=120)[0].split() for each in several] == [["42"]] * 3
    assert len(libraries(cache)) == 1
    assert not list(cache.glob(".building-*"))


AVX512 = frozenset(["avx512f", "avx512dq", "avx512vl", "avx2", "fma", "sse2"])


@pytest.mark.parametrize(
    ("machine", "features", "found"),
    [
        ("x86_64", AVX512, ["avx512", "avx2", "sse2"]),
        ("x86_64", AVX512 - {"avx512dq"}, ["avx2", "sse2"]),
        ("x86_64", frozenset(), ["sse2"]),
        ("aarch64", frozenset({"asimd"}), ["neon"]),
        ("arm64", frozenset(), ["neon"]),
        ("riscv64", frozenset(), []),
    ],
)
def test_lanes_are_asked_of_the_processor(
    machine: str, features: frozenset[str], found: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("FLEXSTAGE_KERNEL", raising=False)
    monkeypatch.setattr(platform, "machine", lambda: machine)
    monkeypatch.setattr(native, "_features", lambda: features)
    assert [each.name for each in native.processor_lanes()] == found
    assert kernel_lanes().name == (found[0] if found else "plain")
    for name in found:
        monkeypatch.setenv("FLEXSTAGE_KERNEL", name)
        assert kernel_lanes().name == name


def test_lanes_that_the_processor_has_not_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(platform, "machine", lambda: "x86_64")
    monkeypatch.setattr(native, "_features", lambda: AVX512 - {"avx512vl"})
    monkeypatch.setenv("FLEXSTAGE_KERNEL", "avx512")
    with pytest.raises(DesignError, match="FLEXSTAGE_KERNEL: it is avx512, and kernels run here with avx2, sse2, or are off"):
        kernel_lanes()


def test_a_kept_kernel_is_of_its_lanes_and_of_no_one_processor(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    found, source = compiler(), tmp_path / "one.c"
    assert found is not None
    source.write_text("int one(void);")
    monkeypatch.setattr(platform, "machine", lambda: "x86_64")

    def named(features: frozenset[str]) -> str:
        monkeypatch.setattr(native, "_features", lambda: features)
        return key(kernel_recipe("one", source), found)

    assert named(AVX512) == named(AVX512 | {"amx_tile"})
    assert named(AVX512) != named(AVX512 - {"avx512f"})
