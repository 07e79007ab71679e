"""The module in a guest that stands still at random and whose stores are late (`guest.schedule`,
`guest.memory_order`): as it is it stays right; a race and a barrier that is missing are found by
one of a hundred seeds, which repeats them.

usage: guest_order.py PROGRAM GUEST WORK [--share N --of M]

As module_variants.py. --share takes one M-th of the seeds at which the module is right.
"""

import sys
from functools import partial
from pathlib import Path

from module_bugs import BUGS
from module_variants import Guest, Ran, WrongError, cases_parser, guest_of, run_named, share_of

RANDOM = ("--set", "guest.schedule=random")
WEAK = ("--set", "guest.memory_order=weak")
JOBS = "hvp-driver-suite /dev/hvp0 --case fifty-jobs"
SEEDS = 100
RIGHT_SEEDS = tuple(range(1, 9))


def changed(guest: Guest, name: str) -> Path:
    bug = next(bug for bug in BUGS if bug.name == name)
    return guest.build("order-" + name.replace(" ", "-"), bug.change)


def run(guest: Guest, module: Path | None, seed: int, *words: str) -> Ran:
    other = f"rmmod hvp\ninsmod /host{module}\n" if module else ""
    # What is wrong may end in a fault of the suite's.
    script = f"{other}{JOBS} | grep -q '\"pass\"' && echo all is right || echo wrong\n"
    return guest.run(script, "--set", f"seed={seed}", *words)


def is_right(ran: Ran) -> bool:
    return "\nall is right\n" in ran.said


def the_module_stays_right(guest: Guest, seed: int) -> None:
    ran = run(guest, None, seed, "--check", "driver", *RANDOM, *WEAK)
    order = ran.summary["memory_order"]
    if not is_right(ran) or ran.summary["driver_findings"] or order["unordered"]:
        raise WrongError(f"seed {seed}: {ran.said[-1500:]}")
    if not order["barriers"]:
        raise WrongError("the kernel has told of no barrier")


def is_found(guest: Guest, name: str, *words: str) -> None:
    module = changed(guest, name)
    if not is_right(run(guest, module, 1)):
        raise WrongError(f"{name}: it shows without {words}")
    for seed in range(1, SEEDS + 1):
        ran = run(guest, module, seed, *words)
        if is_right(ran):
            continue
        again = run(guest, module, seed, *words)
        if again.summary != ran.summary:
            raise WrongError(f"{name}: seed {seed} does not repeat it")
        print(f"        seed {seed}", flush=True)
        return
    raise WrongError(f"{name}: not found by {SEEDS} seeds")


def a_barrier_that_is_missing_is_named(guest: Guest) -> None:
    ran = run(guest, changed(guest, "no barrier"), 1, "--check", "driver", *WEAK)
    rules = [found["rule"] for found in ran.summary["driver_findings"]]
    if "missing-barrier" not in rules or ran.summary["held"]:
        raise WrongError(f"{rules}: {ran.said[-1500:]}")


def main() -> int:
    arguments = cases_parser(__doc__).parse_args()
    guest = guest_of(arguments)
    tests = {
        **{
            f"right at seed {seed}": partial(the_module_stays_right, guest, seed)
            for seed in share_of(arguments, RIGHT_SEEDS)
        },
        "a barrier that is missing": partial(is_found, guest, "no barrier", *WEAK),
        "and its name": partial(a_barrier_that_is_missing_is_named, guest),
        "a record that is cleared behind the doorbell": partial(
            is_found, guest, "record cleared behind the doorbell", *RANDOM
        ),
    }
    return run_named(arguments, tests)


if __name__ == "__main__":
    sys.exit(main())
