"""Stress at every hinge at the worst corner of the stroke range, compared with yield stress, fatigue limit or allowable stress."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import fields, is_dataclass, replace
from typing import Annotated, Any, ClassVar, TypeAlias

import numpy as np

from flexstage.analysis.workspace.load import SAFETY
from flexstage.analysis.workspace.stroke import StrokeLimits
from flexstage.analysis.workspace.wrench import Command, corner_wrenches
from flexstage.base.finding import refuse
from flexstage.base.labelled import Matrix
from flexstage.base.notebook import Result
from flexstage.base.number import Array, index_of_largest, stack
from flexstage.base.record import INNER, VIEW, Along, Heading, Layout
from flexstage.base.units.quantity import RATIO
from flexstage.beams.stress import FACES, has_section, stress, stressed_place
from flexstage.mechanism.assembly.expand import Assembly, PlacedLink, expand
from flexstage.mechanism.mechanism import Mechanism
from flexstage.models.linear.model import LinearModel
from flexstage.parts.material import Material
from flexstage.parts.part import Part, Restricted
from flexstage.parts.profile import single
from flexstage.spatial.frame import COMPONENTS, MOTION

FROM_ZERO = "of all strokes from zero voltage"


class HingeStress(Result):
    """Largest stress in each of L hinges over the corners of the stroke range; the arrays have the shape (..., L).

    `nominal` and `peak` (with the notch factor) are von Mises stresses [Pa]. `yield_stress` [Pa] is NaN if unspecified. `strokes` (..., L,
    n) [m] contains the strokes at the worst corner. `unchecked` names links without a section to check (stacks, compliance matrices,
    restricted parts). `limit` [Pa] is the least of yield stress, fatigue limit and allowable stress, NaN if none is specified. If `limit`
    is `None`, the yield stress is the limit. `governing` names the governing limit in the first design.

    `places` are the ends and faces with the largest stress (empty for a batch). `condition` describes the range of strokes in words.
    `actuators` are stroke or force actuators, or platform coordinates; `units` are their units.
    """

    TABLE: ClassVar[Layout] = Layout(
        "Stress in the hinges",
        "table places",
        head="hinge",
        notes=("Von Mises stress at the worst corner {self.condition}, with permanent load. The peak includes the notch factor.",),
    )

    links: tuple[str, ...]
    actuators: tuple[str, ...]
    nominal: Array
    peak: Array
    yield_stress: Array
    strokes: Array
    unchecked: tuple[str, ...]
    provenance: str
    limit: Array | None = None
    governing: tuple[str, ...] = ()
    places: Annotated[tuple[str, ...], Along("links"), Heading("largest at")] = ()
    condition: str = FROM_ZERO
    units: Annotated[tuple[str, ...], INNER] = ()

    @property
    def allowed(self) -> Annotated[Array, VIEW]:
        """Governing stress limit (..., L) [Pa]."""
        return self.yield_stress if self.limit is None else self.limit

    @property
    def safety(self) -> Annotated[Array, INNER, Heading("safety factor", digits=4, mark=SAFETY)]:
        """Safety factor (..., L): the limit divided by the peak stress; infinite at zero stress."""
        loaded = self.peak != 0.0
        return np.where(loaded | np.isnan(self.allowed), self.allowed / np.where(loaded, self.peak, 1.0), np.inf)

    @property
    def min_safety(self) -> Annotated[Array, RATIO]:
        """The least safety factor of the stage (...); NaN if any hinge's limit is unknown."""
        return np.min(self.safety, axis=-1)

    @property
    def weakest(self) -> Annotated[str, VIEW]:
        """Link with the least known safety factor in the first design."""
        first = np.nan_to_num(self.safety.reshape(-1, len(self.links))[0], nan=np.inf)
        return self.links[int(index_of_largest(1.0 / first))]

    @property
    def unknown(self) -> Annotated[tuple[str, ...], VIEW]:
        """Links without a specified stress limit."""
        gone = np.isnan(np.atleast_2d(self.allowed)).reshape(-1, len(self.links)).any(axis=0)
        return tuple(link for link, missing in zip(self.links, np.asarray(gone), strict=True) if missing)

    @property
    def notes(self) -> Annotated[tuple[str, ...], INNER]:
        """Notes on unchecked links and on limits other than yield."""
        other = (f"{link} {name}" for link, name in zip(self.links, self.governing, strict=False) if name not in ("", "yield stress"))
        said = {"Not checked": self.unchecked, "Yield stress not specified": self.unknown, "Limits other than yield": tuple(other)}
        return tuple(f"{text}: {', '.join(names)}." for text, names in said.items() if names)

    @property
    def worst_strokes(self) -> Annotated[Matrix, VIEW]:
        """Strokes at the largest stress of each link."""
        return Matrix(self.strokes, self.links, self.actuators, (self.units,) * len(self.links) if self.units else "m")

    @property
    def table(self) -> Annotated[Matrix, VIEW, Heading(digits=4)]:
        """Table of the links (rows) with nominal and peak stress, yield stress (or the governing limit) and safety factor."""
        values = stack([self.nominal, self.peak, self.allowed, self.safety])
        return Matrix(values, self.links, ("nominal", "peak", "yield", "safety"), (("Pa", "Pa", "Pa", "1"),) * len(self.links))


def hinge_stress(
    mechanism: Mechanism, model: LinearModel, limits: StrokeLimits, *, command: Command | None = None, condition: str = FROM_ZERO
) -> HingeStress:
    """Compute the stress of every hinge from the link wrenches of an elastic model, with permanent load.

    In a stage assembled at zero voltage, the bias also bends the hinges: use `stroke_limits(mechanism).from_zero` as `limits`. For a stage
    that is stress-free at its bias, use `stroke_limits(mechanism)`.

    With a `command`, `limits` apply to the command's coordinates. `condition` describes the limits in words. The stress is computed by
    linear beam theory; the maxima of a section are added (see `beams.stress`).

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.lumped import lumped
    >>> from flexstage.analysis.workspace.stroke import stroke_limits
    >>> stage = double_triangle()
    >>> hinge_stress(stage, lumped(stage), stroke_limits(stage).from_zero).weakest
    'B4/pivot'
    """
    assembly = expand(mechanism)
    sized = sized_links(assembly)
    if not sized:
        raise refuse("stress", "no link has a section to check", "Use notches, necks, leaves or rods")
    wrenches = corner_wrenches(mechanism, model, limits, tuple(sized), command)
    points = limits.points(wrenches.ndim - 3)
    rows = _rows(list(sized.values()), wrenches, points)
    nominal, peak, known, limit = (stack([row[item] for row in rows]) for item in (0, 1, 2, 4))
    return HingeStress(
        links=tuple(sized),
        actuators=limits.actuators,
        nominal=nominal,
        peak=peak,
        yield_stress=known,
        strokes=np.stack(np.broadcast_arrays(*(row[3] for row in rows)), axis=-2),
        unchecked=tuple(name for name in (*assembly.links, *assembly.superelements) if name not in sized),
        provenance=model.provenance,
        limit=limit,
        governing=tuple(_governing(link.material) for link in sized.values()),
        places=() if any(row[5].ndim > 1 for row in rows) else tuple(_places(sized, np.stack([np.real(row[5]) for row in rows]))),
        condition=condition,
        units=tuple(_input_unit(model, name) for name in limits.actuators),
    )


def _input_unit(model: LinearModel, name: str) -> str:
    return MOTION.unit(name) if name in COMPONENTS else model.inputs[model.input_index((name,))[0]].unit


def _places(links: Mapping[str, PlacedLink], wrenches: Array) -> Iterator[str]:
    """End and faces of the largest stress of links under their wrenches (L, 6); the body of an end without the name of its instance."""
    placed, result = list(links.values()), dict[int, tuple[int, int]]()
    for members in _groups(placed):
        first = placed[members[0]]
        result |= dict(zip(members, zip(*stressed_place(_real(first.part), first.material, wrenches[members]), strict=True), strict=True))
    for index, (name, link) in enumerate(links.items()):
        end, face = result[index]
        instance = f"{name.rpartition('/')[0]}/"
        side = "middle" if end == 0 else f"{link.joins[int(end > 0)].removeprefix(instance)} end"
        yield f"{side}, {FACES[face]}"


def sized_links(assembly: Assembly) -> dict[str, PlacedLink]:
    """Return the links whose stress can be computed."""
    return {name: link for name, link in assembly.links.items() if _has_section(link)}


def stress_use(links: Mapping[str, PlacedLink], wrenches: Array) -> Array:
    """Compute the largest ratio of stress to limit (...) over all links under wrenches (..., L, 6); NaN if a limit is unknown."""
    return np.max(stress_shares(links, wrenches), axis=-1)


def stress_shares(links: Mapping[str, PlacedLink], wrenches: Array) -> Array:
    """Compute ratios of stress to limit (..., L) of links under wrenches (..., L, 6); NaN if the limit is unknown."""
    rows = _rows(list(links.values()), wrenches[None], np.zeros((1, *(1,) * (wrenches.ndim - 2), 0)))
    return stack([row[1] / row[4] for row in rows])


def _governing(material: Material | None) -> str:
    """Name of the least stress limit on the first design; empty without a limit."""
    limits = {} if material is None else material.limits
    return min(limits, key=lambda name: single(limits[name]), default="")


def _has_section(link: PlacedLink) -> bool:
    """Whether the section is known to beam theory and the whole wrench to the model (locked degrees of freedom hide constraint forces)."""
    return not isinstance(link.part, Restricted) and has_section(link.part)


def _groups(links: list[PlacedLink]) -> list[list[int]]:
    """Indices of links with the same part and material."""
    groups: dict[tuple[int, int], list[int]] = {}
    for index, link in enumerate(links):
        groups.setdefault((id(link.part), id(link.material)), []).append(index)
    return list(groups.values())


_Row: TypeAlias = tuple[Array, Array, Array, Array, Array, Array]


def _rows(links: list[PlacedLink], wrenches: Array, points: Array) -> list[_Row]:
    """Nominal and peak stress, yield stress, strokes, least limit and wrench of links at their worst corners, grouped by part."""
    rows: dict[int, _Row] = {}
    for members in _groups(links):
        first = links[members[0]]
        own = np.moveaxis(wrenches[..., members, :], -2, 0)
        peaks = _stress(_real(first.part), first, np.real(own))[1]
        where = index_of_largest(np.moveaxis(peaks, 1, -1))[:, None]
        worst = np.take_along_axis(np.broadcast_to(own, (*peaks.shape, 6)), where[..., None], axis=1)
        nominal, peak = _stress(first.part, first, worst)  # complex-step derivatives are needed only at the worst corner
        for place, index in enumerate(members):
            strokes = np.take_along_axis(np.broadcast_to(points, (*peaks.shape[1:], points.shape[-1])), where[place][..., None], axis=0)[0]
            limits = (_limit(links[index], name, peak[place, 0]) for name in ("yield_stress", "limit"))
            rows[index] = nominal[place, 0], peak[place, 0], next(limits), strokes, next(limits), worst[place, 0]
    return [rows[index] for index in range(len(links))]


def _stress(part: Part, link: PlacedLink, wrenches: Array) -> tuple[Array, Array]:
    """Nominal and peak stress of a part under wrenches (..., 6)."""
    result = stress(part, link.material, wrenches)
    assert result is not None  # noqa: S101  _has_section has asked
    return result.nominal, np.broadcast_to(result.peak, result.nominal.shape)


def _limit(link: PlacedLink, name: str, peak: Array) -> Array:
    limit = None if link.material is None else getattr(link.material, name)
    own = np.asarray(np.nan if limit is None else limit)
    return np.broadcast_to(own, np.broadcast_shapes(own.shape, peak.shape))


def _real(part: Any) -> Any:
    """A part with the real parts of its numbers."""
    changed = {field.name: getattr(part, field.name) for field in fields(part)}
    return replace(part, **{name: _real(value) if is_dataclass(value) else _real_number(value) for name, value in changed.items()})


def _real_number(value: Any) -> Any:
    if isinstance(value, tuple):
        return tuple(_real_number(each) for each in value)
    return np.real(value) if isinstance(value, np.ndarray) and np.iscomplexobj(value) else value
