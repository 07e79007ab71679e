#include "tables/hard_cases/constant_load.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <span>
#include <vector>

#include "models/fem/body.h"
#include "models/fem/direct_solver.h"
#include "models/fem/newmark.h"
#include "models/fem/structured_box.h"
#include "models/fixed/word.h"
#include "models/mesh/region.h"
#include "tables/hard_cases/board.h"

namespace hvp::tables {

namespace {

using Vector = std::vector<double>;

// With so few unknowns six iterations are not the exact solution, but near it.
constexpr int kIterations = 6;
constexpr double kEdge = 0.02;  // m

fem::Body cube() {
  const mesh::TetMesh mesh = fem::structured_box(Eigen::Vector3d::Constant(kEdge), {1, 1, 1});
  mesh::Region lower_half;
  lower_half.fraction = 0.5;
  return {mesh, fem::Material{}, mesh::select_nodes(lower_half, mesh),
          fem::AnchorTreatment::removed};
}

// Forces of different sizes and directions on the free nodes, up to 0.1 N.
Vector load_on(const fem::Body& body) {
  Vector f(static_cast<std::size_t>(3 * body.active_nodes()));
  for (std::size_t i = 0; i < f.size(); ++i) {
    f[i] = 1e-3 * (static_cast<double>(7 * i % 13) - 6) * (1 + static_cast<double>(i));
  }
  return f;
}

fixed::Plan plan_of(fixed::Method method, int passes) {
  fixed::Plan plan;
  plan.settings.method = method;
  plan.settings.iterations = kIterations;
  plan.settings.start = fixed::Start::warm;
  plan.passes = passes;
  return plan;
}

// Runs the frames and looks at what each leaves in `u`.
ConstantLoad watch(int frames, std::span<const double> exact, double unit,
                   const std::function<std::span<const double>()>& frame) {
  ConstantLoad result{.frames = frames};
  Vector previous(exact.size(), 0.0);
  Vector half_way;
  for (int n = 1; n <= frames; ++n) {
    const std::span<const double> u = frame();
    if (!std::ranges::equal(u, previous)) result.last_change = n;
    std::ranges::copy(u, previous.begin());
    if (n == frames / 2) {
      half_way = previous;
    } else if (n > frames / 2 && result.period == 0 && previous == half_way) {
      result.period = n - frames / 2;
    }
    double distance = 0;
    for (std::size_t i = 0; i < u.size(); ++i) {
      distance = std::max(distance, std::abs(u[i] - exact[i]) / unit);
    }
    if (n > frames / 2 && n <= frames / 4 * 3) {
      result.distance_before = std::max(result.distance_before, distance);
    } else if (n > frames / 4 * 3) {
      result.distance = std::max(result.distance, distance);
    }
  }
  return result;
}

Vector solution(const sparse::BlockMatrix& matrix, const Vector& load) {
  Vector u(load.size());
  fem::DirectSolver(matrix).solve(load, u);
  return u;
}

double unit_of(const fixed::Settings& settings) {
  return settings.displacement_range / static_cast<double>(fixed::word_limit(settings.vector_bits));
}

}  // namespace

ConstantLoad static_load(fixed::Method method, int frames) {
  const fem::Body body = cube();
  const Vector load = load_on(body);
  const fixed::Plan plan = plan_of(method, 1);
  Board board(body.stiffness(), plan);
  const Vector exact = solution(fixed::dequantise(board.system().matrix), load);
  return watch(frames, exact, unit_of(plan.settings), [&] {
    board.solve(load, Eigen::Vector3d::Zero());
    return board.displacement();
  });
}

ConstantLoad dynamic_load(fixed::Method method, int passes, int frames) {
  const fem::Body body = cube();
  const Vector load = load_on(body);
  const fixed::Plan plan = plan_of(method, passes);
  const fem::Dynamics dynamics;
  fem::Newmark newmark(body.stiffness(), body.mass(dynamics.mass), dynamics, 2e-3);
  const sparse::BlockMatrix matrix = newmark.effective_matrix();
  Board board(matrix, plan);
  // Where the body comes to rest, u is the static solution of K + (the rounding of Â): with
  // Â·u = f + (Â - K)·u on the right and the rounded Â on the left.
  sparse::BlockMatrix at_rest = body.stiffness();
  if (passes == 1) {
    const sparse::BlockMatrix rounded = fixed::dequantise(board.system().matrix);
    for (std::size_t i = 0; i < at_rest.value.size(); ++i) {
      at_rest.value[i] += rounded.value[i] - matrix.value[i];
    }
  }
  const Vector exact = solution(at_rest, load);
  Vector f(load.size());
  return watch(frames, exact, unit_of(plan.settings), [&] {
    newmark.predict();
    newmark.rhs(load, f);
    board.solve(f, Eigen::Vector3d::Zero());
    newmark.update(board.displacement());
    return board.displacement();
  });
}

}  // namespace hvp::tables
