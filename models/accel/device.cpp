#include "models/accel/device.h"

#include <algorithm>
#include <set>

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

namespace {

using config::Dimension;

constexpr std::string_view kSourceHelp = "where the figures stand, or \"unverified\"";

// Names go to the terminal and into messages of one line.
void require_name(const std::string& name) {
  if (name.empty()) throw InputError("name", "expected a name, found an empty text");
  const auto control = [](unsigned char c) { return c < 0x20 || c == 0x7f; };
  if (std::ranges::any_of(name, control)) {
    throw InputError("name", "expected a name in one line, found a control character in it");
  }
}

// The name of something that a key of [accelerator] chooses.
void require_choice(const std::string& name) {
  require_name(name);
  if (name == "auto") throw InputError("name", "\"auto\" is the rule: expected another name");
}

// A port's width is the narrowest one, doubled so many times, and divides the block's bits.
void require_width(const MemoryType& m, const char* key, int width) {
  int possible = m.narrowest_bits;
  while (possible < width) possible *= 2;
  if (possible == width && m.bits % width == 0) return;
  throw InputError(key, "expected narrowest_bits, " + std::to_string(m.narrowest_bits) +
                            ", doubled some times, and a divisor of the block's " +
                            std::to_string(m.bits) + " bits; found " + std::to_string(width));
}

template <class Part>
void require_distinct(const char* list, const std::vector<Part>& parts) {
  if (parts.empty()) throw InputError(list, std::string("expected at least one [[") + list + "]]");
  std::set<std::string> names;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (names.insert(parts[i].name).second) continue;
    throw InputError(std::string(list) + "[" + std::to_string(i) + "].name",
                     "\"" + parts[i].name + "\" is there already: expected another name");
  }
}

}  // namespace

void MemoryType::declare(config::Visitor& v) {
  v.text("name", name, {.help = "the block's name", .required = true});
  v.integer("blocks", blocks, {0, 1'000'000},
            {.help = "how many the device has", .required = true});
  v.integer("bits", bits, {1, 1 << 24}, {.help = "of a block, without parity", .required = true});
  v.integer("parity_bits", parity_bits, {0, 1 << 24},
            {"of a block, beside the others; they can hold data", "a block without parity"});
  v.integer("narrowest_bits", narrowest_bits, {1, 4096},
            {"narrowest port, without parity", "one bit"});
  v.integer("read_write_bits", read_write_bits, {1, 4096},
            {.help = "widest port where one port reads and another one writes, without parity",
             .required = true});
  v.integer("two_port_bits", two_port_bits, {0, 4096},
            {.help = "widest of two ports that both read or write; 0: it has no two such ports",
             .required = true});
  v.quantity("clock", clock_hz, Dimension::frequency, config::above(0),
             {.help = "the block's own limit", .required = true});
  v.text("source", source, {.help = kSourceHelp, .required = true});
}

void MemoryType::check() const {
  require_choice(name);
  require_width(*this, "read_write_bits", read_write_bits);
  if (two_port_bits > read_write_bits) {
    throw InputError("two_port_bits", "expected at most read_write_bits, which are " +
                                          std::to_string(read_write_bits) + "; found " +
                                          std::to_string(two_port_bits));
  }
  if (two_port_bits > 0) require_width(*this, "two_port_bits", two_port_bits);
  if (parity_bits > bits) {
    throw InputError("parity_bits", "expected no more than the block's " + std::to_string(bits) +
                                        " bits, found " + std::to_string(parity_bits));
  }
}

void MultiplierMode::declare(config::Visitor& v) {
  v.text("name", name, {.help = "what accelerator.multiplier_mode calls it", .required = true});
  v.integer("count", count, {0, 1'000'000},
            {.help = "multipliers of the device", .required = true});
  v.integer("bits", bits, {2, 1024}, {.help = "of the wider operand, signed", .required = true});
  v.integer("other_bits", other_bits, {2, 1024},
            {.help = "of the other operand, signed", .required = true});
  v.integer("summed", summed, {1, 64},
            {"products of which the block gives only the sum; 1: each of its own",
             "independent multipliers"});
  v.quantity("clock", clock_hz, Dimension::frequency, config::above(0),
             {.help = "the block's own limit, all its registers in use", .required = true});
  v.text("source", source, {.help = kSourceHelp, .required = true});
}

void MultiplierMode::check() const {
  require_choice(name);
  if (other_bits > bits) {
    throw InputError("other_bits", "expected the narrower operand, at most " +
                                       std::to_string(bits) + " bits; found " +
                                       std::to_string(other_bits));
  }
}

void LogicCells::declare(config::Visitor& v) {
  v.text("name", name, {.help = "what the look-up tables are called", .required = true});
  v.integer("cells", cells, {0, 100'000'000}, {.help = "look-up tables", .required = true});
  v.integer("inputs", inputs, {3, 16}, {"of a look-up table", "six: all but ECP5"});
  v.integer("registers", registers, {0, 100'000'000}, {.help = "flip-flops", .required = true});
  v.quantity("cells_share", cells_share, config::Dimension::dimensionless, config::between(0, 10),
             {"look-up tables that the engine takes here, of those that are counted for tables of "
              "so many inputs",
              "1: engine.sv, for ECP5 (docs/synthesis.md)"});
  v.quantity("registers_share", registers_share, config::Dimension::dimensionless,
             config::between(0, 10), {"likewise registers", "1: engine.sv"});
  v.text("source", source, {.help = kSourceHelp, .required = true});
}

void Device::declare(config::Visitor& v) {
  v.text("name", name, {.help = "the device's name", .required = true});
  v.text("family", family, {.help = "the family it belongs to", .required = true});
  v.table("logic", logic, {.help = "look-up tables and flip-flops", .required = true});
  v.list("multiplier", multipliers,
         {"ways to use the multipliers; without accelerator.multiplier_mode the first one"});
  v.list("memory", memories, {"kinds of memory blocks"});
  v.effect("timing", timing, {"delays of the device's elements; without them no clock is refused"});
}

void Device::check() const {
  require_name(name);
  require_name(family);
  require_distinct("multiplier", multipliers);
  require_distinct("memory", memories);
}

const MemoryType* Device::memory(const std::string& type) const {
  const auto found = std::ranges::find(memories, type, &MemoryType::name);
  return found == memories.end() ? nullptr : &*found;
}

}  // namespace hvp::accel
