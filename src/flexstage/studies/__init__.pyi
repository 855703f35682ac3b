from flexstage.studies.optimisation.file import (
    load_wanted as load_wanted,
)
from flexstage.studies.optimisation.front import (
    pareto_front as pareto_front,
)
from flexstage.studies.optimisation.optimum import (
    optimise as optimise,
)
from flexstage.studies.optimisation.result import (
    Front as Front,
    Optimum as Optimum,
)
from flexstage.studies.optimisation.wanted import (
    Aim as Aim,
    Objective as Objective,
    Wanted as Wanted,
)
from flexstage.studies.sweeps.effects import (
    Effects as Effects,
    effects as effects,
)
from flexstage.studies.sweeps.file import (
    load_study as load_study,
)
from flexstage.studies.sweeps.run import (
    Run as Run,
    sweep as sweep,
)
from flexstage.studies.sweeps.store import (
    Results as Results,
    read_results as read_results,
)
from flexstage.studies.tolerances.file import (
    load_tolerance as load_tolerance,
)
from flexstage.studies.tolerances.run import (
    Toleranced as Toleranced,
    tolerance as tolerance,
)

HOMES: dict[str, str]
