#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "driver/hvp_driver.h"
#include "models/link/frame_transfer.h"
#include "vp/bus/host_memory.h"
#include "vp/host/transfer.h"

namespace hvp::vp {

// The bytes that the board's engine moves, in multiples of 4: b and U of a frame, and the values of
// a renewed matrix where one is renewed.
struct DmaBytes {
  std::size_t b = 0;
  std::size_t u = 0;
  std::size_t values = 0;

  // `renewed_entries`: of the matrix, where it is renewed; else 0.
  static DmaBytes of(const Transfer& transfer, const fixed::Settings& solver, std::size_t unknowns,
                     std::size_t renewed_entries);
};

// The places of b, U, the descriptors and the completion record in the host's memory, and behind
// them those of the values. As an operating system would give them, they are in separate segments,
// those of b and of U in turn.
class DmaMemory {
 public:
  // The number of bytes used from the memory's beginning.
  static std::size_t needed(const link::DmaEngine& engine, const DmaBytes& bytes);

  // Throws InputError with the key "transfer.dma.segment_bytes" if the board's engine has too few
  // descriptors. The memory has to outlive the object.
  DmaMemory(HostMemory& memory, const link::DmaEngine& engine, const DmaBytes& bytes);

  // The argument of hvp_use_dma(). It is valid as long as this object.
  const hvp_dma& dma() const { return dma_; }

 private:
  std::vector<hvp_segment> to_board_;
  std::vector<hvp_segment> to_host_;
  std::vector<hvp_segment> values_;
  hvp_dma dma_{};
};

}  // namespace hvp::vp
