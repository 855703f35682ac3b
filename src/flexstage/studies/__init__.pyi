from flexstage.studies.optimisation.file import (
    load_optimisation as load_optimisation,
)
from flexstage.studies.optimisation.search.front import (
    pareto_front as pareto_front,
)
from flexstage.studies.optimisation.search.optimum import (
    optimise as optimise,
)
from flexstage.studies.sweeps.effects import (
    effects as effects,
)
from flexstage.studies.sweeps.file import (
    load_study as load_study,
)
from flexstage.studies.sweeps.execution.run import (
    Run as Run,
    sweep as sweep,
)
from flexstage.studies.sweeps.execution.store import (
    read_results as read_results,
)
from flexstage.studies.tolerances.file import (
    load_tolerance as load_tolerance,
)
from flexstage.studies.tolerances.run import (
    tolerance as tolerance,
)

HOMES: dict[str, str]
