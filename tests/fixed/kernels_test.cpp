// Which kernel computes, and that the one in force is right.
#include <cstdlib>
#include <string>

#include <gtest/gtest.h>

#include "models/config/input_error.h"
#include "tests/fixed/contest.h"
#include "tests/fixed/elastic_box.h"

namespace hvp::fixed::kernels_test {
namespace {

using test::difference;
using test::record;

class Environment {
 public:
  explicit Environment(const char* kernel) { set(kernel); }
  ~Environment() { set(had_ ? before_.c_str() : nullptr); }
  Environment(const Environment&) = delete;
  Environment& operator=(const Environment&) = delete;

 private:
  static void set(const char* kernel) {
    if (kernel != nullptr) {
      setenv("HVP_KERNEL", kernel, 1);
    } else {
      unsetenv("HVP_KERNEL");
    }
  }
  bool had_ = std::getenv("HVP_KERNEL") != nullptr;
  std::string before_ = had_ ? std::getenv("HVP_KERNEL") : "";
};

TEST(Kernel, TheBestOneIsTheDefault) {
  const Environment nothing(nullptr);
  EXPECT_EQ(chosen_kernel(), best_kernel());
  EXPECT_EQ(supported_kernels().front(), Kernel::reference);
  EXPECT_TRUE(supported(Kernel::portable));
}

TEST(Kernel, TheEnvironmentChooses) {
  for (const Kernel kernel : supported_kernels()) {
    const Environment named(std::string(name(kernel)).c_str());
    EXPECT_EQ(chosen_kernel(), kernel);
  }
}

TEST(Kernel, AnUnknownNameIsRefusedWithThoseThereAre) {
  const Environment unknown("sse9");
  try {
    chosen_kernel();
    FAIL() << "nothing was thrown";
  } catch (const InputError& error) {
    const std::string message = error.what();
    EXPECT_NE(message.find("sse9"), std::string::npos) << message;
    for (const Kernel kernel : supported_kernels()) {
      EXPECT_NE(message.find(name(kernel)), std::string::npos) << message;
    }
  }
}

TEST(Kernel, OneThatTheMachineLacksIsRefused) {
  for (const Kernel kernel : {Kernel::avx2, Kernel::avx512}) {
    if (!supported(kernel)) {
      EXPECT_THROW(make_solver(Settings{}, kernel), InputError);
    }
  }
}

// Run by ctest once with every name in HVP_KERNEL, and without it.
TEST(ChosenKernel, GivesTheReferencesWords) {
  const char* const wanted = std::getenv("HVP_KERNEL");
  for (const Kernel kernel : {Kernel::avx2, Kernel::avx512}) {
    if (wanted != nullptr && name(kernel) == wanted && !supported(kernel)) {
      GTEST_SKIP() << "this processor has no " << wanted;
    }
  }
  if (wanted != nullptr && *wanted != '\0') {
    ASSERT_EQ(name(chosen_kernel()), wanted);
  }
  const test::Body body = test::make_body({.cells_x = 4, .cells_y = 5, .cells_z = 4});
  for (const Method method : {Method::cg, Method::jacobi_pcg}) {
    Settings s;
    s.method = method;
    const QuantisedMatrix matrix = quantise(body.stiffness, s.matrix_bits);
    const std::vector<std::int32_t> b(static_cast<std::size_t>(matrix.rows()), 900);
    const std::vector<std::int32_t> guess(b.size(), 0);
    ReferenceSolver reference(s);
    reference.load(matrix);
    const auto solver = make_solver(s);
    solver->load(matrix);
    EXPECT_EQ(difference(record(reference, b, guess), record(*solver, b, guess)), "");
  }
}

}  // namespace
}  // namespace hvp::fixed::kernels_test
