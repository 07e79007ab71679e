// The FST file of the RTL engine as a viewer reads it, beside the VCD file of the cycle-accurate
// one: the signals of one name have the same values at every clock.
#include <algorithm>
#include <cstring>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <gtkwave/fstapi.h>
#include <unistd.h>

#include "tests/vp/engine/random_systems.h"
#include "tests/vp/engine/rtl_pair.h"
#include "tests/vp/engine/value_changes.h"
#include "vp/fpga/engine/engine_trace.h"

namespace hvp::vp::rtl::rtl_waveform_test {
namespace {

using hvp::test::ValueChanges;
using test::Pair;
using test::Random;

struct Reader {
  explicit Reader(const std::filesystem::path& path) : fst(fstReaderOpen(path.c_str())) {}
  ~Reader() {
    if (fst != nullptr) fstReaderClose(fst);
  }
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;
  void* fst;
};

ValueChanges read_fst(const std::filesystem::path& path) {
  ValueChanges read;
  const Reader reader(path);
  if (reader.fst == nullptr) return read;
  read.timescale = std::to_string(static_cast<int>(fstReaderGetTimescale(reader.fst)));
  struct Variable {
    std::vector<std::string> names;
    bool real = false;
  };
  struct State {
    std::map<fstHandle, Variable> variables;
    ValueChanges* read;
  } state{{}, &read};
  std::vector<std::string> scope;
  while (const fstHier* entry = fstReaderIterateHier(reader.fst)) {
    if (entry->htyp == FST_HT_SCOPE) {
      scope.emplace_back(entry->u.scope.name);
    } else if (entry->htyp == FST_HT_UPSCOPE) {
      scope.pop_back();
    } else if (entry->htyp == FST_HT_VAR) {
      std::string full;
      for (const std::string& part : scope) full += part + ".";
      // Without the range.
      const std::string name = entry->u.var.name;
      full += name.substr(0, name.find(' '));
      Variable& variable = state.variables[entry->u.var.handle];
      variable.names.push_back(full);
      variable.real = entry->u.var.typ == FST_VT_VCD_REAL;
      read.changes[full];
    }
  }
  fstReaderSetFacProcessMaskAll(reader.fst);
  fstReaderIterBlocksSetNativeDoublesOnCallback(reader.fst, 1);
  const auto change = [](void* data, std::uint64_t time, fstHandle handle,
                         const unsigned char* value) {
    const auto& found = *static_cast<State*>(data);
    const Variable& variable = found.variables.at(handle);
    double number = 0;
    if (variable.real) {
      std::memcpy(&number, value, sizeof number);
    } else {
      number = hvp::test::signed_value(reinterpret_cast<const char*>(value));
    }
    for (const std::string& name : variable.names) {
      found.read->changes[name].emplace_back(static_cast<std::int64_t>(time), number);
    }
  };
  fstReaderIterBlocks(reader.fst, change, &state, nullptr);
  return read;
}

// Ends each solve where a board does, at the instant of its last clock.
class Ends : public sc_core::sc_module {
 public:
  Ends(const sc_core::sc_module_name& name, Pair& pair) : sc_module(name), pair_(pair) {
    SC_HAS_PROCESS(Ends);
    SC_METHOD(end);
    sensitive << pair.engine.done();
    dont_initialize();
  }

 private:
  void end() {
    pair_.both.end_solve();
    times.insert(static_cast<std::int64_t>(sc_core::sc_time_stamp().value()));
  }
  Pair& pair_;

 public:
  std::set<std::int64_t> times;
};

TEST(RtlWaveform, HasTheValuesOfTheCycleAccurateOneUnderTheSameNames) {
  const std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("hvp_rtl_waveform_" + std::to_string(::getpid()));
  const std::string fst_path = path.string() + ".fst";
  Random random(12);
  const fixed::QuantisedMatrix matrix = hvp::test::random_matrix(40, 9, 12, random);
  fixed::Settings settings = test::settings_of(kEngineThesis);
  settings.iterations = 3;
  settings.replace_residual_every = 2;
  std::int64_t begin = 0, end = 0;
  std::set<std::int64_t> last_edges;
  {
    Pair pair(kEngineThesis);
    Ends ends("ends", pair);
    const engine::TraceWindow window{[&] { return pair.engine.jobs(); }, 2, 2};
    const engine::EngineTrace trace("trace", pair.engine, path.string(), window);
    pair.both.open_waveform(fst_path, window);
    pair.load(matrix, settings);
    pair.write_b(hvp::test::random_words(matrix.rows(), 3000, 5));
    for (int job = 1; job <= 3; ++job) {
      if (job == 2) begin = static_cast<std::int64_t>(sc_core::sc_time_stamp().value());
      pair.start(settings);
      sc_core::sc_start();
      if (job == 2) {
        pair.write_x(test::words(matrix.rows(), 16, random));
        sc_core::sc_start();
        end = static_cast<std::int64_t>(sc_core::sc_time_stamp().value());
      }
    }
    EXPECT_EQ(pair.both.difference(), "");
    pair.both.close_waveform();
    last_edges = ends.times;
  }
  const ValueChanges vcd = hvp::test::read_vcd(path.string() + ".vcd");
  const ValueChanges fst = read_fst(fst_path);
  std::filesystem::remove(path.string() + ".vcd");
  std::filesystem::remove(fst_path);
  EXPECT_EQ(fst.timescale, "-12");
  ASSERT_GT(end, begin);

  const std::string top = "SystemC.engine.";
  // A solve forms these; until then each engine has what it began with.
  const std::set<std::string> formed = {
      top + "sequencer.z_r_value",   top + "sequencer.r_exponent",  top + "sequencer.d_exponent",
      top + "vector_unit.r_x_value", top + "vector_unit.z_x_value", top + "vector_unit.d_x_value"};
  const std::set<std::string> orders = {top + "sequencer.state.idle", top + "sequencer.state.copy"};
  std::int64_t first_direction = 0;
  for (const auto& [time, value] : vcd.changes.at(top + "sequencer.state.first_direction")) {
    if (value == 1) first_direction = time;
  }
  ASSERT_GT(first_direction, begin);
  int shared = 0;
  std::int64_t compared = 0;
  for (const auto& [name, changes] : fst.changes) {
    if (!name.starts_with("SystemC.")) continue;
    ASSERT_TRUE(vcd.changes.contains(name)) << name;
    ++shared;
    // Walks through both side by side.
    const ValueChanges::Changes& other = vcd.changes.at(name);
    // z·r, and r·r with it, comes later with a preconditioner.
    const bool late = name.ends_with("z_r_value") && settings.preconditioned();
    const std::int64_t behind = late ? 10'000 * std::max(0, 24 - kEngineThesis.phase_clocks) : 0;
    std::size_t i = 0, j = 0;
    for (std::int64_t time = begin + 10'000; time <= end; time += 10'000) {
      while (i + 1 < changes.size() && changes[i + 1].first <= time) ++i;
      while (j + 1 < other.size() && other[j + 1].first <= time - behind) ++j;
      if (formed.contains(name) && time < first_direction + behind) continue;
      // The order to copy x, which the RTL engine gets behind a solve's last clock, is part of that
      // clock in the other.
      if (orders.contains(name) && last_edges.contains(time)) continue;
      ++compared;
      const double tolerance = 1e-5 * std::abs(other[j].second);  // of a VCD file's numbers
      ASSERT_NEAR(changes[i].second, other[j].second, name.ends_with("_value") ? tolerance : 0)
          << name << " at clock " << (time - begin) / 10'000;
    }
  }
  std::printf("%d signals of one name, %lld values\n", shared, static_cast<long long>(compared));
  EXPECT_EQ(shared, 4 + 13 + 4 + 2 + 3 * kEngineThesis.partitions + 12);
  // Nothing but the second job, and the copy of x that the host then wrote.
  for (const auto& [time, value] : fst.changes.at(top + "clock_edge")) {
    EXPECT_TRUE(time > begin && time <= end) << time;
  }
  EXPECT_EQ(static_cast<std::int64_t>(fst.changes.at(top + "clock_edge").size()),
            (end - begin) / 10'000);
  // The RTL engine's own signals.
  EXPECT_GT(fst.changes.at("TOP.engine.state_number").size(), 20U);
  EXPECT_TRUE(fst.changes.contains("TOP.engine.matrix.g_partition[4].spmxv.position"));
}

TEST(RtlWaveform, IsThereWithoutAnEdge) {
  const std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("hvp_rtl_no_edge_" + std::to_string(::getpid()));
  Pair pair(kEngineThesis);
  const engine::TraceWindow window{[] { return 0; }, 0, 0};
  pair.both.open_waveform(path.string(), window);
  EXPECT_FALSE(std::filesystem::exists(path));
  pair.both.close_waveform();
  const ValueChanges fst = read_fst(path);
  std::filesystem::remove(path);
  EXPECT_TRUE(fst.changes.contains("SystemC.engine.clock_edge"));
  EXPECT_TRUE(fst.changes.contains("TOP.engine.clock"));
}

}  // namespace
}  // namespace hvp::vp::rtl::rtl_waveform_test
