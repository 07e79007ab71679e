#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "models/fixed/settings.h"
#include "models/fixed/solver.h"

namespace hvp::fixed {

// Which implementation of the solver computes. All give the same words, the same report and the
// same calls of the observer; they differ in time alone.
enum class Kernel {
  reference,  // one word, one statement: ReferenceSolver
  portable,   // the fast solver's passes in plain C++
  avx2,
  avx512,  // with VNNI
};

std::string_view name(Kernel kernel);

// Whether this processor and this build have it.
bool supported(Kernel kernel);
std::vector<Kernel> supported_kernels();

// The fastest of those.
Kernel best_kernel();

// The one that the environment variable HVP_KERNEL names, else the best. Throws InputError for a
// name that does not exist or that this machine does not support.
Kernel chosen_kernel();

// Throws InputError as Settings::check(), and where the kernel is not supported.
std::unique_ptr<Solver> make_solver(const Settings& settings, Kernel kernel = chosen_kernel());

}  // namespace hvp::fixed
