#pragma once

#include <array>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "models/fem/direct_solver.h"
#include "models/fixed/settings.h"
#include "models/sparse/block_matrix.h"
#include "models/stability/flag.h"

// The experiment of thesis §4.2 and §4.3 (Tables 4.1 and 4.2): about 1000 nodes, κ between 2500 and
// 4000, x₀ random with ‖x₀‖ = 2.47e5 in units of 16-bit words, and b = A·x₀ with the *rounded*
// matrix. The solver starts from zero, and the error is ‖x - x₀‖ / ‖x₀‖ after a number of
// iterations.
namespace hvp::tables {

inline constexpr std::array<int, 6> kThesisIterations = {30, 40, 50, 60, 70, 80};
inline constexpr std::array<double, 6> kThesisCg = {2.6e-2, 2.2e-2, 1.9e-2, 1.6e-2, 9.8e-3, 5.1e-3};
inline constexpr std::array<double, 6> kThesisPcg = {1.7e-2, 1.1e-2, 2.4e-3,
                                                     1.3e-3, 1.0e-3, 9.0e-4};

// A body meshed by TetGen, with ν = 0.3. The lowest 15 % of its nodes are anchored.
struct ThesisMesh {
  std::string name;
  int nodes = 0;                              // of the mesh
  sparse::BlockMatrix stiffness;              // without the anchored nodes
  std::unique_ptr<fem::DirectSolver> solver;  // of the stiffness
  double condition = 0;                       // of the stiffness
  double condition_rounded = 0;               // of the stiffness rounded to 12 bits
};

// The meshes of three spheres and three cubes.
std::vector<ThesisMesh> thesis_meshes();

enum class Load {
  of_random_solution,  // the thesis' load, b = A·x₀
  random,              // a random b, closer to a contact, whose load acts at a point
};

// The mean errors over the meshes, one for each number of iterations.
struct Errors {
  std::vector<double> rounded;     // against the solution of the rounded system
  std::vector<double> true_model;  // against the solution of the stiffness itself with the same b
  stability::Flags flags;          // of all meshes
};

// The errors of the fixed-point solver. The start is zero and the number of iterations is the last
// of `iterations`; `settings` determines all else.
Errors fixed_point(std::span<const ThesisMesh> meshes, fixed::Settings settings,
                   std::span<const int> iterations, Load load = Load::of_random_solution);

// The errors of CG, or of PCG with the diagonal, in double precision on the same rounded systems.
Errors double_precision(std::span<const ThesisMesh> meshes, bool preconditioned,
                        std::span<const int> iterations, Load load = Load::of_random_solution);

}  // namespace hvp::tables
