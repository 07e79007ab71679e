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

// The experiment of thesis §4.2 and §4.3 (Tables 4.1 and 4.2): about 1000 nodes, κ between 2500
// and 4000, x₀ random with ‖x₀‖ = 2.47e5 in units of 16-bit words, b = A·x₀ with the *rounded*
// matrix, a start from zero, and the error ‖x - x₀‖ / ‖x₀‖ after so many iterations.
namespace hvp::tables {

inline constexpr std::array<int, 6> kThesisIterations = {30, 40, 50, 60, 70, 80};
inline constexpr std::array<double, 6> kThesisCg = {2.6e-2, 2.2e-2, 1.9e-2, 1.6e-2, 9.8e-3, 5.1e-3};
inline constexpr std::array<double, 6> kThesisPcg = {1.7e-2, 1.1e-2, 2.4e-3,
                                                     1.3e-3, 1.0e-3, 9.0e-4};

// A body by TetGen, ν = 0.3, the lowest 15 % of its nodes held.
struct ThesisMesh {
  std::string name;
  int nodes = 0;                              // of the mesh
  sparse::BlockMatrix stiffness;              // the held nodes are removed
  std::unique_ptr<fem::DirectSolver> solver;  // of the stiffness
  double condition = 0;                       // of the stiffness
  double condition_rounded = 0;               // of the same in 12 bits
};

// Three spheres and three cubes.
std::vector<ThesisMesh> thesis_meshes();

enum class Load {
  of_random_solution,  // the thesis': b = A·x₀
  random,              // b random: nearer to a contact, which is a load at a point
};

// Mean over the meshes, one value for each of the wanted iterations.
struct Errors {
  std::vector<double> rounded;     // against the solution of the rounded system
  std::vector<double> true_model;  // against that of the stiffness itself, with the same b
  stability::Flags flags;          // of all meshes
};

// The fixed-point solver. `settings` says all but the start, which is zero, and the number of
// iterations, which is the last wanted one.
Errors fixed_point(std::span<const ThesisMesh> meshes, fixed::Settings settings,
                   std::span<const int> iterations, Load load = Load::of_random_solution);

// CG, or PCG with the diagonal, in double precision on the same rounded systems.
Errors double_precision(std::span<const ThesisMesh> meshes, bool preconditioned,
                        std::span<const int> iterations, Load load = Load::of_random_solution);

}  // namespace hvp::tables
