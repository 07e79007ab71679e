"""Prints docs/plant-hard-cases.md: `./hvp tables plant-cases`."""

import argparse
import math
import sys
from pathlib import Path

from cases import GROUPS
from loop_run import LoopRun, run, two_digits
from plant_case import SCENE, Case, Remedy

HEAD = f"""\
# Hard cases of the plant

<!-- Made by `./hvp tables plant-cases > docs/plant-hard-cases.md`: do not edit. -->

What becomes of a closed loop that is too stiff, too late, too coarse or out of its range, and what
helps. Every case comes to rest, or ends in a named flag; what the flag's text names is then done.
Tests: `tests/plant_cases/`, which assert what stands here. Code: `tables/plant_cases/`.

<!-- not run: writes into the checkout -->
```sh
./hvp tables plant-cases > docs/plant-hard-cases.md
```

## How it is measured

- Every case is this scenario with the settings in its row, each given by `--set`:

```toml
{SCENE}```

- *Ends*: what the device does while its user rests, by its last quarter of a second. A swing is the
  largest that was seen; what turns less than three times in that time *moves on*.
- *Port*: the least energy that all but masses and hand have absorbed at any frame. Negative: the
  loop had fed that much into the motion.
- *Imbalance*: of the energies, of what was moved: below that power of ten, at the start and with
  each remedy. The tests demand 1e-9.
- *Force*: the largest of the motors.
- *Remedies*: what the flags' texts name, each tried by itself, and what it leaves.
- Where several devices are there, the figures are those of the worst.

## The cases
"""

TAIL = """
## What to know

- `active-port` says that the loop gave energy, not that it is unstable: inside the edge of
  stability a loop that comes to rest may feed its own impact for a while. Passive for every user
  is a wall without damping below b/(T/2 + L), b the device's own.
- A wall that damps too much is as active as one that is too stiff: its difference of two positions
  is a period old. A softer spring does not help there, less `wall.damping` does.
- A device that nobody holds and nothing damps never rests, and no flag is due for that: free flight
  is what it should do. `moves_on_m_s` says so, until it leaves the register's 2.1 m, which
  `device-at-its-limit` says.
- Weight without hand and wall has no remedy among the settings of the loop: nothing is there to
  hold it.
- A swing below 6 Hz turns less than three times in a quarter of a second. It is reported by
  `moves_on_m_s`, not by `limit-cycle`, and a slow one that decays may be seen as at rest in one
  quarter of a second and not in the next.
"""


def row(cells: list[str]) -> str:
    return f"| {' | '.join(cells)} |\n"


def settings_of(settings: tuple[str, ...]) -> str:
    return ", ".join(f"`{setting}`" for setting in settings)


def joules(energy: float) -> str:
    if energy == 0:
        return "0"
    for size, unit in ((1.0, "J"), (1e-3, "mJ"), (1e-6, "uJ"), (1e-9, "nJ")):
        if abs(energy) >= size:
            return f"{two_digits(energy / size)} {unit}"
    return f"{energy:.0e} J"


def below(size: float) -> str:
    """The power of ten that it is less than: not below 1e-12, where it is rounding alone."""
    return f"1e{max(-12, math.floor(math.log10(size)) + 1)}" if size > 0 else "1e-12"


def imbalance(result: LoopRun) -> float:
    return max(abs(float(loop["energy"]["imbalance_rel"])) for loop in result.loops)


def flags_of(flags: list[str]) -> str:
    return ", ".join(flags) if flags else "none"


def remedy_of(remedy: Remedy, result: LoopRun) -> str:
    left = flags_of(result.flags) if result.flags else ""
    return f"{settings_of(remedy.settings)}: {left or 'no flag'}, {result.ending()}"


def row_of(case: Case, program: Path) -> str:
    first = run(program, case.settings)
    start = [case.name, settings_of(case.settings) or "none", case.expected]
    if case.refused:
        return row([*start, f"refused: {first.refusal}", "", "", "", "", ""])
    results = [run(program, (*case.settings, *remedy.settings)) for remedy in case.remedies]
    remedies = [
        remedy_of(remedy, result) for remedy, result in zip(case.remedies, results, strict=True)
    ]
    none = "none helps" if first.flags else "none needed"
    force = max(loop["largest_force_N"] for loop in first.loops)
    return row(
        [
            *start,
            first.ending(),
            flags_of(first.flags),
            joules(min(loop["energy"]["port"]["least_J"] for loop in first.loops)),
            below(max(imbalance(result) for result in (first, *results))),
            f"{two_digits(force)} N",
            "<br>".join(remedies) or none,
        ]
    )


def page(program: Path) -> str:
    heads = ["case", "settings", "expected", "ends", "flags", "port", "imbalance", "force"]
    text = HEAD
    for title, cases in GROUPS.items():
        text += f"\n### {title}\n\n" + row([*heads, "remedies, each by itself"])
        text += row(["---"] * (len(heads) + 1))
        text += "".join(row_of(case, program) for case in cases)
    return text + TAIL


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program", type=Path, help="hvp")
    sys.stdout.write(page(parser.parse_args().program.resolve()))


if __name__ == "__main__":
    main()
