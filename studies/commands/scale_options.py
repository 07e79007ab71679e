"""What commands that run studies take to run them elsewhere: --scheduler, --slurm, --array-size."""

import argparse
from collections.abc import Sequence
from pathlib import Path

from studies.carry import Carrier
from studies.errors import HELD, InputError
from studies.option_paths import check_file, check_folder
from studies.point import Point
from studies.program import Program
from studies.session import Session
from studies.slurm import LARGEST_ARRAY, write_array
from studies.store import Store
from studies.study_file import Study
from studies.text_table import count_of


def add_scale_options(parser: argparse.ArgumentParser) -> None:
    """Declare them."""
    parser.add_argument(
        "--scheduler", metavar="ADDRESS", help="of a dask.distributed cluster, tcp://HOST:PORT"
    )
    parser.add_argument(
        "--slurm", type=Path, metavar="FILE.sh", help="run nothing: write an array for sbatch"
    )
    parser.add_argument(
        "--array-size",
        type=int,
        metavar="N",
        help=f"tasks of that array; one a run unless given, and {LARGEST_ARRAY} at most",
    )


def carrier_of(arguments: argparse.Namespace) -> Carrier | None:
    """Who is to carry the runs out; None is this machine. Throws InputError."""
    if arguments.array_size is not None:
        if arguments.slurm is None:
            raise InputError("--array-size: expected --slurm FILE.sh with it")
        if arguments.array_size < 1:
            raise InputError(f"--array-size {arguments.array_size}: expected one task or more")
    if arguments.slurm is not None:
        check_file("--slurm", arguments.slurm)
    if arguments.scheduler is None:
        return None
    if arguments.slurm is not None:
        raise InputError("--slurm: expected without --scheduler, as it runs nothing")
    # Half a second that only those wait for who want it.
    from studies.carry_dask import DaskCarrier  # noqa: PLC0415

    return DaskCarrier(arguments.scheduler)


def session_of(arguments: argparse.Namespace, study: Study, program: Program) -> Session:
    """How the runs of a study's file are carried out. Throws InputError."""
    check_folder("--store", arguments.store, written=False)
    session = Session(
        program,
        Store(arguments.store.absolute()),
        time_limit_s=study.time_limit_s,
        retries=study.retries,
        again=arguments.retry,
        carrier=carrier_of(arguments),
    )
    if arguments.jobs is not None:
        session.workers = arguments.jobs
    return session


def export_array(arguments: argparse.Namespace, session: Session, points: Sequence[Point]) -> int:
    """Write the array that --slurm asks for. Returns the exit status."""
    tasks = session.missing(points)
    if not tasks:
        print("Nothing is left to run: the store has every point")
        return HELD
    size = write_array(arguments.slurm, tasks, arguments.array_size)
    counts = f"{count_of(len(tasks), 'run')} in {count_of(size, 'task')}"
    print(f"{arguments.slurm}: {counts}; sbatch {arguments.slurm}")
    return HELD
