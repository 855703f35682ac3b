"""Where strained flexures leave what the theory of large displacements holds for."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from flexstage.base.finding import Finding
from flexstage.models.nonlinear.strain import Strains

_STRAIN, _CURVING = 0.02, 40.0
"""The largest strain that a linear law is physics for, and the largest b^2 k / t that two shapes across a leaf's width suffice for."""


def strain_cautions(strained: Strains) -> Iterator[Finding]:
    """Flexures whose strain, stress or curving is beyond the theory in any case; of many that are alike each is told.

    >>> none = np.zeros((1, 1))
    >>> [str(each.where) for each in strain_cautions(Strains(("leaf",), none + 0.03, none, none, np.array([np.nan])))]
    ['leaf']
    """
    largest, curving, stress = (np.nan_to_num(each) for each in (strained.largest, strained.curving, strained.stress))
    for name, most in zip(strained.names, _most(largest), strict=True):
        if most > _STRAIN:
            what = f"its strain reaches {most:.2%}, beyond which no linear elastic law is physics"
            yield Finding(name, what, "Ask for less stroke, or make it longer or thinner")
    for name, most, limit in zip(strained.names, _most(stress), strained.limit, strict=True):
        if most > limit:
            what = f"its stress reaches {most / 1e6:.4g} MPa, its material's limit is {limit / 1e6:.4g} MPa"
            yield Finding(name, what, "Ask for less stroke, make it longer or thinner, or take a stronger material")
    for name, most in zip(strained.names, _most(curving), strict=True):
        if most > _CURVING:
            what = f"b^2 k / t reaches {most:.3g}, above {_CURVING:g}: two shapes across its width do not suffice"
            yield Finding(name, what, "Count on an error of some tenths of a per cent in bending")


def _most(values: np.ndarray) -> np.ndarray:
    """The largest (l,) of all cases (..., l)."""
    return np.max(values.reshape(-1, values.shape[-1]), axis=0, initial=0.0)
