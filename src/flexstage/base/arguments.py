"""Conversion and validation of arguments according to the annotation of their field or parameter.

The annotations are the same as for files and schemas. `section: LeafSection` accepts an enum member or its spelling in files ("beam").
`Annotated[Number, LENGTH]` accepts a finite number or an array. Other values raise an error with the name of the argument.
"""

from __future__ import annotations

import difflib
import functools
import inspect
import operator
import types
import typing
from collections.abc import Callable, Iterable, Mapping
from collections.abc import Set as AbstractSet
from dataclasses import dataclass, fields, replace
from enum import Enum
from functools import partial
from typing import Annotated, Any, ClassVar, ParamSpec, TypeAlias, TypeVar, get_args, get_origin

import numpy as np

from flexstage.base.finding import DesignError, list_choices, refuse
from flexstage.base.number import Table, freeze
from flexstage.base.units.quantity import COMPLIANCE_MATRIX, DIRECTION, DIRECTIONS, STIFFNESS_MATRIX, Bound

P = ParamSpec("P")
T = TypeVar("T")

Rule: TypeAlias = Callable[[Any], Any]
"""Function that converts an argument, or raises `MismatchError`."""


@dataclass(frozen=True)
class Demand:
    """Rules of conversion: `finite` requires finite numbers, `frozen` converts mutable values to immutable ones."""

    finite: bool = True
    frozen: bool = False


GAPS = Demand(finite=False)
"""Annotation of an array that may have missing samples (NaN)."""


UNLIMITED = Demand(finite=False)
"""Annotation of a number that may be infinite (no limit)."""


WRITTEN = "WRITTEN"
"""Name of the class attribute with two texts for messages: a noun for the object, and a call that creates it (`fs.lumped(stage)`)."""


class MismatchError(Exception):
    """Argument of the wrong kind: value, expected kind, hint, and position inside the argument."""

    def __init__(self, value: Any, expected: str, advice: str) -> None:
        super().__init__(expected)
        self.value, self.expected, self.advice, self.place = value, expected, advice, ""

    def refusal(self, where: str) -> DesignError:
        """Return the error as a `DesignError` for the field or parameter `where`.

        >>> str(MismatchError(3.0, "a string", "Give a str").refusal("Leaf.material"))
        'Leaf.material: must be a string (got 3.0). Give a str.'
        """
        return refuse(where + self.place, f"must be {self.expected} (got {_shown(self.value)})", self.advice)


class CheckedFields:
    """Base class of frozen dataclasses that convert or refuse their field values at construction."""

    __slots__ = ()
    frozen_values: ClassVar[bool] = False
    """Whether field values become immutable: lists become tuples, mappings become tables, arrays become read-only."""

    def __post_init__(self) -> None:
        own = self.__dict__
        for name, rule in _field_rules(type(self)):
            try:
                own[name] = rule(own[name])
            except MismatchError as error:
                raise error.refusal(f"{type(self).__name__}.{name}") from None


def check_arguments(function: Callable[P, T]) -> Callable[P, T]:
    """Decorate a function to convert or refuse its arguments according to its annotations.

    A wrong argument raises `DesignError` with the name of its parameter. If a stage is passed instead of its model or result, a `TypeError`
    shows the probable call.

    >>> def bend(ends: tuple[str, ...], *, load: float = 1.0) -> float:
    ...     return load
    >>> check_arguments(bend)(["a", "b"], load=2)
    2.0
    >>> check_arguments(bend)("ab")
    Traceback (most recent call last):
    flexstage.base.finding.DesignError: bend: ends: must be several values (got the string 'ab'). Use a tuple or a list of them.
    """

    @functools.wraps(function)
    def call(*args: P.args, **kwargs: P.kwargs) -> T:
        positional, named = convert_arguments(function, args, kwargs)
        return function(*positional, **named)  # type: ignore[arg-type]

    return call


def convert_arguments(
    function: Callable[..., Any], args: tuple[Any, ...], kwargs: Mapping[str, Any]
) -> tuple[tuple[Any, ...], dict[str, Any]]:
    """Convert positional and keyword arguments of a call according to the function's annotations.

    >>> def bend(ends: tuple[str, ...], *, load: float = 1.0) -> float:
    ...     return load
    >>> convert_arguments(bend, (["a", "b"],), {"load": 2})
    ((('a', 'b'),), {'load': 2.0})
    """
    rules = _parameter_rules(function)
    meant, faults = dict[str, Any](), dict[str, MismatchError]()
    for name, value in (*zip(rules, args, strict=False), *kwargs.items()):
        try:
            meant[name] = rules[name](value) if name in rules else value
        except MismatchError as fault:
            faults[name] = fault
    if faults:
        raise _refusal(function, faults)
    positional = tuple(meant[name] for name, _ in zip(rules, args, strict=False))
    return (*positional, *args[len(positional) :]), {name: meant[name] for name in kwargs}


def _refusal(function: Callable[..., Any], faults: Mapping[str, MismatchError]) -> Exception:
    for fault in faults.values():
        given = getattr(fault.value, WRITTEN, ())
        call = _meant_call(function, faults)
        if given and call:
            return TypeError(f"{function.__name__} takes {fault.expected}, not {given[0]}: {call}")
    name, fault = next(iter(faults.items()))
    return fault.refusal(f"{function.__name__}: {name}")


def _meant_call(function: Callable[..., Any], faults: Mapping[str, MismatchError]) -> str:
    """Text of the correct call with required and wrong parameters; empty if none is created from a stage."""
    hints, written, made = typing.get_type_hints(function), list[str](), False
    for name, each in inspect.signature(function).parameters.items():
        kinds = (hints.get(name), *get_args(hints.get(name)))
        how = next((getattr(kind, WRITTEN)[1] for kind in kinds if hasattr(kind, WRITTEN)), "")
        if name in faults or (each.default is each.empty and (how or each.kind is each.POSITIONAL_OR_KEYWORD)):
            made |= "(" in how
            written.append(f"{name}={how}" if how and each.kind is each.KEYWORD_ONLY else how or name)
    return f"{function.__name__}({', '.join(written)})" if made else ""


@functools.cache
def _field_rules(cls: type) -> tuple[tuple[str, Rule], ...]:
    hints = typing.get_type_hints(cls, include_extras=True)
    return tuple((each.name, _parameter_rule(hints[each.name], each.default, frozen=cls.frozen_values)) for each in fields(cls))


@functools.cache
def _parameter_rules(function: Callable[..., Any]) -> Mapping[str, Rule]:
    hints = typing.get_type_hints(function, include_extras=True)
    return {name: _parameter_rule(hints.get(name, Any), each.default) for name, each in inspect.signature(function).parameters.items()}


def _parameter_rule(hint: Any, default: Any, *, frozen: bool = False) -> Rule:
    """Rule of a field or parameter; a default that is not finite allows infinite values."""
    return _rule(hint, Demand(finite=not (isinstance(default, float) and np.isinf(default)), frozen=frozen))


# --- rules of annotations ---


def _rule(hint: Any, demand: Demand) -> Rule:
    origin, args = get_origin(hint), get_args(hint)
    if origin is Annotated:
        return _annotated_rule(args[0], args[1:], demand)
    if origin in (types.UnionType, typing.Union):
        return _union_rule(args, demand)
    if origin is np.ndarray:
        return partial(_array, demand)
    if origin is tuple and Ellipsis not in args:
        return partial(_row, [_rule(each, demand) for each in args])
    if origin is Callable:
        return _function
    if isinstance(origin, type) and issubclass(origin, Mapping):
        return partial(_frozen_table if demand.frozen else _table, _rule(args[1], demand))
    if isinstance(origin, type) and issubclass(origin, Iterable):
        return partial(_items, frozenset if issubclass(origin, AbstractSet) else tuple, _rule(args[0], demand))
    return _plain_rule(origin or hint, demand)


def _annotated_rule(inner: Any, extras: tuple[Any, ...], demand: Demand) -> Rule:
    bound = next((each for each in extras if isinstance(each, Bound)), None)
    node = next((each for each in extras if hasattr(each, "words")), None)
    if node is not None:
        return partial(_word, node)
    if inner is int and bound is not None:
        return partial(_whole, bound)
    if DIRECTION in extras:
        return partial(_direction, _rule(inner, demand))
    if COMPLIANCE_MATRIX in extras or STIFFNESS_MATRIX in extras:
        return partial(_row, [partial(_row, [partial(_number, demand)] * 6)] * 6)
    return _rule(inner, replace(demand, finite=False) if any(isinstance(each, Demand) for each in extras) else demand)


def _union_rule(hints: tuple[Any, ...], demand: Demand) -> Rule:
    inner = [each for each in hints if each is not types.NoneType]
    if float in inner and any(get_origin(each) is np.ndarray for each in inner):
        rules = [_rule(each, demand) for each in inner if each is not float and get_origin(each) is not np.ndarray]
        rules.append(partial(_number, demand))
    else:
        rules = [_rule(each, demand) for each in inner]
    rule = rules[0] if len(rules) == 1 else partial(_first_fitting, rules)
    return partial(_optional, rule) if types.NoneType in hints else rule


def _plain_rule(hint: Any, demand: Demand) -> Rule:
    simple: dict[Any, Rule] = {float: partial(_real, demand), int: partial(_whole, None), bool: _flag, str: _text}
    if hint in simple:
        return simple[hint]
    if not isinstance(hint, type) or hint in (Any, object):
        return freeze if demand.frozen else _as_it_is
    if issubclass(hint, Enum):
        return partial(_choice, hint, {each.value: each for each in hint if isinstance(each.value, str)})
    return partial(_protocol, hint) if getattr(hint, "_is_protocol", False) else partial(_instance, hint)


def _as_it_is(value: Any) -> Any:
    return value


def _optional(rule: Rule, value: Any) -> Any:
    return None if value is None else rule(value)


def _first_fitting(rules: list[Rule], value: Any) -> Any:
    results = list[MismatchError]()
    for rule in rules:
        try:
            return rule(value)
        except MismatchError as error:
            results.append(error)
    inside = next((each for each in results if each.value is not value), None)
    if inside is not None:
        raise inside
    raise MismatchError(value, " or ".join(dict.fromkeys(each.expected for each in results)), results[0].advice)


def _choice(kind: type[Enum], words: Mapping[str, Enum], value: Any) -> Any:
    if type(value) is kind:
        return value
    if isinstance(value, str) and value in words:
        return words[value]
    raise _no_word(value, list(words) or [f"{kind.__name__}.{each.name}" for each in kind])


def _word(node: Any, value: Any) -> Any:
    """A choice of a node: a member, or its spelling."""
    words = node.words
    if type(value) is str and value in words:
        return words[value]
    if value in words.values():
        return value
    raise _no_word(value, list(words))


def _no_word(value: Any, words: list[str]) -> MismatchError:
    near = difflib.get_close_matches(str(value)[:80], words, n=1, cutoff=0.0)
    return MismatchError(value, list_choices(words), f'Use e.g. "{near[0]}"')


def _text(value: Any) -> Any:
    if isinstance(value, str):
        return value
    raise MismatchError(value, "a string", "Give a str")


def _flag(value: Any) -> Any:
    if isinstance(value, bool | np.bool_):
        return bool(value)
    raise MismatchError(value, "True or False", "Give a bool")


def _whole(bound: Bound | None, value: Any) -> Any:
    if isinstance(value, bool) or not isinstance(value, int | np.integer):
        raise MismatchError(value, "a whole number", "Give an int")
    if bound is not None and not bound.low <= value <= bound.high:
        raise MismatchError(value, f"a whole number, {bound.whole()}", "Use an int within these limits")
    return int(value)


def _real(demand: Demand, value: Any) -> Any:
    """A real number as a float."""
    if type(value) is not float:
        if isinstance(value, np.ndarray) and value.ndim == 0:
            value = value.item()
        if isinstance(value, bool) or not isinstance(value, int | float | np.integer | np.floating):
            raise _no_number(value)
        value = _as_float(value)
    if value - value == 0.0 or not (demand.finite or np.isnan(value)):
        return value
    raise MismatchError(value, "a finite number", "Give a finite number")


def _number(demand: Demand, value: Any) -> Any:
    """A number or an array of them, real or complex."""
    if isinstance(value, list) or (isinstance(value, np.ndarray) and value.ndim):
        return _array(demand, value)
    if isinstance(value, complex | np.complexfloating):
        return complex(value)
    return _real(demand, value)


def _as_float(value: Any) -> float:
    try:
        return float(value)
    except OverflowError:
        return float("inf")


def _no_number(value: Any) -> MismatchError:
    advice = "Use a number in SI units, e.g. 0.4 * fs.mm; strings with units are for design files (fs.load)"
    return MismatchError(value, "a number", advice if isinstance(value, str) else "Use a number or an array in SI units")


def _array(demand: Demand, value: Any) -> Any:
    if getattr(value, "__array_ufunc__", _array) is None:  # an array-like object, e.g. a sparse matrix
        return value
    array = _as_array(value) if isinstance(value, list | tuple) else value
    if not isinstance(array, np.ndarray) or array.dtype.kind not in "fciu":
        raise MismatchError(value, "an array of numbers", "Use a numpy array in SI units")
    if demand.finite and not (finite := np.isfinite(array)).all():
        index = tuple(np.argwhere(~finite)[0])
        fault = MismatchError(float(np.real(array[index])), "a finite number", "Give finite numbers")
        fault.place = f" at index {', '.join(map(str, index))}"
        raise fault
    return freeze(array) if demand.frozen else array


def _as_array(value: Any) -> Any:
    try:
        return np.array(value)
    except ValueError:  # its rows have different lengths
        return value


def _direction(rule: Rule, value: Any) -> Any:
    if isinstance(value, str):
        if value not in DIRECTIONS:
            raise _no_word(value, list(DIRECTIONS))
        return DIRECTIONS[value]
    return rule(value)


def _row(rules: list[Rule], value: Any) -> Any:
    """One value per rule."""
    if not isinstance(value, tuple | list) or len(value) != len(rules):
        raise MismatchError(value, f"{len(rules)} values", "Use a tuple of them")
    return tuple(_inside(rule, str(place), each) for place, (rule, each) in enumerate(zip(rules, value, strict=True)))


def _items(kind: type, rule: Rule, value: Any) -> Any:
    """Any number of values."""
    if isinstance(value, str | bytes | Mapping) or not isinstance(value, Iterable) or isinstance(value, np.ndarray):
        raise MismatchError(value, "several values", "Use a tuple or a list of them")
    return kind(_inside(rule, str(place), each) for place, each in enumerate(value))


def _table(rule: Rule, value: Any) -> Any:
    items = _items_by_name(rule, value)
    return value if all(map(operator.is_, value.values(), items.values())) else items


def _frozen_table(rule: Rule, value: Any) -> Any:
    return Table(_items_by_name(rule, value))


def _items_by_name(rule: Rule, value: Any) -> dict[str, Any]:
    if not isinstance(value, Mapping) or not all(isinstance(name, str) for name in value):
        raise MismatchError(value, "values by name", "Use a dict with names as keys")
    return {name: _inside(rule, name, each) for name, each in value.items()}


def _inside(rule: Rule, place: str, value: Any) -> Any:
    try:
        return rule(value)
    except MismatchError as error:
        error.place = f".{place}{error.place}"
        raise


def _function(value: Any) -> Any:
    if callable(value):
        return value
    raise MismatchError(value, "a function", "Give a function")


def _instance(kind: type, value: Any) -> Any:
    if isinstance(value, kind):
        return value
    raise _no_instance(value, kind)


def _no_instance(value: Any, kind: type) -> MismatchError:
    name = f"an {kind.__name__}" if kind.__name__[0] in "AEIO" else f"a {kind.__name__}"
    return MismatchError(value, getattr(kind, WRITTEN, (name,))[0], f"Give {name}")


def _protocol(kind: type, value: Any) -> Any:
    names = {name for base in kind.__mro__ if getattr(base, "_is_protocol", False) for name in vars(base) | base.__annotations__}
    if all(hasattr(value, name) for name in names if not name.startswith("_")):
        return value
    raise _no_instance(value, kind)


def _shown(value: Any) -> str:
    text = f"the string {value!r}" if isinstance(value, str) else "None" if value is None else _of_class(value)
    return text if len(text) <= 60 else f"{text[:60]}..."


def _of_class(value: Any) -> str:
    return repr(value) if isinstance(value, int | float | complex | tuple | list | Enum) else f"a {type(value).__name__}"
