"""The cache of hinges: their 6x6 by content, so that each is computed once on a machine."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable
from dataclasses import asdict, dataclass, fields
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
from flexstage.readings.solid.cache import folder_of
from flexstage.readings.solid.estimate import Accuracy
from flexstage.readings.solid.install import require_solver
from flexstage.readings.solid.parts import Ways
from flexstage.readings.solid.progress import Stage
from flexstage.readings.solid.remote import work_all
from flexstage.readings.solid.store import versions
from flexstage.readings.solid.worker import Call, Job

if TYPE_CHECKING:
    from flexstage.readings.solid.hinge import HingeSolid

HingePart: TypeAlias = Notch | Neck | Leaf | Rod
_ARRAYS = ("compliance", "stiffness", "changes", "whole")


@dataclass(frozen=True, eq=False)
class Hinging(Job):
    """A hinge to compute in a process of its own."""

    part: HingePart
    material: Material
    asked: Accuracy

    @property
    def name(self) -> str:
        """What kind of hinge it is."""
        return f"the {type(self.part).__name__.lower()}"

    def work(self, call: Call) -> bytes:
        """Compute it; the 6x6 as kept."""
        from flexstage.readings.solid.hinge import hinge_compliance

        call.report(Stage.MESHING, 0.0)
        return _encoded(hinge_compliance(self.part, self.material, self.asked))


def kept_hinge(
    part: HingePart, material: Material, asked: Accuracy, ways: Ways, notice: Callable[[Finding], None] | None = None
) -> HingeSolid:
    """The 6x6 of a hinge from the cache, else computed in a process of its own and kept. The solver is needed only where it is not there.

    `notice` is told of a file that is damaged, and of one that could not be kept; neither is fatal.

    >>> kept_hinge.__name__
    'kept_hinge'
    """
    tell = notice or (lambda _: None)
    path = None if ways.cache is None else folder_of(ways.cache) / f"{_key(part, material, asked)}-{versions('hinge').digest}.hinge"
    found = None if path is None else _read(path, tell)
    if found is not None:
        return found
    require_solver()
    results: list[bytes] = []
    work_all([Hinging(part, material, asked)], lambda _job, data: results.append(data), ways.limits)
    if path is not None:
        _keep(path, results[0], tell)
    return _decoded(results[0])


def _key(part: HingePart, material: Material, asked: Accuracy) -> str:
    stiffness = (float(np.real(material.young)), float(np.real(material.poisson)))
    return hashlib.sha256(f"{digest(part, physics=True)} {stiffness} {asked}".encode()).hexdigest()[:32]


def _read(path: Path, tell: Callable[[Finding], None]) -> HingeSolid | None:
    if not path.is_file():
        return None
    try:
        found = _decoded(path.read_bytes())
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
        tell(Finding(str(path), f"the 6x6 kept there cannot be read ({error})", "It is computed anew and replaced"))
        return None
    if not np.isfinite(found.compliance).all() or found.compliance.shape != (6, 6):
        tell(Finding(str(path), "the 6x6 kept there is none", "It is computed anew and replaced"))
        return None
    return found


def _encoded(found: HingeSolid) -> bytes:
    values = {field.name: getattr(found, field.name) for field in fields(found)}
    arrays = {name: value.tolist() for name, value in values.items() if isinstance(value, np.ndarray)}
    numbers = {name: value for name, value in values.items() if isinstance(value, (int, float))}
    body = {"arrays": arrays, "numbers": numbers, "finding": None if found.finding is None else asdict(found.finding)}
    return json.dumps(body | {"checksum": _checksum(body)}).encode()


def _decoded(data: bytes) -> HingeSolid:
    from flexstage.readings.solid.hinge import HingeSolid

    body: dict[str, Any] = json.loads(data)
    if body.pop("checksum") != _checksum(body):
        raise ValueError("it does not have the checksum it states")
    finding = None if body["finding"] is None else Finding(**body["finding"])
    arrays = {name: np.array(value, dtype=float) for name, value in body["arrays"].items()}
    return HingeSolid(**arrays, **body["numbers"], finding=finding)


def _checksum(body: dict[str, Any]) -> str:
    return hashlib.sha256(json.dumps(body, sort_keys=True).encode()).hexdigest()


def _keep(path: Path, data: bytes, tell: Callable[[Finding], None]) -> None:
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        write(path, data.decode())
    except (OSError, DesignError) as error:
        tell(Finding(str(path), f"the 6x6 could not be kept ({error})", "The result is complete but will be computed again"))
