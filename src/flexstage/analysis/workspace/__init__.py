"""Workspace of a stage: strokes, forces, stress, buckling, loads, gauges, clearance and voltages."""
