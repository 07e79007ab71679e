"""What can be turned up or down in a scenario: by the declarations, never by a list of its own."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

Kind = Literal["off", "on", "level"]

FIDELITY = "fidelity."
# From what simulates least to what simulates most: what is cheaper than what is not declared.
_EFFORT = (
    "none",
    "untimed",
    "loosely-timed",
    "fixed",
    "approximately-timed",
    "cycle-accurate",
)
# A level that gives what another one gives, and holds the two against each other.
_CHECKS = ("rtl",)


@dataclass(frozen=True)
class Change:
    """An effect or a fidelity key that is given another value.

    `along` are the changes without which the program refuses this one, by what effects declare to
    need; `help` is the declaration's.
    """

    kind: Kind
    key: str
    value: str
    help: str = ""
    along: tuple["Change", ...] = ()

    @property
    def name(self) -> str:
        """As a table calls it."""
        return f"{self.key} {self.value}" if self.kind == "level" else f"{self.key} {self.kind}"

    @property
    def overrides(self) -> tuple[str, ...]:
        """For `--set`, with what comes along."""
        settings = [setting for other in self.along for setting in other.overrides]
        return (*settings, f"{self.key}={self.value}")


@dataclass(frozen=True)
class Choices:
    """The changes of a scenario, and the declared effects that cannot be tried with the reason."""

    changes: tuple[Change, ...]
    untried: dict[str, str]


def changes_of(
    reference: Mapping[str, Any], present: Iterable[str], fidelity: Mapping[str, str | None]
) -> Choices:
    """Every declared effect switched over and every fidelity level but the scenario's own.

    `reference` is what `hvp reference --json` prints, `present` and `fidelity` are the run's.
    """
    there = set(present)
    changes: list[Change] = []
    untried: dict[str, str] = {}
    for effect in reference["effects"]:
        path, several = effect["path"], effect["list"]
        if path in there:
            changes.append(Change("off", path, "[]" if several else "false", effect["help"]))
        elif several:
            untried[f"{path} on"] = "a list of tables, which has no default"
        elif effect["implied"]:
            untried[f"{path} on"] = "follows from another key"
        else:
            changes.append(Change("on", path, "true", effect["help"]))
    for key in fidelity_keys(reference):
        part = key["path"].removeprefix(FIDELITY)
        own = fidelity.get(part)
        changes += [
            Change("level", key["path"], level, key["help"])
            for level in key["choices"]
            if level != own
        ]
    return Choices(tuple(changes), untried)


def fidelity_keys(reference: Mapping[str, Any]) -> list[dict[str, Any]]:
    """The declared keys that choose how finely a part is simulated, with what they can be."""
    return [
        key | {"choices": [choice for choice in key["choices"] if choice not in _CHECKS]}
        for key in reference["keys"]
        if key["path"].startswith(FIDELITY) and key.get("choices") and not key.get("effect")
    ]


def with_needs(
    change: Change,
    reference: Mapping[str, Any],
    present: Sequence[str],
    settings: Mapping[str, Any],
) -> Change:
    """The change with what it takes by the declared needs; itself where nothing is declared.

    An effect that goes takes those with it that need it; a level those that need another one; an
    effect that comes brings what it needs. `settings` is the resolved scenario.
    """
    effects = {effect["path"]: effect for effect in reference["effects"]}
    along: dict[str, Change] = {}

    def leave(path: str) -> None:
        if path not in along and path in present and path != change.key:
            along[path] = Change("off", path, "[]" if effects[path]["list"] else "false")
            for other, effect in effects.items():
                if _needs_present(effect, path):
                    leave(other)

    def bring(path: str) -> None:
        for need in effects[path]["needs"]:
            key, values = need["key"], need["values"]
            if key in effects and key not in present and key not in along:
                bring(key)
                along[key] = Change("on", key, "true")
            elif key not in effects and values and _value(key, settings) not in values:
                along[key] = Change("level", key, values[0])

    if change.kind == "on":
        bring(change.key)
    for path, effect in effects.items():
        if change.kind == "off" and not path.startswith(f"{change.key}."):
            if _needs_present(effect, change.key):
                leave(path)
        elif change.kind == "level" and any(
            need["key"] == change.key and change.value not in need["values"]
            for need in effect["needs"]
        ):
            leave(path)
    return replace(change, along=tuple(along.values()))


def is_less(change: Change, fidelity: Mapping[str, str | None]) -> bool:
    """Whether the change simulates less than the scenario does."""
    if change.kind != "level":
        return change.kind == "off"
    own = fidelity.get(change.key.removeprefix(FIDELITY))
    return own in _EFFORT and _EFFORT.index(change.value) < _EFFORT.index(own)


def effort(level: str) -> int:
    """A number that is larger where a level simulates more."""
    return _EFFORT.index(level) if level in _EFFORT else len(_EFFORT)


def has_table(path: str, settings: Mapping[str, Any]) -> bool:
    """Whether a resolved scenario has an effect's table."""
    return _value(path, settings) is not None


def _needs_present(effect: Mapping[str, Any], key: str) -> bool:
    return any(need["key"] == key and "present" in need["values"] for need in effect["needs"])


def _value(key: str, settings: Mapping[str, Any]) -> Any:
    value: Any = settings
    for word in key.split("."):
        value = value.get(word) if isinstance(value, Mapping) else None
    return str(value) if isinstance(value, int) else value
