"""Warnings for strains beyond the limits of the theory of large displacements."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from flexstage.base.finding import Finding
from flexstage.models.nonlinear.elements.hinge import deform, exerted
from flexstage.models.nonlinear.elements.strain import Strains
from flexstage.models.nonlinear.equilibrium import State
from flexstage.models.nonlinear.graph import hinge_ends
from flexstage.parts.contact import Contact
from flexstage.parts.part import inner

_STRAIN, _CURVING = 0.02, 40.0
"""Largest strain for linear elasticity, and largest b^2 k / t for two shape functions across a leaf's width."""


def strain_warnings(strained: Strains) -> Iterator[Finding]:
    """Return warnings for flexures whose strain, stress or curvature exceeds the limits of the theory in any load case.

    >>> none = np.zeros((1, 1))
    >>> [str(each.where) for each in strain_warnings(Strains(("leaf",), none + 0.03, none, none, np.array([np.nan])))]
    ['leaf']
    """
    largest, curving, stress = (np.nan_to_num(each) for each in (strained.largest, strained.curving, strained.stress))
    for name, most in zip(strained.names, _most(largest), strict=True):
        if most > _STRAIN:
            what = f"strain beyond linear elasticity (got {most:.2%}, expected {_STRAIN:.0%} or less)"
            yield Finding(name, what, "Reduce the stroke, or make the flexure longer or thinner")
    for name, most, limit in zip(strained.names, _most(stress), strained.limit, strict=True):
        if most > limit:
            what = f"stress above the material's limit (got {most / 1e6:.4g} MPa, expected {limit / 1e6:.4g} MPa or less)"
            yield Finding(name, what, "Reduce the stroke, make the flexure longer or thinner, or use a stronger material")
    for name, most in zip(strained.names, _most(curving), strict=True):
        if most > _CURVING:
            what = (
                "b^2 k / t (width b, curvature k, thickness t) too large for two shape functions across the width "
                f"(got {most:.3g}, expected {_CURVING:g} or less)"
            )
            yield Finding(name, what, "Expect a bending error of some tenths of a per cent")


def left_out(state: State) -> Iterator[Finding]:
    """Yield warnings for effects that the theory neglects: contacts that lift off, stops that are reached.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.models.nonlinear.equilibrium import equilibrium
    >>> from flexstage.models.nonlinear.stage import nonlinear
    >>> list(left_out(equilibrium(nonlinear(parallelogram()), {"platform.fx": 1.0})))
    []
    """
    yield from _lifted(state)
    yield from _stopped(state)


def _lifted(state: State) -> Iterator[Finding]:
    model, pose = state.model, state.pose
    hinges = model.hinges
    pressed = [place for place, name in enumerate(hinges.names) if isinstance(inner(model.assembly.links[name].part), Contact)]
    if not pressed:
        return
    deformation, _ = deform(hinges, hinge_ends(model, pose))
    force = exerted(hinges, deformation, state.loads.inputs, state.loads.constant, np.zeros(deformation.shape))
    known = state.converged.ravel()
    for place in pressed:
        least = float(np.min(-force[place, known, 0], initial=np.inf))
        if least <= 0.0:
            what = f"the ball lifts off (tension of {-least:.4g} N at its seat); the model ignores this"
            yield Finding(hinges.names[place], what, "Reduce the load or stroke, or increase the preload")


def _stopped(state: State) -> Iterator[Finding]:
    model, known = state.model, state.converged.ravel()
    for name, stop in model.assembly.stops.items():
        frame = stop.sight.frame
        place, axis = np.real(frame.position).reshape(-1, 3)[0], np.real(frame.rotation).reshape(-1, 3, 3)[0][:, 0]
        moved = [_moved(state, model.body(body), place) @ axis for body in (stop.sight.body, stop.sight.base)]
        gone = (moved[0] - moved[1])[known]
        low, high = float(np.min(gone, initial=np.inf)), float(np.max(gone, initial=-np.inf))
        if low < float(stop.low) or high > float(stop.high):
            what = f"the stop is exceeded: motion {_gap(low)} to {_gap(high)}, gaps {_gap(stop.low)} to {_gap(stop.high)}"
            yield Finding(name, what, "Reduce the stroke: the model for large displacements ignores stops")


def _gap(value: float | np.ndarray) -> str:
    return f"{float(value) * 1e3:.4g} mm"


def _moved(state: State, body: int, place: np.ndarray) -> np.ndarray:
    """Displacements (b, 3) of a point fixed to a body."""
    arm = place - state.model.reference[body]
    return state.pose.position[:, body] + state.pose.turn[:, body] @ arm - place


def _most(values: np.ndarray) -> np.ndarray:
    """Largest (l,) of all cases (..., l)."""
    return np.max(values, axis=tuple(range(values.ndim - 1)), initial=0.0)
