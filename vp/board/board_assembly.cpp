#include "vp/board/board_assembly.h"

#include <utility>

#include "models/config/input_error.h"
#include "vp/bus/memory_map.h"

namespace hvp::vp {

BoardAssembly::BoardAssembly(const PlatformSettings& settings, Numbers numbers,
                             std::size_t memory_bytes, Ledger& ledger,
                             AccessObserver* register_trace)
    : settings_(settings),
      accelerator_("accelerator", settings.accelerator, settings.fidelity.accelerator, ledger,
                   register_trace, numbers, settings.transfer.master()) {
  if (accelerator_.dma() == nullptr) return;
  memory_ = std::make_unique<HostMemory>("memory", memory_bytes);
}

void BoardAssembly::connect(BusAssembly& buses, InterruptIf& host,
                            std::function<bool()> messages_enabled) {
  Accelerator::require_supported(settings_.fidelity.accelerator, settings_.solver);
  InterruptIf& hears = settings_.faults.empty() ? host : inject(host);
  buses.at_solver_board([this](auto& bus) {
    bus.attach(registers(), kSolverBase, kBarBytes);
    if (memory_ == nullptr) return;
    accelerator_.dma()->to_memory.bind(bus.from_board);
    bus.attach_memory(memory_->from_bus);
  });
  InterruptIf& line = buses.line_to(hears);
  const bool messages = settings_.transfer.notification == link::Notification::msi;
  if (messages) memory_->interrupt.bind(hears);
  if (!messages || messages_enabled) accelerator_.interrupt.bind(line);
  if (messages_enabled) accelerator_.messages_if(std::move(messages_enabled));
  if (settings_.waveform) trace();
}

// Faults sit between the board and what it is attached to.
InterruptIf& BoardAssembly::inject(InterruptIf& host) {
  faults_ =
      std::make_unique<Faults>(settings_.faults, settings_.seed, settings_.period, bus_errors_,
                               settings_.bus.pcie ? &*settings_.bus.pcie : nullptr, host);
  accelerator_.inject(faults_->plan);
  faults_->wire.to_board.bind(accelerator_.from_bus);
  return faults_->line;
}

tlm::tlm_target_socket<>& BoardAssembly::registers() {
  if (faults_ != nullptr) return faults_->wire.from_bus;
  return accelerator_.from_bus;
}

void BoardAssembly::trace() {
  const WaveformWindow& waveform = *settings_.waveform;
  if (accelerator_.engine() == nullptr) {
    throw InputError("waveform", "only the cycle-accurate accelerator has one");
  }
  waveform_ = std::make_unique<engine::EngineTrace>(
      "waveform", *accelerator_.engine(), waveform.file,
      engine::TraceWindow{[this] { return accelerator_.frame(); }, waveform.first_frame,
                          waveform.first_frame + waveform.frames - 1});
}

}  // namespace hvp::vp
