#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "vp/fpga/engine/engine_trace.h"
#include "vp/fpga/rtl/rtl_engine.h"
#include "vp/fpga/rtl/shown_signals.h"

namespace hvp::vp::rtl {

// A waveform of the engine in SystemVerilog in the format FST: all its signals under TOP and, under
// the scopes of engine::EngineTrace, those of its signals that mean the same here, with the same
// values at the same times. A memory shows in the words that lane 0 wrote last.
class RtlWaveform {
 public:
  // `scope` is the cycle-accurate engine's full name. The file is there from the first edge on,
  // whose order throws std::runtime_error where it cannot be written and std::logic_error where the
  // translation has no tracing.
  RtlWaveform(RtlEngine& engine, const std::string& scope, const std::string& path,
              const engine::TraceWindow& window, std::int64_t period_ps);
  ~RtlWaveform();
  RtlWaveform(const RtlWaveform&) = delete;
  RtlWaveform& operator=(const RtlWaveform&) = delete;

  // Completes the file, which is there then in any case.
  void close();

  // The edges that follow come a period each behind this time, and are those of an order that has
  // had `edges` already.
  void begin_order(std::int64_t time_ps, std::int64_t edges);
  // Likewise, but the count of edges stays that of the last order.
  void begin_copy(std::int64_t time_ps);
  // The number of solves so far.
  void set_job(std::int64_t job) { job_ = job; }

 private:
  // What writes a component of a lane's memories with the next edge: a pass, and rows of q.
  struct Port {
    Cells written, written_address, q_write, q_address;
  };

  void declare(const std::string& scope);
  void declare_vectors(const std::string& unit);
  void declare_blocks(const std::string& scope);
  void add(std::string name, int bits, std::function<std::int64_t()> value);
  void add_worth(std::string name, std::function<double()> value);
  void edge();
  std::int64_t frame() const { return copy_frame_ ? *copy_frame_ : window_.frame(); }
  void open();
  void note_written_node();

  RtlEngine& engine_;
  std::string path_;
  bool opened_ = false;
  engine::TraceWindow window_;
  std::int64_t period_ps_;

  std::int64_t time_ps_ = 0;  // of the last edge
  std::int64_t dumped_ps_ = 0;
  std::int64_t job_ = 0;
  std::optional<std::int64_t> copy_frame_;  // in which a copy of x began; empty: none is shown
  std::int64_t edges_ = 0;
  bool counts_ = false;
  bool clock_ = false;  // changes at every edge

  Cells scalar_exponent_, clocks_left_;
  std::vector<Port> ports_;  // of a lane each
  // Of the first lane that writes: the node whose words it wrote last, and the one it writes with
  // the next edge.
  int written_node_ = 0;
  int next_node_ = -1;  // none

  ShownSignals shown_;
  std::vector<std::function<std::int64_t()>> integers_;  // one a signal, empty of a real one
  std::vector<std::function<double()>> reals_;
};

}  // namespace hvp::vp::rtl
