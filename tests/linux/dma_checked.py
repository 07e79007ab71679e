"""`hvp linux --check dma`: what a module does wrong with memory is named, and what is right passes.

usage: dma_checked.py PROGRAM GUEST WORK

As module_variants.py.
"""

import re
import sys
from collections.abc import Callable
from dataclasses import dataclass

from module_variants import (
    TOP,
    Change,
    Guest,
    Ran,
    WrongError,
    cases_parser,
    run_cases,
    share_of,
)

CHECK = ("--check", "dma")
SOLVE = "hvp-driver-suite /dev/hvp0 --case solve"
# Of a warning: where the board may not go, and when.
REFUSED = r"the board's {} of \d+ bytes at 0x[0-9a-f]+, in job 0, at \d+\.\d{{3}} ns was refused: "
OUTSIDE = "the driver has not mapped all of it: "


def offset(bytes_away: str) -> Change:
    return Change(
        "hvp_engine.c",
        "\tsegment->bus_address = address;\n",
        f"\tsegment->bus_address = address + {bytes_away};\n",
    )


UNMAP = """\tdma_unmap_single(&pages->board->function->dev, pages->segment->bus_address,
\t\t\t pages->segment->bytes, pages->direction);
"""


@dataclass(frozen=True)
class Wrong:
    """A change of the module, and what is said of it."""

    name: str
    change: Change
    words: str  # a regular expression
    refused: bool = True


WRONG = (
    # The memory there is the guest's, and another's: without the check the job succeeds with U = 0.
    Wrong(
        "1 MB off",
        offset("0x100000"),
        REFUSED.format("read") + OUTSIDE + r"the nearest mapping is of \d+ bytes at 0x\w+, DMA_",
    ),
    Wrong(
        "outside the memory",
        offset("0x8000000"),
        REFUSED.format("read") + OUTSIDE + r"the nearest mapping is of \d+ bytes at 0x\w+, DMA_",
    ),
    Wrong(
        "longer than what was mapped",
        Change(
            "hvp_engine.c",
            "\taddress = dma_map_single(dev, segment->memory, bytes, direction);\n",
            "\taddress = dma_map_single(dev, segment->memory, 64, direction);\n",
        ),
        REFUSED.format("read") + OUTSIDE + r"the mapping there is of 64 bytes at 0x\w+, DMA_TO_DEV",
    ),
    Wrong(
        "after the end of the mapping",
        Change(
            "hvp_engine.c",
            "\tsegment->bus_address = address;\n",
            "\tsegment->bus_address = address;\n"
            "\tdma_unmap_single(dev, address, bytes, direction);\n",
        ),
        REFUSED.format("read") + OUTSIDE + r"the mapping there, \d+ bytes at \w+, DMA_TO_DEVICE, "
        r"ended at \d+\.\d{3} ns",
    ),
    Wrong(
        "the other direction",
        Change(
            "hvp_engine.c",
            "\t\tret = map_pages(board, &engine->to_host, PAGE_ALIGN(board->vector_bytes),\n"
            "\t\t\t\tDMA_FROM_DEVICE);\n",
            "\t\tret = map_pages(board, &engine->to_host, PAGE_ALIGN(board->vector_bytes),\n"
            "\t\t\t\tDMA_TO_DEVICE);\n",
        ),
        REFUSED.format("write") + r"the driver has mapped it for the other direction: \d+ bytes at "
        r"0x\w+, DMA_TO_DEVICE",
    ),
    Wrong(
        "synced in the other direction",
        Change(
            "hvp_engine.c",
            "\t\tsync_segment(context, part, DMA_TO_DEVICE, owner);\n",
            "\t\tsync_segment(context, part, DMA_FROM_DEVICE, owner);\n",
        ),
        r"the driver syncs \d+ bytes at 0x\w+, DMA_FROM_DEVICE, but mapped \d+ bytes at 0x\w+, "
        r"DMA_TO_DEVICE, at \d+\.\d{3} ns",
        refused=False,
    ),
    Wrong(
        "unmapped twice",
        Change("hvp_engine.c", UNMAP, UNMAP + UNMAP),
        r"the driver unmaps a second time \d+ bytes at 0x\w+, DMA_FROM_DEVICE; the first time was "
        r"at \d+\.\d{3} ns, at ",
        refused=False,
    ),
    Wrong(
        "unmapped with another size",
        Change("hvp_engine.c", UNMAP, UNMAP.replace("segment->bytes", "segment->bytes - 4096")),
        r"the driver unmaps \d+ bytes at 0x\w+, DMA_FROM_DEVICE, but mapped \d+ bytes at ",
        refused=False,
    ),
    Wrong(
        "left mapped",
        Change("hvp_engine.c", UNMAP, ""),
        r"the driver has gone and left mapped \d+ bytes at 0x\w+, DMA_FROM_DEVICE, at ",
        refused=False,
    ),
)


def expect(what: str, holds: bool, ran: Ran) -> None:
    if not holds:
        raise WrongError(f"{what}: {ran.summary.get('dma')}\n{ran.said[-3000:]}")


def is_named(guest: Guest, wrong: Wrong) -> None:
    module = guest.build("dma-" + wrong.name.replace(" ", "-"), (wrong.change,))
    ran = guest.run(f"rmmod hvp\ninsmod /host{module}\n{SOLVE} || true\nrmmod hvp\n", *CHECK)
    expect("the words", re.search(wrong.words, ran.said) is not None, ran)
    expect("refusals", (ran.summary["dma"]["refused"] > 0) == wrong.refused, ran)
    if not wrong.refused:
        expect("the job", '"pass"' in ran.said, ran)
        expect("misuses", ran.summary["dma"]["misuses"] > 0, ran)


def the_module_keeps_the_rules(guest: Guest) -> None:
    script = (TOP / "tests" / "driver" / "linux" / "lifecycle.sh").read_text()
    ran = guest.run(script, *CHECK)
    dma = ran.summary["dma"]
    expect("mappings", dma["maps"] > 0, ran)
    expect("what is wrong", dma["refused"] + dma["misuses"] + dma["left_mapped"] == 0, ran)


def every_kind_of_mapping_is_known(guest: Guest) -> None:
    module = guest.build("mappings", room="tests/driver/linux/mappings")
    before = guest.run("true\n", *CHECK).summary["dma"]["maps"]
    ran = guest.run(f"insmod /host{module}\nrmmod hvp_mappings\n", *CHECK)
    # Two coherent ones, twice two single ones, and a list of three.
    expect("mappings", ran.summary["dma"]["maps"] == before + 9, ran)
    expect("misuses", ran.summary["dma"]["misuses"] == 0, ran)


def are_named(guest: Guest, wrongs: tuple[Wrong, ...]) -> None:
    failed = []
    for wrong in wrongs:
        try:
            is_named(guest, wrong)
        except WrongError as error:
            failed.append(f"{wrong.name}: {error}")
    if failed:
        raise WrongError("\n".join(failed))


def nothing_is_said_without_the_check(guest: Guest) -> None:
    module = guest.build("dma-1-MB-off", (offset("0x100000"),))
    ran = guest.run(f"rmmod hvp\ninsmod /host{module}\n{SOLVE} || true\nrmmod hvp\n")
    expect("no table", "dma" not in ran.summary, ran)
    expect("no word", "was refused" not in ran.said, ran)


def a_board_that_moves_nothing_has_nothing_to_check(guest: Guest) -> None:
    words = ("--set", "transfer.method=programmed-io", "--set", "transfer.notification=intx")
    ran = guest.run(f"{SOLVE}\n", *CHECK, *words)
    expect("a word", "--check dma: the board moves nothing by itself" in ran.said, ran)
    expect("no table", "dma" not in ran.summary, ran)


def main() -> int:
    arguments = cases_parser(__doc__).parse_args()

    def wrong_uses_are_named(guest: Guest) -> None:
        are_named(guest, share_of(arguments, WRONG))

    cases: tuple[Callable[[Guest], None], ...] = (
        the_module_keeps_the_rules,
        every_kind_of_mapping_is_known,
        wrong_uses_are_named,
        nothing_is_said_without_the_check,
    )
    return run_cases(arguments, cases)


if __name__ == "__main__":
    sys.exit(main())
