#pragma once

#include <functional>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "driver/hvp_driver.h"
#include "models/fixed/reference_solver.h"
#include "tests/vp/board_master.h"
#include "tests/vp/expected_time.h"
#include "tests/vp/small_scene.h"
#include "tests/vp/stimulus.h"
#include "vp/bus/host_memory.h"
#include "vp/fpga/accelerator.h"
#include "vp/host/board_access.h"
#include "vp/host/driver_port.h"
#include "vp/pci/pci_bus.h"

namespace hvp::test {

// A board for the small scene's matrix, and who drives it: a script at its registers, or the driver
// over a PCI bus. SystemC elaborates once in a process, so there is one of them in a test.
class BoardRig {
 protected:
  void build(const accel::Architecture& architecture = {},
             vp::Timing level = vp::Timing::loosely_timed, const vp::MasterSettings& master = {}) {
    accelerator_ = std::make_unique<vp::Accelerator>("accelerator", architecture, level, ledger_,
                                                     nullptr, vp::Numbers::fixed, master);
  }
  void build_bus() { bus_ = std::make_unique<vp::PciBus>("bus", link::Pci{}, false, ledger_); }

  // The script's accesses reach the board's registers at once. Somebody else observes its line.
  void run_at_registers(const std::function<void(Stimulus&, BoardMaster&)>& script) {
    stimulus_ = std::make_unique<Stimulus>("stimulus", [&](Stimulus& s) {
      BoardMaster master(s);
      script(s, master);
      finished_ = true;
      sc_core::sc_stop();
    });
    stimulus_->to_target.bind(accelerator_->from_bus);
    start();
  }
  // The same, with the board's line observed.
  void run_with_line(const std::function<void(Stimulus&, BoardMaster&)>& script) {
    line_ = std::make_unique<LineProbe>("line");
    accelerator_->interrupt.bind(*line_);
    run_at_registers(script);
  }
  // The driver's program on a host, a bus and the board.
  void run_driver(vp::Picoseconds interrupt_latency, const std::function<void(Program&)>& script) {
    build_bus();
    build();
    access_ = std::make_unique<vp::BoardAccess>("access");
    port_ = std::make_unique<vp::DriverPort>(*access_, interrupt_latency, ledger_);
    access_->to_bus.bind(bus_->from_host);
    bus_->attach(accelerator_->from_bus, vp::kSolverBase, vp::kBarBytes);
    accelerator_->interrupt.bind(*access_);
    program_ = std::make_unique<Program>("program", [&](Program& p) {
      script(p);
      finished_ = true;
    });
    start();
    EXPECT_EQ(accelerator_->illegal_accesses(), 0);
  }

  void load_matrix(const fixed::QuantisedMatrix& k) {
    const hvp_matrix matrix{static_cast<std::uint32_t>(k.block_rows()),
                            static_cast<std::uint32_t>(k.column.size()), k.row_begin.data(),
                            k.column.data(), k.value.data()};
    ASSERT_EQ(hvp_load_matrix(&device_, &matrix), HVP_OK);
  }

  const fixed::QuantisedMatrix& k() const { return scene_.computation.board().matrix(); }
  vp::Picoseconds solve_time(int iterations = 60) const {
    return test::solve_time(k().row_begin, iterations);
  }
  // From zero.
  std::vector<std::int32_t> solution(const std::vector<std::int32_t>& b,
                                     const fixed::Settings& settings = {}) const {
    std::vector<std::int32_t> u(SmallScene::kUnknowns, 0);
    fixed::ReferenceSolver(settings).solve(k(), {b, u});
    return u;
  }

  SmallScene scene_;
  vp::Ledger ledger_;
  std::unique_ptr<vp::PciBus> bus_;
  std::unique_ptr<vp::Accelerator> accelerator_;
  std::unique_ptr<LineProbe> line_;
  std::unique_ptr<Stimulus> stimulus_;
  std::unique_ptr<vp::BoardAccess> access_;
  std::unique_ptr<vp::DriverPort> port_;
  std::unique_ptr<Program> program_;
  hvp_device device_{};

 private:
  void start() {
    sc_core::sc_start();
    EXPECT_TRUE(finished_);
  }

  bool finished_ = false;
};

}  // namespace hvp::test
