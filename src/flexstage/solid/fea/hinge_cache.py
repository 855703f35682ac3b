"""The cache of hinges: their 6x6 by content, so that each is computed once on a machine."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, fields, replace
from pathlib import Path
from typing import Any

import numpy as np

from flexstage.base.finding import DesignError, Finding
from flexstage.base.store import write
from flexstage.solid.fea.cache import folder_of
from flexstage.solid.fea.estimate import Accuracy
from flexstage.solid.fea.hinge_form import HingeForm, HingeSolid
from flexstage.solid.fea.install import require_solver
from flexstage.solid.fea.memory import Counts, needed
from flexstage.solid.fea.parts import Ways
from flexstage.solid.fea.piece import form_digest
from flexstage.solid.fea.remote import work_all
from flexstage.solid.fea.store import versions
from flexstage.solid.fea.worker import Call, Job


@dataclass(frozen=True, eq=False)
class Hinging(Job):
    """A hinge to compute in a process of its own, under the name it has for the user."""

    called: str
    form: HingeForm
    asked: Accuracy

    @property
    def name(self) -> str:
        """The hinge's name."""
        return self.called

    @property
    def order(self) -> int:
        """The lowest order that an error can be estimated at."""
        return min(self.asked.orders[0] + 1, self.asked.orders[1])

    def needed(self, counts: Counts) -> float:
        """Memory of the first solves [bytes]; at higher orders as much is taken as there is."""
        return needed(counts, self.order, 6)

    def refusal(self, counts: Counts, limit: float) -> Finding | None:
        """Why its coarsest mesh does not fit."""
        if self.needed(counts) <= limit:
            return None
        what = f"its coarsest mesh needs about {self.needed(counts) / 1e9:.3g} GB at order {self.order}, and {limit / 1e9:.3g} GB are there"
        return Finding(self.name, what, "Free memory, or let it have more")

    def work(self, call: Call) -> bytes:
        """Compute it; the 6x6 as kept. What is refused is told by the name it has for the user."""
        from flexstage.solid.fea.hinge import Told, hinge_compliance

        try:
            told = Told(call.report, call.ask)
            return _encoded(hinge_compliance(self.form.part, self.form.material, self.asked, told=told, roots=self.form.roots))
        except DesignError as error:
            kind = f"the {self.form.part.kind}"
            raise DesignError(replace(each, where=each.where.replace(kind, self.name, 1)) for each in error.findings) from None


def kept_hinges(
    forms: Mapping[str, HingeForm], asked: Accuracy, ways: Ways, notice: Callable[[Finding], None] | None = None
) -> dict[str, HingeSolid]:
    """The 6x6 of hinges by name, from the cache, else computed in processes of their own, side by side, each kept as soon as it is done.

    The solver is needed only for those that are not there. `notice` is told of a file that is damaged, and of one that could not be kept;
    neither is fatal. Raises `DesignError` with all that could not be computed.

    >>> kept_hinges({}, Accuracy(), Ways())
    {}
    """
    tell = notice or (lambda _: None)
    keys = {name: _key(form, asked) for name, form in forms.items()}
    paths = {key: _path(key, ways) for key in keys.values()}
    found = {key: None if path is None else _read(path, tell) for key, path in paths.items()}
    first = {key: name for name, key in reversed(keys.items())}
    missing = [Hinging(name, forms[name], asked) for name, key in keys.items() if found[key] is None and first[key] == name]

    def take(job: Hinging, data: bytes) -> None:
        key = keys[job.name]
        found[key] = _decoded(data)
        if (path := paths[key]) is not None:
            _keep(path, data, tell)

    if missing:
        require_solver()
        work_all(missing, take, ways.limits, ways.progress)
    return {name: hinge for name, key in keys.items() if (hinge := found[key]) is not None}


def _path(key: str, ways: Ways) -> Path | None:
    return None if ways.cache is None else folder_of(ways.cache) / f"{key}-{versions('hinge').digest}.hinge"


def _key(form: HingeForm, asked: Accuracy) -> str:
    stiffness = (float(np.real(form.material.young)), float(np.real(form.material.poisson)))
    return hashlib.sha256(f"{form_digest(form.part)} {stiffness} {form.roots} {asked}".encode()).hexdigest()[:32]


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
