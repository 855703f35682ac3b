"""flexstage: design and proof of flexure-based ultra-precision positioning stages.

The public surface, name by name; what goes beyond describing a stage and analysing it stands in `solid`, `experiment`, `control` and
`studies`. A name is imported from its home at first use (PEP 562), so `import flexstage` itself loads nothing; type checkers and editors
read the same table from `__init__.pyi`.
"""

from importlib import import_module

from flexstage.base.lazy import lazily

__version__ = "0.1.0"

WINGS = ("solid", "experiment", "control", "studies")
HOMES = {
    "base.finding": "DesignError Finding",
    "base.scale": "X Y Z m mm um nm rad mrad urad nrad deg kg N kN N_per_m N_per_um Pa MPa GPa Hz kHz V uF K",
    "base.labelled": "Matrix",
    "base.number": "Number Table",
    "base.digest": "digest",
    "parts.material": "Material",
    "parts.profile": "Circular Elliptic Filleted Straight",
    "parts.notch": "Notch",
    "parts.neck": "Neck",
    "parts.leaf": "Leaf",
    "parts.rod": "Rod",
    "parts.given": "Given Joint Origin",
    "parts.part": "Restricted",
    "parts.piezo": "Piezo",
    "parts.gauge": "Gauge Positive",
    "parts.body": "Body Block Cylinder Imported Inertia Payload",
    "parts.freedom": "Freedom",
    "beams.compliance": "compliance stiffness",
    "beams.stress": "stress",
    "beams.validity": "validity",
    "mechanism.pattern": "Polar Pose Facing",
    "mechanism.mechanism": "Mechanism Link Unit Placement Probe Force Opening ModalDamping StructuralDamping RayleighDamping",
    "mechanism.expand": "expand",
    "mechanism.restrict": "isolate restrict",
    "mechanism.store": "dump dumps load loads patch schema",
    "mechanism.checks": "check checked",
    "mechanism.address": "addresses assign get set_value",
    "cases.registry": "case",
    "cases.double_triangle": "double_triangle",
    "models.ideal": "ideal",
    "models.lumped": "Masses lumped",
    "models.mapped": "mapped",
    "models.linear.kinematics": "Kinematics",
    "models.linear.model": "LinearModel",
    "models.linear.static": "static_gain",
    "models.finite": "FiniteMotion FinitePose forward_kinematics inverse_kinematics",
    "models.linear.frequency": "Response",
    "models.linear.state_space": "StateSpace state_space",
    "analysis.solid_modes": "FeaModes",
    "analysis.statics": "Statics equivalent_stiffness statics",
    "analysis.lost_motion": "LostMotion lost_motion",
    "analysis.modes": "Modes modal_assurance modes subspace_angle",
    "analysis.deflection": "Deflection deflection",
    "analysis.response": "response transmissibility",
    "analysis.random_response": "RandomResponse Spectrum random_response",
    "analysis.drift": "Drift drift",
    "analysis.error_budget": "ErrorBudget error_budget",
    "analysis.sensitivities": "Sensitivities sensitivities",
    "analysis.omitted": "Omitted omitted",
    "analysis.units": "UnitResult units",
    "analysis.workspace.workspace": "Workspace workspace",
    "analysis.cautions": "Caveats caveats",
    "analysis.complete": "Analysis Reading analyse",
    "analysis.standing": "standing",
    "analysis.judge": "judge",
    "analysis.budget": "budget",
    "analysis.difference": "difference",
    "show.report": "report",
}
_of_core, _names = lazily(__name__, HOMES)


def __getattr__(name: str) -> object:
    return import_module(f"flexstage.{name}") if name in WINGS else _of_core(name)


def __dir__() -> list[str]:
    return sorted({*_names(), *WINGS})
