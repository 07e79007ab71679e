#include "models/fixed/system.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "models/config/input_error.h"
#include "models/fixed/word.h"
#include "models/index.h"

namespace hvp::fixed {

namespace {

std::vector<double> diagonal_scale(const sparse::BlockMatrix& matrix) {
  std::vector<double> scale(at(matrix.rows()));
  for (int i = 0; i < matrix.rows(); ++i) {
    const std::ptrdiff_t block = matrix.find(i / 3, i / 3);
    const double entry =
        block < 0 ? 0.0 : matrix.block(static_cast<std::size_t>(block))[at(4 * (i % 3))];
    scale[at(i)] = 1.0 / std::sqrt(entry);
    if (std::isnormal(scale[at(i)])) continue;
    throw InputError("matrix_scaling", "diagonal entry " + std::to_string(i) + " is " +
                                           fmt::to_string(entry) +
                                           "; a number above zero was expected");
  }
  return scale;
}

}  // namespace

sparse::BlockMatrix scaled(const sparse::BlockMatrix& matrix, std::span<const double> scale) {
  sparse::BlockMatrix result = matrix;
  for (int row = 0; row < result.block_rows(); ++row) {
    for (int k = result.row_begin[at(row)]; k < result.row_begin[at(row) + 1]; ++k) {
      const int column = result.column[at(k)];
      for (int e = 0; e < 9; ++e) {
        // The product of the two factors first, for the symmetry.
        result.block(at(k))[e] *= scale[at(3 * row + e / 3)] * scale[at(3 * column + e % 3)];
      }
    }
  }
  return result;
}

int static_shift_for(const QuantisedMatrix& matrix, double growth) {
  std::uint64_t largest = 1;
  for (int row = 0; row < matrix.block_rows(); ++row) {
    const auto words = matrix.row(row);
    for (std::size_t c = 0; c < 3; ++c) {
      std::uint64_t sum = 0;
      for (std::size_t k = 0; k < words.size(); k += 9) {
        for (std::size_t e = 0; e < 3; ++e) sum += magnitude(words[k + 3 * c + e]);
      }
      largest = std::max(largest, sum);
    }
  }
  if (growth > 1) {
    largest = static_cast<std::uint64_t>(std::ceil(growth * static_cast<double>(largest)));
  }
  return std::min(bit_length(largest - 1), 31);
}

System prepare(const sparse::BlockMatrix& matrix, const Settings& settings, double headroom) {
  System system{.settings = settings, .matrix = {}, .scale = {}};
  if (settings.matrix_scaling == MatrixScaling::diagonal) {
    system.scale = diagonal_scale(matrix);
    system.matrix = quantise(scaled(matrix, system.scale), settings.matrix_bits, headroom);
  } else {
    system.scale.assign(at(matrix.rows()), 1.0);
    system.matrix = quantise(matrix, settings.matrix_bits, headroom);
  }
  system.settings.static_shift = settings.static_scale == StaticScale::matrix_norm
                                     ? static_shift_for(system.matrix, headroom)
                                     : settings.shift();
  return system;
}

Fit replace_values(const sparse::BlockMatrix& matrix, System& system) {
  QuantisedMatrix& words = system.matrix;
  const bool is_scaled = system.settings.matrix_scaling != MatrixScaling::none;
  const auto limit = static_cast<double>(word_limit(words.bits));
  Fit fit;
  // Looks at all entries before it takes the first.
  for (const bool take : {false, true}) {
    for (int row = 0; row < words.block_rows(); ++row) {
      for (int k = words.row_begin[at(row)]; k < words.row_begin[at(row) + 1]; ++k) {
        for (int e = 0; e < 9; ++e) {
          double entry = matrix.block(at(k))[e];
          if (is_scaled) {
            entry *= system.scale[at(3 * row + e / 3)] *
                     system.scale[at(3 * words.column[at(k)] + e % 3)];
          }
          // Ties away from zero, as quantise() has them.
          const double word = std::round(entry / words.scale);
          if (take) {
            words.value[9 * at(k) + at(e)] = static_cast<std::int32_t>(word);
            continue;
          }
          if (!(std::abs(word) <= limit)) ++fit.beyond;
          fit.filling = std::max(fit.filling, std::abs(entry / words.scale) / limit);
        }
      }
    }
    if (fit.beyond > 0) break;
  }
  return fit;
}

sparse::BlockMatrix dequantise(const System& system) {
  sparse::BlockMatrix result = dequantise(system.matrix);
  if (system.settings.matrix_scaling == MatrixScaling::none) return result;
  for (int row = 0; row < result.block_rows(); ++row) {
    for (int k = result.row_begin[at(row)]; k < result.row_begin[at(row) + 1]; ++k) {
      const int column = result.column[at(k)];
      for (int e = 0; e < 9; ++e) {
        result.block(at(k))[e] /=
            system.scale[at(3 * row + e / 3)] * system.scale[at(3 * column + e % 3)];
      }
    }
  }
  return result;
}

namespace {

void require_same_size(std::size_t from, std::size_t to) {
  if (from == to) return;
  throw InputError("a vector of " + std::to_string(from) + " entries was to fill one of " +
                   std::to_string(to));
}

// To nearest, ties away from zero, of a magnitude below 2^31: std::round, which would be a call for
// every entry.
std::int32_t rounded(double value) {
  const auto whole = static_cast<std::int64_t>(value);
  const double rest = value - static_cast<double>(whole);  // exact
  return static_cast<std::int32_t>(whole + (rest >= 0.5 ? 1 : 0) - (rest <= -0.5 ? 1 : 0));
}

// The word of entry i is values[i] · factor(i) / unit.
template <class Factor>
int to_words(std::span<const double> values, const Factor& factor, double unit, std::int64_t limit,
             const char* what, std::span<std::int32_t> words) {
  require_same_size(values.size(), words.size());
  const double beyond = static_cast<double>(limit) + 0.5;
  int clamped = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i])) {
      throw InputError(std::string(what) + " " + std::to_string(i) + " is not a finite number");
    }
    // Clamped before the conversion: a double beyond 64 bits has no integer.
    const double scaled = values[i] * factor(i) / unit;
    if (std::abs(scaled) < beyond) {
      words[i] = rounded(scaled);
    } else {
      words[i] = static_cast<std::int32_t>(scaled < 0 ? -limit : limit);
      ++clamped;
    }
  }
  return clamped;
}

double one(std::size_t /*entry*/) { return 1.0; }

// The range that y = S⁻¹·x needs for every |x_i| <= displacement_range.
double scaled_range(const System& system) {
  const auto least = std::min_element(system.scale.begin(), system.scale.end());
  return least == system.scale.end() ? system.settings.displacement_range
                                     : system.settings.displacement_range / *least;
}

bool is_scaled(const System& system) {
  return system.settings.matrix_scaling != MatrixScaling::none;
}

void require_unit(double unit, const char* what) {
  if (std::isnormal(unit) && unit > 0) return;
  throw InputError(std::string("the unit of ") + what + " comes out as " + fmt::to_string(unit) +
                   "; a finite number above zero was expected");
}

}  // namespace

Scaling::Scaling(const Settings& settings, double matrix_scale)
    : Scaling(settings, matrix_scale, settings.displacement_range, {}) {}

Scaling::Scaling(const System& system)
    : Scaling(system.settings, system.matrix.scale,
              is_scaled(system) ? scaled_range(system) : system.settings.displacement_range,
              is_scaled(system) ? system.scale : std::vector<double>()) {}

Scaling::Scaling(const Settings& settings, double matrix_scale, double displacement_range,
                 std::vector<double> scale)
    : scale_(std::move(scale)),
      displacement_unit_(displacement_range /
                         static_cast<double>(word_limit(settings.vector_bits))),
      force_unit_(std::ldexp(matrix_scale * displacement_unit_, settings.rhs_shift())),
      displacement_limit_(word_limit(settings.vector_bits)),
      force_limit_(word_limit(settings.residual_bits())) {
  require_unit(displacement_unit_, "displacement");
  require_unit(force_unit_, "the right-hand side");
}

int Scaling::right_hand_side(std::span<const double> force, std::span<std::int32_t> words) const {
  constexpr const char* kWhat = "right-hand side entry";
  if (scale_.empty()) return to_words(force, one, force_unit_, force_limit_, kWhat, words);
  require_same_size(force.size(), scale_.size());
  const auto factor = [this](std::size_t i) { return scale_[i]; };
  return to_words(force, factor, force_unit_, force_limit_, kWhat, words);
}

int Scaling::displacement_words(std::span<const double> displacement,
                                std::span<std::int32_t> words) const {
  constexpr const char* kWhat = "displacement";
  if (scale_.empty()) {
    return to_words(displacement, one, displacement_unit_, displacement_limit_, kWhat, words);
  }
  require_same_size(displacement.size(), scale_.size());
  const auto factor = [this](std::size_t i) { return 1.0 / scale_[i]; };
  return to_words(displacement, factor, displacement_unit_, displacement_limit_, kWhat, words);
}

void Scaling::displacements(std::span<const std::int32_t> words,
                            std::span<double> displacement) const {
  require_same_size(words.size(), displacement.size());
  if (!scale_.empty()) require_same_size(words.size(), scale_.size());
  for (std::size_t i = 0; i < words.size(); ++i) {
    const double unscaled = displacement_unit_ * static_cast<double>(words[i]);
    displacement[i] = scale_.empty() ? unscaled : scale_[i] * unscaled;
  }
}

}  // namespace hvp::fixed
