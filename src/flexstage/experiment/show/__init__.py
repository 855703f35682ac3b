"""Tables, figures and reports of tests."""
