#include "app/results/summary.h"

#include "app/results/figures_json.h"

namespace hvp::results {

std::vector<std::string> effects(const app::Scenario& s) {
  std::vector<std::string> names;
  if (s.dynamics) names.emplace_back("dynamics");
  if (s.refinement) names.emplace_back("refinement");
  if (s.host.jitter) names.emplace_back("host.jitter");
  if (s.host.wake_up) names.emplace_back("host.wake_up");
  if (s.host.interrupt_latencies) names.emplace_back("host.interrupt_latencies");
  if (s.device.encoder) names.emplace_back("device.encoder");
  if (s.loads.gravity) names.emplace_back("loads.gravity");
  if (s.bus.protocol) names.emplace_back("bus.protocol");
  if (s.bus.traffic) names.emplace_back("bus.traffic");
  if (s.bus.graphics_traffic) names.emplace_back("bus.graphics_traffic");
  if (s.bus.pcie) names.emplace_back("bus.pcie");
  if (s.bus.read_latencies) names.emplace_back("bus.read_latencies");
  if (s.bus.pcie && s.bus.pcie->root_complex_latencies) {
    names.emplace_back("bus.pcie.root_complex_latencies");
  }
  if (s.bus.posted_writes) names.emplace_back("bus.posted_writes");
  if (s.reference) names.emplace_back("reference");
  if (s.spectrum) names.emplace_back("spectrum");
  if (s.accelerator.several) names.emplace_back("accelerator.several");
  if (s.output.waveform) names.emplace_back("output.waveform");
  if (!s.faults.empty()) names.emplace_back("fault");
  return names;
}

std::string summary_json(const Outcome& outcome) { return figures_json(outcome).dump(2) + "\n"; }

}  // namespace hvp::results
