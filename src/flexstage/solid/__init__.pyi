from flexstage.solid.calibration import (
    calibrate as calibrate,
)
from flexstage.solid.exchange.matrices import (
    export_superelement as export_superelement,
)
from flexstage.solid.fea.cache import (
    Cache as Cache,
)
from flexstage.solid.fea.estimate import (
    Accuracy as Accuracy,
)
from flexstage.solid.fea.fineness import (
    Fineness as Fineness,
    Reduction as Reduction,
)
from flexstage.solid.fea.hinge import (
    hinge_compliance as hinge_compliance,
)
from flexstage.solid.fea.model import (
    model as model,
)
from flexstage.solid.hinges import (
    solid_hinges as solid_hinges,
)
from flexstage.solid.modes import (
    fea_modes as fea_modes,
)
from flexstage.solid.moving import (
    to_glb as to_glb,
)
from flexstage.solid.resolution import (
    Resolution as Resolution,
)
from flexstage.solid.stage import (
    solid_stage as solid_stage,
)
from flexstage.solid.units import (
    solid_units as solid_units,
)
from flexstage.solid.verification import (
    verify as verify,
)

HOMES: dict[str, str]
