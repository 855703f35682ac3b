"""File paths of imported solids and parts: absolute in a description; in a design file, relative for files within its folder."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from flexstage.mechanism.mechanism import Mechanism
from flexstage.mechanism.references import FILES, renamed
from flexstage.mechanism.store.encode import tree_of
from flexstage.mechanism.store.tidy import round_to_digits
from flexstage.mechanism.store.toml import text_of
from flexstage.parts.body import Body, Imported
from flexstage.parts.shape import Elastic


def anchor_paths(mechanism: Mechanism, folder: Path) -> Mechanism:
    """Return the description with absolute paths of imported solids and of parts; relative paths are relative to `folder`.

    >>> anchor_paths(Mechanism("a"), Path()) == Mechanism("a")
    True
    """
    root = folder.resolve()
    return _with_paths(mechanism, lambda path: str(root / path))


def beside(mechanism: Mechanism, folder: Path) -> Mechanism:
    """Return the description with relative paths for those imported solids and parts whose files are within a folder.

    >>> beside(Mechanism("a"), Path()) == Mechanism("a")
    True
    """
    root = folder.resolve()

    def shorten(path: str) -> str:
        return Path(path).relative_to(root).as_posix() if Path(path).is_relative_to(root) else path

    return _with_paths(mechanism, shorten)


def outline_text(body: str, name: str, solid: Imported, folder: Path) -> str:
    """Return the design-file text of an imported outline, for a file in a folder.

    >>> from flexstage.parts.body import Inertia
    >>> cube = Imported("steel", "/parts/cube.step", "0", (0.01, 0.01, 0.01), 1e-3, (0.0, 0.0, 0.0), Inertia(1e-6, 1e-6, 1e-6))
    >>> print(outline_text("platform", "cube", cube, Path("/parts")))
    [bodies.platform.solids.cube]
    shape = "step"
    material = "steel"
    file = "cube.step"
    ...
    """
    return _table(Mechanism("", bodies={body: Body(solids={name: solid})}), "bodies", folder)


def part_text(name: str, part: Elastic, folder: Path) -> str:
    """Return the design-file text of a part, for a file in a folder.

    >>> from flexstage.parts.spring import Spring
    >>> print(part_text("magnet", Spring(stiffness=-2e3), Path()))
    [parts.magnet]
    kind = "spring"
    stiffness = "-0.002 N/um"
    """
    return _table(Mechanism("", parts={name: part}), "parts", folder)


def _table(mechanism: Mechanism, section: str, folder: Path) -> str:
    lines = text_of({section: tree_of(beside(round_to_digits(mechanism), folder))[section]}, {}).splitlines()
    return "\n".join(line for line in lines if line and not line.startswith("#"))


def _with_paths(mechanism: Mechanism, change: Callable[[str], str]) -> Mechanism:
    """The description with changed file paths of parts and outlines."""
    sections = {name: getattr(mechanism, name) for name in ("parts", "bodies", "units")}
    return replace(mechanism, **{name: renamed(entries, FILES, lambda _, path: change(path)) for name, entries in sections.items()})
