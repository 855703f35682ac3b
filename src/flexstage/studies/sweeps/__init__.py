"""Studies of many designs: variables, responses, plans, computation and storage of designs."""
