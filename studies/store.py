"""Records by their addresses: what has been run once is not run again.

A record is a file, written beside its name and renamed, so that a killed study leaves no half of
one. Two hex digits make a folder, as a study may have a hundred thousand.
"""

import contextlib
import fcntl
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import overload

from studies.errors import StudyError
from studies.record import Record
from studies.whole_file import write_whole

DEFAULT_STORE = Path("studies-out") / "store"


class Store:
    """A folder of records."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def get(self, address: str) -> Record | None:
        """The record, or nothing. Throws StudyError for a file that is none."""
        path = self._path(address)
        try:
            record = Record.from_json(path.read_text(encoding="utf-8"))
        except FileNotFoundError:
            return None
        except ValueError as error:
            raise StudyError(f"{path}: no record of a run: {error}; remove it") from error
        if record.address != address:
            raise StudyError(f"{path}: the record of another run; remove it")
        return record

    def put(self, record: Record, files: Mapping[str, bytes] | None = None) -> None:
        """Store a record, and first the files that are kept with it."""
        path = self._path(record.address)
        path.parent.mkdir(parents=True, exist_ok=True)
        for name, data in (files or {}).items():
            write_whole(self.file(record.address, name), data)
        write_whole(path, record.to_json().encode())

    @contextlib.contextmanager
    def claim(self, address: str) -> Iterator[None]:
        """Keep others from running what is being run; waits for one that does.

        The lock goes with who holds it, however that ends.
        """
        # Few enough to lie about, and so many that two runs seldom meet at one.
        folder = self.folder / "locks"
        folder.mkdir(parents=True, exist_ok=True)
        with (folder / address[:3]).open("ab") as file:
            fcntl.flock(file, fcntl.LOCK_EX)
            yield

    def file(self, address: str, name: str) -> Path:
        """Where a file is that was kept with a record."""
        return self._path(address).with_suffix(f".{name}")

    def _path(self, address: str) -> Path:
        return self.folder / address[:2] / f"{address[2:]}.json"


class Records(Sequence[Record]):
    """Records in the order of their points, read again each time that one is asked for.

    The figures of ten thousand runs are in the store, not in memory; who wants them more than once
    makes a list. `of` has an address, or the record itself where the store has none.
    """

    def __init__(self, store: Store, of: Sequence[str | Record]) -> None:
        self._store = store
        self._of = of

    def __len__(self) -> int:
        return len(self._of)

    @overload
    def __getitem__(self, index: int) -> Record: ...
    @overload
    def __getitem__(self, index: slice) -> "Records": ...
    def __getitem__(self, index: int | slice) -> "Record | Records":
        """Throws StudyError where somebody has removed the record meanwhile."""
        if isinstance(index, slice):
            return Records(self._store, self._of[index])
        found = self._of[index]
        if isinstance(found, Record):
            return found
        record = self._store.get(found)
        if record is None:
            raise StudyError(
                f"{self._store.folder}: the record of {found} was removed meanwhile; "
                "the same command runs it again"
            )
        return record

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Sequence) and list(self) == list(other)

    __hash__ = None  # type: ignore[assignment]
