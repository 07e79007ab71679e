#include "vp/fpga/rtl_timing.h"

#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "vp/fpga/engine/layout.h"
#include "vp/fpga/every_clock.h"
#include "vp/fpga/rtl/engine_sizes.h"
#include "vp/fpga/rtl/rtl_comparison.h"

namespace hvp::vp {

namespace {

// The RTL engine gets what the other gets, and runs through a job when that is over.
class EveryRtlClock : public EveryClock {
 public:
  explicit EveryRtlClock(const accel::Architecture& architecture) : EveryClock(architecture) {
    rtl::require_buildable(architecture);
  }

  void load(const fixed::QuantisedMatrix& matrix, const fixed::Settings& settings) override {
    choose(matrix, settings);
    both_->load(matrix, settings);
    EveryClock::load(matrix, settings);
  }
  void renew(const fixed::QuantisedMatrix& matrix, const fixed::Settings& settings) override {
    both_->load(matrix, settings);
    EveryClock::renew(matrix, settings);
  }
  std::optional<std::int64_t> start_load(const fixed::Settings& settings) override {
    const std::optional<std::int64_t> clocks = EveryClock::start_load(settings);
    both_->invert();
    return clocks;
  }
  std::optional<std::int64_t> start_solve(const fixed::Settings& settings,
                                          const fixed::Report& /*report*/) override {
    both_->start_solve(settings);
    engine_.start_solve(settings, both_.get());
    return std::nullopt;
  }
  std::int64_t update_node(const fixed::QuantisedMatrix& matrix, int node,
                           const fixed::Settings& settings,
                           std::span<const std::int32_t> row) override {
    const std::int64_t clocks = EveryClock::update_node(matrix, node, settings, row);
    if (matrix.is_contact[static_cast<std::size_t>(node)] != 0) {
      both_->constrain(node, matrix.diagonal(3 * node));
    } else {
      both_->restore(node, row);
    }
    return clocks;
  }
  void abort() override {
    if (both_) both_->abort();
    EveryClock::abort();
  }
  void write_b(std::span<const std::int32_t> words) override {
    if (both_) both_->write_b(words);
    EveryClock::write_b(words);
  }
  void write_x(std::span<const std::int32_t> words) override {
    if (both_) both_->write_x(words);
    EveryClock::write_x(words);
  }
  // An engine that is not that of its description is no fault of a board, from which a driver could
  // recover: the run ends here.
  bool confirms(std::span<const std::int32_t> solution) override {
    both_->end_solve();
    if (!both_->difference().empty()) throw std::runtime_error(both_->difference());
    return EveryClock::confirms(solution);
  }
  std::string difference() const override { return both_ ? both_->difference() : std::string(); }
  void record_port(const EnginePortSink& record) override {
    record_ = record;
    if (both_) both_->rtl().record = record;
  }
  void carry_words() override {
    if (both_) both_->expect_flips();
    EveryClock::carry_words();
  }
  void flip(const engine::Flip& flip) override {
    if (both_) both_->flip(flip);
    EveryClock::flip(flip);
  }
  void forget_previous() override {
    if (both_) both_->rtl().forget_previous();
    EveryClock::forget_previous();
  }
  std::optional<rtl::Compared> compared() const override {
    return both_ ? both_->compared() : rtl::Compared{};
  }
  bool open_rtl_waveform(const std::string& path, const engine::TraceWindow& window) override {
    shown_ = {path, window};
    if (both_) both_->open_waveform(path, window);
    return true;
  }
  void close_rtl_waveform() override {
    shown_.reset();
    if (both_) both_->close_waveform();
  }

 private:
  // The board gets its engine with the first matrix, which says what is asked of it. What has been
  // written before is nothing to either engine, as a load begins with no vector.
  void choose(const fixed::QuantisedMatrix& matrix, const fixed::Settings& settings) {
    if (both_) return;
    const accel::Architecture& architecture = engine_.architecture();
    const engine::Layout layout(architecture, matrix.row_begin, matrix.column);
    const rtl::EngineSize* size = rtl::find_size(
        rtl::wanted_size(architecture, settings, {layout.nodes(), layout.most_packages()}));
    // The thesis' size says by key in what it is another.
    if (size == nullptr) size = &rtl::kEngineThesis;
    rtl::require_fitting(*size, architecture);
    rtl::require_fitting(*size, settings);
    both_ = std::make_unique<rtl::RtlComparison>(engine_, *size);
    both_->rtl().record = record_;
    if (shown_) both_->open_waveform(shown_->first, shown_->second);
  }

  EnginePortSink record_;
  std::optional<std::pair<std::string, engine::TraceWindow>> shown_;
  std::unique_ptr<rtl::RtlComparison> both_;  // null: no matrix has been loaded
};

}  // namespace

std::unique_ptr<JobTiming> make_rtl_timing(const accel::Architecture& architecture) {
  return std::make_unique<EveryRtlClock>(architecture);
}

void require_rtl() {}

void require_rtl(const accel::Architecture& architecture) { rtl::require_buildable(architecture); }

void require_rtl(const fixed::Settings& settings) { rtl::require_buildable(settings); }

void require_rtl(const accel::Architecture& architecture, const fixed::Settings& settings) {
  rtl::require_buildable(architecture, settings);
}

RtlSize rtl_size(const accel::Architecture& architecture, const fixed::Settings& settings,
                 std::span<const int> row_begin, std::span<const int> column) {
  const engine::Layout layout(architecture, row_begin, column);
  const rtl::Room room{layout.nodes(), layout.most_packages()};
  rtl::require_buildable(room);
  const rtl::EngineSize wanted = rtl::wanted_size(architecture, settings, room);
  return {rtl::identifier(wanted), rtl::parameters(wanted), rtl::find_size(wanted) != nullptr};
}

}  // namespace hvp::vp
