"""Arguments of the whole public surface: the spelling of files is understood, anything else is refused under the parameter's name.

All is made of signatures and annotations: a new class, function or parameter is tested as soon as it is public.
"""

from __future__ import annotations

import functools
import inspect
import types
import typing
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import chdir
from dataclasses import MISSING, fields, is_dataclass
from enum import Enum
from pathlib import Path
from typing import Annotated, Any, get_args, get_origin
from unittest.mock import MagicMock

import numpy as np
import pytest

import flexstage as fs
from flexstage.base.arguments import GAPS, CheckedFields, convert_arguments
from flexstage.base.units.quantity import COMPLIANCE_MATRIX, STIFFNESS_MATRIX, Bound, Quantity
from flexstage.control.plant_models.electronics import Hardware
from flexstage.control.plant_models.plants import Plant
from flexstage.control.trajectory.path import Trajectory
from flexstage.models.linear.kinematics import Kinematics
from flexstage.models.linear.model import Channel
from flexstage.models.nonlinear.equilibrium import State
from flexstage.models.nonlinear.stage import Nonlinear
from tests.hygiene.test_surface import EVERY, NAMESPACES

NAN, INFINITE = float("nan"), float("inf")
PUBLIC = [getattr(NAMESPACES[package], name) for package, name in EVERY]
FUNCTIONS = [each for each in PUBLIC if inspect.isfunction(each)]
CLASSES = [each for each in PUBLIC if is_dataclass(each)]
CALLED = [*FUNCTIONS, *CLASSES]


@functools.cache
def hints_of(called: Any) -> dict[str, Any]:
    hints = typing.get_type_hints(called, include_extras=True)
    return {name: hints[name] for name in inspect.signature(called).parameters}


def alternatives(hint: Any) -> Iterator[tuple[Any, tuple[Any, ...]]]:
    """What a value may be, each with its annotations: the members of unions."""
    if get_origin(hint) is Annotated:
        inner, *extras = get_args(hint)
        yield from ((each, (*extras, *own)) for each, own in alternatives(inner))
    elif get_origin(hint) in (typing.Union, types.UnionType):
        for each in get_args(hint):
            yield from alternatives(each)
    else:
        yield hint, ()


def is_container(kind: Any) -> bool:
    origin = get_origin(kind)
    return isinstance(origin, type) and issubclass(origin, Iterable) and origin is not np.ndarray


def is_mapping(kind: Any) -> bool:
    origin = get_origin(kind)
    return isinstance(origin, type) and issubclass(origin, Mapping)


def sample(hint: Any) -> Any:
    """A value of the kind, as a call would give it."""
    kind, extras = next(iter(alternatives(hint)))
    origin, args = get_origin(kind), get_args(kind)
    if {COMPLIANCE_MATRIX, STIFFNESS_MATRIX} & {each for each in extras if isinstance(each, Quantity)}:
        return ((1.0,) * 6,) * 6
    if origin is tuple and Ellipsis not in args:
        return tuple(sample(each) for each in args)
    if is_container(kind):
        return {} if is_mapping(kind) else ()
    if origin is np.ndarray:
        return np.ones((1, 1))
    if kind is int:
        return int(next((max(each.low, 0.0) for each in extras if isinstance(each, Bound)), 1))
    simple = {float: 1.0, str: "name", bool: True, Any: None}
    if kind in simple:
        return simple[kind]
    if isinstance(kind, type) and issubclass(kind, Enum):
        return next(iter(kind))
    if isinstance(kind, type) and issubclass(kind, CheckedFields) and not inspect.isabstract(kind):
        made = object.__new__(kind)
        vars(made).update({each.name: None for each in fields(kind) if each.default is MISSING}) if is_dataclass(kind) else None
        return made
    return object.__new__(kind) if isinstance(kind, type) and not getattr(kind, "_is_protocol", False) else MagicMock()


def spellings(hint: Any) -> Iterator[tuple[Any, Any]]:
    """What files write, and what it means, of every choice that a hint has."""
    for kind, extras in alternatives(hint):
        node = next((each for each in extras if hasattr(each, "words")), None)
        if node is not None:
            yield from node.words.items()
        elif isinstance(kind, type) and issubclass(kind, Enum):
            yield from ((each.value, each) for each in kind if isinstance(each.value, str))
        elif is_container(kind) and not is_mapping(kind):
            as_kind = frozenset if get_origin(kind) is frozenset else tuple
            yield from (([word], as_kind([member])) for word, member in spellings(get_args(kind)[0]))


def nonsense(hint: Any, default: Any) -> Iterator[Any]:
    """Values that no parameter of the hint may take."""
    kinds = [kind for kind, _ in alternatives(hint)]
    if Any in kinds:
        return
    items = [get_args(kind) for kind in kinds if is_container(kind)]
    names = [args[-2] if args[-1] is Ellipsis else args[-1] for args in items]
    numbers = float in kinds or any(get_origin(kind) is np.ndarray for kind in kinds)
    yield object()
    if str not in kinds:
        yield from ("nonsense", "0.4 mm")
    if float not in kinds:
        yield 3.5
    if bool not in kinds:
        yield True
    finite = not any(GAPS in extras for _, extras in alternatives(hint))
    if numbers and finite:
        yield from (NAN, np.array([1.0, NAN]))
    if numbers and finite and default != INFINITE:
        yield INFINITE
    if names and Any not in names:
        yield from ((object(),), {"nonsense": object()}, {1: 1.0})
    if types.NoneType not in kinds and default is not None:
        yield None


def parameters(every: list[Any]) -> list[tuple[Any, str]]:
    return [(called, name) for called in every for name in inspect.signature(called).parameters]


def name_of(value: Any) -> str:
    return value if isinstance(value, str) else f"{value.__module__.rpartition('.')[2]}.{value.__name__}"


def arguments_with(called: Any, name: str, value: Any) -> dict[str, Any]:
    """Arguments of a call: what it needs, and one of them in particular."""
    hints = hints_of(called)
    needed = {each.name: sample(hints[each.name]) for each in inspect.signature(called).parameters.values() if each.default is each.empty}
    return needed | {name: value}


@pytest.mark.parametrize("called", CALLED, ids=name_of)
def test_nonsense_is_refused_under_the_name_of_the_parameter(called: Any) -> None:
    for name, each in inspect.signature(called).parameters.items():
        for value in nonsense(hints_of(called)[name], each.default):
            with pytest.raises((fs.DesignError, TypeError, ValueError), match=rf"{called.__name__}(\.|: ){name}\b"):
                called(**arguments_with(called, name, value))


def choices(every: list[Any]) -> list[tuple[Any, str]]:
    return [(called, name) for called, name in parameters(every) if any(spellings(hints_of(called)[name]))]


@pytest.mark.parametrize(("made", "name"), choices(CLASSES), ids=name_of)
def test_classes_understand_the_spelling_of_files(made: Any, name: str) -> None:
    for word, member in spellings(hints_of(made)[name]):
        for value in (word, member):
            assert getattr(made(**arguments_with(made, name, value)), name) == member


@pytest.mark.parametrize(("function", "name"), choices(FUNCTIONS), ids=name_of)
def test_functions_understand_the_spelling_of_files(function: Any, name: str) -> None:
    for word, member in spellings(hints_of(function)[name]):
        for value in (word, member):
            assert convert_arguments(function, (), arguments_with(function, name, value))[1][name] == member


def test_the_surface_has_choices_names_and_numbers() -> None:
    assert len(choices(CLASSES)) > 30
    assert len(choices(FUNCTIONS)) >= 4
    assert len(parameters(CALLED)) > 500


# --- names of what is not there ---

FREE = {"where", "source", "about", "text", "states", "mount.name", "force_workspace.point"}
"""Parameters that take any text, or are refused on other stages: `force_workspace` is for forces."""


@functools.cache
def stage() -> fs.Mechanism:
    return fs.case("parallelogram")


MADE: dict[Any, Callable[[], Any]] = {
    fs.Mechanism: stage,
    fs.LinearModel: lambda: fs.lumped(stage()),
    Kinematics: lambda: fs.ideal(stage()),
    Nonlinear: lambda: fs.nonlinear(stage()),
    State: lambda: fs.equilibrium(made(Nonlinear)),
    Hardware: lambda: fs.control.sampling_chain(stage(), rate=1e4),
    Plant: lambda: fs.control.plant(made(fs.LinearModel), made(Kinematics), made(Hardware)),
    fs.experiment.RigSetup: lambda: fs.experiment.RigSetup(seconds=10.0),
    fs.control.System: lambda: fs.control.System(np.eye(1), np.eye(1), np.eye(1), np.eye(1), (Channel("u", "V"),), (Channel("y", "m"),)),
    fs.Spectrum: lambda: fs.Spectrum(1e-18),
    Trajectory: lambda: fs.control.Sine({"x": 1e-6}, 10.0),
}
"""What parameters of these classes are given."""

REAL: dict[str, Any] = {
    "axis": "x",
    "copy": "left",
    "size": 1e-4,
    "drive": "platform.x",
    "name": "parallelogram",
    "times": np.arange(3.0),
    "on": "ground",
    "values": np.array([0.0, 1e-6]),
    "outputs": ("platform",),
    "inputs": ("B",),
    "load": {"platform.fx": 1.0},
    "command": {"x": 1e-6},
    "spectra": {"ground.x": fs.Spectrum(1e-18)},
    "band": (1.0, 9.0),
    "names": ("parts.leaf.width",),
    "coordinates": ("x",),
    "results": lambda state: state.position,
}
"""What required parameters of these names are given."""


@functools.cache
def made(kind: Any) -> Any:
    return MADE[kind]()


def named(every: list[Any]) -> list[tuple[Any, str]]:
    """Functions that can be called here with each of their parameters that takes names of something in a stage."""
    found = list[tuple[Any, str]]()
    for function in every:
        hints, signature = hints_of(function), inspect.signature(function).parameters
        free = {name for name in signature if {name, f"{function.__name__}.{name}"} & FREE}
        taken = [name for name in signature if name not in free and any(text_form(hints[name]))]
        needed = [name for name, each in signature.items() if each.default is each.empty]
        found += [(function, name) for name in taken if all(each in REAL or hints[each] in MADE for each in needed)]
    return found


def text_form(hint: Any) -> Iterator[Any]:
    """A name that nothing has, in the form that the hint asks for."""
    for kind, _ in alternatives(hint):
        items = get_args(kind)
        if kind is str:
            yield "nonsense"
        elif is_container(kind) and items[0] is str and is_mapping(kind):
            yield {"nonsense": made(items[1]) if items[1] in MADE else sample(items[1])}
        elif is_container(kind) and items[0] is str:
            yield ("nonsense",) * len(items) if Ellipsis not in items else ("nonsense",)


@pytest.mark.parametrize(("function", "name"), named(FUNCTIONS), ids=name_of)
def test_names_of_nothing_are_refused_with_what_there_is(function: Any, name: str, tmp_path: Path) -> None:
    hints = hints_of(function)
    needed = [each.name for each in inspect.signature(function).parameters.values() if each.default is each.empty]
    given = {each: REAL[each] if each in REAL else made(hints[each]) for each in needed}
    for value in text_form(hints[name]):
        with pytest.raises(fs.DesignError, match="nonsense"), chdir(tmp_path):
            function(**given | {name: value})


def test_names_are_tested() -> None:
    assert len(named(FUNCTIONS)) > 40


def test_a_point_of_nothing_is_refused_where_forces_drive_the_stage() -> None:
    driven = fs.case("voice-coil-xy")
    with pytest.raises(fs.DesignError, match="nonsense"):
        fs.force_workspace(driven, fs.ideal(driven), fs.lumped(driven), point="nonsense")
