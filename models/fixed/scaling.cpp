#include "models/fixed/scaling.h"

#include <cmath>
#include <cstddef>
#include <string>

#include "models/config/input_error.h"
#include "models/fixed/word.h"

namespace hvp::fixed {

namespace {

void require_same_size(std::size_t from, std::size_t to) {
  if (from == to) return;
  throw InputError("a vector of " + std::to_string(from) + " entries was to fill one of " +
                   std::to_string(to));
}

int to_words(std::span<const double> values, double unit, std::int64_t limit, const char* what,
             std::span<std::int32_t> words) {
  require_same_size(values.size(), words.size());
  int clamped = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i])) {
      throw InputError(std::string(what) + " " + std::to_string(i) + " is not a finite number");
    }
    // Clamped before the conversion: a double beyond 64 bits has no integer.
    double scaled = std::round(values[i] / unit);
    const auto bound = static_cast<double>(limit);
    if (std::abs(scaled) > bound) {
      scaled = std::copysign(bound, scaled);
      ++clamped;
    }
    words[i] = static_cast<std::int32_t>(scaled);
  }
  return clamped;
}

void require_unit(double unit, const char* what) {
  if (std::isnormal(unit) && unit > 0) return;
  throw InputError(std::string("the unit of ") + what + " comes out as " + std::to_string(unit) +
                   "; a finite number above zero was expected");
}

}  // namespace

Scaling::Scaling(const Settings& settings, double matrix_scale)
    : displacement_unit_(settings.displacement_range /
                         static_cast<double>(word_limit(settings.vector_bits))),
      force_unit_(std::ldexp(matrix_scale * displacement_unit_, settings.rhs_shift())),
      displacement_limit_(word_limit(settings.vector_bits)),
      force_limit_(word_limit(settings.residual_bits())) {
  require_unit(displacement_unit_, "displacement");
  require_unit(force_unit_, "the right-hand side");
}

int Scaling::right_hand_side(std::span<const double> force, std::span<std::int32_t> words) const {
  return to_words(force, force_unit_, force_limit_, "right-hand side entry", words);
}

int Scaling::displacement_words(std::span<const double> displacement,
                                std::span<std::int32_t> words) const {
  return to_words(displacement, displacement_unit_, displacement_limit_, "displacement", words);
}

void Scaling::displacements(std::span<const std::int32_t> words,
                            std::span<double> displacement) const {
  require_same_size(words.size(), displacement.size());
  for (std::size_t i = 0; i < words.size(); ++i) {
    displacement[i] = displacement_unit_ * static_cast<double>(words[i]);
  }
}

}  // namespace hvp::fixed
