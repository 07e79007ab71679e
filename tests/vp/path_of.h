#pragma once

#include <vector>

#include "vp/frame/ledger.h"

namespace hvp::vp {

inline CriticalPath path_of(const Frame& frame) {
  CriticalPath path;
  path.follow(frame);
  return path;
}

inline std::vector<SpanId> critical_path(const Frame& frame) { return path_of(frame).spans(); }

}  // namespace hvp::vp
