"""Tables, figures and reports of tolerance studies."""
