"""Materials, a stack and a gauge of the shipped stages, for stages that tests draw."""

from flexstage.cases.registry import case

_STAGE = case("parallelogram")
ALUMINIUM, STEEL = _STAGE.materials["aluminium"], _STAGE.materials["steel"]
SLIM_STACK, GAUGE = _STAGE.parts["stack"], _STAGE.sensors["probe"]
