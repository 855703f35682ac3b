"""The solid wing: a stage as three-dimensional elastic bodies, and theory beside it."""

from flexstage.base.lazy import lazily

HOMES = {
    "fea.cache": "Cache",
    "fea.fineness": "Fineness Hold Reduction",
    "fea.estimate": "Accuracy",
    "fea.hinge": "HingeSolid hinge_compliance",
    "fea.model": "SolidModel model model_with_parts",
    "resolution": "Resolution Resolved",
    "hinges": "SolidHinge solid_hinges",
    "units": "SolidUnit solid_units",
    "stage": "SolidStage solid_stage",
    "verification": "Verification verify",
    "modes": "fea_modes kept_fea_modes",
    "calibration": "Calibration calibrate",
}
__getattr__, __dir__ = lazily(__name__, HOMES)
