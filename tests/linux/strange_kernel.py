#!/usr/bin/env python3
"""A "kernel" that says what none would: it is started as one, with the word strange=HOW among its
arguments, connects where it is told to, and does that."""

import os
import socket
import struct
import sys
import time

ACK, START, REQUEST, WAIT, RUN = 0, 1, 2, 3, 6


def word(name: str) -> str:
    return next(a.removeprefix(name) for a in sys.argv[1:] if a.startswith(name))


def connect(path: str) -> socket.socket:
    connection = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
    connection.connect(path)
    return connection


class Calendar:
    def __init__(self) -> None:
        self.socket = connect(word("time-travel=ext:"))
        self.tell(START, 0)

    def tell(self, operation: int, at: int) -> None:
        self.socket.sendall(struct.pack("<IIQ", operation, 1, at))
        self.socket.recv(16)


def vhost(request: int, payload: bytes, size: int | None = None, flags: int = 1) -> bytes:
    return struct.pack("<III", request, flags, len(payload) if size is None else size) + payload


def memory_table(connection: socket.socket, size: int, file_size: int) -> None:
    file = os.memfd_create("guest")
    os.ftruncate(file, file_size)
    table = struct.pack("<IIQQQQ", 1, 0, 0x100000, size, 0x100000, 0)
    socket.send_fds(connection, [vhost(5, table)], [file])


def speak_of_time(how: str) -> None:
    calendar = Calendar()
    if how == "unknown-time":
        calendar.socket.sendall(struct.pack("<IIQ", 99, 1, 0))
        time.sleep(60)
    if how == "past":
        calendar.tell(REQUEST, 1000)
        calendar.tell(WAIT, 0)
        calendar.socket.recv(16)
        calendar.socket.sendall(struct.pack("<IIQ", ACK, 1, 0))
        calendar.tell(REQUEST, 1)
        time.sleep(60)
    if how == "sleeps-for-ever":
        calendar.tell(REQUEST, 2**63 - 1)
        calendar.tell(WAIT, 0)
        time.sleep(60)
    speak_of_memory(how)


def speak_of_memory(how: str) -> None:
    board = connect(word("virtio_uml.device=").rpartition(":")[0])
    if how == "four-gigabytes":
        board.sendall(vhost(5, b"", 0xFFFFFFFF))
    elif how == "rubbish":
        board.sendall(bytes(range(256)) * 16)
    elif how == "half-a-message":
        board.sendall(vhost(5, b"")[:7])
        sys.exit(0)
    elif how == "no-descriptor":
        board.sendall(vhost(5, struct.pack("<IIQQQQ", 1, 0, 0, 4096, 0, 0)))
    elif how == "short-memory":
        memory_table(board, 1 << 40, 4096)
    elif how == "leaves":
        board.close()
    else:
        make_ring(board, 0x500000 if how == "ring-outside" else 0x100F00)
    time.sleep(60)


def make_ring(board: socket.socket, available: int) -> None:
    memory_table(board, 4096, 4096)
    board.sendall(vhost(8, struct.pack("<II", 0, 256)))
    board.sendall(vhost(9, struct.pack("<IIQQQQ", 0, 0, 0x100000, 0x100800, available, 0)))
    board.sendall(vhost(18, struct.pack("<II", 0, 1)))
    board.sendall(vhost(35, struct.pack("<II", 0, 0)))


def main() -> None:
    how = word("strange=")
    if how == "dies":
        sys.exit(4)
    if how == "silent":
        time.sleep(60)
    if how == "half-a-time":
        connect(word("time-travel=ext:")).sendall(b"\1\0\0")
        sys.exit(0)
    speak_of_time(how)


main()
