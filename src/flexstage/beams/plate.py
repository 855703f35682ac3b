"""Plate action of leaf springs: bending stiffness between a beam and a plate in plane strain.

A leaf bent about its width has anticlastic curvature across the width, except near its clamped ends. A narrow leaf is a beam of rigidity
EI; a wide leaf is a plate of rigidity EI / (1 - nu^2), with Poisson's ratio nu. Let s be the fraction of the length in which the leaf
curves freely, weighted by the squared bending moment. Then

    1 / factor = (1 - nu^2) + nu^2 s(L / b).

s depends little on nu. It is a rational function of L/b between two limits: s -> 1 - const b/L for narrow leaves, s -> const L/b for wide
leaves. The constants are fitted to a converged Ritz solution of the thin plate (tests/analytic). The plate factors agree with this solution
within 0.06 % for b/L from 0.03 to 8 and nu from 0.1 to 0.45. They agree within 0.08 % with the plate elements of reference B6.
"""

from __future__ import annotations

from flexstage.base.number import Number

_EVEN = (0.3294, -0.0462, 0.3752, 0.3529, 0.2725)
_ODD = (0.1465, 0.0159, 0.05075, 0.3010, 0.1419)


def moment_factor(slenderness: Number, poisson: Number) -> Number:
    """Compute the factor by which plate action raises EI/L for a constant bending moment; `slenderness` is length divided by width.

    >>> [round(moment_factor(ratio, 0.3), 4) for ratio in (10.0, 5.0, 2.0, 0.5)]  # reference B6: 1.0076, 1.0150, 1.0377, 1.0819
    [1.0074, 1.0147, 1.0374, 1.0823]
    """
    return _factor(_free_share(slenderness, _EVEN), poisson)


def shear_factor(slenderness: Number, poisson: Number) -> Number:
    """Compute the factor by which plate action raises 12 EI/L^3 for a guided leaf (no moment at its centre); `slenderness`: length / width.

    >>> [round(shear_factor(ratio, 0.3), 4) for ratio in (10.0, 5.0, 2.0, 0.5)]  # reference B6: 1.0209, 1.0376, 1.0679, 1.0912
    [1.0202, 1.0371, 1.0676, 1.0913]
    """
    return _factor(_free_share(slenderness, _ODD), poisson)


def _factor(free_share: Number, poisson: Number) -> Number:
    square = poisson * poisson
    return 1.0 / (1.0 - square + square * free_share)


def _free_share(x: Number, constants: tuple[float, ...]) -> Number:
    one, two, three, below, below_two = constants
    top = x * (one + x * (two + x * three))
    return top / (1.0 + x * (below + x * (below_two + x * three)))
