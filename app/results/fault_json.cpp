#include "app/results/fault_json.h"

#include <nlohmann/json.hpp>

namespace hvp::results {

using nlohmann::ordered_json;

ordered_json driver_json(const Outcome& o) {
  const vp::ServoCounts& c = o.troubles;
  ordered_json errors = ordered_json::object();
  for (std::size_t i = 0; i < c.errors.size(); ++i) {
    if (c.errors[i].count == 0) continue;
    errors[hvp_status_name(static_cast<hvp_status>(i))] = {
        {"count", c.errors[i].count}, {"first_frame", c.errors[i].first_frame}};
  }
  ordered_json j;
  j["errors"] = errors;
  j["repeated_accesses"] = c.mended.aborted + c.mended.damaged;
  j["lost_interrupts"] = c.mended.lost_interrupts;
  j["lost_acknowledgements"] = c.mended.lost_acknowledgements;
  j["held_frames"] = c.held_frames;
  j["longest_hold_ticks"] = c.longest_hold;
  j["recoveries"] = c.recoveries;
  j["failed_set_ups"] = c.failed_set_ups;
  j["given_up_frame"] = c.given_up_at < 0 ? ordered_json(nullptr) : ordered_json(c.given_up_at);
  return j;
}

ordered_json faults_json(const Outcome& o) {
  ordered_json list = ordered_json::array();
  for (const vp::FaultRecord& r : o.faults) {
    ordered_json j;
    j["kind"] = vp::name(r.fault.kind);
    j["injected"] = r.injected;
    j["noticed"] = r.noticed;
    j["corrected"] = r.corrected;
    j["unnoticed"] = r.unnoticed();
    j["first_frame"] = r.injected == 0 ? ordered_json(nullptr) : ordered_json(r.first_frame);
    list.push_back(j);
  }
  return list;
}

}  // namespace hvp::results
