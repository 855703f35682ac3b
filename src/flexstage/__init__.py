"""flexstage: design and proof of flexure-based ultra-precision positioning stages.

The public surface, name by name. A name is imported from its room at first use (PEP 562), so `import flexstage` itself loads nothing;
type checkers and editors read the same table from `__init__.pyi`.
"""

from importlib import import_module

__version__ = "0.1.0"

_ROOMS = {
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
    "readings.ideal": "ideal",
    "readings.lumped": "Masses lumped",
    "readings.mapped": "mapped",
    "readings.solid.cache": "Cache",
    "readings.solid.fineness": "Fineness Hold Reduction",
    "readings.solid.estimate": "Accuracy",
    "readings.solid.hinge": "HingeSolid hinge_compliance",
    "readings.solid.reading": "SolidReading solid solid_parts",
    "readings.measured.record": "Channel InMemory Record Responses Role in_memory",
    "readings.measured.options": "Allow Kind Options",
    "readings.measured.unit": "in_si responses_in_si",
    "readings.measured.read": "read_record",
    "readings.measured.write": "Form write_record",
    "readings.measured.health": "Needs examine usable",
    "readings.measured.spectra": "Segments Spectra Window spectra",
    "readings.measured.transfer": "h1 h2 multiple_coherence ordinary_coherence spectral_ratio",
    "readings.measured.identify": "Search identify",
    "readings.measured.identified": "Identified",
    "readings.linear.kinematics": "Kinematics",
    "readings.linear.model": "LinearModel",
    "readings.linear.static": "static_gain",
    "readings.finite": "FiniteMotion FinitePose forward_kinematics inverse_kinematics",
    "readings.linear.frequency": "Response",
    "readings.linear.state_space": "StateSpace state_space",
    "analysis.statics": "Statics equivalent_stiffness statics",
    "analysis.lost_motion": "LostMotion lost_motion",
    "analysis.modes": "Modes modal_assurance modes subspace_angle",
    "analysis.deflection": "Deflection deflection",
    "analysis.response": "response transmissibility",
    "analysis.random_response": "RandomResponse Spectrum random_response",
    "analysis.drift": "Drift drift",
    "analysis.error_budget": "ErrorBudget error_budget",
    "studies.sensitivities": "Sensitivities sensitivities",
    "studies.omitted": "Omitted omitted",
    "studies.units": "UnitResult units",
    "studies.resolution": "Resolution Resolved",
    "studies.solid_hinge": "SolidHinge solid_hinges",
    "studies.solid_unit": "SolidUnit solid_units",
    "studies.solid_stage": "SolidStage solid_stage",
    "studies.verify": "Verification verify",
    "studies.fea_modes": "FeaModes fea_modes kept_fea_modes",
    "studies.compare": "Compared compare",
    "studies.update": "Told Updated update",
    "studies.update_free": "Known",
    "studies.update_text": "updated_text",
    "studies.measured_shapes": "StageShapes stage_shapes",
    "studies.calibrate": "Calibration calibrate",
    "studies.workspace": "Workspace workspace",
    "studies.complete": "Analysis Reading analyse",
    "studies.judge": "judge",
    "studies.budget": "budget",
    "studies.difference": "difference",
    "studies.rig.rig": "rig",
    "studies.rig.setup": "Amplifier AntiAlias NoiseDrive Recorded RigSetup Sensing Tap",
    "present.report": "report",
}
_HOME = {name: room for room, names in _ROOMS.items() for name in names.split()}


def __getattr__(name: str) -> object:
    if name not in _HOME:
        raise AttributeError(f"module 'flexstage' has no attribute {name!r}")
    value = getattr(import_module(f"flexstage.{_HOME[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({"__version__", *_HOME})
