"""Tables, figures and reports of optimisations."""
