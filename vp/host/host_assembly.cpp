#include "vp/host/host_assembly.h"

#include "models/time/picoseconds.h"

namespace hvp::vp {

namespace {

bool untimed(const PlatformSettings& settings) { return settings.fidelity.host == Timing::untimed; }

ServoSettings servo_settings(const PlatformSettings& settings, bool refined) {
  ServoSettings servo;
  servo.period = settings.period;
  servo.frames = settings.frames;
  servo.costs = settings.host;
  servo.untimed = untimed(settings);
  servo.solver = settings.solver;
  // A pass of a refined solve that saturates is mended by the next one.
  servo.hold_saturated =
      !refined && host::guards(settings.host.recovery.hold_saturated, !settings.faults.empty());
  return servo;
}

SceneState at_rest(const fem::Body& body, const host::FrameComputation& computation,
                   plant::Device& device) {
  SceneState scene;
  scene.touches = {{.tip = device.at(0).position, .contact = {}}};
  scene.displacement = body.expand(computation.displacement());
  scene.has_force = !computation.timing_only();
  return scene;
}

HostMemory* memory_of(const BoardSide& side) {
  return side.board() == nullptr ? nullptr : side.board()->memory();
}

}  // namespace

HostAssembly::HostAssembly(const PlatformSettings& settings, const fem::Body& body,
                           host::FrameComputation& computation, collision::ContactSearch& contacts,
                           BoardSide& side, Ledger& ledger, Verdict& verdict, Session& session)
    : settings_(settings),
      side_(side),
      exchange_{Mailbox<SceneState>(at_rest(body, computation, side.device())),
                Mailbox<ContactReport>(ContactReport{std::vector<collision::Contact>(1)})},
      dispatcher_(settings.host, settings.seed, ledger),
      access_("access", settings.transfer.notification == link::Notification::msi),
      port_(access_, untimed(settings) ? 0 : to_picoseconds(settings.host.interrupt_latency_s),
            ledger, &dispatcher_, settings.transfer),
      servo_("servo", servo_settings(settings, computation.refined() != nullptr), body, computation,
             contacts, access_, port_, dispatcher_, exchange_, ledger, verdict, session,
             memory_of(side)),
      collision_("collision", settings.host, untimed(settings), contacts, exchange_, session,
                 servo_.begun(), dispatcher_) {}

void HostAssembly::connect() {
  access_.to_bus.bind(side_.from_host());
  side_.connect(access_);
  servo_.drain_with([this] { side_.drain(); });
  if (side_.buses().graphics() != nullptr) {
    collision_.tell_drawing(side_.buses().graphics()->drawing());
  }
  if (side_.board() != nullptr) watch(*side_.board());
}

void HostAssembly::watch(BoardAssembly& board) {
  port_.watch(board.accelerator().job_end());
  if (board.faults() != nullptr) servo_.report_to(*board.faults());
  if (!host::guards(settings_.host.recovery.bus_errors, !settings_.faults.empty())) return;
  const bool untimed_bus = settings_.fidelity.bus == Timing::untimed;
  port_.report_errors(board.bus_errors(), untimed_bus ? 0 : settings_.bus.pci.read_ps(0),
                      untimed_bus ? 0 : settings_.bus.pci.write_ps(0));
}

}  // namespace hvp::vp
