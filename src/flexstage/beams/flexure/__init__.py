"""Laws of flexures at large displacements: what bends, twists and stretches in them, as tables of modes along their length."""
