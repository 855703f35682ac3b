"""Seating of balls in their seats under weight, payloads and forces with zero strokes: lift-off, slip and onset of yield."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from flexstage.analysis.workspace.wrench import dead_wrenches
from flexstage.base.finding import Finding
from flexstage.base.number import Array, first_design, matvec, stack
from flexstage.mechanism.assembly.expand import expand
from flexstage.mechanism.mechanism import Mechanism
from flexstage.models.linear.model import LinearModel
from flexstage.models.linear.undetermined import require_known
from flexstage.parts.contact import Contact, Hertz, contact_stiffness, hertz
from flexstage.parts.material import Material
from flexstage.spatial.frame import FORCES

_ONSET = 1.6
"""Ratio of greatest pressure to yield stress at which a sphere begins to yield below its surface (Johnson 1985, chapter 6, nu = 0.3)."""
_RANK = 1e-9


@dataclass(frozen=True, eq=False)
class Seating:
    """Contact loads of a ball in its seat, at the worst contact.

    `left` (...) is the least normal force divided by the force due to the preload; the ball lifts off at zero. `slip` is the tangential
    force divided by the friction limit, NaN if no friction is specified. `pressure` is the largest contact pressure [Pa]. `crush` is
    `pressure` divided by the pressure at the onset of yield in the softer material, NaN if neither material has a yield stress.
    """

    left: Array
    slip: Array
    pressure: Array
    crush: Array


def seating(mechanism: Mechanism, model: LinearModel) -> dict[str, Seating]:
    """Compute the seating of each ball contact, by link, under the permanent load.

    The wrench of a link determines the motion of its ball, and thus the force of each contact. Motions without stiffness are excluded. The
    stiffness is linearised about the preload. A contact slips if the total tangential force exceeds the friction coefficient times the
    normal force (gross sliding).

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.lumped import lumped
    >>> seating(double_triangle(), lumped(double_triangle()))
    {}
    """
    links = {name: link for name, link in expand(mechanism).links.items() if isinstance(link.part, Contact)}
    if not links:
        return {}
    rows = tuple(f"{name}.{component}" for name in links for component in FORCES)
    require_known(model, rows)
    forces = np.real(dead_wrenches(mechanism, model, rows))
    wrenches = forces.reshape(*forces.shape[:-1], len(links), 6)
    result: dict[str, Seating] = {}
    for index, (name, link) in enumerate(links.items()):
        assert isinstance(link.part, Contact)  # noqa: S101  as asked above
        assert link.material is not None  # noqa: S101  a contact has one
        result[name] = seated(link.part, link.material, wrenches[..., index, :])
    return result


def seated(part: Contact, material: Material, wrench: Array) -> Seating:
    """Compute the seating of a ball under a `wrench` (..., 6) [N, N m] on the ball about its centre, in addition to the preload."""
    contacts = hertz(part, material)
    pressed, shifted = _contact_forces(part, material, contacts, wrench)
    left = np.min(pressed / np.real(contacts.force)[..., None], axis=-1)
    largest = np.maximum(np.max(pressed, axis=-1), 0.0)
    grip = np.real(np.asarray(np.nan if part.friction is None else part.friction))[..., None] * np.maximum(pressed, 0.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        slip = np.max(np.where(shifted > 0.0, shifted / grip, 0.0 * grip), axis=-1)
    pressure = 1.5 * np.cbrt(np.real(contacts.force) ** 2 * largest) / (np.pi * np.real(contacts.spot) ** 2)
    return Seating(left, slip, pressure, pressure / (_ONSET * _softer(material)))


def _contact_forces(part: Contact, material: Material, contacts: Hertz, wrench: Array) -> tuple[Array, Array]:
    """Normal force (..., c), compression positive, and magnitude of the tangential force of each contact."""
    scale = stack([*(3 * [1.0]), *(3 * [1.0 / np.real(np.asarray(part.radius))])])
    scaled = scale[..., :, None] * np.real(contact_stiffness(part, material)) * scale[..., None, :]
    moved = scale * matvec(np.linalg.pinv(scaled, rcond=_RANK, hermitian=True), scale * wrench)
    forces = (np.real(contacts.matrix) @ (np.real(contacts.motion) @ moved[..., None, :, None]))[..., 0]
    normals = np.real(contacts.normals)
    pull = np.sum(forces * normals, axis=-1)
    return np.real(contacts.force)[..., None] - pull, np.linalg.norm(forces - pull[..., None] * normals, axis=-1)


def _softer(material: Material) -> Array:
    """Lower yield stress of a pair; NaN if neither has one."""
    stated = [np.real(each.yield_stress) for each in (material, getattr(material, "counter", material)) if each.yield_stress is not None]
    return np.asarray(np.nan) if not stated else np.minimum(stated[0], stated[-1])


def seating_findings(found: Mapping[str, Seating]) -> Iterator[Finding]:
    """Yield warnings for balls that lift off, slip or yield, in the first design."""
    for name, each in found.items():
        left, slip, pressure, crush = (float(first_design(value, 0)) for value in (each.left, each.slip, each.pressure, each.crush))
        if left <= 0.0:
            what = f"the ball lifts off its seat: weight, payloads and forces unload it by {1.0 - left:.3g} times its preload"
            yield Finding(name, what, "Increase the preload, or describe the source of the preload: a spring, a magnet or weight")
        elif slip > 1.0:
            what = f"the ball slips: weight, payloads and forces give a tangential force of {slip:.3g} times the friction limit"
            yield Finding(name, what, "Increase the preload: the contact stiffness is valid only without slip")
        if crush > 1.0:
            what = f"the greatest pressure, {pressure / 1e6:.4g} MPa, is {crush:.3g} times the pressure at which the softer material yields"
            yield Finding(name, f"{what} ({_ONSET:g} times its yield stress)", "Use a larger ball, a harder material or less preload")
