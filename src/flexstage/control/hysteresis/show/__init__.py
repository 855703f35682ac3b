"""Tables, figures and reports of a stack's test."""
