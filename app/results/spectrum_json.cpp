#include "app/results/spectrum_json.h"

#include <nlohmann/json.hpp>

namespace hvp::results {

namespace {
nlohmann::ordered_json bounds(const sparse::Interval& interval) {
  return nlohmann::ordered_json::array({interval.lower, interval.upper});
}

nlohmann::ordered_json ends(const sparse::Spectrum& spectrum) {
  nlohmann::ordered_json j;
  j["smallest"] = bounds(spectrum.smallest);
  j["largest"] = bounds(spectrum.largest);
  const auto condition = spectrum.condition();
  j["condition"] = condition ? bounds(*condition) : nlohmann::ordered_json(nullptr);
  return j;
}

}  // namespace

nlohmann::ordered_json condition_json(const std::optional<fixed::SystemSpectrum>& spectrum) {
  if (!spectrum) return nullptr;
  nlohmann::ordered_json j;
  j["given"] = ends(spectrum->given);
  j["scaled"] = spectrum->scaled ? ends(*spectrum->scaled) : nlohmann::ordered_json(nullptr);
  j["rounded"] = ends(spectrum->rounded);
  return j;
}

}  // namespace hvp::results
