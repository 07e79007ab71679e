#include "models/accel/device_timing.h"

#include "models/config/input_error.h"

namespace hvp::accel {

void DeviceTiming::declare(config::Visitor& v) {
  const auto delay = [&v](std::string_view name, double& value, std::string_view help) {
    v.quantity(name, value, config::Dimension::time, config::between(0, 1e-6),
               {.help = help, .required = true});
  };
  delay("clock_to_out", clock_to_out_s, "of a logic cell's register");
  delay("set_up", set_up_s, "of a logic cell's register");
  delay("logic", logic_s, "of a look-up table");
  v.integer("logic_inputs", logic_inputs, {3, 8},
            {.help = "inputs of a look-up table", .required = true});
  delay("carry", carry_s, "into a carry chain and out of it, without its bits");
  delay("carry_bit", carry_bit_s, "of a bit of a carry chain");
  delay("multiplier", multiplier_s, "through a multiplier without registers");
  delay("multiplier_register", multiplier_register_s, "clock-to-out of a multiplier's register");
  delay("memory_read", memory_read_s, "clock-to-out of a memory without output register");
  delay("memory_register", memory_register_s, "clock-to-out of a memory's output register");
  delay("memory_set_up", memory_set_up_s, "of a memory's address and data");
  delay("routing", routing_s, "of a net between logic cells");
  delay("block_routing", block_routing_s, "of a net to or from a multiplier or a memory");
  v.quantity(
      "crowding", crowding, config::Dimension::dimensionless, config::between(0, 10),
      {.help = "by which part nets are longer once all multipliers are in use", .required = true});
  v.text("source", source,
         {.help = "where the delays come from, or \"unverified\"", .required = true});
}

void DeviceTiming::check() const {
  // Any path has a register and a net; without them a clock would have no limit.
  if (clock_to_out_s + set_up_s + routing_s > 0) return;
  throw InputError("routing", "expected clock_to_out, set_up or routing above zero");
}

}  // namespace hvp::accel
