"""Mistakes that kernel developers make, one each in the module, and what the platform says of them.

usage: module_bugs.py PROGRAM GUEST WORK [--checked] [--share N --of M | --lines]

As module_variants.py. Each is run with `hvp linux --check driver,dma`, and the module as it is
breaks no rule. With --checked the mistakes are those that only a kernel sees which looks for more:
GUEST is the variant kasan+lockdep. --share takes one M-th of them; --lines prints a line each for
docs/driver-bugs.md, and judges nothing.
"""

import re
import sys
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

from dma_checked import SOLVE, UNMAP, offset
from module_variants import (
    Change,
    Guest,
    Ran,
    WrongError,
    cases_parser,
    guest_of,
    run_named,
    share_of,
)

CHECK = ("--check", "driver,dma")
CHECK_KERNEL = ("--check", "kasan,lockdep")
LINE = ("--set", "transfer.method=programmed-io", "--set", "transfer.notification=intx")


@dataclass(frozen=True)
class Bug:
    """A mistake, and the word that names it: a rule of docs/driver-rules.md, or part of a
    warning of `--check dma`, or of what a kernel that looks for more complains of."""

    name: str
    change: tuple[Change, ...]
    word: str
    words: tuple[str, ...] = ()
    script: str = SOLVE


# The driver's core, which the module is built from.
CORE = "../{}"
BUGS = (
    Bug("DMA address 1 MB off", (offset("0x100000"),), "stray-dma"),
    Bug("DMA address behind the memory", (offset("0x8000000"),), "stray-dma"),
    Bug(
        "DMA length a page too long",
        (
            Change(
                CORE.format("hvp_dma.c"),
                "  return (uint32_t)(words * sizeof(uint32_t));\n",
                "  return (uint32_t)(words * sizeof(uint32_t)) + 4096U;\n",
            ),
        ),
        "list-length",
    ),
    Bug(
        "DMA length in words",
        (
            Change(
                CORE.format("hvp_dma.c"),
                "  return (uint32_t)(words * sizeof(uint32_t));\n",
                "  return (uint32_t)words & ~3U;\n",
            ),
        ),
        "list-length",
    ),
    Bug(
        "record cleared behind the doorbell",
        (
            Change(
                CORE.format("hvp_dma.c"),
                "  // Job numbers begin anew after a reset: an old record must not pass for "
                "the new one.\n",
                "  hvp_write_register(device, HVP_OFFSET(CONTROL), HVP__CONTROL__RUN_LIST_bm);\n",
            ),
            Change(
                CORE.format("hvp_dma.c"),
                "  hand_over_record(device, HVP_OWNER_DEVICE);\n"
                "  hvp_write_register(device, HVP_OFFSET(CONTROL), HVP__CONTROL__RUN_LIST_bm);\n",
                "  device->dma.record[0] = 0xffffffffU;\n",
            ),
        ),
        "owned-memory-touched",
    ),
    Bug(
        "no barrier",
        (Change("hvp_engine.c", "\t\t\tdma_wmb();\n", "\t\t\tbarrier();\n"),),
        "missing-barrier",
        ("--set", "guest.memory_order=weak"),
    ),
    Bug(
        "no bus master",
        (Change("hvp_pci.c", "\tpci_set_master(function);\n", ""),),
        "no-bus-master",
    ),
    Bug(
        "mapping freed twice",
        (Change("hvp_engine.c", UNMAP, UNMAP + UNMAP),),
        "the driver unmaps a second time",
        script=SOLVE + "\nrmmod hvp",
    ),
    Bug(
        "list not told again after a reset",
        (
            Change(
                CORE.format("hvp_dma.c"),
                "  device->bus.write_block(device->bus.context, HVP_OFFSET(DMA_LIST_LOW), words,\n"
                "                          LIST_REGISTERS + more);\n",
                "  (void)words;\n  (void)more;\n",
            ),
        ),
        "list-not-set",
    ),
    Bug(
        "interrupt line not taken down",
        (
            Change(
                CORE.format("hvp_irq.c"),
                "      hvp_write_register(device, HVP_OFFSET(INTERRUPT_ENABLE), 0U);\n"
                "      device->interrupts_on = false;\n",
                "",
            ),
        ),
        "line-left-up",
        LINE,
    ),
    Bug(
        "end not acknowledged",
        (
            Change(
                CORE.format("hvp_driver.c"),
                "  hvp_write_register(device, HVP_OFFSET(INTERRUPT_STATUS), seen);\n",
                "  (void)seen;\n",
            ),
        ),
        "start-unacknowledged|command-ignored",
        LINE,
    ),
    Bug(
        "words the other way round",
        (
            Change(
                CORE.format("hvp_matrix.c"),
                "  hvp_write_elements(device, HVP_OFFSET(NODES), size, 2U, 32U);\n",
                "  hvp_write_register(device, HVP_OFFSET(NODES),\n"
                "                     __builtin_bswap32((uint32_t)size[0]));\n"
                "  hvp_write_register(device, HVP_OFFSET(BLOCKS), (uint32_t)size[1]);\n",
            ),
        ),
        "byte-order",
    ),
    Bug(
        "a register that is not there",
        (
            Change(
                CORE.format("hvp_job.c"),
                "  ++device->job;\n",
                "  ++device->job;\n  hvp_write_register(device, 0x3cU, 1U);\n",
            ),
        ),
        "illegal-access",
    ),
    Bug(
        "U read without a look at the end",
        (
            Change(
                CORE.format("hvp_job.c"),
                "  const hvp_status status =\n      device->uses_dma ? hvp_await_record(device, "
                "timeout_ns) : hvp_await_end(device, timeout_ns);\n",
                "  const hvp_status status = HVP_OK;\n  (void)timeout_ns;\n"
                "  device->last_status = 0U;\n",
            ),
        ),
        "early-result",
        LINE,
    ),
)

# Seen by KASAN and lockdep alone.
CHECKED_BUGS = (
    Bug(
        "an open file keeps no reference to the board",
        (
            Change(
                "hvp_pci.c",
                "\tkref_get(&board->references);\n",
                "\t(void)board;\n",
            ),
        ),
        "kasan: .*BUG: KASAN: use-after-free",
    ),
    Bug(
        "sleeping under the handler's lock",
        (
            Change(
                "hvp_job_calls.c",
                "\thvp_engine_give(board);\n",
                "\thvp_engine_give(board);\n"
                "\tspin_lock_irq(&board->line_lock);\n"
                "\tkfree(kmalloc(64, GFP_KERNEL));\n"
                "\tspin_unlock_irq(&board->line_lock);\n",
            ),
            Change(
                "hvp_job_calls.c",
                "#include <linux/uaccess.h>\n",
                "#include <linux/slab.h>\n#include <linux/uaccess.h>\n",
            ),
        ),
        "lockdep: .*-unsafe lock order detected",
        LINE,
    ),
)


@dataclass(frozen=True)
class Said:
    """What names a bug: the rule, the line about it, and the accesses to the BAR until then."""

    rule: str
    what: str
    access: int


def said_of(guest: Guest, bug: Bug) -> tuple[list[Said], Ran]:
    module = guest.build("bug-" + re.sub(r"\W", "-", bug.name), bug.change)
    script = f"rmmod hvp\ninsmod /host{module}\n{bug.script} || true\n"
    if bug in CHECKED_BUGS:
        # What follows a complaint is as it may be, a panic among it.
        ran = guest.run(script, *CHECK_KERNEL, *bug.words, statuses=(0, 1, 3))
        return [Said(c["check"], c["text"], 0) for c in ran.summary["checks"]["found"]], ran
    ran = guest.run(script, *CHECK, *bug.words)
    said = [Said(f["rule"], f["what"], f["access"]) for f in ran.summary["driver_findings"]]
    said += [
        Said("dma", line.partition("the driver ")[2], 0)
        for line in ran.said.splitlines()
        if "warning: the driver " in line
    ]
    return said, ran


def naming(bug: Bug, said: list[Said]) -> list[Said]:
    return [one for one in said if re.search(bug.word, one.rule + ": the driver " + one.what)]


def is_named(guest: Guest, bug: Bug) -> None:
    said, ran = said_of(guest, bug)
    if not naming(bug, said):
        found = "; ".join(f"{one.rule}: {one.what}" for one in said) or "nothing"
        raise WrongError(f"expected {bug.word}, found {found}\n{ran.said[-1500:]}")


def the_module_breaks_no_rule(guest: Guest, words: tuple[str, ...]) -> None:
    ran = guest.run(f"{SOLVE}\nhvp-driver-suite /dev/hvp0 --case fifty-jobs\n", *CHECK, *words)
    if ran.summary["driver_accesses"] == 0 or ran.summary["driver_findings"]:
        raise WrongError(f"{words}: {ran.summary['driver_findings']}")


def lines(guest: Guest, bugs: tuple[Bug, ...]) -> None:
    for bug in bugs:
        said, _ = said_of(guest, bug)
        named = naming(bug, said)
        what = f"`{named[0].rule}`" if named else "**unnamed**"
        print(f"| {bug.name} | {what} |", flush=True)


def main() -> int:
    parser = cases_parser(__doc__)
    parser.add_argument("--lines", action="store_true")
    parser.add_argument("--checked", action="store_true")
    arguments = parser.parse_args()
    guest = guest_of(arguments)
    if arguments.lines:
        lines(guest, CHECKED_BUGS if arguments.checked else BUGS)
        return 0
    if arguments.checked:
        named = {bug.name: partial(is_named, guest, bug) for bug in CHECKED_BUGS}
        return run_named(arguments, named)
    # No other layer knows where a handler ends.
    only_here = tuple(bug for bug in BUGS if bug.word == "line-left-up")
    chosen = tuple(dict.fromkeys((*only_here, *share_of(arguments, BUGS))))
    tests: dict[str, Callable[[], None]] = {
        "the module by DMA and MSI": partial(the_module_breaks_no_rule, guest, ()),
        "the module by words and INTA#": partial(the_module_breaks_no_rule, guest, LINE),
        **{bug.name: partial(is_named, guest, bug) for bug in chosen},
    }
    return run_named(arguments, tests)


if __name__ == "__main__":
    sys.exit(main())
