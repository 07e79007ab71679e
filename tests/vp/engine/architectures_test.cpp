// The levels' clocks over the whole range of every key of [accelerator], and over architectures
// that nobody would build: the cycle-accurate engine is the measure.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "models/accel/architecture.h"
#include "models/config/effects.h"
#include "models/config/input_error.h"
#include "tests/fixed/elastic_box.h"
#include "tests/vp/engine/engine_systems.h"
#include "tests/vp/engine/levels.h"
#include "vp/fpga/engine/phase_engine.h"

namespace hvp::vp::engine::architectures_test {
namespace {

using accel::Architecture;
using fixed::Settings;
using fixed::test::Random;
using test::Levels;

// What the loosely-timed level promises, in %. The approximately-timed one is exact.
constexpr double kLooseBound = 1.0;

// Depths that do not leave the vector unit a clock are refused: a change of one takes the others'
// sum along.
void deepen(Architecture& a) {
  a.pipeline_clocks = std::max(
      a.pipeline_clocks, a.memory_read_clocks + a.multiplier_clocks + a.adder_tree_clocks + 1);
}

// Goes through the declaration of an architecture and gives one key one of its values.
class OneKey : public config::QuietVisitor {
 public:
  using config::QuietVisitor::integer;
  // Of the key's values the `number`th of those that values() spreads over its range.
  OneKey(std::string key, std::size_t number) : key_(std::move(key)), number_(number) {}

  void integer(std::string_view name, std::int64_t& value, config::IntegerRange range,
               config::Note) override {
    if (const std::vector<std::int64_t> all = values(range); is(name) && number_ < all.size()) {
      set(std::to_string(value = all[number_]));
    }
  }
  void boolean(std::string_view name, bool& value, config::Note) override {
    if (is(name) && number_ < 2) set((value = number_ != 0) ? "true" : "false");
  }
  void choice_index(std::string_view name, std::size_t& index,
                    const std::vector<std::string_view>& names, config::Note) override {
    if (is(name) && number_ < names.size()) set(std::string(names[index = number_]));
  }

  // Every key that has whole numbers or names for values.
  const std::set<std::string>& keys() const { return keys_; }
  // Empty where the key has fewer values.
  const std::string& value() const { return value_; }

  // Its ends, every number up to 17, and odd and even ones between, closer together where they are
  // small.
  static std::vector<std::int64_t> values(const config::IntegerRange& range) {
    std::set<std::int64_t> all = {range.min, range.max, range.max - 1};
    for (std::int64_t v = range.min; v <= std::min<std::int64_t>(17, range.max); ++v) all.insert(v);
    for (std::int64_t v = 20; v < range.max; v += v / 3) all.insert(v);
    return {all.begin(), all.end()};
  }

 private:
  bool is(std::string_view name) {
    keys_.emplace(name);
    return name == key_;
  }
  void set(std::string value) { value_ = std::move(value); }

  std::string key_;
  std::size_t number_;
  std::set<std::string> keys_;
  std::string value_;
};

struct Named {
  std::string name;
  Architecture architecture;
};

// Each key over its range, all others at their defaults.
std::vector<Named> one_key_changed() {
  OneKey keys("", 0);
  Architecture thesis;
  thesis.declare(keys);
  std::vector<Named> all;
  for (const std::string& key : keys.keys()) {
    for (std::size_t number = 0;; ++number) {
      Architecture a;
      OneKey one(key, number);
      a.declare(one);
      if (one.value().empty()) break;
      if (a.matrix_storage == accel::MatrixStorage::symmetric) continue;  // has no engine
      if (key != "pipeline_clocks") deepen(a);
      all.push_back({key + " = " + one.value(), a});
    }
  }
  return all;
}

// From 1 to `most`, small numbers as likely as large ones.
int spread(Random& random, int most) {
  int bits = 0;
  while (most >> bits > 1) ++bits;
  const int scale = 1 << random.below(bits + 1);
  return std::min(most, scale + random.below(scale));
}

Architecture random_architecture(Random& random) {
  // Now and then all keys at once, mostly a few.
  const int share = random.below(3) == 0 ? 1 : 3;
  const auto drawn = [&](int& value, int most) {
    if (random.below(share) == 0) value = spread(random, most);
  };
  Architecture a;
  drawn(a.rows_in_parallel, 3);
  drawn(a.package, 64);
  drawn(a.partitions, 256);
  drawn(a.nodes_per_clock, 64);
  drawn(a.memory_read_clocks, 100);
  drawn(a.multiplier_clocks, 100);
  drawn(a.adder_tree_clocks, 100);
  drawn(a.division_clocks, 1000);
  drawn(a.result_queue, 1024);
  drawn(a.direction_banks, 64);
  a.direction_memory = static_cast<accel::DirectionMemory>(random.below(3));
  a.absolute_value_register = random.below(2) == 1;
  a.pipeline_clocks =
      a.memory_read_clocks + a.multiplier_clocks + a.adder_tree_clocks + spread(random, 300);
  return a;
}

std::string describe(const Architecture& a) {
  const auto number = [](const char* name, int value) {
    return std::string(name) + " " + std::to_string(value) + ", ";
  };
  return number("PL1", a.rows_in_parallel) + number("PL2", a.package) +
         number("PL3", a.partitions) + number("L", a.nodes_per_clock) +
         number("read", a.memory_read_clocks) + number("multiplier", a.multiplier_clocks) +
         number("adders", a.adder_tree_clocks) + number("pipeline", a.phase_clocks()) +
         number("division", a.division_clocks) + number("queue", a.result_queue) +
         number("d", static_cast<int>(a.direction_memory)) + number("banks", a.direction_banks) +
         number("s", a.packages_per_row);
}

struct Engines {
  std::string name;
  std::unique_ptr<CycleEngine> cycles;
  std::unique_ptr<PhaseEngine> phases;
};

// SystemC elaborates once: all of them are there before the first one runs.
std::vector<Engines> build(const std::vector<Named>& architectures) {
  std::vector<Engines> engines;
  for (const Named& one : architectures) {
    const std::string number = std::to_string(engines.size());
    engines.push_back(
        {one.name, std::make_unique<CycleEngine>(("cycles_" + number).c_str(), one.architecture),
         std::make_unique<PhaseEngine>(("phases_" + number).c_str(), one.architecture)});
  }
  return engines;
}

void expect_agreement(const Levels& levels) {
  EXPECT_EQ(levels.approximately_timed, levels.cycle_accurate);
  EXPECT_LE(std::abs(levels.loose_error()), kLooseBound)
      << levels.loosely_timed << " clocks for " << levels.cycle_accurate;
}

// What an architecture says of its own keys.
bool admitted(const Architecture& a) {
  try {
    a.check();
  } catch (const InputError&) {
    return false;
  }
  return true;
}

// Every engine of a process ticks while one of them solves: in parts, each a process of its own.
constexpr int kParts = 12;

template <class Item>
std::vector<Item> part_of(const std::vector<Item>& all, int part) {
  std::vector<Item> some;
  for (auto i = static_cast<std::size_t>(part); i < all.size(); i += kParts) some.push_back(all[i]);
  return some;
}

class AgreementOverArchitectures : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Part, AgreementOverArchitectures, testing::Range(0, kParts));

TEST_P(AgreementOverArchitectures, OfEveryKeyOverItsRange) {
  const std::vector<test::NamedMatrix> meshes = test::mesh_set();
  const auto sphere = std::ranges::find(meshes, "sphere of 200", &test::NamedMatrix::name);
  ASSERT_NE(sphere, meshes.end());
  std::vector<Named> architectures = one_key_changed();
  ASSERT_GT(architectures.size(), 200U);
  // pipeline_clocks from 0 to 9, which leave nothing beside the other depths, and lanes, banks and
  // places of a queue that are no power of two.
  const auto power_of_two = [](int value) {
    return std::has_single_bit(static_cast<unsigned>(value));
  };
  std::erase_if(architectures, [&](const Named& one) {
    const Architecture& a = one.architecture;
    const bool whole = power_of_two(a.nodes_per_clock) && power_of_two(a.direction_banks) &&
                       power_of_two(a.result_queue);
    EXPECT_EQ(admitted(a), whole && a.pipeline_clocks > 9) << one.name;
    return !admitted(a);
  });
  ASSERT_GT(architectures.size(), 150U);
  std::vector<Engines> engines = build(part_of(architectures, GetParam()));
  Settings settings;
  settings.iterations = 5;
  int too_short = 0;
  for (Engines& one : engines) {
    SCOPED_TRACE(one.name);
    try {
      expect_agreement(test::compare(*one.cycles, *one.phases, sphere->matrix, settings));
    } catch (const InputError& error) {
      // A row needs more packages than packages_per_row has.
      EXPECT_EQ(error.key(), "packages_per_row");
      ++too_short;
    }
  }
  EXPECT_LE(too_short, 9);
}

TEST_P(AgreementOverArchitectures, OfRandomOnes) {
  constexpr int kArchitectures = 156;
  const std::vector<test::NamedMatrix> meshes = test::mesh_set();
  Random random(20 + 2 * static_cast<unsigned>(GetParam()));
  std::vector<Named> architectures;
  for (int i = 0; i < kArchitectures / kParts; ++i) {
    const Architecture a = random_architecture(random);
    architectures.push_back({describe(a), a});
  }
  std::vector<Engines> engines = build(architectures);
  for (Engines& one : engines) {
    const test::NamedMatrix& mesh =
        meshes[static_cast<std::size_t>(random.below(static_cast<int>(meshes.size())))];
    SCOPED_TRACE(mesh.name + ": " + one.name);
    Settings settings;
    settings.iterations = 1 + random.below(10);
    settings.method = random.below(2) == 0 ? fixed::Method::cg : fixed::Method::block_jacobi_pcg;
    if (random.below(3) == 0) settings.replace_residual_every = 1 + random.below(4);
    if (random.below(3) == 0) settings.start = fixed::Start::extrapolated;
    expect_agreement(test::compare(*one.cycles, *one.phases, mesh.matrix, settings));
  }
}

// Systems of a few nodes, where a pipeline's depth and who is first in turn weigh most.
TEST_P(AgreementOverArchitectures, OfRandomOnesOverSmallSystems) {
  constexpr int kArchitectures = 156;
  std::vector<fixed::QuantisedMatrix> matrices;
  for (const int cells : {1, 2, 3}) {
    matrices.push_back(fixed::quantise(test::box_stiffness(cells, cells, 1), 12));
  }
  Random random(21 + 2 * static_cast<unsigned>(GetParam()));
  std::vector<Named> architectures;
  for (int i = 0; i < kArchitectures / kParts; ++i) {
    const Architecture a = random_architecture(random);
    architectures.push_back({describe(a), a});
  }
  std::vector<Engines> engines = build(architectures);
  for (Engines& one : engines) {
    const auto which = static_cast<std::size_t>(random.below(3));
    SCOPED_TRACE(std::to_string(matrices[which].block_rows()) + " nodes: " + one.name);
    Settings settings;
    settings.iterations = 1 + random.below(20);
    expect_agreement(test::compare(*one.cycles, *one.phases, matrices[which], settings));
  }
}

// The products of a second solve of three take other clocks than those of the first.
bool later_products_differ(const Architecture& a, const fixed::QuantisedMatrix& matrix) {
  const Layout layout(a, matrix.row_begin, matrix.column);
  const ProductClocks products = phase_clocks(a, layout).products;
  std::int64_t difference = 0;
  std::size_t product = 0;
  for (int i = 0; i < 6; ++i) {
    difference += (i < 3 ? -1 : 1) * products.clocks[product];
    product = products.after(product);
  }
  return difference != 0;
}

// Whose rows are first in turn is left from the product before, from one solve to the next; a
// reset, and a matrix that is loaded, begin with the first partition again.
TEST(AgreementOverArchitectures, OfSolvesThatFollowEachOtherAndAReset) {
  constexpr std::size_t kArchitectures = 30;
  const fixed::QuantisedMatrix matrix = fixed::quantise(test::box_stiffness(3, 3, 3), 12);
  Random random(22);
  std::vector<Named> architectures;
  while (architectures.size() < kArchitectures) {
    const Architecture a = random_architecture(random);
    if (!later_products_differ(a, matrix)) continue;
    architectures.push_back({describe(a), a});
  }
  std::vector<Engines> engines = build(architectures);
  Settings settings;
  settings.iterations = 2;
  const std::vector<std::int32_t> b = test::random_words(matrix.rows(), 2000, 3);
  int left_over = 0;  // where the solve behind another takes other clocks than the first
  for (Engines& one : engines) {
    SCOPED_TRACE(one.name);
    const auto again = [&] {
      one.cycles->write_b(b);
      one.cycles->start_solve(settings);
      sc_core::sc_start();
      one.phases->start_solve(settings, one.cycles->report());
      sc_core::sc_start();
      EXPECT_EQ(one.phases->clocks(), one.cycles->clocks());
      return one.cycles->clocks();
    };
    const std::int64_t first =
        test::compare(*one.cycles, *one.phases, matrix, settings).cycle_accurate;
    const std::int64_t second = again();
    one.cycles->abort();
    one.phases->abort();
    const std::int64_t after_a_reset = again();
    EXPECT_EQ(after_a_reset, first);
    if (second != first) ++left_over;
    again();
    expect_agreement(test::compare(*one.cycles, *one.phases, matrix, settings));
  }
  EXPECT_EQ(left_over, static_cast<int>(kArchitectures)) << "nothing that a reset could put right";
}

}  // namespace
}  // namespace hvp::vp::engine::architectures_test
