"""Nominal stress in hinges, and stress concentration of their notches. Results are real numbers, without complex-step derivatives."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexstage.base.number import Array, Number, magnitude
from flexstage.beams.beam import Beam
from flexstage.beams.compliance import beam_of, law_of
from flexstage.parts.material import Material
from flexstage.parts.part import Part, inner

FACES = ("faces +-y", "faces +-z", "whole section", "shear and torsion")
"""Locations of the largest stress in the section: due to M_z, due to M_y, due to N, and due to shear force and torque."""
_ALONE: Array = np.array([[0.0, 1, 0, 0, 0, 1], [0, 0, 1, 0, 1, 0], [1, 0, 0, 0, 0, 0]])
"""Components of the wrench that make M_z, M_y and N."""
_ALIKE = 1e-9


@dataclass(frozen=True, eq=False)
class Stress:
    """Largest von Mises stress: `nominal` (...) [Pa] at `position` x (...) [m] from the part's centre, and the notch `factor` K_t."""

    nominal: Array
    position: Array
    factor: Array

    @property
    def peak(self) -> Array:
        """Nominal stress times the notch factor [Pa]."""
        return self.nominal * self.factor


def has_section(part: Part) -> bool:
    """Return whether `stress` has a result: the section and the notch factor of the part are known.

    >>> from flexstage.parts.notch import Notch
    >>> from flexstage.parts.profile import Circular
    >>> has_section(Notch("steel", thickness=0.001, width=0.01, profile=Circular(0.005)))
    True
    """
    return _factor(part) is not None


def _factor(part: Part) -> Number | None:
    """Notch factor K_t; `None` if unknown."""
    part_law = law_of(part)
    return None if part_law is None or part_law.concentration is None else part_law.concentration(inner(part))


def stress(part: Part, material: Material | None, wrench: Array) -> Stress | None:
    """Compute the largest stress in a part whose second end carries `wrench` (..., 6) [N, N m], about the centre in the link frame.

    The stress is computed by beam theory at every station x from end to end. Axial force and bending moments follow from force F and moment
    m of the wrench: N = F_x, M_z = m_z - x F_y, M_y = m_y + x F_z. The section has thickness t, width b (round: diameter d) and area A.

    sigma = |N|/A + |M_z| t/(2 I_z) + |M_y| b/(2 I_y) + warping (round: |N|/A + |M| d/(2 I)).

    tau is the sum of the largest shear and torsion stresses. The von Mises stress is sqrt(sigma^2 + 3 tau^2).

    The maxima of a section are added although they occur at different points: the result is an upper bound of the nominal stress. Returns
    `None` for parts without a known section (for example piezo stacks, which have load limits) or without a known notch factor.

    >>> steel = Material(young=200e9, poisson=0.3, density=7750.0)
    >>> from flexstage.parts.leaf import Leaf
    >>> leaf = Leaf("steel", length=0.05, thickness=0.001, width=0.01)
    >>> result = stress(leaf, steel, np.array([0.0, 1.0, 0.0, 0.0, 0.0, 0.0]))  # 1 N guided: M = F L/2 at both ends
    >>> round(float(result.nominal) / 1e6, 2), round(6 * 0.025 / (0.01 * 0.001**2) / 1e6, 2)
    (15.0, 15.0)
    """
    factor, own = _factor(part), law_of(part)
    if factor is None or own is None or own.beam is None:
        return None
    beam = beam_of(inner(part), material)
    position = np.stack([-beam.points.position, beam.points.position], axis=-2)
    load = np.moveaxis(np.asarray(wrench), -1, 0)[..., None, None]
    equivalent = np.sqrt(_normal(beam, position, load) ** 2 + 3.0 * _tangential(beam, load) ** 2)
    equivalent, position = (item.reshape(*item.shape[:-2], -1) for item in np.broadcast_arrays(equivalent, position))
    where = np.argmax(equivalent, axis=-1)[..., None]
    nominal = np.take_along_axis(equivalent, where, axis=-1)[..., 0]
    return Stress(nominal, np.take_along_axis(position, where, axis=-1)[..., 0], np.asarray(factor))


def stressed_place(part: Part, material: Material | None, wrench: Array) -> tuple[Array, Array]:
    """Return the location of the largest stress of one part under wrenches (k, 6): end (k,) and index in `FACES` (k,).

    The end is -1 for the first end, 1 for the second, 0 for a point between them.

    >>> from flexstage.parts.leaf import Leaf
    >>> steel = Material(young=200e9, poisson=0.3, density=7750.0)
    >>> leaf = Leaf("steel", length=0.05, thickness=0.001, width=0.01)
    >>> end, face = stressed_place(leaf, steel, np.array([[0.0, 1.0, 0.0, 0.0, 0.0, 0.025]]))  # cantilever: M = 0 at its second end
    >>> end.item(), FACES[face.item()]
    (-1, 'faces +-y')
    """
    beam, load = beam_of(inner(part), material), np.moveaxis(wrench, -1, 0)[..., None, None]
    position = np.stack([-beam.points.position, beam.points.position], axis=-2)
    shear = np.sqrt(3.0) * _tangential(beam, load)
    alone = [_normal(beam, position, load * each[:, None, None, None]) for each in _ALONE]
    whole = np.sqrt(_normal(beam, position, load) ** 2 + shear**2)
    size = (len(wrench), *np.broadcast_shapes(position.shape, whole.shape)[-2:])
    whole, position, *parts = (np.broadcast_to(each, size).reshape(len(wrench), -1) for each in (whole, position, *alone, shear))
    where = np.argmax(whole >= (1.0 - _ALIKE) * np.max(whole, axis=-1, keepdims=True), axis=-1)[:, None]
    x, *there = (np.take_along_axis(each, where, axis=-1)[:, 0] for each in (position, *parts))
    return np.where(np.abs(x) < 0.5 * np.max(position), 0, np.sign(x)).astype(int), np.argmax(np.stack(there), axis=0)


def _normal(beam: Beam, position: Array, load: Array) -> Array:
    """Largest normal stress (..., 2, m) at the stations -x and +x."""
    section = beam.section.each(_row)
    about_z = magnitude(load[5] - position * load[1]) / section.inertia_z
    about_y = magnitude(load[4] + position * load[2]) / section.inertia_y
    plain = section.normal_stress(magnitude(load[0]) / section.area, about_y, about_z)
    if section.warping is None:
        return plain
    return plain + section.sectorial * (magnitude(_row(beam.twisting.bimoment) * load[3]) / section.warping)


def _tangential(beam: Beam, load: Array) -> Array:
    """Largest shear stress (..., 1, m): shear forces, uniform torsion and the torque carried by warping."""
    section = beam.section.each(_row)
    force = np.sqrt(load[1] * load[1] + load[2] * load[2]) / section.area
    uniform = _row(beam.twisting.rate) * section.torsion * (section.shear / (_row(beam.flexibility[..., 1]) * section.area))
    return section.shear_peak * force + section.torsional_stress(magnitude(load[3]), uniform)


def _row(number: Number) -> Array:
    return np.atleast_1d(np.asarray(number))[..., None, :]
