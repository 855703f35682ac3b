"""Search for an optimum: the problem, steps of a search, and Pareto fronts."""
