#pragma once

#include "models/collision/contact_search.h"
#include "models/fem/body.h"
#include "models/host/frame_computation.h"
#include "vp/board/board_side.h"
#include "vp/frame/session.h"
#include "vp/frame/verdict.h"
#include "vp/host/board_access.h"
#include "vp/host/collision_process.h"
#include "vp/host/dispatcher.h"
#include "vp/host/driver_port.h"
#include "vp/host/exchange.h"
#include "vp/host/servo_process.h"
#include "vp/platform_settings.h"

namespace hvp::vp {

// The host: the processor's way to the bus, what its operating system costs, and its two processes.
class HostAssembly {
 public:
  // Keeps references to all. The board's side is built already, so that its modules come first.
  HostAssembly(const PlatformSettings& settings, const fem::Body& body,
               host::FrameComputation& computation, collision::ContactSearch& contacts,
               BoardSide& side, Ledger& ledger, Verdict& verdict, Session& session);

  // Binds both sides to each other. Throws as BoardSide::connect() does.
  void connect();

  ServoProcess& servo() { return servo_; }
  const ServoProcess& servo() const { return servo_; }
  const CollisionProcess& collision() const { return collision_; }

 private:
  void watch(BoardAssembly& board);

  const PlatformSettings& settings_;
  BoardSide& side_;
  Exchange exchange_;
  Dispatcher dispatcher_;
  BoardAccess access_;
  DriverPort port_;
  ServoProcess servo_;
  CollisionProcess collision_;
};

}  // namespace hvp::vp
