#pragma once

#include <cstdint>
#include <systemc>
#include <vector>

#include "models/collision/contact_search.h"
#include "models/host/costs.h"
#include "vp/frame/frame.h"
#include "vp/host/dispatcher.h"
#include "vp/host/exchange.h"

namespace hvp::vp {

// The collision and graphics process (thesis §6.2.3), on a core of its own or on the servo
// process'. Once a period it takes the latest tip and U, tests the tip against the deformed
// surface, draws, and publishes the contact node at the end of the pass. The servo process thus
// gets a contact that is between one pass and one period plus one pass old.
class CollisionProcess : public sc_core::sc_module {
 public:
  CollisionProcess(const sc_core::sc_module_name& name, const host::Host& costs, bool untimed,
                   collision::ContactSearch& search, Exchange& exchange, const Session& session,
                   sc_core::sc_event& begun, Dispatcher& dispatcher);

  // Notifies `drawing` when a pass has found its contact and begins to draw. On a shared core that
  // is the time without preemption.
  void tell_drawing(sc_core::sc_event& drawing) { drawing_ = &drawing; }

  std::int64_t passes() const { return passes_; }
  std::int64_t skipped_passes() const { return skipped_; }
  // The longest pass so far, from its first instruction to its last.
  Picoseconds longest_pass() const { return longest_; }

 private:
  void run();
  void pass();
  void search(const SceneState& scene);

  host::Host costs_;
  bool untimed_;
  collision::ContactSearch& search_;
  Exchange& exchange_;
  const Session& session_;
  sc_core::sc_event& begun_;
  Dispatcher& dispatcher_;
  sc_core::sc_event* drawing_ = nullptr;
  std::vector<collision::Contact> found_;  // by the current pass
  std::vector<collision::Contact> reported_;
  std::int64_t passes_ = 0;
  std::int64_t skipped_ = 0;
  Picoseconds longest_ = 0;
};

}  // namespace hvp::vp
