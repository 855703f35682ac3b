"""What analyses take: a description in the place of a model is refused, and the call that was meant is said."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from inspect import Parameter, signature
from typing import ParamSpec, TypeVar

from flexstage.mechanism.mechanism import Mechanism

P = ParamSpec("P")
T = TypeVar("T")

_MODELS = {"LinearModel": "fs.lumped(stage)", "Kinematics": "fs.ideal(stage)"}
_WRITTEN = {**_MODELS, "Mechanism": "stage"}


def takes_models(function: Callable[P, T]) -> Callable[P, T]:
    """The function, which refuses a description (`Mechanism`) where its annotations ask for a `LinearModel` or for `Kinematics`.

    Raises `TypeError` with the call that was probably meant, the stage modelled by lumped hinges and its kinematics by ideal ones.

    >>> import flexstage as fs
    >>> fs.modes(fs.case("parallelogram"))
    Traceback (most recent call last):
    TypeError: modes takes a model, not a description: modes(fs.lumped(stage))
    """
    parameters = signature(function).parameters.values()
    asked = {each.name: str(each.annotation).partition(" |")[0] for each in parameters}
    places = [(place, each.name) for place, each in enumerate(parameters) if asked[each.name] in _MODELS]
    needed = [_written(each, asked[each.name]) for each in parameters if _is_needed(each) or asked[each.name] in _MODELS]
    meant = f"{function.__name__}({', '.join(needed)})"

    @wraps(function)
    def check_arguments(*args: P.args, **kwargs: P.kwargs) -> T:
        for place, name in places:
            if isinstance(args[place] if place < len(args) else kwargs.get(name), Mechanism):
                raise TypeError(f"{function.__name__} takes a model, not a description: {meant}")
        return function(*args, **kwargs)

    return check_arguments


def _written(parameter: Parameter, asked: str) -> str:
    """An argument as a call writes it."""
    value = _WRITTEN.get(asked, parameter.name)
    return f"{parameter.name}={value}" if parameter.kind is Parameter.KEYWORD_ONLY else value


def _is_needed(parameter: Parameter) -> bool:
    return parameter.default is Parameter.empty and parameter.kind is Parameter.POSITIONAL_OR_KEYWORD
