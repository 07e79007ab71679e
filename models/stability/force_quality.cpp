#include "models/stability/force_quality.h"

#include <algorithm>
#include <cmath>

namespace hvp::stability {

namespace {

constexpr double kSmallestChange = 1e-9;  // N, of the first bin

void keep_worst(WorstFrame& worst, double value, std::int64_t frame) {
  if (worst.frame >= 0 && !(value > worst.value)) return;
  worst = {value, frame};
}

}  // namespace

void ForceQuality::add(const FeltForce& felt) {
  if (felt.force.norm() > 0) keep_worst(peak_, felt.force.norm(), felt.frame);
  if (felt.pull > 0) keep_worst(pull_, felt.pull, felt.frame);
  if (any_) {
    const Eigen::Vector3d change = felt.force - last_.force;
    if (change.norm() > 0) keep_worst(step_, change.norm(), felt.frame);
    count_alternation(felt, change);
    last_change_ = change;
  } else {
    alternations_began_s_ = felt.time_s;
  }
  watch_hand_over(felt);
  watch_rest(felt);
  last_ = felt;
  any_ = true;
}

double ForceQuality::step_share() const { return peak_.value > 0 ? step_.value / peak_.value : 0; }

// frexp and a table of roots, so that the bin is the same everywhere.
int ForceQuality::bin(double change) {
  constexpr std::array<double, kBinsAnOctave> kRoots = {0.5, 0.5946035575013605, 0.7071067811865476,
                                                        0.8408964152537145};
  if (!(change > kSmallestChange)) return 0;
  int exponent = 0;
  const double mantissa = std::frexp(change / kSmallestChange, &exponent);
  const auto within = std::upper_bound(kRoots.begin(), kRoots.end(), mantissa) - kRoots.begin() - 1;
  return std::min(kBinsAnOctave * (exponent - 1) + static_cast<int>(within), kBins - 1);
}

void ForceQuality::count_alternation(const FeltForce& felt, const Eigen::Vector3d& change) {
  const bool over = alternations_frames_ >= kWindowFrames &&
                    felt.time_s >= alternations_began_s_ + kWindowSeconds;
  if (over) {
    close_alternations();
    alternations_began_s_ = felt.time_s;
  }
  ++alternations_frames_;
  const double turned =
      change.dot(last_change_) < 0 ? std::min(change.norm(), last_change_.norm()) : 0;
  const double alternated = std::min(turned, last_turned_);
  last_turned_ = turned;
  if (alternated > 0) ++alternations_[static_cast<std::size_t>(bin(alternated))];
}

void ForceQuality::close_alternations() {
  std::int32_t with_at_least = 0;
  for (std::size_t at = kBins; at-- > 0;) {
    with_at_least += alternations_[at];
    most_alternations_[at] = std::max(most_alternations_[at], with_at_least);
  }
  alternations_ = {};
  alternations_frames_ = 0;
}

std::int64_t ForceQuality::alternations() const {
  ForceQuality closed = *this;
  closed.close_alternations();
  // The bin that the bound falls into counts as below it.
  const int above = bin(std::max(kRingingShare * peak_.value, kNoForce)) + 1;
  return above < kBins ? closed.most_alternations_[static_cast<std::size_t>(above)] : 0;
}

const ForceQuality::Past* ForceQuality::past(double time_s) const {
  constexpr double kRounding = 1e-9;  // s
  for (std::size_t back = 0; back < std::min(kept_, kPasts); ++back) {
    const Past& one = pasts_[(kept_ - 1 - back) % kPasts];
    if (one.time_s <= time_s + kRounding) return &one;
  }
  return nullptr;
}

void ForceQuality::watch_hand_over(const FeltForce& felt) {
  Past now{felt.time_s, felt.force, felt.force.norm(), felt.tip};
  if (felt.foot) {
    now.force = felt.force.dot(felt.normal) * felt.normal;
    now.way -= *felt.foot;
  }
  if (felt.contact < 0) {
    touched_.reset();
  } else if (!touched_ || last_.contact < 0) {
    touched_ = now;
    handed_over_s_ = -1;
  } else if (felt.contact != last_.contact) {
    handed_over_s_ = felt.time_s;
  }
  if (touched_ && handed_over_s_ >= 0) {
    for (std::size_t i = 0; i < kSpans.size(); ++i) {
      const double began_s = felt.time_s - 2 * kSpans[i];
      if (touched_->time_s > began_s || handed_over_s_ <= began_s) continue;
      const Past* middle = past(felt.time_s - kSpans[i]);
      const Past* first = past(began_s);
      // Where a frame is longer than the span there is nothing to look back to.
      if (middle == nullptr || first == nullptr || middle == first) continue;
      const double force = std::max({now.size, middle->size, first->size});
      const double way = (felt.foot ? now.way : Eigen::Vector3d(now.way - touched_->way)).norm();
      if (!(force > kNoForce) || !(way > 0)) continue;
      // The normal turns with the surface; a node's force turns with its hand-overs.
      const double change =
          (felt.foot ? std::abs(now.force.norm() - 2 * middle->force.norm() + first->force.norm())
                     : (now.force - 2 * middle->force + first->force).norm()) /
          force;
      const double explained = (now.way - 2 * middle->way + first->way).norm() / way;
      if (change > explained) keep_worst(handed_over_[i], change - explained, felt.frame);
    }
  }
  if (kept_ == 0 || felt.time_s >= pasts_[(kept_ - 1) % kPasts].time_s + kPastSeconds) {
    pasts_[kept_ % kPasts] = now;
    ++kept_;
  }
}

void ForceQuality::watch_rest(const FeltForce& felt) {
  const bool rests = any_ && !felt.fades && felt.contact >= 0 && felt.contact == last_.contact &&
                     felt.tip == last_.tip;
  if (!rests) {
    rest_ = {};
    ripple_before_.reset();
    return;
  }
  const bool full = rest_.frames >= kWindowFrames && felt.time_s >= rest_.began_s + kRestSeconds;
  if (full) close_rest_window();
  if (rest_.frames == 0) rest_ = {felt.time_s, 0, felt.force, felt.force, Eigen::Vector3d::Zero()};
  ++rest_.frames;
  rest_.least = rest_.least.cwiseMin(felt.force);
  rest_.most = rest_.most.cwiseMax(felt.force);
  rest_.sum += felt.force;
}

void ForceQuality::close_rest_window() {
  const double mean = rest_.sum.norm() / static_cast<double>(rest_.frames);
  const double moves = (rest_.most - rest_.least).maxCoeff();
  const double ripple = mean > kNoForce ? moves / mean : 0;
  if (ripple_before_) {
    rested_ = true;
    if (ripple > kSettles * *ripple_before_) keep_worst(ripple_, ripple, last_.frame);
  }
  ripple_before_ = ripple;
  rest_ = {};
}

std::optional<double> ForceQuality::ripple() const {
  ForceQuality closed = *this;
  const bool full = rest_.frames >= kWindowFrames && last_.time_s >= rest_.began_s + kRestSeconds;
  if (full) closed.close_rest_window();
  if (!closed.rested_) return std::nullopt;
  return closed.ripple_.value;
}

Flags ForceQuality::flags() const {
  Flags flags;
  if (step_.value > kNoForce && step_share() > kLargestStep) flags.raise(Flag::force_step);
  for (const WorstFrame& change : handed_over_) {
    if (change.value > kNoticeable) flags.raise(Flag::force_step);
  }
  if (alternations() > kMostAlternations) flags.raise(Flag::force_ringing);
  if (ripple().value_or(0) > kRipple) flags.raise(Flag::limit_cycle);
  return flags;
}

void ForceQuality::report(config::Figures& f) const {
  const auto newtons = [&f](const WorstFrame& worst) {
    f.quantity("N", worst.value, "N", "how large");
    f.frame("frame", worst.frame, "the frame that has it, or null");
  };
  f.table("largest", "the largest |F|", [&] { newtons(peak_); });
  f.table("step", "the largest change from one frame to the next. Over a tenth: `force-step`", [&] {
    newtons(step_);
    f.ratio("of_largest_rel", step_share(), "of the largest |F|");
  });
  f.table("handed_over",
          "how much the force changes while a contact is handed from node to node, beyond what the "
          "tip's motion and the trend before explain, of the force itself. Over a tenth: "
          "`force-step` (people notice 7 to 10 %, Jones 1989, Pang et al. 1991)",
          [&] {
            const auto change = [&](const WorstFrame& worst, std::string_view share,
                                    std::string_view frame) {
              f.ratio(share, worst.value, "the most");
              f.frame(frame, worst.frame, "the frame that ends it, or null");
            };
            change(handed_over_[0], "within_30_ms_rel", "within_30_ms_frame");
            change(handed_over_[1], "within_100_ms_rel", "within_100_ms_frame");
          });
  f.count(
      "alternations", alternations(),
      "the most turns of the force in a row, beyond 2 % of the largest, in a tenth of a second. "
      "Over eight: `force-ringing`");
  f.table(
      "pull",
      "the largest force along the surface's outward normal: the tip pulls, which no tip can. A "
      "pass of the collision process late, contact ends",
      [&] { newtons(pull_); });
  f.ratio("ripple_rel", ripple(),
          "peak to peak of the force while the tip rests, of what does not settle, over its mean; "
          "null where it never rested long enough. Over 1.5 %: `limit-cycle`");
}

}  // namespace hvp::stability
