"""Surfaces: displacement and stress at the skins of all components, for coordinates of the stage's linear model."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from flexstage.base.number import Array
from flexstage.solid.fea.solver.assemble import Placed
from flexstage.solid.fea.solver.component import groups


def element_coordinates(item: Placed, motion: Array, strokes: Mapping[str, Array]) -> Array:
    """Compute the coordinates (n, k) of a component that cause stress, from the model's `motion` (N, k) and the stacks' `strokes` (k,) [m].

    A freely expanding stack has no stress; therefore its free stroke is subtracted.

    >>> from types import SimpleNamespace as Of
    >>> copy = Of(element=Of(free_strokes={"B/pzt": np.array([1.0])}), operator=np.array([[2.0]]))
    >>> element_coordinates(copy, np.array([[3.0]]), {"B/pzt": np.array([5.0])}).tolist()  # 2 x 3 - 5
    [[1.0]]
    """
    own = item.operator @ motion
    for name, free in item.element.free_strokes.items():
        if name in strokes:
            own = own - free[:, None] * strokes[name]
    return own


def stresses(item: Placed, coordinates: Array) -> Array:
    """Compute the stress (v, 6, k) as xx, yy, zz, xy, yz, zx [Pa] at the vertices of a component's skin, in its own axes.

    >>> from types import SimpleNamespace as Of
    >>> one = Of(element=Of(skin=Of(stress=np.ones((1, 6, 2)))))
    >>> stresses(one, np.array([[2.0], [3.0]]))[0, :, 0].tolist()
    [5.0, 5.0, 5.0, 5.0, 5.0, 5.0]
    """
    skin = item.element.skin.stress
    return (skin.reshape(-1, skin.shape[-1]) @ coordinates).reshape(len(skin), 6, -1)


def von_mises(stress: Array) -> Array:
    """Compute the von Mises stress (...) from the stress components (..., 6): xx, yy, zz, xy, yz, zx.

    >>> von_mises(np.array([[2.0, 0, 0, 0, 0, 0], [0, 0, 0, 1.0, 0, 0]])).round(9).tolist()
    [2.0, 1.732050808]
    """
    x, y, z, xy, yz, zx = np.moveaxis(np.asarray(stress, dtype=float), -1, 0)
    return np.sqrt(0.5 * ((x - y) ** 2 + (y - z) ** 2 + (z - x) ** 2) + 3.0 * (xy**2 + yz**2 + zx**2))


def vertex_places(item: Placed, motion: Array, factor: float) -> Array:
    """Compute positions (v, 3) [m] of a component's skin in the stage's frame, displaced by `factor` times the motion of coordinates (N,).

    >>> from types import SimpleNamespace as Of
    >>> from flexstage.spatial.frame import identity
    >>> skin = Of(vertices=np.zeros((1, 3)), motion=np.array([[[1.0], [0.0], [0.0]]]))
    >>> item = Of(element=Of(skin=skin), operator=np.eye(1), component=Of(place=identity()))
    >>> vertex_places(item, np.array([0.5]), 2.0).tolist()
    [[1.0, 0.0, 0.0]]
    """
    skin = item.element.skin
    own = item.operator @ motion
    shift = (skin.motion.reshape(-1, skin.motion.shape[-1]) @ own).reshape(-1, 3)
    return np.asarray(item.component.place.point(skin.vertices + factor * shift))


def piece_vertices(item: Placed) -> Iterator[tuple[str, Array]]:
    """List the links and bodies of a component with the vertices (indices) of their skin. The names are those of this instance of the unit.

    >>> from types import SimpleNamespace as Of
    >>> skin = Of(triangles=np.array([[0, 1, 2], [2, 1, 3]]), owner=np.array([0, 1]))
    >>> pieces = (Of(owner="B/tip"), Of(owner="B/front"))
    >>> [(name, at.tolist()) for name, at in piece_vertices(Of(element=Of(skin=skin), component=Of(pieces=pieces)))]
    [('B/tip', [0, 1, 2]), ('B/front', [1, 2, 3])]
    """
    skin = item.element.skin
    for name, numbers in groups(item.component).items():
        yield name, np.unique(skin.triangles[np.isin(skin.owner, numbers)])
