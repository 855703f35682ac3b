"""Lazy import of the names of a package (PEP 562) and of rarely used modules."""

from collections.abc import Callable, Mapping
from importlib import import_module
from sys import modules
from typing import Any

from flexstage.base.renamed import new_name


def lazy_attributes(package: str, homes: Mapping[str, str]) -> tuple[Callable[[str], object], Callable[[], list[str]]]:
    """Return `__getattr__` and `__dir__` of a package whose names are imported at first use.

    `homes` maps each module below the package to the names that this module provides. Other names raise `AttributeError`. A name must not
    also be the name of a module in the package: importing that module would replace the name.
    """
    home = {name: module for module, names in homes.items() for name in names.split()}

    def attribute(name: str) -> object:
        if name not in home:
            renamed = new_name(name, home)
            raise AttributeError(f"module {package!r} has no attribute {name!r}" + (f": it is called {renamed!r}" if renamed else ""))
        value = getattr(import_module(f"{package}.{home[name]}"), name)
        setattr(modules[package], name, value)
        return value

    return attribute, lambda: sorted({*home, *(name for name in vars(modules[package]) if name.startswith("__"))})


class LazyModule:
    """Stand-in for the module with the given full name; the module is imported at first use.

    >>> LazyModule("math").floor(1.5)
    1
    """

    def __init__(self, module: str) -> None:
        self._module = module

    def __getattr__(self, name: str) -> Any:
        """Return an attribute of the module. Raises `AttributeError` for an unknown name, and `ImportError` if the module is missing."""
        return getattr(import_module(self._module), name)
