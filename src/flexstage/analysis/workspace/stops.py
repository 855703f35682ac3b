"""Stops as limits of strokes: the gap of a stop is treated as a stroke, and the motion at the stop per ideal motion as a row of R_a."""

from __future__ import annotations

import numpy as np

from flexstage.analysis.workspace.stroke import SingleAxis, StrokeLimits, mapping_at, single_axis, stroke_limits
from flexstage.base.labelled import Matrix, ratio_units
from flexstage.base.number import join, stack
from flexstage.mechanism.assembly.expand import expand
from flexstage.mechanism.assembly.incidence import layout, twist_at
from flexstage.mechanism.mechanism import PLATFORM, Mechanism
from flexstage.models.linear.channels import see
from flexstage.models.linear.kinematics import Kinematics
from flexstage.spatial.frame import MOTION

STOPS = "stops"
"""Prefix of stop names in lists of limits: `stops/end`."""


def single_strokes(mechanism: Mechanism, kinematics: Kinematics) -> SingleAxis:
    """Compute ideal single-axis strokes of the platform, limited by actuators and stops.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.ideal import ideal
    >>> single_strokes(double_triangle(), ideal(double_triangle())).limiting[2]
    'B4'
    """
    mapping, limits = with_stops(mechanism, kinematics, kinematics.mapping, stroke_limits(mechanism))
    return single_axis(mapping, limits, provenance=kinematics.provenance)


def with_stops(
    mechanism: Mechanism, kinematics: Kinematics, mapping: Matrix, limits: StrokeLimits, point: str = PLATFORM
) -> tuple[Matrix, StrokeLimits]:
    """Return mapping and limits with an additional row for every stop within reach: low <= n^T x <= high.

    Here the row n^T maps the ideal motions x to the motion at the stop. The coordinates of `mapping` are motions of `point`. A stop is
    omitted if no combination of strokes can reach it. A missing low limit of a stop is replaced by a finite limit out of reach. Bodies
    between ground and platform move as in the ideal model (small motions).

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.ideal import ideal
    >>> stage = double_triangle()
    >>> with_stops(stage, ideal(stage), ideal(stage).mapping, stroke_limits(stage))[0].rows
    ('B1', 'B2', 'B3', 'B4', 'B5', 'B6')
    """
    stops = expand(mechanism).stops
    if not stops:
        return mapping, limits
    rows = mapping_at(mechanism, kinematics, point, mapping=_closing(mechanism, kinematics, mapping.columns)).values
    low, high = (stack([getattr(item, side) for item in stops.values()]) for side in ("low", "high"))
    gains = np.real(rows) @ np.linalg.pinv(np.real(mapping.values))  # an upper bound for redundant strokes
    least, largest = map(np.real, limits.swing(gains))
    met = np.any(np.atleast_2d((np.real(low) > least) | (np.real(high) < largest)).reshape(-1, len(stops)), axis=0)
    if not np.any(met):
        return mapping, limits
    names = tuple(f"{STOPS}/{name}" for name, kept in zip(stops, met.tolist(), strict=True) if kept)
    low = np.where(np.isinf(low), 2.0 * least - largest, low)
    units = ratio_units(("m",) * (len(mapping.rows) + len(names)), tuple(map(MOTION.unit, mapping.columns)))
    values = join([mapping.values, rows[..., met, :]])
    ends = (join([strokes[..., None], gaps[..., met, None]])[..., 0] for strokes, gaps in ((limits.low, low), (limits.high, high)))
    return Matrix(values, mapping.rows + names, mapping.columns, units), StrokeLimits(limits.actuators + names, *np.broadcast_arrays(*ends))


def _closing(mechanism: Mechanism, kinematics: Kinematics, columns: tuple[str, ...]) -> Matrix:
    """Motion at each stop per ideal motion of the platform."""
    assembly = expand(mechanism)
    order = layout(assembly)
    seen = [
        see(stop.sight, lambda body, frame: twist_at(assembly, order, body, frame)) @ kinematics.bodies for stop in assembly.stops.values()
    ]
    names = tuple(f"{STOPS}/{name}" for name in assembly.stops)
    units = ratio_units(("m",) * len(names), tuple(map(MOTION.unit, columns)))
    return Matrix(join(seen), names, columns, units)
