#pragma once

// Generated from driver/hvp.rdl by driver/generate.py. Do not edit.

#include <array>
#include <cstdint>
#include <string_view>

// clang-format off
namespace hvp::vp {

enum class Register : std::uint8_t {
  id,  // Identification
  version,  // Version of this register map
  capability_nodes,  // Capability: nodes
  capability_blocks,  // Capability: blocks
  capability_format,  // Capability: word lengths
  capability_clock,  // Capability: clock
  capability_solver,  // Capability: solver
  capability_dma,  // Capability: DMA
  control,  // Control
  status,  // Status
  interrupt_status,  // Interrupt status
  interrupt_enable,  // Interrupt enable
  error,  // Error
  error_detail,  // Error detail
  job,  // Job
  method,  // Method
  iterations,  // Iterations
  stop_residual_low,  // Stop residual, low half
  stop_residual_high,  // Stop residual, high half
  replace_every,  // Residual replacement
  static_shift,  // Static scaling
  scaling,  // Dynamic scaling
  format,  // Word lengths
  coefficients,  // Coefficients
  arithmetic,  // Arithmetic
  start_mode,  // Start mode
  nodes,  // Nodes
  blocks,  // Blocks
  packing,  // Packing of elements
  update_node,  // Update: node
  update_kind,  // Update: kind
  update_diagonal,  // Update: diagonal
  update_blocks,  // Update: blocks
  result_job,  // Result: job
  result_iterations,  // Result: iterations
  result_end,  // Result: end
  result_replacements,  // Result: replacements
  result_saturations,  // Result: saturations
  result_wraps,  // Result: wraps
  result_breakdowns,  // Result: breakdowns
  result_flags,  // Result: flags
  result_cycles_low,  // Result: cycles, low half
  result_cycles_high,  // Result: cycles, high half
  dma_list_low,  // DMA: list, low half
  dma_list_high,  // DMA: list, high half
  dma_count,  // DMA: descriptors
  dma_record_low,  // DMA: completion record, low half
  dma_record_high,  // DMA: completion record, high half
  dma_values_low,  // DMA: list of values, low half
  dma_values_high,  // DMA: list of values, high half
  dma_values_count,  // DMA: descriptors of values
};

enum class Aperture : std::uint8_t {
  row,  // Staged block row
  b,  // Right-hand side
  u,  // Solution
  row_begin,  // Row begin
  column,  // Column
  value,  // Value
};

// A bit is reserved where both read_mask and write_mask are zero. A command (pulse) bit
// is not stored. While STATUS.busy, a register is locked whole where busy_mask has bits
// that are not commands; otherwise only the commands in busy_mask are.
struct RegisterInfo {
  std::string_view name;
  std::uint32_t offset;
  std::uint32_t reset;
  std::uint32_t read_mask;
  std::uint32_t write_mask;
  std::uint32_t write_one_to_clear_mask;
  std::uint32_t pulse_mask;
  std::uint32_t busy_mask;
};

struct ApertureInfo {
  std::string_view name;
  std::uint32_t offset;
  std::uint32_t size;  // bytes at full depth
  bool readable;
  bool writable;
  bool locked_while_busy;
};

// Some bits of a register, the lowest at `low`.
struct Field {
  Register reg;
  unsigned low;
  unsigned width;

  constexpr std::uint32_t mask() const {
    return (~std::uint32_t{0} >> (32 - width)) << low;
  }
};

inline constexpr std::uint32_t kBarBytes = 0x02000000;
// Registers lie below this offset, memories above.
inline constexpr std::uint32_t kRegisterBytes = 0x000000f0;

// In the order of Register; offsets ascend.
inline constexpr std::array<RegisterInfo, 51> kRegisters = {{
    {"ID", 0x00000000, 0x48565031, 0xffffffff, 0x00000000, 0x00000000, 0x00000000, 0x00000000},
    {"VERSION", 0x00000004, 0x00020004, 0xffffffff, 0x00000000, 0x00000000, 0x00000000, 0x00000000},
    {"CAPABILITY_NODES", 0x00000008, 0x01002000, 0xffffffff, 0x00000000, 0x00000000, 0x00000000, 0x00000000},
    {"CAPABILITY_BLOCKS", 0x0000000c, 0x00050000, 0xffffffff, 0x00000000, 0x00000000, 0x00000000, 0x00000000},
    {"CAPABILITY_FORMAT", 0x00000010, 0x18202018, 0xffffffff, 0x00000000, 0x00000000, 0x00000000, 0x00000000},
    {"CAPABILITY_CLOCK", 0x00000014, 0x000186a0, 0xffffffff, 0x00000000, 0x00000000, 0x00000000, 0x00000000},
    {"CAPABILITY_SOLVER", 0x00000018, 0x8000071f, 0xff000fff, 0x00000000, 0x00000000, 0x00000000, 0x00000000},
    {"CAPABILITY_DMA", 0x0000001c, 0x00000000, 0x0000ffff, 0x00000000, 0x00000000, 0x00000000, 0x00000000},
    {"CONTROL", 0x00000020, 0x00000000, 0x00000000, 0x8000003f, 0x00000000, 0x8000003f, 0x0000003f},
    {"STATUS", 0x00000024, 0x00000000, 0xffffff1f, 0x00000000, 0x00000000, 0x00000000, 0x00000000},
    {"INTERRUPT_STATUS", 0x00000028, 0x00000000, 0x00000003, 0x00000003, 0x00000003, 0x00000000, 0x00000000},
    {"INTERRUPT_ENABLE", 0x0000002c, 0x00000000, 0x00000003, 0x00000003, 0x00000000, 0x00000000, 0x00000000},
    {"ERROR", 0x00000030, 0x00000000, 0x00001fff, 0x00000000, 0x00000000, 0x00000000, 0x00000000},
    {"ERROR_DETAIL", 0x00000034, 0x00000000, 0xffffffff, 0x00000000, 0x00000000, 0x00000000, 0x00000000},
    {"JOB", 0x00000038, 0x00000000, 0xffffffff, 0x00000000, 0x00000000, 0x00000000, 0x00000000},
    {"METHOD", 0x00000040, 0x00000000, 0x00000007, 0x00000007, 0x00000000, 0x00000000, 0x00000007},
    {"ITERATIONS", 0x00000044, 0x0000003c, 0x0000ffff, 0x0000ffff, 0x00000000, 0x00000000, 0x0000ffff},
    {"STOP_RESIDUAL_LOW", 0x00000048, 0x00000000, 0xffffffff, 0xffffffff, 0x00000000, 0x00000000, 0xffffffff},
    {"STOP_RESIDUAL_HIGH", 0x0000004c, 0x00000000, 0xffffffff, 0xffffffff, 0x00000000, 0x00000000, 0xffffffff},
    {"REPLACE_EVERY", 0x00000050, 0x00000000, 0x0000ffff, 0x0000ffff, 0x00000000, 0x00000000, 0x0000ffff},
    {"STATIC_SHIFT", 0x00000054, 0x0000000b, 0x0000003f, 0x0000003f, 0x00000000, 0x00000000, 0x0000003f},
    {"SCALING", 0x00000058, 0x01010103, 0x1f1f0f03, 0x1f1f0f03, 0x00000000, 0x00000000, 0x1f1f0f03},
    {"FORMAT", 0x0000005c, 0x1010100c, 0xffffffff, 0xffffffff, 0x00000000, 0x00000000, 0xffffffff},
    {"COEFFICIENTS", 0x00000060, 0x000d1800, 0x003f3f01, 0x003f3f01, 0x00000000, 0x00000000, 0x003f3f01},
    {"ARITHMETIC", 0x00000064, 0x40000000, 0xff000133, 0xff000133, 0x00000000, 0x00000000, 0xff000133},
    {"START_MODE", 0x00000068, 0x00000001, 0x00000003, 0x00000003, 0x00000000, 0x00000000, 0x00000003},
    {"NODES", 0x0000006c, 0x00000000, 0x0000ffff, 0x0000ffff, 0x00000000, 0x00000000, 0x0000ffff},
    {"BLOCKS", 0x00000070, 0x00000000, 0xffffffff, 0xffffffff, 0x00000000, 0x00000000, 0xffffffff},
    {"PACKING", 0x00000074, 0x00000000, 0x00000001, 0x00000001, 0x00000000, 0x00000000, 0x00000001},
    {"UPDATE_NODE", 0x00000080, 0x00000000, 0x0000ffff, 0x0000ffff, 0x00000000, 0x00000000, 0x0000ffff},
    {"UPDATE_KIND", 0x00000084, 0x00000000, 0x00000001, 0x00000001, 0x00000000, 0x00000000, 0x00000001},
    {"UPDATE_DIAGONAL", 0x00000088, 0x00000001, 0xffffffff, 0xffffffff, 0x00000000, 0x00000000, 0xffffffff},
    {"UPDATE_BLOCKS", 0x0000008c, 0x00000000, 0x0000ffff, 0x0000ffff, 0x00000000, 0x00000000, 0x0000ffff},
    {"RESULT_JOB", 0x000000a0, 0x00000000, 0xffffffff, 0x00000000, 0x00000000, 0x00000000, 0x00000000},
    {"RESULT_ITERATIONS", 0x000000a4, 0x00000000, 0xffffffff, 0x00000000, 0x00000000, 0x00000000, 0x00000000},
    {"RESULT_END", 0x000000a8, 0x00000000, 0x00000001, 0x00000000, 0x00000000, 0x00000000, 0x00000000},
    {"RESULT_REPLACEMENTS", 0x000000ac, 0x00000000, 0xffffffff, 0x00000000, 0x00000000, 0x00000000, 0x00000000},
    {"RESULT_SATURATIONS", 0x000000b0, 0x00000000, 0xffffffff, 0x00000000, 0x00000000, 0x00000000, 0x00000000},
    {"RESULT_WRAPS", 0x000000b4, 0x00000000, 0xffffffff, 0x00000000, 0x00000000, 0x00000000, 0x00000000},
    {"RESULT_BREAKDOWNS", 0x000000b8, 0x00000000, 0xffffffff, 0x00000000, 0x00000000, 0x00000000, 0x00000000},
    {"RESULT_FLAGS", 0x000000bc, 0x00000000, 0xffffffff, 0x00000000, 0x00000000, 0x00000000, 0x00000000},
    {"RESULT_CYCLES_LOW", 0x000000c0, 0x00000000, 0xffffffff, 0x00000000, 0x00000000, 0x00000000, 0x00000000},
    {"RESULT_CYCLES_HIGH", 0x000000c4, 0x00000000, 0xffffffff, 0x00000000, 0x00000000, 0x00000000, 0x00000000},
    {"DMA_LIST_LOW", 0x000000d0, 0x00000000, 0xffffffff, 0xffffffff, 0x00000000, 0x00000000, 0xffffffff},
    {"DMA_LIST_HIGH", 0x000000d4, 0x00000000, 0xffffffff, 0xffffffff, 0x00000000, 0x00000000, 0xffffffff},
    {"DMA_COUNT", 0x000000d8, 0x00000000, 0xffffffff, 0xffffffff, 0x00000000, 0x00000000, 0xffffffff},
    {"DMA_RECORD_LOW", 0x000000dc, 0x00000000, 0xffffffff, 0xffffffff, 0x00000000, 0x00000000, 0xffffffff},
    {"DMA_RECORD_HIGH", 0x000000e0, 0x00000000, 0xffffffff, 0xffffffff, 0x00000000, 0x00000000, 0xffffffff},
    {"DMA_VALUES_LOW", 0x000000e4, 0x00000000, 0xffffffff, 0xffffffff, 0x00000000, 0x00000000, 0xffffffff},
    {"DMA_VALUES_HIGH", 0x000000e8, 0x00000000, 0xffffffff, 0xffffffff, 0x00000000, 0x00000000, 0xffffffff},
    {"DMA_VALUES_COUNT", 0x000000ec, 0x00000000, 0x0000ffff, 0x0000ffff, 0x00000000, 0x00000000, 0x0000ffff},
}};

// In the order of Aperture; offsets ascend.
inline constexpr std::array<ApertureInfo, 6> kApertures = {{
    {"ROW", 0x00001000, 0x00002400, true, true, true},
    {"B", 0x00020000, 0x00018000, true, true, true},
    {"U", 0x00040000, 0x00018000, true, true, true},
    {"ROW_BEGIN", 0x00060000, 0x00008004, true, true, true},
    {"COLUMN", 0x00200000, 0x00140000, true, true, true},
    {"VALUE", 0x01000000, 0x00b40000, true, true, true},
}};

enum class ErrorCode : std::uint32_t {
  none = 0,  // No error is pending.
  bad_size = 1,  // load_done: NODES or BLOCKS is zero or beyond the board's capability. Detail: the value.
  bad_matrix = 2,  // load_done: ROW_BEGIN does not run from 0 to BLOCKS without decreasing, a row has more blocks than CAPABILITY_NODES.max_row_blocks, columns do not ascend or are not below NODES, a diagonal block is missing, a block has no partner at its transpose's place, or an entry is beyond ±(2^(FORMAT.matrix_bits - 1) - 1); update_values and fetch_values: the last alone. Detail: the block row.
  bad_setting = 3,  // start, run_list, load_done, update_values, fetch_values or update_node: a setting is out of the board's range; run_list and fetch_values on a board without an engine blame CAPABILITY_DMA. Detail: the register's offset; ERROR.place: the field's lowest bit.
  not_loaded = 4,  // start, run_list or update_node without a loaded matrix, update_values or fetch_values without a loaded pattern.
  bad_node = 5,  // update_node: UPDATE_NODE is not below NODES. Detail: the node.
  bad_row = 6,  // update_node: UPDATE_BLOCKS differs from the number of blocks in the row. Detail: the row's own number.
  illegal_access = 7,  // An access that the map does not allow was refused. Detail: its offset.
  internal_fault = 8,  // The solver stopped on a fault of its own.
  bad_descriptor = 9,  // run_list: a descriptor is not what DMA_LIST_LOW describes; fetch_values: not what DMA_VALUES_LOW does. Detail: its place in the list, from 0.
  dma_failed = 10,  // run_list or fetch_values: the host's memory did not answer the engine, or a word of VALUE arrived damaged. On PCI Express its writes are posted, and it hears of its reads alone. Detail: the descriptor's place in the list; 0xfffffffe: the list itself; 0xffffffff: the completion record, which is not written then.
};

enum class SolverMethod : std::uint32_t {
  cg = 0,  // Conjugate gradients (thesis §4.2).
  jacobi_pcg = 1,  // Conjugate gradients with Jacobi's preconditioner (thesis §4.3).
  block_jacobi_pcg = 2,  // The same with the inverse 3 × 3 blocks of the diagonal.
  chronopoulos_gear = 3,  // Conjugate gradients with A·d by a recurrence (Chronopoulos and Gear 1989).
  pipelined_cg = 4,  // Conjugate gradients with the divisions beside the product (Ghysels and Vanroose 2014).
};

enum class CoefficientFormat : std::uint32_t {
  own_shift = 0,  // A shift of its own in every iteration, which fills the mantissa.
  fixed_point = 1,  // A fixed number of bits behind the point.
};

enum class RoundingMode : std::uint32_t {
  nearest_up = 0,  // To nearest, ties away from zero.
  nearest_even = 1,  // To nearest, ties to the even word.
  truncation = 2,  // Towards zero.
};

enum class OverflowMode : std::uint32_t {
  saturate = 0,  // The limit of the word; counted in RESULT_SATURATIONS.
  wrap = 1,  // The low bits of the value; counted in RESULT_WRAPS.
};

enum class StartMode : std::uint32_t {
  zero = 0,  // Start from U = 0.
  warm = 1,  // Start from what the U memory holds: the last solution, or what the host wrote.
  extrapolated = 2,  // Start from 2·U - (the U of the job before), saturating. From U alone where the job before had another mode, where the host has written to U since, and after load_done, update_values and fetch_values.
};

enum class PackingMode : std::uint32_t {
  two_a_word = 0,  // Elements of at most 16 bits two in a word.
  one_a_word = 1,  // Every element in a word of its own.
};

enum class UpdateKind : std::uint32_t {
  constrain = 0,  // Zero the node's block row and column and set the three diagonal entries to UPDATE_DIAGONAL (thesis §3.7, Fig. 3.5).
  row = 1,  // Write the block row from the ROW memory and the block column as its transpose. Gives a released node its row back.
};

namespace field {

inline constexpr Field kIdMagic{Register::id, 0, 32};
inline constexpr Field kVersionMinor{Register::version, 0, 16};
inline constexpr Field kVersionMajor{Register::version, 16, 16};
inline constexpr Field kCapabilityNodesMaxNodes{Register::capability_nodes, 0, 16};
inline constexpr Field kCapabilityNodesMaxRowBlocks{Register::capability_nodes, 16, 16};
inline constexpr Field kCapabilityBlocksMaxBlocks{Register::capability_blocks, 0, 32};
inline constexpr Field kCapabilityFormatMaxMatrixBits{Register::capability_format, 0, 8};
inline constexpr Field kCapabilityFormatMaxVectorBits{Register::capability_format, 8, 8};
inline constexpr Field kCapabilityFormatMaxRhsBits{Register::capability_format, 16, 8};
inline constexpr Field kCapabilityFormatMaxCoefficientBits{Register::capability_format, 24, 8};
inline constexpr Field kCapabilityClockKilohertz{Register::capability_clock, 0, 32};
inline constexpr Field kCapabilitySolverMethods{Register::capability_solver, 0, 8};
inline constexpr Field kCapabilitySolverStartModes{Register::capability_solver, 8, 4};
inline constexpr Field kCapabilitySolverMaxScalarBits{Register::capability_solver, 24, 8};
inline constexpr Field kCapabilityDmaMaxDescriptors{Register::capability_dma, 0, 16};
inline constexpr Field kControlStart{Register::control, 0, 1};
inline constexpr Field kControlUpdateNode{Register::control, 1, 1};
inline constexpr Field kControlLoadDone{Register::control, 2, 1};
inline constexpr Field kControlRunList{Register::control, 3, 1};
inline constexpr Field kControlUpdateValues{Register::control, 4, 1};
inline constexpr Field kControlFetchValues{Register::control, 5, 1};
inline constexpr Field kControlReset{Register::control, 31, 1};
inline constexpr Field kStatusBusy{Register::status, 0, 1};
inline constexpr Field kStatusDone{Register::status, 1, 1};
inline constexpr Field kStatusError{Register::status, 2, 1};
inline constexpr Field kStatusMatrixLoaded{Register::status, 3, 1};
inline constexpr Field kStatusPatternLoaded{Register::status, 4, 1};
inline constexpr Field kStatusErrorCode{Register::status, 8, 8};
inline constexpr Field kStatusFlags{Register::status, 16, 16};
inline constexpr Field kInterruptStatusDone{Register::interrupt_status, 0, 1};
inline constexpr Field kInterruptStatusError{Register::interrupt_status, 1, 1};
inline constexpr Field kInterruptEnableDone{Register::interrupt_enable, 0, 1};
inline constexpr Field kInterruptEnableError{Register::interrupt_enable, 1, 1};
inline constexpr Field kErrorCode{Register::error, 0, 8};
inline constexpr Field kErrorPlace{Register::error, 8, 5};
inline constexpr Field kErrorDetailDetail{Register::error_detail, 0, 32};
inline constexpr Field kJobJob{Register::job, 0, 32};
inline constexpr Field kMethodMethod{Register::method, 0, 3};
inline constexpr Field kIterationsCount{Register::iterations, 0, 16};
inline constexpr Field kStopResidualLowLow{Register::stop_residual_low, 0, 32};
inline constexpr Field kStopResidualHighHigh{Register::stop_residual_high, 0, 32};
inline constexpr Field kReplaceEveryCount{Register::replace_every, 0, 16};
inline constexpr Field kStaticShiftShift{Register::static_shift, 0, 6};
inline constexpr Field kScalingDynamic{Register::scaling, 0, 1};
inline constexpr Field kScalingDown{Register::scaling, 1, 1};
inline constexpr Field kScalingHeadroomBits{Register::scaling, 8, 4};
inline constexpr Field kScalingThreshold{Register::scaling, 16, 5};
inline constexpr Field kScalingStep{Register::scaling, 24, 5};
inline constexpr Field kFormatMatrixBits{Register::format, 0, 8};
inline constexpr Field kFormatVectorBits{Register::format, 8, 8};
inline constexpr Field kFormatRhsBits{Register::format, 16, 8};
inline constexpr Field kFormatCoefficientBits{Register::format, 24, 8};
inline constexpr Field kCoefficientsFormat{Register::coefficients, 0, 1};
inline constexpr Field kCoefficientsAlphaFraction{Register::coefficients, 8, 6};
inline constexpr Field kCoefficientsBetaFraction{Register::coefficients, 16, 6};
inline constexpr Field kArithmeticDivisionRounding{Register::arithmetic, 0, 2};
inline constexpr Field kArithmeticShiftRounding{Register::arithmetic, 4, 2};
inline constexpr Field kArithmeticOverflow{Register::arithmetic, 8, 1};
inline constexpr Field kArithmeticScalarBits{Register::arithmetic, 24, 8};
inline constexpr Field kStartModeMode{Register::start_mode, 0, 2};
inline constexpr Field kNodesCount{Register::nodes, 0, 16};
inline constexpr Field kBlocksCount{Register::blocks, 0, 32};
inline constexpr Field kPackingMode{Register::packing, 0, 1};
inline constexpr Field kUpdateNodeNode{Register::update_node, 0, 16};
inline constexpr Field kUpdateKindKind{Register::update_kind, 0, 1};
inline constexpr Field kUpdateDiagonalValue{Register::update_diagonal, 0, 32};
inline constexpr Field kUpdateBlocksCount{Register::update_blocks, 0, 16};
inline constexpr Field kResultJobJob{Register::result_job, 0, 32};
inline constexpr Field kResultIterationsCount{Register::result_iterations, 0, 32};
inline constexpr Field kResultEndReached{Register::result_end, 0, 1};
inline constexpr Field kResultReplacementsCount{Register::result_replacements, 0, 32};
inline constexpr Field kResultSaturationsCount{Register::result_saturations, 0, 32};
inline constexpr Field kResultWrapsCount{Register::result_wraps, 0, 32};
inline constexpr Field kResultBreakdownsCount{Register::result_breakdowns, 0, 32};
inline constexpr Field kResultFlagsBits{Register::result_flags, 0, 32};
inline constexpr Field kResultCyclesLowLow{Register::result_cycles_low, 0, 32};
inline constexpr Field kResultCyclesHighHigh{Register::result_cycles_high, 0, 32};
inline constexpr Field kDmaListLowLow{Register::dma_list_low, 0, 32};
inline constexpr Field kDmaListHighHigh{Register::dma_list_high, 0, 32};
inline constexpr Field kDmaCountToBoard{Register::dma_count, 0, 16};
inline constexpr Field kDmaCountToHost{Register::dma_count, 16, 16};
inline constexpr Field kDmaRecordLowLow{Register::dma_record_low, 0, 32};
inline constexpr Field kDmaRecordHighHigh{Register::dma_record_high, 0, 32};
inline constexpr Field kDmaValuesLowLow{Register::dma_values_low, 0, 32};
inline constexpr Field kDmaValuesHighHigh{Register::dma_values_high, 0, 32};
inline constexpr Field kDmaValuesCountCount{Register::dma_values_count, 0, 16};

}  // namespace field

}  // namespace hvp::vp
// clang-format on
