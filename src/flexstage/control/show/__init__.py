"""Tables, figures and reports of a loop."""
