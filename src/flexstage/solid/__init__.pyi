from flexstage.solid.results.calibration import (
    calibrate as calibrate,
)
from flexstage.solid.exchange.matrices import (
    export_superelement as export_superelement,
)
from flexstage.solid.fea.jobs.cache import (
    Cache as Cache,
)
from flexstage.solid.fea.meshing.estimate import (
    Accuracy as Accuracy,
)
from flexstage.solid.fea.meshing.fineness import (
    Fineness as Fineness,
    Reduction as Reduction,
)
from flexstage.solid.fea.hinges.hinge import (
    hinge_compliance as hinge_compliance,
)
from flexstage.solid.results.read import (
    model as model,
)
from flexstage.solid.results.hinges import (
    solid_hinges as solid_hinges,
)
from flexstage.solid.results.modes import (
    fea_modes as fea_modes,
)
from flexstage.solid.show.moving import (
    to_glb as to_glb,
)
from flexstage.solid.results.resolution import (
    Resolution as Resolution,
)
from flexstage.solid.results.stage import (
    solid_stage as solid_stage,
)
from flexstage.solid.results.units import (
    solid_units as solid_units,
)
from flexstage.solid.results.verification import (
    required_values as required_values,
    verify as verify,
)

HOMES: dict[str, str]
