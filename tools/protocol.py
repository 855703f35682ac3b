"""The studio's messages for TypeScript: `python -m tools.protocol` writes web/src/protocol.ts anew from the classes."""

from __future__ import annotations

import inspect
import types
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any, Literal, Union, get_args, get_origin, get_type_hints

from flexstage.apps.studio import protocol

TARGET = Path(__file__).resolve().parents[1] / "web" / "src" / "protocol.ts"
_WORDS = {int: "number", float: "number", str: "string", bool: "boolean", type(None): "null", Any: "unknown"}


def written() -> str:
    """The text of protocol.ts as the classes are now."""
    kinds = [each for each in vars(protocol).values() if is_dataclass(each) and isinstance(each, type) and not each.__subclasses__()]
    asked, said = ([each for each in kinds if issubclass(each, base)] for base in (protocol.Request, protocol.Said))
    interfaces = [_interface(each, message=each in (*asked, *said)) for each in kinds]
    head = "// Written by `python -m tools.protocol` from src/flexstage/apps/studio/protocol.py. Do not edit.\n"
    unions = [_union("Request", asked), _union("Said", said)]
    about = _comment(inspect.getdoc(protocol) or "", "")
    return "\n".join([head, about + f"export const VERSION = {protocol.VERSION};\n", *interfaces, *unions])


def _union(name: str, kinds: list[Any]) -> str:
    return "\n  | ".join([f"export type {name} =", *(each.__name__ for each in kinds)]) + ";\n"


def _interface(kind: type, *, message: bool) -> str:
    hints = get_type_hints(kind)
    lines = [f'  kind: "{kind.__name__.lower()}";'] if message else []
    lines += [f"  {each.name}: {_type(hints[each.name])};" for each in fields(kind)]
    return _comment(inspect.getdoc(kind) or "", "") + f"export interface {kind.__name__} {{\n" + "\n".join(lines) + "\n}\n"


def _comment(text: str, indent: str) -> str:
    lines = text.splitlines()
    if len(lines) == 1:
        return f"{indent}/** {text} */\n"
    return "\n".join([f"{indent}/**", *(f"{indent} * {line}".rstrip() for line in lines), f"{indent} */", ""])


def _type(hint: Any) -> str:
    origin, arguments = get_origin(hint), get_args(hint)
    if origin is Literal:
        return " | ".join(f'"{each}"' for each in arguments)
    if origin in (Union, types.UnionType):
        return " | ".join(_type(each) for each in arguments)
    if origin is tuple:
        inner = _type(arguments[0])
        return f"({inner})[]" if "|" in inner else f"{inner}[]"
    if origin is dict:
        return f"Record<string, {_type(arguments[1])}>"
    return _WORDS.get(hint, getattr(hint, "__name__", ""))


if __name__ == "__main__":
    TARGET.write_text(written(), encoding="utf-8")
