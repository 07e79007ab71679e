#include "app/results/loop.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "app/results/number_text.h"
#include "app/results/outcome.h"

namespace hvp::results {

std::optional<StiffnessBudget> stiffness_budget(const plant::WallLoop& loop, double device_damping,
                                                MeasuredDelay measured) {
  if (measured.worst_delay_s > kMostSamples * loop.period_s) return std::nullopt;
  StiffnessBudget b;
  b.delay_s = loop.delay_s;
  b.worst_delay_s = measured.worst_delay_s;
  b.frames = measured.frames;
  b.moving = measured.moving;
  b.contact_N_m = measured.contact_N_m;
  b.period_s = loop.period_s;
  b.stable_N_m = plant::largest_stable_stiffness(loop);
  b.passive_N_m = plant::passive_stiffness(loop, device_damping);
  plant::WallLoop worst = loop;
  worst.delay_s = measured.worst_delay_s;
  b.edge_N_m = plant::largest_stable_stiffness(worst);
  if (measured.let_go) {
    plant::WallLoop alone = worst;
    alone.device = *measured.let_go;
    b.edge_N_m = std::min(b.edge_N_m, plant::largest_stable_stiffness(alone));
  }
  b.worst_passive_N_m = plant::passive_stiffness(worst, device_damping);
  plant::WallLoop at_once = loop;
  at_once.delay_s = 0;
  at_once.device.lag_rate = 0;
  b.without_delay_N_m = plant::largest_stable_stiffness(at_once);
  b.shares = std::move(measured.after_latch);
  for (StiffnessBudget::Share& share : b.shares) {
    share.cost_N_m = plant::stiffness_cost(loop, share.time_s);
  }
  if (loop.device.lag_rate > 0) {
    plant::WallLoop without_lag = loop;
    without_lag.device.lag_rate = 0;
    b.shares.push_back({"device", "amplifier lag", 1 / loop.device.lag_rate,
                        plant::largest_stable_stiffness(without_lag) - b.stable_N_m});
  }
  std::ranges::stable_sort(b.shares, std::greater<>(), &StiffnessBudget::Share::cost_N_m);
  return b;
}

std::optional<double> StiffnessBudget::margin() const {
  if (!moving || !contact_N_m || !(*contact_N_m > 0)) return std::nullopt;
  return edge_N_m / *contact_N_m;
}

stability::Flags margin_flags(const std::optional<StiffnessBudget>& budget, double least) {
  stability::Flags flags;
  if (!budget) return flags;
  const std::optional<double> margin = budget->margin();
  if (margin && *margin < least) flags.raise(stability::Flag::low_gain_margin);
  return flags;
}

void StiffnessBudget::report(config::Figures& f) const {
  f.when(probe.has_value(), [&] {
    f.count("probe", static_cast<std::int64_t>(probe.value_or(0)),
            "with `[probe.device]`: whose device it is, from 0");
  });
  f.mean_time(
      "delay_us", delay_s * 1e12,
      "from the latch to the force at the motor, the mean of the frames in contact in which a "
      "force changes, or of all where there was none");
  f.mean_time("worst_delay_us", worst_delay_s * 1e12, "the largest of those");
  f.count("frames", frames, "of those frames");
  f.quantity("stable_N_m", stable_N_m, "N/m",
             "the stiffest wall with which the loop is stable, by its exact eigenvalues at that "
             "delay");
  f.quantity("passive_N_m", passive_N_m, "N/m",
             "the stiffest passive one: the device's damping over half a period and that delay");
  f.quantity("edge_N_m", edge_N_m, "N/m", "the stiffest stable one, at the worst delay");
  f.quantity("worst_passive_N_m", worst_passive_N_m, "N/m",
             "the stiffest passive one, at the worst delay");
  f.quantity("contact_N_m", contact_N_m, "N/m",
             "of the wall, or of the body at the stiffest contact along the probes' ways; null "
             "where it was not computed");
  f.ratio("margin", margin(),
          "the gain margin, `edge_N_m` over `contact_N_m`: below one the linear loop is unstable. "
          "Less than `budget.gain_margin`: `low-gain-margin`. Null where nothing in contact moved");
  f.quantity("without_delay_N_m", without_delay_N_m, "N/m", "stable, if no part took time");
  f.list("parts", "what each part of the delay costs; largest first", shares,
         [&f](const Share& share) {
           f.text("part", share.part, "which part of the system");
           f.text("phase", share.phase, "what it does");
           f.mean_time("mean_us", share.time_s * 1e12,
                       "its time after the latch; of an amplifier's lag the time constant");
           f.quantity("cost_N_m", share.cost_N_m, "N/m",
                      "by how much stiffer a wall could be if it took none");
         });
}

namespace {

using Out = std::back_insert_iterator<std::string>;

constexpr double kNoEnergy = 1e-12;               // J; rounding, far below what registers resolve
constexpr double kLeastShareOfStiffness = 0.005;  // of the stiffness, for a line of its own

std::string joules(double energy) {
  const double size = std::abs(energy);
  if (size < kNoEnergy) return "0 uJ";
  if (size >= 1) return fmt::format("{:.3g} J", energy);
  if (size >= 1e-3) return fmt::format("{:.3g} mJ", 1e3 * energy);
  return fmt::format("{:.3g} uJ", 1e6 * energy);
}

void rest_line(Out out, const plant::RestWatch& rest) {
  using Verdict = plant::RestWatch::Verdict;
  fmt::format_to(out, "  at rest        ");
  switch (rest.verdict()) {
    case Verdict::swings: {
      const plant::Oscillation::Cycle& cycle = *rest.cycle();
      fmt::format_to(out, "swings on by {} at {:.3g} Hz{} (frame {})\n",
                     readable_length(cycle.amplitude_m), cycle.frequency_hz,
                     cycle.grows ? " and grows" : "", cycle.frame);
      return;
    }
    case Verdict::moves_on:
      fmt::format_to(out, "moves on, at {:.3g} m/s in the end\n", *rest.moves_on());
      return;
    case Verdict::comes_to_rest:
      fmt::format_to(out, "comes to rest: moves by {} at the end\n",
                     readable_length(*rest.last_moves_m()));
      return;
    case Verdict::not_measured:
      if (!rest.compared()) {
        fmt::format_to(out, "not measured: the user never rests for half a second\n");
        return;
      }
      fmt::format_to(out,
                     "not measured: still moves by {} at the end of a rest, which is too short to "
                     "tell whether that ends\n",
                     readable_length(*rest.last_moves_m()));
      return;
  }
}

void device_lines(Out out, const plant::LoopQuality& q) {
  const plant::LoopEnergy& e = q.energy();
  fmt::format_to(out, "  energy         motors {}, hand {}; lost to damping {}, to friction {}\n",
                 joules(e.energy().by_motors), joules(e.energy().by_intention),
                 joules(e.energy().device_damping + e.energy().hand_damping),
                 joules(e.energy().friction));
  fmt::format_to(out,
                 "  of the motors' body {}, encoder {}, latency {}, converter {}, amplifier {}\n",
                 joules(e.body()), joules(e.encoder()), joules(e.latency()), joules(e.converter()),
                 joules(e.amplifier()));
  fmt::format_to(out, "  port           {}\n",
                 e.active() ? fmt::format("ACTIVE: the loop had fed in {} by frame {}",
                                          joules(-e.least_at_port()), e.least_frame())
                 : e.least_at_port() < -kNoEnergy
                     ? fmt::format("passive but for {} by frame {}, less than a thousandth of the "
                                   "energy moved",
                                   joules(-e.least_at_port()), e.least_frame())
                     : std::string("passive in every frame"));
  rest_line(out, q.rest());
  if (q.saturated_frames() > 0) {
    fmt::format_to(out, "  saturated      {} with a force that was clamped\n",
                   counted(q.saturated_frames(), "frame"));
  }
  if (q.limit_frames() > 0) {
    fmt::format_to(
        out, "  at its limit   {} out of reach, at a singular pose or with a wrong position\n",
        counted(q.limit_frames(), "frame"));
  }
}

}  // namespace

namespace {

void port_lines(Out out, const Outcome& o) {
  const std::size_t probes = std::max(o.tools.size(), o.passivity.size());
  for (std::size_t i = 0; i < probes; ++i) {
    fmt::format_to(out, "\nHost port    {}\n",
                   probes > 1 ? fmt::format("probe {}", i) : "between rendering and device");
    if (!o.tools.empty()) {
      fmt::format_to(out, "  coupling       stretched by up to {}\n",
                     readable_length(o.tools[i].largest_stretch()));
    }
    if (o.passivity.empty()) continue;
    const host::PassivityController& c = o.passivity[i];
    fmt::format_to(out, "  observer       {} in the end, at least {}\n", joules(c.observed_j()),
                   joules(c.least_j()));
    fmt::format_to(out, "  controller     {}\n",
                   c.frames_acted() == 0
                       ? std::string("did not act")
                       : fmt::format("acted in {}, in {} at its bound; up to {:.3g} N s/m",
                                     counted(c.frames_acted(), "frame"), c.frames_bound(),
                                     c.largest_damping()));
  }
}

}  // namespace

std::string loop_text(const Outcome& o) {
  std::string text;
  const Out out = std::back_inserter(text);
  for (std::size_t i = 0; i < o.loop.size(); ++i) {
    if (o.loop[i].empty()) continue;  // a device without mass beside others
    fmt::format_to(out, "\nLoop         {}\n",
                   o.loop.size() > 1 ? fmt::format("device {}", i) : "the device and its hand");
    device_lines(out, o.loop[i]);
  }
  port_lines(out, o);
  return text;
}

std::string stiffness_text(const std::optional<StiffnessBudget>& budget) {
  std::string text;
  const Out out = std::back_inserter(text);
  if (!budget) return text;
  const auto time = [](double seconds) {
    return readable_time(static_cast<vp::Picoseconds>(std::llround(seconds * 1e12)));
  };
  fmt::format_to(
      out,
      "\nStiffness    {}a wall up to {:.4g} N/m is stable, passive up to {:.4g} N/m: the "
      "force is {} late, the mean\n             of {}{}\n",
      budget->probe ? fmt::format("device {}, with the least: ", *budget->probe) : "",
      budget->stable_N_m, budget->passive_N_m, time(budget->delay_s),
      counted(budget->frames, "frame"), budget->moving ? " in contact whose force changes" : "");
  if (budget->worst_delay_s > budget->delay_s) {
    fmt::format_to(out, "  at worst {}: {:.4g} N/m, passive {:.4g} N/m\n",
                   time(budget->worst_delay_s), budget->edge_N_m, budget->worst_passive_N_m);
  }
  if (const std::optional<double> margin = budget->margin()) {
    fmt::format_to(out, "  gain margin    {:.4g}: the contact has {:.4g} N/m{}\n", *margin,
                   *budget->contact_N_m, *margin < 1 ? ", beyond the edge of the linear loop" : "");
  } else if (budget->moving) {
    fmt::format_to(out, "  gain margin    not measured: the contact's stiffness is not known\n");
  }
  for (const StiffnessBudget::Share& share : budget->shares) {
    if (share.cost_N_m < kLeastShareOfStiffness * budget->stable_N_m) continue;
    fmt::format_to(out, "  {:<22} {:>10}  costs {:>8.4g} N/m\n",
                   fmt::format("{} {}", share.part, share.phase), time(share.time_s),
                   share.cost_N_m);
  }
  fmt::format_to(out, "  {:<22} {:>10}  {:>14.4g} N/m\n", "if nothing took time", "",
                 budget->without_delay_N_m);
  return text;
}

}  // namespace hvp::results
