"""The solid wing: a stage as three-dimensional elastic bodies, and theory beside it."""

from flexstage.base.lazy import lazy_attributes

HOMES = {
    "fea.cache": "Cache",
    "fea.fineness": "Fineness Reduction",
    "fea.estimate": "Accuracy",
    "fea.hinge": "hinge_compliance",
    "fea.model": "model",
    "exchange.matrices": "export_superelement",
    "moving": "to_glb",
    "resolution": "Resolution",
    "hinges": "solid_hinges",
    "units": "solid_units",
    "stage": "solid_stage",
    "verification": "verify",
    "modes": "fea_modes",
    "calibration": "calibrate",
}
__getattr__, __dir__ = lazy_attributes(__name__, HOMES)
