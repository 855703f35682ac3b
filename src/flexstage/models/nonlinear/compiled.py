"""Interface to the compiled kernel in C: it passes tables and cases of a stage, and returns the results."""

from __future__ import annotations

import ctypes
import functools
from collections.abc import Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np

from flexstage.base.number import Array
from flexstage.base.processes.native import kernel_library
from flexstage.base.session import SESSION
from flexstage.beams.flexure.law import FlexureLaw
from flexstage.beams.flexure.modes import gauss
from flexstage.models.nonlinear.graph import OtherTerms
from flexstage.models.nonlinear.stage import Flexures, Nonlinear
from flexstage.models.nonlinear.state import Loads, Pose, SolverOptions

_MOST = {"points": 24, "modes": 48, "fields": 24, "unknowns": 150}
"""Capacity of the kernel, and number of body unknowns beyond which LAPACK's blocks are faster than lanes."""
_GROUP_SIZES = ("links", "points", "twist", "across", "bending", "fields")
_GROUP_TABLES = ("weights", "running", "steps", "left", "phi", "inner", "form", "rest", "plate", "compliance", "scalar")
_GROUP_PLACES = ("joins", "turn", "first", "second", "strain", "wrench")
_SIZES = ("cases", "bodies", "extra", "groups", "dead", "iterations", "heavy")
_SETTINGS = ("size", "reach", "step", "gap", "limit")
_ARRAYS = ("position", "turn", "held", "gravity", "body", "arm", "force", "residual", "stiffness", "status", "count", "moved", "lack")
_TABLES = ("length", "rigidity", "form", "modes", "inner", "plate", "compliance", "trapeze", "stretch")
_KNOWN = frozenset((*_TABLES, "inertia", "half", "shearing", "natural", "rest"))


class _Group(ctypes.Structure):
    """`Group` of kernel.c."""

    _fields_ = (
        *((name, ctypes.c_int64) for name in _GROUP_SIZES),
        *((name, ctypes.c_void_p) for name in (*_GROUP_TABLES, *_GROUP_PLACES)),
    )


class _Task(ctypes.Structure):
    """`Task` of kernel.c."""

    _fields_ = (
        *((name, ctypes.c_int64) for name in _SIZES),
        *((name, ctypes.c_double) for name in _SETTINGS),
        ("group", ctypes.c_void_p),
        *((name, ctypes.c_void_p) for name in _ARRAYS),
    )


@dataclass(frozen=True, eq=False)
class CompiledResult:
    """Poses of b cases, and per case (b,): `status`, number of iterations `count`, size `moved` of the last step, last residual `lack`."""

    pose: Pose
    status: Array
    count: Array
    moved: Array
    lack: Array


@dataclass(frozen=True, eq=False)
class Tables:
    """Kernel input of a stage: for each group of flexures, `sizes` and named `arrays`."""

    sizes: tuple[Mapping[str, int], ...]
    arrays: tuple[Mapping[str, Array], ...]


@functools.cache
def kernel() -> ctypes.CDLL | None:
    """Load the library, or return `None` if there is none.

    >>> result = kernel()
    >>> result is None or result.flexstage_equilibria_width() in (2, 4, 8)
    True
    """
    library = kernel_library(Path(__file__).with_name("kernel.c"))
    if library is not None:
        library.flexstage_equilibria.restype = library.flexstage_equilibria_width.restype = ctypes.c_int64
    return library


@SESSION.keep(64)
def tables(model: Nonlinear) -> Tables | None:
    """Build the kernel tables of a stage, or return `None` if the kernel does not support it.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.models.nonlinear.stage import nonlinear
    >>> [sizes["links"] for sizes in tables(nonlinear(parallelogram())).sizes]
    [2, 2]
    """
    groups = [_group(group) for group in model.flexures]
    if model.freedoms > _MOST["unknowns"] or not groups or None in groups:
        return None
    known = [each for each in groups if each is not None]
    return Tables(tuple(sizes for sizes, _ in known), tuple(arrays for _, arrays in known))


def iterate_compiled(model: Nonlinear, start: Pose, loads: Loads, options: SolverOptions, other: OtherTerms | None) -> CompiledResult:
    """Iterate every case in C; requires `kernel` and `tables`.

    If `other` terms are specified, only one step is computed, because these terms are valid only at the start. The result equals
    `newton.iterate` up to rounding. The result of a case is bit-identical for any set of other cases.
    """
    library = kernel()
    assert library is not None  # noqa: S101  (the caller has asked)
    cases = len(start.position)
    pose = Pose(
        _copy(start.position), _copy(start.turn), tuple(map(_copy, start.strain)), tuple(map(_copy, start.wrench)), _copy(start.held)
    )
    results = {name: np.ones(cases, dtype=np.int64) for name in ("status", "count")} | {name: np.zeros(cases) for name in ("moved", "lack")}
    terms = {} if other is None else {"residual": _copy(other.residual), "stiffness": _copy(other.stiffness)}
    held: dict[str, Array] = {name: getattr(pose, name) for name in ("position", "turn", "held")} | _loads(model, loads) | results | terms
    groups, settings = _groups(model, pose), (model.size, model.reach, options.step, options.gap, options.limit)
    sizes = (cases, len(model.bodies), pose.held.shape[1], len(groups), len(held["body"]), options.iterations, int(np.any(loads.gravity)))
    task: Any = _Task()
    _fill(task, dict(zip((*_SIZES, *_SETTINGS), (*sizes, *settings), strict=True)), held)
    task.group = ctypes.addressof(groups)
    if library.flexstage_equilibria(ctypes.byref(task)):
        results["status"][:], results["moved"][:] = 2, np.nan
    return CompiledResult(pose, **results)


def _groups(model: Nonlinear, pose: Pose) -> Any:
    made = tables(model)
    assert made is not None  # noqa: S101  (the caller has asked)
    groups = (_Group * len(made.sizes))()
    for group, sizes, arrays, strain, wrench in zip(groups, made.sizes, made.arrays, pose.strain, pose.wrench, strict=True):
        _fill(group, sizes, {**arrays, "strain": strain, "wrench": wrench})
    return groups


def _loads(model: Nonlinear, loads: Loads) -> dict[str, Array]:
    body = model.places.body.astype(np.int64)
    return {"gravity": _copy(loads.gravity), "force": _copy(model.constant_wrenches(loads)), "body": body, "arm": _copy(model.places.arm)}


def _fill(target: Any, numbers: Mapping[str, float], arrays: Mapping[str, Array]) -> None:
    for name, value in numbers.items():
        setattr(target, name, value)
    for name, array in arrays.items():
        setattr(target, name, array.ctypes.data)


def _copy(array: Array) -> Array:
    return np.array(array, dtype=float, order="C")


def _group(group: Flexures) -> tuple[Mapping[str, int], Mapping[str, Array]] | None:
    law = group.law
    points, _, modes, count = law.signature
    counts = _axes(law)
    if counts is None or points > _MOST["points"] or modes > _MOST["modes"] or count > _MOST["fields"] or _unknown(law):
        return None
    rule = gauss(points)
    weight = law.line_mass * law.length**3 / law.rigidity
    stiff = np.max(np.linalg.diagonal(law.form), axis=-1)
    scalar = [law.length, law.rigidity, law.trapeze, law.stretch[:, 0], law.stretch[:, 1], weight, stiff]
    arrays: tuple[Array, ...] = (
        *(rule.weights, rule.running, np.diff(rule.knots), 1.0 - rule.points),
        *(np.moveaxis(np.sum(each, axis=-2), -1, -2) for each in (law.modes, law.inner)),
        *(law.form, law.rest, law.plate, law.compliance, np.stack(scalar, axis=-1), group.turn, group.arm_first, group.arm_second),
    )
    group_tables: dict[str, Array] = {
        name: _copy(each) for name, each in zip((*_GROUP_TABLES, "turn", "first", "second"), arrays, strict=True)
    }
    group_tables["joins"] = np.stack([group.first, group.second], axis=-1).astype(np.int64, order="C")
    sizes = (len(group.names), points, *counts, count)
    return dict(zip(_GROUP_SIZES, sizes, strict=True)), group_tables


def _axes(law: FlexureLaw) -> tuple[int, ...] | None:
    """Numbers of modes for twist and bending about y and z, if they are in this order, each about one axis, and decoupled."""
    nonzero = np.any(law.modes != 0.0, axis=tuple(range(law.modes.ndim - 2))) | np.any(
        law.inner != 0.0, axis=tuple(range(law.inner.ndim - 2))
    )
    axis = np.argmax(nonzero, axis=0)
    if np.any(np.sum(nonzero, axis=0) != 1) or np.any(np.diff(axis) < 0):
        return None
    count = len(axis)
    apart = axis[:, None] != axis
    return None if np.any(law.form[..., :count, :count][..., apart]) else tuple(int(np.sum(axis == each)) for each in range(3))


def _unknown(law: FlexureLaw) -> bool:
    """Whether a law has non-zero tables that the kernel does not support."""
    others = (getattr(law, each.name) for each in fields(law) if each.name not in _KNOWN)
    bent_across = np.any(law.form[..., law.modes.shape[-1] :, : law.modes.shape[-1]][..., _across(law)])
    return bool(bent_across) or any(each is not None and bool(np.any(each)) for each in others)


def _across(law: FlexureLaw) -> Array:
    """Modes that bend about y, which must not couple with the plate fields."""
    return np.any(law.modes[..., 1, :] != 0.0, axis=tuple(range(law.modes.ndim - 2)))
