"""The wing of many designs: sweeps, optimisation, tolerances."""

from flexstage.base.lazy import lazy_attributes

HOMES = {
    "sweeps.effects": "effects",
    "sweeps.file": "load_study",
    "sweeps.run": "Run sweep",
    "sweeps.store": "read_results",
    "optimisation.file": "load_wanted",
    "optimisation.optimum": "optimise",
    "optimisation.front": "pareto_front",
    "tolerances.file": "load_tolerance",
    "tolerances.run": "tolerance",
}
__getattr__, __dir__ = lazy_attributes(__name__, HOMES)
