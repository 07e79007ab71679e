#include "vp/fpga/rtl_timing.h"

#include <stdexcept>

#include "vp/fpga/every_clock.h"
#include "vp/fpga/rtl/rtl_comparison.h"

namespace hvp::vp {

namespace {

// The RTL engine gets what the other gets, and runs through a job when that is over.
class EveryRtlClock : public EveryClock {
 public:
  explicit EveryRtlClock(const accel::Architecture& architecture)
      : EveryClock(architecture), both_(engine_, rtl::kEngineThesis) {}

  void load(const fixed::QuantisedMatrix& matrix, const fixed::Settings& settings) override {
    both_.load(matrix, settings);
    EveryClock::load(matrix, settings);
  }
  void renew(const fixed::QuantisedMatrix& matrix, const fixed::Settings& settings) override {
    both_.load(matrix, settings);
    EveryClock::renew(matrix, settings);
  }
  std::optional<std::int64_t> start_load(const fixed::Settings& settings) override {
    const std::optional<std::int64_t> clocks = EveryClock::start_load(settings);
    both_.invert();
    return clocks;
  }
  std::optional<std::int64_t> start_solve(const fixed::Settings& settings,
                                          const fixed::Report& /*report*/) override {
    both_.start_solve(settings);
    engine_.start_solve(settings, &both_);
    return std::nullopt;
  }
  std::int64_t update_node(const fixed::QuantisedMatrix& matrix, int node,
                           const fixed::Settings& settings,
                           std::span<const std::int32_t> row) override {
    const std::int64_t clocks = EveryClock::update_node(matrix, node, settings, row);
    if (matrix.is_contact[static_cast<std::size_t>(node)] != 0) {
      both_.constrain(node, matrix.diagonal(3 * node));
    } else {
      both_.restore(node, row);
    }
    return clocks;
  }
  void abort() override {
    both_.abort();
    EveryClock::abort();
  }
  void write_b(std::span<const std::int32_t> words) override {
    both_.write_b(words);
    EveryClock::write_b(words);
  }
  void write_x(std::span<const std::int32_t> words) override {
    both_.write_x(words);
    EveryClock::write_x(words);
  }
  // An engine that is not that of its description is no fault of a board, from which a driver could
  // recover: the run ends here.
  bool confirms(std::span<const std::int32_t> solution) override {
    both_.end_solve();
    if (!both_.difference().empty()) throw std::runtime_error(both_.difference());
    return EveryClock::confirms(solution);
  }
  void record_port(const EnginePortSink& record) override { both_.rtl().record = record; }
  void carry_words() override {
    both_.expect_flips();
    EveryClock::carry_words();
  }
  void flip(const engine::Flip& flip) override {
    both_.flip(flip);
    EveryClock::flip(flip);
  }
  void forget_previous() override {
    both_.rtl().forget_previous();
    EveryClock::forget_previous();
  }
  std::optional<rtl::Compared> compared() const override { return both_.compared(); }
  bool open_rtl_waveform(const std::string& path, const engine::TraceWindow& window) override {
    both_.open_waveform(path, window);
    return true;
  }
  void close_rtl_waveform() override { both_.close_waveform(); }

 private:
  rtl::RtlComparison both_;
};

}  // namespace

std::unique_ptr<JobTiming> make_rtl_timing(const accel::Architecture& architecture) {
  return std::make_unique<EveryRtlClock>(architecture);
}

void require_rtl() {}

void require_rtl(const accel::Architecture& architecture) {
  rtl::require_fitting(rtl::kEngineThesis, architecture);
}

void require_rtl(const fixed::Settings& settings) {
  rtl::require_fitting(rtl::kEngineThesis, settings);
}

}  // namespace hvp::vp
