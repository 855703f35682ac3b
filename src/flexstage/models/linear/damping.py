"""Damping of a linear model: the applicable damping law, and the modal damping ratios."""

from __future__ import annotations

import numpy as np

from flexstage.base.finding import refuse
from flexstage.base.number import Array
from flexstage.mechanism.mechanism import Damping, ModalDamping, RayleighDamping
from flexstage.models.linear.eigen import Eigen
from flexstage.models.linear.model import LinearModel


def damping_law(model: LinearModel, damping: Damping | None = None) -> Damping:
    """Return the requested damping law or, without a request, the model's law; raises `DesignError` if both are missing.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.models.lumped import lumped
    >>> model = lumped(parallelogram())
    >>> damping_law(model).ratio, damping_law(model, ModalDamping(0.02)).ratio
    (0.01, 0.02)
    """
    law = damping if damping is not None else model.damping
    if law is None:
        raise refuse(
            "damping",
            "the design specifies no damping, but damping determines the response at a resonance",
            'Specify it in the design, e.g. damping = { law = "modal", ratio = 0.01 }, or pass damping=ModalDamping(0.01)',
        )
    return law


def modal_ratios(model: LinearModel, solved: Eigen, damping: Damping) -> Array:
    """Compute the damping ratio zeta_r (..., k) of each mode: the damping law's ratio plus phi^T D phi / (2 omega_r) for the dampers D.

    The damper term neglects the coupling of modes by dampers, which `transfer` and `state_space` include. For modes at 0 Hz, the ratio is
    zero.
    """
    dampers = _diagonal(viscous_coupling(model, solved)) / (2.0 * np.sqrt(_nonzero(solved.values)))
    return np.where(solved.values == 0.0, 0.0, law_ratios(model, solved, damping) + dampers)


def law_rates(model: LinearModel, solved: Eigen, damping: Damping) -> Array:
    """Compute 2 zeta_r omega_r (..., k) [1/s] of each mode for a damping law.

    For a mode at 0 Hz, the result is the mass factor for Rayleigh damping, and zero for the other laws.
    """
    rates = 2.0 * law_ratios(model, solved, damping) * np.sqrt(solved.values)
    own = np.asarray(damping.mass_factor)[..., None] if isinstance(damping, RayleighDamping) else 0.0
    return np.where(solved.values == 0.0, own, rates)


def _nonzero(values: Array) -> Array:
    return np.where(values == 0.0, 1.0, values)


def _diagonal(matrix: Array) -> Array:
    return np.linalg.diagonal(matrix)


def viscous_coupling(model: LinearModel, solved: Eigen) -> Array:
    """Compute Phi^T D Phi (..., k, k), the dampers of parts in modal coordinates [1/s].

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.models.linear.eigen import eigen
    >>> from flexstage.models.lumped import lumped
    >>> model = lumped(parallelogram())
    >>> bool(viscous_coupling(model, eigen(model)).any())  # no part states a damping
    False
    """
    total: Array = np.zeros((solved.shapes.shape[-1],) * 2)
    for name, law in model.viscous.items():
        strain = model.stiffness[name].operator[..., : law.shape[-1], :] @ solved.shapes
        total = total + strain.mT @ law @ strain
    return total


def law_ratios(model: LinearModel, solved: Eigen, damping: Damping) -> Array:
    """Compute the damping ratio zeta_r (..., k) of each mode for a damping law.

    - Modal: as specified.
    - Rayleigh: zeta_r = (alpha/omega_r + beta omega_r)/2 (exact), with the mass factor alpha and the stiffness factor beta.
    - Structural: zeta_r = sum_p eta_p phi^T K_p phi / (2 omega_r^2), the *equivalent* ratio by modal strain energy (Ungar and Kerwin 1962).
      The equivalent ratio is correct at resonance for small loss factors.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.mechanism.mechanism import StructuralDamping
    >>> from flexstage.models.linear.eigen import eigen
    >>> from flexstage.models.lumped import lumped
    >>> model = lumped(parallelogram())
    >>> ratios = law_ratios(model, eigen(model), StructuralDamping())
    >>> bool(np.all((ratios > 0.0005) & (ratios < 0.01)))  # half the loss factors of aluminium, 0.001, and of the stack, 0.02
    True
    """
    if isinstance(damping, ModalDamping):
        ratio = np.asarray(damping.ratio)[..., None]
        return np.broadcast_to(ratio, np.broadcast_shapes(ratio.shape, solved.values.shape))
    omega = np.sqrt(_nonzero(solved.values))
    if isinstance(damping, RayleighDamping):
        mass, stiffness = np.asarray(damping.mass_factor)[..., None], np.asarray(damping.stiffness_factor)[..., None]
        return 0.5 * (mass / omega + stiffness * omega)
    lost = np.zeros(1)
    for part in model.stiffness.values():
        strain = part.operator @ solved.shapes
        lost = lost + np.asarray(part.loss_factor)[..., None] * np.sum(strain * (part.law @ strain), axis=-2)
    return 0.5 * lost / _nonzero(solved.values)


def structural_stiffness(model: LinearModel) -> Array:
    """Compute the complex stiffness K* = sum K_p (1 + j eta_p) (..., n, n), with the loss factor eta_p of each part's material.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.models.lumped import lumped
    >>> model = lumped(parallelogram())
    >>> bool(np.allclose(structural_stiffness(model).real, model.stiffness_matrix))
    True
    """
    total = model.stiffness_matrix.astype(complex)
    for part in model.stiffness.values():
        lost = np.asarray(part.loss_factor)[..., None, None] * (part.operator.mT @ part.law @ part.operator)
        total = total + 1j * lost
    return total
