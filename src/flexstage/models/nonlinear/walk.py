"""Body poses of large stages, computed from the flexures along a spanning tree from the ground, without gaps between links.

A solution step rotates bodies by finite rotations, but displaces them to first order. Along a chain of many links, this difference opens a
gap at every link, which causes wrong restoring forces. Positions are compensated sums along the tree (W. Kahan, Comm. ACM 8, 1965). Without
compensation, the equal rounding errors of equal links would add up to a force in all links.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, replace

import numpy as np

from flexstage.base.number import matvec
from flexstage.base.session import SESSION
from flexstage.models.nonlinear.elements.element import shape
from flexstage.models.nonlinear.graph import flexure_weight
from flexstage.models.nonlinear.stage import Nonlinear
from flexstage.models.nonlinear.state import Loads, Pose


@dataclass(frozen=True)
class Step:
    """Step of the tree: a flexure (`group` and number `link`), the body at its outer end, and whether its start is nearer to the ground."""

    group: int
    link: int
    body: int
    start: bool


@SESSION.keep(16)
def tree(model: Nonlinear) -> tuple[Step, ...]:
    """Return the flexures of a spanning tree from the ground, nearest first. Bodies that no flexure connects to the tree are not included.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.models.nonlinear.stage import nonlinear
    >>> [step.body for step in tree(nonlinear(parallelogram()))]
    [0, 1, 2]
    """
    reached, ground = {len(model.bodies)}, len(model.bodies)
    joins: dict[int, list[tuple[int, Step]]] = {}
    for number, group in enumerate(model.flexures):
        for link, (one, other) in enumerate(zip(group.first.tolist(), group.second.tolist(), strict=True)):
            joins.setdefault(one, []).append((other, Step(number, link, other, start=True)))
            joins.setdefault(other, []).append((one, Step(number, link, one, start=False)))
    steps, waiting = [], deque([ground])
    while waiting:
        for other, step in joins.get(waiting.popleft(), ()):
            if other not in reached:
                reached.add(other)
                waiting.append(other)
                steps.append(step)
    return tuple(steps)


def walk_tree(model: Nonlinear, pose: Pose, loads: Loads) -> Pose:
    """Return the pose in which each body of the tree is at the end of its flexure, computed from the flexure's amplitudes and forces."""
    ends, turns = [], []
    for number, group in enumerate(model.flexures):
        frame = np.moveaxis(pose.turn[:, group.first], 1, 0) @ group.turn[:, None]
        weight = flexure_weight(group.law, frame, loads)
        lies = shape(group.law, pose.strain[number], pose.wrench[number][..., :3], weight)
        ends.append(group.law.length[:, None, None] * lies.end)
        turns.append(lies.end_turn)
    position, turn, rounded = np.array(pose.position), np.array(pose.turn), np.zeros_like(pose.position)
    for step in tree(model):
        group, link = model.flexures[step.group], step.link
        one, other, own = group.first[link], group.second[link], group.turn[link]
        along, across = ends[step.group][link], own @ turns[step.group][link] @ own.T
        near, far = (one, other) if step.start else (other, one)
        turn[:, far] = turn[:, near] @ (across if step.start else across.mT)
        reach = matvec(turn[:, one], group.arm_first[link] + along @ own.T) - matvec(turn[:, other], group.arm_second[link])
        moved = rounded[:, near] + (reach if step.start else -reach)
        position[:, far] = position[:, near] + moved
        rounded[:, far] = moved - (position[:, far] - position[:, near])
    return replace(pose, position=position, turn=turn)
