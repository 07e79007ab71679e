#include "vp/board/board_side.h"

#include <stdexcept>
#include <string>
#include <utility>

#include "models/config/input_error.h"
#include "vp/bus/host_memory.h"
#include "vp/fpga/register_table.h"
#include "vp/main_stack.h"

namespace hvp::vp {

BusAssembly::BusAssembly(const BusSettings& settings, Timing level, std::int64_t seed,
                         std::int64_t vertices, Ledger& ledger)
    : pci_("bus", settings, level, ledger, seed) {
  if (settings.traffic) {
    traffic_ = std::make_unique<TrafficMaster>("traffic", *settings.traffic, pci_);
  }
  if (settings.graphics_traffic) {
    graphics_ = std::make_unique<GraphicsMaster>(
        "graphics", settings.graphics_traffic->picture_bytes(vertices), pci_);
  }
  if (!settings.pcie) return;
  bridge_ = std::make_unique<HostBridge>("bridge", kSolverBase, kBarBytes);
  pcie_ = std::make_unique<PcieBus>("pcie", *settings.pcie, level, ledger, seed);
  bridge_->to_link.bind(pcie_->from_host);
  bridge_->to_bus.bind(pci_.from_host);
}

tlm::tlm_target_socket<>& BusAssembly::from_host() {
  if (bridge_ != nullptr) return bridge_->from_host;
  return pci_.from_host;
}

InterruptIf& BusAssembly::line_to(InterruptIf& host) {
  if (pcie_ == nullptr) return host;
  pcie_->interrupt_line.bind(host);
  return *pcie_;
}

void BusAssembly::drain_to_board() {
  pci_.drain_to_board();
  if (pcie_ != nullptr) pcie_->drain_to_board();
}

void BusAssembly::drain_to_host() {
  pci_.drain_to_host();
  if (pcie_ != nullptr) pcie_->drain_to_host();
}

void BusAssembly::drain() {
  drain_to_board();
  drain_to_host();
}

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
  line_ = std::make_unique<LossyLine>(host);
  if (!settings_.faults.empty()) plan_faults();
  buses.at_solver_board([this](auto& bus) {
    bus.attach(accelerator_.from_bus, kSolverBase, kBarBytes);
    if (memory_ == nullptr) return;
    accelerator_.dma()->to_memory.bind(bus.from_board);
    bus.attach_memory(memory_->from_bus);
  });
  InterruptIf& line = buses.line_to(*line_);
  const bool messages = settings_.transfer.notification == link::Notification::msi;
  if (messages) memory_->interrupt.bind(*line_);
  if (!messages || messages_enabled) accelerator_.interrupt.bind(line);
  if (messages_enabled) accelerator_.messages_if(std::move(messages_enabled));
  if (settings_.waveform) trace();
  if (settings_.engine_port) record_port();
}

// Faults sit between the board and what it is attached to.
FaultPlan& BoardAssembly::plan_faults() {
  if (faults_ != nullptr) return *faults_;
  faults_ = std::make_unique<FaultPlan>(settings_.faults, settings_.seed, settings_.period);
  wire_ = std::make_unique<FaultyWire>(*faults_, bus_errors_,
                                       settings_.bus.pcie ? &*settings_.bus.pcie : nullptr,
                                       accelerator_.behind());
  accelerator_.inject(
      *faults_,
      [this](tlm::tlm_generic_payload& transaction, sc_core::sc_time& delay) {
        wire_->b_transport(transaction, delay);
      },
      settings_.bus.pcie ? &*settings_.bus.pcie : nullptr);
  line_->lose(*faults_);
  return *faults_;
}

void BoardAssembly::trace() {
  const WaveformWindow& waveform = *settings_.waveform;
  if (accelerator_.engine() == nullptr) {
    throw InputError("waveform", "only the cycle-accurate accelerator has one");
  }
  const engine::TraceWindow window{[this] { return accelerator_.frame(); }, waveform.first_frame,
                                   waveform.first_frame + waveform.frames - 1};
  waveform_ = std::make_unique<engine::EngineTrace>("waveform", *accelerator_.engine(),
                                                    waveform.file, window);
  accelerator_.open_rtl_waveform(waveform.file + ".fst", window);
}

void BoardAssembly::record_port() {
  accelerator_.record_port(
      [this](char what, std::uint32_t first, std::uint32_t second, std::uint32_t third) {
        if (accelerator_.frame() < settings_.engine_port->frames) {
          settings_.engine_port->write(what, first, second, third);
        }
      });
}

namespace {
std::unique_ptr<BoardAssembly> make_board(const PlatformSettings& settings,
                                          const Workload& workload, Ledger& ledger,
                                          AccessObserver* register_trace) {
  if (workload.has_board) {
    return std::make_unique<BoardAssembly>(settings, workload.numbers, workload.memory_bytes,
                                           ledger, register_trace);
  }
  if (settings.waveform) throw InputError("waveform", "the host solves: there is no engine");
  return nullptr;
}
}  // namespace

BoardSide::BoardSide(const PlatformSettings& settings, const Workload& workload,
                     const Session& session, Ledger& ledger, AccessObserver* register_trace)
    : buses_(settings.bus, settings.fidelity.bus, settings.seed, workload.vertices, ledger),
      board_(make_board(settings, workload, ledger, register_trace)),
      device_(settings, session, ledger) {}

void BoardSide::connect(InterruptIf& host, std::function<bool()> messages_enabled) {
  if (board_ != nullptr) board_->connect(buses_, host, std::move(messages_enabled));
  device_.connect(buses_);
}

void BoardSide::step_to(Picoseconds time) {
  if (time < now_ps()) {
    throw std::invalid_argument("a step to " + std::to_string(time) + " ps at " +
                                std::to_string(now_ps()) + " ps");
  }
  sc_core::sc_start(to_sc_time(time - now_ps()), sc_core::SC_RUN_TO_TIME);
  // A step of no length makes one delta cycle only.
  while (sc_core::sc_pending_activity_at_current_time()) sc_core::sc_start(sc_core::SC_ZERO_TIME);
  return_to_main_stack();
}

std::optional<Picoseconds> BoardSide::next_event() {
  if (sc_core::sc_get_status() == sc_core::SC_ELABORATION) return now_ps();  // all begin at 0
  if (!sc_core::sc_pending_activity()) return std::nullopt;
  return now_ps() + static_cast<Picoseconds>(sc_core::sc_time_to_pending_activity().value());
}

}  // namespace hvp::vp
