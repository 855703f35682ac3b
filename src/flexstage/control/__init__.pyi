from flexstage.control.systems.closed import (
    LoopBreak as LoopBreak,
    loop as loop,
)
from flexstage.control.controllers.decentralised import (
    Decentralised as Decentralised,
)
from flexstage.control.controllers.loops import (
    actuator_loops as actuator_loops,
    modal_loops as modal_loops,
    platform_loops as platform_loops,
)
from flexstage.control.controllers.notch import (
    notch_of_mode as notch_of_mode,
)
from flexstage.control.controllers.pi import (
    PI as PI,
)
from flexstage.control.controllers.pid import (
    PID as PID,
)
from flexstage.control.controllers.prefilter import (
    Prefilter as Prefilter,
)
from flexstage.control.controllers.resonant import (
    IntegralResonant as IntegralResonant,
)
from flexstage.control.plant_models.electronics import (
    AmplifierSettings as AmplifierSettings,
    GaugeSettings as GaugeSettings,
    sampling_chain as sampling_chain,
)
from flexstage.control.systems.exchange import (
    from_control as from_control,
    to_control as to_control,
)
from flexstage.control.export.files import (
    write_controller as write_controller,
    write_fmu as write_fmu,
    write_plant as write_plant,
)
from flexstage.control.hysteresis.models.bouc_wen import (
    bouc_wen as bouc_wen,
)
from flexstage.control.hysteresis.creep import (
    LogCreep as LogCreep,
    exponentials as exponentials,
)
from flexstage.control.hysteresis.models.inverse import (
    hysteresis_inverse as hysteresis_inverse,
)
from flexstage.control.hysteresis.stack import (
    dump_hysteresis as dump_hysteresis,
    load_hysteresis as load_hysteresis,
    stack_hysteresis as stack_hysteresis,
)
from flexstage.control.hysteresis.stack_test import (
    stack_test as stack_test,
)
from flexstage.control.noise import (
    noise_budget as noise_budget,
)
from flexstage.control.plant_models.plants import (
    plant as plant,
)
from flexstage.control.show.report import (
    loop_report as loop_report,
)
from flexstage.control.simulation.machine import (
    machine as machine,
)
from flexstage.control.simulation.result import (
    step_figures as step_figures,
    tracking as tracking,
)
from flexstage.control.simulation.run import (
    simulate as simulate,
)
from flexstage.control.robustness.stability import (
    verdict as verdict,
)
from flexstage.control.robustness.stability_margins import (
    margins as margins,
)
from flexstage.control.study.hardware.amplifiers import (
    ChargeSetup as ChargeSetup,
)
from flexstage.control.study.choices import (
    Axes as Axes,
    Axis as Axis,
    Compensation as Compensation,
    ControllerKind as ControllerKind,
    Criterion as Criterion,
    Following as Following,
    Notching as Notching,
    StackKind as StackKind,
)
from flexstage.control.study.file import (
    load_setup as load_setup,
)
from flexstage.control.study.setup import (
    AmplifierSetup as AmplifierSetup,
    ControllerSetup as ControllerSetup,
    DampingSetup as DampingSetup,
    FileMotion as FileMotion,
    Floor as Floor,
    FollowSetup as FollowSetup,
    GaugeSetup as GaugeSetup,
    GoalSetup as GoalSetup,
    HystereticStacks as HystereticStacks,
    LoopNumbers as LoopNumbers,
    LoopSetup as LoopSetup,
    AxisAmplitudes as AxisAmplitudes,
    NotchSetup as NotchSetup,
    PrefilterSetup as PrefilterSetup,
    RasterMotion as RasterMotion,
    VibrationSetup as VibrationSetup,
    SineMotion as SineMotion,
    SpiralMotion as SpiralMotion,
    StepMotion as StepMotion,
)
from flexstage.control.study.compare import (
    compare_controllers as compare_controllers,
)
from flexstage.control.study.study import (
    loop_study as loop_study,
    sensitivity_crossover as sensitivity_crossover,
)
from flexstage.control.systems.system import (
    System as System,
)
from flexstage.control.trajectory.path import (
    reference as reference,
)
from flexstage.control.trajectory.raster import (
    Raster as Raster,
)
from flexstage.control.trajectory.sine import (
    Sine as Sine,
)
from flexstage.control.trajectory.spiral import (
    Spiral as Spiral,
)
from flexstage.control.trajectory.step import (
    Step as Step,
)
from flexstage.control.tuning.objective import (
    TuningObjective as TuningObjective,
)
from flexstage.control.tuning.spec import (
    TuningSpec as TuningSpec,
)

HOMES: dict[str, str]
