"""Models of other wings by name, as the application hands them to commands: no wing imports another one for its model."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from importlib import import_module
from typing import TYPE_CHECKING, Protocol, cast

if TYPE_CHECKING:  # the table of commands hands models and loads nothing heavy
    from flexstage.analysis.dynamics.solid_modes import FeaModes
    from flexstage.mechanism.mechanism import Mechanism


class ModesModel(Protocol):
    """A model that gives modes of a stage: computed if asked for, else those that are kept; `None` where there are none."""

    def __call__(self, mechanism: Mechanism, *, computing: bool) -> FeaModes | None:
        """The modes of a stage."""
        ...


@dataclass(frozen=True)
class Models:
    """A table of models: name -> function, stated as module:name. The module is imported when the model is asked for."""

    homes: Mapping[str, str]

    def modes(self, name: str) -> ModesModel:
        """The model of this name; `KeyError` where the application hands none."""
        module, _, function = self.homes[name].partition(":")
        return cast("ModesModel", getattr(import_module(module), function))
