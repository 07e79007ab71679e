#include <algorithm>
#include <functional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "models/config/input_error.h"
#include "vp/fpga/rtl/engine_sizes.h"
#include "vp/fpga/rtl/rtl_engine.h"

namespace hvp::vp::rtl::rtl_sizes_test {
namespace {

using accel::Architecture;
using accel::DirectionMemory;
using fixed::Method;
using fixed::Settings;

// The thesis' engine, changed.
struct Design {
  Architecture a;
  Settings s;
  Room room{.nodes = 500, .packages = 400};

  EngineSize wanted() const { return wanted_size(a, s, room); }
};

using Change = std::function<void(Design&)>;

Design changed(const Change& change) {
  Design design;
  change(design);
  return design;
}

// Each of these makes another engine of it.
const std::vector<Change>& other_engines() {
  static const std::vector<Change> all = {
      [](Design& d) { d.a.partitions = 4; },
      [](Design& d) { d.a.package = 7; },
      [](Design& d) { d.a.nodes_per_clock = 1; },
      [](Design& d) { d.a.pipeline_clocks = 21; },
      [](Design& d) { d.a.absolute_value_register = true; },
      [](Design& d) { d.a.division_clocks = 69; },
      [](Design& d) { d.a.result_queue = 8; },
      [](Design& d) { d.a.rows_in_parallel = 1; },
      [](Design& d) { d.a.direction_banks = 2; },
      [](Design& d) { d.a.direction_memory = DirectionMemory::two_copies; },
      [](Design& d) { d.a.direction_memory = DirectionMemory::stall; },
      [](Design& d) { d.s.matrix_bits = 13; },
      [](Design& d) { d.s.vector_bits = 15; },
      [](Design& d) { d.s.coefficient_bits = 15; },
      [](Design& d) { d.s.method = Method::block_jacobi_pcg; },
      [](Design& d) { d.s.scaling_step = 2; },
      [](Design& d) { d.s.static_shift = 16; },
      [](Design& d) { d.room.nodes = 1025; },
      [](Design& d) { d.room.packages = 2049; },
  };
  return all;
}

TEST(RtlSizes, TheThesisSizeServesWhateverIsAsLargeOrSmaller) {
  const std::vector<Change> served = {
      [](Design&) {},
      [](Design& d) { d.a.division_clocks = 68; },
      [](Design& d) { d.room = {.nodes = 1024, .packages = 2048}; },
      [](Design& d) { d.room = {.nodes = 0, .packages = 0}; },
      [](Design& d) { d.room = {.nodes = 1, .packages = 1}; },
      [](Design& d) { d.s.static_shift = 15; },
      [](Design& d) { d.s.method = Method::jacobi_pcg; },
      [](Design& d) { d.a.clock_hz = 1e6; },
  };
  for (const Change& change : served) {
    EXPECT_EQ(find_size(changed(change).wanted()), &kEngineThesis);
  }
}

TEST(RtlSizes, EachParameterIsAskedForAndHasAPlaceInTheName) {
  std::set<std::string> names{identifier(Design().wanted())};
  std::set<std::string> texts{parameters(Design().wanted())};
  for (const Change& change : other_engines()) {
    const EngineSize wanted = changed(change).wanted();
    SCOPED_TRACE(parameters(wanted));
    // What only this build's user has asked for serves too.
    EXPECT_NE(find_size(wanted), &kEngineThesis);
    names.insert(identifier(wanted));
    texts.insert(parameters(wanted));
  }
  // A register in front of the multiplier is a clock of the pipeline.
  EXPECT_EQ(names.size(), other_engines().size());
  EXPECT_EQ(texts.size(), other_engines().size());
}

// The memories number as many as are asked for.
TEST(RtlSizes, AddressesHaveRoomForEveryNodeAndPackage) {
  for (int count = 1; count <= 3000; ++count) {
    const EngineSize size = changed([&](Design& d) { d.room = {count, count}; }).wanted();
    EXPECT_GE(1 << size.node_bits, count);
    EXPECT_GE(1 << size.package_bits, count);
    EXPECT_LT(1 << size.node_bits, std::max(65, 2 * count));
  }
  // A bank of d has two nodes at least, however few there are.
  for (int banks = 1; banks <= 1024; banks *= 2) {
    const EngineSize size = changed([&](Design& d) {
                              d.a.direction_banks = banks;
                              d.room = {1, 1};
                            }).wanted();
    EXPECT_GT(1 << size.node_bits, banks);
  }
  // As many bits of a shift with a preconditioner as without.
  const auto longest = [](Method method) {
    return changed([=](Design& d) {
             d.s.matrix_bits = 18;
             d.s.method = method;
           })
        .wanted()
        .static_bits;
  };
  EXPECT_EQ(longest(Method::jacobi_pcg), longest(Method::cg));
}

std::string refused(const Change& change) {
  const Design d = changed(change);
  try {
    require_buildable(d.a);
    require_buildable(d.s);
    require_buildable(d.a, d.s);
    require_buildable(d.room);
  } catch (const InputError& e) {
    return e.key();
  }
  return "";
}

TEST(RtlSizes, WhatNoSizeHasIsRefusedByKey) {
  for (const Change& change : other_engines()) EXPECT_EQ(refused(change), "");
  const std::vector<std::pair<std::string, Change>> all = {
      {"partitions", [](Design& d) { d.a.partitions = 17; }},
      {"package", [](Design& d) { d.a.package = 17; }},
      {"nodes_per_clock", [](Design& d) { d.a.nodes_per_clock = 8; }},
      {"direction_banks", [](Design& d) { d.a.nodes_per_clock = 4; }},
      {"result_queue", [](Design& d) { d.a.result_queue = 1; }},
      {"pipeline_clocks", [](Design& d) { d.a.pipeline_clocks = 18; }},
      {"pipeline_clocks", [](Design& d) { d.a.pipeline_clocks = 257; }},
      {"memory_read_clocks", [](Design& d) { d.a.memory_read_clocks = 3; }},
      {"multiplier_clocks", [](Design& d) { d.a.multiplier_clocks = 2; }},
      {"adder_tree_clocks", [](Design& d) { d.a.adder_tree_clocks = 5; }},
      {"rows_in_parallel",
       [](Design& d) {
         d.a.rows_in_parallel = 2;
         d.a.package = 11;
       }},
      {"rows_in_parallel",
       [](Design& d) {
         d.a.rows_in_parallel = 1;
         d.a.direction_memory = DirectionMemory::stall;
       }},
      {"method", [](Design& d) { d.s.method = Method::chronopoulos_gear; }},
      {"scalar_bits", [](Design& d) { d.s.scalar_bits = 128; }},
      {"overflow", [](Design& d) { d.s.overflow = fixed::Overflow::wrap; }},
      {"coefficient_format",
       [](Design& d) { d.s.coefficient_format = fixed::CoefficientFormat::fixed; }},
      {"scaling_down", [](Design& d) { d.s.scaling_down = false; }},
      {"static_shift", [](Design& d) { d.s.static_shift = 32; }},
      // Short coefficients leave the scaler less than it takes; Jacobi's sums come five clocks
      // late.
      {"division_clocks", [](Design& d) { d.s.coefficient_bits = 8; }},
      {"division_clocks",
       [](Design& d) {
         d.s.method = Method::jacobi_pcg;
         d.s.coefficient_bits = 12;
         d.a.pipeline_clocks = 19;
       }},
      // The look-up of a row in small packages leaves long words of P⁻¹ too little.
      {"division_clocks",
       [](Design& d) {
         d.s.method = Method::jacobi_pcg;
         d.s.coefficient_bits = 12;
         d.s.matrix_bits = 24;
         d.a.pipeline_clocks = 24;
         d.a.package = 4;
       }},
      {"division_clocks",
       [](Design& d) {
         d.s.method = Method::block_jacobi_pcg;
         d.s.matrix_bits = 14;
       }},
      {"nodes", [](Design& d) { d.room.nodes = (1 << 14) + 1; }},
      {"partitions", [](Design& d) { d.room.packages = (1 << 14) + 1; }},
  };
  for (const auto& [key, change] : all) EXPECT_EQ(refused(change), key);
}

}  // namespace
}  // namespace hvp::vp::rtl::rtl_sizes_test
