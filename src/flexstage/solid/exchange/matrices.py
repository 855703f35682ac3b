"""Export of one solid of a stage as a superelement with reduced matrices, for theory and other programs."""

from __future__ import annotations

import os
from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np

from flexstage.base.arguments import check_arguments
from flexstage.base.finding import refuse, suggest_nearest
from flexstage.base.processes.progress import Progress
from flexstage.base.storage.store import atomic_write
from flexstage.mechanism.drawn import with_drawn_parts
from flexstage.mechanism.mechanism import Mechanism
from flexstage.parts.condensation import superelement
from flexstage.parts.superelement import FileUnits, Port, Superelement
from flexstage.solid.fea.geometry.sound import sound_components
from flexstage.solid.fea.jobs.cache import Cache
from flexstage.solid.fea.jobs.parts import Ways, reduce_parts
from flexstage.solid.fea.jobs.remote import Limits
from flexstage.solid.fea.meshing.fineness import Reduction
from flexstage.solid.fea.solver.component import Component, Interface, components

_CACHE, _STANDARD = Cache(), Reduction()


@check_arguments
def export_superelement(
    mechanism: Mechanism,
    name: str,
    path: str | os.PathLike[str],
    reduction: Reduction = _STANDARD,
    *,
    cache: Cache | None = _CACHE,
    progress: Progress | None = None,
    memory: float | None = None,
) -> Superelement:
    """Reduce one solid of a stage by finite elements, write its matrices to an NPZ file, and return the part that they define.

    The solid contains the body or link of this `name` and all parts of the same component (see `fea.solver.component`). The ports of the
    solid are end faces of links at which the solid meets the ground, rigid bodies, stacks or other units. The end faces remain plane. A
    port has the name of its link (`left`, or `left-platform` if both ends of the link are ports). The frame of a port is at the middle of
    the face. The axes of a port are those of the stage, of the unit that contains the solid, or of the link if the solid is a single link.

    Stiffness `K` and mass `M` are in SI units. The first coordinates of both matrices are the twists of the ports. The inner coordinates
    are the `reduction.modes` lowest modes with all ports fixed, and static responses that replace the omitted modes. The static responses
    are due to wrenches on the bodies and to the inertia forces of the ports' motions.

    Raises `DesignError` in the same cases as `model`, and if the name is unknown, the solid has fewer than two ports, or the solid contains
    a stack. The matrices cannot represent the stroke of a stack.
    """
    target = Path(path)
    if target.suffix != ".npz":
        raise refuse(str(path), "the matrix file must be an NPZ file", "Choose a name that ends in .npz")
    shape = with_drawn_parts(mechanism)
    whole = _free(_component(components(shape), name))
    sound_components(shape, cache)
    ((_, element),) = reduce_parts((whole,), replace(reduction, residual=True), Ways(cache, progress, Limits(memory=memory)))
    if element.strokes:
        raise refuse(name, "stiffness and mass cannot represent the stroke of a stack", "Export the bodies on both sides of the stack")
    with atomic_write(target) as place, place.open("wb") as stream:
        np.savez(stream, K=sum(element.stiffness.values()), M=sum(element.inertia.values()))
    return superelement(Superelement(FileUnits.SI, _ports(whole), file=str(target), source=f"flexstage, {reduction.modes} modes"))


def _component(parts: tuple[Component, ...], name: str) -> Component:
    """The component that contains a body or link."""
    held = {piece.owner: part for part in parts for piece in part.pieces}
    if name not in held:
        raise refuse(name, "unknown solid", suggest_nearest(name, held))
    return held[name]


def _free(part: Component) -> Component:
    """The component without neighbours, all its joints ports that remain plane."""
    joints = [item.joint for item in part.interfaces]
    if len(joints) + len(part.fixed) < 2:
        raise refuse(
            part.name, f"too few ports (got {len(joints) + len(part.fixed)}, expected 2 or more)", "Choose a solid that meets several links"
        )
    interfaces = (*(replace(item, yields=False) for item in part.interfaces), *(Interface(joint) for joint in part.fixed))
    return replace(part, interfaces=interfaces, fixed=())


def _ports(part: Component) -> dict[str, Port]:
    joints = [item.joint for item in part.interfaces]
    ends = Counter(joint.link for joint in joints)
    names = [joint.link if ends[joint.link] == 1 else f"{joint.link}-{joint.body}" for joint in joints]
    places = [tuple(float(each) for each in joint.frame.position) for joint in joints]
    rows = range(1, 6 * len(joints), 6)
    return {name.replace("/", "-"): Port(row, at=(x, y, z)) for name, row, (x, y, z) in zip(names, rows, places, strict=True)}
