"""Proofs about two modules of the RTL engine, for every input and every number of clocks.

    python tests/rtl/prove.py

Yosys reads a module with its properties (formal/*.sv, which bind themselves to it), and its SAT
solver proves them by induction over the clocks. The sizes of words are the least, as no property
depends on them; partitions, lanes and depths are those that engines have. Then the same properties
are tried on mutants of the modules: a mutant that no proof refutes is named, and has to have its
reason in unrefuted.toml.
"""

import argparse
import re
import subprocess
import sys
import tempfile
import time
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from mutants import Module, Mutant, entry, explanation
from translation import ENGINE

FORMAL = Path(__file__).resolve().parent / "formal"
REASONS = FORMAL / "unrefuted.toml"
# Induction over more clocks than this has not been needed.
DEEPEST = 4
LANES = (1, 2)


@dataclass(frozen=True)
class Proof:
    """Of one module in one size."""

    module: str
    others: tuple[str, ...]  # that it has inside
    properties: str
    parameters: tuple[tuple[str, int], ...]

    def __str__(self) -> str:
        sizes = ", ".join(f"{name} {value}" for name, value in self.parameters if name in SHOWN)
        return f"{self.module}.sv: {sizes}"


SHOWN = ("Partitions", "Lanes", "QueueBits")


def arbiter(partitions: int, lanes: int) -> Proof:
    sizes = {"Partitions": partitions, "Lanes": lanes, "NodeBits": 1, "CountBits": 2}
    words = {"SumBits": 1, "VectorBits": 1}
    return Proof("row_collector", (), "row_collector_properties", tuple((sizes | words).items()))


def queue(bits: int) -> Proof:
    sizes = {"QueueBits": bits, "Package": 3, "PackageBits": 2, "NodeBits": 1, "Lanes": 1}
    words = {"MatrixBits": 2, "VectorBits": 2, "SumBits": 9}
    others = (
        "bank_reads",
        "direction_bank",
        "direction_copy",
        "double_pumped_memory",
        "dual_port_memory",
        "index_prefetch",
    )
    return Proof("spmxv_partition", others, "row_queue_properties", tuple((sizes | words).items()))


def proofs(most_partitions: int) -> Iterator[Proof]:
    for partitions in range(1, most_partitions + 1):
        yield from (arbiter(partitions, lanes) for lanes in LANES)
    yield from (queue(bits) for bits in range(1, 5))


def commands(proof: Proof, source: Path) -> list[str]:
    """Yosys', for a module whose text is in `source`."""
    files = [ENGINE / f"{name}.sv" for name in proof.others]
    files += [source, FORMAL / f"{proof.properties}.sv"]
    parameters = " ".join(f"-G {name}={value}" for name, value in proof.parameters)
    return [
        f"read_slang --top {proof.module} {parameters} {' '.join(map(str, files))}",
        f"hierarchy -top {proof.module}",
        "flatten",
        # What nobody drives is free: a property may speak of any one row.
        "setundef -undriven -anyseq",
        "memory_map",
        "opt -full",
        "async2sync",
        "chformal -lower",
        "opt -full",
        f"sat -tempinduct -prove-asserts -set-assumes -maxsteps {DEEPEST}",
    ]


# By itself, since yosys ends the process where a design is not one.
RUN = """
import sys
from pyosys import libyosys
design = libyosys.Design()
for command in sys.argv[1:]:
    libyosys.run_pass(command, design)
"""


def proved(proof: Proof, source: Path) -> tuple[bool, str]:
    """Whether it is, and what yosys said."""
    command = [sys.executable, "-c", RUN, *commands(proof, source)]
    done = subprocess.run(command, check=False, capture_output=True, text=True)
    said = done.stdout + done.stderr
    # A property that has become a constant would say nothing.
    vacuous = re.search(r"proof for assert: \S+ when 1'0", said)
    return "Induction step proven: SUCCESS!" in said and not vacuous, said


def mutated(proof: Proof, matching: str, share: int, of: int) -> Iterator[tuple[Mutant, str]]:
    """A share of the module's mutants in lines that match, each with the module's text."""
    module = Module(ENGINE / f"{proof.module}.sv")
    places = [
        i for i, mutant in enumerate(module.mutants) if re.search(matching, mutant.source_line)
    ]
    for place in places[share % of :: of]:
        yield module.mutants[place], module.with_mutants({place: 1}, "1")


# Lines of spmxv_partition.sv that count or keep rows.
OF_QUEUE = (
    r"waiting|issue =|issued[01]? <=|issued -|finished|rows\["
    r"|valid <=|last <=|if \((last|valid)\[7\]|index[01] <="
)


def unrefuted(share: int, of: int, folder: Path) -> tuple[int, int, list[Mutant]]:
    """How many mutants there are, how many were refuted, and the others."""
    tried, held = 0, []
    for proof, matching in ((arbiter(3, 2), ""), (queue(1), OF_QUEUE)):
        for mutant, text in mutated(proof, matching, share, of):
            source = folder / f"{proof.module}.sv"
            source.write_text(text)
            tried += 1
            if proved(proof, source)[0]:
                held.append(mutant)
    return tried, tried - len(held), held


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--partitions", type=int, default=5, help="at most so many")
    parser.add_argument("--share", type=int, default=0, help="which share of the mutants")
    parser.add_argument("--of", type=int, default=1, help="of how many; 0: no mutants")
    options = parser.parse_args()
    failed = 0
    for proof in proofs(options.partitions):
        started = time.monotonic()
        holds, said = proved(proof, ENGINE / f"{proof.module}.sv")
        failed += not holds
        print(f"{'proved' if holds else 'NOT PROVED'}: {proof}, {time.monotonic() - started:.1f} s")
        if not holds:
            print("\n".join(said.splitlines()[-80:]))
    if options.of == 0:
        return 1 if failed else 0
    reasons = tomllib.loads(REASONS.read_text())["survivor"]
    with tempfile.TemporaryDirectory() as folder:
        tried, refuted, held = unrefuted(options.share, options.of, Path(folder))
    for mutant in held:
        reason = explanation(mutant, reasons)
        failed += reason is None
        print(f"not refuted: {mutant}")
        print(f"    {reason['reason']}" if reason else f"    without a reason:\n{entry(mutant)}")
    print(f"{refuted} of {tried} mutants refuted, {len(held)} hold the properties")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
