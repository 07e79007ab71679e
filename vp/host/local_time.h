#pragma once

#include <systemc>

#include <tlm_utils/tlm_quantumkeeper.h>

#include "vp/frame/frame_tag.h"

namespace hvp::vp {

// Temporal decoupling of the servo process (IEEE 1666-2011 §12.1): time that it spends at work runs
// ahead of the kernel, by at most the global quantum. Nothing that another part could observe, or
// that could be observed of another part, happens ahead: every bus access, every wait and every
// exchange between processes synchronises first. The quantum is therefore a matter of wall time
// only; with a quantum of zero each step synchronises.
class LocalTime {
 public:
  static void set_quantum(Picoseconds quantum) {
    tlm_utils::tlm_quantumkeeper::set_global_quantum(to_sc_time(quantum));
  }

  Picoseconds now() const { return static_cast<Picoseconds>(keeper_.get_current_time().value()); }
  // Spends time, in the process whose time this is.
  void advance(Picoseconds time) {
    keeper_.inc(to_sc_time(time));
    if (keeper_.need_sync()) keeper_.sync();
  }
  void synchronise() {
    if (ahead() != sc_core::SC_ZERO_TIME) keeper_.sync();
  }

  // How far the process is ahead: what a transaction carries as its annotated delay. The bus has
  // waited for it when it returns, and restart() begins from there.
  sc_core::sc_time ahead() const { return keeper_.get_local_time(); }
  void restart() { keeper_.reset(); }

 private:
  tlm_utils::tlm_quantumkeeper keeper_;
};

}  // namespace hvp::vp
