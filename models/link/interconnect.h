#pragma once

#include <cstdint>

#include "models/link/pci_protocol.h"
#include "models/link/pcie.h"

namespace hvp::link {

// The bytes of a register, a descriptor's word and a message.
inline constexpr std::int64_t kWordBytes = 4;

// What an operation between processor, memory and board takes, nobody else on the bus.
struct Cost {
  std::int64_t latency_ps = 0;    // until its data are where they go
  std::int64_t processor_ps = 0;  // of it the processor's: it does nothing else
  std::int64_t bus_ps = 0;        // the bus, or the busier direction of the link, is taken
  std::int64_t wire_bytes = 0;    // payload, padding, packets' overhead; all directions
  std::int64_t transactions = 0;  // bursts of a bus, packets of a link

  // One after the other.
  Cost& operator+=(const Cost& next);
};
Cost operator+(Cost first, const Cost& next);

enum class Interrupt { intx, msi };

// The ways that bytes can go, as an architect's table compares them: the same questions to every
// bus. `bytes` are whole 32-bit words, more than none.
class Interconnect {
 public:
  virtual ~Interconnect() = default;
  // The processor stores words: one access each, or collected into bursts by a write-combining
  // buffer. Writes are posted: the processor goes on when the bus can take the next one.
  virtual Cost processor_write(std::int64_t bytes, bool combined) const = 0;
  // The processor loads words, one access each, and waits for each.
  virtual Cost processor_read(std::int64_t bytes) const = 0;
  // The board reads the host's memory, or writes it.
  virtual Cost dma_read(std::int64_t bytes) const = 0;
  virtual Cost dma_write(std::int64_t bytes) const = 0;
  // From the board's decision to the interrupt controller. INTx tells nothing but that: the
  // handler reads a status word, which also pushes the board's posted writes ahead of itself (PCI
  // 3.0 §3.2.5.2; PCIe 5.0 §2.4). MSI is a posted write, behind the data that it announces.
  virtual Cost interrupt(Interrupt kind) const = 0;
};

// Pci::write_latency and Pci::read_latency stand before a processor's access; consecutive writes
// are write_latency apart, or as long as the bus needs for one.
class PciInterconnect : public Interconnect {
 public:
  PciInterconnect(const Pci& bus, const PciProtocol& protocol);
  Cost processor_write(std::int64_t bytes, bool combined) const override;
  Cost processor_read(std::int64_t bytes) const override;
  Cost dma_read(std::int64_t bytes) const override;
  Cost dma_write(std::int64_t bytes) const override;
  // INTx is a wire of its own and takes nothing.
  Cost interrupt(Interrupt kind) const override;

 private:
  Cost block(Direction direction, std::int64_t bytes) const;

  Pci bus_;
  PciClocks clocks_;
};

// A processor's write reaches the root port after half of processor_latency.
class PcieInterconnect : public Interconnect {
 public:
  explicit PcieInterconnect(const Pcie& link) : link_(link) {}
  Cost processor_write(std::int64_t bytes, bool combined) const override;
  Cost processor_read(std::int64_t bytes) const override;
  Cost dma_read(std::int64_t bytes) const override;
  Cost dma_write(std::int64_t bytes) const override;
  // INTx is a message of a header alone (PCIe 5.0 §2.2.8.1).
  Cost interrupt(Interrupt kind) const override;

 private:
  Cost read(PcieSide requester, std::int64_t bytes) const;

  Pcie link_;
};

}  // namespace hvp::link
