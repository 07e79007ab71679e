#pragma once

#include <functional>
#include <systemc>
#include <tlm>
#include <vector>

#include "models/link/pcie.h"
#include "vp/fault/fault_plan.h"
#include "vp/frame/frame_tag.h"

namespace hvp::vp {

// The connection of bus and solver board with the faults of the bus: accesses that no target claims
// and words damaged on the wire. It is no module, so that it can come during the run. The bus has
// taken its time before a transaction arrives here; a master abort takes as long as the access
// would have.
//
// A damaged word of conventional PCI has the wrong parity if an odd number of its bits is flipped
// (PCI 3.0 §3.7.1: PAR is even over AD[31:0] and C/BE#). It is used nevertheless, and the bridge
// records the error. On PCI Express the link's CRC finds every damaged packet, which is sent again;
// the root port does not learn of a refused write, because writes are posted.
class FaultyWire {
 public:
  using Transport = std::function<void(tlm::tlm_generic_payload&, sc_core::sc_time&)>;

  // Keeps references. `link` is the board's PCI Express link; null on the PCI bus.
  FaultyWire(FaultPlan& plan, BusErrors& errors, const link::Pcie* link, Transport to_board)
      : plan_(plan), errors_(errors), link_(link), to_board_(std::move(to_board)) {}

  void b_transport(tlm::tlm_generic_payload& transaction, sc_core::sc_time& delay);

 private:
  void abort(tlm::tlm_generic_payload& transaction);
  void poison(tlm::tlm_generic_payload& transaction);
  void corrupt(tlm::tlm_generic_payload& transaction, const Fault& fault, std::int64_t frame,
               sc_core::sc_time& delay);
  // `wire_bytes`: of the packet that comes again.
  void replay(tlm::tlm_generic_payload& transaction, const Fault& fault, std::int64_t wire_bytes,
              sc_core::sc_time& delay);
  std::int64_t data_wire_bytes(const tlm::tlm_generic_payload& transaction) const;
  std::int64_t request_wire_bytes(const tlm::tlm_generic_payload& transaction) const;
  void reset_board();

  FaultPlan& plan_;
  BusErrors& errors_;
  const link::Pcie* link_;
  Transport to_board_;
};

// The board's interrupt line to the host, on which a request is lost where a plan says so.
class LossyLine : public InterruptIf {
 public:
  explicit LossyLine(InterruptIf& host) : host_(host) {}
  // From now on. Keeps a reference.
  void lose(FaultPlan& plan) { plan_ = &plan; }

  void interrupt(const Tag& tag) override {
    if (plan_ != nullptr) {
      if (plan_->gone(now_ps(), tag.frame)) return;
      if (plan_->strike(FaultKind::lost_interrupt, tag.frame) != nullptr) return;
    }
    host_.interrupt(tag);
  }
  void lowered() override { host_.lowered(); }

 private:
  FaultPlan* plan_ = nullptr;
  InterruptIf& host_;
};

}  // namespace hvp::vp
