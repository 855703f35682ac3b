"""The wing of many designs: sweeps, optimisation, tolerances."""

from flexstage.base.lazy import lazily

HOMES = {
    "sweeps.effects": "Effects effects",
    "sweeps.file": "load_study",
    "sweeps.run": "Run sweep",
    "sweeps.store": "Results read_results",
    "optimisation.wanted": "Aim Objective Wanted",
    "optimisation.file": "load_wanted",
    "optimisation.optimum": "optimise",
    "optimisation.front": "pareto_front",
    "optimisation.result": "Front Optimum",
    "tolerances.file": "load_tolerance",
    "tolerances.run": "Toleranced tolerance",
}
__getattr__, __dir__ = lazily(__name__, HOMES)
