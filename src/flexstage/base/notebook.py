"""What shows itself in a notebook: the one place where a value below `show` asks for its picture or tables."""

from __future__ import annotations

from importlib import import_module


class InNotebook:
    """A value that notebooks show as `flexstage.show.notebook` lays it out.

    That module is named in a text and loaded when a value is shown: it stands above all values, and draws with matplotlib.

    >>> import numpy as np
    >>> from flexstage.base.labelled import Matrix
    >>> "<td" in Matrix(np.array([[2.0]]), ("a",), ("b",), "m")._repr_html_()
    True
    """

    def _repr_html_(self) -> str:
        return import_module("flexstage.show.notebook").to_html(self)
