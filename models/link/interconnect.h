#pragma once

#include <cstdint>

#include "models/link/pci.h"
#include "models/link/pcie.h"

namespace hvp::link {

// The bytes of a register, of a descriptor's word and of a message.
inline constexpr std::int64_t kWordBytes = 4;

// The cost of an operation between processor, memory and board with no other traffic on the bus.
struct Cost {
  std::int64_t latency_ps = 0;    // time until its data have arrived
  std::int64_t processor_ps = 0;  // the part in which the processor does nothing else
  std::int64_t bus_ps = 0;        // time of the bus, or of the busier direction of the link
  std::int64_t wire_bytes = 0;    // payload, padding and overhead of packets; all directions
  std::int64_t transactions = 0;  // bursts of a bus, packets of a link

  // Adds an operation that follows this one.
  Cost& operator+=(const Cost& next);
};
Cost operator+(Cost first, const Cost& next);

enum class Interrupt { intx, msi };

// The operations of a bus that moves bytes between processor, memory and board, the same for every
// bus. `bytes` are whole 32-bit words, at least one.
class Interconnect {
 public:
  virtual ~Interconnect() = default;
  // The processor stores words, each by an access or combined into bursts by a write-combining
  // buffer. Writes are posted: the processor goes on when the bus can take the next one.
  virtual Cost processor_write(std::int64_t bytes, bool combined) const = 0;
  // The processor loads words, each by an access for which it waits.
  virtual Cost processor_read(std::int64_t bytes) const = 0;
  // The board reads the host's memory, or writes it.
  virtual Cost dma_read(std::int64_t bytes) const = 0;
  virtual Cost dma_write(std::int64_t bytes) const = 0;
  // An interrupt from the board's decision to the interrupt controller. INTx carries no data: the
  // handler reads a status word, which also pushes the board's posted writes ahead of itself (PCI
  // 3.0 §3.2.5.2; PCIe 5.0 §2.4). MSI is a posted write that follows the data which it announces.
  virtual Cost interrupt(Interrupt kind) const = 0;
};

// PCI as an interconnect. Pci::write_latency_s and Pci::read_latency_s come before a processor's
// access; consecutive writes are write_latency apart, or as long as the bus needs for one.
class PciInterconnect : public Interconnect {
 public:
  PciInterconnect(const Pci& bus, const PciProtocol& protocol);
  Cost processor_write(std::int64_t bytes, bool combined) const override;
  Cost processor_read(std::int64_t bytes) const override;
  Cost dma_read(std::int64_t bytes) const override;
  Cost dma_write(std::int64_t bytes) const override;
  // INTx has its own wire and takes no time.
  Cost interrupt(Interrupt kind) const override;

 private:
  Cost block(Direction direction, std::int64_t bytes) const;

  Pci bus_;
  PciClocks clocks_;
};

// PCI Express as an interconnect. A processor's write reaches the root port after half of
// processor_latency_s.
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
