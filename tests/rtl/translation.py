"""test_rtl_engine with other translations of the RTL in it: with mutants, or counting lines.

Everything else comes from a build that is there: ninja says with which commands it made a
translation and the program, and of those only the SystemVerilog, the folder and some arguments are
others here. So the sizes of the engine are those of the build.
"""

import shlex
import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path

TOP = Path(__file__).resolve().parents[2]
ENGINE = TOP / "vp/fpga/rtl/engine"
PROGRAM = "test_rtl_engine"
# What a translation is linked with, of Verilator's own library.
LIBRARY = (
    "verilated.cpp",
    "verilated_threads.cpp",
    "verilated_dpi.cpp",
    "verilated_cov.cpp",
    "verilated_fst_c.cpp",  # the level's own size can write a waveform
)
VERILATOR_INCLUDES = Path("/usr/share/verilator/include")


class NotBuiltError(Exception):
    """A command that failed, with its last lines."""


@dataclass(frozen=True)
class Translation:
    """One that the build has: an archive, and the class in it."""

    archive: str  # as the build names it
    prefix: str
    command: tuple[str, ...]  # Verilator's

    @property
    def is_engine(self) -> bool:
        return self.prefix.startswith("Vengine_")

    @property
    def parameters(self) -> dict[str, int]:
        """Of engine.sv."""
        given = (part[2:].split("=") for part in self.command if part.startswith("-G"))
        return {name: int(value) for name, value in given}

    @property
    def name(self) -> str:
        return self.prefix.removeprefix("Vengine_") if self.is_engine else self.prefix[1:]


def run(command: list[str], folder: Path) -> str:
    done = subprocess.run(command, cwd=folder, check=False, capture_output=True, text=True)
    if done.returncode != 0:
        lines = (done.stdout + done.stderr).splitlines()
        errors = [line for line in lines if "rror" in line] or lines
        raise NotBuiltError("\n".join([shlex.join(command)[:300], *errors[:20]]))
    return done.stdout


def ninja_commands(build: Path, target: str) -> list[list[str]]:
    listed = run(["ninja", "-C", str(build), "-t", "commands", target], build)
    return [shlex.split(line) for line in listed.splitlines() if not line.startswith("ninja:")]


def _link_command(build: Path) -> list[str]:
    words = ninja_commands(build, PROGRAM)[-1]
    return words[words.index("&&") + 1 : words.index("&&", words.index("&&") + 1)]


def translations(build: Path) -> list[Translation]:
    """Those that the program of tests has in that build, of the engine and of modules."""
    found = []
    for word in _link_command(build):
        if not word.endswith("_verilated.a"):
            continue
        for command in ninja_commands(build, word):
            if any(part.endswith("verilator_bin") for part in command):
                prefix = command[command.index("--prefix") + 1]
                found.append(Translation(word, prefix, tuple(command)))
    return found


@dataclass(frozen=True)
class Variant:
    """How the translations of a program differ from the build's."""

    folder: Path  # of all that is made
    arguments: tuple[str, ...]  # for Verilator, of engines
    support: Path  # C++ that the translated code calls
    optimisation: str = "-O1"


def _translate(one: Translation, variant: Variant, sources: list[Path]) -> Path:
    """Returns the object of the translated class."""
    folder = variant.folder / one.prefix
    # What another translation has left there would be compiled, too.
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    words = list(one.command[one.command.index("&&") + 1 :])
    words[words.index("--Mdir") + 1] = str(folder)
    words = [word for word in words if not word.endswith(".sv") and word != "-Wall"]
    words += ["-Wno-fatal", "-Wno-lint", *map(str, sources)]
    if one.is_engine:
        words += variant.arguments
    run(words, folder)
    everything = folder / "everything.cpp"
    generated = sorted(folder.glob(f"{one.prefix}*.cpp"))
    everything.write_text("".join(f'#include "{path.name}"\n' for path in generated))
    return _compile(everything, variant, [f"-I{folder}"])


def _compile(source: Path, variant: Variant, options: list[str]) -> Path:
    made = variant.folder / f"{source.parent.name}-{source.stem}.o"
    includes = [f"-I{VERILATOR_INCLUDES}", f"-I{VERILATOR_INCLUDES / 'vltstd'}"]
    command = ["ccache", "g++", "-std=c++20", variant.optimisation, "-DVM_COVERAGE=1"]
    run([*command, *includes, *options, "-w", "-c", str(source), "-o", str(made)], variant.folder)
    return made


def _compile_again(build: Path, source: str, one: Translation, variant: Variant) -> tuple[str, str]:
    """The object of a source of the program, with the class that `one` has now: old and new."""
    for words in ninja_commands(build, PROGRAM):
        if words[-1].endswith(source) and "-c" in words:
            old = words[words.index("-o") + 1]
            new = str(variant.folder / Path(old).name)
            words[words.index("-o") + 1] = new
            place = next(i for i, word in enumerate(words) if word.startswith("-I"))
            words.insert(place, f"-I{variant.folder / one.prefix}")
            run(words, build)
            return old, new
    raise NotBuiltError(f"{build} makes no {source}")


def build_program(build: Path, variant: Variant, sources: dict[str, list[Path]]) -> Path:
    """The program with translations of `sources`, by their names; the others stay the build's.

    Files of a translation are given in the order in which Verilator has to read them. Throws
    NotBuiltError.
    """
    variant.folder.mkdir(parents=True, exist_ok=True)
    link = _link_command(build)
    objects = [_compile(VERILATOR_INCLUDES / name, variant, []) for name in LIBRARY]
    objects.append(_compile(variant.support, variant, []))
    for one in translations(build):
        if one.name not in sources:
            continue
        made = _translate(one, variant, sources[one.name])
        link[link.index(one.archive)] = str(made)
        if one.is_engine:
            old, new = _compile_again(build, f"engine_{one.name}.cpp", one, variant)
            # The level's own size is in an archive: what comes first is taken.
            if old in link:
                link[link.index(old)] = new
            else:
                link.insert(link.index("-o"), new)
    program = variant.folder / PROGRAM
    place = link.index("-o")
    link[place + 1] = str(program)
    # Before the archives, of which some have Verilator's library, too.
    run([*link[:place], *map(str, objects), *link[place:]], build)
    return program


def engine_sources(one: Translation) -> list[Path]:
    """The build's own files of a translation."""
    return [Path(word) for word in one.command if word.endswith(".sv")]
