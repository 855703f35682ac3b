"""Models of other packages by name. The application passes them to commands, so that packages do not import one another."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from importlib import import_module
from typing import TYPE_CHECKING, Protocol, cast

if TYPE_CHECKING:  # the table of commands loads no models
    from flexstage.analysis.dynamics.solid_modes import FeaModes
    from flexstage.mechanism.mechanism import Mechanism


class ModesModel(Protocol):
    """Function that returns the modes of a stage, or `None` if they are missing. If `computing` is false, it only reads the cache."""

    def __call__(self, mechanism: Mechanism, *, computing: bool) -> FeaModes | None:
        """Return the modes of a stage."""
        ...


@dataclass(frozen=True)
class Models:
    """Table of models: `homes` maps the name of a model to its function, "module:function". The module is imported at first use."""

    homes: Mapping[str, str]

    def modes(self, name: str) -> ModesModel:
        """Return the model with this name; raises `KeyError` if the application has no such model."""
        module, _, function = self.homes[name].partition(":")
        return cast("ModesModel", getattr(import_module(module), function))
