#pragma once

#include <systemc>
#include <vector>

#include <tlm_utils/simple_initiator_socket.h>
#include <tlm_utils/simple_target_socket.h>

#include "models/link/pcie.h"
#include "vp/fault/bus_errors.h"
#include "vp/fault/fault_plan.h"
#include "vp/frame/frame_tag.h"

namespace hvp::vp {

// Between the bus and the solver board: accesses that nobody claims, words that are damaged on the
// wire. The bus has taken its time when a transaction comes here; a master abort takes as long as
// the access would have.
//
// A damaged word of conventional PCI has the wrong parity where an odd number of its bits is
// flipped (PCI 3.0 §3.7.1: PAR is even over AD[31:0] and C/BE#). It is used all the same; the
// bridge remembers. On PCI Express the link's CRC finds every damaged packet, which is sent again;
// of a write that is refused, being posted, the root port hears nothing.
class FaultyWire : public sc_core::sc_module {
 public:
  // `link`: of PCI Express; null for a bus.
  FaultyWire(const sc_core::sc_module_name& name, FaultPlan& plan, BusErrors& errors,
             const link::Pcie* link = nullptr);

  tlm_utils::simple_target_socket<FaultyWire> from_bus;
  tlm_utils::simple_initiator_socket<FaultyWire> to_board;

 private:
  void b_transport(tlm::tlm_generic_payload& transaction, sc_core::sc_time& delay);
  void abort(tlm::tlm_generic_payload& transaction);
  void corrupt(tlm::tlm_generic_payload& transaction, const Fault& fault, std::int64_t frame,
               sc_core::sc_time& delay);
  void replay(tlm::tlm_generic_payload& transaction, const Fault& fault, sc_core::sc_time& delay);
  void reset_board();

  FaultPlan& plan_;
  BusErrors& errors_;
  const link::Pcie* link_;
};

}  // namespace hvp::vp
