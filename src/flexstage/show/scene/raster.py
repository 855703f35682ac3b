"""Rasterisation with a depth buffer: the nearest triangle at each pixel, and visible lines."""

from __future__ import annotations

import numpy as np

from flexstage.base.number import Array

_BIAS = 1.0
"""A line is visible up to this distance behind the farthest pixel around it [pixels]."""


def nearest(corners: Array, shape: tuple[int, int]) -> tuple[Array, Array]:
    """Find the nearest triangle at the middle of each pixel. Returns the triangle numbers (-1: none) and depths of all pixels (`shape`).

    `corners` (t, 3, 3) are in pixels to the right, down, and towards the viewer. A triangle without projected area is not visible.

    >>> far = np.array([[0.0, 0.0, 0.0], [8.0, 0.0, 0.0], [0.0, 8.0, 0.0]])
    >>> nearest(np.stack([far, 0.5 * far + [0.0, 0.0, 1.0]]), (1, 5))[0].tolist()
    [[1, 1, 1, 0, 0]]
    """
    height, width = shape
    plane = planes(corners, corners[..., 2])
    low, high = corners[..., 1].min(axis=1), corners[..., 1].max(axis=1)
    face, row = _runs(low, high, height)
    start, end = corners[face], np.roll(corners[face], -1, axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        share = (row[:, None] + 0.5 - start[..., 1]) / (end[..., 1] - start[..., 1])
        crossing = np.where((share >= 0.0) & (share <= 1.0), start[..., 0] + share * (end[..., 0] - start[..., 0]), np.nan)
    left, right = np.fmin.reduce(crossing, axis=1), np.fmax.reduce(crossing, axis=1)
    span, column = _runs(np.nan_to_num(left), np.nan_to_num(right, nan=-1.0), width)
    across, down, level = plane[face].T
    depth = ((level + down * (row + 0.5)).astype(np.float32))[span] + across.astype(np.float32)[span] * (
        column.astype(np.float32) + np.float32(0.5)
    )
    pixel = row[span] * width + column
    buffer = np.full(height * width, -np.inf, dtype=np.float32)
    np.maximum.at(buffer, pixel, depth)
    visible = depth == buffer[pixel]
    found = np.full(height * width, -1, dtype=np.int32)
    found[pixel[visible]] = face[span[visible]]
    return found.reshape(shape), buffer.reshape(shape)


def normals(corners: Array) -> Array:
    """Compute the outward unit normals (t, 3) of triangles; zero for triangles without area.

    `corners` (t, 3, 3) are in pixels to the right, down and towards the viewer; the normals point right, up and towards the viewer.

    >>> normals(np.array([[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, -1.0, 0.0]]]))[0, 2]
    np.float64(1.0)
    """
    sides = (corners[:, 1:] - corners[:, :1]) * np.array([1.0, -1.0, 1.0])
    normal = np.cross(sides[:, 0], sides[:, 1])
    return normal / np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), np.finfo(float).tiny)


def planes(corners: Array, values: Array) -> Array:
    """Interpolate the corner values (t, 3) of triangles linearly. Triangles without area have coefficients of zero.

    Returns the coefficients (t, 3) of each triangle: the change of the value per pixel to the right, the change per pixel down, and the
    value at pixel coordinates 0.

    >>> planes(np.array([[[0.0, 0.0], [2.0, 0.0], [0.0, 2.0]]]), np.array([[1.0, 3.0, 5.0]])).tolist()
    [[1.0, 2.0, 1.0]]
    """
    (x, y), value = (corners[:, 1:, :2] - corners[:, :1, :2]).transpose(2, 1, 0), (values[:, 1:] - values[:, :1]).T
    area = x[0] * y[1] - x[1] * y[0]
    scale = np.divide(1.0, area, out=np.zeros_like(area), where=np.abs(area) > 1e-9)
    across, down = scale * (value[0] * y[1] - value[1] * y[0]), scale * (x[0] * value[1] - x[1] * value[0])
    return np.stack([across, down, values[:, 0] - across * corners[:, 0, 0] - down * corners[:, 0, 1]], axis=1)


def visible_lines(ends: Array, depth: Array) -> Array:
    """Find the visible pixels (h, w) of lines between `ends` (e, 2, 3) [pixels]. `depth` (h, w) is the depth of triangles that hide lines.

    >>> visible_lines(np.array([[[0.5, 0.5, 1.0], [3.5, 0.5, 1.0]]]), np.array([[0.0, 9.0, 9.0, 9.0]])).tolist()
    [[True, True, False, False]]
    """
    height, width = depth.shape
    steps = np.ceil(np.abs(ends[:, 1, :2] - ends[:, 0, :2]).max(axis=1)).astype(int) + 1
    own, step = _ranges(np.zeros(len(ends), dtype=int), steps)
    places = ends[own, 0] + (step / np.maximum(steps[own] - 1, 1))[:, None] * (ends[own, 1] - ends[own, 0])
    column, row = places[:, :2].astype(int).T
    inside = (row >= 0) & (row < height) & (column >= 0) & (column < width)
    row, column, level = row[inside], column[inside], places[inside, 2]
    padded = np.pad(depth, 1, constant_values=np.inf)
    around = np.min([padded[row + down, column + across] for down in range(3) for across in range(3)], axis=0)
    drawn = np.zeros(depth.shape, dtype=bool)
    drawn[row, column] = level >= around - _BIAS
    return drawn


def _runs(low: Array, high: Array, count: int) -> tuple[Array, Array]:
    """The pixels of lines with this count whose middles are in [`low`, `high`): index of the line, and of the pixel."""
    first, last = (np.clip(np.ceil(each - 0.5), 0, count).astype(np.int32) for each in (low, high))
    return _ranges(first, np.maximum(last - first, 0))


def _ranges(first: Array, counts: Array) -> tuple[Array, Array]:
    """Consecutive numbers from `first`, `counts` of each: index of the range, and the number."""
    own = np.repeat(np.arange(len(counts), dtype=np.int32), counts)
    return own, (first - np.cumsum(counts) + counts)[own] + np.arange(len(own), dtype=np.int32)
