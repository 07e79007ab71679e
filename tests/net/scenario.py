"""A scenario that is being put together: TOML by key, whose keys can be taken out again."""

from dataclasses import dataclass, field

from scenario_reference import UNITS

Item = dict[str, str]


@dataclass
class Scenario:
    """TOML by full key; a list has its items' keys relative to it."""

    values: Item = field(default_factory=dict)
    lists: dict[str, list[Item]] = field(default_factory=dict)
    effects: set[str] = field(default_factory=set)  # of those that are there without a key too
    files: dict[str, str] = field(default_factory=dict)  # beside the scenario, by name

    def copy(self) -> "Scenario":
        lists = {name: [dict(item) for item in items] for name, items in self.lists.items()}
        return Scenario(dict(self.values), lists, set(self.effects), dict(self.files))

    def text(self) -> str:
        lines = [f"{key} = {value}" for key, value in self.values.items()]
        for effect in sorted(self.effects):
            inside = (*self.values, *self.lists, *self.effects)
            if not any(key.startswith(f"{effect}.") for key in inside):
                lines.append(f"{effect} = {{}}")
        for name, items in self.lists.items():
            inner = ["{" + ", ".join(f"{k} = {v}" for k, v in item.items()) + "}" for item in items]
            lines.append(f"{name} = [{', '.join(inner)}]")
        return "\n".join(lines) + "\n"

    def names(self) -> list[str]:
        """Of what can be taken out, the longest first."""
        listed = [
            *self.lists,
            *(f"{name}.{key}" for name, items in self.lists.items() for i in items for key in i),
        ]
        return sorted({*self.values, *self.effects, *listed}, key=lambda name: (-len(name), name))

    def take_out(self, name: str) -> None:
        """A key, or a table with all that is in it."""
        self.values = {
            key: value
            for key, value in self.values.items()
            if key != name and not key.startswith(f"{name}.")
        }
        self.effects = {e for e in self.effects if e != name and not e.startswith(f"{name}.")}
        for listed in [*self.lists]:
            if f"{name}.".startswith(f"{listed}.") or listed.startswith(f"{name}."):
                del self.lists[listed]


def quantity(value: float, dimension: str) -> str:
    unit = UNITS.get(dimension, "")
    return f'"{value!r} {unit}"' if unit else repr(value)


def vector(values: tuple[float, ...], dimension: str = "length") -> str:
    return "[" + ", ".join(quantity(value, dimension) for value in values) + "]"
