"""How far flexures are strained at a state, and how much their sections curve (docs/nonlinear.md, 28)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexstage.base.number import Array
from flexstage.models.nonlinear.element import shape
from flexstage.models.nonlinear.equilibrium import State


@dataclass(frozen=True, eq=False)
class Strains:
    """Of every flexure by name: the largest strain along it (..., l), and b^2 k / t of its strongest bending (..., l)."""

    names: tuple[str, ...]
    largest: Array
    curving: Array


def strains(state: State) -> Strains:
    """Strains at the ends and the points of every flexure, of its thinnest section where that varies.

    |N| / E A + |k_z| t / 2 + |k_y| b / 2 + k_x^2 b^2 / 12, the most each section can have at an edge of its surface. A leaf's section at a
    clamped end has 1 / (1 - nu^2) times the stress of a beam of that strain.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.models.nonlinear.equilibrium import equilibrium
    >>> from flexstage.models.nonlinear.stage import nonlinear
    >>> found = strains(equilibrium(nonlinear(parallelogram()), {"platform.fx": 100.0}, weight=0.0))
    >>> found.names[:2], bool(found.largest[0] > 1e-5)
    (('left', 'right'), True)
    """
    names: list[str] = []
    largest: list[Array] = []
    curving: list[Array] = []
    for number, group in enumerate(state.model.flexures):
        law = group.law
        lies = shape(law, state.pose.strain[number], state.pose.wrench[number][..., :3])
        bent = np.abs(np.concatenate([lies.curvature, lies.rule.ends @ lies.curvature], axis=-2)) / law.length[:, None, None, None]
        half, wide = law.half[:, None, None, 0], law.half[:, None, None, 1]
        pulled = np.max(np.abs(lies.tension) * law.compliance[:, None, :, 0], axis=-1)
        bending = bent[..., 2] * half + bent[..., 1] * wide + bent[..., 0] ** 2 * wide**2 / 3.0
        names += group.names
        largest += list(pulled + np.max(bending, axis=-1))
        curving += list(2.0 * law.half[:, None, 1] ** 2 / law.half[:, None, 0] * np.max(bent[..., 2], axis=-1))
    known = np.where(state.converged, 1.0, np.nan)[..., None]
    both = (known * np.moveaxis(np.array(each), 0, -1).reshape(*state.shape, len(names)) for each in (largest, curving))
    return Strains(tuple(names), *both)
