"""Control of a positioning stage: plant, controller, hysteresis, simulation and export."""

from flexstage.base.lazy import lazy_attributes

HOMES = {
    "systems.system": "System",
    "plant_models.electronics": "AmplifierSettings GaugeSettings sampling_chain",
    "plant_models.plants": "plant",
    "systems.closed": "LoopBreak loop",
    "robustness.stability": "verdict",
    "robustness.stability_margins": "margins",
    "noise": "noise_budget",
    "systems.exchange": "from_control to_control",
    "controllers.pi": "PI",
    "controllers.pid": "PID",
    "controllers.resonant": "IntegralResonant",
    "controllers.notch": "notch_of_mode",
    "controllers.prefilter": "Prefilter",
    "controllers.loops": "actuator_loops modal_loops platform_loops",
    "controllers.decentralised": "Decentralised",
    "tuning.objective": "TuningObjective",
    "tuning.spec": "TuningSpec",
    "trajectory.step": "Step",
    "trajectory.raster": "Raster",
    "trajectory.spiral": "Spiral",
    "trajectory.sine": "Sine",
    "trajectory.path": "reference",
    "simulation.machine": "machine",
    "simulation.run": "simulate",
    "simulation.result": "step_figures tracking",
    "hysteresis.models.inverse": "hysteresis_inverse",
    "hysteresis.models.bouc_wen": "bouc_wen",
    "hysteresis.creep": "LogCreep exponentials",
    "hysteresis.stack": "dump_hysteresis load_hysteresis stack_hysteresis",
    "hysteresis.stack_test": "stack_test",
    "study.choices": "Axes Axis Compensation ControllerKind Criterion Following Notching StackKind",
    "study.hardware.amplifiers": "ChargeSetup",
    "study.setup": (
        "AmplifierSetup ControllerSetup DampingSetup FileMotion Floor FollowSetup GaugeSetup GoalSetup HystereticStacks LoopNumbers "
        "LoopSetup AxisAmplitudes NotchSetup PrefilterSetup RasterMotion VibrationSetup SineMotion SpiralMotion StepMotion"
    ),
    "study.file": "load_setup",
    "study.compare": "compare_controllers",
    "study.study": "loop_study sensitivity_crossover",
    "show.report": "loop_report",
    "export.files": "write_controller write_fmu write_plant",
}
__getattr__, __dir__ = lazy_attributes(__name__, HOMES)
