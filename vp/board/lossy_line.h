#pragma once

#include "vp/fault/fault_plan.h"
#include "vp/frame/frame_tag.h"

namespace hvp::vp {

// The board's request on its way to the host, where it can be lost. A module, so that it has a
// place among the others; it has no process.
class LossyLine : public sc_core::sc_module, public InterruptIf {
 public:
  LossyLine(const sc_core::sc_module_name& name, FaultPlan& plan, InterruptIf& host)
      : sc_module(name), plan_(plan), host_(host) {}

  void interrupt(const Tag& tag) override {
    if (plan_.gone(now_ps(), tag.frame)) return;
    if (plan_.strike(FaultKind::lost_interrupt, tag.frame) != nullptr) return;
    host_.interrupt(tag);
  }
  void lowered() override { host_.lowered(); }

 private:
  FaultPlan& plan_;
  InterruptIf& host_;
};

}  // namespace hvp::vp
