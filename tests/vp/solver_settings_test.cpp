// Every method and option of the solver on the board: set through the driver, compared with the
// reference solver word for word and with a count of its own clock for clock.
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "driver/hvp_driver.h"
#include "models/fixed/reference_solver.h"
#include "models/stability/flag.h"
#include "tests/vp/board_rig.h"
#include "tests/vp/expected_time.h"
#include "tests/vp/small_scene.h"
#include "tests/vp/stimulus.h"
#include "vp/fpga/accelerator.h"
#include "vp/host/board_access.h"
#include "vp/host/driver_config.h"
#include "vp/host/driver_port.h"
#include "vp/pci/pci_bus.h"

namespace hvp::vp::solver_settings_test {
namespace {

using fixed::Method;
using test::kBoardClock;
using test::kUs;
using test::Made;
using test::SmallScene;
using Words = std::vector<std::int32_t>;

constexpr std::size_t kUnknowns = SmallScene::kUnknowns;
constexpr std::uint64_t kTimeoutNs = 100'000'000;
constexpr std::array kMethods = {Method::cg, Method::jacobi_pcg, Method::block_jacobi_pcg,
                                 Method::chronopoulos_gear, Method::pipelined_cg};

class SolverSettings : public test::BoardRig, public testing::Test {
 protected:
  void run(const std::function<void(test::Program&)>& script) {
    run_driver(0, [&](test::Program& p) {
      ASSERT_EQ(hvp_open(&device_, &port_->bus(), scratch_.data(), scratch_.size()), HVP_OK);
      script(p);
    });
  }

  void configure(const fixed::Settings& s) {
    const hvp_solver_config config = driver_config(s);
    ASSERT_EQ(hvp_configure(&device_, &config), HVP_OK);
  }
  // Leaves the matrix in k_.
  void load(const fixed::Settings& s) {
    k_ = fixed::quantise(scene_.computation.matrix(), s.matrix_bits);
    send();
  }
  void send() { load_matrix(k_); }
  Words solve(const Words& b) {
    Words u(kUnknowns);
    EXPECT_EQ(hvp_solve(&device_, b.data(), u.data(), kUnknowns, kTimeoutNs), HVP_OK);
    return u;
  }
  hvp_result result() {
    hvp_result r{};
    EXPECT_EQ(hvp_read_result(&device_, &r), HVP_OK);
    return r;
  }
  void expect(const fixed::Report& report, const hvp_result& r, const std::string& what) {
    EXPECT_EQ(r.iterations, static_cast<std::uint32_t>(report.iterations)) << what;
    EXPECT_EQ(r.reached, report.reached) << what;
    EXPECT_EQ(r.replacements, static_cast<std::uint32_t>(report.replacements)) << what;
    EXPECT_EQ(r.saturations, static_cast<std::uint32_t>(report.saturations)) << what;
    EXPECT_EQ(r.wraps, static_cast<std::uint32_t>(report.wraps)) << what;
    EXPECT_EQ(r.breakdowns, static_cast<std::uint32_t>(report.breakdowns)) << what;
    EXPECT_EQ(r.flags, report.flags.bits()) << what;
  }
  std::uint64_t clocks(const Made& made) const {
    return static_cast<std::uint64_t>(test::SolveClocks(k_.row_begin)(made));
  }

  std::vector<std::uint32_t> scratch_ = std::vector<std::uint32_t>(3 * kUnknowns);
  fixed::QuantisedMatrix k_;
  // A preconditioned board has b in units 2^m smaller (thesis §4.3); longer words have room for
  // more.
  static Words rhs(const fixed::Settings& s, int largest = 200) {
    const int static_scale = s.preconditioned() ? 11 : 0;
    return test::words(SmallScene::kUnknowns, largest << (s.vector_bits - 16) / 2 << static_scale);
  }
};

struct Change {
  const char* name;
  std::function<void(fixed::Settings&)> make;
  int largest_rhs = 200;
};

// Each of them makes other words than the defaults do, so that one which did not arrive shows.
const std::vector<Change> kChanges = {
    {"defaults", [](auto&) {}},
    {"iterations", [](auto& s) { s.iterations = 7; }},
    {"zero start", [](auto& s) { s.start = fixed::Start::zero; }},
    {"replacement", [](auto& s) { s.replace_residual_every = 4; }},
    {"matrix_bits", [](auto& s) { s.matrix_bits = 14; }},
    {"vector_bits", [](auto& s) { s.vector_bits = 18; }},
    {"wide words", [](auto& s) { s.matrix_bits = 20, s.vector_bits = 24, s.static_shift = 19; }},
    {"scalar_bits", [](auto& s) { s.vector_bits = 32, s.matrix_bits = 24, s.scalar_bits = 128; }},
    {"coefficient_bits", [](auto& s) { s.coefficient_bits = 9; }},
    {"fixed coefficients", [](auto& s) { s.coefficient_format = fixed::CoefficientFormat::fixed; }},
    {"alpha_fraction",
     [](auto& s) {
       s.coefficient_format = fixed::CoefficientFormat::fixed;
       s.alpha_fraction_bits = 17;
     }},
    {"beta_fraction",
     [](auto& s) {
       s.coefficient_format = fixed::CoefficientFormat::fixed;
       s.beta_fraction_bits = 7;
     }},
    {"division_rounding",
     [](auto& s) { s.coefficient_bits = 10, s.division_rounding = fixed::Rounding::truncation; }},
    {"shift_rounding", [](auto& s) { s.shift_rounding = fixed::Rounding::truncation; }},
    {"shift to even", [](auto& s) { s.shift_rounding = fixed::Rounding::nearest_even; }},
    {"static scaling", [](auto& s) { s.dynamic_scaling = false; }},
    {"up only", [](auto& s) { s.scaling_down = false; }},
    {"threshold", [](auto& s) { s.scaling_threshold = 16; }},
    {"step", [](auto& s) { s.scaling_step = 3; }},
    {"headroom", [](auto& s) { s.headroom_bits = 4; }},
    {"wrap", [](auto& s) { s.overflow = fixed::Overflow::wrap; }, 30'000},
    {"saturate", [](auto&) {}, 30'000},
};

class EveryMethod : public SolverSettings, public testing::WithParamInterface<Method> {};

TEST_P(EveryMethod, HasTheReferenceSolversWordsAndItsOwnClocks) {
  run([&](test::Program&) {
    Words plain;
    for (const Change& change : kChanges) {
      fixed::Settings s;
      s.method = GetParam();
      s.iterations = 12;
      change.make(s);
      configure(s);
      load(s);
      ASSERT_EQ(hvp_write_initial_guess(&device_, Words(kUnknowns, 3).data(), kUnknowns), HVP_OK);
      const Words b = rhs(s, change.largest_rhs);
      Words expected(kUnknowns, 3);
      fixed::ReferenceSolver reference(s);
      reference.load(k_);
      for (int job = 0; job < 2; ++job) {  // the second starts from the first's U
        const fixed::Report report = reference.solve({b, expected});
        EXPECT_EQ(solve(b), expected) << change.name;
        if (plain.empty()) {
          plain = expected;
        } else if (job == 0 && !(s.method == Method::jacobi_pcg && s.scaling_threshold > 1)) {
          // (Jacobi's directions do not shrink enough to be scaled up in so few iterations.)
          EXPECT_NE(expected, plain) << change.name;
        }
        const hvp_result r = result();
        expect(report, r, change.name);
        EXPECT_EQ(r.wraps > 0, s.overflow == fixed::Overflow::wrap) << change.name;
        EXPECT_EQ(r.cycles,
                  clocks({.method = s.method,
                          .passes = report.breakdowns > 0 ? report.iterations : s.iterations,
                          .replacements = report.replacements,
                          .dynamic_scaling = s.dynamic_scaling,
                          .broken_down = report.breakdowns > 0,
                          .scalar_bits = s.scalar_bits,
                          .coefficient_bits = s.coefficient_bits,
                          .scaling_step = s.scaling_step}))
            << change.name;
      }
    }
  });
}

// U, the results and the interrupt come with the clock that ends the job early, not before.
TEST_P(EveryMethod, EndsWhenItsResidualIsReached) {
  run([&](test::Program& p) {
    fixed::Settings s;
    s.method = GetParam();
    s.iterations = 100;
    s.stop_residual = 0.2;
    configure(s);
    load(s);
    const Words b = rhs(s);
    Words expected(kUnknowns, 0);
    const fixed::Report report = fixed::ReferenceSolver(s).solve(k_, {b, expected});
    ASSERT_TRUE(report.reached);
    ASSERT_GT(report.iterations, 1);
    ASSERT_LT(report.iterations, 60);
    const Made made{.method = s.method, .passes = report.iterations};

    ASSERT_EQ(hvp_write_rhs(&device_, b.data(), kUnknowns), HVP_OK);
    ASSERT_EQ(hvp_start(&device_), HVP_OK);
    const Picoseconds started = now_ps();
    const RegisterBank& bank = accelerator_->bank();
    p.sleep_until(started + static_cast<Picoseconds>(clocks(made)) * kBoardClock - 1);
    EXPECT_EQ(bank.get(field::kStatusBusy), 1U);
    EXPECT_EQ(bank.get(Register::result_job), 0U);
    EXPECT_EQ(bank.get(Register::result_iterations), 0U);
    EXPECT_EQ(bank.get(field::kResultEndReached), 0U);
    EXPECT_EQ(bank.get(field::kStatusFlags), 0U);
    for (std::size_t i = 0; i < kUnknowns; ++i) {
      EXPECT_EQ(packed_element(bank.memory(Aperture::u), i, 16), 0);
    }
    EXPECT_EQ(accelerator_->report().iterations, 0);
    p.sleep(2);
    EXPECT_EQ(bank.get(field::kStatusBusy), 0U);
    ASSERT_EQ(hvp_wait(&device_, kTimeoutNs), HVP_OK);
    Words u(kUnknowns);
    ASSERT_EQ(hvp_read_solution(&device_, u.data(), kUnknowns), HVP_OK);
    EXPECT_EQ(u, expected);
    expect(report, result(), "early end");
    EXPECT_TRUE(result().reached);

    // Nothing to do from there but to look: the set-up alone.
    s.stop_residual = 0.5;
    configure(s);
    ASSERT_EQ(solve(b), expected);
    EXPECT_EQ(result().iterations, 0U);
    EXPECT_EQ(result().cycles, clocks({.method = s.method, .passes = 0}));
  });
}

// With a count alone the board makes its passes, whether there is anything left to do or not.
TEST_P(EveryMethod, CountsItsPassesAtRest) {
  run([&](test::Program&) {
    fixed::Settings s;
    s.method = GetParam();
    s.iterations = 9;
    configure(s);
    load(s);
    EXPECT_EQ(solve(Words(kUnknowns, 0)), Words(kUnknowns, 0));
    EXPECT_EQ(result().iterations, 0U);
    EXPECT_EQ(result().flags, 0U);
    EXPECT_EQ(result().cycles, clocks({.method = s.method, .passes = 9}));
    s.stop_residual = 1e-3;
    configure(s);
    EXPECT_EQ(solve(Words(kUnknowns, 0)), Words(kUnknowns, 0));
    EXPECT_TRUE(result().reached);
    EXPECT_EQ(result().cycles, clocks({.method = s.method, .passes = 0}));
  });
}

TEST_P(EveryMethod, ABreakdownEndsTheJob) {
  run([&](test::Program&) {
    fixed::Settings s;
    s.method = GetParam();
    configure(s);
    k_ = fixed::quantise(scene_.computation.matrix(), s.matrix_bits);
    // Two nodes that pull each other more than everything else holds them: what moves them apart
    // has negative curvature.
    for (const auto& [row, col] : {std::pair{20, 21}, std::pair{21, 20}}) {
      const auto block = 9 * static_cast<std::size_t>(k_.find(row, col));
      for (std::size_t e = 0; e < 9; ++e) k_.value[block + e] = e % 4 == 0 ? 2047 : 0;
    }
    send();
    Words b = rhs(s);
    for (std::size_t c = 0; c < 3; ++c) {
      b[3 * 20 + c] *= 10;
      b[3 * 21 + c] = -b[3 * 20 + c];
    }
    Words expected(kUnknowns, 0);
    const fixed::Report report = fixed::ReferenceSolver(s).solve(k_, {b, expected});
    ASSERT_EQ(report.breakdowns, 1);
    ASSERT_LT(report.iterations, s.iterations);
    EXPECT_EQ(solve(b), expected);
    expect(report, result(), "breakdown");
    EXPECT_EQ(result().cycles,
              clocks({.method = s.method, .passes = report.iterations, .broken_down = true}));
    EXPECT_EQ(accelerator_->breakdowns(), 1);
  });
}

// A reset discards the job, how early it would have ended notwithstanding.
TEST_P(EveryMethod, AResetDiscardsAJobThatWouldHaveEndedEarly) {
  run([&](test::Program& p) {
    fixed::Settings s;
    s.method = GetParam();
    s.stop_residual = 0.05;
    s.start = fixed::Start::extrapolated;
    for (int round = 0; round < 2; ++round) {
      configure(s);
      load(s);
      const Words b = rhs(s);
      Words expected(kUnknowns, 0);
      fixed::Settings from_zero = s;
      from_zero.start = fixed::Start::zero;
      const fixed::Report report = fixed::ReferenceSolver(from_zero).solve(k_, {b, expected});
      const Made made{.method = s.method, .passes = report.iterations, .extrapolated = true};
      const Picoseconds end = static_cast<Picoseconds>(clocks(made)) * kBoardClock;
      ASSERT_EQ(hvp_write_rhs(&device_, b.data(), kUnknowns), HVP_OK);
      ASSERT_EQ(hvp_start(&device_), HVP_OK);
      const Picoseconds started = now_ps();
      if (round == 0) {
        p.sleep(end / 2);
        ASSERT_EQ(hvp_reset(&device_), HVP_OK);
        p.sleep_until(started + 2 * end);
        const RegisterBank& bank = accelerator_->bank();
        EXPECT_EQ(bank.get(Register::status), 0U);
        EXPECT_EQ(bank.get(Register::result_job), 0U);
        EXPECT_EQ(packed_element(bank.memory(Aperture::u), 0, 16), 0);
        EXPECT_EQ(accelerator_->report().iterations, 0);
        EXPECT_EQ(accelerator_->saturations(), 0);
        continue;
      }
      ASSERT_EQ(hvp_wait(&device_, kTimeoutNs), HVP_OK);
      EXPECT_EQ(static_cast<Picoseconds>(result().cycles) * kBoardClock, end);
      Words u(kUnknowns);
      ASSERT_EQ(hvp_read_solution(&device_, u.data(), kUnknowns), HVP_OK);
      EXPECT_EQ(u, expected);
    }
  });
}

INSTANTIATE_TEST_SUITE_P(Methods, EveryMethod, testing::ValuesIn(kMethods));

// From the scenario's settings to the ledger: a frame's solve takes what its job made.
class MethodFrames : public testing::TestWithParam<Method> {};

TEST_P(MethodFrames, SpansTheIterationsThatWereMade) {
  SmallScene::Options options;
  options.solver.method = GetParam();
  options.solver.iterations = 30;
  options.solver.start = fixed::Start::extrapolated;
  options.solver.stop_residual = 0.3;
  SmallScene scene(options);
  scene.touch();
  scene.settings.frames = 30;
  Platform platform(scene.settings, scene.body, scene.computation, scene.contacts);
  test::FrameLog log;
  struct Reports : FrameObserver {
    explicit Reports(const Platform& p) : platform(p) {}
    void solved(const Frame& /*frame*/, const Solution& /*solution*/) override {
      made.push_back(platform.accelerator().report());
    }
    const Platform& platform;
    std::vector<fixed::Report> made;
  } reports(platform);
  platform.add_observer(log);
  platform.add_observer(reports);
  platform.run();

  ASSERT_EQ(log.frames.size(), 30U);
  int worked = 0;
  for (std::size_t n = 0; n < log.frames.size(); ++n) {
    const std::vector<Span>& spans = log.frames[n].spans;
    const auto solve = std::find_if(spans.begin(), spans.end(),
                                    [](const Span& s) { return s.phase == Phase::solve; });
    ASSERT_NE(solve, spans.end());
    const fixed::Report& report = reports.made[n];
    const int passes = report.reached || report.breakdowns > 0 ? report.iterations : 30;
    EXPECT_EQ(solve->end - solve->start,
              test::solve_time(scene.computation.board().matrix().row_begin,
                               Made{.method = GetParam(),
                                    .passes = passes,
                                    .extrapolated = true,
                                    .broken_down = report.breakdowns > 0}));
    worked += report.reached && report.iterations > 0 ? 1 : 0;
  }
  EXPECT_GT(worked, 0);
  EXPECT_EQ(platform.accelerator().illegal_accesses(), 0);
}

INSTANTIATE_TEST_SUITE_P(Methods, MethodFrames, testing::ValuesIn(kMethods));

// 2·U − (the U before), clamped to the word; only where the board has both.
class Extrapolated : public SolverSettings {
 protected:
  void begin(std::int32_t limit) {
    settings_.start = fixed::Start::extrapolated;
    settings_.iterations = 5;  // far from converged, so that the guess shows
    limit_ = limit;
    configure(settings_);
    load(settings_);
  }
  // A job, and the reference's from this guess.
  void expect_from(Words guess, const char* what, std::int64_t clamped = 0) {
    const Words b = test::words(SmallScene::kUnknowns, limit_, ++seed_);
    fixed::Report report = fixed::ReferenceSolver(settings_).solve(k_, {b, guess});
    EXPECT_EQ(solve(b), guess) << what;
    EXPECT_EQ(result().saturations, static_cast<std::uint32_t>(report.saturations + clamped))
        << what;
    if (clamped > 0) report.flags.raise(stability::Flag::saturation);
    EXPECT_EQ(result().flags, report.flags.bits()) << what;
    EXPECT_EQ(result().cycles, clocks({.passes = 5, .extrapolated = true})) << what;
    before_ = last_;
    last_ = guess;
  }
  Words line() const {
    Words guess(kUnknowns);
    for (std::size_t i = 0; i < kUnknowns; ++i) {
      guess[i] = std::clamp(2 * last_[i] - before_[i], -32767, 32767);
    }
    return guess;
  }

  fixed::Settings settings_;
  std::int32_t limit_ = 0;
  std::uint32_t seed_ = 0;
  Words last_ = Words(kUnknowns, 0);
  Words before_ = Words(kUnknowns, 0);
};

TEST_F(Extrapolated, TakesTheLineThroughTheLastTwoSolutions) {
  run([&](test::Program&) {
    begin(200);
    expect_from(last_, "the first has nothing to go by");
    expect_from(line(), "second");
    expect_from(line(), "third");

    // The host's guess, and nothing before it.
    Words guess = test::words(SmallScene::kUnknowns, 500, 77);
    ASSERT_EQ(hvp_write_initial_guess(&device_, guess.data(), kUnknowns), HVP_OK);
    last_ = guess;
    expect_from(guess, "after the host's guess");
    expect_from(line(), "and on from there");

    // A job from zero in between is not on the line.
    const Words b = rhs(settings_);
    fixed::Settings from_zero = settings_;
    from_zero.start = fixed::Start::zero;
    configure(from_zero);
    last_.assign(kUnknowns, 0);
    fixed::ReferenceSolver(from_zero).solve(k_, {b, last_});
    EXPECT_EQ(solve(b), last_);
    EXPECT_EQ(result().cycles, clocks({.passes = 5}));
    configure(settings_);
    expect_from(last_, "after a job from zero");
    expect_from(line(), "and on again");

    send();
    expect_from(last_, "another matrix");
  });
}

TEST_F(Extrapolated, AClampedGuessIsCountedAndFlagged) {
  run([&](test::Program&) {
    begin(32767);
    expect_from(last_, "first");
    Words guess = last_;
    for (std::size_t i = 0; i < kUnknowns; i += 3) guess[i] = 30000;
    ASSERT_EQ(hvp_write_initial_guess(&device_, guess.data(), kUnknowns), HVP_OK);
    settings_.iterations = 5;
    last_ = guess;
    expect_from(guess, "from the edge");
    std::int64_t clamped = 0;
    for (std::size_t i = 0; i < kUnknowns; ++i) {
      if (std::abs(2 * last_[i] - before_[i]) > 32767) ++clamped;
    }
    ASSERT_GT(clamped, 0);
    expect_from(line(), "beyond it", clamped);
  });
}

// A node that is held meanwhile is held for a solver that is made anew too.
TEST_F(SolverSettings, ChangesBetweenJobsKeepTheMatrixAsItIs) {
  run([&](test::Program&) {
    fixed::Settings s;
    s.method = Method::block_jacobi_pcg;
    configure(s);
    load(s);
    const Words b = rhs(s);
    solve(b);
    ASSERT_EQ(hvp_constrain_node(&device_, 30, 900), HVP_OK);
    k_.set_contact(30, 900);
    Words guess = test::words(SmallScene::kUnknowns, 50);
    ASSERT_EQ(hvp_write_initial_guess(&device_, guess.data(), kUnknowns), HVP_OK);
    fixed::ReferenceSolver(s).solve(k_, {b, guess});
    EXPECT_EQ(solve(b), guess);
    s.iterations = 11;
    s.replace_residual_every = 3;
    s.shift_rounding = fixed::Rounding::nearest_even;
    configure(s);
    fixed::ReferenceSolver(s).solve(k_, {b, guess});
    EXPECT_EQ(solve(b), guess);
    EXPECT_EQ(result().replacements, 3U);
  });
}

TEST_F(SolverSettings, WhatTheBoardRefusesIsSaidWithItsRegister) {
  run([&](test::Program&) {
    fixed::Settings s;
    configure(s);
    load(s);
    const Words b = rhs(s);
    // In the driver's range, beyond the board's.
    s.scaling_step = 17;
    configure(s);
    Words u(kUnknowns);
    EXPECT_EQ(hvp_solve(&device_, b.data(), u.data(), kUnknowns, kTimeoutNs),
              HVP_ERROR_BAD_SETTING);
    EXPECT_EQ(hvp_error_detail(&device_), test::offset_of(Register::scaling));
    s = {};
    s.alpha_fraction_bits = 41;
    configure(s);
    EXPECT_EQ(hvp_solve(&device_, b.data(), u.data(), kUnknowns, kTimeoutNs),
              HVP_ERROR_BAD_SETTING);
    EXPECT_EQ(hvp_error_detail(&device_), test::offset_of(Register::coefficients));
    // The matrix is still there.
    s = {};
    configure(s);
    solve(b);
    EXPECT_EQ(result().job, 1U);
  });
}

}  // namespace
}  // namespace hvp::vp::solver_settings_test
