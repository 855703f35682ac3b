"""Sound stages, which have outlines without errors: outlines are checked before meshing, once for each stage."""

from __future__ import annotations

import contextlib
from collections.abc import Sequence

from flexstage.base.finding import DesignError, Finding, require
from flexstage.base.storage.digest import digest
from flexstage.mechanism.drawn import with_drawn_parts
from flexstage.mechanism.mechanism import Mechanism
from flexstage.parts.body import Imported
from flexstage.solid.fea.jobs.apart import contacts_apart
from flexstage.solid.fea.jobs.cache import SOUND, Cache, holds, keep
from flexstage.solid.fea.jobs.install import require_installed
from flexstage.solid.fea.jobs.remote import Pool
from flexstage.solid.fea.meshing.fineness import Fineness, thin_findings
from flexstage.solid.fea.solver.component import Component, Cut, components


def sound_components(mechanism: Mechanism, cache: Cache | None, cut: Cut = Cut.UNITS, pool: Pool | None = None) -> tuple[Component, ...]:
    """Cut a stage into components, after a check of its outlines.

    Raises `DesignError` with the names of links without a shape or a specified stiffness, and with the sizes of gaps, overlaps and slivers
    (`contact_findings`).

    >>> sound_components(Mechanism("nothing"), None)
    ()
    """
    parts = components(mechanism, cut)
    if parts:
        require(stage_findings(mechanism, cache, pool))
    return parts


def stage_findings(mechanism: Mechanism, cache: Cache | None, pool: Pool | None = None) -> tuple[Finding, ...]:
    """Return the errors that prevent a stage's outlines from forming solids. The cache records the stages without errors.

    Stages with imported solids are always checked, because their files may change.
    """
    if cache is not None and _is_known(mechanism, cache):
        return ()
    (found,) = contacts_apart([mechanism], pool=pool)
    if cache is not None:
        _remember(mechanism, cache, found)
    return found


def solid_findings(mechanism: Mechanism) -> tuple[Finding, ...]:
    """Return the outlines' errors that prevent FEA of a stage; the result is empty without solver or if a link cannot be a solid.

    >>> solid_findings(Mechanism("nothing"))
    ()
    """
    shape = with_drawn_parts(mechanism)
    try:
        require_installed()
        parts = components(shape)
        thin = tuple(each for part in parts for each in thin_findings(part.pieces, Fineness()))
        return thin or (stage_findings(shape, Cache()) if parts else ())
    except DesignError:  # without solver, or not a solid by choice
        return ()


def check_together(mechanisms: Sequence[Mechanism], cache: Cache | None, pool: Pool | None = None) -> None:
    """Check stages in parallel and record stages without errors in the cache. Errors are reported later, when a stage is used.

    >>> check_together((), None)
    """
    unknown = {} if cache is None else {_key(each): each for each in mechanisms if not has_imports(each) and not _is_known(each, cache)}
    if cache is not None and unknown:
        with contextlib.suppress(DesignError):
            for each, found in zip(unknown.values(), contacts_apart(tuple(unknown.values()), pool=pool), strict=True):
                _remember(each, cache, found)


def _is_known(mechanism: Mechanism, cache: Cache) -> bool:
    return not has_imports(mechanism) and holds(cache, _key(mechanism), SOUND)


def _remember(mechanism: Mechanism, cache: Cache, found: tuple[Finding, ...]) -> None:
    if not (found or has_imports(mechanism)):
        keep(cache, _key(mechanism), mechanism.name, None, SOUND, notice=lambda _finding: None)  # it is checked again then


def _key(mechanism: Mechanism) -> str:
    return digest(mechanism, physics=True)[:32]


def has_imports(mechanism: Mechanism) -> bool:
    """Return whether a stage contains imported solids."""
    bodies = [*mechanism.bodies.values(), *(body for unit in mechanism.units.values() for body in unit.bodies.values())]
    return any(isinstance(solid, Imported) for body in bodies for solid in body.solids.values())
