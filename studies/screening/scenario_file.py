"""Writes a scenario that is another one with some keys changed."""

import json
import os
import tomllib
from collections.abc import Sequence
from pathlib import Path


def scenario_text(base: Path, folder: Path, comment: str, overrides: Sequence[str]) -> str:
    """TOML for a file in `folder`: `base` by its relative path, and KEY=VALUE as for `--set`."""
    lines = [f"# {line}" for line in comment.splitlines()]
    relative = os.path.relpath(base.resolve(), folder.resolve())
    lines += ["", f"base = {json.dumps(relative)}"]
    settings: dict[str, str] = {}
    for override in overrides:
        key, _, value = override.partition("=")
        settings[key.strip()] = value.strip()  # the last one holds
    lines += [f"{key} = {_toml(value)}" for key, value in settings.items()]
    return "\n".join(lines) + "\n"


def _toml(value: str) -> str:
    """A value as `--set` reads it: TOML where it is, else a text."""
    try:
        tomllib.loads(f"value = {value}")
    except tomllib.TOMLDecodeError:
        return json.dumps(value, ensure_ascii=False)
    return value
