"""Mutants of the RTL engine: which of them do the engine's tests notice?

    cmake build/release -DHVP_RTL_SIZES='narrow;wide;stall;banks;rows;blocks'
    cmake --build build/release --target test_rtl_engine
    python tests/rtl/mutation.py --build build/release --count 400

A number of seeded mutants, spread over all modules, are translated at once and run one after the
other, each by the tests that notice most mutants first. They come in an order by chance, so that
what --minutes leaves time for is of all modules. Tests and random systems are fewer at first; a
survivor that has no reason in survivors.toml gets all of them. The report says how many
mutants were run and how many of these were noticed, and names the survivors. Each of those has to
have its reason in survivors.toml: that no test can tell it from the original (equivalent), or why
none does. Exit status 1 where one has none, or where fewer than nine of ten others were noticed.
"""

import argparse
import math
import os
import random
import resource
import subprocess
import sys
import time
import tomllib
from collections import Counter
from dataclasses import dataclass, replace
from pathlib import Path

from mutants import Module, Mutant, entry, explanation
from translation import (
    ENGINE,
    NotBuiltError,
    Variant,
    build_program,
    engine_sources,
    translations,
)

HERE = Path(__file__).resolve().parent
REASONS = HERE / "survivors.toml"
WANTED = 0.9
RANDOM = "Engine/RtlSizes.AgreeOnRandomSystems"
CONTACTS = "Engine/RtlSizes.AgreeOnContacts"
ABORTS = "Engine/RtlSizes.AgreeWhereverASolveIsAborted"
INVERSES = "Engine/RtlInverse.AgreesOnBlocksOfAnyKind"
INVERSE_ABORTS = "Engine/RtlInverse.AgreesWhereverItIsAborted"
THRESHOLDS = "Engine/RtlSizes.StopAtTheThreshold"
# What is first tried on a module's mutants: where there are some, tests of the module by itself,
# and where only some sizes have the module, one of these.
FIRST = {
    "scaler.sv": "RtlScaler.*",
    "coefficient_divider.sv": "RtlDivider.*",
    "stop_test.sv": "RtlStopTest.*",
    "edit_visits.sv": f"{CONTACTS}/narrow",
    "matrix_editor.sv": f"{CONTACTS}/narrow",
    "inverse_maker.sv": f"{RANDOM}/wide",
    "inverse_order.sv": f"{RANDOM}/wide",
    "row_lengths.sv": f"{RANDOM}/wide",
    "preconditioner_lane.sv": f"{RANDOM}/wide",
    "block_inverse_maker.sv": f"{INVERSES}/blocks",
    "block_preconditioner_lane.sv": f"{RANDOM}/blocks",
    "wide_multiplier.sv": f"{RANDOM}/wide",
    "bank_reads.sv": f"{RANDOM}/banks",
    "direction_bank.sv": f"{RANDOM}/banks",
    "direction_copy.sv": f"{RANDOM}/banks",
    "dual_port_memory.sv": f"{RANDOM}/banks",
}
# SystemC elaborates once in a process, so that each of these is one; the first notices most.
WHOLE = (
    f"{RANDOM}/narrow",
    f"{CONTACTS}/narrow",
    "Engine/RtlRows.AgreeBeyondTheWordsOfQ/thesis",
    "RtlPorts.*",
    f"{ABORTS}/narrow",
    f"{CONTACTS}/wide",
    f"{THRESHOLDS}/wide",
    f"{RANDOM}/wide",
)
# For what none of those notices and nobody has a reason for.
OTHERS = (
    "RtlScaler.*",
    "RtlDivider.*",
    "RtlStopTest.*",
    f"{INVERSE_ABORTS}/wide",
    f"{INVERSE_ABORTS}/blocks",
    f"{CONTACTS}/blocks",
    f"{RANDOM}/blocks",
    f"{ABORTS}/wide",
    f"{THRESHOLDS}/narrow",
    f"{THRESHOLDS}/thesis",
    f"{CONTACTS}/banks",
    f"{CONTACTS}/rows",
    f"{CONTACTS}/thesis",
    f"{RANDOM}/narrow",
    f"{RANDOM}/stall",
    f"{RANDOM}/thesis",
    f"{RANDOM}/banks",
    f"{RANDOM}/rows",
    f"{RANDOM}/wide",
    "RtlEngine.AgreesOnTheThesisSphereWithJacobi",
)
# Of each test of random systems, at first.
FEW_SYSTEMS = 60
ALL_SYSTEMS = 300
# A test that needs as many times the processor time that it needs without a mutant has no end.
PATIENCE = 2
LEAST_SECONDS = 2


@dataclass(frozen=True)
class Outcome:
    number: int
    mutant: Mutant
    noticed_by: str | None


def chosen(modules: list[Module], count: int, seed: int) -> dict[str, list[int]]:
    """Places in each module's mutants: in proportion to how many it has, and a few at least."""
    draw = random.Random(seed)
    total = sum(len(module.mutants) for module in modules)
    places: dict[str, list[int]] = {}
    for module in modules:
        there = len(module.mutants)
        wanted = min(there, max(5, round(count * there / total)))
        places[module.name] = sorted(draw.sample(range(there), wanted))
    return places


def listed(modules: list[Module], kind: str) -> dict[str, list[int]]:
    """Places of those that survivors.toml has with that kind: a test may notice them by now."""
    reasons = [reason for reason in survivors() if reason["kind"] == kind]
    return {
        module.name: [
            place
            for place, mutant in enumerate(module.mutants)
            if explanation(mutant, reasons) is not None
        ]
        for module in modules
    }


def survivors() -> list[dict[str, str]]:
    return tomllib.loads(REASONS.read_text())["survivor"] if REASONS.exists() else []


def mutated_program(
    build: Path, folder: Path, modules: list[Module], places: dict[str, list[int]]
) -> tuple[Path, list[Mutant]]:
    """The program with these mutants, the first of which is number 1."""
    sources = folder / "sources"
    sources.mkdir(parents=True, exist_ok=True)
    imported = 'import "DPI-C" function int hvp_selected_mutant();\n'
    # In an engine the choice is made once. A module by itself asks each time: the tests know the
    # layout of its class, which has no room for a variable.
    package = f"package mutants;\n{imported}int selected = hvp_selected_mutant();\nendpackage\n"
    (sources / "mutants.sv").write_text(package)
    mutants: list[Mutant] = []
    for module in modules:
        numbers = {}
        for place in places[module.name]:
            mutants.append(module.mutants[place])
            numbers[place] = len(mutants)
        (sources / module.name).write_text(module.with_mutants(numbers, "mutants::selected"))
        alone = module.with_mutants(numbers, "hvp_selected_mutant()")
        alone = alone.replace("\n);\n", "\n);\n" + imported, 1)
        (sources / f"alone_{module.name}").write_text(alone)
    variant = Variant(folder, (), HERE / "selected_mutant.cpp")
    files = {}
    for one in translations(build):
        paths = engine_sources(one)
        names = [path.name for path in paths]
        if one.is_engine:
            files[one.name] = [sources / "mutants.sv", *(sources / name for name in names)]
        else:
            # What a test has of its own, beside the module, stays as it is.
            files[one.name] = [
                sources / f"alone_{path.name}" if path.parent == ENGINE else path for path in paths
            ]
    return build_program(build, variant, files), mutants


class Runner:
    """Runs tests of the program with one of its mutants."""

    def __init__(self, program: Path) -> None:
        self._program = program
        self._seconds: dict[str, float] = {}

    def passes(self, test: str, number: int, systems: int = FEW_SYSTEMS) -> bool:
        """With number 0 it has no mutant, and the time it takes is kept."""
        command = [str(self._program), f"--gtest_filter={test}", "--gtest_fail_fast"]
        patience = PATIENCE * systems / FEW_SYSTEMS
        limit = LEAST_SECONDS + math.ceil(patience * self._seconds.get(test, 100.0))
        used = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        done = subprocess.run(
            ["prlimit", f"--cpu={limit}", *command],
            check=False,
            capture_output=True,
            env={
                **os.environ,
                "HVP_MUTANT": str(number),
                "HVP_RTL_SYSTEMS": str(systems),
            },
        )
        if number == 0:
            self._seconds[test] = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - used
            print(f"{self._seconds[test]:6.1f} s of a processor: {test}", flush=True)
            # A filter that no test is called by would pass with every mutant.
            if b" 0 tests from 0 test suites" in done.stdout:
                return False
        return done.returncode == 0

    def noticed_by(self, mutant: Mutant, number: int) -> str | None:
        # Each once, in this order.
        for test in dict.fromkeys([FIRST.get(mutant.file, WHOLE[0]), *WHOLE]):
            if not self.passes(test, number):
                return test
        return None

    def noticed_by_others(self, number: int) -> str | None:
        """With all systems."""
        for test in OTHERS:
            if not self.passes(test, number, ALL_SYSTEMS):
                return test
        return None


def report(outcomes: list[Outcome], drawn: int, reasons: list[dict[str, str]]) -> int:
    """Prints what became of the mutants, of so many drawn ones; returns the exit status."""
    noticed = Counter(o.mutant.file for o in outcomes if o.noticed_by)
    made = Counter(o.mutant.file for o in outcomes)
    by_test = Counter(o.noticed_by for o in outcomes if o.noticed_by)
    surviving = [o.mutant for o in outcomes if not o.noticed_by]
    equivalent = unexplained = 0
    for mutant in surviving:
        reason = explanation(mutant, reasons)
        kind = "without a reason" if reason is None else reason["kind"]
        equivalent += kind == "equivalent"
        unexplained += reason is None
        print(f"survives ({kind}): {mutant}")
        print(f"    {reason['reason']}" if reason else entry(mutant))
    print()
    for file in sorted(made):
        print(f"{file:26} {noticed[file]:4} of {made[file]:4} noticed")
    print()
    for test, count in by_test.most_common():
        print(f"{count:4} noticed by {test}")
    killed, others = sum(noticed.values()), len(outcomes) - equivalent
    print(
        f"\n{len(outcomes)} of {drawn} mutants were run: {killed} noticed, {len(surviving)} "
        f"survive, of which {equivalent} are equivalent and {unexplained} without a reason; of "
        f"those that are not equivalent {100 * killed / max(others, 1):.1f} % were noticed"
    )
    return 1 if unexplained or killed < WANTED * others else 0


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--build", type=Path, default=Path("build/release"))
    parser.add_argument("--keep", type=Path, help="folder of the translation")
    parser.add_argument("--count", type=int, default=400)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--listed", metavar="KIND", help="those of survivors.toml instead")
    parser.add_argument("--modules", nargs="+", metavar="FILE.sv", help="mutants of these alone")
    parser.add_argument("--numbers", type=int, nargs="+", help="only these mutants")
    parser.add_argument("--minutes", type=float, default=math.inf, help="begin none after as many")
    options = parser.parse_args()
    build = options.build.resolve()
    folder = (options.keep or build / "mutation").resolve()
    modules = [Module(path) for path in sorted(ENGINE.glob("*.sv"))]
    if options.listed:
        places = listed(modules, options.listed)
    else:
        names = options.modules or [module.name for module in modules]
        unknown = set(names) - {module.name for module in modules}
        if unknown:
            parser.error(f"expected modules of {ENGINE}: found {', '.join(sorted(unknown))}")
        drawn = [module for module in modules if module.name in names]
        places = {module.name: [] for module in modules}
        places |= chosen(drawn, options.count, options.seed)
    try:
        program, mutants = mutated_program(build, folder, modules, places)
    except NotBuiltError as error:
        print(f"the mutants could not be translated: {error}", file=sys.stderr)
        return 1
    runner = Runner(program)
    for test in dict.fromkeys([*FIRST.values(), *WHOLE]):
        if not runner.passes(test, 0):
            print(f"{test} fails without a mutant", file=sys.stderr)
            return 1
    outcomes = []
    numbers = list(range(1, len(mutants) + 1))
    random.Random(options.seed).shuffle(numbers)
    end = time.monotonic() + 60 * options.minutes
    for number in options.numbers or numbers:
        if time.monotonic() > end:
            break
        mutant = mutants[number - 1]
        outcomes.append(Outcome(number, mutant, runner.noticed_by(mutant, number)))
        print(f"{number} {outcomes[-1].noticed_by or 'SURVIVES'}: {mutant}", flush=True)
    reasons = survivors()
    for place, outcome in enumerate(outcomes):
        if outcome.noticed_by is None and explanation(outcome.mutant, reasons) is None:
            noticed_by = runner.noticed_by_others(outcome.number)
            outcomes[place] = replace(outcome, noticed_by=noticed_by)
            print(f"{outcome.number} {noticed_by or 'SURVIVES ALL'}: {outcome.mutant}", flush=True)
    return report(outcomes, len(mutants), reasons)


if __name__ == "__main__":
    sys.exit(main())
