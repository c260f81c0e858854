"""Values as TOML."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from typing import Any

from .errors import refused

_BARE = re.compile(r"^[A-Za-z0-9_-]+$")
_ESCAPES = {'"': '\\"', "\\": "\\\\", "\b": "\\b", "\t": "\\t", "\n": "\\n", "\f": "\\f", "\r": "\\r"}


def _text(text: str) -> str:
    return '"' + "".join(_ESCAPES.get(c, c if ord(c) >= 32 and ord(c) != 127 else f"\\u{ord(c):04x}") for c in text) + '"'


def _key(key: Any, path: str) -> str:
    if not isinstance(key, str):
        raise refused(path or "scene", repr(key) + " as a key", "texts as keys")
    return key if _BARE.match(key) else _text(key)


def value(value: Any, path: str = "") -> str:
    """A number, a text, a list (or array) or a table in one line."""
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int):
        return str(value)
    if isinstance(value, float):
        return repr(value) if math.isfinite(value) else str(value)
    if isinstance(value, str):
        return _text(value)
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{_key(k, path)} = {_below(v, path, k)}" for k, v in value.items()) + "}"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(_below(v, path, k) for k, v in enumerate(value)) + "]"
    raise refused(path or "value", value, "a number, a text, a list or a dict")


def _below(item: Any, path: str, key: Any) -> str:
    return value(item, f"{path}.{key}" if path else str(key))


def document(scene: Mapping[str, Any]) -> str:
    """A scene given as a dict of its keys."""
    if not isinstance(scene, Mapping):
        raise refused("scene", scene, "a dict with the scene's keys")
    plain, tables = [], []
    for key, item in scene.items():
        name = _key(key, "")
        if isinstance(item, Mapping):
            tables.append(_table(f"[{name}]", item, str(key)))
        elif isinstance(item, (list, tuple)) and item and all(isinstance(entry, Mapping) for entry in item):
            tables += [_table(f"[[{name}]]", entry, f"{key}.{k}") for k, entry in enumerate(item)]
        else:
            plain.append(f"{name} = {value(item, str(key))}\n")
    return "".join(plain) + "".join(tables)


def _table(header: str, entries: Mapping[str, Any], path: str) -> str:
    lines = [f"{_key(k, path)} = {_below(v, path, k)}\n" for k, v in entries.items()]
    return f"\n{header}\n" + "".join(lines)
