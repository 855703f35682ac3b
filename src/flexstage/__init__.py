"""flexstage: design and proof of flexure-based ultra-precision positioning stages.

The public surface, name by name; what goes beyond describing a stage and analysing it stands in `solid`, `experiment`, `control` and
`studies`. A name is imported from its home at first use (PEP 562), so `import flexstage` itself loads nothing; type checkers and editors
read the same table from `__init__.pyi`.
"""

from importlib import import_module

from flexstage.base.lazy import Late, lazy_attributes
from flexstage.base.notebook import RenderHook
from flexstage.base.version import __version__ as __version__

WINGS = ("solid", "experiment", "control", "studies")
HOMES = {
    "base.finding": "DesignError",
    "base.scale": "X Y Z m mm um nm rad mrad urad nrad deg kg N kN N_per_m N_per_um Pa MPa GPa Hz kHz V uF K",
    "parts.material": "Material",
    "parts.profile": "Circular Elliptic Filleted Straight Parabolic Hyperbolic Power Vee FreeForm",
    "parts.notch": "Notch",
    "parts.neck": "Neck",
    "parts.leaf": "Leaf LeafEnds LeafSection",
    "parts.reinforced_leaf": "ReinforcedLeaf",
    "parts.membrane": "Membrane",
    "parts.rod": "Rod",
    "parts.given": "Given Joint",
    "parts.spring": "Spring",
    "parts.contact": "Contact Seat",
    "parts.piezo": "Piezo",
    "parts.shear_piezo": "ShearPiezo",
    "parts.amplified": "Amplified SteppingDrive",
    "parts.force_actuator": "ForceActuator",
    "parts.voice_coil": "VoiceCoil CoilSide Supply",
    "parts.cross_hinge": "CrossHinge",
    "parts.cartwheel": "Cartwheel",
    "parts.folded_leaf": "FoldedLeaf",
    "parts.superelement": "Superelement Port FileUnits MatrixNames",
    "parts.condensation": "superelement",
    "parts.gauge": "Gauge Positive",
    "parts.tilt": "Tilt",
    "parts.encoder": "Encoder",
    "parts.strain_gauge": "StrainGauge",
    "parts.body": "Body Block Cylinder Extrusion Imported Inertia Payload Sphere",
    "parts.freedom": "Freedom",
    "mechanism.pattern": "Polar Pose Facing Normal",
    "mechanism.mount": "mount",
    "mechanism.mechanism": "Mechanism NamedNumber Link StrokePath Unit Placement Probe LinkProbe GaugeSum Stop Force Opening "
    "ModalDamping StructuralDamping RayleighDamping",
    "mechanism.store": "dump dumps load loads",
    "mechanism.checks": "check",
    "cases.registry": "case",
    "models.ideal": "ideal",
    "models.lumped": "lumped",
    "models.mapped": "mapped",
    "models.linear.model": "LinearModel",
    "models.nonlinear.stage": "nonlinear",
    "models.nonlinear.state": "Effort",
    "models.nonlinear.equilibrium": "equilibrium",
    "models.nonlinear.critical": "critical",
    "models.nonlinear.linearise": "linearise",
    "models.nonlinear.path": "branch path trace",
    "models.nonlinear.slopes": "over_designs slopes",
    "models.finite": "forward_kinematics inverse_kinematics",
    "analysis.statics": "freedom_stiffness statics",
    "analysis.mass_matrix": "mass_matrix",
    "analysis.lost_motion": "lost_motion",
    "analysis.modes": "modes",
    "analysis.deflection": "deflection",
    "analysis.response": "response transmissibility",
    "analysis.random_response": "Spectrum random_response",
    "analysis.drift": "drift",
    "analysis.sensitivities": "sensitivities",
    "analysis.stroke": "stroke",
    "analysis.stance": "stance",
    "analysis.misalign": "misalign",
    "analysis.load_cases": "critical_factors",
    "analysis.workspace.workspace": "workspace",
    "analysis.workspace.reach": "reach",
    "analysis.inner_stage": "amplified",
    "analysis.complete": "Model analyse",
    "analysis.budget": "budget",
    "analysis.validity": "validity",
    "show.report": "report",
    "show.viewer.course": "play",
    "show.viewer.view": "View view",
    "show.matlab": "to_mat",
    "show.sheets": "to_csv to_pandas to_xarray",
    "show.workbook": "to_xlsx",
}
RenderHook.tables, RenderHook.views = Late("flexstage.show.notebook"), Late("flexstage.show.viewer.view")
_of_core, _names = lazy_attributes(__name__, HOMES)


def __getattr__(name: str) -> object:
    return import_module(f"flexstage.{name}") if name in WINGS else _of_core(name)


def __dir__() -> list[str]:
    return sorted({*_names(), *WINGS})
