#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "vp/fpga/engine/cycle_engine.h"
#include "vp/fpga/job_timing.h"

namespace hvp::vp {

// Every clock and every word, by engine::CycleEngine.
class EveryClock : public JobTiming {
 public:
  explicit EveryClock(const accel::Architecture& architecture) : engine_("engine", architecture) {}

  void load(const fixed::QuantisedMatrix& matrix, const fixed::Settings& settings) override {
    engine_.load(matrix, settings);
  }
  void renew(const fixed::QuantisedMatrix& matrix, const fixed::Settings& settings) override {
    engine_.load(matrix, settings);
  }
  std::optional<std::int64_t> start_load(const fixed::Settings& /*settings*/) override {
    engine_.start_inversion();
    return std::nullopt;
  }
  std::optional<std::int64_t> start_solve(const fixed::Settings& settings,
                                          const fixed::Report& /*report*/) override {
    engine_.start_solve(settings);
    return std::nullopt;
  }
  // The engine writes its packages while the access that gave the command is stalled.
  std::int64_t update_node(const fixed::QuantisedMatrix& matrix, int node,
                           const fixed::Settings& /*settings*/,
                           std::span<const std::int32_t> row) override {
    if (matrix.is_contact[static_cast<std::size_t>(node)] != 0) {
      engine_.start_constraining(node, matrix.diagonal(3 * node));
    } else {
      engine_.start_restoring(node, row);
    }
    return engine_.update_clocks();
  }
  void abort() override { engine_.abort(); }

  const sc_core::sc_event* ended() const override { return &engine_.done(); }
  std::optional<SolveClocks> solve_clocks() const override {
    return SolveClocks{engine_.clocks(), engine_.state_clocks()};
  }

  bool has_words() const override { return true; }
  void write_b(std::span<const std::int32_t> words) override { engine_.write_b(words); }
  void write_x(std::span<const std::int32_t> words) override { engine_.write_x(words); }
  bool confirms(std::span<const std::int32_t> solution) override {
    x_.resize(solution.size());
    engine_.read_x(x_);
    return std::ranges::equal(x_, solution);
  }
  void forget_previous() override { engine_.forget_previous(); }
  void carry_words() override { engine_.carry_words(); }
  void flip(const engine::Flip& flip) override { engine_.flip(flip); }
  void read_x(std::span<std::int32_t> words) const override { engine_.read_x(words); }
  fixed::Report report() override { return engine_.report(); }

  const engine::CycleEngine* engine() const override { return &engine_; }

 protected:
  engine::CycleEngine engine_;

 private:
  std::vector<std::int32_t> x_;
};

}  // namespace hvp::vp
