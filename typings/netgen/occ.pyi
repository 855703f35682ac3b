# Everything here is bound at run time from a compiled library: of unknown type.
from typing import Any

def __getattr__(name: str) -> Any: ...
