"""Deformation of links at a state: strain and stress of flexures, section curvature, and the range of their laws.

See docs/nonlinear.md, 28 and 29.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexstage.base.number import Array, Number
from flexstage.models.nonlinear.elements.corotated import port_motion
from flexstage.models.nonlinear.elements.element import Shape
from flexstage.models.nonlinear.elements.hinge import deform, imposed
from flexstage.models.nonlinear.equilibrium import State
from flexstage.models.nonlinear.graph import flexure_state, hinge_ends
from flexstage.models.nonlinear.stage import Flexures
from flexstage.parts.material import Material

_STRAIN = 0.05
"""Strain of a flexure beyond which no linear elastic law is valid."""
_TURN, _SHIFT = 0.46, 0.30
"""Rotation [rad] and relative displacement at which a law of small motions is 10 % wrong, of a cantilever under P L^2 = E I.

K. E. Bisshopp & D. C. Drucker, Quart. Appl. Math. 3 (1945) 272: 0.4613 rad and 0.3017; linear theory gives 0.5 and 0.3333.
"""
_ABOUT_Z = np.array([0.0, 0.0, 1.0])
_ACROSS = np.array([-1.0, -0.5, 0.0, 0.5, 1.0])
"""Stress evaluation points across the width, over half of it."""


@dataclass(frozen=True, eq=False)
class Strains:
    """Strains of l flexures by name: the `largest` strain (..., l), and the ratio `curving` (..., l).

    `curving` is b^2 k / t with the width b, the thickness t and the largest curvature k; NaN for flexures without plate bending.

    `stress` (..., l) is the largest von Mises stress on the faces [Pa]; `limit` (l,) the lowest stress limit of the material, NaN if
    unknown.
    """

    names: tuple[str, ...]
    largest: Array
    curving: Array
    stress: Array
    limit: Array


def strains(state: State) -> Strains:
    """Compute strains at the ends and the integration points of every flexure, for the thinnest section of the flexure.

    At the throat of a notch or neck of thickness t and radius R, the strain is too low by 1 % at t/R = 0.1, 8 % at 0.04, 19 % at 0.02.

    The strain is |N| / (E A) + |k_z| t / 2 + |k_y| b / 2 + k_x^2 b^2 / 12, the largest possible sum at an edge of the section. N is the
    axial force, E A the axial stiffness; k_y and k_z are the curvatures relative to the natural shape, k_x is the twist rate, t the
    thickness and b the width. At a clamped end of a leaf, the stress is 1 / (1 - nu^2) times the stress of a beam with the same strain,
    where nu is Poisson's ratio. Stress includes stretch, bending about both axes, section curvature of a leaf, and Saint-Venant torsion.
    Restrained warping and stress concentration at notches and fillets are neglected.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.models.nonlinear.equilibrium import equilibrium
    >>> from flexstage.models.nonlinear.stage import nonlinear
    >>> result = strains(equilibrium(nonlinear(parallelogram()), {"platform.fx": 100.0}, weight=0.0))
    >>> result.names[:2], bool(result.largest[0] > 1e-5)
    (('left', 'right'), True)
    """
    names: list[str] = []
    largest: list[Array] = []
    curving: list[Array] = []
    stressed: list[Array] = []
    for number, group in enumerate(state.model.flexures):
        law = group.law
        lies = flexure_state(group, state.pose, number, state.loads).lies
        bent = np.abs(_bent(lies) - law.natural[:, None, None, :1] * _ABOUT_Z) / law.length[:, None, None, None]
        half, wide = law.half[:, None, None, 0], law.half[:, None, None, 1]
        pulled = np.max(np.abs(lies.tension) * law.compliance[:, None, :, 0], axis=-1)
        bending = bent[..., 2] * half + bent[..., 1] * wide + bent[..., 0] ** 2 * wide**2 / 3.0
        names += group.names
        largest += list(pulled + np.max(bending, axis=-1))
        stressed += list(_stress(group, _materials(state, group), lies))
        curved = np.max(np.abs(_bent(lies)[..., 2]), axis=-1) / law.length[:, None]
        curving += list(2.0 * law.half[:, None, 1] ** 2 / law.half[:, None, 0] * curved if law.plate.size else np.nan * curved)
    known = np.where(state.converged, 1.0, np.nan)[..., None]
    results = (known * np.moveaxis(np.array(each), 0, -1).reshape(*state.shape, len(names)) for each in (largest, curving, stressed))
    return Strains(tuple(names), *results, limit=_limits([each for group in state.model.flexures for each in _materials(state, group)]))


def law_reserve(state: State) -> tuple[float, str]:
    """Return the least remaining fraction of the links' permitted deformation (1: undeformed; 0: limit), and a clause that names the limit.

    The strain limit of flexures is 5 %. The 6x6 stiffness of a link or superelement is valid for small motions. Its range ends at motions
    for which the error is about 10 %. The limits are a rotation of 0.46 rad between the ends, and a displacement of 0.3 of the stage's
    diagonal (for a superelement, of the diagonal of its ports). For a spring with a length, the displacement limit is this length.
    Deformations without stiffness have no limit.
    """
    model, pose, hinges = state.model, state.pose, state.model.hinges
    used = [(float(np.max(strains(state).largest, initial=0.0)) / _STRAIN, f"a flexure has a strain of {_STRAIN:.0%} there")]
    moved = deform(hinges, hinge_ends(model, pose))[0] - imposed(hinges, state.loads.inputs)
    places = np.concatenate([model.reference[:-1], model.reference[hinges.first] + hinges.arm_first])
    shift = np.where(hinges.strut > 0.0, hinges.strut, _SHIFT * _diagonal(places))
    stiff = np.diagonal(hinges.stiffness, axis1=1, axis2=2) != 0.0
    links = zip(hinges.names, np.where(stiff, moved[:, 0], 0.0), shift, strict=True)
    shares = {name: _share(own, far) for name, own, far in links}
    for each in model.elements:
        motion = port_motion(each, pose.position[:, each.bodies], pose.turn[:, each.bodies]).motion
        shares[each.name] = _share(motion.reshape(-1, 6), _SHIFT * _diagonal(each.place))
    used += [(share, f"{name} is deformed beyond the range of its 6x6 stiffness there") for name, share in shares.items()]
    return min((1.0 - share, why) for share, why in used)


def _diagonal(places: Array) -> float:
    """Diagonal of the bounding box of points (n, 3); infinite for a single point, which has no size."""
    return float(np.linalg.norm(np.ptp(places, axis=0))) or np.inf


def _share(motion: Array, shift: float) -> float:
    """The largest displacement and rotation among motions (..., 6) over the limits of a law of small motions."""
    return float(np.max(np.abs(motion) / np.repeat([shift, _TURN], 3)))


def _bent(lies: Shape) -> Array:
    """Curvatures (l, b, n + 2, 3) at points and ends, over the length."""
    return np.concatenate([lies.curvature, lies.rule.ends @ lies.curvature], axis=-2)


def _materials(state: State, group: Flexures) -> list[Material]:
    materials = [state.model.assembly.links[name].material for name in group.names]
    return [each for each in materials if each is not None]


def _limits(materials: list[Material]) -> Array:
    return np.array([np.nan if each.limit is None else float(each.limit) for each in materials])


def _column(values: list[Number]) -> Array:
    return np.array([float(value) for value in values])[:, None, None, None, None]


def _stress(group: Flexures, materials: list[Material], lies: Shape) -> Array:
    """The largest von Mises stress (l, b) at points and ends, five points across the width and both faces (docs/nonlinear.md, 29)."""
    law, flat = group.law, group.law.plate.shape[-1] > 0
    young, shear = _column([each.modulus for each in materials]), _column([each.shear for each in materials])
    poisson = _column([each.contraction if flat else 0.0 for each in materials])
    length, half, wide, shearing = (each[:, None, None, None, None] for each in (law.length, law.half[:, 0], law.half[:, 1], law.shearing))
    bent = _bent(lies)[..., None, None, :] / length[..., None]
    natural, across_natural = (law.natural[:, None, None, None, None, place] / length for place in (0, 1))
    plate = np.pad(lies.plate, ((0, 0), (0, 0), (0, 2), (0, 0)))[..., None, None, :] / length[..., None]  # clamped ends: no curvature
    pulled = lies.tension * law.compliance[:, None, :, 0]
    pulled = np.concatenate([pulled, pulled @ lies.rule.ends.T], axis=-1)[..., None, None]
    twist, across, bend = (bent[..., axis] for axis in range(3))
    u, face = _ACROSS[:, None], half * np.array([-1.0, 1.0])
    square = wide * wide / 3.0
    two, four = square * (3.0 * u**2 - 1.0) / 2.0, square * (35.0 * u**4 - 30.0 * u**2 + 3.0) / 8.0
    flexed = plate[..., 0] + plate[..., 1] * (420.0 * u**2 - 60.0) / 24.0
    stretched = pulled + twist * twist * two - bend * (plate[..., 0] * two + plate[..., 1] * four) + wide * u * across
    factor = young / (1.0 - poisson * poisson)
    bend, flexed = bend - natural, flexed - across_natural
    along = young * stretched - factor * face * (bend + poisson * flexed)
    over = -factor * face * (flexed + poisson * bend) if flat else 0.0 * along
    torsion = shearing * shear * half * twist
    return np.sqrt(np.max(along * along + over * over - along * over + 3.0 * torsion * torsion, axis=(2, 3, 4)))
