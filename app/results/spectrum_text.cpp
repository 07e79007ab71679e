#include "app/results/spectrum_text.h"

#include <fmt/format.h>

namespace hvp::results {

namespace {

std::string line(const char* what, const sparse::Spectrum& s) {
  const auto condition = s.condition();
  const std::string kappa =
      condition ? fmt::format("condition {:.4g} to {:.4g}", condition->lower, condition->upper)
                : std::string("not positive definite");
  return fmt::format("  {:<14} {}; eigenvalues from {:.4g} .. {:.4g} to {:.4g} .. {:.4g}\n", what,
                     kappa, s.smallest.lower, s.smallest.upper, s.largest.lower, s.largest.upper);
}

}  // namespace

std::string spectrum_text(const fixed::SystemSpectrum& spectrum) {
  std::string text = line("true matrix", spectrum.given);
  if (spectrum.scaled) text += line("scaled", *spectrum.scaled);
  return text + line("rounded", spectrum.rounded);
}

}  // namespace hvp::results
