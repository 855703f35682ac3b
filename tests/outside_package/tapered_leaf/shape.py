"""The shape that finite elements ask for."""

from flexstage.solid.fea.geometry.draw import Shape
from tapered_leaf.solid import taper_solid

TAPER = Shape(taper_solid)
