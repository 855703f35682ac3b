"""Tables and reports of the answers to a specification."""
