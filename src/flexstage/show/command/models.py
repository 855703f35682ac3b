"""Models of other packages by name, passed to commands by the application: no package imports another one for its model."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from importlib import import_module
from typing import TYPE_CHECKING, Protocol, cast

if TYPE_CHECKING:  # the table of commands loads no models
    from flexstage.analysis.dynamics.solid_modes import FeaModes
    from flexstage.mechanism.mechanism import Mechanism


class ModesModel(Protocol):
    """Modal model of a stage: computed if requested, else read from the cache; `None` if there are no modes."""

    def __call__(self, mechanism: Mechanism, *, computing: bool) -> FeaModes | None:
        """The modes of a stage."""
        ...


@dataclass(frozen=True)
class Models:
    """A table of models: name -> function, as module:name. The module is imported at the first use of the model."""

    homes: Mapping[str, str]

    def modes(self, name: str) -> ModesModel:
        """The model of this name; `KeyError` if the application has none."""
        module, _, function = self.homes[name].partition(":")
        return cast("ModesModel", getattr(import_module(module), function))
