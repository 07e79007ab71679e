#include "vp/fpga/board_registers.h"

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "models/config/input_error.h"
#include "models/fixed/stop_test.h"
#include "vp/fpga/register_bank.h"

namespace hvp::vp {

namespace {

// The longest words that the board says it has are the solver's (models/fixed/settings.cpp).
constexpr std::uint32_t kMatrixBits = 24;
constexpr std::uint32_t kVectorBits = 32;
constexpr std::uint32_t kCoefficientBits = 24;
static_assert(kRegisters[static_cast<std::size_t>(Register::capability_format)].reset ==
              (kMatrixBits << field::kCapabilityFormatMaxMatrixBits.low |
               kVectorBits << field::kCapabilityFormatMaxVectorBits.low |
               kVectorBits << field::kCapabilityFormatMaxRhsBits.low |
               kCoefficientBits << field::kCapabilityFormatMaxCoefficientBits.low));

// The field whose value the board does not take; none: it takes them all.
using Wrong = std::optional<Field>;

constexpr bool between(std::uint32_t value, std::uint32_t least, std::uint32_t most) {
  return value >= least && value <= most;
}

// The value that a code stands for, or the field that has no such code.
template <class Value, std::size_t count>
Wrong decode(const RegisterBank& bank, Field field, const std::array<Value, count>& values,
             Value& value) {
  const std::uint32_t code = bank.get(field);
  if (code >= count) return field;
  value = values.at(code);
  return std::nullopt;
}

// In the order of the codes (SolverMethod, StartMode and RoundingMode).
constexpr std::array kMethods = {fixed::Method::cg, fixed::Method::jacobi_pcg,
                                 fixed::Method::block_jacobi_pcg, fixed::Method::chronopoulos_gear,
                                 fixed::Method::pipelined_cg};
static_assert(static_cast<std::size_t>(SolverMethod::pipelined_cg) == kMethods.size() - 1);
constexpr std::array kStarts = {fixed::Start::zero, fixed::Start::warm, fixed::Start::extrapolated};
static_assert(static_cast<std::size_t>(StartMode::extrapolated) == kStarts.size() - 1);
constexpr std::array kRoundings = {fixed::Rounding::nearest_up, fixed::Rounding::nearest_even,
                                   fixed::Rounding::truncation};
static_assert(static_cast<std::size_t>(RoundingMode::truncation) == kRoundings.size() - 1);

Wrong read_iteration(const RegisterBank& bank, fixed::Settings& s) {
  s.iterations = static_cast<int>(bank.get(field::kIterationsCount));
  if (s.iterations < 1) return field::kIterationsCount;
  const std::uint64_t high = bank.get(field::kStopResidualHighHigh);
  const std::uint64_t bits = high << 32 | bank.get(field::kStopResidualLowLow);
  // Doubles from 0 to 1 are in the order of their bits; all others lie above.
  if (bits > std::bit_cast<std::uint64_t>(1.0) ||
      (bits != 0 && bits < std::bit_cast<std::uint64_t>(fixed::StopTest::kLeast))) {
    return field::kStopResidualHighHigh;
  }
  s.stop_residual = std::bit_cast<double>(bits);
  s.replace_residual_every = static_cast<int>(bank.get(field::kReplaceEveryCount));
  return std::nullopt;
}

Wrong read_scaling(const RegisterBank& bank, fixed::Settings& s) {
  s.static_shift = static_cast<int>(bank.get(field::kStaticShiftShift));
  if (s.static_shift > 31) return field::kStaticShiftShift;
  const std::uint32_t headroom = bank.get(field::kScalingHeadroomBits);
  const std::uint32_t threshold = bank.get(field::kScalingThreshold);
  const std::uint32_t step = bank.get(field::kScalingStep);
  s.dynamic_scaling = bank.get(field::kScalingDynamic) != 0;
  s.scaling_down = bank.get(field::kScalingDown) != 0;
  s.headroom_bits = static_cast<int>(headroom);
  s.scaling_threshold = static_cast<int>(threshold);
  s.scaling_step = static_cast<int>(step);
  if (headroom > 8) return field::kScalingHeadroomBits;
  if (!between(threshold, 1, 16)) return field::kScalingThreshold;
  if (!between(step, 1, 16)) return field::kScalingStep;
  return std::nullopt;
}

Wrong read_format(const RegisterBank& bank, fixed::Settings& s) {
  const std::uint32_t matrix = bank.get(field::kFormatMatrixBits);
  const std::uint32_t vector = bank.get(field::kFormatVectorBits);
  const std::uint32_t coefficient = bank.get(field::kFormatCoefficientBits);
  s.matrix_bits = static_cast<int>(matrix);
  s.vector_bits = static_cast<int>(vector);
  s.coefficient_bits = static_cast<int>(coefficient);
  if (!between(matrix, 8, kMatrixBits)) return field::kFormatMatrixBits;
  if (!between(vector, 12, kVectorBits)) return field::kFormatVectorBits;
  if (!between(coefficient, 8, kCoefficientBits)) return field::kFormatCoefficientBits;
  const bool fits =
      bank.get(field::kFormatRhsBits) == static_cast<std::uint32_t>(s.residual_bits());
  return fits ? Wrong() : Wrong(field::kFormatRhsBits);
}

Wrong read_coefficients(const RegisterBank& bank, fixed::Settings& s) {
  const std::uint32_t alpha = bank.get(field::kCoefficientsAlphaFraction);
  const std::uint32_t beta = bank.get(field::kCoefficientsBetaFraction);
  const bool fixed_point = bank.get(field::kCoefficientsFormat) ==
                           static_cast<std::uint32_t>(CoefficientFormat::fixed_point);
  s.coefficient_format =
      fixed_point ? fixed::CoefficientFormat::fixed : fixed::CoefficientFormat::own_shift;
  s.alpha_fraction_bits = static_cast<int>(alpha);
  s.beta_fraction_bits = static_cast<int>(beta);
  if (alpha > 40) return field::kCoefficientsAlphaFraction;
  if (beta > 40) return field::kCoefficientsBetaFraction;
  return std::nullopt;
}

Wrong read_arithmetic(const RegisterBank& bank, fixed::Settings& s) {
  const bool wrap =
      bank.get(field::kArithmeticOverflow) == static_cast<std::uint32_t>(OverflowMode::wrap);
  s.overflow = wrap ? fixed::Overflow::wrap : fixed::Overflow::saturate;
  s.scalar_bits = static_cast<int>(bank.get(field::kArithmeticScalarBits));
  Wrong wrong = decode(bank, field::kArithmeticDivisionRounding, kRoundings, s.division_rounding);
  if (!wrong) {
    wrong = decode(bank, field::kArithmeticShiftRounding, kRoundings, s.shift_rounding);
  }
  if (wrong) return wrong;
  if (s.scalar_bits != 64 && s.scalar_bits != 128) return field::kArithmeticScalarBits;
  return std::nullopt;
}

Wrong read_each(const RegisterBank& bank, fixed::Settings& s) {
  if (Wrong wrong = decode(bank, field::kMethodMethod, kMethods, s.method)) return wrong;
  for (const auto read :
       {read_iteration, read_scaling, read_format, read_coefficients, read_arithmetic}) {
    if (Wrong wrong = read(bank, s)) return wrong;
  }
  return decode(bank, field::kStartModeMode, kStarts, s.start);
}

// The multipliers have no room for the one negative number without a positive twin.
std::int32_t largest_entry(unsigned bits) {
  return static_cast<std::int32_t>((std::uint32_t{1} << (bits - 1)) - 1);
}

}  // namespace

BoardError bad_setting(Field field) {
  return {ErrorCode::bad_setting, offset_of(field.reg), field.low};
}

BoardError read_settings(const RegisterBank& bank, fixed::Settings& s) {
  s = {};
  if (const Wrong wrong = read_each(bank, s)) return bad_setting(*wrong);
  try {
    s.check();
  } catch (const InputError&) {  // headroom that leaves a vector word too few bits
    return bad_setting(field::kScalingHeadroomBits);
  }
  return {};
}

BoardError read_matrix(const RegisterBank& bank, fixed::QuantisedMatrix& matrix) {
  const std::uint32_t nodes = bank.get(field::kNodesCount);
  const std::uint32_t blocks = bank.get(field::kBlocksCount);
  if (nodes == 0 || nodes > bank.get(field::kCapabilityNodesMaxNodes)) {
    return {ErrorCode::bad_size, nodes};
  }
  if (blocks == 0 || blocks > bank.get(field::kCapabilityBlocksMaxBlocks)) {
    return {ErrorCode::bad_size, blocks};
  }
  const unsigned bits = bank.get(field::kFormatMatrixBits);
  const bool one_a_word = bank.get(field::kPackingMode) != 0;
  const std::span<const std::uint32_t> row_begin = bank.memory(Aperture::row_begin);
  const std::span<const std::uint32_t> column = bank.memory(Aperture::column);
  const std::span<const std::uint32_t> value = bank.memory(Aperture::value);

  matrix = {};
  matrix.bits = static_cast<int>(bits);
  matrix.scale = 1;
  matrix.is_contact.assign(nodes, 0);
  matrix.column.reserve(blocks);
  if (row_begin[0] != 0) return {ErrorCode::bad_matrix, 0};
  for (std::uint32_t row = 0; row < nodes; ++row) {
    const std::uint32_t first = row_begin[row];
    const std::uint32_t last = row_begin[row + 1];
    if (last < first || last > blocks ||
        last - first > bank.get(field::kCapabilityNodesMaxRowBlocks)) {
      return {ErrorCode::bad_matrix, row};
    }
    bool diagonal = false;
    for (std::uint32_t k = first; k < last; ++k) {
      const bool ascends = k == first || column[k] > column[k - 1];
      if (column[k] >= nodes || !ascends) return {ErrorCode::bad_matrix, row};
      diagonal = diagonal || column[k] == row;
      matrix.column.push_back(static_cast<int>(column[k]));
    }
    if (!diagonal) return {ErrorCode::bad_matrix, row};
    matrix.row_begin.push_back(static_cast<int>(last));
  }
  if (row_begin[nodes] != blocks) return {ErrorCode::bad_matrix, nodes - 1};

  const std::int32_t limit = largest_entry(bits);
  matrix.value.reserve(9 * std::size_t{blocks});
  for (std::uint32_t row = 0; row < nodes; ++row) {
    for (std::size_t i = 9 * std::size_t{row_begin[row]}; i < 9 * std::size_t{row_begin[row + 1]};
         ++i) {
      const std::int32_t element = packed_element(value, i, bits, one_a_word);
      if (element > limit || element < -limit) return {ErrorCode::bad_matrix, row};
      matrix.value.push_back(element);
    }
    // The board mirrors a node's row into its column, so that the pattern has to be symmetric.
    for (std::uint32_t k = row_begin[row]; k < row_begin[row + 1]; ++k) {
      if (matrix.find(static_cast<int>(column[k]), static_cast<int>(row)) < 0) {
        return {ErrorCode::bad_matrix, row};
      }
    }
  }
  return {};
}

BoardError read_values(const RegisterBank& bank, fixed::QuantisedMatrix& matrix) {
  const auto bits = static_cast<unsigned>(matrix.bits);
  const bool one_a_word = bank.get(field::kPackingMode) != 0;
  const std::span<const std::uint32_t> value = bank.memory(Aperture::value);
  const std::int32_t limit = largest_entry(bits);
  const auto in_contact = [&matrix](int node) {
    return matrix.is_contact[static_cast<std::size_t>(node)] != 0;
  };
  // Looks at all entries before it takes the first.
  for (const bool take : {false, true}) {
    for (int row = 0; row < matrix.block_rows(); ++row) {
      const auto r = static_cast<std::size_t>(row);
      for (int k = matrix.row_begin[r]; k < matrix.row_begin[r + 1]; ++k) {
        const auto block = static_cast<std::size_t>(k);
        if (in_contact(row) || in_contact(matrix.column[block])) continue;
        for (std::size_t i = 9 * block; i < 9 * block + 9; ++i) {
          const std::int32_t element = packed_element(value, i, bits, one_a_word);
          if (element > limit || element < -limit) {
            return {ErrorCode::bad_matrix, static_cast<std::uint32_t>(row)};
          }
          if (take) matrix.value[i] = element;
        }
      }
    }
  }
  return {};
}

void write_back_node(const fixed::QuantisedMatrix& matrix, int node, RegisterBank& bank) {
  const std::span<std::uint32_t> words = bank.memory(Aperture::value);
  const auto bits = static_cast<unsigned>(matrix.bits);
  const bool one_a_word = bank.get(field::kPackingMode) != 0;
  const auto copy_block = [&](std::size_t block) {
    for (std::size_t i = 9 * block; i < 9 * block + 9; ++i) {
      set_packed_element(words, i, bits, matrix.value[i], one_a_word);
    }
  };
  const auto row = static_cast<std::size_t>(node);
  for (int k = matrix.row_begin[row]; k < matrix.row_begin[row + 1]; ++k) {
    copy_block(static_cast<std::size_t>(k));
    const std::ptrdiff_t mirror = matrix.find(matrix.column[static_cast<std::size_t>(k)], node);
    copy_block(static_cast<std::size_t>(mirror));
  }
}

}  // namespace hvp::vp
