#include "vp/platform.h"

#include <cmath>

#include "models/config/input_error.h"
#include "vp/host/board_solver.h"
#include "vp/host/local_time.h"
#include "vp/main_stack.h"

namespace hvp::vp {

namespace {

// A pass of a refined solve that saturates is mended by the next one.
ServoSettings servo_settings(const PlatformSettings& settings, bool refined) {
  ServoSettings servo = settings.servo;
  servo.hold_saturated =
      !refined && host::guards(servo.costs.recovery.hold_saturated, !settings.faults.empty());
  return servo;
}

SceneState at_rest(const fem::Body& body, const host::FrameComputation& computation,
                   plant::Device& device) {
  SceneState scene;
  scene.tip = device.at(0).position;
  scene.displacement = body.expand(computation.displacement());
  scene.has_force = !computation.timing_only();
  return scene;
}

Numbers numbers_of(const host::FrameComputation& computation) {
  return computation.timing_only() ? Numbers::none : Numbers::fixed;
}

std::size_t memory_bytes(const PlatformSettings& settings, std::size_t unknowns) {
  const Transfer& transfer = settings.transfer;
  if (transfer.method != Transfer::Method::dma) return 0;
  const fixed::Settings& solver = settings.servo.solver;
  return DmaMemory::needed(
      transfer.engine(),
      static_cast<std::size_t>(BoardSolver::rhs_bytes(solver, transfer, unknowns)),
      static_cast<std::size_t>(BoardSolver::solution_bytes(solver, transfer, unknowns)));
}

template <class Visit>
void visit_objects(const std::vector<sc_core::sc_object*>& objects, const Visit& visit) {
  for (sc_core::sc_object* object : objects) {
    visit(*object);
    visit_objects(object->get_child_objects(), visit);
  }
}

}  // namespace

Platform::Platform(const PlatformSettings& settings, const fem::Body& body,
                   host::FrameComputation& computation, collision::ContactSearch& contacts,
                   AccessObserver* register_trace)
    : settings_(settings),
      verdict_(settings.servo.period, settings.budget),
      own_device_(plant::make_device(settings.device, settings.probe)),
      device_(settings.haptic_device != nullptr ? *settings.haptic_device : *own_device_),
      exchange_{Mailbox<SceneState>(at_rest(body, computation, device_)),
                Mailbox<ContactReport>(ContactReport{})},
      bus_("bus", settings_.bus, settings_.fidelity.bus, ledger_, settings_.seed),
      traffic_(settings_.bus.traffic
                   ? std::make_unique<TrafficMaster>("traffic", *settings_.bus.traffic, bus_)
                   : nullptr),
      graphics_(settings_.bus.graphics_traffic
                    ? std::make_unique<GraphicsMaster>(
                          "graphics",
                          settings_.bus.graphics_traffic->picture_bytes(
                              static_cast<std::int64_t>(contacts.surface().surface_nodes().size())),
                          bus_)
                    : nullptr),
      bridge_(settings_.bus.pcie ? std::make_unique<HostBridge>("bridge", kSolverBase, kBarBytes)
                                 : nullptr),
      pcie_(settings_.bus.pcie
                ? std::make_unique<PcieBus>("pcie", *settings_.bus.pcie, settings_.fidelity.bus,
                                            ledger_, settings_.seed)
                : nullptr),
      accelerator_(computation.on_host() != nullptr
                       ? nullptr
                       : std::make_unique<Accelerator>("accelerator", settings_.accelerator,
                                                       settings_.fidelity.accelerator, ledger_,
                                                       register_trace, numbers_of(computation),
                                                       settings_.transfer.master())),
      memory_(accelerator_ != nullptr && accelerator_->dma() != nullptr
                  ? std::make_unique<HostMemory>(
                        "memory", memory_bytes(settings_, computation.displacement().size()))
                  : nullptr),
      daq_("daq", settings_.device.daq, settings_.device.encoder, device_, session_, ledger_),
      dispatcher_(settings_.servo.costs, settings_.seed, ledger_),
      access_("access",
              settings_.servo.untimed
                  ? 0
                  : std::llround(settings_.servo.costs.interrupt_latency_s * 1e12),
              ledger_, &dispatcher_, settings_.transfer),
      servo_("servo", servo_settings(settings_, computation.refined() != nullptr), body,
             computation, contacts, access_, dispatcher_, exchange_, ledger_, verdict_, session_,
             memory_.get()),
      collision_("collision", settings_.servo.costs, settings_.servo.untimed, contacts, exchange_,
                 session_, servo_.begun(), dispatcher_) {
  ledger_.add_sink(verdict_);
  connect_host();
  if (accelerator_ != nullptr) connect_board();
  bus_.attach(daq_.from_bus, kDaqBase, DaqBoard::kSize);
  if (graphics_) collision_.tell_drawing(graphics_->drawing());
  servo_.drain_with([this] { drain(); });
  if (settings_.waveform) trace(*settings_.waveform);
}

void Platform::connect_host() {
  if (pcie_ == nullptr) {
    access_.to_bus.bind(bus_.from_host);
    return;
  }
  access_.to_bus.bind(bridge_->from_host);
  bridge_->to_link.bind(pcie_->from_host);
  bridge_->to_bus.bind(bus_.from_host);
}

void Platform::drain() {
  bus_.drain();
  if (pcie_ != nullptr) pcie_->drain();
}

// Faults sit between the board and what it is attached to.
void Platform::connect_board() {
  Accelerator::require_supported(settings_.fidelity.accelerator, settings_.servo.solver);
  const bool faulty = !settings_.faults.empty();
  if (host::guards(settings_.servo.costs.recovery.bus_errors, faulty)) {
    const bool untimed = settings_.fidelity.bus == Timing::untimed;
    access_.report_errors(bus_errors_, untimed ? 0 : settings_.bus.pci.read_ps(0),
                          untimed ? 0 : settings_.bus.pci.write_ps(0));
  }
  InterruptIf* host = &access_;
  if (faulty) {
    faults_ = std::make_unique<Faults>(
        settings_.faults, settings_.seed, settings_.servo.period, bus_errors_,
        settings_.bus.pcie ? &*settings_.bus.pcie : nullptr, access_);
    accelerator_->inject(faults_->plan);
    servo_.report_to(faults_->plan);
    host = &faults_->line;
    faults_->wire.to_board.bind(accelerator_->from_bus);
  }
  access_.watch(accelerator_->job_end());
  if (pcie_ != nullptr) {
    connect_board(*pcie_);
    pcie_->interrupt_line.bind(*host);
  } else {
    connect_board(bus_);
  }
  if (settings_.transfer.notification == link::Notification::msi) {
    memory_->interrupt.bind(*host);
  } else if (pcie_ != nullptr) {
    accelerator_->interrupt.bind(*pcie_);
  } else {
    accelerator_->interrupt.bind(*host);
  }
}

template <class Bus>
void Platform::connect_board(Bus& bus) {
  if (faults_ != nullptr) {
    bus.attach(faults_->wire.from_bus, kSolverBase, kBarBytes);
  } else {
    bus.attach(accelerator_->from_bus, kSolverBase, kBarBytes);
  }
  if (memory_ == nullptr) return;
  accelerator_->dma()->to_memory.bind(bus.from_board);
  bus.attach_memory(memory_->from_bus);
}

void Platform::trace(const Waveform& waveform) {
  if (accelerator_ == nullptr || accelerator_->engine() == nullptr) {
    throw InputError("waveform", "only the cycle-accurate accelerator has one");
  }
  waveform_ = std::make_unique<engine::EngineTrace>(
      "waveform", *accelerator_->engine(), waveform.file,
      engine::TraceWindow{[this] { return accelerator_->frame(); }, waveform.first_frame,
                          waveform.first_frame + waveform.frames - 1});
}

Platform::~Platform() = default;

void Platform::run() {
  LocalTime::set_quantum(std::llround(settings_.servo.costs.quantum_s * 1e12));
  sc_core::sc_start();
  return_to_main_stack();
  if (servo_.failure()) std::rethrow_exception(servo_.failure());
}

std::vector<std::string> Platform::modules() {
  std::vector<std::string> names;
  visit_objects(sc_core::sc_get_top_level_objects(), [&names](const sc_core::sc_object& object) {
    if (dynamic_cast<const sc_core::sc_module*>(&object) != nullptr) {
      names.emplace_back(object.name());
    }
  });
  return names;
}

std::size_t Platform::processes() {
  std::size_t count = 0;
  visit_objects(sc_core::sc_get_top_level_objects(), [&count](const sc_core::sc_object& object) {
    const std::string kind = object.kind();
    if (kind == "sc_thread_process" || kind == "sc_method_process") ++count;
  });
  return count;
}

}  // namespace hvp::vp
