#pragma once

#include <memory>
#include <optional>

#include "vp/board/board_side.h"
#include "vp/frame/session.h"
#include "vp/frame/verdict.h"
#include "vp/host/board_access.h"
#include "vp/host/body_rendering.h"
#include "vp/host/collision_process.h"
#include "vp/host/dispatcher.h"
#include "vp/host/driver_port.h"
#include "vp/host/exchange.h"
#include "vp/host/rendering.h"
#include "vp/host/servo_process.h"
#include "vp/platform_settings.h"

namespace hvp::vp {

// The host: the processor's way to the bus, what its operating system costs, and its processes: the
// servo loop, and where there is a body the collision process.
class HostAssembly {
 public:
  // Keeps references to all. `soft`: none where settings.wall stands in the body's place. The
  // board's side is built already, so that its modules come first.
  HostAssembly(const PlatformSettings& settings, const std::optional<SoftBody>& soft,
               BoardSide& side, Ledger& ledger, Verdict& verdict, Session& session);

  // Binds both sides to each other. Throws as BoardSide::connect() does.
  void connect();

  // Before the run. Keeps a reference.
  void observe_jobs(JobObserver& observer) { rendering_->observe_jobs(observer); }

  ServoProcess& servo() { return servo_; }
  const ServoProcess& servo() const { return servo_; }
  // Null where there is no body.
  const CollisionProcess* collision() const { return collision_.get(); }

 private:
  std::unique_ptr<Rendering> make_rendering(const std::optional<SoftBody>& soft);
  void watch(BoardAssembly& board);

  const PlatformSettings& settings_;
  BoardSide& side_;
  std::optional<Exchange> exchange_;
  Dispatcher dispatcher_;
  BoardAccess access_;
  DriverPort port_;
  Work work_;
  std::unique_ptr<Rendering> rendering_;
  ServoProcess servo_;
  std::unique_ptr<CollisionProcess> collision_;
};

}  // namespace hvp::vp
