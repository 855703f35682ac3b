"""Names of a package that are imported at first use (PEP 562): loading the package loads nothing."""

from collections.abc import Callable, Mapping
from importlib import import_module
from sys import modules


def lazy_attributes(package: str, homes: Mapping[str, str]) -> tuple[Callable[[str], object], Callable[[], list[str]]]:
    """`__getattr__` and `__dir__` of a package whose names live in the modules that `homes` gives: module below the package -> names.

    Raises `AttributeError` for other names. No name may be that of a module of the package: an import would put the module in its place.
    """
    home = {name: module for module, names in homes.items() for name in names.split()}

    def attribute(name: str) -> object:
        if name not in home:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        value = getattr(import_module(f"{package}.{home[name]}"), name)
        setattr(modules[package], name, value)
        return value

    return attribute, lambda: sorted({*home, *(name for name in vars(modules[package]) if name.startswith("__"))})
