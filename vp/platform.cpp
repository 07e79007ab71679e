#include "vp/platform.h"

#include <exception>

#include "models/time/picoseconds.h"
#include "vp/host/board_access.h"
#include "vp/host/board_solver.h"
#include "vp/host/dma_memory.h"
#include "vp/host/rendering.h"
#include "vp/main_stack.h"

namespace hvp::vp {

namespace {

bool untimed(const PlatformSettings& settings) { return settings.fidelity.host == Timing::untimed; }

ServoSettings servo_settings(const PlatformSettings& settings, std::size_t probes) {
  return {settings.period,
          settings.frames,
          settings.host.pipeline_depth,
          DaqBoard::read_bytes(settings.devices_of(probes)),
          {settings.host.virtual_coupling, settings.host.passivity, settings.wall,
           to_seconds(settings.period)}};
}

BodySettings body_settings(const PlatformSettings& settings, bool refined) {
  // A pass of a refined solve that saturates is mended by the next one.
  const bool hold_saturated =
      !refined && host::guards(settings.host.recovery.hold_saturated, !settings.faults.empty());
  return {settings.period, settings.host, settings.solver, hold_saturated, settings.seed};
}

SceneState at_rest(const SoftBody& soft, BoardSide& side) {
  SceneState scene;
  for (std::size_t i = 0; i < side.probes(); ++i) {
    scene.touches.push_back({.tip = side.device(i).at(0).position, .contact = {}});
  }
  scene.displacement = soft.body.expand(soft.computation.displacement());
  scene.has_force = !soft.computation.timing_only();
  return scene;
}

std::optional<Exchange> make_exchange(const std::optional<SoftBody>& soft, BoardSide& side) {
  if (!soft) return std::nullopt;
  return Exchange{
      Mailbox<SceneState>(at_rest(*soft, side)),
      Mailbox<ContactReport>(ContactReport{std::vector<collision::Contact>(side.probes())})};
}

HostMemory* memory_of(const BoardSide& side) {
  return side.board() == nullptr ? nullptr : side.board()->memory();
}

}  // namespace

HostAssembly::HostAssembly(const PlatformSettings& settings, const std::optional<SoftBody>& soft,
                           BoardSide& side, Ledger& ledger, Verdict& verdict, Session& session)
    : settings_(settings),
      side_(side),
      exchange_(make_exchange(soft, side)),
      dispatcher_(settings.host, settings.seed, ledger),
      access_("access", settings.transfer.notification == link::Notification::msi),
      port_(access_, untimed(settings) ? 0 : to_picoseconds(settings.host.interrupt_latency_s),
            ledger, &dispatcher_, settings.transfer),
      work_(settings_.host, untimed(settings_), access_.tag(), access_.time(), ledger),
      rendering_(make_rendering(soft)),
      servo_("servo", servo_settings(settings, side.probes()), *rendering_, access_, work_,
             dispatcher_, ledger, verdict, session) {
  if (!soft) return;
  collision_ = std::make_unique<CollisionProcess>("collision", settings.host, untimed(settings),
                                                  soft->contacts, *exchange_, session,
                                                  servo_.begun(), dispatcher_);
}

std::unique_ptr<Rendering> HostAssembly::make_rendering(const std::optional<SoftBody>& soft) {
  if (!soft) {
    return std::make_unique<WallRendering>(settings_.wall.value(), to_seconds(settings_.period),
                                           side_.probes());
  }
  return std::make_unique<BodyRendering>(
      body_settings(settings_, soft->computation.refined() != nullptr), *soft, side_.probes(),
      access_, port_, work_, *exchange_, memory_of(side_));
}

void HostAssembly::connect() {
  access_.to_bus.bind(side_.from_host());
  side_.connect(access_);
  servo_.drain_with([this] { side_.drain(); });
  if (side_.buses().graphics() != nullptr && collision_ != nullptr) {
    collision_->tell_drawing(side_.buses().graphics()->drawing());
  }
  if (side_.board() != nullptr) watch(*side_.board());
}

void HostAssembly::watch(BoardAssembly& board) {
  port_.watch(board.accelerator().job_end());
  if (board.faults() != nullptr) rendering_->report_to(*board.faults());
  if (!host::guards(settings_.host.recovery.bus_errors, !settings_.faults.empty())) return;
  const bool untimed_bus = settings_.fidelity.bus == Timing::untimed;
  port_.report_errors(board.bus_errors(), untimed_bus ? 0 : settings_.bus.pci.read_ps(0),
                      untimed_bus ? 0 : settings_.bus.pci.write_ps(0));
}

namespace {

// What the board's engine needs of the host's memory.
std::size_t memory_of(const PlatformSettings& settings, const host::FrameComputation& computation) {
  const Transfer& transfer = settings.transfer;
  if (transfer.method != Transfer::Method::dma) return 0;
  return DmaMemory::needed(
      transfer.engine(), DmaBytes::of(transfer, settings.solver, computation.displacement().size(),
                                      renewed_entries(computation)));
}

Workload workload_of(const PlatformSettings& settings, const std::optional<SoftBody>& soft) {
  if (!soft) return {.has_board = false};
  const host::FrameComputation& computation = soft->computation;
  return {.has_board = computation.has_board(),
          .numbers = computation.timing_only() ? Numbers::none : Numbers::fixed,
          .memory_bytes = memory_of(settings, computation),
          .vertices = static_cast<std::int64_t>(soft->contacts.surface().surface_nodes().size())};
}

template <class Visit>
void visit_objects(const std::vector<sc_core::sc_object*>& objects, const Visit& visit) {
  for (sc_core::sc_object* object : objects) {
    visit(*object);
    visit_objects(object->get_child_objects(), visit);
  }
}

}  // namespace

// The order of construction is that of modules and processes, which results depend on.
Platform::Platform(const PlatformSettings& settings, const std::optional<SoftBody>& soft,
                   AccessObserver* register_trace)
    : settings_(settings),
      verdict_(settings.period, settings.budget),
      side_(settings_, workload_of(settings_, soft), session_, ledger_, register_trace),
      host_(settings_, soft, side_, ledger_, verdict_, session_) {
  ledger_.add_observer(verdict_);
  host_.connect();
}

void Platform::run() {
  LocalTime::set_quantum(to_picoseconds(settings_.host.quantum_s));
  sc_core::sc_start();
  return_to_main_stack();
  if (servo().failure()) std::rethrow_exception(servo().failure());
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
