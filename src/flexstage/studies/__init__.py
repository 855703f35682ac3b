"""The studies package: sweeps, optimisation, tolerances."""

from flexstage.base.lazy import lazy_attributes

HOMES = {
    "sweeps.effects": "effects",
    "sweeps.file": "load_study",
    "sweeps.execution.run": "Run sweep",
    "sweeps.execution.store": "read_results",
    "optimisation.file": "load_optimisation",
    "optimisation.search.optimum": "optimise",
    "optimisation.search.front": "pareto_front",
    "tolerances.file": "load_tolerance",
    "tolerances.run": "tolerance",
}
__getattr__, __dir__ = lazy_attributes(__name__, HOMES)
