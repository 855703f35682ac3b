"""flexstage: design and proof of flexure-based ultra-precision positioning stages."""
