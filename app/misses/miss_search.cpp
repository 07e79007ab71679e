#include "app/misses/miss_search.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include <fmt/format.h>

#include "app/process/child_process.h"
#include "models/config/input_error.h"
#include "models/random/tilt.h"
#include "models/statistics/proportion.h"
#include "vp/frame/late_probability.h"
#include "vp/frame/rare_misses.h"
#include "vp/platform.h"

namespace hvp::app {

namespace {

using nlohmann::json;
using vp::RareMisses;

// What the scenario draws times from.
std::vector<random::TimeDistribution*> drawn_times(vp::PlatformSettings& s) {
  std::vector<random::TimeDistribution*> all;
  const auto add = [&all](auto& effect) {
    if (effect && effect->kind != random::TimeDistribution::Kind::constant) all.push_back(&*effect);
  };
  add(s.host.jitter);
  add(s.host.wake_up);
  add(s.host.interrupt_latencies);
  if (s.host.gpu) add(s.host.gpu->latencies);
  add(s.bus.read_latencies);
  if (s.bus.pcie) add(s.bus.pcie->root_complex_latencies);
  return all;
}

struct OneRun {
  double late = 0;
  std::int64_t seen = 0;
  std::int64_t frames = 0;
  std::int64_t left_out = 0;
  std::vector<std::string> tables;
  std::vector<std::uint32_t> draws;
  std::optional<double> by_convolution;
  MissFigures::Convolution convolution = MissFigures::Convolution::of_other_times;
};

// SystemC elaborates once in a process.
OneRun run_once(Scene& scene, std::int64_t seed, const random::Tilt::Settings& tilted) {
  const json told = json::parse(in_child([&] {
    vp::PlatformSettings settings = platform_settings(scene);
    settings.seed = seed;
    random::Tilt tilt(tilted);
    for (random::TimeDistribution* drawn : drawn_times(settings)) drawn->tilt = &tilt;
    vp::Platform platform(
        settings, scene.has_body() ? std::optional(soft_body(scene)) : std::nullopt, nullptr);
    RareMisses misses(tilt, platform.verdict().budget());
    platform.add_observer(misses);
    std::optional<vp::LateProbability> late;
    if (tilted.draws.empty() && vp::LateProbability::applies(scene.scenario().host)) {
      platform.add_observer(late.emplace(scene.scenario().host, platform.verdict().budget()));
    }
    platform.run();
    json convolved;
    auto why = MissFigures::Convolution::of_other_times;
    if (late) {
      const auto result = late->result();
      if (result && result->known()) convolved = result->late.share;
      why = !result || result->untested ? MissFigures::Convolution::untested
            : result->dependent         ? MissFigures::Convolution::dependent
                                        : MissFigures::Convolution::known;
    }
    return json{{"late", misses.late()},     {"seen", misses.seen()},
                {"frames", misses.frames()}, {"left_out", misses.left_out()},
                {"tables", tilt.tables()},   {"draws", tilt.counted()},
                {"convolved", convolved},    {"why", static_cast<int>(why)}}
        .dump();
  }));
  OneRun run;
  run.late = told.at("late");
  run.seen = told.at("seen");
  run.frames = told.at("frames");
  run.left_out = told.at("left_out");
  run.convolution = static_cast<MissFigures::Convolution>(told.at("why").get<int>());
  run.tables = told.at("tables").get<std::vector<std::string>>();
  run.draws = told.at("draws").get<std::vector<std::uint32_t>>();
  if (!told.at("convolved").is_null()) run.by_convolution = told.at("convolved").get<double>();
  return run;
}

}  // namespace

MissFigures find_misses(Scene& scene, const MissSettings& wanted, const Progress& progress) {
  vp::PlatformSettings settings = platform_settings(scene);
  MissFigures figures;
  for (const random::TimeDistribution* drawn : drawn_times(settings)) {
    figures.pareto = figures.pareto || (drawn->kind == random::TimeDistribution::Kind::measured &&
                                        drawn->tail == random::TimeDistribution::Tail::pareto);
  }
  if (drawn_times(settings).empty()) {
    throw InputError(
        "no time is drawn in this scenario: expected [host.jitter], [host.wake_up], "
        "[host.interrupt_latencies], [bus.read_latencies], [bus.pcie.root_complex_latencies] or "
        "[host.gpu.latencies] with another distribution than \"constant\"");
  }
  // What is drawn in a frame is counted by a run as it comes.
  if (progress) progress("counting what a frame draws");
  const std::int64_t seed = scene.scenario().seed;
  random::Tilt::Settings tilted;
  const OneRun as_it_comes = run_once(scene, seed, tilted);
  figures.by_convolution = as_it_comes.by_convolution;
  figures.convolution = as_it_comes.convolution;
  for (std::size_t i = 0; i < as_it_comes.draws.size(); ++i) {
    figures.effects.push_back({as_it_comes.tables[i], as_it_comes.draws[i]});
  }
  // Rows of late frames that have no end weigh as all their times do together, which is next to
  // nothing: what is frequent is counted as it comes.
  constexpr double kFrequent = 0.05;
  figures.plain = as_it_comes.late > kFrequent * static_cast<double>(as_it_comes.frames);
  if (!figures.plain) tilted.draws = as_it_comes.draws;
  double late = 0;
  double squares = 0;
  int with_late = 0;
  double error = 0;  // of `late`
  constexpr double kNormal = 1.96;
  constexpr int kFewest = 30;
  while (figures.runs < wanted.most_runs) {
    tilted.seed = ++figures.runs;
    if (progress) {
      progress(fmt::format("run {} of at most {}: {} late forces", figures.runs, wanted.most_runs,
                           figures.seen));
    }
    const OneRun run = run_once(scene, seed + figures.runs, tilted);
    late += run.late;
    squares += run.late * run.late;
    with_late += run.seen > 0 ? 1 : 0;
    figures.seen += run.seen;
    figures.frames += run.frames;
    figures.left_out += run.left_out;
    if (figures.runs < 2) continue;
    const double n = figures.runs;
    error = std::sqrt(std::max(0.0, squares - late * late / n) * n / (n - 1));
    figures.uncertain = with_late < kFewest;
    if (!figures.uncertain && kNormal * error < wanted.precision * late) break;
    if (figures.seen == 0 && figures.runs >= wanted.runs_in_vain) break;
  }
  if (figures.frames == 0) return figures;
  const double share = late / static_cast<double>(figures.frames);
  // The logarithm is nearer to normal.
  const double factor = late > 0 ? std::exp(kNormal * error / late) : 1;
  using statistics::Rounding;
  figures.share = rounded_share(share, Rounding::nearest);
  figures.low = rounded_share(share / factor, Rounding::down);
  figures.high = rounded_share(std::min(1.0, share * factor), Rounding::up);
  return figures;
}

void MissFigures::report(config::Figures& f) const {
  std::optional<double> known;
  std::optional<double> least;
  std::optional<double> most;
  if (seen > 0) known = share;
  if (!uncertain) least = low, most = high;
  f.ratio("share", known, "the probability that a frame's force is late; null: none was");
  f.ratio("low", least, "at least so much with 95 %; null: too few runs had a late one");
  f.ratio("high", most, "and at most so much");
  f.ratio("by_convolution", by_convolution,
          "the same by hvp run's deadline.late_probability, over the frames of one run");
  f.count("seen", seen, "late frames, most of them by times that come less often");
  f.truth("plain", plain, "more than one in twenty is late: all times were drawn as they come");
  f.truth("tail_as_stated", pareto,
          "a Pareto tail is taken as stated: what its samples leave open is in hvp run's "
          "deadline.late_probability");
  f.count("runs", runs, "");
  f.count("frames", frames, "that were counted");
  f.count("left_out", left_out, "frames whose solve failed");
}

}  // namespace hvp::app
