"""Sound stages: outlines are checked against each other before anything is meshed, once for what is known to be sound already."""

from __future__ import annotations

import contextlib
from collections.abc import Sequence
from pathlib import Path

from flexstage.base.finding import DesignError, Finding, require
from flexstage.base.storage.digest import digest
from flexstage.base.storage.store import write
from flexstage.mechanism.mechanism import Mechanism
from flexstage.parts.body import Imported
from flexstage.solid.fea.jobs.apart import contacts_apart
from flexstage.solid.fea.jobs.cache import Cache, folder_of
from flexstage.solid.fea.jobs.remote import Pool
from flexstage.solid.fea.jobs.store import versions
from flexstage.solid.fea.solver.component import Component, Cut, components


def sound_components(mechanism: Mechanism, cache: Cache | None, cut: Cut = Cut.UNITS, pool: Pool | None = None) -> tuple[Component, ...]:
    """Cut a stage into components, its outlines checked against each other.

    Raises `DesignError` naming every link that has no shape, and every gap, overlap and sliver with its size (`contact_findings`).

    >>> sound_components(Mechanism("nothing"), None)
    ()
    """
    parts = components(mechanism, cut)
    if parts:
        require(stage_findings(mechanism, cache, pool))
    return parts


def stage_findings(mechanism: Mechanism, cache: Cache | None, pool: Pool | None = None) -> tuple[Finding, ...]:
    """What keeps a stage's outlines from forming solids. Sound stages are remembered in the cache by their content.

    Those with imported solids are not: their files may change.
    """
    mark = None if cache is None or has_imports(mechanism) else _mark(mechanism, cache)
    if mark is not None and mark.is_file():
        return ()
    (found,) = contacts_apart([mechanism], pool=pool)
    if mark is not None:
        _remember(mark, found)
    return found


def check_together(mechanisms: Sequence[Mechanism], cache: Cache | None, pool: Pool | None = None) -> None:
    """Check stages side by side and remember those that are sound; what is wrong with the others is told when they are asked for.

    >>> check_together((), None)
    """
    marks = {} if cache is None else {_mark(each, cache): each for each in mechanisms if not has_imports(each)}
    unknown = {mark: each for mark, each in marks.items() if not mark.is_file()}
    if unknown:
        with contextlib.suppress(DesignError):
            for mark, found in zip(unknown, contacts_apart(tuple(unknown.values()), pool=pool), strict=True):
                _remember(mark, found)


def _remember(mark: Path, found: tuple[Finding, ...]) -> None:
    if not found:
        with contextlib.suppress(OSError, DesignError):  # it is checked again then
            mark.parent.mkdir(parents=True, exist_ok=True)
            write(mark, "")


def _mark(mechanism: Mechanism, cache: Cache) -> Path:
    return folder_of(cache) / f"{digest(mechanism, physics=True)[:32]}-{versions('geometry.contact').digest}.sound"


def has_imports(mechanism: Mechanism) -> bool:
    """Whether some of a stage's solids stand in files of their own."""
    bodies = [*mechanism.bodies.values(), *(body for unit in mechanism.units.values() for body in unit.bodies.values())]
    return any(isinstance(solid, Imported) for body in bodies for solid in body.solids.values())
