from flexstage.analysis.deflection import (
    Deflection as Deflection,
    deflection as deflection,
)
from flexstage.analysis.drift import (
    Drift as Drift,
    drift as drift,
)
from flexstage.analysis.error_budget import (
    ErrorBudget as ErrorBudget,
    error_budget as error_budget,
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
from flexstage.analysis.random_response import (
    RandomResponse as RandomResponse,
    Spectrum as Spectrum,
    random_response as random_response,
)
from flexstage.analysis.response import (
    response as response,
    transmissibility as transmissibility,
)
from flexstage.analysis.statics import (
    Statics as Statics,
    equivalent_stiffness as equivalent_stiffness,
    statics as statics,
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
from flexstage.present.report import (
    report as report,
)
from flexstage.readings.finite import (
    FiniteMotion as FiniteMotion,
    FinitePose as FinitePose,
    forward_kinematics as forward_kinematics,
    inverse_kinematics as inverse_kinematics,
)
from flexstage.readings.ideal import (
    ideal as ideal,
)
from flexstage.readings.linear.frequency import (
    Response as Response,
)
from flexstage.readings.linear.kinematics import (
    Kinematics as Kinematics,
)
from flexstage.readings.linear.model import (
    LinearModel as LinearModel,
)
from flexstage.readings.linear.state_space import (
    StateSpace as StateSpace,
    state_space as state_space,
)
from flexstage.readings.linear.static import (
    static_gain as static_gain,
)
from flexstage.readings.lumped import (
    Masses as Masses,
    lumped as lumped,
)
from flexstage.readings.mapped import (
    mapped as mapped,
)
from flexstage.readings.measured.health import (
    Needs as Needs,
    examine as examine,
    usable as usable,
)
from flexstage.readings.measured.identified import (
    Identified as Identified,
)
from flexstage.readings.measured.identify import (
    Search as Search,
    identify as identify,
)
from flexstage.readings.measured.options import (
    Allow as Allow,
    Kind as Kind,
    Options as Options,
)
from flexstage.readings.measured.read import (
    read_record as read_record,
)
from flexstage.readings.measured.record import (
    Channel as Channel,
    InMemory as InMemory,
    Record as Record,
    Responses as Responses,
    Role as Role,
    in_memory as in_memory,
)
from flexstage.readings.measured.spectra import (
    Segments as Segments,
    Spectra as Spectra,
    Window as Window,
    spectra as spectra,
)
from flexstage.readings.measured.transfer import (
    h1 as h1,
    h2 as h2,
    multiple_coherence as multiple_coherence,
    ordinary_coherence as ordinary_coherence,
    spectral_ratio as spectral_ratio,
)
from flexstage.readings.measured.unit import (
    in_si as in_si,
    responses_in_si as responses_in_si,
)
from flexstage.readings.measured.write import (
    Form as Form,
    write_record as write_record,
)
from flexstage.readings.solid.cache import (
    Cache as Cache,
)
from flexstage.readings.solid.estimate import (
    Accuracy as Accuracy,
)
from flexstage.readings.solid.fineness import (
    Fineness as Fineness,
    Hold as Hold,
    Reduction as Reduction,
)
from flexstage.readings.solid.hinge import (
    HingeSolid as HingeSolid,
    hinge_compliance as hinge_compliance,
)
from flexstage.readings.solid.reading import (
    SolidReading as SolidReading,
    solid as solid,
    solid_parts as solid_parts,
)
from flexstage.analysis.loop.hysteresis.prandtl_ishlinskii import (
    PrandtlIshlinskii as PrandtlIshlinskii,
)
from flexstage.analysis.loop.hysteresis.envelope import (
    Envelope as Envelope,
)
from flexstage.analysis.loop.hysteresis.inverse import (
    hysteresis_inverse as hysteresis_inverse,
)
from flexstage.analysis.loop.hysteresis.bouc_wen import (
    BoucWen as BoucWen,
    bouc_wen as bouc_wen,
)
from flexstage.analysis.loop.hysteresis.preisach import (
    Preisach as Preisach,
    preisach as preisach,
)
from flexstage.analysis.loop.hysteresis.creep import (
    Creep as Creep,
    LogCreep as LogCreep,
    exponentials as exponentials,
)
from flexstage.analysis.loop.hysteresis.creep_record import (
    identify_creep as identify_creep,
)
from flexstage.analysis.loop.hysteresis.identify import (
    identify_hysteresis as identify_hysteresis,
)
from flexstage.analysis.loop.hysteresis.stack import (
    StackHysteresis as StackHysteresis,
    dump_hysteresis as dump_hysteresis,
    load_hysteresis as load_hysteresis,
    stack_hysteresis as stack_hysteresis,
)
from flexstage.studies.hysteresis import (
    Channels as Channels,
    StackTest as StackTest,
    stack_test as stack_test,
)
from flexstage.studies.budget import (
    budget as budget,
)
from flexstage.studies.calibrate import (
    Calibration as Calibration,
    calibrate as calibrate,
)
from flexstage.studies.compare import (
    Compared as Compared,
    compare as compare,
)
from flexstage.studies.cautions import (
    Caveats as Caveats,
    caveats as caveats,
)
from flexstage.studies.complete import (
    Analysis as Analysis,
    Reading as Reading,
    analyse as analyse,
)
from flexstage.studies.difference import (
    difference as difference,
)
from flexstage.studies.fea_modes import (
    FeaModes as FeaModes,
    fea_modes as fea_modes,
    kept_fea_modes as kept_fea_modes,
)
from flexstage.studies.judge import (
    judge as judge,
)
from flexstage.studies.measured_shapes import (
    StageShapes as StageShapes,
    stage_shapes as stage_shapes,
)
from flexstage.studies.omitted import (
    Omitted as Omitted,
    omitted as omitted,
)
from flexstage.studies.optimise.file import (
    load_wanted as load_wanted,
)
from flexstage.studies.optimise.front import (
    pareto_front as pareto_front,
)
from flexstage.studies.optimise.optimum import (
    optimise as optimise,
)
from flexstage.studies.optimise.result import (
    Front as Front,
    Optimum as Optimum,
)
from flexstage.studies.optimise.wanted import (
    Aim as Aim,
    Objective as Objective,
    Wanted as Wanted,
)
from flexstage.studies.resolution import (
    Resolution as Resolution,
    Resolved as Resolved,
)
from flexstage.studies.rig.rig import (
    rig as rig,
)
from flexstage.studies.rig.setup import (
    Amplifier as Amplifier,
    AntiAlias as AntiAlias,
    NoiseDrive as NoiseDrive,
    Recorded as Recorded,
    RigSetup as RigSetup,
    Sensing as Sensing,
    Tap as Tap,
)
from flexstage.studies.sensitivities import (
    Sensitivities as Sensitivities,
    sensitivities as sensitivities,
)
from flexstage.studies.solid_hinge import (
    SolidHinge as SolidHinge,
    solid_hinges as solid_hinges,
)
from flexstage.studies.solid_stage import (
    SolidStage as SolidStage,
    solid_stage as solid_stage,
)
from flexstage.studies.solid_unit import (
    SolidUnit as SolidUnit,
    solid_units as solid_units,
)
from flexstage.studies.standing import (
    standing as standing,
)
from flexstage.studies.study.effects import (
    Effects as Effects,
    effects as effects,
)
from flexstage.studies.study.file import (
    load_study as load_study,
)
from flexstage.studies.study.run import (
    Run as Run,
    sweep as sweep,
)
from flexstage.studies.study.store import (
    Results as Results,
    read_results as read_results,
)
from flexstage.studies.units import (
    UnitResult as UnitResult,
    units as units,
)
from flexstage.studies.update import (
    Told as Told,
    Updated as Updated,
    update as update,
)
from flexstage.studies.update_free import (
    Known as Known,
)
from flexstage.studies.update_text import (
    updated_text as updated_text,
)
from flexstage.studies.verify import (
    Verification as Verification,
    verify as verify,
)
from flexstage.studies.workspace import (
    Workspace as Workspace,
    workspace as workspace,
)

__version__: str
from flexstage.analysis.loop.system import System as System
from flexstage.analysis.loop.hardware import AmplifierSettings as AmplifierSettings
from flexstage.analysis.loop.hardware import GaugeSettings as GaugeSettings
from flexstage.analysis.loop.hardware import Hardware as Hardware
from flexstage.analysis.loop.hardware import hardware as hardware
from flexstage.analysis.loop.plant import Plant as Plant
from flexstage.analysis.loop.plant import plant as plant
from flexstage.analysis.loop.reduced import reduced as reduced
from flexstage.analysis.loop.closed import Cut as Cut
from flexstage.analysis.loop.closed import Loop as Loop
from flexstage.analysis.loop.closed import loop as loop
from flexstage.analysis.loop.verdict import verdict as verdict
from flexstage.analysis.loop.margins import bandwidths as bandwidths
from flexstage.analysis.loop.margins import crosstalk as crosstalk
from flexstage.analysis.loop.margins import margins as margins
from flexstage.analysis.loop.margins import peaks as peaks
from flexstage.analysis.loop.noise import noise_budget as noise_budget
from flexstage.analysis.loop.exchange import from_control as from_control
from flexstage.analysis.loop.exchange import to_control as to_control
from flexstage.analysis.loop.controllers.pi import PI as PI
from flexstage.analysis.loop.controllers.pid import PID as PID
from flexstage.analysis.loop.controllers.resonant import IntegralResonant as IntegralResonant
from flexstage.analysis.loop.controllers.notch import notch_of_mode as notch_of_mode
from flexstage.analysis.loop.controllers.loops import actuator_loops as actuator_loops
from flexstage.analysis.loop.controllers.loops import modal_loops as modal_loops
from flexstage.analysis.loop.controllers.loops import platform_loops as platform_loops
from flexstage.analysis.loop.controllers.decentralised import Decentralised as Decentralised
from flexstage.analysis.loop.tuning.goal import Goal as Goal
from flexstage.analysis.loop.trajectory.step import Step as Step
from flexstage.analysis.loop.trajectory.raster import Raster as Raster
from flexstage.analysis.loop.trajectory.spiral import Spiral as Spiral
from flexstage.analysis.loop.trajectory.sine import Sine as Sine
from flexstage.analysis.loop.trajectory.path import reference as reference
from flexstage.analysis.loop.simulation.machine import machine as machine
from flexstage.analysis.loop.simulation.run import simulate as simulate
from flexstage.analysis.loop.simulation.result import step_figures as step_figures
from flexstage.analysis.loop.simulation.result import tracking as tracking
from flexstage.studies.loop.choices import Axes as Axes
from flexstage.studies.loop.choices import Axis as Axis
from flexstage.studies.loop.choices import Compensation as Compensation
from flexstage.studies.loop.choices import ControllerKind as ControllerKind
from flexstage.studies.loop.choices import Criterion as Criterion
from flexstage.studies.loop.choices import Notching as Notching
from flexstage.studies.loop.choices import StackKind as StackKind
from flexstage.studies.loop.setup import Amplifying as Amplifying
from flexstage.studies.loop.setup import Controlling as Controlling
from flexstage.studies.loop.setup import FileMotion as FileMotion
from flexstage.studies.loop.setup import Floor as Floor
from flexstage.studies.loop.setup import Gauging as Gauging
from flexstage.studies.loop.setup import HystereticStacks as HystereticStacks
from flexstage.studies.loop.setup import LoopSetup as LoopSetup
from flexstage.studies.loop.setup import Motion as Motion
from flexstage.studies.loop.setup import NotchAt as NotchAt
from flexstage.studies.loop.setup import RasterMotion as RasterMotion
from flexstage.studies.loop.setup import Shaking as Shaking
from flexstage.studies.loop.setup import SineMotion as SineMotion
from flexstage.studies.loop.setup import SpiralMotion as SpiralMotion
from flexstage.studies.loop.setup import StepMotion as StepMotion
from flexstage.studies.loop.file import load_setup as load_setup
from flexstage.studies.loop.floor import criterion_spectrum as criterion_spectrum
from flexstage.studies.loop.study import LoopStudy as LoopStudy
from flexstage.studies.loop.study import loop_study as loop_study
from flexstage.present.loop_report import loop_report as loop_report
from flexstage.present.loop_files import write_controller as write_controller
from flexstage.present.loop_files import write_fmu as write_fmu
from flexstage.present.loop_files import write_plant as write_plant
from flexstage.studies.tolerance.file import load_tolerance as load_tolerance
from flexstage.studies.tolerance.run import Toleranced as Toleranced
from flexstage.studies.tolerance.run import tolerance as tolerance
