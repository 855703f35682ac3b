from flexstage.solid.calibration import (
    Calibration as Calibration,
    calibrate as calibrate,
)
from flexstage.solid.fea.cache import (
    Cache as Cache,
)
from flexstage.solid.fea.estimate import (
    Accuracy as Accuracy,
)
from flexstage.solid.fea.fineness import (
    Fineness as Fineness,
    Hold as Hold,
    Reduction as Reduction,
)
from flexstage.solid.fea.hinge import (
    HingeSolid as HingeSolid,
    hinge_compliance as hinge_compliance,
)
from flexstage.solid.fea.model import (
    SolidModel as SolidModel,
    model as model,
    model_with_parts as model_with_parts,
)
from flexstage.solid.hinges import (
    SolidHinge as SolidHinge,
    solid_hinges as solid_hinges,
)
from flexstage.solid.modes import (
    fea_modes as fea_modes,
    kept_fea_modes as kept_fea_modes,
)
from flexstage.solid.resolution import (
    Resolution as Resolution,
    Resolved as Resolved,
)
from flexstage.solid.stage import (
    SolidStage as SolidStage,
    solid_stage as solid_stage,
)
from flexstage.solid.units import (
    SolidUnit as SolidUnit,
    solid_units as solid_units,
)
from flexstage.solid.verification import (
    Verification as Verification,
    verify as verify,
)

HOMES: dict[str, str]
