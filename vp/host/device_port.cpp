#include "vp/host/device_port.h"

namespace hvp::vp {

DevicePort::DevicePort(const Settings& settings, std::size_t probes)
    : wall_(settings.wall),
      newest_(probes, Eigen::Vector3d::Zero()),
      forces_(probes, Eigen::Vector3d::Zero()) {
  if (settings.coupling) {
    tools_.assign(probes, {*settings.coupling, settings.period_s});
  }
  if (settings.passivity) controllers_.assign(probes, {*settings.passivity, settings.period_s});
}

void DevicePort::read(Frame& frame) {
  frame.ports.resize(newest_.size());
  for (std::size_t i = 0; i < newest_.size(); ++i) {
    collision::Touch& touch = frame.touches[i];
    newest_[i] = touch.tip;
    frame.ports[i] = {.read = touch.tip};
    if (tools_.empty()) continue;
    touch.tip =
        wall_ ? tools_[i].follow(touch.tip, *wall_) : tools_[i].follow(touch.tip, forces_[i]);
  }
}

void DevicePort::send(Frame& frame) {
  send_operations_ = 0;
  for (std::size_t i = 0; i < newest_.size(); ++i) {
    forces_[i] = frame.touches[i].force;
    if (controllers_.empty()) continue;
    host::PassivityController& controller = controllers_[i];
    frame.ports[i].damping = controller.damping(newest_[i], forces_[i]);
    frame.ports[i].observed_J = controller.observed_j();
    send_operations_ += host::PassivityController::kObserves +
                        (controller.acts() ? host::PassivityController::kDamps : 0);
  }
}

}  // namespace hvp::vp
