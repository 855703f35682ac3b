"""What is imported at first use: names of a package (PEP 562), and modules that few calls of their importer need."""

from collections.abc import Callable, Mapping
from importlib import import_module
from sys import modules
from typing import Any

from flexstage.base.renamed import new_name


def lazy_attributes(package: str, homes: Mapping[str, str]) -> tuple[Callable[[str], object], Callable[[], list[str]]]:
    """`__getattr__` and `__dir__` of a package whose names live in the modules that `homes` gives: module below the package -> names.

    Raises `AttributeError` for other names. No name may be that of a module of the package: an import would put the module in its place.
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


class Late:
    """A module by its whole name, imported when the first of its names is asked for; type checkers are shown the import itself.

    >>> Late("math").floor(1.5)
    1
    """

    def __init__(self, module: str) -> None:
        self._module = module

    def __getattr__(self, name: str) -> Any:
        """A name of the module. Raises `AttributeError` for others, and `ImportError` where the module itself is missing."""
        return getattr(import_module(self._module), name)
