#!/usr/bin/env python3
"""Makes from hvp.rdl what the driver, the model and the reader need of the register map.

    driver/generated/hvp_registers.h   the driver's C header
    vp/fpga/register_table.h           the model's C++ table
    docs/registers.md                  the reference page

The three are checked in. With --check nothing is written; the exit status is 1 and the stale files
are named if what is checked in is not what the description gives. Needs requirements.txt.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from enum import IntEnum
from pathlib import Path
from typing import Any, NoReturn

from peakrdl_cheader.exporter import CHeaderExporter
from systemrdl.compiler import RDLCompiler
from systemrdl.node import AddrmapNode, FieldNode, MemNode, RegNode
from systemrdl.rdltypes.builtin_enums import OnWriteType

TOP = Path(__file__).resolve().parent.parent
DESCRIPTION = TOP / "driver" / "hvp.rdl"
LICENCE = "SPDX-License-Identifier: GPL-2.0-only OR Apache-2.0"
NOTICE = "Generated from driver/hvp.rdl by driver/generate.py. Do not edit."
WORD_BYTES = 4


def words(text: str | None) -> str:
    """One line out of a description that was wrapped for the source."""
    return " ".join((text or "").split())


def pascal_case(name: str) -> str:
    return "".join(part.capitalize() for part in name.split("_"))


@dataclass(frozen=True)
class Entry:
    """A value of an enumeration."""

    name: str
    value: int
    description: str


@dataclass(frozen=True)
class Field:
    name: str
    low: int
    width: int
    reset: int
    readable: bool
    writable: bool
    write_one_to_clear: bool
    pulse: bool
    locked_while_busy: bool
    encoding: str | None
    description: str

    @property
    def mask(self) -> int:
        return ((1 << self.width) - 1) << self.low

    @property
    def access(self) -> str:
        if self.write_one_to_clear:
            return "read, write 1 to clear"
        if self.pulse:
            return "write 1 to command"
        if self.readable and self.writable:
            return "read, write"
        return "read" if self.readable else "write"


@dataclass(frozen=True)
class Register:
    name: str
    offset: int
    title: str
    description: str
    fields: tuple[Field, ...]

    def mask(self, chosen: Callable[[Field], bool]) -> int:
        return sum(field.mask for field in self.fields if chosen(field))

    @property
    def reset(self) -> int:
        return sum(field.reset << field.low for field in self.fields)


@dataclass(frozen=True)
class Aperture:
    name: str
    offset: int
    size: int
    title: str
    description: str
    readable: bool
    writable: bool
    locked_while_busy: bool
    element_width: str | None


@dataclass(frozen=True)
class Map:
    description: str
    registers: tuple[Register, ...]
    apertures: tuple[Aperture, ...]
    encodings: dict[str, tuple[Entry, ...]]


def refuse(message: str) -> NoReturn:
    raise SystemExit(f"{DESCRIPTION.name}: {message}")


def is_set(node: Any, name: str) -> bool:
    return node.get_property(name) is True


def read_field(node: FieldNode, *, whole_locked: bool) -> Field:
    encoding = node.get_property("encode")
    on_write = node.get_property("onwrite")
    reset = node.get_property("reset") or 0
    if not isinstance(reset, int):
        refuse(f"{node.get_path()}: the reset value is not a number")
    if on_write not in (None, OnWriteType.woclr) or node.get_property("onread") is not None:
        refuse(f"{node.get_path()}: the model knows no side effect but woclr and singlepulse")
    return Field(
        name=node.inst_name,
        low=node.low,
        width=node.width,
        reset=reset,
        readable=node.is_sw_readable,
        writable=node.is_sw_writable,
        write_one_to_clear=on_write is OnWriteType.woclr,
        pulse=node.get_property("singlepulse"),
        locked_while_busy=node.is_sw_writable
        and (whole_locked or is_set(node, "locked_while_busy")),
        encoding=encoding.type_name if encoding else None,
        description=words(node.get_property("desc")),
    )


def read_map(top: AddrmapNode) -> Map:
    registers: list[Register] = []
    apertures: list[Aperture] = []
    encodings: dict[str, tuple[Entry, ...]] = {}
    for node in top.children():
        title = words(node.get_property("name"))
        description = words(node.get_property("desc"))
        if isinstance(node, RegNode):
            if node.size != WORD_BYTES or node.is_array:
                refuse(f"{node.inst_name}: registers are single 32-bit words")
            locked = is_set(node, "locked_while_busy")
            fields = tuple(read_field(field, whole_locked=locked) for field in node.fields())
            registers.append(
                Register(node.inst_name, node.absolute_address, title, description, fields)
            )
            for field_node in node.fields():
                encoding = field_node.get_property("encode")
                if encoding is not None:
                    encodings[encoding.type_name] = tuple(
                        Entry(member.name, member.value, words(member.rdl_desc))
                        for member in encoding
                    )
        elif isinstance(node, MemNode):
            if node.get_property("memwidth") != 8 * WORD_BYTES:
                refuse(f"{node.inst_name}: memories are 32 bits wide")
            apertures.append(
                Aperture(
                    name=node.inst_name,
                    offset=node.absolute_address,
                    size=node.size,
                    title=title,
                    description=description,
                    readable=node.is_sw_readable,
                    writable=node.is_sw_writable,
                    locked_while_busy=is_set(node, "locked_while_busy"),
                    element_width=node.get_property("element_width"),
                )
            )
        else:
            refuse(f"{node.inst_name}: neither a register nor a memory")
    description = "\n\n".join(
        words(part) for part in (top.get_property("desc") or "").split("\n\n")
    )
    return Map(description, tuple(registers), tuple(apertures), encodings)


# A kernel has these under other names.
C_INCLUDES = "#include <stdint.h>\n#include <assert.h>\n"
EITHER_INCLUDES = f"""#ifdef __KERNEL__
#include <linux/build_bug.h>
#include <linux/stddef.h>
#include <linux/types.h>
#else
{C_INCLUDES}#endif
"""


def c_header(top: AddrmapNode, the_map: Map) -> str:
    """PeakRDL's masks and struct for a program and for a kernel, with the enumerations, which it
    leaves out, put behind them."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "hvp_registers.h"
        CHeaderExporter().export(top, str(path), reuse_typedefs=False)
        text = path.read_text(encoding="utf-8")
    if text.count(C_INCLUDES) != 1:
        refuse("the C header has changed its form: not its two includes")
    text = text.replace(C_INCLUDES, EITHER_INCLUDES)
    lines = []
    for name, entries in the_map.encodings.items():
        lines += [f"// enumeration - {name}", f"enum hvp_{name} {{"]
        lines += [
            f"    HVP_{name.upper()}_{entry.name.upper()} = {entry.value}, // {entry.description}"
            for entry in entries
        ]
        lines += ["};", ""]
    marker = "#ifdef __cplusplus\n}"
    before, found, after = text.rpartition(marker)
    if not found:
        refuse("the C header has changed its form: no closing extern C")
    return f"// {LICENCE}\n// {NOTICE}\n" + before + "\n".join(lines) + "\n" + found + after


def cpp_table(the_map: Map) -> str:
    def hexadecimal(value: int) -> str:
        return f"0x{value:08x}"

    registers = the_map.registers
    apertures = the_map.apertures
    page_end = max(register.offset for register in registers) + WORD_BYTES
    bar_bytes = 1 << (max(a.offset + a.size for a in apertures) - 1).bit_length()
    out = [
        "#pragma once",
        "",
        f"// {NOTICE}",
        "",
        "#include <array>",
        "#include <cstdint>",
        "#include <string_view>",
        "",
        "// clang-format off",
        "namespace hvp::vp {",
        "",
        "enum class Register : std::uint8_t {",
        *(f"  {register.name.lower()},  // {register.title}" for register in registers),
        "};",
        "",
        "enum class Aperture : std::uint8_t {",
        *(f"  {aperture.name.lower()},  // {aperture.title}" for aperture in apertures),
        "};",
        "",
        "// A bit is reserved where both read_mask and write_mask are zero. A command (pulse) bit",
        "// is not stored. While STATUS.busy, a register is locked whole where busy_mask has bits",
        "// that are not commands; otherwise only the commands in busy_mask are.",
        "struct RegisterInfo {",
        "  std::string_view name;",
        "  std::uint32_t offset;",
        "  std::uint32_t reset;",
        "  std::uint32_t read_mask;",
        "  std::uint32_t write_mask;",
        "  std::uint32_t write_one_to_clear_mask;",
        "  std::uint32_t pulse_mask;",
        "  std::uint32_t busy_mask;",
        "};",
        "",
        "struct ApertureInfo {",
        "  std::string_view name;",
        "  std::uint32_t offset;",
        "  std::uint32_t size;  // bytes at full depth",
        "  bool readable;",
        "  bool writable;",
        "  bool locked_while_busy;",
        "};",
        "",
        "// Some bits of a register, the lowest at `low`.",
        "struct Field {",
        "  Register reg;",
        "  unsigned low;",
        "  unsigned width;",
        "",
        "  constexpr std::uint32_t mask() const {",
        "    return (~std::uint32_t{0} >> (32 - width)) << low;",
        "  }",
        "};",
        "",
        f"inline constexpr std::uint32_t kBarBytes = {hexadecimal(bar_bytes)};",
        "// Registers lie below this offset, memories above.",
        f"inline constexpr std::uint32_t kRegisterBytes = {hexadecimal(page_end)};",
        "",
        "// In the order of Register; offsets ascend.",
        f"inline constexpr std::array<RegisterInfo, {len(registers)}> kRegisters = {{{{",
    ]
    for register in registers:
        masks = (
            register.offset,
            register.reset,
            register.mask(lambda field: field.readable),
            register.mask(lambda field: field.writable),
            register.mask(lambda field: field.write_one_to_clear),
            register.mask(lambda field: field.pulse),
            register.mask(lambda field: field.locked_while_busy),
        )
        out.append(f'    {{"{register.name}", {", ".join(map(hexadecimal, masks))}}},')
    out += [
        "}};",
        "",
        "// In the order of Aperture; offsets ascend.",
        f"inline constexpr std::array<ApertureInfo, {len(apertures)}> kApertures = {{{{",
    ]
    for aperture in apertures:
        flags = (aperture.readable, aperture.writable, aperture.locked_while_busy)
        out.append(
            f'    {{"{aperture.name}", {hexadecimal(aperture.offset)}, '
            f"{hexadecimal(aperture.size)}, {', '.join(str(flag).lower() for flag in flags)}}},"
        )
    out += ["}};", ""]
    for name, entries in the_map.encodings.items():
        out.append(f"enum class {pascal_case(name)} : std::uint32_t {{")
        out += [f"  {entry.name} = {entry.value},  // {entry.description}" for entry in entries]
        out += ["};", ""]
    out += ["namespace field {", ""]
    for register in registers:
        out += [
            f"inline constexpr Field k{pascal_case(f'{register.name}_{field.name}')}"
            f"{{Register::{register.name.lower()}, {field.low}, {field.width}}};"
            for field in register.fields
        ]
    out += ["", "}  // namespace field", "", "}  // namespace hvp::vp", "// clang-format on", ""]
    return "\n".join(out)


def table(head: Iterable[str], rows: Iterable[Iterable[str]]) -> list[str]:
    head = list(head)
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    lines += ["| " + " | ".join(cell.replace("|", "\\|") for cell in row) + " |" for row in rows]
    return [*lines, ""]


def reference_page(the_map: Map) -> str:
    registers = the_map.registers
    apertures = the_map.apertures
    out = ["# Registers of the solver board", "", f"<!-- {NOTICE} -->", "", the_map.description, ""]
    out += ["## Overview", ""]
    out += table(
        ("offset", "register", "", "reset"),
        (
            (f"0x{r.offset:03x}", f"[{r.name}](#{r.name.lower()})", r.title, f"0x{r.reset:08x}")
            for r in registers
        ),
    )
    out += table(
        ("offset", "memory", "", "bytes", "element width"),
        (
            (
                f"0x{a.offset:07x}",
                f"[{a.name}](#memories)",
                a.title,
                f"{a.size}",
                f"FORMAT.{a.element_width}" if a.element_width else "one word",
            )
            for a in apertures
        ),
    )
    out += ["## Registers", ""]
    for register in registers:
        out += [f"### {register.name}", "", f"Offset 0x{register.offset:03x}. {register.title}."]
        if register.description:
            out.append(register.description)
        if any(field.locked_while_busy and not field.pulse for field in register.fields):
            out.append("Not writable while busy.")
        out.append("")
        rows = []
        for field in sorted(register.fields, key=lambda field: field.low):
            high = field.low + field.width - 1
            bits = f"{high}:{field.low}" if field.width > 1 else f"{field.low}"
            text = field.description
            if field.encoding:
                text += f" See [{field.encoding}](#{field.encoding})."
            if field.pulse:
                text += " Refused while busy." if field.locked_while_busy else ""
            rows.append((bits, field.name, field.access, f"0x{field.reset:x}", text.strip()))
        out += table(("bits", "field", "access", "reset", "meaning"), rows)
    out += ["## Memories", ""]
    memory_rows = []
    for aperture in apertures:
        text = aperture.description
        if aperture.locked_while_busy:
            text += " Neither readable nor writable while busy."
        memory_rows.append((aperture.name, f"0x{aperture.offset:07x}", f"{aperture.size}", text))
    out += table(("memory", "offset", "bytes", "contents"), memory_rows)
    out += ["## Enumerations", ""]
    for name, entries in the_map.encodings.items():
        out += [f"### {name}", ""]
        out += table(
            ("value", "name", "meaning"),
            ((f"{entry.value}", entry.name, entry.description) for entry in entries),
        )
    return "\n".join(out).rstrip("\n") + "\n"


def compile_description() -> AddrmapNode:
    compiler = RDLCompiler()
    compiler.compile_file(str(DESCRIPTION))
    top: AddrmapNode = compiler.elaborate().top
    return top


class Exit(IntEnum):
    FRESH = 0
    STALE = 1


def main() -> Exit:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--check", action="store_true", help="say what is stale, write nothing")
    arguments = parser.parse_args()

    top = compile_description()
    the_map = read_map(top)

    stale = False
    for name, text in {
        "driver/generated/hvp_registers.h": c_header(top, the_map),
        "vp/fpga/register_table.h": cpp_table(the_map),
        "docs/registers.md": reference_page(the_map),
    }.items():
        path = TOP / name
        current = path.read_text(encoding="utf-8") if path.exists() else None
        if current == text:
            continue
        if arguments.check:
            print(f"{name} is stale: run driver/generate.py", file=sys.stderr)
            stale = True
        else:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")
            print(f"wrote {name}", file=sys.stderr)
    return Exit.STALE if stale else Exit.FRESH


if __name__ == "__main__":
    sys.exit(main())
