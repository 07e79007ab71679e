#include "models/plant/daq.h"

#include <cmath>

namespace hvp::plant {

Counts RegisterFormat::to_counts(double value) const {
  constexpr double kLargest = 2147483647.0;
  const double counts = std::round(value * counts_per_unit);
  if (std::isnan(counts)) return {.value = 0, .saturated = true};
  if (counts > kLargest) return {.value = 2147483647, .saturated = true};
  if (counts < -kLargest) return {.value = -2147483647, .saturated = true};
  return {.value = static_cast<std::int32_t>(counts), .saturated = false};
}

void Daq::declare(config::Visitor& v) {
  v.quantity("sampling_delay", sampling_delay, config::Dimension::time, config::between(0.0, 1e-3),
             {.help = "from the command to sample to a position that can be read",
              .source = "assumption, no figure published for the Quanser Q4; latching 24-bit "
                        "counters takes 0.1 to 1 us, a 14-bit converter 2.4 us a channel "
                        "(AD7865 data sheet, four channels at once up to 10 us)"});
  v.quantity("output_delay", output_delay, config::Dimension::time, config::between(0.0, 1e-3),
             {.help = "from the last force register's write to the settled output",
              .source = "assumption, no figure published for the Quanser Q4; 12-bit converters "
                        "with an output amplifier settle over their full scale in 3 to 20 us"});
}

}  // namespace hvp::plant
