// What of an ECP5's block RAM the engine uses (Lattice FPGA-TN-02204): two ports of one width, each
// with a clock, the read register, the output register behind it, and writes that leave both as they
// are. An instance that uses more of it ends the simulation.
`default_nettype none

module DP16KD #(
    parameter int DATA_WIDTH_A = 18,
    parameter int DATA_WIDTH_B = 18,
    parameter REGMODE_A = "NOREG",
    parameter REGMODE_B = "NOREG",
    parameter CSDECODE_A = "0b000",
    parameter CSDECODE_B = "0b000",
    parameter WRITEMODE_A = "NORMAL",
    parameter WRITEMODE_B = "NORMAL"
) (
    input wire CLKA, CEA, OCEA, WEA, RSTA, CSA0, CSA1, CSA2,
    input wire ADA0, ADA1, ADA2, ADA3, ADA4, ADA5, ADA6, ADA7, ADA8,
    input wire ADA9, ADA10, ADA11, ADA12, ADA13,
    input wire DIA0, DIA1, DIA2, DIA3, DIA4, DIA5, DIA6, DIA7, DIA8,
    input wire DIA9, DIA10, DIA11, DIA12, DIA13, DIA14, DIA15, DIA16, DIA17,
    output wire DOA0, DOA1, DOA2, DOA3, DOA4, DOA5, DOA6, DOA7, DOA8,
    output wire DOA9, DOA10, DOA11, DOA12, DOA13, DOA14, DOA15, DOA16, DOA17,
    input wire CLKB, CEB, OCEB, WEB, RSTB, CSB0, CSB1, CSB2,
    input wire ADB0, ADB1, ADB2, ADB3, ADB4, ADB5, ADB6, ADB7, ADB8,
    input wire ADB9, ADB10, ADB11, ADB12, ADB13,
    input wire DIB0, DIB1, DIB2, DIB3, DIB4, DIB5, DIB6, DIB7, DIB8,
    input wire DIB9, DIB10, DIB11, DIB12, DIB13, DIB14, DIB15, DIB16, DIB17,
    output wire DOB0, DOB1, DOB2, DOB3, DOB4, DOB5, DOB6, DOB7, DOB8,
    output wire DOB9, DOB10, DOB11, DOB12, DOB13, DOB14, DOB15, DOB16, DOB17
);

  localparam int Bits = DATA_WIDTH_A;
  localparam int Shift = Bits == 18 ? 4 : Bits == 9 ? 3 : $clog2(Bits);
  if (DATA_WIDTH_B != Bits || CSDECODE_A != "0b000" || CSDECODE_B != "0b000" ||
      WRITEMODE_A != "NORMAL" || WRITEMODE_B != "NORMAL") begin
    $error("this model has two ports of one width");
  end
  wire unused = &{1'b0, RSTA, RSTB, CSA0, CSA1, CSA2, CSB0, CSB1, CSB2};

  wire [13:0] address_a = {ADA13, ADA12, ADA11, ADA10, ADA9, ADA8, ADA7, ADA6, ADA5,
      ADA4, ADA3, ADA2, ADA1, ADA0};
  wire [17:0] in_a = {DIA17, DIA16, DIA15, DIA14, DIA13, DIA12, DIA11, DIA10, DIA9,
      DIA8, DIA7, DIA6, DIA5, DIA4, DIA3, DIA2, DIA1, DIA0};
  logic [17:0] read_a, out_a;
  assign {DOA17, DOA16, DOA15, DOA14, DOA13, DOA12, DOA11, DOA10, DOA9,
      DOA8, DOA7, DOA6, DOA5, DOA4, DOA3, DOA2, DOA1, DOA0} =
      REGMODE_A == "OUTREG" ? out_a : read_a;
  wire [13:0] address_b = {ADB13, ADB12, ADB11, ADB10, ADB9, ADB8, ADB7, ADB6, ADB5,
      ADB4, ADB3, ADB2, ADB1, ADB0};
  wire [17:0] in_b = {DIB17, DIB16, DIB15, DIB14, DIB13, DIB12, DIB11, DIB10, DIB9,
      DIB8, DIB7, DIB6, DIB5, DIB4, DIB3, DIB2, DIB1, DIB0};
  logic [17:0] read_b, out_b;
  assign {DOB17, DOB16, DOB15, DOB14, DOB13, DOB12, DOB11, DOB10, DOB9,
      DOB8, DOB7, DOB6, DOB5, DOB4, DOB3, DOB2, DOB1, DOB0} =
      REGMODE_B == "OUTREG" ? out_b : read_b;

  // A byte of a port of 18 bits is written where the address' lowest bits say so.
  logic [Bits-1:0] cells[2**(14-Shift)];
  function automatic logic [Bits-1:0] merged(input logic [Bits-1:0] old, input logic [17:0] in,
                                             input logic [13:0] at);
    logic [Bits-1:0] result;
    result = old;
    for (int i = 0; i < Bits; ++i) if (Bits < 18 || at[i/9]) result[i] = in[i];
    return result;
  endfunction

  // Both ports write the same cells.
  /* verilator lint_off BLKSEQ */
  always @(posedge CLKA) begin
    if (OCEA) out_a <= read_a;
    if (CEA && WEA) cells[address_a[13:Shift]] = merged(cells[address_a[13:Shift]], in_a, address_a);
    else if (CEA) read_a <= 18'(cells[address_a[13:Shift]]);
  end
  always @(posedge CLKB) begin
    if (OCEB) out_b <= read_b;
    if (CEB && WEB) cells[address_b[13:Shift]] = merged(cells[address_b[13:Shift]], in_b, address_b);
    else if (CEB) read_b <= 18'(cells[address_b[13:Shift]]);
  end
  /* verilator lint_on BLKSEQ */

endmodule

`default_nettype wire
