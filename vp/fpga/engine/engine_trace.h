#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <systemc>
#include <vector>

#include "vp/fpga/engine/cycle_engine.h"

namespace hvp::vp::engine {

// The window of a trace: the engine's work while `frame()` is between two frames.
struct TraceWindow {
  std::function<std::int64_t()> frame;  // asked at every edge
  std::int64_t first = 0;
  std::int64_t last = std::numeric_limits<std::int64_t>::max();
};

// A trace of the cycle-accurate engine as a VCD file (IEEE 1364) for GTKWave and Surfer: a wire for
// each state of the sequencer, the SpMxV blocks' positions and queues, and the words that lane 0 of
// the vector unit wrote last, as signed words (…_word) and as real numbers in the units of
// docs/fixed-point.md (…_value). Outside the window the values do not change, so that nothing is
// written.
//
// It samples an edge after all processes of that edge have run. It has to exist before simulation
// starts.
class EngineTrace : public sc_core::sc_module {
 public:
  // Writes `path` with the suffix ".vcd".
  EngineTrace(const sc_core::sc_module_name& name, const CycleEngine& engine,
              const std::string& path, const TraceWindow& window);

 private:
  struct Close {
    void operator()(sc_core::sc_trace_file* file) const { sc_core::sc_close_vcd_trace_file(file); }
  };
  // A vector's x component at the node, as a word and as a real number.
  struct Component {
    std::int32_t word = 0;
    double value = 0;
  };
  struct Block {
    bool busy = false;
    int package = 0;
    std::uint32_t rows_finished = 0;
    std::uint32_t rows_waiting = 0;
  };

  void declare();
  void wait_until_settled();
  void sample();
  bool in_window() const;
  void show(Component& component, const std::vector<std::int32_t>& words, int node, int exponent);

  const CycleEngine& engine_;
  TraceWindow window_;
  std::unique_ptr<sc_core::sc_trace_file, Close> file_;
  sc_core::sc_event settled_;

  bool clock_ = false;  // changes at every edge
  std::int64_t frame_ = 0;
  std::int64_t job_ = 0;
  std::int64_t edge_ = 0;
  int iteration_ = 0;
  std::array<bool, static_cast<std::size_t>(State::direction) + 1> state_{};
  std::vector<Block> block_;
  bool divider_busy_ = false;
  bool editor_busy_ = false;
  int edited_node_ = 0;
  int node_ = 0;
  int entered_node_ = 0;
  Component x_, b_, r_, z_, d_, q_;
  double alpha_ = 0, beta_ = 0, z_r_ = 0, d_q_ = 0;
  int r_exponent_ = 0, d_exponent_ = 0;
};

}  // namespace hvp::vp::engine
