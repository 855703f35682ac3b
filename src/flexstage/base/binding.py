"""Compiled modules of scipy without the packages they stand in, a fifth to half a second of imports."""

from __future__ import annotations

import sys
from contextlib import suppress
from functools import cache
from importlib import import_module
from importlib.machinery import PathFinder
from importlib.util import find_spec, module_from_spec
from typing import Any


@cache
def binding(name: str, whole: str) -> Any:
    """The compiled module of scipy of that name alone; the `whole` package, where it is not found or does not load alone.

    >>> binding("scipy.optimize._lsap", "scipy.optimize").linear_sum_assignment([[1.0, 0.0], [0.0, 1.0]])[1].tolist()
    [1, 0]
    """
    if name in sys.modules:
        return sys.modules[name]
    package = find_spec("scipy")
    inside = name.split(".")[1:-1]
    folders = ["/".join([each, *inside]) for each in (package.submodule_search_locations or ())] if package else []
    found = PathFinder.find_spec(name, folders)
    if found is not None and found.loader is not None:
        with suppress(ImportError):  # where what it links to is found says scipy itself
            module = module_from_spec(found)
            found.loader.exec_module(module)
            return sys.modules.setdefault(name, module)
    return import_module(whole)
