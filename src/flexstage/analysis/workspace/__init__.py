"""What a stage can reach and bear: strokes, forces, stress, buckling, loads, gauges, clearance and volts."""
