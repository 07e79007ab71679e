// How long a partition's row waits for the vector unit, at every edge of products in which many
// partitions share few lanes.
#include <algorithm>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/vp/engine/engine_systems.h"
#include "vp/fpga/engine/cycle_engine.h"

namespace hvp::vp::engine::fairness_test {
namespace {

class Waits : public sc_core::sc_module {
 public:
  Waits(const sc_core::sc_module_name& name, const CycleEngine& engine)
      : sc_module(name), engine_(engine), heads_(index(engine.architecture().partitions)) {
    SC_HAS_PROCESS(Waits);
    SC_METHOD(clocked);
    sensitive << engine.clock().edge();
    dont_initialize();
  }

  std::int64_t longest() const { return longest_; }
  std::int64_t taken() const { return taken_; }

 private:
  struct Head {
    bool there = false;
    std::uint32_t taken = 0;
    std::int64_t edges = 0;
  };

  static std::size_t index(int partition) { return static_cast<std::size_t>(partition); }

  void clocked() {
    for (int i = 0; i < engine_.architecture().partitions; ++i) {
      Head& head = heads_[index(i)];
      const SpmxvBlock& block = engine_.block(i);
      const std::uint32_t taken = block.taken->read();
      if (taken != head.taken) ++taken_;
      head.edges = head.there && taken == head.taken ? head.edges + 1 : 0;
      head.there = block.finished.read() != taken;
      head.taken = taken;
      longest_ = std::max(longest_, head.edges);
    }
  }

  const CycleEngine& engine_;
  std::vector<Head> heads_;
  std::int64_t longest_ = 0;
  std::int64_t taken_ = 0;
};

struct Watched {
  std::unique_ptr<CycleEngine> engine;
  std::unique_ptr<Waits> waits;
};

TEST(Collection, NoRowWaitsAsLongAsThereArePartitions) {
  const fixed::QuantisedMatrix matrix = fixed::quantise(test::box_stiffness(9, 6, 5), 12);
  // SystemC elaborates once: all of them are there before the first one runs.
  std::vector<Watched> engines;
  for (const int partitions : {5, 16}) {
    for (const int lanes : {1, 2, 4}) {
      accel::Architecture architecture;
      architecture.partitions = partitions;
      architecture.nodes_per_clock = lanes;
      architecture.package = 24;
      const std::string number = std::to_string(engines.size());
      auto engine = std::make_unique<CycleEngine>(("engine_" + number).c_str(), architecture);
      auto waits = std::make_unique<Waits>(("waits_" + number).c_str(), *engine);
      engines.push_back({std::move(engine), std::move(waits)});
    }
  }
  fixed::Settings settings;
  settings.iterations = 3;
  for (const auto& [engine, waits] : engines) {
    engine->load(matrix, settings);
    engine->write_b(test::random_words(matrix.rows(), 3000, 7));
    engine->start_solve(settings);
    sc_core::sc_start();
    const int partitions = engine->architecture().partitions;
    const int lanes = engine->architecture().nodes_per_clock;
    EXPECT_LT(waits->longest(), partitions) << lanes << " lanes";
    EXPECT_EQ(waits->taken(), 4 * matrix.block_rows());
    // They do compete.
    if (partitions == 16) {
      EXPECT_GE(waits->longest(), lanes == 4 ? 4 : 8);
    }
  }
}

}  // namespace
}  // namespace hvp::vp::engine::fairness_test
