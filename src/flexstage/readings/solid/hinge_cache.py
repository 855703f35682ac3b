"""The cache of hinges: their 6x6 by content, so that each is computed once on a machine."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from flexstage.base.digest import digest
from flexstage.base.finding import DesignError, Finding
from flexstage.mechanism.store.file import write
from flexstage.parts.leaf import Leaf
from flexstage.parts.material import Material
from flexstage.parts.neck import Neck
from flexstage.parts.notch import Notch
from flexstage.parts.rod import Rod
from flexstage.readings.solid.cache import Cache, folder_of
from flexstage.readings.solid.estimate import Accuracy
from flexstage.readings.solid.store import versions

if TYPE_CHECKING:
    from flexstage.readings.solid.hinge import HingeSolid

HingePart: TypeAlias = Notch | Neck | Leaf | Rod
_ARRAYS = ("compliance", "stiffness", "changes", "whole")


def kept_hinge(
    part: HingePart, material: Material, asked: Accuracy, cache: Cache | None, notice: Callable[[Finding], None] | None = None
) -> HingeSolid:
    """The 6x6 of a hinge from the cache, else computed and kept. The solver is needed only where it is not there.

    `notice` is told of a file that is damaged, and of one that could not be kept; neither is fatal.

    >>> kept_hinge.__name__
    'kept_hinge'
    """
    tell = notice or (lambda _: None)
    path = None if cache is None else folder_of(cache) / f"{_key(part, material, asked)}-{versions().digest}.hinge"
    found = None if path is None else _read(path, tell)
    if found is not None:
        return found
    from flexstage.readings.solid.install import require_solver

    require_solver()
    from flexstage.readings.solid.hinge import hinge_compliance

    result = hinge_compliance(part, material, asked)
    if path is not None:
        _keep(path, result, tell)
    return result


def _key(part: HingePart, material: Material, asked: Accuracy) -> str:
    stiffness = (float(np.real(material.young)), float(np.real(material.poisson)))
    return hashlib.sha256(f"{digest(part, physics=True)} {stiffness} {asked}".encode()).hexdigest()[:32]


def _read(path: Path, tell: Callable[[Finding], None]) -> HingeSolid | None:
    if not path.is_file():
        return None
    try:
        found = _from(json.loads(path.read_text(encoding="utf-8")))
    except (OSError, ValueError, KeyError, TypeError) as error:
        tell(Finding(str(path), f"the 6x6 kept there cannot be read ({error})", "It is computed anew and replaced"))
        return None
    if not np.isfinite(found.compliance).all() or found.compliance.shape != (6, 6):
        tell(Finding(str(path), "the 6x6 kept there is none", "It is computed anew and replaced"))
        return None
    return found


def _from(values: dict[str, Any]) -> HingeSolid:
    from flexstage.readings.solid.hinge import HingeSolid

    finding = values.pop("finding")
    arrays = {name: np.array(values.pop(name), dtype=float) for name in _ARRAYS}
    return HingeSolid(
        compliance=arrays["compliance"],
        stiffness=arrays["stiffness"],
        error=float(values["error"]),
        changes=arrays["changes"],
        whole=arrays["whole"],
        stub=float(values["stub"]),
        freedoms=int(values["freedoms"]),
        elements=int(values["elements"]),
        order=int(values["order"]),
        finding=None if finding is None else Finding(**finding),
    )


def _keep(path: Path, found: HingeSolid, tell: Callable[[Finding], None]) -> None:
    values: dict[str, Any] = {name: getattr(found, name).tolist() for name in _ARRAYS}
    values |= {name: getattr(found, name) for name in ("error", "stub", "freedoms", "elements", "order")}
    values["finding"] = None if found.finding is None else asdict(found.finding)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        write(path, json.dumps(values))
    except (OSError, DesignError) as error:
        tell(Finding(str(path), f"the 6x6 could not be kept ({error})", "The result is complete but will be computed again"))
