"""Data of the viewer for a stage, as an object and as JSON with base64 arrays, for pages, notebooks and the studio."""

from __future__ import annotations

import base64
import json
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, TypeVar

import numpy as np

from flexstage.analysis.complete import platform_modes
from flexstage.analysis.dynamics.modes import Modes
from flexstage.base.finding import DesignError, name_first
from flexstage.base.number import Array
from flexstage.mechanism.assembly.expand import Assembly, expand
from flexstage.mechanism.mechanism import GROUND, PLATFORM, Mechanism
from flexstage.mechanism.store.lines import line_numbers
from flexstage.models.ideal import ideal
from flexstage.models.linear.kinematics import Kinematics
from flexstage.models.linear.model import LinearModel
from flexstage.models.lumped import lumped
from flexstage.show.scene.primitives import simplification
from flexstage.show.scene.skin import Kind
from flexstage.show.scene.stage import Label, scene
from flexstage.show.viewer.bend import Bend, bend_of
from flexstage.show.viewer.mesh import Mesh, mesh_of
from flexstage.show.viewer.motions import (
    Curve,
    Motion,
    PathMotion,
    Response,
    Skeleton,
    axis_motions,
    deflections,
    drift_motions,
    mode_motions,
    stroke_motions,
)
from flexstage.show.viewer.parts import Describer, DrawnEntry

FORMAT = 1
_Found = TypeVar("_Found")
_STEPS, _PIECES = 12, 1800
"""Number of segments of a bent link, and their largest total number."""
_MODES = 12
_LOADED = ", small motions about the loaded stage"


@dataclass(frozen=True, eq=False)
class StageData:
    """Data of a viewer for a stage: its mesh, its parts by number, and its motions.

    `bodies` are the names of the bodies in the order of twists, the ground first. `size` [m] is the diagonal of the bounding box of the
    mesh, and `centre` (3,) [m] is the middle of the box. `bones` are the bodies with their reference points. `things` are the drawn parts.
    `notes` list the simplifications of the picture with reasons.
    """

    name: str
    size: float
    centre: Array
    bodies: tuple[str, ...]
    bones: Skeleton
    things: tuple[DrawnEntry, ...]
    labels: tuple[Label, ...]
    mesh: Mesh
    motions: tuple[Motion, ...]
    notes: tuple[str, ...]

    @cached_property
    def links(self) -> tuple[int, ...]:
        """Numbers of hinges and actuators among the drawn parts, in the sequence of a motion's strain energies."""
        return tuple(number for number, thing in enumerate(self.things) if thing.kind in {Kind.HINGE, Kind.DRIVE})

    def reach(self, motion: Motion) -> float:
        """Return a motion's largest displacement [m]: of any vertex or, in a motion with a `course`, of any reference point or node."""
        if motion.course is not None:
            return motion.course.reach
        moved = self.mesh.displacement(motion.twists)
        return float(np.sqrt(np.max(np.sum(moved**2, axis=1), initial=0.0)))

    def document(self) -> dict[str, Any]:
        """Convert to plain values, named as in the page's program (`web/src/viewer/types.ts`)."""
        return {
            "format": FORMAT,
            "name": self.name,
            "size": self.size,
            "centre": self.centre.tolist(),
            "bodies": list(self.bodies),
            "platform": self.bodies.index(PLATFORM) if PLATFORM in self.bodies else 0,
            "reference": self.bones.references.get(PLATFORM, np.zeros(3)).tolist(),
            "references": [self.bones.references.get(name, np.zeros(3)).tolist() for name in self.bodies],
            "parts": [_part(thing) for thing in self.things],
            "labels": [self._label(each) for each in self.labels],
            "links": list(self.links),
            "mesh": _mesh(self.mesh),
            "motions": [self.motion_document(each) for each in self.motions],
            "notes": list(self.notes),
        }

    def text(self) -> str:
        """Convert the document to JSON. Equal stages give identical text."""
        return json.dumps(self.document(), separators=(",", ":"), allow_nan=False)

    def _label(self, label: Label) -> dict[str, Any]:
        bodies = [self.bodies.index(name) for name in label.bodies]
        return {"text": label.text, "kind": label.kind.value, "point": list(label.point), "bodies": bodies}

    def motion_document(self, motion: Motion) -> dict[str, Any]:
        """Convert a motion of this stage to plain values, as in the document."""
        return _known(
            {
                "group": motion.group.value,
                "name": motion.name,
                "label": motion.label,
                "frequency": motion.frequency,
                "remark": motion.remark or None,
                "twists": packed(motion.twists, "<f4"),
                "reach": float(f"{self.reach(motion):.6g}"),
                "scaled": motion.frequency is None,
                "energy": self._by_link(motion.energy),
                "stress": self._by_link(motion.stress),
                "stressed": None if motion.stress is None else motion.stressed,
                "course": motion.course and _course(motion.course),
                "response": motion.response and _response(motion.response),
            }
        )

    def _by_link(self, known: Mapping[str, float] | None) -> str | None:
        return None if known is None else packed([known.get(self.things[number].name, np.nan) for number in self.links], "<f4")


def _known(document: dict[str, Any]) -> dict[str, Any]:
    """The entries of a document that are known."""
    return {key: value for key, value in document.items() if value is not None}


def stage_data(
    mechanism: Mechanism,
    *,
    model: LinearModel | None = None,
    weighed: LinearModel | None = None,
    kinematics: Kinematics | None = None,
    found: Modes | None = None,
    text: str = "",
    count: int = _MODES,
    still: StageData | None = None,
) -> StageData:
    """Compute the data of a viewer for a stage (first design of a batch), with motions.

    The lumped `model`, the ideal `kinematics`, the modes `found` and the data `still` without motions are computed unless specified.
    Motions that cannot be computed are left out, with the reason in the notes. `weighed` is the model for the modes of the loaded stage.
    `text` is the text of the design file, in which the line numbers of parts are found. `count` is the number of lowest modes shown;
    platform modes are always included. Raises `DesignError` if the stage cannot be drawn.
    """
    still = still or still_data(mechanism, text=text)
    notes, motions, bones = list(still.notes), list[Motion](), still.bones
    model = model or _attempt("modes, strokes and deflections", lambda: lumped(mechanism), notes)
    kinematics = kinematics or _attempt("ideal motions", lambda: ideal(mechanism), notes)
    if model is not None:
        moving, about = weighed or model, "" if weighed is None or weighed is model else _LOADED
        found = found or _attempt("modes", lambda: platform_modes(mechanism, moving), notes)
        motions += [] if found is None else mode_motions(moving, kinematics, found, bones, count, about=about)
        motions += _attempt("strokes", lambda: list(stroke_motions(mechanism, model, kinematics, bones)), notes) or []
    if kinematics is not None:
        motions += axis_motions(kinematics, bones)
    if model is not None:
        motions += _attempt("deflections", lambda: list(deflections(mechanism, model, kinematics, bones)), notes) or []
        motions += _attempt("drift", lambda: list(drift_motions(mechanism, model, bones)), notes) or []
    return replace(still, motions=tuple(motions), notes=tuple(notes))


def still_data(mechanism: Mechanism, *, text: str = "") -> StageData:
    """Compute the data of a viewer for a stage (first design of a batch) without motions. No model is needed."""
    assembly = expand(mechanism)
    steps = max(1, min(_STEPS, _PIECES // max(1, len(assembly.links))))
    seen = scene(mechanism, steps=steps)
    bodies, shown = (GROUND, *assembly.bodies), {piece.name: piece for piece in seen.pieces}
    describer = Describer(mechanism, assembly, line_numbers(text))
    numbers = {name: number for number, name in enumerate(bodies)}
    things = tuple(describer.thing(name, each.kind, *(numbers[body] for body in each.bodies)) for name, each in shown.items())
    mesh = mesh_of(seen.pieces, numbers, {name: number for number, name in enumerate(shown)}, _bends(assembly), bend_of(None))
    low, high = (mesh.points.min(axis=0), mesh.points.max(axis=0)) if len(mesh.points) else (np.zeros(3), np.zeros(3))
    size, middle = float(np.sqrt(np.sum((high - low) ** 2))) or seen.size, 0.5 * (low + high)
    coarse = f"each of the {len(assembly.links)} links is drawn with {steps} segment{'s' if steps > 1 else ''} when bent"
    notes = (*([coarse] if steps < _STEPS else []), *_simplifications(assembly))
    return StageData(mechanism.name or "stage", size, middle, bodies, Skeleton(seen.references), things, seen.labels, mesh, (), notes)


def _simplifications(assembly: Assembly) -> Iterator[str]:
    """Simplified outlines: holes cut by other outlines, and outlines from a CAD file."""
    solids = {name: each for body in assembly.bodies.values() for name, each in body.solids.items()} | dict(assembly.ground)
    found = {name: simplification(placed.solid) for name, placed in solids.items()}
    for said in dict.fromkeys(filter(None, found.values())):
        names = [name for name, each in found.items() if each == said]
        yield f"drawn {said}: {name_first(names)}"


def _bends(assembly: Assembly) -> Mapping[str, Bend]:
    """Bends of links with a shape of their own, by name; one value for all links of one part."""
    kinds = {id(link.part): link.part for link in assembly.links.values()}
    known = {key: bend_of(part) for key, part in kinds.items()}
    return {name: known[id(link.part)] for name, link in assembly.links.items()}


def _attempt(what: str, work: Callable[[], _Found], notes: list[str]) -> _Found | None:
    """The result, or for a refused stage `None` and the reasons among the notes."""
    try:
        return work()
    except DesignError as error:
        notes += [f"no {what}: {finding}" for finding in error.findings]
        return None


def _part(thing: DrawnEntry) -> dict[str, Any]:
    return _known(vars(thing) | {"kind": thing.kind.value, "unit": thing.unit or None})


def _mesh(mesh: Mesh) -> dict[str, Any]:
    wide = "<u4" if len(mesh.points) > 0xFFFF else "<u2"
    return {
        "points": packed(mesh.points, "<f4"),
        "part": packed(mesh.part, "<u2"),
        "carrier": packed(mesh.carrier, "<u2"),
        "station": packed(mesh.station, "<u2"),
        "carriers": packed(mesh.bodies, "<u2"),
        "ends": packed(mesh.ends, "<f4"),
        "stations": packed(mesh.stations, "<f4"),
        "indices": "u4" if wide == "<u4" else "u2",
        "triangles": packed(mesh.triangles, wide),
        "edges": packed(mesh.edges, wide),
    }


def _course(course: PathMotion) -> dict[str, Any]:
    return _known(
        {
            "points": len(course.said),
            "frames": course.frames.tolist(),
            "poses": packed(course.poses, "<f4"),
            "shape": None if course.shape is None else packed(course.shape, "<f4"),
            "curves": _curves(course.curves),
            "beyond": course.beyond,
            "said": course.said,
        }
    )


def _response(response: Response) -> dict[str, Any]:
    return {
        "basis": packed(response.basis, "<f4"),
        "weights": packed(response.weights, "<f4"),
        "curves": _curves(response.curves),
        "points": len(response.weights),
    }


def _curves(curves: Iterable[Curve]) -> list[dict[str, str]]:
    return [{"name": each.name, "unit": each.unit, "values": packed(each.values, "<f4")} for each in curves]


def packed(values: Array | Sequence[float], form: str) -> str:
    """Encode values in base64, in a numpy format such as `<f4`.

    >>> packed([1.0], "<f4")
    'AACAPw=='
    """
    return base64.b64encode(np.ascontiguousarray(values).astype(form).tobytes()).decode("ascii")
