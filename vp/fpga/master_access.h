#pragma once

#include <cstdint>
#include <span>

#include "models/time/picoseconds.h"

namespace hvp::vp {

// What the board's own transactions are for.
enum class MasterPurpose { descriptors, b, u, record, message, values };
const char* name(MasterPurpose purpose);

// A transaction of the board's own, as its engine sees it.
struct MasterAccess {
  Picoseconds began = 0;
  Picoseconds ended = 0;  // of a write: when the engine goes on; the bus may still have it
  std::int64_t frame = -1;
  MasterPurpose purpose = MasterPurpose::descriptors;
  bool read = false;  // from the host's memory
  std::uint64_t address = 0;
  std::span<const std::uint8_t> data;
  bool answered = false;
};

class MasterObserver {
 public:
  virtual ~MasterObserver() = default;
  // Has begun: `ended` is that time, and what is read is not there yet.
  virtual void begins(const MasterAccess& /*access*/) {}
  virtual void transferred(const MasterAccess& access) = 0;
};

}  // namespace hvp::vp
