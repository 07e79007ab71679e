// Temporal decoupling never moves an observable: every span of every frame is the same whatever the
// quantum, and so are the numbers.
#include <algorithm>
#include <bit>
#include <cstdint>
#include <string>
#include <systemc>
#include <tuple>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "models/random/distribution.h"
#include "tests/vp/child_output.h"
#include "tests/vp/small_scene.h"
#include "tests/vp/stimulus.h"
#include "vp/host/board_access.h"

namespace hvp::vp::quantum_test {
namespace {

using test::kMs;
using test::kNs;
using test::kUs;
using test::SmallScene;

random::TimeDistribution uniform(double longest_s) {
  random::TimeDistribution d;
  d.kind = random::TimeDistribution::Kind::uniform;
  d.maximum_s = longest_s;
  return d;
}

enum class Case {
  plain,
  pipelined,
  one_core,
  shared_bus,
  overloaded,
  no_board,
  posted,
  polling,
  dma,
  pipelined_dma,
  pcie,
};

SmallScene make(Case which) {
  SmallScene::Options options;
  options.dynamics = fem::Dynamics{};
  if (which == Case::no_board) options.solved_by = host::SolvedBy::cg;
  return SmallScene(options);
}

void prepare(SmallScene& scene, Case which) {
  PlatformSettings& s = scene.settings;
  s.frames = 60;
  scene.slide(0.1);
  // The collision process has to look often, so that both processes meet at odd times.
  s.host.graphics.rate_hz = 333;
  s.host.graphics.drawing_s = 1e-3;
  switch (which) {
    case Case::plain:
    case Case::no_board:
      break;
    case Case::pipelined:
      s.host.pipeline_depth = 1;
      s.budget = 2 * s.period;
      break;
    case Case::one_core:
      s.host.cores = 1;
      s.host.graphics.non_preemptible_s = 50e-6;
      s.host.wake_up = uniform(30e-6);
      s.host.jitter = uniform(20e-6);
      break;
    case Case::shared_bus: {
      s.fidelity.bus = Timing::approximately_timed;
      BusTraffic traffic;
      traffic.period_s = 41e-6;
      s.bus.traffic = traffic;
      break;
    }
    case Case::posted:
      s.bus.posted_writes.emplace();
      break;
    case Case::polling:
      s.transfer.notification = link::Notification::polling;
      s.transfer.poll_interval_s = 1e-6;
      break;
    case Case::pipelined_dma:
      s.host.pipeline_depth = 1;
      s.budget = 2 * s.period;
      [[fallthrough]];
    case Case::dma:
      s.fidelity.bus = Timing::approximately_timed;
      s.bus.posted_writes.emplace();
      s.transfer.method = Transfer::Method::dma;
      s.transfer.notification = link::Notification::msi;
      break;
    case Case::pcie:
      s.fidelity.bus = Timing::approximately_timed;
      s.bus.pcie.emplace();
      s.transfer.method = Transfer::Method::dma;
      s.transfer.notification = link::Notification::msi;
      break;
    case Case::overloaded:
      s.host.sustained_rate_flops = 20e6;
      break;
  }
}

struct Result {
  std::vector<std::int64_t> frames;  // each span's and frame's numbers
  std::int64_t deltas = 0;           // of the kernel
};

void append(std::vector<std::int64_t>& to, const Frame& f) {
  for (const Span& s : f.spans) {
    to.insert(to.end(), {static_cast<std::int64_t>(s.part), static_cast<std::int64_t>(s.phase),
                         s.start, s.end, s.cause});
  }
  to.insert(to.end(), {f.number, f.born, f.force_at_motor, f.work_done, f.contact_age,
                       f.touch().contact.node, f.flags});
  for (int i = 0; i < 3; ++i) to.push_back(std::bit_cast<std::int64_t>(f.touch().force[i]));
}

Result simulate(Case which, Picoseconds quantum) {
  SmallScene scene = make(which);
  prepare(scene, which);
  scene.settings.host.quantum_s = static_cast<double>(quantum) * 1e-12;
  const test::Simulated run(scene);
  Result result;
  for (const Frame& f : run.log.frames) append(result.frames, f);
  result.frames.push_back(run.platform.verdict().misses());
  result.frames.push_back(run.platform.collision()->passes());
  result.deltas = static_cast<std::int64_t>(sc_core::sc_delta_count());
  return result;
}

std::vector<std::int64_t> numbers(const std::string& bytes) {
  std::vector<std::int64_t> result(bytes.size() / sizeof(std::int64_t));
  std::copy(bytes.begin(), bytes.end(), reinterpret_cast<char*>(result.data()));
  return result;
}

class Quantum : public testing::TestWithParam<std::tuple<Case, Picoseconds>> {};

TEST_P(Quantum, MovesNoSpanAndNoNumber) {
  const Case which = std::get<0>(GetParam());
  const Picoseconds quantum = std::get<1>(GetParam());
  const std::vector<std::int64_t> without = numbers(test::output_of_child([which](std::string& to) {
    Result r = simulate(which, 0);
    r.frames.push_back(r.deltas);
    to.assign(reinterpret_cast<const char*>(r.frames.data()),
              r.frames.size() * sizeof(r.frames[0]));
  }));
  ASSERT_GT(without.size(), 60U * 5U);
  Result with = simulate(which, quantum);
  // It does something: the kernel has less to do.
  if (quantum >= 100 * kUs) {
    EXPECT_LT(with.deltas, without.back());
  }
  with.frames.push_back(without.back());
  EXPECT_EQ(with.frames, without);
}

std::string case_name(const testing::TestParamInfo<Quantum::ParamType>& info) {
  static constexpr const char* kNames[] = {"plain",      "pipelined",     "one_core", "shared_bus",
                                           "overloaded", "no_board",      "posted",   "polling",
                                           "dma",        "pipelined_dma", "pcie"};
  return std::string(kNames[static_cast<int>(std::get<0>(info.param))]) + "_" +
         std::to_string(std::get<1>(info.param) / kNs) + "ns";
}

INSTANTIATE_TEST_SUITE_P(
    Sweep, Quantum,
    testing::Combine(testing::Values(Case::plain, Case::pipelined, Case::one_core, Case::shared_bus,
                                     Case::overloaded, Case::no_board, Case::posted, Case::polling,
                                     Case::dma, Case::pipelined_dma, Case::pcie),
                     testing::Values(1 * kNs, 1 * kUs, 17 * kUs, 100 * kUs, 1 * kMs, 2 * kMs)),
    case_name);

class Process : public sc_core::sc_module {
 public:
  explicit Process(const sc_core::sc_module_name& name) : sc_module(name) {
    SC_HAS_PROCESS(Process);
    SC_THREAD(run);
  }
  std::vector<std::pair<Picoseconds, Picoseconds>> kernel_and_local;

 private:
  void run() {
    LocalTime time;
    time.restart();
    const auto note = [&] { kernel_and_local.emplace_back(now_ps(), time.now()); };
    time.advance(4 * kUs);
    note();
    time.advance(5 * kUs);
    note();
    time.advance(2 * kUs);
    note();
    time.advance(1 * kUs);
    note();
    time.synchronise();
    note();
  }
};

TEST(LocalTime, RunsAheadOfTheKernelUntilTheQuantumIsOverOrSomebodySynchronises) {
  LocalTime::set_quantum(10 * kUs);
  const Process process("process");
  sc_core::sc_start();
  const std::vector<std::pair<Picoseconds, Picoseconds>> expected = {
      {0, 4 * kUs}, {0, 9 * kUs}, {11 * kUs, 11 * kUs}, {11 * kUs, 12 * kUs}, {12 * kUs, 12 * kUs}};
  EXPECT_EQ(process.kernel_and_local, expected);
}

}  // namespace
}  // namespace hvp::vp::quantum_test
