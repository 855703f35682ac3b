"""Search for an optimum: problem, steps and fronts."""
