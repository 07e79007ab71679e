"""Small designs whose longest path is known, for place-and-route.

Each is registers, a few elements, registers. Inputs come from a shift register, so that a design
needs three pins whatever its words, and outputs are kept without pins: what is measured is the path
between registers. `Counts` says how often each element of the delay model lies on that path.
"""

from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True)
class Counts:
    """Elements on the longest path (docs/critical-path.md)."""

    registers: int = 1  # clock-to-out and set-up of logic cells
    luts: int = 0
    chains: int = 0  # carry chains
    chain_bits: int = 0
    multipliers: int = 0  # unregistered
    block_registers: int = 0  # clock-to-out of a multiplier's own register
    memory_reads: int = 0  # clock-to-out without output register
    memory_outputs: int = 0  # with output register
    memory_writes: int = 0  # set-up of an address
    hops: int = 0  # nets between logic cells
    block_hops: int = 0  # nets to or from a multiplier or a memory


@dataclass(frozen=True)
class Design:
    """A design, and whether its measurement fits the elements or checks them."""

    name: str
    fits: bool
    counts: Counts
    body: str
    inputs: int  # bits
    outputs: int
    multipliers: int = 0  # of the whole design

    def verilog(self) -> str:
        """The module, with its shift register and its kept outputs."""
        return f"""module top(input clk, input bit_in, output bit_out);
reg [{self.inputs - 1}:0] in;
(* keep *) reg [{self.outputs - 1}:0] out;
assign bit_out = in[{self.inputs - 1}];
always @(posedge clk) in <= {{in[{self.inputs - 2}:0], bit_in}};
{self.body}
endmodule
"""


def _absolute(word: str, bits: int) -> str:
    return f"({word}[{bits - 1}] ? -{word} : {word})"


def absolute_value(bits: int, fits: bool) -> Design:
    """A carry chain that negates, and a multiplexer that takes it or not."""
    return Design(
        f"absolute_value_{bits}",
        fits,
        Counts(luts=1, chains=1, chain_bits=bits, hops=2),
        f"always @(posedge clk) out <= {_absolute('in', bits)};",
        bits,
        bits,
    )


def adder(bits: int, fits: bool) -> Design:
    """An adder: its sum goes straight into the register behind it."""
    return Design(
        f"adder_{bits}",
        fits,
        Counts(chains=1, chain_bits=bits, hops=1),
        f"always @(posedge clk) out <= in[{bits - 1}:0] + in[{2 * bits - 1}:{bits}];",
        2 * bits,
        bits,
    )


def adder_tree(terms: int, bits: int, fits: bool) -> Design:
    """Terms added in pairs between two registers; words grow by a bit a level."""
    levels = terms.bit_length() - 1
    lines: list[str] = []
    names = [f"in[{bits * (i + 1) - 1}:{bits * i}]" for i in range(terms)]
    for level in range(1, levels + 1):
        width = bits + level
        pairs = [(names[2 * i], names[2 * i + 1]) for i in range(len(names) // 2)]
        names = []
        for i, (a, b) in enumerate(pairs):
            lines.append(
                f"(* keep *) wire [{width - 1}:0] s{level}_{i} = $signed({a}) + $signed({b});"
            )
            names.append(f"s{level}_{i}")
    width = bits + levels
    lines.append(f"always @(posedge clk) out <= {names[0]};")
    # Chains run one behind the other: a bit of the next needs one bit of the last only, and the
    # carry of each but one is hidden. What is on the path is one whole chain and a bit of the rest.
    return Design(
        f"adder_tree_{terms}x{bits}",
        fits,
        Counts(chains=levels, chain_bits=width, hops=levels),
        "\n".join(lines),
        terms * bits,
        width,
    )


def selector_levels(select_bits: int) -> int:
    """Levels of four-input logic; the first two select bits share one, by its hard multiplexer."""
    return max(1, select_bits - 1)


def selector(ways: int, bits: int, fits: bool) -> Design:
    """A multiplexer of so many words."""
    select = ways.bit_length() - 1
    body = (
        f"wire [{select - 1}:0] which = in[{select - 1}:0];\n"
        f"always @(posedge clk) out <= in[{select} + which*{bits} +: {bits}];"
    )
    levels = selector_levels(select)
    return Design(
        f"selector_{ways}x{bits}",
        fits,
        Counts(luts=levels, hops=levels),
        body,
        select + ways * bits,
        bits,
    )


def barrel_shifter(bits: int, fits: bool) -> Design:
    """A shift to the right by any number of bits, with sign."""
    select = (bits - 1).bit_length()
    levels = selector_levels(select)
    return Design(
        f"barrel_shifter_{bits}",
        fits,
        Counts(luts=levels, hops=levels),
        f"wire signed [{bits - 1}:0] word = in[{bits - 1}:0];\n"
        f"always @(posedge clk) out <= word >>> in[{bits + select - 1}:{bits}];",
        bits + select,
        bits,
    )


def comparator(bits: int, fits: bool) -> Design:
    """The larger of two words is kept: dynamic scaling's search for the largest."""
    return Design(
        f"comparator_{bits}",
        fits,
        Counts(luts=1, chains=1, chain_bits=bits, hops=3),
        "always @(posedge clk) if (in > out) out <= in;",
        bits,
        bits,
    )


def divider_step(bits: int, fits: bool) -> Design:
    """Shift and subtract: the difference is kept where it is not negative."""
    body = (
        f"wire [{bits}:0] shifted = {{out[{bits - 1}:0], in[{bits}]}};\n"
        f"wire [{bits}:0] difference = shifted - {{1'b0, in[{bits - 1}:0]}};\n"
        f"always @(posedge clk) out <= difference[{bits}] ? shifted : difference;"
    )
    return Design(
        f"divider_step_{bits}",
        fits,
        Counts(luts=1, chains=1, chain_bits=bits, hops=3),
        body,
        bits + 1,
        bits + 1,
    )


def multiplier(bits: int, fits: bool) -> Design:
    """A multiplier between registers outside of its block."""
    return Design(
        f"multiplier_{bits}",
        fits,
        Counts(multipliers=1, block_hops=2),
        f"always @(posedge clk) out <= in[{bits - 1}:0] * in[{2 * bits - 1}:{bits}];",
        2 * bits,
        2 * bits,
        1,
    )


def _block(bits: int, registers: dict[str, str]) -> str:
    ports = [f".A{i}(in[{i}]), .B{i}(in[{bits + i}])" for i in range(bits)]
    ports += [f".A{i}(1'b0), .B{i}(1'b0)" for i in range(bits, 18)]
    ports += [f".P{i}(product[{i}])" for i in range(2 * bits)]
    ports += [".SIGNEDA(1'b0), .SIGNEDB(1'b0), .SOURCEA(1'b0), .SOURCEB(1'b0)"]
    ports += [".CLK0(clk), .CE0(1'b1), .RST0(1'b0)"]
    values = ", ".join(f'.{name}("{value}")' for name, value in registers.items())
    return f"MULT18X18D #({values}) block({', '.join(ports)});"


def registered_multiplier(bits: int, pipeline: bool, fits: bool) -> Design:
    """A multiplier between its block's own registers, with or without the one amid it."""
    registers = {"REG_INPUTA_CLK": "CLK0", "REG_INPUTB_CLK": "CLK0", "REG_OUTPUT_CLK": "CLK0"}
    if pipeline:
        registers["REG_PIPELINE_CLK"] = "CLK0"
    body = (
        f"(* keep *) wire [{2 * bits - 1}:0] product;\n{_block(bits, registers)}\n"
        "always @(posedge clk) out <= product;"
    )
    name = "pipelined" if pipeline else "registered"
    return Design(
        f"{name}_multiplier_{bits}",
        fits,
        Counts(registers=0, block_registers=1, block_hops=1),
        body,
        2 * bits,
        2 * bits,
        1,
    )


def wide_product(fits: bool) -> Design:
    """32 x 16 bits from two multipliers and an adder, between two registers."""
    body = (
        "wire [31:0] low = in[15:0] * in[47:32];\n"
        "wire [31:0] high = in[31:16] * in[47:32];\n"
        "always @(posedge clk) out <= {high, 16'b0} + low;"
    )
    return Design(
        "wide_product_32x16",
        fits,
        Counts(multipliers=1, chains=1, chain_bits=32, block_hops=2),
        body,
        48,
        48,
        2,
    )


def critical_path(bits: int, copies: int, fits: bool, registered: bool = False) -> Design:
    """Thesis Fig. 5.10: multiplexer, absolute value, multiplier; so many of them side by side."""
    lines = []
    each = 3 * bits + 1
    for i in range(copies):
        at = i * each
        lines += [
            f"wire [{bits - 1}:0] word{i} = in[{at}] ? in[{at + bits}:{at + 1}]"
            f" : in[{at + 2 * bits}:{at + bits + 1}];",
            f"wire [{bits - 1}:0] size{i} = {_absolute(f'word{i}', bits)};",
        ]
        factor = f"in[{at + 3 * bits}:{at + 2 * bits + 1}]"
        target = f"out[{2 * bits * (i + 1) - 1}:{2 * bits * i}]"
        if registered:
            lines += [
                f"reg [{bits - 1}:0] held{i}, other{i};",
                f"always @(posedge clk) begin held{i} <= size{i}; other{i} <= {factor};"
                f" {target} <= held{i} * other{i}; end",
            ]
        else:
            lines.append(f"always @(posedge clk) {target} <= size{i} * {factor};")
    counts = Counts(luts=2, chains=1, chain_bits=bits, multipliers=1, hops=3, block_hops=2)
    if registered:
        counts = Counts(multipliers=1, block_hops=2)
    name = "with_register_" if registered else ""
    return Design(
        f"critical_path_{name}{bits}x{copies}",
        fits,
        counts,
        "\n".join(lines),
        copies * each,
        copies * 2 * bits,
        copies,
    )


def _memory_block(bits: int, output_register: bool) -> str:
    address = [f".{port}{i + 4}(address[{i}])" for port in ("ADA", "ADB") for i in range(10)]
    data = [f".DIA{i}(in[{10 + i}])" for i in range(bits)]
    read = [f".DOB{i}(read[{i}])" for i in range(bits)]
    control = [
        ".CLKA(clk), .CEA(1'b1), .OCEA(1'b1), .WEA(in[0]), .RSTA(1'b0)",
        ".CLKB(clk), .CEB(1'b1), .OCEB(1'b1), .WEB(1'b0), .RSTB(1'b0)",
    ]
    register = "OUTREG" if output_register else "NOREG"
    values = (
        f'.DATA_WIDTH_A(18), .DATA_WIDTH_B(18), .REGMODE_A("{register}"), .REGMODE_B("{register}")'
    )
    ports = ", ".join(address + data + read + control)
    return f"DP16KD #({values}) block({ports});"


def memory(kind: str, bits: int, fits: bool) -> Design:
    """A block RAM between registers: its read, its read and what follows, or its address."""
    block = _memory_block(bits, kind in ("output", "address"))
    body = [f"wire [{bits - 1}:0] read; wire [9:0] address;", block]
    body.append(
        "assign address = in[50] ? in[49:40] : in[39:30];"
        if kind == "address"
        else "reg [9:0] held; always @(posedge clk) held <= in[39:30]; assign address = held;"
    )
    if kind == "operand":
        body.append(f"always @(posedge clk) out <= in[0] ? read : {{read[0], read[{bits - 1}:1]}};")
        counts = Counts(registers=0, luts=1, memory_reads=1, block_hops=1)
    elif kind == "adder":
        body.append(f"always @(posedge clk) out <= read + in[{bits - 1}:0];")
        counts = Counts(registers=0, chains=1, chain_bits=bits, memory_reads=1, block_hops=1)
    else:
        body.append("always @(posedge clk) out <= read;")
        counts = {
            "read": Counts(registers=0, memory_reads=1, block_hops=1),
            "output": Counts(registers=0, memory_outputs=1, block_hops=1),
            "address": Counts(luts=1, memory_writes=1, hops=1, block_hops=1),
        }[kind]
    return Design(f"memory_{kind}_{bits}", fits, counts, "\n".join(body), 52, bits)


def multiply_accumulate(columns: int, rows: int, fits: bool) -> Design:
    """The sub-block of thesis Fig. 5.5: 12 x 16 bits, a rank an addition, 48-bit accumulators."""
    word = 12
    operand = 16
    levels = columns.bit_length() - 1
    lines: list[str] = []
    for r in range(rows):
        names = []
        for c in range(columns):
            a = (r * columns + c) * word
            d = rows * columns * word + c * operand
            lines += [
                f"reg signed [27:0] p{r}_{c};",
                f"always @(posedge clk) p{r}_{c} <= $signed(in[{a + word - 1}:{a}])"
                f" * $signed(in[{d + operand - 1}:{d}]);",
            ]
            names.append(f"p{r}_{c}")
        for level in range(1, levels + 1):
            width = 28 + level
            pairs = [(names[2 * i], names[2 * i + 1]) for i in range(len(names) // 2)]
            names = []
            for i, (left, right) in enumerate(pairs):
                name = f"t{r}_{level}_{i}"
                lines += [
                    f"reg signed [{width - 1}:0] {name};",
                    f"always @(posedge clk) {name} <= {left} + {right};",
                ]
                names.append(name)
        lines.append(
            f"always @(posedge clk) out[{48 * r + 47}:{48 * r}] <="
            f" $signed(out[{48 * r + 47}:{48 * r}]) + {names[0]};"
        )
    return Design(
        f"multiply_accumulate_{rows}x{columns}",
        fits,
        Counts(multipliers=1, block_hops=2),
        "\n".join(lines),
        rows * columns * word + columns * operand,
        48 * rows,
        rows * columns,
    )


def all_designs() -> list[Design]:
    """Some for the fit, the others to check it."""
    fit, check = True, False
    make: list[Callable[[], Design]] = [
        lambda: absolute_value(8, fit),
        lambda: absolute_value(16, check),
        lambda: absolute_value(32, fit),
        lambda: absolute_value(64, check),
        lambda: adder(16, fit),
        lambda: adder(32, check),
        lambda: adder(48, check),
        lambda: adder(64, fit),
        lambda: adder_tree(4, 28, check),
        lambda: adder_tree(8, 28, fit),
        lambda: selector(4, 16, fit),
        lambda: selector(16, 16, check),
        lambda: barrel_shifter(32, check),
        lambda: barrel_shifter(48, fit),
        lambda: comparator(16, fit),
        lambda: comparator(32, check),
        lambda: divider_step(32, fit),
        lambda: divider_step(64, check),
        lambda: multiplier(12, check),
        lambda: multiplier(16, fit),
        lambda: registered_multiplier(16, False, fit),
        lambda: registered_multiplier(16, True, fit),
        lambda: wide_product(check),
        lambda: memory("read", 18, fit),
        lambda: memory("output", 18, fit),
        lambda: memory("address", 18, fit),
        lambda: memory("operand", 16, check),
        lambda: memory("adder", 16, check),
        lambda: critical_path(8, 1, fit),
        lambda: critical_path(12, 1, check),
        lambda: critical_path(16, 1, check),
        lambda: critical_path(18, 1, fit),
        lambda: critical_path(16, 1, check, registered=True),
        lambda: critical_path(16, 4, fit),
        lambda: critical_path(16, 12, check),
        lambda: critical_path(16, 24, fit),
        lambda: multiply_accumulate(8, 1, fit),
        lambda: multiply_accumulate(8, 3, check),
    ]
    return [function() for function in make]
