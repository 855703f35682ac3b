"""The design file of a command: check of outputs, reading of the file, changes by `--set`, model and named points."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, TypeAlias

from flexstage.analysis.complete import loaded_model, read
from flexstage.analysis.loaded.load_effect import load_effect
from flexstage.base.finding import DesignError, Finding, refuse, require, suggest_nearest
from flexstage.base.units.expression import parse_expression
from flexstage.mechanism.addresses.address import assign
from flexstage.mechanism.checks import require_valid
from flexstage.mechanism.mechanism import Mechanism
from flexstage.mechanism.store import load
from flexstage.models.linear.model import LinearModel
from flexstage.models.theory import Model
from flexstage.show.command.options import Changes, Design, ElasticBodies
from flexstage.show.command.output import require_writable
from flexstage.show.command.terminal import print_note
from flexstage.spatial.frame import COMPONENTS


@dataclass(frozen=True)
class DesignOptions:
    """Design file of a command, and options for changed values."""

    design: Design
    changes: Changes = None

    def open(self) -> Mechanism:
        """Read the description and apply the changes. Raises `DesignError` with all errors."""
        return open_design(self.design, self.changes)


Lumped: TypeAlias = Annotated[Mechanism, "a lumped model may include the flexibility of its bodies"]
"""The description that a command with the lumped model reads."""


@dataclass(frozen=True)
class LumpedOptions(DesignOptions):
    """Design-file options of a command that uses the lumped model."""

    elastic_bodies: ElasticBodies = False

    def open(self) -> Mechanism:
        """Read the description and apply the changes, with flexible bodies if requested."""
        return with_elastic_bodies(super().open(), chosen=self.elastic_bodies)


def with_elastic_bodies(mechanism: Mechanism, *, chosen: bool) -> Mechanism:
    """Return the description, with flexible bodies in its lumped model if `chosen`."""
    return replace(mechanism, elastic_bodies=True) if chosen else mechanism


def open_design(path: Path, changes: Sequence[str] | None = None, outputs: Sequence[tuple[str, str | Path | None]] = ()) -> Mechanism:
    """Check that the outputs (pairs of option and path) are writable, then read a description and apply the changes.

    Raises `DesignError` with all errors.
    """
    require_writable(outputs, [path])
    return change(load(path), changes or ())


def change(mechanism: Mechanism, changes: Sequence[str]) -> Mechanism:
    """Apply assignments (ADDRESS=VALUE) to a description and check the result; raises `DesignError` with all errors.

    Prints a note to stderr for each formula that an assignment replaces.
    """
    findings: list[Finding] = []
    result = mechanism
    for text in changes:
        try:
            result = assign(result, text)
        except DesignError as error:
            findings += [Finding(_where(text, each.where), each.what, each.advice) for each in error.findings]
    require(findings)
    for address, text in mechanism.formulas.items():
        if address not in result.formulas:
            numbers = " or ".join(f"numbers.{name}" for name in sorted(parse_expression(text).names))
            advice = f". To change all dependent values, set {numbers}" if numbers else ""
            print_note(f'note: the value of {address} replaces its formula "{text}"{advice}')
    return _valid(result, changes) if changes else mechanism


def _valid(mechanism: Mechanism, changes: Sequence[str]) -> Mechanism:
    """The checked description; errors of an assigned number name the assignment."""
    assigned = {text.partition("=")[0].strip(): text for text in changes}
    places = {place: text for address, text in assigned.items() for place in (address, f'overrides."{address}"')}
    try:
        return require_valid(mechanism)
    except DesignError as error:
        named = (replace(each, where=f"--set {places[each.where]}") if each.where in places else each for each in error.findings)
        raise DesignError(named) from None


def _where(text: str, inner: str) -> str:
    """The assignment, and the location of an error if it adds information."""
    parts = {text.partition("=")[0].strip(), f'"{text}"'}
    return f"--set {text}" if inner in parts else f"--set {text}: {inner}"


def elastic_model(mechanism: Mechanism, model: Model, *, loaded: bool = False) -> LinearModel:
    """Return the linear model of a stage; raises `DesignError` for the ideal model.

    If `loaded`, the model includes the effect of a significant permanent load.
    """
    linear = loaded_model(mechanism, model) if loaded else read(mechanism, model)
    if linear is None:
        raise refuse("--model ideal", "the ideal model has no stiffness, no lost motion and no modes", "Use --model lumped or mapped")
    return linear


def load_notes(mechanism: Mechanism, model: Model) -> tuple[str, ...]:
    """Return the sentence on the permanent load if `model` is the lumped model and the load is significant; otherwise nothing."""
    effect = load_effect(mechanism) if model is Model.LUMPED else None
    return () if effect is None or effect.model is None else (effect.text,)


def known_point(model: LinearModel, name: str, option: str) -> str:
    """Return the name of a body or point whose twist the model computes. Raises `DesignError` with similar names for an unknown name."""
    outputs = [channel.name.rpartition(".") for channel in model.outputs]
    places = dict.fromkeys(place for place, _, component in outputs if component in COMPONENTS)
    if name not in places:
        raise refuse(option, f"unknown body or point {name}", suggest_nearest(name, places))
    return name
