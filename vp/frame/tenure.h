#pragma once

#include <cstdint>
#include <string_view>

#include "vp/frame/frame.h"

namespace hvp::vp {

// What one user at a time has: a core, a bus, a direction of a link.
enum class Resource : std::uint8_t {
  core_0,         // the servo process', and the other one's where there is one core
  core_1,         // the collision and graphics process'
  bus,            // PCI
  link_to_board,  // PCI Express
  link_to_host,
};
std::string_view name(Resource resource);

// Who had a resource, for what, and when. Other than a frame's spans, which say what the frame took
// and waited for, tenures say what was taken, whoever took it: set-up, passes of the collision
// process and background traffic too. Those of one resource do not overlap, and those of a bus add
// up to what it says of its use.
struct Tenure {
  Resource resource = Resource::bus;
  std::string_view user;  // processor, board, traffic, graphics; a process
  std::string_view what;  // a phase's name, or what else it was
  std::int64_t frame = -1;
  Picoseconds start = 0;
  Picoseconds end = 0;
};

// Takes tenures as they are known: those of a resource in the order of time.
class TenureSink {
 public:
  virtual ~TenureSink() = default;
  virtual void take(const Tenure& tenure) = 0;
};

}  // namespace hvp::vp
