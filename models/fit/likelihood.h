#pragma once

#include <cmath>

#include <ceres/autodiff_first_order_function.h>
#include <ceres/gradient_problem.h>
#include <ceres/gradient_problem_solver.h>

namespace hvp::fit {

// Half of the 95 % interval of a normal estimate, in standard deviations.
inline constexpr double kNormal95 = 1.959963984540054;

struct Likeliest {
  bool usable = false;  // a likelihood was found at all
  bool converged = false;
  double cost = 0;  // − ln likelihood, as the deviance has it
};

// Searches the parameters of greatest likelihood from `u` on, which gets them. `Deviance` is a
// functor as Ceres differentiates it, of Count parameters without bounds; BFGS.
template <int Count, class Deviance>
Likeliest likeliest(const Deviance& deviance, double* u) {
  const ceres::GradientProblem problem(
      new ceres::AutoDiffFirstOrderFunction<Deviance, Count>(new Deviance(deviance)));
  ceres::GradientProblemSolver::Options options;
  options.logging_type = ceres::SILENT;
  options.max_num_iterations = 500;
  options.line_search_direction_type = ceres::BFGS;
  options.function_tolerance = 1e-15;
  options.gradient_tolerance = 1e-9;
  options.parameter_tolerance = 1e-12;
  ceres::GradientProblemSolver::Summary summary;
  ceres::Solve(options, problem, u, &summary);
  return {.usable = summary.IsSolutionUsable() && std::isfinite(summary.final_cost),
          .converged = summary.termination_type == ceres::CONVERGENCE,
          .cost = summary.final_cost};
}

}  // namespace hvp::fit
