#pragma once

#include "vp/board/board_side.h"
#include "vp/frame/ledger.h"
#include "vp/frame/session.h"
#include "vp/function/outside_host.h"
#include "vp/platform_settings.h"

namespace hvp::vp {

// The board's side for a host of another program, built and wired: what the C library hvp-board,
// `hvp serve` and `hvp linux` have in common. SystemC elaborates once in a process, so there is one
// a process. The host's memory is empty until the host gives some (HostMemory::map()); its own
// settings and effects, [host] and [hand] among them, are of no meaning here.
class BoardFunction {
 public:
  explicit BoardFunction(const PlatformSettings& settings, AccessObserver* register_trace = nullptr)
      : settings_(settings),
        side_(settings_, Workload{}, session_, ledger_, register_trace),
        host_("host", settings_, side_, session_, ledger_) {}

  OutsideHost& host() { return host_; }
  ConfigSpace& config() { return host_.config(); }
  // Null where the board is no master.
  HostMemory* memory() { return side_.board()->memory(); }
  const Accelerator& accelerator() const { return side_.board()->accelerator(); }
  BusErrors& bus_errors() { return side_.board()->bus_errors(); }
  Ledger& ledger() { return ledger_; }
  const Session& session() const { return session_; }
  BoardSide& side() { return side_; }

 private:
  PlatformSettings settings_;
  Ledger ledger_;
  Session session_;
  BoardSide side_;
  OutsideHost host_;
};

}  // namespace hvp::vp
