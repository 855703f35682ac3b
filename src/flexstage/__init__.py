"""flexstage: design and proof of flexure-based ultra-precision positioning stages."""

__version__ = "0.1.0"
