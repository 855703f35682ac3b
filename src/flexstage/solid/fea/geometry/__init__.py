"""Geometry of solids: pieces, CAD, contact and clearance."""
