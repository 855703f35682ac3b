"""What a stage is made of: data, intended freedoms and profiles; no stiffness, no CAD."""
