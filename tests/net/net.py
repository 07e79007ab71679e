"""Draws scenarios and holds what they give against the laws that every run obeys.

Each scenario is run and its files are audited; then each law changes the scenario and compares. A
scenario that the program refuses is drawn on without what the refusal names; the refusal has to be
one line that names a key. What fails is kept, and the line that repeats it is printed.

    python3 tests/net/net.py build/release/app/hvp --count 500 --seed 7
    python3 tests/net/net.py build/release/app/hvp --seed 7 --only 12     one, with every law
"""

import argparse
import os
import random
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path

import force_checks
import ledger_audit
import trace_audit
import whole_files
from against_the_host import AGAINST_THE_HOST
from drawing import draw, without
from laws import LAWS as IDENTITIES
from laws import Law
from mirror import MIRROR
from physics import LOADS_AND_MATTER
from rest import REST
from run_files import Run
from scenario import Scenario
from scenario_reference import Table, tables_of
from slides import SLIDES

LAWS = (*IDENTITIES, *LOADS_AND_MATTER, *REST, *SLIDES, AGAINST_THE_HOST, MIRROR)
LONGEST_RUN_S = 60  # of the processor, whatever else the machine does
HANGS_AFTER_S = 900
REFUSED = 2
DRAWS = 40  # of one scenario, each without what was refused in the last
PREPARED = 6  # of a law's own scenario, where it cannot be had without what it needs
LAWS_EACH = 3  # of a scenario, in turn
DRAWN_ON = 4  # scenarios at a time, where those before say nothing of a law
MOST_DRAWN = 10  # times as many as were asked for
REFUSAL = re.compile(r"[^:\n]+:(?:\d+:)? ([\w.\[\]]+): [^\n]+\n")


class WrongEndError(Exception):
    """A run that neither gave a result nor was refused as it should be."""


def limit_time() -> None:
    resource.setrlimit(resource.RLIMIT_CPU, (LONGEST_RUN_S, LONGEST_RUN_S + 5))


@dataclass
class Findings:
    drawn: int = 0  # scenarios that were tried until one was not refused
    refused: int = 0  # of them
    runs: int = 0
    complaints: list[str] = field(default_factory=list)
    asked: Counter[str] = field(default_factory=Counter)  # by law

    def add(self, other: "Findings") -> None:
        self.drawn += other.drawn
        self.refused += other.refused
        self.runs += other.runs
        self.asked += other.asked


@dataclass(frozen=True)
class Place:
    program: Path
    folder: Path
    tables: list[Table]
    findings: Findings

    def run(self, scenario: Scenario, name: str) -> Run:
        file = self.folder / f"{name}.toml"
        file.write_text(scenario.text(), encoding="utf-8")
        for beside, text in scenario.files.items():
            (self.folder / beside).write_text(text, encoding="utf-8")
        return self.run_file(file, name)

    def run_file(self, file: Path, name: str) -> Run:
        out = self.folder / name
        command = [str(self.program), "run", str(file), "--quiet", "--out", str(out)]
        try:
            ended = subprocess.run(
                command,
                capture_output=True,
                timeout=HANGS_AFTER_S,
                check=False,
                text=True,
                preexec_fn=limit_time,
            )
        except subprocess.TimeoutExpired:
            raise WrongEndError(f"hung for {HANGS_AFTER_S} s") from None
        if ended.returncode == -signal.SIGXCPU:
            raise WrongEndError(f"took more than {LONGEST_RUN_S} s")
        self.findings.runs += 1
        run = Run(out, ended.returncode, ended.stdout, ended.stderr)
        if run.status not in (0, 1, REFUSED):
            raise WrongEndError(f"ended with status {run.status}: {run.errors.strip()[-400:]}")
        return run

    def refused_key(self, run: Run) -> str:
        """What a refusal is about, in full and without an index."""
        said = REFUSAL.fullmatch(run.errors)
        if said is None:
            raise WrongEndError(f"was refused with: {run.errors.strip()[:400]}")
        key = re.sub(r"\[\d+\]", "", said[1])
        known = {table.path for table in self.tables}
        known |= {f"{t.path}.{k.name}".lstrip(".") for t in self.tables for k in t.keys}
        if key not in known:
            raise WrongEndError(f"was refused for {key}, which is no key: {run.errors.strip()}")
        return key

    def settled(self, scenario: Scenario, name: str) -> tuple[Scenario, Run] | None:
        """Without what is refused; None where nothing is left to take out."""
        for _ in range(DRAWS):
            run = self.run(scenario, name)
            self.findings.drawn += 1
            if run.status != REFUSED:
                return scenario, run
            self.findings.refused += 1
            left = without(scenario, run.errors, self.refused_key(run))
            if left is None:
                return None
            scenario = left
        return None


def audit(run: Run) -> Iterator[str]:
    yield from whole_files.complaints(run.folder, run.printed)
    yield from ledger_audit.complaints(run)
    yield from force_checks.complaints(run)


def judge(place: Place, law: Law, rng: random.Random, before: tuple[Scenario, Run]) -> list[str]:
    if law.prepare is not None:
        settled = None
        for _ in range(PREPARED):
            prepared = law.prepare(rng, before[0])
            settled = place.settled(prepared, f"{law.name}-before")
            if settled is not None:
                break
        if settled is None:
            return []
        before = settled
        for key in law.keeps:
            if before[0].values.get(key) != prepared.values[key]:
                return [f"{key} was refused"]
    scenario, run = before
    changed = law.change(rng, scenario, run)
    if changed is None:
        return []
    after = place.run(changed, law.name)
    if after.status == REFUSED:
        place.refused_key(after)
        return [] if law.may_be_refused else [f"was refused: {after.errors.strip()}"]
    place.findings.asked[law.name] += 1
    return [*audit(after), *law.compare(run, after)]


def repeated(place: Place, scenario: Scenario, run: Run) -> list[str]:
    """The scenario with every default written out gives the same bytes. A run copies a surface and
    a device beside it, measured times it does not: those are put there."""
    names = {path.name for path in run.folder.iterdir()}
    for name, text in scenario.files.items():
        (run.folder / name).write_text(text, encoding="utf-8")
    again = place.run_file(run.folder / "scenario.resolved.toml", "again")
    if again.status == REFUSED:
        return [f"was refused: {again.errors.strip()}"]
    place.findings.asked["resolved"] += 1
    names |= {path.name for path in again.folder.iterdir()}
    different = []
    for name in sorted(names - {"performance.json"}):
        one, other = run.folder / name, again.folder / name
        if not one.is_file() or not other.is_file() or one.read_bytes() != other.read_bytes():
            different.append(f"{name} differs when scenario.resolved.toml is run")
    return different


MOST_TOLD = 3


@dataclass(frozen=True)
class Plan:
    program: Path
    tables: list[Table]
    seed: int
    laws: list[str]
    laws_each: int
    keep: Path  # for the files of what fails

    def laws_of(self, index: int) -> list[Law]:
        """Some of them, in turn."""
        first = index * self.laws_each
        chosen = {self.laws[(first + i) % len(self.laws)] for i in range(self.laws_each)}
        return [law for law in LAWS if law.name in chosen]


def look_at(plan: Plan, index: int) -> Findings:
    findings = Findings()
    with tempfile.TemporaryDirectory(prefix="hvp-net-") as folder:
        place = Place(plan.program, Path(folder), plan.tables, findings)
        rng = random.Random(f"{plan.seed}/{index}")
        asking = ""

        def tell(what: list[str]) -> None:
            findings.complaints += [f"{asking}{text}" for text in what[:MOST_TOLD]]

        try:
            before = None
            while before is None:
                before = place.settled(draw(rng, plan.tables), "drawn")
            tell([*audit(before[1]), *trace_audit.complaints(before[1])])
            for law in plan.laws_of(index):
                asking = f"{law.name}: "
                law_rng = random.Random(f"{plan.seed}/{index}/{law.name}")
                if law.name == "resolved":
                    tell(repeated(place, *before))
                else:
                    tell(judge(place, law, law_rng, before))
        except WrongEndError as error:
            tell([str(error)])
        except Exception as error:  # a file that cannot be read as it should is a finding too
            tell([f"{type(error).__name__}: {error}"])
        if findings.complaints:
            kept = plan.keep / f"{plan.seed}-{index}"
            shutil.rmtree(kept, ignore_errors=True)
            shutil.copytree(place.folder, kept, ignore=shutil.ignore_patterns("*.vtu", "*.pvd"))
    return findings


def look_at_all(plan: Plan, numbers: Sequence[int], total: Findings) -> int:
    """How many of them failed. What was found is told and added."""
    failed = 0
    with ProcessPoolExecutor(int(os.environ.get("HVP_JOBS", os.cpu_count() or 1))) as pool:
        for index, found in zip(numbers, pool.map(partial(look_at, plan), numbers), strict=True):
            total.add(found)
            if found.complaints:
                failed += 1
                for text in found.complaints:
                    print(f"{index}: {text}")
                kept = plan.keep / f"{plan.seed}-{index}"
                again = f"{sys.argv[0]} {plan.program} --seed {plan.seed} --only {index}"
                print(f"  {kept}; again: python3 {again}", flush=True)
    return failed


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("hvp", type=Path, help="the program")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--count", type=int, default=60, help="of scenarios")
    parser.add_argument("--only", type=int, help="the scenario of this number, with every law")
    parser.add_argument("--law", choices=[law.name for law in LAWS], help="this law alone")
    parser.add_argument("--keep", type=Path, default=Path("build/net"), help="for what fails")
    arguments = parser.parse_args()
    program: Path = arguments.hvp.resolve()
    page = subprocess.run([program, "reference"], capture_output=True, text=True, check=True)
    laws = [law.name for law in LAWS if arguments.law in (None, law.name)]
    each = len(laws) if arguments.only is not None else min(LAWS_EACH, len(laws))
    numbers = [arguments.only] if arguments.only is not None else range(arguments.count)
    plan = Plan(program, tables_of(page.stdout), arguments.seed, laws, each, arguments.keep)
    total = Findings()
    failed = look_at_all(plan, numbers, total)
    looked_at = len(numbers)
    # A law asks nothing of a scenario that it does not suit, and a short run may draw such alone.
    while (
        (unasked := [law for law in laws if not total.asked[law]])
        and looked_at * each >= len(laws)
        and looked_at < MOST_DRAWN * len(numbers)
        and arguments.only is None
    ):
        further = range(looked_at, looked_at + DRAWN_ON)
        of_these = replace(plan, laws=unasked, laws_each=len(unasked))
        failed += look_at_all(of_these, further, total)
        looked_at += len(further)
    print(
        f"{looked_at} scenarios, {total.runs} runs; {total.refused} of {total.drawn} drawn were "
        f"refused ({100 * total.refused / max(total.drawn, 1):.0f} %); {failed} scenarios failed"
    )
    print("  " + ", ".join(f"{law} {total.asked[law]}" for law in laws))
    if unasked and looked_at * each >= len(laws) and arguments.only is None:
        failed += 1
        print(f"no scenario could be asked about: {', '.join(unasked)}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
