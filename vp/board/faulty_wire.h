#pragma once

#include <systemc>
#include <vector>

#include <tlm_utils/simple_initiator_socket.h>
#include <tlm_utils/simple_target_socket.h>

#include "models/link/pcie.h"
#include "vp/fault/fault_plan.h"
#include "vp/frame/frame_tag.h"

namespace hvp::vp {

// The connection of bus and solver board with the faults of the bus: accesses that no target claims
// and words damaged on the wire. The bus has taken its time before a transaction arrives here; a
// master abort takes as long as the access would have.
//
// A damaged word of conventional PCI has the wrong parity if an odd number of its bits is flipped
// (PCI 3.0 §3.7.1: PAR is even over AD[31:0] and C/BE#). It is used nevertheless, and the bridge
// records the error. On PCI Express the link's CRC finds every damaged packet, which is sent again;
// the root port does not learn of a refused write, because writes are posted.
class FaultyWire : public sc_core::sc_module {
 public:
  // `link` is the board's PCI Express link; null on the PCI bus.
  FaultyWire(const sc_core::sc_module_name& name, FaultPlan& plan, BusErrors& errors,
             const link::Pcie* link = nullptr);

  tlm_utils::simple_target_socket<FaultyWire> from_bus;
  tlm_utils::simple_initiator_socket<FaultyWire> to_board;

 private:
  void b_transport(tlm::tlm_generic_payload& transaction, sc_core::sc_time& delay);
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
};

// The board's interrupt line to the host, on which a request can be lost. It is a module for its
// place in the hierarchy; it has no process.
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

// The modules that inject the faults of a scenario with [[fault]].
struct Faults {
  Faults(const std::vector<Fault>& faults, std::int64_t seed, Picoseconds period, BusErrors& errors,
         const link::Pcie* link, InterruptIf& host)
      : plan(faults, seed, period),
        wire("faulty_wire", plan, errors, link),
        line("lossy_line", plan, host) {}

  FaultPlan plan;
  FaultyWire wire;
  LossyLine line;
};

}  // namespace hvp::vp
