#include "vp/fpga/engine/engine_trace.h"

#include <cmath>
#include <cstddef>

namespace hvp::vp::engine {

namespace {

double worth(const fixed::ScaledScalar& scalar) {
  return std::ldexp(static_cast<double>(scalar.word), -scalar.exponent);
}

double worth(const fixed::Coefficient& coefficient) {
  return std::ldexp(static_cast<double>(coefficient.mantissa), coefficient.exponent);
}

}  // namespace

EngineTrace::EngineTrace(const sc_core::sc_module_name& name, const CycleEngine& engine,
                         const std::string& path, const TraceWindow& window)
    : sc_module(name),
      engine_(engine),
      window_(window),
      file_(sc_core::sc_create_vcd_trace_file(path.c_str())),
      settled_("settled"),
      block_(static_cast<std::size_t>(engine.architecture().partitions)) {
  declare();
  SC_HAS_PROCESS(EngineTrace);
  SC_METHOD(wait_until_settled);
  sensitive << engine.clock().edge();
  dont_initialize();
  SC_METHOD(sample);
  sensitive << settled_;
  dont_initialize();
}

void EngineTrace::declare() {
  sc_core::sc_trace_file* file = file_.get();
  // Saying so would go to the terminal.
  sc_core::sc_report_handler::set_actions("tracing timescale unit set", sc_core::SC_DO_NOTHING);
  file->set_time_unit(1, sc_core::SC_PS);
  const std::string top = std::string(engine_.name()) + ".";
  sc_trace(file, clock_, top + "clock_edge");
  sc_trace(file, frame_, top + "frame");
  sc_trace(file, job_, top + "job");
  sc_trace(file, edge_, top + "edge_of_job");
  for (std::size_t s = 0; s < state_.size(); ++s) {
    sc_trace(file, state_[s], top + "sequencer.state." + engine::name(static_cast<State>(s)));
  }
  sc_trace(file, iteration_, top + "sequencer.iteration");
  sc_trace(file, alpha_, top + "sequencer.alpha_value");
  sc_trace(file, beta_, top + "sequencer.beta_value");
  sc_trace(file, z_r_, top + "sequencer.z_r_value");
  sc_trace(file, d_q_, top + "sequencer.d_q_value");
  sc_trace(file, r_exponent_, top + "sequencer.r_exponent");
  sc_trace(file, d_exponent_, top + "sequencer.d_exponent");
  sc_trace(file, divider_busy_, top + "divider.busy");
  sc_trace(file, editor_busy_, top + "matrix_editor.busy");
  sc_trace(file, edited_node_, top + "matrix_editor.node");
  for (std::size_t i = 0; i < block_.size(); ++i) {
    const std::string block = top + "spmxv_" + std::to_string(i) + ".";
    sc_trace(file, block_[i].busy, block + "busy");
    sc_trace(file, block_[i].package, block + "package");
    sc_trace(file, block_[i].rows_finished, block + "rows_finished");
    sc_trace(file, block_[i].rows_waiting, block + "rows_waiting");
  }
  const std::string unit = top + "vector_unit.";
  sc_trace(file, entered_node_, unit + "next_node");
  sc_trace(file, node_, unit + "written_node");
  const auto component = [&](const Component& c, const std::string& vector) {
    sc_trace(file, c.word, unit + vector + "_x_word");
    sc_trace(file, c.value, unit + vector + "_x_value");
  };
  component(x_, "x");
  component(b_, "b");
  component(r_, "r");
  component(z_, "z");
  component(d_, "d");
  component(q_, "q");
}

bool EngineTrace::in_window() const {
  const std::int64_t frame = window_.frame();
  return frame >= window_.first && frame <= window_.last;
}

void EngineTrace::wait_until_settled() {
  if (in_window()) settled_.notify(sc_core::SC_ZERO_TIME);
}

void EngineTrace::show(Component& component, const std::vector<std::int32_t>& words, int node,
                       int exponent) {
  component.word = words[3 * static_cast<std::size_t>(node)];
  component.value = std::ldexp(component.word, -exponent);
}

void EngineTrace::sample() {
  clock_ = !clock_;
  frame_ = window_.frame();
  job_ = engine_.jobs();
  edge_ = engine_.clocks();
  const Sequencer& sequencer = engine_.sequencer();
  const Scalars& scalars = sequencer.scalars();
  for (std::size_t s = 0; s < state_.size(); ++s) {
    state_[s] = sequencer.state() == static_cast<State>(s);
  }
  iteration_ = sequencer.report().iterations;
  alpha_ = worth(scalars.alpha);
  beta_ = worth(scalars.beta);
  z_r_ = worth(scalars.z_r);
  d_q_ = worth(scalars.d_q);
  r_exponent_ = scalars.r_exponent;
  d_exponent_ = scalars.d_exponent;
  divider_busy_ = engine_.divider().busy();
  editor_busy_ = engine_.matrix_editor().busy();
  edited_node_ = engine_.matrix_editor().node();
  for (std::size_t i = 0; i < block_.size(); ++i) {
    const SpmxvBlock& block = engine_.block(static_cast<int>(i));
    block_[i] = {block.busy(), block.position(), block.finished.read(),
                 block.finished.read() - block.taken->read()};
  }
  const VectorUnit& unit = engine_.vector_unit();
  const VectorMemories& memories = unit.memories();
  const bool preconditioned = engine_.settings().preconditioned();
  entered_node_ = unit.position();
  node_ = unit.written_node();
  show(x_, memories.x, node_, 0);
  show(b_, memories.b, node_, -engine_.settings().rhs_shift());
  show(r_, memories.r, node_, scalars.r_exponent);
  show(z_, preconditioned ? memories.z : memories.r, node_,
       preconditioned ? scalars.z_exponent : scalars.r_exponent);
  show(d_, engine_.block(0).direction(), node_, scalars.d_exponent);
  show(q_, memories.q, node_, scalars.q_exponent);
}

}  // namespace hvp::vp::engine
