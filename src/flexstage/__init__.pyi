from flexstage import control as control, experiment as experiment, solid as solid, studies as studies
from flexstage.analysis.budget import (
    budget as budget,
)
from flexstage.analysis.cautions import (
    Caveats as Caveats,
    caveats as caveats,
)
from flexstage.analysis.complete import (
    Analysis as Analysis,
    Reading as Reading,
    analyse as analyse,
)
from flexstage.analysis.deflection import (
    Deflection as Deflection,
    deflection as deflection,
)
from flexstage.analysis.difference import (
    difference as difference,
)
from flexstage.analysis.drift import (
    Drift as Drift,
    drift as drift,
)
from flexstage.analysis.error_budget import (
    ErrorBudget as ErrorBudget,
    error_budget as error_budget,
)
from flexstage.analysis.judge import (
    judge as judge,
)
from flexstage.analysis.lost_motion import (
    LostMotion as LostMotion,
    lost_motion as lost_motion,
)
from flexstage.analysis.modes import (
    Modes as Modes,
    modal_assurance as modal_assurance,
    modes as modes,
    subspace_angle as subspace_angle,
)
from flexstage.analysis.omitted import (
    Omitted as Omitted,
    omitted as omitted,
)
from flexstage.analysis.random_response import (
    RandomResponse as RandomResponse,
    Spectrum as Spectrum,
    random_response as random_response,
)
from flexstage.analysis.response import (
    response as response,
    transmissibility as transmissibility,
)
from flexstage.analysis.sensitivities import (
    Sensitivities as Sensitivities,
    sensitivities as sensitivities,
)
from flexstage.analysis.solid_modes import (
    FeaModes as FeaModes,
)
from flexstage.analysis.standing import (
    standing as standing,
)
from flexstage.analysis.statics import (
    Statics as Statics,
    equivalent_stiffness as equivalent_stiffness,
    statics as statics,
)
from flexstage.analysis.units import (
    UnitResult as UnitResult,
    units as units,
)
from flexstage.analysis.workspace.workspace import (
    Workspace as Workspace,
    workspace as workspace,
)
from flexstage.base.digest import (
    digest as digest,
)
from flexstage.base.finding import (
    DesignError as DesignError,
    Finding as Finding,
)
from flexstage.base.labelled import (
    Matrix as Matrix,
)
from flexstage.base.number import (
    Number as Number,
    Table as Table,
)
from flexstage.base.scale import (
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
from flexstage.beams.compliance import (
    compliance as compliance,
    stiffness as stiffness,
)
from flexstage.beams.stress import (
    stress as stress,
)
from flexstage.beams.validity import (
    validity as validity,
)
from flexstage.cases.double_triangle import (
    double_triangle as double_triangle,
)
from flexstage.cases.registry import (
    case as case,
)
from flexstage.mechanism.address import (
    addresses as addresses,
    assign as assign,
    get as get,
    set_value as set_value,
)
from flexstage.mechanism.checks import (
    check as check,
    checked as checked,
)
from flexstage.mechanism.expand import (
    expand as expand,
)
from flexstage.mechanism.mechanism import (
    Force as Force,
    Link as Link,
    Mechanism as Mechanism,
    ModalDamping as ModalDamping,
    Opening as Opening,
    Placement as Placement,
    Probe as Probe,
    RayleighDamping as RayleighDamping,
    StructuralDamping as StructuralDamping,
    Unit as Unit,
)
from flexstage.mechanism.pattern import (
    Facing as Facing,
    Polar as Polar,
    Pose as Pose,
)
from flexstage.mechanism.restrict import (
    isolate as isolate,
    restrict as restrict,
)
from flexstage.mechanism.store import (
    dump as dump,
    dumps as dumps,
    load as load,
    loads as loads,
    patch as patch,
    schema as schema,
)
from flexstage.models.finite import (
    FiniteMotion as FiniteMotion,
    FinitePose as FinitePose,
    forward_kinematics as forward_kinematics,
    inverse_kinematics as inverse_kinematics,
)
from flexstage.models.ideal import (
    ideal as ideal,
)
from flexstage.models.linear.frequency import (
    Response as Response,
)
from flexstage.models.linear.kinematics import (
    Kinematics as Kinematics,
)
from flexstage.models.linear.model import (
    LinearModel as LinearModel,
)
from flexstage.models.linear.state_space import (
    StateSpace as StateSpace,
    state_space as state_space,
)
from flexstage.models.linear.static import (
    static_gain as static_gain,
)
from flexstage.models.lumped import (
    Masses as Masses,
    lumped as lumped,
)
from flexstage.models.mapped import (
    mapped as mapped,
)
from flexstage.parts.body import (
    Block as Block,
    Body as Body,
    Cylinder as Cylinder,
    Imported as Imported,
    Inertia as Inertia,
    Payload as Payload,
)
from flexstage.parts.freedom import (
    Freedom as Freedom,
)
from flexstage.parts.gauge import (
    Gauge as Gauge,
    Positive as Positive,
)
from flexstage.parts.given import (
    Given as Given,
    Joint as Joint,
    Origin as Origin,
)
from flexstage.parts.leaf import (
    Leaf as Leaf,
)
from flexstage.parts.material import (
    Material as Material,
)
from flexstage.parts.neck import (
    Neck as Neck,
)
from flexstage.parts.notch import (
    Notch as Notch,
)
from flexstage.parts.part import (
    Restricted as Restricted,
)
from flexstage.parts.piezo import (
    Piezo as Piezo,
)
from flexstage.parts.profile import (
    Circular as Circular,
    Elliptic as Elliptic,
    Filleted as Filleted,
    Straight as Straight,
)
from flexstage.parts.rod import (
    Rod as Rod,
)
from flexstage.show.report import (
    report as report,
)

__version__: str
HOMES: dict[str, str]
WINGS: tuple[str, ...]
