"""The solid package: a stage as three-dimensional elastic bodies, compared with theory."""

from flexstage.base.lazy import lazy_attributes

HOMES = {
    "fea.jobs.cache": "Cache",
    "fea.meshing.fineness": "Fineness Reduction",
    "fea.meshing.estimate": "Accuracy",
    "fea.hinges.hinge": "hinge_compliance",
    "results.read": "model",
    "exchange.matrices": "export_superelement",
    "show.moving": "to_glb",
    "results.resolution": "Resolution",
    "results.hinges": "solid_hinges",
    "results.units": "solid_units",
    "results.stage": "solid_stage",
    "results.verification": "required_values verify",
    "results.modes": "fea_modes",
    "results.calibration": "calibrate",
}
__getattr__, __dir__ = lazy_attributes(__name__, HOMES)
