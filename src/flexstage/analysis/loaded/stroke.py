"""Characteristics over the stroke: force, stiffness, parasitic motion, frequencies, strain and stability along a load path."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Annotated

import numpy as np

from flexstage.analysis.loaded.operating_point import coordinate
from flexstage.analysis.loaded.strained import left_out, strain_warnings
from flexstage.base.arguments import check_arguments
from flexstage.base.finding import Finding
from flexstage.base.labelled import Matrix
from flexstage.base.notebook import Result
from flexstage.base.number import Array
from flexstage.base.record import INNER
from flexstage.base.units.quantity import LENGTH
from flexstage.base.units.unit import quantity_of_unit, show
from flexstage.mechanism.mechanism import PLATFORM
from flexstage.models.linear.eigen import eigenvalues
from flexstage.models.linear.kinematics import Kinematics
from flexstage.models.linear.model import LinearModel
from flexstage.models.nonlinear.elements.strain import Strains, strains
from flexstage.models.nonlinear.equilibrium import State
from flexstage.models.nonlinear.linearise import linearise
from flexstage.models.nonlinear.paths.critical_load import unstable_motions
from flexstage.models.nonlinear.paths.load_path import LoadPath
from flexstage.spatial.frame import COMPONENTS, FORCES, TWIST_UNITS, WRENCH

_FREQUENCIES = ("f1", "f2", "f3")
_FORCE_OF: dict[str, str] = dict(zip(COMPONENTS, FORCES, strict=True))


class Stroke(Result):
    """Characteristics of a stage over the stroke of a `drive`. The matrix `along` has a row for each point.

    Columns are the drive's value, the holding force and stiffness of a driven coordinate, and the platform's displacement and rotation
    vector. For a stack, the column `lost` is its lost motion divided by its stroke. Further columns are the platform's first natural
    frequencies (with the coordinate free under the holding force), the largest stress and strain of a flexure, and the number of unstable
    modes (0: stable). Drive and displacements are relative to the static deflection `sag` under weight and loads; if `sag` is None, they
    are relative to the nominal position.
    """

    drive: str
    along: Matrix
    sag: Matrix | None
    strained: Annotated[Strains, INNER]
    doubts: Annotated[tuple[Finding, ...], INNER]
    provenance: str

    @property
    def warnings(self) -> tuple[Finding, ...]:
        """Warnings of strains beyond the limits of the theory, and of missing equilibria."""
        return (*_warnings(self), *self.doubts)


@dataclass(frozen=True, eq=False)
class PostBuckling:
    """The post-buckling path and its characteristics."""

    path: LoadPath
    stroke: Stroke


@check_arguments
def stroke(path: LoadPath, rest: State | None = None, *, kinematics: Kinematics | None = None) -> Stroke:
    """Compute force, stiffness, motion, frequencies and stress at each point of a stroke (equations 25 to 28 of docs/nonlinear.md).

    Frequencies are those of the released stage: a driven coordinate is free under the holding force. They are NaN if the released stage is
    unstable. Loads and weight are those of `path`. If a state `rest` is specified, the driven coordinate and the displacements are relative
    to this state. If the ideal `kinematics` of the stage are specified, the result contains the relative lost motion of a driven stack, 1 -
    R_a V^+ t / a. Here t is the platform's displacement and rotation vector relative to `rest`, and a is the stroke. V^+ maps t to the
    coordinates of the ideal motions, and R_a maps these to the stroke; both are computed in the nominal position (see `lost_motion`).

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.models.nonlinear.paths.load_path import load_path
    >>> from flexstage.models.nonlinear.stage import nonlinear
    >>> result = stroke(load_path(nonlinear(parallelogram()), "platform.x", np.array([0.0, 1e-4])))
    >>> result.along.columns[:4]
    ('platform.x', 'force', 'stiffness', 'platform.y')
    """
    points = Points(path.drive, path.values, path.state, path.locked, rest, kinematics)
    none = _FREQUENCIES[points.frequencies.shape[-1] :]
    columns = {name: column for name, column in points.columns.items() if name not in none}
    values = np.stack([values() for values, _ in columns.values()], axis=-1)
    rows = tuple(str(number + 1) for number in range(len(path.values)))
    along = Matrix(values, rows, tuple(columns), (tuple(unit for _, unit in columns.values()),) * len(rows))
    sag = None if rest is None else Matrix(rest.twist(PLATFORM)[None], (PLATFORM,), COMPONENTS, (TWIST_UNITS,))
    return Stroke(path.drive, along, sag, points.strained, tuple(left_out(path.state)), points.about.provenance)


@dataclass(frozen=True, eq=False)
class Points:
    """States (k,) at `values` of a drive, and the characteristics of these states relative to `rest`, computed on first use.

    `locked` coordinates remain fixed when the drive is released. Lost motion requires the ideal `kinematics`.
    """

    drive: str
    values: Array
    state: State
    locked: tuple[str, ...]
    rest: State | None
    kinematics: Kinematics | None = None

    @cached_property
    def about(self) -> LinearModel:
        """Stage linearised about each of the states."""
        return linearise(self.state, locked=self.locked)

    @cached_property
    def strained(self) -> Strains:
        """Strain and stress of the flexures."""
        return strains(self.state)

    @cached_property
    def motions(self) -> Array:
        """Number of unstable modes of each released state; -1 if no equilibrium was found."""
        return unstable_motions(self.state, locked=self.locked)

    @cached_property
    def frequencies(self) -> Array:
        """Natural frequencies (k, n) of the released stage in each of the k states [Hz]; NaN if the released stage is unstable."""
        with np.errstate(invalid="ignore"):
            return np.sqrt(eigenvalues(self.about)) / (2.0 * np.pi)

    @cached_property
    def columns(self) -> dict[str, tuple[Callable[[], Array], str]]:
        """Columns by name: the function that computes the column, and the column's unit."""
        return dict(_columns(self))

    def column(self, name: str) -> Array:
        """Return a single column (k,)."""
        return self.columns[name][0]()


def _columns(points: Points) -> Iterator[tuple[str, tuple[Callable[[], Array], str]]]:
    drive, state, rest = points.drive, points.state, points.rest
    owner, _, component = drive.rpartition(".")
    held = component in COMPONENTS and state.held[:1] == (drive,)
    units: dict[str, str] = dict(zip(COMPONENTS, TWIST_UNITS, strict=True))
    known = {channel.name: channel.unit for channel in state.model.inputs}
    begun = 0.0 if rest is None or not held else coordinate(rest, drive)
    yield drive, (lambda: points.values - begun, units[component] if held else known.get(drive, "1"))
    if held:
        force = WRENCH.unit(component)
        yield "force", (lambda: state.reactions[..., 0], force)
        conjugate = f"{owner}.{_FORCE_OF[component]}"
        if conjugate in known:
            yield "stiffness", (lambda: _stiffness(points.about, drive, conjugate), f"{force}/{units[component]}")
    twist = state.twist(PLATFORM) - (0.0 if rest is None else rest.twist(PLATFORM))
    yield from (
        (f"platform.{name}", (partial(np.take, twist, place, -1), units[name]))
        for place, name in enumerate(COMPONENTS)
        if f"platform.{name}" != drive
    )
    ideal = points.kinematics
    if ideal is not None and drive in ideal.actuators and ideal.actuated:
        yield "lost", (lambda: _lost(ideal, drive, points.values, twist), "1")
    yield from ((name, (partial(_frequency, points, place), "Hz")) for place, name in enumerate(_FREQUENCIES))
    yield "stress", (lambda: np.max(points.strained.stress, axis=-1, initial=0.0), "Pa")
    yield "strain", (lambda: np.max(points.strained.largest, axis=-1, initial=0.0), "1")
    yield "unstable", (lambda: np.where(points.motions < 0, np.nan, points.motions), "1")


def _lost(ideal: Kinematics, drive: str, strokes: Array, twist: Array) -> Array:
    """Relative lost motion of a stroke; NaN at zero stroke."""
    sense = (ideal.mapping.values @ ideal.projection)[ideal.actuators.index(drive)]
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(strokes == 0.0, np.nan, 1.0 - twist @ sense / strokes)


def _frequency(points: Points, place: int) -> Array:
    few = place >= points.frequencies.shape[-1]
    return np.full(len(points.values), np.nan) if few else points.frequencies[..., place]


def _stiffness(about: LinearModel, coordinate: str, force: str) -> Array:
    """Force per displacement along the drive, all else free."""
    known = np.asarray(np.isfinite(about.stiffness_matrix).all(axis=(-2, -1)))[..., None, None]
    matrix = np.where(known, about.stiffness_matrix, np.eye(len(about.coordinates)))
    moved = np.linalg.solve(matrix, about.input_matrix[..., about.input_index((force,))])
    compliance = (about.output[..., about.output_index((coordinate,)), :] @ moved)[..., 0, 0]
    return np.where(known[..., 0, 0], 1.0 / compliance, np.nan)


def _warnings(result: Stroke) -> Iterator[Finding]:
    yield from strain_warnings(result.strained)
    lost = np.isnan(result.along.values[:, -1])
    if lost.any():
        what = f"no equilibrium found at {int(lost.sum())} of {len(lost)} points, the first at {_first(result, lost)}"
        yield Finding(result.drive, what, "Reduce the stroke, or use arc-length continuation (fs.continuation)")
    loose = result.along.values[:, -1] > 0
    if loose.any():
        what = f"the free stage is unstable at {int(loose.sum())} of {len(loose)} points, the first at {_first(result, loose)}"
        yield Finding(result.drive, what, "Run flexstage buckle to find the buckling mode")


def _first(result: Stroke, points: Array) -> str:
    """Value of the drive at the first of the marked points."""
    along = result.along
    unit = along.unit if isinstance(along.unit, str) else along.unit[0][0]
    return show(float(along.values[points, 0][0]), LENGTH if unit == "m" else quantity_of_unit(unit), digits=4)
