"""flexstage: design and verification of flexure-based ultra-precision positioning stages.

The names of this package describe and analyse a stage; the packages `solid`, `experiment`, `control` and `studies` contain names for
further tasks. A name is imported from its module at first use (PEP 562), so that `import flexstage` does not load these modules. Type
checkers and editors read the same names from `__init__.pyi`.
"""

from importlib import import_module

from flexstage.base.lazy import LazyModule, lazy_attributes
from flexstage.base.notebook import RenderHook
from flexstage.base.version import __version__ as __version__

WINGS = ("solid", "experiment", "control", "studies")
HOMES = {
    "base.finding": "DesignError",
    "base.units.scale": "X Y Z m mm um nm rad mrad urad nrad deg kg N kN N_per_m N_per_um Pa MPa GPa Hz kHz V uF K",
    "parts.material": "Material",
    "parts.profile": "Circular Elliptic Filleted Straight Parabolic Hyperbolic Power Vee FreeForm",
    "parts.notch": "Notch",
    "parts.neck": "Neck",
    "parts.leaf": "Leaf LeafEnds LeafSection",
    "parts.reinforced_leaf": "ReinforcedLeaf",
    "parts.membrane": "Membrane",
    "parts.rod": "Rod",
    "parts.compliance_matrix": "ComplianceMatrix Joint",
    "parts.spring": "Spring",
    "parts.contact": "Contact Seat",
    "parts.piezo": "Piezo",
    "parts.shear_piezo": "ShearPiezo",
    "parts.amplified": "Amplified SteppingDrive",
    "parts.force_actuator": "ForceActuator",
    "parts.voice_coil": "VoiceCoil CoilSide Supply",
    "parts.rotary_coil": "RotaryCoil",
    "parts.cross_hinge": "CrossHinge",
    "parts.cartwheel": "Cartwheel",
    "parts.folded_leaf": "FoldedLeaf",
    "parts.superelement": "Superelement Port FileUnits MatrixNames",
    "parts.condensation": "superelement",
    "parts.gauge": "Gauge SensorSense",
    "parts.tilt": "Tilt",
    "parts.encoder": "Encoder",
    "parts.strain_gauge": "StrainGauge",
    "parts.body": "Body Block Cylinder Extrusion Imported Inertia Payload Sphere",
    "parts.freedom": "Freedom",
    "mechanism.assembly.pattern": "Polar Pose InstanceOrientation Normal",
    "mechanism.assembly.mount": "mount",
    "mechanism.mechanism": "Mechanism NamedNumber Link StrokePath Unit Placement Probe LinkProbe GaugeSum Stop Force Aperture "
    "ModalDamping StructuralDamping RayleighDamping",
    "mechanism.store": "dump dumps load loads",
    "analysis.caveats": "check",
    "studies.synthesis.answers": "design",
    "studies.synthesis.specification": "load_specification",
    "cases.registry": "case",
    "models.ideal": "ideal",
    "models.lumped": "lumped",
    "models.mapped": "mapped",
    "models.linear.model": "LinearModel",
    "models.nonlinear.stage": "nonlinear",
    "models.nonlinear.state": "SolverOptions",
    "models.nonlinear.equilibrium": "equilibrium",
    "models.nonlinear.paths.critical_load": "critical_load",
    "models.nonlinear.linearise": "linearise",
    "models.nonlinear.paths.load_path": "continuation load_path post_buckling_path",
    "models.nonlinear.gradients": "evaluate_designs gradients",
    "models.finite": "forward_kinematics inverse_kinematics",
    "analysis.linear_statics.statics": "freedom_stiffness statics",
    "analysis.linear_statics.mass_matrix": "mass_matrix",
    "analysis.linear_statics.lost_motion": "lost_motion",
    "analysis.dynamics.modes": "modes",
    "analysis.linear_statics.deflection": "deflection",
    "analysis.dynamics.response": "response transmissibility",
    "analysis.dynamics.random_response": "Spectrum random_response",
    "analysis.linear_statics.drift": "drift",
    "analysis.assessment.sensitivities": "sensitivities",
    "analysis.loaded.stroke": "stroke",
    "analysis.loaded.operating_point": "operating_point",
    "analysis.loaded.misalign": "misalign",
    "analysis.loaded.load_cases": "buckling_factors",
    "analysis.workspace.workspace": "workspace",
    "analysis.workspace.force_workspace": "force_workspace",
    "analysis.linear_statics.inner_stage": "amplified",
    "analysis.complete": "Model analyse",
    "analysis.assessment.budget": "budget",
    "analysis.validity": "validity",
    "show.report": "report",
    "show.viewer.animation": "animate",
    "show.viewer.view": "View view",
    "show.matlab": "to_mat",
    "show.sheets": "to_csv to_pandas to_xarray",
    "show.workbook": "to_xlsx",
}
RenderHook.tables, RenderHook.views = LazyModule("flexstage.show.notebook"), LazyModule("flexstage.show.viewer.view")
_of_core, _names = lazy_attributes(__name__, HOMES)


def __getattr__(name: str) -> object:
    return import_module(f"flexstage.{name}") if name in WINGS else _of_core(name)


def __dir__() -> list[str]:
    return sorted({*_names(), *WINGS})
