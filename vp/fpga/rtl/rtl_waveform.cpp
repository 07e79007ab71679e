#include "vp/fpga/rtl/rtl_waveform.h"

#include <cmath>
#include <cstddef>
#include <utility>

#include "models/index.h"

namespace hvp::vp::rtl {

namespace {

std::int32_t signed_value(const Cells& cells) {
  const int unused = 32 - cells.width;
  return static_cast<std::int32_t>(cells.bits(0, 0, cells.width) << unused) >> unused;
}

std::uint32_t value_of(const Cells& cells, int index = 0) {
  return cells.bits(index, 0, cells.width);
}

}  // namespace

RtlWaveform::RtlWaveform(RtlEngine& engine, const std::string& scope, const std::string& path,
                         const engine::TraceWindow& window, std::int64_t period_ps)
    : engine_(engine), path_(path), window_(window), period_ps_(period_ps) {
  EngineModel& model = engine.model();
  scalar_exponent_ = model.cells("sequence_of_passes", "scalar_exponent");
  clocks_left_ = model.cells("sequence_of_passes", "clocks_left");
  for (int lane = 0; lane < engine.size().nodes_per_clock; ++lane) {
    const std::string component =
        "vectors.g_lane[" + std::to_string(lane) + "].g_component[0].component";
    ports_.push_back({model.cells(component, "written"), model.cells(component, "written_address"),
                      model.cells(component, "q_write"), model.cells(component, "q_address")});
  }
  declare("SystemC." + scope + ".");
  engine.watch([this] { edge(); });
}

RtlWaveform::~RtlWaveform() {
  engine_.watch({});
  if (opened_) engine_.model().close_waveform();
}

void RtlWaveform::open() {
  if (opened_) return;
  opened_ = true;
  engine_.model().open_waveform(path_, shown_);
}

void RtlWaveform::close() {
  open();
  engine_.model().close_waveform();
}

void RtlWaveform::add(std::string name, int bits, std::function<std::int64_t()> value) {
  shown_.push_back({std::move(name), bits});
  integers_.push_back(std::move(value));
  reals_.emplace_back();
}

void RtlWaveform::add_worth(std::string name, std::function<double()> value) {
  shown_.push_back({std::move(name), ShownSignal::kReal});
  integers_.emplace_back();
  reals_.push_back(std::move(value));
}

// In the order of engine::EngineTrace.
void RtlWaveform::declare(const std::string& scope) {
  const EnginePorts& ports = engine_.ports();
  add(scope + "clock_edge", 1, [this] { return clock_ ? 1 : 0; });
  add(scope + "frame", 64, [this] { return frame(); });
  add(scope + "job", 64, [this] { return job_; });
  add(scope + "edge_of_job", 64, [this] { return edges_; });
  const std::string sequencer = scope + "sequencer.";
  for (std::size_t s = 0; s < engine::kStates; ++s) {
    add(sequencer + "state." + engine::name(static_cast<engine::State>(s)), 1,
        [&ports, s] { return ports.state == static_cast<int>(s) ? 1 : 0; });
  }
  add(sequencer + "iteration", 32, [&ports] { return ports.iterations_made; });
  add_worth(sequencer + "z_r_value", [this, &ports] {
    return std::ldexp(static_cast<double>(ports.z_r), -signed_value(scalar_exponent_));
  });
  add(sequencer + "r_exponent", 32, [&ports] { return ports.r_exponent; });
  add(sequencer + "d_exponent", 32, [&ports] { return ports.d_exponent; });
  // Between the register that has the command and the one that gets the quotient.
  add(scope + "divider.busy", 1, [this] {
    const auto left = static_cast<int>(value_of(clocks_left_));
    return left > 1 && left < engine_.size().division_clocks ? 1 : 0;
  });
  add(scope + "matrix_editor.busy", 1, [&ports] { return ports.editing ? 1 : 0; });
  declare_blocks(scope);
  declare_vectors(scope + "vector_unit.");
}

void RtlWaveform::declare_blocks(const std::string& scope) {
  EngineModel& model = engine_.model();
  for (int p = 0; p < engine_.size().partitions; ++p) {
    const std::string partition = "matrix.g_partition[" + std::to_string(p) + "].spmxv";
    const std::string block = scope + "spmxv_" + std::to_string(p) + ".";
    const Cells busy = model.cells(partition, "busy");
    const Cells position = model.cells(partition, "position");
    const Cells finished = model.cells(partition, "finished");
    const Cells taken = model.cells(partition, "taken");
    add(block + "busy", 1, [busy] { return value_of(busy); });
    add(block + "package", 32, [position] { return value_of(position); });
    add(block + "rows_waiting", 32, [finished, taken] {
      return (value_of(finished) - value_of(taken)) & ((1U << finished.width) - 1);
    });
  }
}

void RtlWaveform::declare_vectors(const std::string& unit) {
  add(unit + "written_node", 32, [this] { return written_node_; });
  const auto word = [this](Vector vector) {
    return engine_.memories().word(vector, written_node_, 0);
  };
  const auto component = [&](const char* vector, Vector memory, std::function<int()> exponent) {
    add(unit + vector + "_x_word", 32, [word, memory] { return word(memory); });
    if (!exponent) return;
    add_worth(unit + vector + "_x_value", [word, memory, exponent = std::move(exponent)] {
      return std::ldexp(word(memory), -exponent());
    });
  };
  const auto of_r = [this] { return engine_.ports().r_exponent; };
  const auto preconditioned = [this] { return engine_.settings().preconditioned(); };
  component("x", Vector::x, [] { return 0; });
  component("b", Vector::b, [this] { return -engine_.settings().rhs_shift(); });
  component("r", Vector::r, of_r);
  // Without a preconditioner z is r.
  const auto z = [word, preconditioned] { return word(preconditioned() ? Vector::z : Vector::r); };
  add(unit + "z_x_word", 32, z);
  add_worth(unit + "z_x_value", [this, z, preconditioned] {
    const EnginePorts& ports = engine_.ports();
    return std::ldexp(z(), -(preconditioned() ? ports.z_exponent : ports.r_exponent));
  });
  component("d", Vector::d, [this] { return engine_.ports().d_exponent; });
  component("q", Vector::q, {});
}

void RtlWaveform::begin_order(std::int64_t time_ps, std::int64_t edges) {
  time_ps_ = time_ps;
  copy_frame_.reset();
  edges_ = edges;
  counts_ = true;
}

void RtlWaveform::begin_copy(std::int64_t time_ps) {
  time_ps_ = time_ps;
  copy_frame_ = window_.frame();
  counts_ = false;
}

void RtlWaveform::note_written_node() {
  if (next_node_ >= 0) written_node_ = next_node_;
  next_node_ = -1;
  const int lanes = engine_.size().nodes_per_clock;
  for (int lane = lanes - 1; lane >= 0; --lane) {
    const Port& port = ports_[at(lane)];
    if (value_of(port.written) != 0) {
      next_node_ = static_cast<int>(value_of(port.written_address)) * lanes + lane;
    } else if (value_of(port.q_write) != 0) {
      next_node_ = static_cast<int>(value_of(port.q_address)) * lanes + lane;
    }
  }
}

void RtlWaveform::edge() {
  open();
  time_ps_ += period_ps_;
  if (counts_) ++edges_;
  note_written_node();
  // A change of the matrix beside a copy is made behind it here: its first edges are not shown.
  const std::int64_t frame = this->frame();
  if (frame < window_.first || frame > window_.last || time_ps_ <= dumped_ps_) return;
  dumped_ps_ = time_ps_;
  clock_ = !clock_;
  for (std::size_t i = 0; i < shown_.size(); ++i) {
    if (integers_[i]) {
      shown_[i].integer = integers_[i]();
    } else {
      shown_[i].real = reals_[i]();
    }
  }
  engine_.model().dump(time_ps_);
}

}  // namespace hvp::vp::rtl
