"""A package that adds to flexstage a hinge, a gauge and a measure."""
