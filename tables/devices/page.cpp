#include <fmt/format.h>

#include "app/devices/devices.h"
#include "app/scenario/outline.h"
#include "app/scenario/quantity.h"
#include "app/scenario/reference.h"
#include "tables/pages.h"
#include "tables/text.h"

namespace hvp::tables {

namespace {

constexpr const char* kHead = R"(# FPGA devices

<!-- Made by `./hvp tables devices > docs/devices.md`: do not edit. -->

The FPGAs that `accelerator.device` can name: what each has, and where the figures stand. A device is
a file, `devices/<name>.toml`, and nothing in the code knows one of them. *Unverified* figures are
those of the document named as they are known, but were not read from it again for this project.
Code: `models/accel/device.h` (what a device is), `app/devices/` (reading). What the figures decide:
[accelerator.md](accelerator.md), "Memory and multipliers".

<!-- not run: writes into the checkout -->
```sh
./hvp tables devices > docs/devices.md
```
)";

constexpr const char* kOwnDevice = R"(
## A device of your own

Copy one of the files, change it, and name it by its path, relative to the scenario. It is read as
strictly as a scenario: an unknown key or a figure out of range is refused with its line. Results keep
it beside `scenario.resolved.toml`.

```sh
cp devices/EP2S60.toml mine.toml
sed -i 's/name = "EP2S60"/name = "mine"/; s/^blocks = 255/blocks = 300/' mine.toml
./hvp explain scenarios/thesis.toml --set accelerator.device="$PWD/mine.toml"
```

To build one in, put the file into `devices/`, name it in `app/devices/CMakeLists.txt`, and renew this
page. `tests/accel/devices_test.cpp` then reads it.

## Keys of a device's file
)";

std::string logic_table() {
  MarkdownTable table({"device", "family", "look-up tables", "registers", "source"});
  for (const std::string_view name : devices::built_in_names()) {
    const accel::Device& d = devices::built_in(name);
    table.add({d.name, d.family, fmt::format("{} {}", d.logic.cells, d.logic.name),
               fmt::format("{}", d.logic.registers), d.logic.source});
  }
  return table.text();
}

std::string clock(double hertz) {
  return scenario::format_quantity(hertz, config::Dimension::frequency);
}

std::string multiplier_table() {
  MarkdownTable table({"device", "mode", "count", "operands", "limit", "source"});
  for (const std::string_view name : devices::built_in_names()) {
    for (const accel::MultiplierMode& m : devices::built_in(name).multipliers) {
      const std::string summed = m.summed > 1 ? fmt::format(", sums of {}", m.summed) : "";
      table.add({std::string(name), m.name, fmt::format("{}", m.count),
                 fmt::format("{} × {}{}", m.bits, m.other_bits, summed), clock(m.clock_hz),
                 m.source});
    }
  }
  return table.text();
}

std::string memory_table() {
  MarkdownTable table({"device", "type", "blocks", "bits + parity", "one reads, one writes",
                       "two ports", "narrowest", "limit", "source"});
  for (const std::string_view name : devices::built_in_names()) {
    for (const accel::MemoryType& m : devices::built_in(name).memories) {
      const std::string two =
          m.two_port_bits > 0 ? fmt::format("{} bits", m.two_port_bits) : "none";
      table.add({std::string(name), m.name, fmt::format("{}", m.blocks),
                 fmt::format("{} + {}", m.bits, m.parity_bits),
                 fmt::format("{} bits", m.read_write_bits), two,
                 fmt::format("{}", m.narrowest_bits), clock(m.clock_hz), m.source});
    }
  }
  return table.text();
}

// Picoseconds, as whole numbers.
std::string delays_table() {
  MarkdownTable table({"device", "register", "look-up table", "carry + a bit", "multiplier",
                       "memory without / with its register", "net", "net of a block", "crowding",
                       "source"});
  const auto ps = [](double seconds) { return fmt::format("{:.0f}", seconds * 1e12); };
  for (const std::string_view name : devices::built_in_names()) {
    const auto& t = devices::built_in(name).timing;
    if (!t) continue;
    table.add({std::string(name), ps(t->clock_to_out_s + t->set_up_s),
               fmt::format("{}, {} inputs", ps(t->logic_s), t->logic_inputs),
               fmt::format("{} + {}", ps(t->carry_s), ps(t->carry_bit_s)), ps(t->multiplier_s),
               fmt::format("{} / {}", ps(t->memory_read_s), ps(t->memory_register_s)),
               ps(t->routing_s), ps(t->block_routing_s), fmt::format("{:.2f}", t->crowding),
               t->source});
  }
  return table.text();
}

}  // namespace

std::string devices_page() {
  std::string page = kHead;
  page += "\n## Logic\n\n" + logic_table();
  page +=
      "\n## Multipliers\n\nWithout `accelerator.multiplier_mode` the first mode is taken. Operands "
      "are signed.\n\n" +
      multiplier_table();
  page += "\n## Memory\n\nPort widths are without parity.\n\n" + memory_table();
  page +=
      "\n## Delays\n\nIn ps; what they are is in [critical-path.md](critical-path.md). A register "
      "is "
      "clock-to-out and set-up.\n\n" +
      delays_table();
  page += kOwnDevice;
  return page + scenario::reference_tables(scenario::describe(accel::Device{}));
}

}  // namespace hvp::tables
