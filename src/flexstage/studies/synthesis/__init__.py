"""Design of stages for a specification: bounds, architectures, search."""
