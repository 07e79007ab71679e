#include "app/results/misses.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "app/results/number_text.h"
#include "vp/frame/late_probability.h"
#include "vp/frame/verdict.h"

namespace hvp::results {

namespace {

// True where what a frame takes is drawn, so that another run of it may miss what this one did not.
bool draws_times(const std::vector<std::string>& effects) {
  constexpr std::array<std::string_view, 8> kDrawn = {"host.jitter",
                                                      "host.wake_up",
                                                      "host.interrupt_latencies",
                                                      "bus.read_latencies",
                                                      "bus.pcie.root_complex_latencies",
                                                      "bus.traffic",
                                                      "bus.graphics_traffic",
                                                      "host.gpu.latencies"};
  return std::ranges::any_of(
      effects, [&](const auto& effect) { return std::ranges::count(kDrawn, effect) > 0; });
}

// What so many ticks say of all: none late of 1000 is no proof that none ever is.
std::string miss_text(const vp::Verdict& v) {
  const std::int64_t ticks = v.frames() + v.skipped_ticks();
  if (ticks == 0) return {};
  const statistics::Proportion p = v.miss_share();
  constexpr const char* kOf = "(95 %, if ticks are independent)";
  // Three digits, as the bounds have: fewer would round inwards.
  if (v.misses() == 0) {
    return fmt::format("\n  a miss         in less than {:.3g} % of all ticks {}", 100 * p.high,
                       kOf);
  }
  return fmt::format("\n  a miss         in {} of these ticks, in {:.3g} % to {:.3g} % of all {}",
                     percent(p.share), 100 * p.low, 100 * p.high, kOf);
}

// What the distributions of the drawn times say of frames that were not run.
std::string late_text(const vp::LateProbability::Result& r) {
  constexpr const char* kWhat = "\n  late by chance ";
  if (!r.known()) {
    return fmt::format("{}not known: {}", kWhat,
                       r.dependent ? "the rest of a frame depends on the times that are drawn"
                                   : "too few frames are alike to tell whether it depends on the "
                                     "times that are drawn");
  }
  // The transforms tell no smaller share from none.
  constexpr double kLeast = 1e-13;
  const std::string share = r.late.share < kLeast ? fmt::format("less than {:.0e}", kLeast)
                                                  : fmt::format("{:.3g}", r.late.share);
  const std::string of = r.left_out == 0
                             ? fmt::format("all {} frames", r.frames)
                             : fmt::format("{} of {} frames", r.frames, r.frames + r.left_out);
  std::string tail;
  if (r.by_tail && r.by_tail->low > 0) {
    tail = fmt::format("; {:.2g} to {:.2g} with 95 %, by what the tail's samples tell",
                       r.by_tail->low, r.by_tail->high);
  } else if (r.by_tail) {
    tail =
        fmt::format("; up to {:.2g} with 95 %, by what the tail's samples tell", r.by_tail->high);
  }
  return fmt::format("{}with a probability of {} a frame, in the mean over {}{}", kWhat, share, of,
                     tail);
}

}  // namespace

std::string misses_text(const Outcome& o) {
  std::string text;
  if (draws_times(o.scene.effects)) text += miss_text(o.verdict);
  if (o.late_probability) text += late_text(*o.late_probability);
  return text;
}

}  // namespace hvp::results
