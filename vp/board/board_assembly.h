#pragma once

#include <cstddef>
#include <functional>
#include <memory>

#include "vp/board/faults.h"
#include "vp/bus/bus_assembly.h"
#include "vp/bus/host_memory.h"
#include "vp/fault/bus_errors.h"
#include "vp/fpga/accelerator.h"
#include "vp/fpga/engine/engine_trace.h"
#include "vp/frame/ledger.h"
#include "vp/platform_settings.h"

namespace hvp::vp {

// The solver board with what a scenario has on it and around it: the accelerator; the host's
// memory, where the board is bus master; with [[fault]] what is between them and the host; with
// [output.waveform] who looks at the engine's clocks.
class BoardAssembly {
 public:
  // Keeps a reference to the settings. `memory_bytes`: of the host's memory, for a bus master.
  BoardAssembly(const PlatformSettings& settings, Numbers numbers, std::size_t memory_bytes,
                Ledger& ledger, AccessObserver* register_trace);

  // Puts the board on its bus; its interrupts end at `host`. Once, after all modules of the host
  // and the buses are built. Throws InputError with the keys "method" and "waveform" where the
  // accelerator's level does not have them.
  // `messages_enabled`: of a host that decides while it runs whether interrupts are messages; it
  // hears of the line otherwise.
  void connect(BusAssembly& buses, InterruptIf& host, std::function<bool()> messages_enabled = {});

  Accelerator& accelerator() { return accelerator_; }
  const Accelerator& accelerator() const { return accelerator_; }
  // Null where the board is no master.
  HostMemory* memory() const { return memory_.get(); }
  // Null without [[fault]].
  FaultPlan* faults() const { return faults_ == nullptr ? nullptr : &faults_->plan; }
  BusErrors& bus_errors() { return bus_errors_; }
  void close_waveform() { waveform_.reset(); }

 private:
  InterruptIf& inject(InterruptIf& host);
  void trace();
  tlm::tlm_target_socket<>& registers();

  const PlatformSettings& settings_;
  Accelerator accelerator_;
  std::unique_ptr<HostMemory> memory_;
  BusErrors bus_errors_;
  std::unique_ptr<Faults> faults_;
  std::unique_ptr<engine::EngineTrace> waveform_;
};

}  // namespace hvp::vp
