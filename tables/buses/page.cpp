#include <algorithm>
#include <memory>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "app/scenario/outline.h"
#include "app/scenario/reference.h"
#include "models/link/frame_transfer.h"
#include "models/link/pci_arbiter.h"
#include "models/link/pcie_link.h"
#include "tables/pages.h"
#include "tables/text.h"

namespace hvp::tables {

namespace {

using link::Cost;
using link::Direction;
using link::Movement;
using link::Notification;
using link::PcieGeneration;
using link::PciKind;

constexpr const char* kHead = R"(# Buses: rates, ways to move a frame, a second master

<!-- Made by `./hvp tables buses > docs/bus-tables.md`: do not edit. -->

What the formulas of [pci.md](pci.md) and [pcie.md](pcie.md) give with the defaults of their parameters, which stand
at the end. Code: `models/link/`, `tables/buses/`.

<!-- not run: writes into the checkout -->
```sh
./hvp tables buses > docs/bus-tables.md
```

## What a link carries

In GB/s: behind the encoding; left to packets; payload of 256-byte writes, one burst or packet each. And 3000 bytes (b or
U of 500 nodes in 16-bit words) on the wire: bursts of 64 bytes on PCI, packets of 256 on PCIe. Gen6 is in flits.

)";

constexpr const char* kWays = R"(
## Ways to move a frame's data

b to the board and U back, 1500 words of 16 bits each, two of them in a word of 32 unless it says *unpacked*. To the
board: until it may start. To the host: from the solve's end until the host has U. Processor: what it spends on it
of both. Wire: bytes of the whole frame with all overhead. What the host computes and its interrupt latency are not
in it; polling is without a pause, and of the board only where the processor moves the data.

)";

constexpr const char* kContention = R"(
## A second master on PCI 32/33

The accelerator writes U, 3000 bytes, by DMA; meanwhile the processor reads one word of the DAQ board. How much later
than alone it has it, from 0 to the worst instant to ask, and how much later the DMA ends at worst. Found by
`PciArbiter`, which is asked at every clock of the transfer.

)";

constexpr const char* kParameters = R"(
## Parameters

)";

struct NamedLink {
  const char* name;
  PcieGeneration generation;
  int lanes;
};
constexpr NamedLink kLinks[] = {
    {"PCIe Gen1 x1", PcieGeneration::gen1, 1},   {"PCIe Gen1 x4", PcieGeneration::gen1, 4},
    {"PCIe Gen1 x8", PcieGeneration::gen1, 8},   {"PCIe Gen2 x4", PcieGeneration::gen2, 4},
    {"PCIe Gen2 x8", PcieGeneration::gen2, 8},   {"PCIe Gen3 x4", PcieGeneration::gen3, 4},
    {"PCIe Gen3 x8", PcieGeneration::gen3, 8},   {"PCIe Gen3 x16", PcieGeneration::gen3, 16},
    {"PCIe Gen4 x8", PcieGeneration::gen4, 8},   {"PCIe Gen4 x16", PcieGeneration::gen4, 16},
    {"PCIe Gen5 x16", PcieGeneration::gen5, 16}, {"PCIe Gen6 x16", PcieGeneration::gen6, 16}};

struct NamedBus {
  const char* name;
  PciKind kind;
};
constexpr NamedBus kBuses[] = {{"PCI 32/33", PciKind::pci_32_33},
                               {"PCI 32/66", PciKind::pci_32_66},
                               {"PCI 64/66", PciKind::pci_64_66},
                               {"PCI-X 133", PciKind::pci_x_133}};

link::Pci bus(PciKind kind, int burst_bytes = 64) {
  link::Pci pci;
  pci.kind = kind;
  pci.burst_bytes = burst_bytes;
  return pci;
}

link::Pcie serial(const NamedLink& named) {
  link::Pcie pcie;
  pcie.generation = named.generation;
  pcie.lanes = named.lanes;
  return pcie;
}

double us(std::int64_t ps) { return static_cast<double>(ps) * 1e-6; }
std::string digits(double value) {
  return fmt::format("{:.{}f}", value, value < 10 ? 3 : value < 100 ? 2 : 1);
}

std::string rate_table() {
  MarkdownTable table({"link", "raw", "packets", "256-byte writes", "3000 bytes, us"});
  for (const NamedBus& named : kBuses) {
    const link::Pci pci = bus(named.kind);
    const double raw = pci.width_bytes() * 1e3 / static_cast<double>(pci.clock_period_ps());
    const double effective = 256e3 / static_cast<double>(bus(named.kind, 256).write_wire_ps(256));
    table.add(
        {named.name, digits(raw), "", digits(effective), digits(us(pci.write_wire_ps(3000)))});
  }
  for (const NamedLink& named : kLinks) {
    const link::Pcie pcie = serial(named);
    const std::int64_t block = pcie.transfer_ps(pcie.write_wire_bytes(3000));
    const double wire = 256 * 1e3 / static_cast<double>(pcie.write_wire_bytes(256));
    table.add({named.name, digits(pcie.raw_rate() * 1e-9), digits(pcie.tlp_rate() * 1e-9),
               digits(pcie.tlp_rate() * 1e-12 * wire), digits(us(block))});
  }
  return table.text();
}

struct Way {
  Movement movement;
  Notification notification;
  bool packed;
};
constexpr Way kWaysOfAFrame[] = {{Movement::programmed_io, Notification::polling, false},
                                 {Movement::programmed_io, Notification::polling, true},
                                 {Movement::programmed_io, Notification::intx, true},
                                 {Movement::write_combined_io, Notification::intx, true},
                                 {Movement::dma, Notification::polling, true},
                                 {Movement::dma, Notification::intx, true},
                                 {Movement::dma, Notification::msi, false},
                                 {Movement::dma, Notification::msi, true}};

void add_ways(MarkdownTable& table, const char* name, const link::Interconnect& way_of) {
  for (const Way& way : kWaysOfAFrame) {
    const link::Payload payload = {1'500, 1'500, 16, way.packed};
    const link::FrameTransfer frame =
        frame_transfer(way_of, {}, payload, {way.movement, way.notification, 0});
    const Cost total = frame.total();
    table.add({name,
               fmt::format("{}, {}{}", link::name(way.movement), link::name(way.notification),
                           way.packed ? "" : ", unpacked"),
               digits(us(frame.to_board_total().latency_ps)),
               digits(us(frame.to_host_total().latency_ps)), digits(us(total.latency_ps)),
               digits(us(total.processor_ps)), digits(us(total.bus_ps)),
               fmt::format("{}", total.wire_bytes)});
  }
}

std::string way_table() {
  MarkdownTable table({"link", "way", "to the board, us", "to the host, us", "both, us",
                       "processor, us", "bus taken, us", "wire, bytes"});
  for (const NamedBus& named : kBuses) {
    if (named.kind == PciKind::pci_32_66) continue;
    add_ways(table, named.name, link::PciInterconnect(bus(named.kind), {}));
  }
  for (const NamedLink& named : kLinks) {
    const bool shown = (named.generation == PcieGeneration::gen1 && named.lanes == 1) ||
                       (named.generation == PcieGeneration::gen3 && named.lanes < 16);
    if (shown) add_ways(table, named.name, link::PcieInterconnect(serial(named)));
  }
  return table.text();
}

struct Delay {
  std::int64_t word_ps = 0;
  std::int64_t block_ps = 0;
};

// Over all clocks of the block's transfer at which the word may be asked for.
Delay worst_delay(const link::Pci& pci, const link::PciProtocol& protocol) {
  const link::PciClocks clocks(pci, protocol);
  const std::int64_t word = clocks.alone_ps(Direction::read, 4);
  const std::int64_t block = clocks.alone_ps(Direction::write, 3'000);
  Delay worst;
  for (std::int64_t asked = 0; asked < block; asked += clocks.period_ps()) {
    link::PciArbiter arbiter(pci, protocol, 2);
    arbiter.request(0, Direction::write, 3'000, 0);
    arbiter.request(1, Direction::read, 4, asked);
    worst.word_ps = std::max(worst.word_ps, arbiter.forecast(1) - asked - word);
    worst.block_ps = std::max(worst.block_ps, arbiter.forecast(0) - block);
  }
  return worst;
}

std::string contention_table() {
  MarkdownTable table({"longest burst, bytes", "latency timer, clocks", "word later by up to, us",
                       "block later by up to, us"});
  for (const int burst : {64, 256, 4'096}) {
    for (const int timer : {0, 32, 64, 255}) {
      link::PciProtocol protocol;
      protocol.latency_timer_clocks = timer;
      const Delay delay = worst_delay(bus(PciKind::pci_32_33, burst), protocol);
      table.add({fmt::format("{}", burst), fmt::format("{}", timer), digits(us(delay.word_ps)),
                 digits(us(delay.block_ps))});
    }
  }
  return table.text();
}

template <class Part>
std::string parameters(const char* title) {
  return fmt::format("### {}\n", title) + scenario::reference_tables(scenario::describe(Part{})) +
         "\n";
}

}  // namespace

std::string buses_page() {
  std::string page = kHead + rate_table();
  page += kWays + way_table();
  page += kContention + contention_table();
  page += kParameters;
  page += parameters<link::PciProtocol>("PCI with several masters");
  page += parameters<link::Pcie>("PCI Express");
  page += parameters<link::DmaEngine>("DMA engine");
  page.pop_back();  // the empty line after the last of them
  return page;
}

}  // namespace hvp::tables
