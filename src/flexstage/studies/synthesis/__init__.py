"""From a specification to stages: bounds, architectures, search."""
