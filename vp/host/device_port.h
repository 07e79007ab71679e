#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "models/host/passivity.h"
#include "models/host/virtual_coupling.h"
#include "vp/frame/frame.h"

namespace hvp::vp {

// What a host has between its rendering and the haptic devices: the effects [host.virtual_coupling]
// and [host.passivity], of each probe for itself. It is built where one of them is.
class DevicePort {
 public:
  struct Settings {
    std::optional<host::VirtualCoupling> coupling;
    std::optional<host::Passivity> passivity;
    std::optional<host::Wall> wall;  // that the tools press; none: a body
    double period_s = 0;

    bool present() const { return coupling || passivity; }
  };

  DevicePort(const Settings& settings, std::size_t probes);

  // To be called when the positions of a frame have been read: its touches get the tools' places,
  // and its ports what was read.
  void read(Frame& frame);
  // To be called before the forces of a frame go out: its ports get the damping.
  void send(Frame& frame);

  // Additions and multiplications of read() and of the last send().
  double read_operations() const {
    return (wall_ ? host::VirtualTool::kWallOperations : host::VirtualTool::kOperations) *
           static_cast<double>(tools_.size());
  }
  double send_operations() const { return send_operations_; }

  // One a probe; empty without the effect.
  const std::vector<host::VirtualTool>& tools() const { return tools_; }
  const std::vector<host::PassivityController>& controllers() const { return controllers_; }

 private:
  std::optional<host::Wall> wall_;
  std::vector<host::VirtualTool> tools_;
  std::vector<host::PassivityController> controllers_;
  std::vector<Eigen::Vector3d> newest_;  // positions read last; a pipeline sends an older frame's
  std::vector<Eigen::Vector3d> forces_;  // on the body, of the frame that was sent last
  double send_operations_ = 0;
};

}  // namespace hvp::vp
