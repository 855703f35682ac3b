"""Error codes of the General Command Set, reported by `ERR?`."""

from __future__ import annotations

from enum import IntEnum


class Code(IntEnum):
    """Error codes of the virtual controller, from the manual MS249E (section 8.7, "Error Codes"), and codes of the wave generator."""

    NO_ERROR = 0
    PARAMETER_SYNTAX = 1
    UNKNOWN_COMMAND = 2
    COMMAND_TOO_LONG = 3
    SERVO_OFF = 5
    POSITION_OUT_OF_LIMITS = 7
    VELOCITY_OUT_OF_LIMITS = 8
    STOPPED = 10
    INVALID_AXIS = 15
    PARAMETER_OUT_OF_RANGE = 17
    DOUBLE_AXIS = 22
    NUMBER_OF_PARAMETERS = 24
    INVALID_NUMBER = 25
    UNKNOWN_PARAMETER = 54
    INVALID_RECORDER_TABLE = 57
    INVALID_RECORDER_OPTION = 58
    INVALID_RECORDER_SOURCE = 59
    WAVE_TOO_LARGE = 67
    WAVE_GENERATOR_ACTIVE = 73
    NO_WAVE_SELECTED = 75
    NOT_ENOUGH_RECORDED = 77
    WAVE_TYPE = 402
    LOOP_UNSTABLE = 506


class CommandError(Exception):
    """Refusal of a command, with an error `code`."""

    def __init__(self, code: Code) -> None:
        super().__init__(code.name)
        self.code = code
