#include "app/design/design_figures.h"

#include <algorithm>

#include <fmt/format.h>

#include "app/scene/frame_cost.h"
#include "app/scene/scene.h"
#include "models/config/input_error.h"

namespace hvp::app {

namespace {

// Row lengths for `nodes` nodes, each length in the same proportion as in the scene.
accel::Pattern resized(const accel::Pattern& p, int nodes) {
  accel::Pattern result;
  result.blocks_in_row.reserve(static_cast<std::size_t>(nodes));
  for (std::int64_t i = 0; i < nodes; ++i) {
    const auto row = static_cast<std::size_t>(i * p.nodes() / nodes);
    result.blocks_in_row.push_back(p.blocks_in_row[row]);
  }
  return result;
}

Reach reach_of(const Scene& scene, int nodes) {
  Reach r;
  r.nodes = nodes;
  r.mesh_nodes =
      static_cast<int>(std::int64_t{nodes} * static_cast<std::int64_t>(scene.quality().nodes) /
                       scene.pattern().nodes());
  return r;
}

// The scenario's clock, or the highest one where the design does not reach that.
double clock_in_force(const accel::Architecture& a, const std::optional<accel::CriticalPath>& c) {
  return c ? std::min(a.clock_hz, c->highest_clock_hz) : a.clock_hz;
}

void take_time(const Scene& scene, const accel::BoardClocks& board, double clock_hz, Reach& r) {
  const accel::SolveWork work = accel::longest_solve(scene.computation().board().settings());
  accel::Architecture a = scene.scenario().accelerator;
  a.clock_hz = clock_hz;
  r.solve_ps = board.solve(work).total() * a.clock_period_ps();
  r.frame_ps = frame_ps(frame_steps(scene, r.nodes, r.solve_ps));
}

std::optional<Reach> largest(const Scene& scene, const accel::WordLengths& words, double clock_hz) {
  const accel::Architecture& a = scene.scenario().accelerator;
  const int nodes = accel::largest_mesh_of_board(scene.device(), a, words, scene.board());
  if (nodes == 0) return std::nullopt;
  Reach r = reach_of(scene, nodes);
  // The words that devices exchange for a larger mesh depend on its columns, which do not exist.
  if (!a.several || a.several->exchange == accel::Exchange::all) {
    take_time(scene, accel::BoardClocks(a, resized(scene.pattern(), nodes)), clock_hz, r);
  }
  return r;
}

// False for a design that the scenario's fidelity, or several devices, would refuse.
bool has_model(const Scene& scene, const accel::Design& design) {
  using fixed::Method;
  const bool engine = vp::has_engine(scene.scenario().fidelity.accelerator);
  const Method method = design.solver.method;
  if (engine && (method == Method::chronopoulos_gear || method == Method::pipelined_cg)) {
    return false;
  }
  const bool symmetric = design.architecture.matrix_storage == accel::MatrixStorage::symmetric;
  return !symmetric || !(engine || design.architecture.several);
}

double per_second(std::int64_t ps) { return ps == 0 ? 0 : 1e12 / static_cast<double>(ps); }

WhatIf try_out(const Scene& scene, const accel::Variation& variation) {
  WhatIf w;
  w.variation = variation;
  const accel::Architecture& a = variation.design.architecture;
  const accel::WordLengths words = accel::word_lengths(variation.design.solver);
  try {
    const accel::BoardClocks board(a, scene.pattern());
    w.solve_clocks = board.solve(accel::longest_solve(variation.design.solver)).total();
    const accel::Usage usage = accel::board_usage(scene.device(), a, words, board);
    for (const accel::Resource& r : usage.resources) {
      if (r.used <= r.available) continue;
      w.short_of.push_back(fmt::format("{} {} of {}", r.type, r.used, r.available));
    }
    for (const accel::Obstacle& o : usage.obstacles) w.short_of.push_back(o.reason);
    double clock_hz = a.clock_hz;
    if (scene.device().timing) {
      w.highest_clock_hz =
          accel::highest_clock({scene.device(), a, words, scene.pattern().nodes()});
      clock_hz = std::min(clock_hz, *w.highest_clock_hz);
    }
    w.solve_s = static_cast<double>(w.solve_clocks) / clock_hz;
  } catch (const InputError& e) {
    w.refused = e.what();
  }
  return w;
}

}  // namespace

double Reach::solve_rate_hz() const { return per_second(solve_ps); }
double Reach::frame_rate_hz() const { return per_second(frame_ps); }

DesignFigures design_figures(const Scene& scene) {
  const accel::Architecture& a = scene.scenario().accelerator;
  const fixed::Settings& solver = scene.computation().board().settings();
  const accel::WordLengths words = accel::word_lengths(solver);
  DesignFigures f;
  f.cycles = scene.solve_cycles();
  if (scene.device().timing) {
    f.clock = accel::critical_path({scene.device(), a, words, scene.pattern().nodes()});
  }
  f.usage = scene.usage();
  f.packing = accel::packing(a, scene.pattern());
  accel::Architecture in_force = a;
  in_force.clock_hz = clock_in_force(a, f.clock);
  f.operations = accel::operation_rate(in_force, scene.pattern(), solver.method, f.cycles);
  f.scene = reach_of(scene, scene.pattern().nodes());
  take_time(scene, scene.board(), in_force.clock_hz, f.scene);
  f.largest = largest(scene, words, in_force.clock_hz);
  for (const accel::Variation& v : accel::variations({a, solver})) {
    if (has_model(scene, v.design)) f.what_if.push_back(try_out(scene, v));
  }
  return f;
}

}  // namespace hvp::app
