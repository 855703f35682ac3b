from flexstage import control as control, experiment as experiment, solid as solid, studies as studies
from flexstage.analysis.caveats import (
    check as check,
)
from flexstage.studies.synthesis.answers import (
    design as design,
)
from flexstage.studies.synthesis.specification import (
    load_specification as load_specification,
)
from flexstage.analysis.assessment.budget import (
    budget as budget,
)
from flexstage.analysis.complete import (
    Model as Model,
    analyse as analyse,
)
from flexstage.analysis.linear_statics.deflection import (
    deflection as deflection,
)
from flexstage.analysis.linear_statics.drift import (
    drift as drift,
)
from flexstage.analysis.loaded.load_cases import (
    buckling_factors as buckling_factors,
)
from flexstage.analysis.linear_statics.lost_motion import (
    lost_motion as lost_motion,
)
from flexstage.analysis.linear_statics.mass_matrix import (
    mass_matrix as mass_matrix,
)
from flexstage.analysis.dynamics.modes import (
    modes as modes,
)
from flexstage.analysis.dynamics.random_response import (
    Spectrum as Spectrum,
    random_response as random_response,
)
from flexstage.analysis.dynamics.response import (
    response as response,
    transmissibility as transmissibility,
)
from flexstage.analysis.assessment.sensitivities import (
    sensitivities as sensitivities,
)
from flexstage.analysis.loaded.misalign import (
    misalign as misalign,
)
from flexstage.analysis.loaded.operating_point import (
    operating_point as operating_point,
)
from flexstage.analysis.loaded.stroke import (
    stroke as stroke,
)
from flexstage.analysis.linear_statics.statics import (
    freedom_stiffness as freedom_stiffness,
    statics as statics,
)
from flexstage.analysis.linear_statics.inner_stage import (
    amplified as amplified,
)
from flexstage.analysis.workspace.force_workspace import (
    force_workspace as force_workspace,
)
from flexstage.analysis.workspace.workspace import (
    workspace as workspace,
)
from flexstage.analysis.validity import (
    validity as validity,
)
from flexstage.base.finding import (
    DesignError as DesignError,
)
from flexstage.base.units.scale import (
    GPa as GPa,
    Hz as Hz,
    K as K,
    MPa as MPa,
    N as N,
    N_per_m as N_per_m,
    N_per_um as N_per_um,
    Pa as Pa,
    V as V,
    X as X,
    Y as Y,
    Z as Z,
    deg as deg,
    kHz as kHz,
    kN as kN,
    kg as kg,
    m as m,
    mm as mm,
    mrad as mrad,
    nm as nm,
    nrad as nrad,
    rad as rad,
    uF as uF,
    um as um,
    urad as urad,
)
from flexstage.cases.registry import (
    case as case,
)
from flexstage.mechanism.mechanism import (
    Force as Force,
    GaugeSum as GaugeSum,
    Link as Link,
    LinkProbe as LinkProbe,
    Mechanism as Mechanism,
    ModalDamping as ModalDamping,
    NamedNumber as NamedNumber,
    Aperture as Aperture,
    Placement as Placement,
    Probe as Probe,
    RayleighDamping as RayleighDamping,
    Stop as Stop,
)
from flexstage.mechanism.mechanism import (
    StrokePath as StrokePath,
    StructuralDamping as StructuralDamping,
    Unit as Unit,
)
from flexstage.mechanism.assembly.mount import (
    mount as mount,
)
from flexstage.mechanism.assembly.pattern import (
    InstanceOrientation as InstanceOrientation,
    Normal as Normal,
    Polar as Polar,
    Pose as Pose,
)
from flexstage.mechanism.store import (
    dump as dump,
    dumps as dumps,
    load as load,
    loads as loads,
)
from flexstage.models.finite import (
    forward_kinematics as forward_kinematics,
    inverse_kinematics as inverse_kinematics,
)
from flexstage.models.ideal import (
    ideal as ideal,
)
from flexstage.models.linear.model import (
    LinearModel as LinearModel,
)
from flexstage.models.lumped import (
    lumped as lumped,
)
from flexstage.models.mapped import (
    mapped as mapped,
)
from flexstage.models.nonlinear.paths.critical_load import (
    critical_load as critical_load,
)
from flexstage.models.nonlinear.equilibrium import (
    equilibrium as equilibrium,
)
from flexstage.models.nonlinear.linearise import (
    linearise as linearise,
)
from flexstage.models.nonlinear.paths.load_path import (
    post_buckling_path as post_buckling_path,
    load_path as load_path,
    continuation as continuation,
)
from flexstage.models.nonlinear.gradients import (
    evaluate_designs as evaluate_designs,
    gradients as gradients,
)
from flexstage.models.nonlinear.stage import (
    nonlinear as nonlinear,
)
from flexstage.models.nonlinear.state import (
    SolverOptions as SolverOptions,
)
from flexstage.parts.body import (
    Block as Block,
    Body as Body,
    Cylinder as Cylinder,
    Extrusion as Extrusion,
    Imported as Imported,
    Inertia as Inertia,
    Payload as Payload,
    Sphere as Sphere,
)
from flexstage.parts.cartwheel import (
    Cartwheel as Cartwheel,
)
from flexstage.parts.condensation import (
    superelement as superelement,
)
from flexstage.parts.contact import (
    Contact as Contact,
    Seat as Seat,
)
from flexstage.parts.cross_hinge import (
    CrossHinge as CrossHinge,
)
from flexstage.parts.encoder import (
    Encoder as Encoder,
)
from flexstage.parts.folded_leaf import (
    FoldedLeaf as FoldedLeaf,
)
from flexstage.parts.freedom import (
    Freedom as Freedom,
)
from flexstage.parts.gauge import (
    Gauge as Gauge,
    SensorSense as SensorSense,
)
from flexstage.parts.compliance_matrix import (
    ComplianceMatrix as ComplianceMatrix,
    Joint as Joint,
)
from flexstage.parts.leaf import (
    Leaf as Leaf,
    LeafEnds as LeafEnds,
    LeafSection as LeafSection,
)
from flexstage.parts.material import (
    Material as Material,
)
from flexstage.parts.membrane import (
    Membrane as Membrane,
)
from flexstage.parts.neck import (
    Neck as Neck,
)
from flexstage.parts.notch import (
    Notch as Notch,
)
from flexstage.parts.piezo import (
    Piezo as Piezo,
)
from flexstage.parts.shear_piezo import (
    ShearPiezo as ShearPiezo,
)
from flexstage.parts.voice_coil import (
    CoilSide as CoilSide,
    Supply as Supply,
    VoiceCoil as VoiceCoil,
)
from flexstage.parts.rotary_coil import (
    RotaryCoil as RotaryCoil,
)
from flexstage.parts.amplified import (
    Amplified as Amplified,
    SteppingDrive as SteppingDrive,
)
from flexstage.parts.force_actuator import (
    ForceActuator as ForceActuator,
)
from flexstage.parts.profile import (
    Circular as Circular,
    Elliptic as Elliptic,
    Filleted as Filleted,
    FreeForm as FreeForm,
    Hyperbolic as Hyperbolic,
    Parabolic as Parabolic,
    Power as Power,
    Straight as Straight,
    Vee as Vee,
)
from flexstage.parts.reinforced_leaf import (
    ReinforcedLeaf as ReinforcedLeaf,
)
from flexstage.parts.rod import (
    Rod as Rod,
)
from flexstage.parts.spring import (
    Spring as Spring,
)
from flexstage.parts.strain_gauge import (
    StrainGauge as StrainGauge,
)
from flexstage.parts.superelement import (
    FileUnits as FileUnits,
    MatrixNames as MatrixNames,
    Port as Port,
    Superelement as Superelement,
)
from flexstage.parts.tilt import (
    Tilt as Tilt,
)
from flexstage.show.matlab import (
    to_mat as to_mat,
)
from flexstage.show.report import (
    report as report,
)
from flexstage.show.sheets import (
    to_csv as to_csv,
    to_pandas as to_pandas,
    to_xarray as to_xarray,
)
from flexstage.show.viewer.animation import (
    animate as animate,
)
from flexstage.show.viewer.view import (
    View as View,
    view as view,
)
from flexstage.show.workbook import (
    to_xlsx as to_xlsx,
)

__version__: str
HOMES: dict[str, str]
WINGS: tuple[str, ...]
