"""Tables, figures and reports of the solid model."""
