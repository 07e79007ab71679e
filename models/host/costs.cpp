#include "models/host/costs.h"

#include <cmath>

namespace hvp::host {

using config::Dimension;

void Graphics::declare(config::Visitor& v) {
  v.quantity("rate", rate_hz, Dimension::frequency, config::between(1, 1000),
             {"rate of the collision and graphics process", "thesis section 6.2.3"});
  v.quantity("drawing_time", drawing_s, Dimension::time, config::between(0, 1),
             {"time of a pass that is not collision detection: one picture",
              "assumed: a third of the period"});
}

std::int64_t Graphics::period_ps() const { return std::llround(1e12 / rate_hz); }

void Host::declare(config::Visitor& v) {
  v.quantity("sustained_rate", sustained_rate_flops, Dimension::throughput,
             config::between(1e6, 1e12),
             {"operations a second in sparse products",
              "thesis Table 6.3: Netburst at 2.8 GHz, the host's family"});
  v.quantity(
      "contact_lookup", contact_lookup_s, Dimension::time, config::between(0, 1e-3),
      {"fetching the contact node from the collision process", "assumed: a lock and a copy"});
  v.quantity("driver_call", driver_call_s, Dimension::time, config::between(0, 1e-3),
             {"instructions of a driver call beside its bus accesses", "assumed"});
  v.quantity("interrupt_latency", interrupt_latency_s, Dimension::time, config::between(0, 1e-2),
             {"from the board's interrupt until the servo process runs again",
              "assumed; real-time extensions lie between 2 and 20 us"});
  v.quantity("timeout", timeout_s, Dimension::time, config::between(1e-6, 10),
             {"how long the driver waits for the board", "five periods at 500 Hz"});
  v.effect("jitter", jitter,
           {"the timer releases the servo process late, by a time drawn for each tick"});
  v.effect("wake_up", wake_up,
           {"the servo process runs some time after its tick or interrupt has made it ready, drawn "
            "each time"});
  v.table("graphics", graphics, {"the 33 Hz collision and graphics process"});
}

std::int64_t Host::compute_ps(double operations) const {
  return std::llround(operations / sustained_rate_flops * 1e12);
}

double conversion_operations(int words) { return 4.0 * words; }

}  // namespace hvp::host
