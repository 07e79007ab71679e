#include "models/fixed/solver.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <string>

#include "models/config/input_error.h"
#include "models/fixed/fast/fast_solver.h"
#include "models/fixed/reference_solver.h"

namespace hvp::fixed {

namespace {

// From the slowest to the fastest.
constexpr std::array kKernels = {Kernel::reference, Kernel::portable, Kernel::avx2, Kernel::avx512};

std::string supported_names() {
  std::string names;
  for (const Kernel kernel : supported_kernels()) {
    names += (names.empty() ? "" : ", ") + std::string(name(kernel));
  }
  return names;
}

void require_supported(Kernel kernel) {
  if (supported(kernel)) return;
  throw InputError("HVP_KERNEL", "this machine does not have the kernel \"" +
                                     std::string(name(kernel)) + "\"; it has " + supported_names());
}

}  // namespace

std::string_view name(Kernel kernel) {
  switch (kernel) {
    case Kernel::reference:
      return "reference";
    case Kernel::portable:
      return "portable";
    case Kernel::avx2:
      return "avx2";
    case Kernel::avx512:
      break;
  }
  return "avx512";
}

bool supported(Kernel kernel) {
  if (kernel == Kernel::reference || kernel == Kernel::portable) return true;
#ifdef HVP_X86_KERNELS
  __builtin_cpu_init();
  if (kernel == Kernel::avx2) return __builtin_cpu_supports("avx2") != 0;
  return __builtin_cpu_supports("avx512f") != 0 && __builtin_cpu_supports("avx512bw") != 0 &&
         __builtin_cpu_supports("avx512dq") != 0 && __builtin_cpu_supports("avx512vl") != 0 &&
         __builtin_cpu_supports("avx512vnni") != 0;
#else
  return false;
#endif
}

std::vector<Kernel> supported_kernels() {
  std::vector<Kernel> result;
  std::ranges::copy_if(kKernels, std::back_inserter(result), supported);
  return result;
}

Kernel best_kernel() { return supported_kernels().back(); }

Kernel chosen_kernel() {
  const char* wanted = std::getenv("HVP_KERNEL");
  if (wanted == nullptr || *wanted == '\0') return best_kernel();
  const auto* const hit =
      std::ranges::find_if(kKernels, [&](Kernel kernel) { return name(kernel) == wanted; });
  if (hit == kKernels.end()) {
    throw InputError("HVP_KERNEL", "a kernel \"" + std::string(wanted) +
                                       "\" does not exist; this machine has " + supported_names());
  }
  require_supported(*hit);
  return *hit;
}

std::unique_ptr<Solver> make_solver(const Settings& settings, Kernel kernel) {
  require_supported(kernel);
  switch (kernel) {
    case Kernel::reference:
      return std::make_unique<ReferenceSolver>(settings);
#ifdef HVP_X86_KERNELS
    case Kernel::avx2:
      return std::make_unique<fast::FastSolver>(settings, fast::avx2_passes());
    case Kernel::avx512:
      return std::make_unique<fast::FastSolver>(settings, fast::avx512_passes());
#endif
    default:
      return std::make_unique<fast::FastSolver>(settings, fast::portable_passes());
  }
}

}  // namespace hvp::fixed
