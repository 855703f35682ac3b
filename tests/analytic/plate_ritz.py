"""A thin plate by Ritz: the authority for the plate action of leaf springs. Shares no formula with the package.

A leaf of length 1 and width `width`, clamped at x = +-1/2 to rigid bodies, free at its sides, carries a bending moment m(x). Deflection
f(x) + sum P_2k(z) h_k(x) with h = h' = 0 at the clamps, f free: bending energy of Kirchhoff's plate, D = 1.
"""

from __future__ import annotations

import numpy as np
from numpy.polynomial import Legendre
from numpy.polynomial.legendre import leggauss


def factor(width, poisson, *, guided, across=6, along=36):
    """Factor on EI/L (moment constant) or on 12 EI/L^3 (`guided`: moment linear through zero)."""
    x, weight = leggauss(2 * along)
    weight, moment = 0.5 * weight, 0.5 * x if guided else np.ones_like(x)
    h0, h1, h2 = _clamped(x, along, guided)
    stiffness, load = _energy((h0 * weight, h1 * weight, h2 * weight), (h0, h1, h2), width, poisson, across)
    load = np.kron(load, (h0 * weight) @ moment) * poisson / width
    compliance = (moment**2 @ weight) / width + load @ np.linalg.solve(stiffness, load)
    return (1.0 / 12.0 if guided else 1.0) / (width * (1.0 - poisson**2) * compliance)


def _clamped(x, count, odd):
    """(1 - u^2)^2 P_k(u), u = 2x, and its first two derivatives by x."""
    bubble = Legendre.fromroots([-1.0, -1.0, 1.0, 1.0])
    functions = [bubble * Legendre.basis(2 * k + int(odd)) for k in range(count)]
    return tuple(
        2.0**order * np.array([function.deriv(order)(x) if order else function(x) for function in functions]) for order in range(3)
    )


def _energy(weighted, plain, width, poisson, count):
    z, weight = leggauss(4 * count)
    weight = 0.5 * width * weight
    shapes = [Legendre.basis(2 * k) for k in range(1, count + 1)]
    p0, p1, p2 = ((2.0 / width) ** order * np.array([s.deriv(order)(z) if order else s(z) for s in shapes]) for order in range(3))
    product = [[weighted[i] @ plain[j].T for j in range(3)] for i in range(3)]
    mixed = np.kron((p0 * weight) @ p2.T, product[2][0])
    stiffness = np.kron((p0 * weight) @ p0.T, product[2][2]) + np.kron((p2 * weight) @ p2.T, product[0][0])
    stiffness += poisson * (mixed + mixed.T) + 2.0 * (1.0 - poisson) * np.kron((p1 * weight) @ p1.T, product[1][1])
    curling = p2 @ weight
    return stiffness - poisson**2 / width * np.kron(np.outer(curling, curling), product[0][0]), curling
