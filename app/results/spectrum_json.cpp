#include "app/results/spectrum_json.h"

#include <nlohmann/json.hpp>

namespace hvp::results {

namespace {
nlohmann::ordered_json bounds(const sparse::Interval& interval) {
  return nlohmann::ordered_json::array({interval.lower, interval.upper});
}
}  // namespace

nlohmann::ordered_json spectrum_json(const sparse::Spectrum& spectrum) {
  nlohmann::ordered_json j;
  j["smallest"] = bounds(spectrum.smallest);
  j["largest"] = bounds(spectrum.largest);
  const auto condition = spectrum.condition();
  j["condition"] = condition ? bounds(*condition) : nlohmann::ordered_json(nullptr);
  return j;
}

}  // namespace hvp::results
