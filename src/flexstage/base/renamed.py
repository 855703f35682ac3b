"""Old names of options, keys and Python objects, refused with the new name."""

from collections.abc import Collection

_TEXT = """
--reading --model          --at --point                --load-at --load-point        --points --steps          --hold --fixed
--beyond --post-buckling   --side --branch            --copy --instance         --size --amount
--about --rotation         --along --translation       --inputs --input-quantity     --tap --input-signal      --noise --drive-rms
--noise --input-asd        --allow --accept-fault      --only --channels             --resolution --frequency-resolution
--command --amplitude      --sensitivity --max-sensitivity                           --follow --tracking       --compensate --feedforward
--damping --force-feedback --goal --tune-for           --single --float32            --fast --no-realtime      --free --parameters
--parameter --parameters   --parameters --list-parameters                            --parameter --case-parameter
--what --scope             --of kind

reading model              place placements            require requirements          change overrides          mode_limit max_mode_frequency
stands_for replaces        gap_back gap_negative       warmth face_temperature_difference                      removes subtract
left residual_hysteresis   by method                   by amplitude                  of axes                   of address
each independent           aim objective               given compliance_matrix

stance operating_point     Stance OperatingPoint       critical critical_load        critical_factors buckling_factors
trace continuation         branch post_buckling_path   path load_path                slopes gradients          over_designs evaluate_designs
Effort SolverOptions       Given ComplianceMatrix      Positive SensorSense          Facing InstanceOrientation
Opening Aperture           reach force_workspace       ForceReach ForceWorkspace     play animate
Cut LoopBreak              Aim TuningObjective         Goal TuningSpec               hardware sampling_chain   NotchAt NotchSetup
PrefilterAt PrefilterSetup Motion AxisAmplitudes       Needs RecordRequirements      Known Prior               Allow FaultTolerance
Tap InputSignal            Recorded InputQuantity      load_wanted load_optimisation Wanted OptimisationProblem
"""
_WORDS = iter(_TEXT.split())
RENAMED = tuple(zip(_WORDS, _WORDS, strict=True))
"""Pairs of an old and a new name. An old name may have several new names, each for another command or file."""


def new_name(old: str, known: Collection[str]) -> str | None:
    """Return the `known` name that replaced the name `old`; `None` if no known name replaced it, or if `old` itself is known.

    >>> new_name("mode_limit", ["name", "max_mode_frequency"]), new_name("by", ["by", "method"])
    ('max_mode_frequency', None)
    """
    return next((new for before, new in RENAMED if before == old and old not in known and new in known), None)
