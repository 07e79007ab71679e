"""A running `hvp serve` for a test: started, waited for, ended, with a hard limit on each."""

from __future__ import annotations

import signal
import subprocess
from pathlib import Path
from types import TracebackType

LIMIT_S = 120


class Served:
    def __init__(self, program: Path, scenario: list[str], socket: Path) -> None:
        self.socket = socket
        self._process = subprocess.Popen(
            [str(program), "serve", *scenario, "--quiet", "--vfio-user", str(socket)],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )

    def __enter__(self) -> Served:
        assert self._process.stdout is not None
        line = self._process.stdout.readline()  # once it listens, or has ended
        if not line.startswith("listening on "):
            _, errors = self._process.communicate(timeout=LIMIT_S)
            raise RuntimeError(f"hvp serve does not listen: {line}{errors}")
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._process.send_signal(signal.SIGTERM)
        try:
            self._process.communicate(timeout=LIMIT_S)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.communicate()
            raise
        if kind is None and (self._process.returncode != -signal.SIGTERM or self.socket.exists()):
            raise RuntimeError(f"hvp serve ended with {self._process.returncode}")
