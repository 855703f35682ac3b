"""Large displacements: equilibrium, stiffness, stability and modes of stages away from the nominal position."""
