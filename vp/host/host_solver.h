#pragma once

#include "models/host/frame_computation.h"
#include "models/host/host_solve.h"
#include "vp/host/frame_solver.h"

namespace hvp::vp {

// There is no board: the servo process solves, on its own core. Each step costs its operations at
// the rate of host.solver_rate.
class HostSolver : public FrameSolver {
 public:
  // Keeps references.
  HostSolver(host::FrameComputation& computation, const Work& work)
      : computation_(computation), work_(work) {}

  hvp_status set_up_piece(bool& done) override {
    computation_.set_contact({});
    done = true;
    return HVP_OK;
  }
  hvp_status move_contact(std::span<const int> nodes) override {
    computation_.set_contact(nodes);
    work_.spend(Phase::node_update, 0, scaled(computation_.on_host()->contact_operations()));
    return HVP_OK;
  }
  hvp_status begin(std::uint32_t& /*flags*/) override { return HVP_OK; }
  hvp_status end(std::uint32_t& /*flags*/) override {
    computation_.begin();
    computation_.method().next({});
    work_.spend(Phase::solve, 0, scaled(computation_.on_host()->operations()));
    return HVP_OK;
  }
  void finish(std::uint32_t& /*flags*/) override {}
  hvp_status close() override { return HVP_OK; }

 private:
  // In operations of the host's other steps.
  double scaled(double operations) const { return operations / work_.costs().solver_speed(); }

  host::FrameComputation& computation_;
  const Work& work_;
};

}  // namespace hvp::vp
