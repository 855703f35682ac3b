"""A plain bar: a test case with known results for every step of the solid model."""

from __future__ import annotations

import numpy as np

from flexstage.parts.body import Block
from flexstage.solid.fea.geometry.piece import Medium, Piece
from flexstage.solid.fea.solver.component import Component, Interface, Joint
from flexstage.spatial.frame import Frame, identity


def bar() -> Component:
    """Make a square bar along x: 100 x 10 x 10 mm, E = 100 GPa, nu = 0, density 1000 kg/m^3, fixed at x = 0, with a joint at x = 100 mm.

    The bar's axial stiffness is E A / L = 100 N/um, and its mass is 10 g.

    >>> [piece.name for piece in bar().pieces], bar().interfaces[0].joint.name
    (['bar.block'], 'end')
    """
    block = Block("plain", (0.1, 0.01, 0.01))
    middle = Frame(np.eye(3), np.array([0.05, 0.0, 0.0]))
    return Component(
        name="bar",
        pieces=(Piece("bar.block", block, Medium(young=100e9, poisson=0.0, density=1000.0), middle, "bar"),),
        interfaces=(Interface(Joint("end", "link", "bar", Frame(np.eye(3), np.array([0.1, 0.0, 0.0])), 1e-4)),),
        fixed=(Joint("foot", "other", "ground", Frame(np.diag([-1.0, -1.0, 1.0]), np.zeros(3)), 1e-4),),
        bodies={"bar": np.array([0.05, 0.0, 0.0])},
        place=identity(),
    )
