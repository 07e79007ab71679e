// A memory with two ports that both read and write, of an ECP5's block RAMs: a word comes behind the
// edge that takes its address or, with their output registers, behind the next one. A write leaves
// the port's output as it is. For synthesis, which finds neither the two ports nor those registers.
`default_nettype none

module ecp5_memory #(
    parameter int Width = 16,
    parameter int AddressBits = 10,
    parameter bit OutputRegister = 1'b1,
    // A block has 1024 words of 18 bits, twice as many of half the width, and so on.
    localparam int PortBits =
        AddressBits <= 10 ? 18 : AddressBits == 11 ? 9 : AddressBits == 12 ? 4 :
        AddressBits == 13 ? 2 : 1,
    // Of an address within a block's, which counts bits; every eighth one has a ninth beside it.
    localparam int Shift = PortBits == 18 ? 4 : PortBits == 9 ? 3 : $clog2(PortBits)
) (
    input wire clock,
    input wire [1:0] write,
    input wire [1:0][AddressBits-1:0] address,
    input wire [1:0][Width-1:0] write_word,
    input wire registers,  // the output registers take what was read
    output wire [1:0][Width-1:0] word
);

  localparam int Blocks = (Width + PortBits - 1) / PortBits;
  if (AddressBits > 14) $error("an ECP5's block RAM has 2^14 bits");

  // The lowest address bits of a wide port are its byte enables.
  localparam logic [13:0] ByteEnables = PortBits == 18 ? 14'd3 : 14'd0;
  wire [13:0] a = 14'(address[0]) << Shift | ByteEnables;
  wire [13:0] b = 14'(address[1]) << Shift | ByteEnables;
  wire [1:0][Blocks*PortBits-1:0] in, out;
  for (genvar p = 0; p < 2; ++p) begin : g_port
    assign in[p] = (Blocks * PortBits)'(write_word[p]);
    assign word[p] = out[p][Width-1:0];
  end
  wire unused = &{1'b0, out};

  for (genvar i = 0; i < Blocks; ++i) begin : g_block
    wire [17:0] da = 18'(in[0][i*PortBits+:PortBits]);
    wire [17:0] db = 18'(in[1][i*PortBits+:PortBits]);
    wire [17:0] qa, qb;
    assign out[0][i*PortBits+:PortBits] = qa[PortBits-1:0];
    assign out[1][i*PortBits+:PortBits] = qb[PortBits-1:0];
    wire unused_bits = &{1'b0, qa, qb};
    DP16KD #(
        .DATA_WIDTH_A(PortBits),
        .DATA_WIDTH_B(PortBits),
        .REGMODE_A(OutputRegister ? "OUTREG" : "NOREG"),
        .REGMODE_B(OutputRegister ? "OUTREG" : "NOREG"),
        .CSDECODE_A("0b000"),
        .CSDECODE_B("0b000"),
        .WRITEMODE_A("NORMAL"),
        .WRITEMODE_B("NORMAL")
    ) block (
        .CLKA(clock), .CEA(1'b1), .OCEA(registers), .WEA(write[0]), .RSTA(1'b0),
        .CSA0(1'b0), .CSA1(1'b0), .CSA2(1'b0),
        .ADA0(a[0]), .ADA1(a[1]), .ADA2(a[2]), .ADA3(a[3]), .ADA4(a[4]), .ADA5(a[5]),
        .ADA6(a[6]), .ADA7(a[7]), .ADA8(a[8]), .ADA9(a[9]), .ADA10(a[10]), .ADA11(a[11]),
        .ADA12(a[12]), .ADA13(a[13]),
        .DIA0(da[0]), .DIA1(da[1]), .DIA2(da[2]), .DIA3(da[3]), .DIA4(da[4]), .DIA5(da[5]),
        .DIA6(da[6]), .DIA7(da[7]), .DIA8(da[8]), .DIA9(da[9]), .DIA10(da[10]), .DIA11(da[11]),
        .DIA12(da[12]), .DIA13(da[13]), .DIA14(da[14]), .DIA15(da[15]), .DIA16(da[16]), .DIA17(da[17]),
        .DOA0(qa[0]), .DOA1(qa[1]), .DOA2(qa[2]), .DOA3(qa[3]), .DOA4(qa[4]), .DOA5(qa[5]),
        .DOA6(qa[6]), .DOA7(qa[7]), .DOA8(qa[8]), .DOA9(qa[9]), .DOA10(qa[10]), .DOA11(qa[11]),
        .DOA12(qa[12]), .DOA13(qa[13]), .DOA14(qa[14]), .DOA15(qa[15]), .DOA16(qa[16]), .DOA17(qa[17]),
        .CLKB(clock), .CEB(1'b1), .OCEB(registers), .WEB(write[1]), .RSTB(1'b0),
        .CSB0(1'b0), .CSB1(1'b0), .CSB2(1'b0),
        .ADB0(b[0]), .ADB1(b[1]), .ADB2(b[2]), .ADB3(b[3]), .ADB4(b[4]), .ADB5(b[5]),
        .ADB6(b[6]), .ADB7(b[7]), .ADB8(b[8]), .ADB9(b[9]), .ADB10(b[10]), .ADB11(b[11]),
        .ADB12(b[12]), .ADB13(b[13]),
        .DIB0(db[0]), .DIB1(db[1]), .DIB2(db[2]), .DIB3(db[3]), .DIB4(db[4]), .DIB5(db[5]),
        .DIB6(db[6]), .DIB7(db[7]), .DIB8(db[8]), .DIB9(db[9]), .DIB10(db[10]), .DIB11(db[11]),
        .DIB12(db[12]), .DIB13(db[13]), .DIB14(db[14]), .DIB15(db[15]), .DIB16(db[16]), .DIB17(db[17]),
        .DOB0(qb[0]), .DOB1(qb[1]), .DOB2(qb[2]), .DOB3(qb[3]), .DOB4(qb[4]), .DOB5(qb[5]),
        .DOB6(qb[6]), .DOB7(qb[7]), .DOB8(qb[8]), .DOB9(qb[9]), .DOB10(qb[10]), .DOB11(qb[11]),
        .DOB12(qb[12]), .DOB13(qb[13]), .DOB14(qb[14]), .DOB15(qb[15]), .DOB16(qb[16]), .DOB17(qb[17])
    );
  end

endmodule

`default_nettype wire
