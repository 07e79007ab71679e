"""Which axis matters, against shares that are known."""

import math
from pathlib import Path

import numpy as np

from studies.influence import Influence, influences, words
from studies.point import Value
from studies.study_file import Study, parse

HEAD = 'scenario = "s.toml"\n[design]\nkind = "latin-hypercube"\nsamples = 400\n'
RANGE = '[[axis]]\nkey = "{}"\nfrom = "0 ms"\nto = "1 ms"\n'


def _study(axes: str) -> Study:
    return parse(HEAD + axes, Path("s.toml"))


def _of(found: list[Influence], axis: str) -> Influence:
    return next(influence for influence in found if influence.axis == axis)


def test_ishigamis_shares_are_found() -> None:
    """Ishigami & Homma 1990: S1 is 0.3139, 0.4424 and 0, by a closed form."""
    random = np.random.default_rng(3)
    x = random.uniform(-math.pi, math.pi, (2000, 3))
    y = np.sin(x[:, 0]) + 7 * np.sin(x[:, 1]) ** 2 + 0.1 * x[:, 2] ** 4 * np.sin(x[:, 0])
    cells: dict[str, list[Value]] = {
        name: [f"{value} ms" for value in x[:, place]] for place, name in enumerate("abc")
    }
    cells["worst_us"] = [float(value) for value in y]
    found = influences(_study("".join(map(RANGE.format, "abc"))), cells, ["worst_us"])
    assert [influence.axis for influence in found] == ["b", "a", "c"]
    for axis, exact in (("a", 0.3139), ("b", 0.4424), ("c", 0.0)):
        influence = _of(found, axis)
        assert influence.low <= exact <= influence.high
        assert abs(influence.share - exact) < 0.04
    assert _of(found, "c").low == 0


def test_named_choices_are_a_group_each_and_chance_is_not_told() -> None:
    random = np.random.default_rng(5)
    kinds = [str(kind) for kind in random.choice(["pci", "pcie", "isa"], 300)]
    cost = {"pci": 1.0, "pcie": 2.0, "isa": 6.0}
    noise = random.normal(0, 1, 300)
    cells: dict[str, list[Value]] = {
        "kind": list(kinds),
        "idle": [f"{value} ms" for value in random.uniform(0, 1, 300)],
        "worst_us": [cost[kind] + float(n) for kind, n in zip(kinds, noise, strict=True)],
    }
    axes = '[[axis]]\nkey = "kind"\nvalues = ["pci", "pcie", "isa"]\n' + RANGE.format("idle")
    found = influences(_study(axes), cells, ["worst_us"])
    explained = float(np.var([cost[kind] for kind in kinds]))
    kind = _of(found, "kind")
    assert abs(kind.share - explained / (explained + 1)) < 0.05
    assert kind.low <= explained / (explained + 1) <= kind.high
    (sentence,) = words(found)
    assert sentence.startswith("Of the variance of worst_us kind ")
    assert sentence.endswith("Not told from chance: idle.")


def test_intervals_hold_as_often_as_they_say() -> None:
    held = 0
    for seed in range(60):
        random = np.random.default_rng(seed)
        x = random.uniform(0, 1, 200)
        y = x + random.normal(0, math.sqrt(1 / 12), 200)  # half of the variance
        cells: dict[str, list[Value]] = {
            "a": [f"{value} ms" for value in x],
            "y": [float(value) for value in y],
        }
        (influence,) = influences(_study(RANGE.format("a")), cells, ["y"])
        held += influence.low <= 0.5 <= influence.high
    assert held >= 50  # of 60 at 95 %


def test_nothing_is_said_where_nothing_can_be() -> None:
    study = _study(RANGE.format("a"))
    few: dict[str, list[Value]] = {"a": ["1 ms"] * 10, "y": [float(i) for i in range(10)]}
    assert influences(study, few, ["y"]) == []
    still: dict[str, list[Value]] = {"a": [f"{i} ms" for i in range(50)], "y": [2.0] * 50}
    assert influences(study, still, ["y", "not measured"]) == []
    product = parse('scenario = "s.toml"\n' + RANGE.format("a") + "steps = 3\n", Path("s.toml"))
    assert influences(product, {"a": ["1 ms"] * 50, "y": [1.0, 2.0] * 25}, ["y"]) == []
