"""A stage over its stroke: force, stiffness, parasitic motion, frequencies, strain, stability at every point of a path."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np

from flexstage.analysis.stance import coordinate
from flexstage.analysis.strained import left_out, strain_cautions
from flexstage.base.finding import Finding
from flexstage.base.labelled import Matrix
from flexstage.base.notebook import InNotebook
from flexstage.base.number import Array
from flexstage.base.record import INNER
from flexstage.mechanism.mechanism import PLATFORM
from flexstage.models.linear.eigen import eigenvalues
from flexstage.models.linear.model import LinearModel
from flexstage.models.nonlinear.equilibrium import State
from flexstage.models.nonlinear.linearise import linearise
from flexstage.models.nonlinear.path import Path
from flexstage.models.nonlinear.strain import Strains, strains
from flexstage.spatial.frame import COMPONENTS, FORCES, TWIST_UNITS, WRENCH_UNITS

_FREQUENCIES = 3
_AT_ONCE = 2
"""Points between which it is told how far it is."""
_FORCE_OF: dict[str, str] = dict(zip(COMPONENTS, FORCES, strict=True))


@dataclass(frozen=True, eq=False)
class Stroke(InNotebook):
    """A stage along `drive`: a row a point `along` it.

    Columns: the drive's value; the force that holds it there and the stiffness against it, where the drive is a coordinate; the platform's
    displacement and rotation vector; its first natural frequencies, free under that force; the largest stress and strain of a flexure; and
    in how many ways the free stage would leave that place (0: stable). Drive and displacements count from `sag`, where weight and loads
    bring the platform from its drawn place; None where they count from the drawn one.
    """

    drive: str
    along: Matrix
    sag: Matrix | None
    strained: Annotated[Strains, INNER]
    doubts: Annotated[tuple[Finding, ...], INNER]
    provenance: str

    @property
    def cautions(self) -> tuple[Finding, ...]:
        """What is beyond the theory, or not found."""
        return (*_cautions(self), *self.doubts)


def stroke(path: Path, rest: State | None = None, *, told: Callable[[int], None] | None = None) -> Stroke:
    """What a designer asks of a path, point by point (docs/nonlinear.md, 25 to 28).

    Frequencies are NaN where the free stage is not stable. Loads and weight are those of the path. The drive and displacements count from
    `rest`, if it is given. `told` hears how many points are done; without it they are done together.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.models.nonlinear.path import path
    >>> from flexstage.models.nonlinear.stage import nonlinear
    >>> found = stroke(path(nonlinear(parallelogram()), "platform.x", np.array([0.0, 1e-4])))
    >>> found.along.columns[:4]
    ('platform.x', 'force', 'stiffness', 'platform.y')
    """
    count = len(path.values)
    portions = [np.arange(count)] if told is None else np.array_split(np.arange(count), max(1, -(-count // _AT_ONCE)))
    found: list[Stroke] = []
    for portion in portions:
        found.append(_portion(path if told is None else path.some(portion), rest))
        if told is not None:
            told(int(portion[-1]) + 1)
    first, parts = found[0], [each.strained for each in found]
    largest, curving, stress = (np.concatenate([getattr(each, name) for each in parts]) for name in ("largest", "curving", "stress"))
    rows, unit = tuple(str(number + 1) for number in range(count)), first.along.unit
    values = np.concatenate([each.along.values for each in found])
    along = Matrix(values, rows, first.along.columns, unit if isinstance(unit, str) else unit[:1] * count)
    strained = replace(parts[0], largest=largest, curving=curving, stress=stress)
    return replace(first, along=along, strained=strained, doubts=tuple(left_out(path.state)))


def _portion(path: Path, rest: State | None) -> Stroke:
    about = linearise(path.state, locked=path.locked)
    strained = strains(path.state)
    columns = dict(_columns(path, about, strained, rest))
    values = np.stack([values for values, _ in columns.values()], axis=-1)
    rows = tuple(str(number + 1) for number in range(len(path.values)))
    units = tuple(tuple(unit for _, unit in columns.values()) for _ in rows)
    sag = None if rest is None else Matrix(rest.twist(PLATFORM)[None], (PLATFORM,), COMPONENTS, (TWIST_UNITS,))
    return Stroke(path.drive, Matrix(values, rows, tuple(columns), units), sag, strained, (), about.provenance)


def _columns(path: Path, about: LinearModel, strained: Strains, rest: State | None) -> Iterator[tuple[str, tuple[Array, str]]]:
    owner, _, component = path.drive.rpartition(".")
    held = component in COMPONENTS and path.state.held[:1] == (path.drive,)
    units: dict[str, str] = dict(zip(COMPONENTS, TWIST_UNITS, strict=True))
    known = {channel.name: channel.unit for channel in about.inputs}
    begun = 0.0 if rest is None or not held else coordinate(rest, path.drive)
    yield path.drive, (path.values - begun, units[component] if held else known.get(path.drive, "1"))
    if held:
        force = WRENCH_UNITS[COMPONENTS.index(component)]
        yield "force", (path.state.reactions[..., 0], force)
        conjugate = f"{owner}.{_FORCE_OF[component]}"
        if conjugate in known:
            yield "stiffness", (_stiffness(about, path.drive, conjugate), f"{force}/{units[component]}")
    twist = path.state.twist(PLATFORM) - (0.0 if rest is None else rest.twist(PLATFORM))
    yield from (
        (f"platform.{name}", (twist[..., place], units[name])) for place, name in enumerate(COMPONENTS) if f"platform.{name}" != path.drive
    )
    with np.errstate(invalid="ignore"):  # of what is not stable
        frequencies = np.sqrt(eigenvalues(about)) / (2.0 * np.pi)
    yield from ((f"f{place + 1}", (frequencies[..., place], "Hz")) for place in range(min(_FREQUENCIES, frequencies.shape[-1])))
    yield "stress", (np.max(strained.stress, axis=-1, initial=0.0), "Pa")
    yield "strain", (np.max(strained.largest, axis=-1, initial=0.0), "1")
    yield "unstable", (np.where(path.motions < 0, np.nan, path.motions), "1")


def _stiffness(about: LinearModel, coordinate: str, force: str) -> Array:
    """Force over displacement in its own direction, everything else free."""
    known = np.asarray(np.isfinite(about.stiffness_matrix).all(axis=(-2, -1)))[..., None, None]
    matrix = np.where(known, about.stiffness_matrix, np.eye(len(about.coordinates)))
    moved = np.linalg.solve(matrix, about.input_matrix[..., about.input_index((force,))])
    compliance = (about.output[..., about.output_index((coordinate,)), :] @ moved)[..., 0, 0]
    return np.where(known[..., 0, 0], 1.0 / compliance, np.nan)


def _cautions(found: Stroke) -> Iterator[Finding]:
    yield from strain_cautions(found.strained)
    values = found.along.values[:, 0]
    lost = np.isnan(found.along.values[:, -2])
    if lost.any():
        what = f"{int(lost.sum())} of {len(lost)} points have no equilibrium that was found, the first at {values[lost][0]:.4g}"
        yield Finding(found.drive, what, "Ask for less, or follow the load by arc length (fs.trace)")
    loose = found.along.values[:, -1] > 0
    if loose.any():
        what = f"at {int(loose.sum())} of {len(loose)} points the free stage is not stable, the first at {values[loose][0]:.4g}"
        yield Finding(found.drive, what, "Ask flexstage buckle what gives way")
