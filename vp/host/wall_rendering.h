#pragma once

#include <optional>
#include <vector>

#include "models/host/wall.h"
#include "vp/host/frame_solver.h"
#include "vp/host/rendering.h"

namespace hvp::vp {

// A wall that the host renders by itself: no board, no collision process.
class WallRendering : public Rendering {
 public:
  WallRendering(const host::Wall& wall, double period_s, std::size_t probes)
      : wall_(wall), period_s_(period_s), before_(probes) {}

  std::size_t probes() const override { return before_.size(); }
  void begin(FrameStep& step) override;
  void collect(FrameStep& /*step*/) override {}
  double force_operations() const override {
    return host::Wall::kOperations * static_cast<double>(before_.size());
  }
  ServoCounts& counts() override { return counts_; }

 private:
  host::Wall wall_;
  double period_s_;
  std::vector<std::optional<double>> before_;  // depth in the frame before
  ServoCounts counts_;
};

}  // namespace hvp::vp
