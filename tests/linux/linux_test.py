"""`hvp linux`: a kernel boots on simulated time, drives the board, and ends well or in one line.

usage: linux_test.py PROGRAM GUEST SERVO [--runs N]

PROGRAM is hvp, GUEST a folder with `linux` and `initramfs.cpio.gz` (driver/linux/guest.sh), SERVO
what makes the same frames in the board's own process. Every run has a hard limit.
"""

import argparse
import contextlib
import csv
import json
import os
import re
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from frames_file import Output, write_frames

TOP = Path(__file__).resolve().parents[2]
LIMIT_S = 240
SCENARIO = TOP / "scenarios" / "thesis.toml"
OVERRIDES = ("transfer.method=dma", "transfer.notification=msi")
# The clock of a kernel on simulated time has steps of 256 ns, and reading it takes one.
CLOCK_NS = 256


class WrongError(Exception):
    pass


def expect(what: str, wanted: object, found: object) -> None:
    if wanted != found:
        raise WrongError(f"{what}: expected {wanted!r}, found {found!r}")


def expect_in(what: str, part: str, text: str) -> None:
    if part not in text:
        raise WrongError(f"{what}: expected {part!r} in {text!r}")


@dataclass
class Guest:
    program: Path
    folder: Path
    servo: Path
    work: Path  # of this case
    runs: int

    def command(self, *words: str, script: str = "", kernel: Path | None = None) -> list[str]:
        command = [str(self.program), "linux", str(SCENARIO), "--out", str(self.work / "out")]
        for override in OVERRIDES:
            command += ["--set", override]
        command += ["--kernel", str(kernel or self.folder / "linux")]
        command += ["--initrd", str(self.folder / "initramfs.cpio.gz"), *words]
        if script:
            (self.work / "script").write_text(script)
            command += ["--script", str(self.work / "script")]
        return command

    def run(
        self, *words: str, script: str = "", kernel: Path | None = None, status: int = 0
    ) -> subprocess.CompletedProcess[str]:
        done = subprocess.run(
            self.command(*words, script=script, kernel=kernel),
            capture_output=True,
            text=True,
            timeout=LIMIT_S,
            env={**os.environ, "TMPDIR": str(self.work)},
            check=False,
        )
        if done.returncode != status:
            raise WrongError(
                f"status {done.returncode}, expected {status}\n{done.stdout}\n{done.stderr}"
            )
        expect("what is left of a run", [], [p.name for p in self.work.glob("hvp-linux-*")])
        return done

    def refused(self, line: str, *words: str, script: str = "", kernel: Path | None = None) -> str:
        done = self.run(*words, script=script, kernel=kernel, status=3)
        said = done.stderr.splitlines()
        expect("lines of the error", 1, len(said))
        expect_in("the error", line, said[0])
        return done.stdout

    def summary(self) -> dict[str, object]:
        summary = json.loads((self.work / "out" / "summary.json").read_text())
        assert isinstance(summary, dict)
        return summary

    def solve(self, frames: Path) -> Output:
        script = f"hvp-servo /dev/hvp0 /host{frames} /host{self.work}/u\n"
        self.run(script=script)
        return Output(self.work / "u")

    def servo_run(self, frames: int) -> Output:
        write_frames(self.work / "frames", frames)
        return self.solve(self.work / "frames")


def boots_and_enumerates(guest: Guest) -> None:
    script = """cd /sys/bus/pci/devices/0000:00:00.0
cat vendor device class
head -n 1 resource
dd if=config bs=1 skip=4 count=2 2>/dev/null | hexdump -e '"%04x\\n"'
"""
    said = guest.run(script=script).stdout
    bar = "0x00000000f0000000 0x00000000f1ffffff 0x0000000000040200"
    for line in ("0x1172", "0x4850", "0x120000", bar, "by DMA, msi"):
        expect_in("the console", line, said)
    expect_in("the console's file", bar, (guest.work / "out" / "console.log").read_text())
    expect("frames", 0, guest.summary()["deadline"]["frames"])  # type: ignore[index]


def has_the_function_that_the_scenario_asks_for(guest: Guest) -> None:
    """A link's capability, and a BAR of 64 bits, in the window that virt-pci.c has for all."""
    script = """cd /sys/bus/pci/devices/0000:00:00.0
head -n 1 resource
stat -c %s config
cat current_link_speed current_link_width reset_method
dd if=config bs=1 skip=16 count=8 2>/dev/null | hexdump -e '2/4 "%08x " "\\n"'
echo 1 > reset
hvp-driver-suite /dev/hvp0 --case solve && echo solved
"""
    link = ("generation=gen1", "lanes=4")
    words = [word for one in link for word in ("--set", f"bus.pcie.{one}")]
    words += ["--set", "function.pci_express=true", "--set", "function.bar_bits=64"]
    said = guest.run(*words, script=script).stdout
    bar = "0x00000000f0000000 0x00000000f1ffffff 0x0000000000140204"
    register = "f0000004 00000000"
    speed = "2.5 GT/s PCIe\n4\nflr pm"
    for line in (bar, "\n4096\n", speed, register, "by DMA, msi", "solved"):
        expect_in("the console", line, said.replace("\r", ""))


def a_board_that_is_pulled_out(guest: Guest) -> None:
    """No job goes well any more; the module lets go of it, and nobody finds it again."""
    script = """hvp-driver-suite /dev/hvp0 --fault surprise-removal --case fault-surprise-removal
cd /sys/bus/pci/devices
hexdump -n 4 -e '"identity %08x\\n"' 0000:00:00.0/config
echo 1 > 0000:00:00.0/remove
echo 1 > /sys/bus/pci/rescan
echo functions: *
"""
    fault = ("--set", "fault[0].kind=surprise-removal", "--set", "fault[0].frame=5")
    said = guest.run(*fault, "--set", "function.msi_x=true", script=script, status=1).stdout
    for part in ('"result": "pass"', "identity ffffffff", "functions: *"):
        expect_in("the console", part, said)
    expect("words of a kernel in trouble", [], re.findall("WARNING|BUG|Oops", said))


def notes_errors_of_a_link(guest: Guest) -> None:
    """In the function's configuration space; no root port is there to tell the kernel of them."""
    script = """cd /sys/bus/pci/devices/0000:00:00.0
read_config() {
  dd if=config bs=1 skip=$1 count=4 2>/dev/null | hexdump -e '"%08x\\n"'
}
hvp-driver-suite /dev/hvp0 --fault aer-uncorrectable --case fault-aer-uncorrectable
for at in 256 260 272; do read_config $at; done
"""
    words = ["bus.pcie.generation=gen3", "transfer.method=programmed-io"]
    words += ["function.pci_express=true", "fault[0].kind=aer-uncorrectable", "fault[0].frame=5"]
    words += ["fault[0].access=start", "fault[1].kind=aer-correctable", "fault[1].frame=3"]
    said = guest.run(
        *[part for word in words for part in ("--set", word)],
        *("--kernel-argument", "hvp.bus_errors=1"),
        script=script,
        status=1,
    ).stdout.replace("\r", "")
    expect_in("the suite", '"result": "pass"', said)
    expect_in("the registers", "00010001\n00001000\n00000040\n", said)


def hears_messages_of_a_table(guest: Guest) -> None:
    """As long as a job by MSI, also behind a reset; the module says how it hears."""
    wanted, u = shortest(guest)
    found, by_table = shortest(guest, "function.msi_x=true")
    expect("the shortest frame", wanted, found)
    expect("U", True, by_table.solutions == u.solutions)
    script = """cd /sys/bus/pci/devices/0000:00:00.0
grep . msi_irqs/*
echo 1 > reset
hvp-driver-suite /dev/hvp0 --case fifty-jobs && echo solved
grep hvp /proc/interrupts
"""
    said = guest.run("--set", "function.msi_x=true", script=script).stdout
    for part in ("by DMA, msi-x", "\nmsix\n", "solved"):
        expect_in("the console", part, said.replace("\r", ""))


def solves_as_in_process(guest: Guest) -> None:
    frames = 1000
    out = guest.servo_run(frames)
    subprocess.run(
        [guest.servo, SCENARIO, guest.work / "frames", guest.work / "here"],
        check=True,
        timeout=LIMIT_S,
    )
    expect("frames", frames, len(out.solutions))
    expect("U", True, Output(guest.work / "here").solutions == out.solutions)
    summary = guest.summary()
    expect("frames of the ledger", frames, summary["deadline"]["frames"])  # type: ignore[index]
    expect("deadlines", True, summary["held"])
    with (guest.work / "out" / "frames.csv").open() as file:
        rows = list(csv.DictReader(file))
    expect("lines of frames.csv", frames, len(rows))
    for row, (_, woken, _, ended, _) in zip(rows[1:], out.times[1:], strict=True):
        seen = (ended - woken) / 1000
        latency = float(row["latency_us"])
        # Two readings of a clock that takes 256 ns each, and one in between.
        if abs(seen - latency) > 4 * CLOCK_NS / 1000:
            raise WrongError(
                f"frame {row['frame']}: {latency} us in the ledger, {seen} us in the guest"
            )


def solves_as_a_run_did(guest: Guest) -> None:
    frames = 1000
    jobs = guest.work / "run"
    command = [str(guest.program), "run", str(SCENARIO), "--record-jobs", "--out", str(jobs)]
    command += ["--set", f"frames={frames}", "--set", "output.pictures=false"]
    subprocess.run(command, check=True, timeout=LIMIT_S, stdout=subprocess.DEVNULL)
    out = guest.solve(jobs / "jobs.hvpf")
    wanted = Output(jobs / "jobs.hvpu")
    expect("jobs", frames, len(out.solutions))
    expect("U", True, wanted.solutions == out.solutions)
    expect("most of them touch the body", True, sum(map(any, wanted.solutions)) > frames / 2)


def shortest(guest: Guest, *settings: str) -> tuple[int, Output]:
    """Of 30 frames, in ps; some read the clock once or twice more, which takes 256 ns."""
    words = [word for setting in settings for word in ("--set", setting)]
    write_frames(guest.work / "frames", 30)
    script = f"hvp-servo /dev/hvp0 /host{guest.work}/frames /host{guest.work}/u\n"
    guest.run(*words, script=script)
    with (guest.work / "out" / "frames.csv").open() as file:
        times = [round(1e6 * float(row["latency_us"])) for row in csv.DictReader(file)]
    return min(times), Output(guest.work / "u")


def system_calls_and_interrupts_take_time(guest: Guest) -> None:
    # From its wake-up to its job's end hvp-servo makes three calls and is woken by an interrupt.
    # With bursts there is one more, to read U, and one that sends b: its writes are posted, and the
    # next call begins while they are on the bus, for 2.38 us.
    posted_ns = 2380
    for calls, method, notification in (
        (3, "dma", "msi"),
        (3, "dma", "intx"),
        (4, "bursts", "intx"),
    ):
        board = (f"transfer.method={method}", f"transfer.notification={notification}")
        ideal, wanted = shortest(guest, *board)
        for call_ns, interrupt_ns in ((0, 0), (0, 7000), (1300, 0), (170, 5000), (9000, 1_000_000)):
            took, found = shortest(
                guest,
                *board,
                f"guest.system_call={call_ns} ns",
                f"host.interrupt_latency={interrupt_ns} ns",
            )
            added = 1000 * (calls * call_ns + interrupt_ns)
            if method == "bursts":
                added += 1000 * max(0, call_ns - posted_ns)
            what = f"{board}, calls of {call_ns} ns, interrupts of {interrupt_ns} ns"
            expect(what, added, took - ideal)
            expect("U", True, found.solutions == wanted.solutions)
    guest.run("--set", "guest.system_call=1 us", "--set", "host.jitter.mean=1 us")
    left_out = "what the guest's processor does between its calls, host.jitter"
    expect("what is not counted", left_out, guest.summary()["guest"]["not_counted"])  # type: ignore[index]
    done = guest.run("--set", "guest.system_call=2 us", "--kernel-argument", "system_call_ns=0")
    expect_in("a kernel that takes none", "guest.system_call: the kernel took no time", done.stderr)


def traces_registers(guest: Guest) -> None:
    write_frames(guest.work / "frames", 3)
    script = f"hvp-servo /dev/hvp0 /host{guest.work}/frames /host{guest.work}/u\n"
    for _ in range(2):  # over the files of the first
        guest.run("--trace-registers", script=script)
    log = (guest.work / "out" / "registers.log").read_text()
    expect("doorbells", 3, log.count(" write CONTROL 4 0x00000008 ok"))
    expect_in("the waveform", "$enddefinitions", (guest.work / "out" / "registers.vcd").read_text())


def records_and_replays(guest: Guest) -> None:
    """With and without times for calls and interrupts."""
    frames = 3
    write_frames(guest.work / "frames", frames)
    script = f"hvp-servo /dev/hvp0 /host{guest.work}/frames /host{guest.work}/u\n"
    record = guest.work / "a.bin"
    late = ("--set", "host.interrupt_latency=5 us", "--set", "guest.system_call=0.17 us")
    for words in ((), late):
        guest.run("--record", str(record), *words, script=script)
        done = subprocess.run(
            [guest.program, "replay", record, "--times", "--json"],
            capture_output=True,
            text=True,
            timeout=LIMIT_S,
            check=False,
        )
        expect("the replay's status", 0, done.returncode)
        found = json.loads(done.stdout)
        expect("the host", "a kernel (hvp linux)", found["host"])
        # Of each job the list, b, U and the record.
        expect("transfers", 4 * frames, found["compared"]["transfers"]["compared"])
        accesses = found["compared"]["accesses"]
        expect("accesses", accesses["recorded"], accesses["compared"])


@contextlib.contextmanager
def load() -> Iterator[None]:
    """Other programs that want every processor."""
    busy = [
        subprocess.Popen([sys.executable, "-c", "while True: pass"])
        for _ in range(2 * (os.cpu_count() or 1))
    ]
    try:
        yield
    finally:
        for process in busy:
            process.kill()
            process.wait()


def repeats_itself(guest: Guest) -> None:
    files = ("u", "out/frames.csv", "out/summary.json", "out/trace.json")

    def once() -> list[bytes]:
        guest.servo_run(40)
        return [(guest.work / name).read_bytes() for name in files]

    first = once()
    for run in range(1, guest.runs):
        with load() if run % 2 else contextlib.nullcontext():
            for name, before, now in zip(files, first, once(), strict=True):
                expect(f"{name} of run {run} is that of the first", True, before == now)


def lives_on(guest: Guest) -> None:
    """Reset, suspend, unbinding, other parameters; some of the suite's cases are late by intent."""
    guest.run(script=(TOP / "tests" / "driver" / "linux" / "lifecycle.sh").read_text(), status=1)


def a_script_that_fails(guest: Guest) -> None:
    guest.refused("hvp: the script ended with status 7", script="exit 7\n")


def a_kernel_without_init(guest: Guest) -> None:
    guest.refused("the guest's kernel panicked: ", "--kernel-argument", "rdinit=/none")


def jobs_without_a_pause_are_as_long_as_each(guest: Guest) -> None:
    # The kernel's own tick of 10 ms, and another program's timer, come while jobs are under way.
    script = (
        "(while :; do usleep 700; done) &\n" + "hvp-driver-suite /dev/hvp0 --case fifty-jobs\n" * 8
    )
    guest.run(script=script)
    with (guest.work / "out" / "frames.csv").open() as file:
        times = [float(row["latency_us"]) for row in csv.DictReader(file)]
    expect("jobs", True, len(times) >= 8 * 50)
    # Each is born at its first access or, between two of them, at a timer's wake-up.
    if max(times) - min(times) > 4 * CLOCK_NS / 1000:
        raise WrongError(f"jobs of {min(times)} to {max(times)} us")


def a_job_that_does_not_end_is_a_miss(guest: Guest) -> None:
    words = ("--set", "fault[0].kind=stuck-busy", "--set", "fault[0].frame=5")
    said = guest.run(*words, script="hvp-driver-suite /dev/hvp0 --fault stuck-busy\n", status=1)
    expect_in("the terminal", "1 whose job failed", said.stdout)
    expect_in("the terminal", "stuck-busy: 1 time, first in frame 5", said.stdout)
    summary = guest.summary()
    expect("held", False, summary["held"])
    expect("misses", 1, summary["deadline"]["misses"])  # type: ignore[index]


def latencies(guest: Guest) -> list[float]:
    with (guest.work / "out" / "frames.csv").open() as file:
        return [float(row["latency_us"]) for row in csv.DictReader(file)]


def a_lost_interrupt_costs_what_the_program_waited(guest: Guest) -> None:
    words = ("--set", "fault[0].kind=lost-interrupt", "--set", "fault[0].frame=2")
    timeout_ms = 20
    write_frames(guest.work / "frames", 5)
    files = f"/host{guest.work}/frames /host{guest.work}/u"
    script = f"hvp-servo /dev/hvp0 {files} --timeout-ms {timeout_ms}\n"
    guest.run(*words, "--set", "bus.pcie.generation=gen3", script=script, status=1)
    times = latencies(guest)
    due, _, _, ended, _ = Output(guest.work / "u").times[2]
    # The program's clock takes a step to be read, three times from its wake-up on.
    late = (ended - due) / 1000 - times[2]
    if times[2] < 1000 * timeout_ms or not 0 <= late <= 4 * CLOCK_NS / 1000:
        raise WrongError(f"{times[2]} us in the record, {(ended - due) / 1000} by the program")


def a_fault_that_the_script_asks_for(guest: Guest) -> None:
    """Is the scenario's in the same job, the same each time, and refused in one line."""
    write_frames(guest.work / "frames", 6)
    servo = f"hvp-servo /dev/hvp0 /host{guest.work}/frames /host{guest.work}/u --timeout-ms 20\n"
    words = [f"fault[0].{key}" for key in ("kind=lost-interrupt", "frame=2", "count=2")]
    guest.run(*(part for word in words for part in ("--set", word)), script=servo, status=1)
    of_scenario = latencies(guest)
    asked = "hvp-fault kind=lost-interrupt frame=2 count=2\nhvp-fault kind=stuck-busy,frame=99\n"
    results = []
    for _ in range(2):
        said = guest.run(script=asked + servo, status=1).stdout
        expect("latencies", of_scenario, latencies(guest))
        expect_in("the terminal", "lost-interrupt: 2 times, first in frame 2", said)
        expect_in("the terminal", "stuck-busy: did not happen: it is asked for in frame 99", said)
        results.append(
            [(guest.work / "out" / n).read_bytes() for n in ("frames.csv", "trace.json")]
        )
    expect("the files of the second run are those of the first", True, results[0] == results[1])
    record = guest.work / "a.bin"
    guest.run("--record", str(record), script=asked + servo, status=1)
    replayed = subprocess.run(
        [guest.program, "replay", record, "--times"],
        capture_output=True,
        timeout=LIMIT_S,
        check=False,
    )
    expect("the replay's status", 0, replayed.returncode)
    guest.run(script="hvp-fault kind=stuck-busy\n" + servo, status=3)
    expect("misses", 1, guest.summary()["deadline"]["misses"])  # type: ignore[index]
    said = guest.refused(
        "the script ended with status 2", script="hvp-fault kind=lost || exit $?\n"
    )
    expect_in("the console", 'hvp-fault: kind=lost: expected "lost-interrupt"', said)


def stops_where_it_is_asked_to(guest: Guest) -> None:
    script = "hvp-driver-suite /dev/hvp0 --case fifty-jobs\n"
    found = set()
    for _ in range(2):
        said = guest.run("--stop-at", "job 99", "--stop-at", "job 7", script=script).stdout
        stop = re.search(r"^stopped: job 7 begins at (\d+\.\d{6}) us, in job 7$", said, re.M)
        if not stop:
            raise WrongError(f"no stop: {said}")
        expect_in("what the guest does", "its processor is in", said)
        expect_in("the board", "its last job, number 8 of the run", said)
        # The board finishes what it has begun, and no host sees that.
        expect("frames", 7, guest.summary()["deadline"]["frames"])  # type: ignore[index]
        found.add(stop.group(1))
    expect("different times", 1, len(found))
    for point, what in (("write to CONTROL", "0x"), ("message 3", "arrives"), ("read of ID", "0x")):
        said = guest.run("--stop-at", point, script=script).stdout
        expect_in("the stop", f"stopped: {point} {what}", said)
    never = guest.run("--stop-at", "job 50", script=script).stderr
    expect_in("the warning", "--stop-at job 50: it never came", never)


def a_guest_that_hangs(guest: Guest) -> None:
    jobs = "hvp-driver-suite /dev/hvp0 --case fifty-jobs\n"
    line = "nothing was heard of the guest for 3 s"
    # One that computes for ever, and one that sleeps while simulated time goes on.
    for last, does in (
        ("while :; do :; done\n", "userspace"),
        ("mkfifo /tmp/f; cat /tmp/f\n", "time_travel_"),
    ):
        words = ("--patience", "3", "--trace-registers")
        said = guest.refused(line, *words, script=jobs + last)
        for part in (does, "the board: idle; its last job, number 50 of the run", "read STATUS"):
            expect_in("what it does", part, said[said.rfind("of simulated time: ") :])
        expect("jobs of before", 50, guest.summary()["deadline"]["frames"])  # type: ignore[index]
        expect_in("the log", "CONTROL", (guest.work / "out" / "registers.log").read_text())


def has_the_same_memory_each_time(guest: Guest) -> None:
    consoles = set()
    for _ in range(3):
        guest.run(script="head -n 2 /proc/meminfo\n")
        console = (guest.work / "out" / "console.log").read_text()
        consoles.add(re.sub(r"hvp-linux-\w+", "", console))
    expect("different consoles", 1, len(consoles))


STRANGE = {
    "dies": "the guest's kernel ended before it asked for the time",
    "half-a-time": "",
    "unknown-time": "the guest's calendar asks for 99",
    "past": "the guest wants to run at 1 ns, and it is 1000 ns",
    "sleeps-for-ever": "the guest sleeps without a timer",
    "silent": "nothing was heard of the guest for 3 s",
    "four-gigabytes": "a payload of 4294967295 bytes",
    "rubbish": "vhost-user: ",
    "half-a-message": "",
    "leaves": "the guest's kernel has closed a connection and goes on",
    "no-descriptor": "1 regions of memory with 0 descriptors",
    "short-memory": "is not in its file",
    "ring-outside": "where it has no memory",
    "ring-too-long": "where it has no memory",
}


def strange_kernels(guest: Guest) -> None:
    kernel = Path(__file__).with_name("strange_kernel.py")
    for how, line in STRANGE.items():
        words = ("--patience", "3", "--kernel-argument", f"strange={how}")
        if line:
            guest.refused(line, *words, kernel=kernel)
        else:  # it goes in the middle of a message, which is an end as any other
            guest.run(*words, kernel=kernel)


def wrong_words(guest: Guest) -> None:
    for words, line in (
        (("--memory", "lots"), "expected a size such as 64M"),
        (("--patience", "0"), "--patience"),
        (
            ("--check", "kasan,nothing"),
            "--check kasan,nothing: expected words of driver, dma, kasan, lockdep",
        ),
        (("--check", ""), "--check: expected a value"),
        (("--check", "kasan", "--gdb"), "--gdb and a kernel that checks: expected one of them"),
        (("--script", "/none"), "--script /none: expected a file that can be read"),
        (
            ("--stop-at", "write to CONTRL"),
            "--stop-at write to CONTRL: no such register; did you mean CONTROL?",
        ),
        (("--stop-at", "third message"), '--stop-at "third message": expected "write to REGISTER"'),
    ):
        done = guest.run(*words, status=2)
        expect_in("the error", line, done.stderr)
    (guest.work / "a script").write_text("true\n")
    done = guest.run("--script", str(guest.work / "a script"), status=2)
    expect_in("the error", "expected a path without blanks", done.stderr)
    guest.refused("insmod ended with status", "--kernel-argument", "hvp.timeout_ms=0")
    done = guest.run(kernel=Path("/etc/passwd"), status=2)
    expect_in("the error", "expected a file that can be run", done.stderr)


def complaints_of_the_kernel_are_in_the_verdict(guest: Guest) -> None:
    script = "".join(
        f'echo "{line}" >/dev/kmsg\n'
        for line in ("BUG: KASAN: use-after-free in f", "WARNING: possible recursive locking") * 2
    )
    kernel = guest.folder / "linux"
    guest.run("--check", "kasan", kernel=kernel)
    expect("held", True, guest.summary()["held"])
    checks = {"asked": "kasan", "complaints": 0, "found": []}
    expect("checks", checks, guest.summary()["checks"])
    said = guest.run("--check", "lockdep,kasan", script=script, kernel=kernel, status=1).stdout
    expect_in("the terminal", "checked       kasan, lockdep: the kernel complains", said)
    expect_in("the terminal", "complaint     kasan, 2 times: BUG: KASAN: use-after-free in f", said)
    expect("held", False, guest.summary()["held"])
    checks = guest.summary()["checks"]  # type: ignore[assignment]
    expect("complaints", 4, checks["complaints"])
    expect("names", ["kasan", "lockdep"], [found["check"] for found in checks["found"]])  # type: ignore[attr-defined]
    guest.run(script=script)  # nobody asked


def nothing_is_left_when_killed(guest: Guest) -> None:
    command = guest.command(script="while :; do :; done\n")
    mark = str(guest.work)
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, env={**os.environ, "TMPDIR": str(guest.work)}
    ) as process:
        assert process.stdout is not None
        running = any(b"by DMA, msi" in line for line in process.stdout)
        expect("the guest runs", True, running and bool(guests_of(mark)))
        process.send_signal(signal.SIGKILL)
        process.wait(timeout=LIMIT_S)
    deadline = time.monotonic() + LIMIT_S
    while time.monotonic() < deadline:
        left = [p.name for p in guest.work.glob("hvp-linux-*")]
        if not left and not guests_of(mark):
            return
        time.sleep(0.05)
    raise WrongError("a guest or its folder is left")


def guests_of(mark: str) -> list[str]:
    found = []
    for path in Path("/proc").glob("[0-9]*/cmdline"):
        with contextlib.suppress(OSError):
            line = path.read_bytes()
            if mark.encode() in line and b"time-travel=ext" in line:
                found.append(path.parent.name)
    return found


CASES: tuple[Callable[[Guest], None], ...] = (
    boots_and_enumerates,
    has_the_function_that_the_scenario_asks_for,
    hears_messages_of_a_table,
    notes_errors_of_a_link,
    a_board_that_is_pulled_out,
    solves_as_in_process,
    solves_as_a_run_did,
    system_calls_and_interrupts_take_time,
    traces_registers,
    records_and_replays,
    repeats_itself,
    lives_on,
    a_script_that_fails,
    a_kernel_without_init,
    jobs_without_a_pause_are_as_long_as_each,
    a_job_that_does_not_end_is_a_miss,
    a_lost_interrupt_costs_what_the_program_waited,
    a_fault_that_the_script_asks_for,
    stops_where_it_is_asked_to,
    a_guest_that_hangs,
    has_the_same_memory_each_time,
    strange_kernels,
    wrong_words,
    complaints_of_the_kernel_are_in_the_verdict,
    nothing_is_left_when_killed,
)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program", type=Path)
    parser.add_argument("guest", type=Path)
    parser.add_argument("servo", type=Path)
    parser.add_argument("--runs", type=int, default=4, help="of repeats_itself")
    parser.add_argument("--case", help="one alone")
    arguments = parser.parse_args()
    failed = 0
    for case in CASES:
        if arguments.case not in (None, case.__name__):
            continue
        with tempfile.TemporaryDirectory() as work:
            guest = Guest(
                arguments.program.resolve(),
                arguments.guest.resolve(),
                arguments.servo.resolve(),
                Path(work),
                arguments.runs,
            )
            try:
                case(guest)
                print(f"ok      {case.__name__}", flush=True)
            except (WrongError, subprocess.SubprocessError, OSError) as error:
                failed += 1
                print(f"FAILED  {case.__name__}: {error}", flush=True)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
