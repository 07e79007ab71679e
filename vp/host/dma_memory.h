#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "driver/hvp_driver.h"
#include "models/link/frame_transfer.h"
#include "vp/bus/host_memory.h"
#include "vp/host/transfer.h"

namespace hvp::vp {

// The places of b, U, the descriptors and the completion record in the host's memory. As an
// operating system would give them, they are in separate segments, those of b and of U in turn.
class DmaMemory {
 public:
  // The number of bytes used from the memory's beginning. `b_bytes` and `u_bytes` are multiples of
  // 4.
  static std::size_t needed(const link::DmaEngine& engine, std::size_t b_bytes,
                            std::size_t u_bytes);
  // As above, for `transfer` and this number of unknowns; 0 without a DMA engine.
  static std::size_t needed(const Transfer& transfer, const fixed::Settings& solver,
                            std::size_t unknowns);

  // Throws InputError with the key "transfer.dma.segment_bytes" if the board's engine has too few
  // descriptors. The memory has to outlive the object.
  DmaMemory(HostMemory& memory, const link::DmaEngine& engine, std::size_t b_bytes,
            std::size_t u_bytes);

  // The argument of hvp_use_dma(). It is valid as long as this object.
  const hvp_dma& dma() const { return dma_; }

 private:
  std::vector<hvp_segment> to_board_;
  std::vector<hvp_segment> to_host_;
  hvp_dma dma_{};
};

}  // namespace hvp::vp
