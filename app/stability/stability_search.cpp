#include "app/stability/stability_search.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "app/run/watches.h"
#include "app/scene/unit_contacts.h"
#include "models/config/input_error.h"

namespace hvp::app {

namespace {

constexpr double kFirst = 100;     // N/m; where to begin without a better guess
constexpr double kSoftest = 1e-2;  // below it nothing is a wall
constexpr double kStride = 1.5;
constexpr double kLastDamping = 0.97;  // of the one at which no stiffness is stable any more
constexpr double kStiffest = 1000;     // times the scenario's own body

void require_loop(const Scenario& s) {
  if (!s.has_mass(0)) {
    const std::string key = s.device_key(0) + ".dynamics";
    throw InputError(key, "a device without mass has no stability: expected [" + key + "]");
  }
}

// Returns the scene with another damping of the wall.
Scene damped(const Scene& scene, double damping) {
  Scenario s = scene.scenario();
  s.wall->damping_N_s_m = damping;
  return {s, scene.device()};
}

class Search {
 public:
  Search(const Scene& scene, const SearchSettings& settings, const Progress& progress)
      : scene_(scene), settings_(settings), progress_(progress) {}

  StabilityFigures find() {
    const Scenario& s = scene_.scenario();
    StabilityFigures figures;
    figures.period_s = s.budget.period_s;
    if (s.wall) figures.damping_N_s_m = s.wall->damping_N_s_m;
    if (!s.wall) {
      own_N_m_ = contact_stiffness(scene_).value_or(0);
      if (own_N_m_ == 0) throw InputError("probe.motion", "the probe never presses on the body");
      settings_.largest_N_m = kStiffest * own_N_m_;
    }
    // A first run gives the delay with which the eigenvalues predict the result.
    stable(s.wall ? kFirst : own_N_m_);
    const std::optional<plant::WallLoop> loop = wall_loop(
        s, 0, delay_s_, s.wall ? s.wall->direction() : Eigen::Vector3d(Eigen::Vector3d::UnitZ()));
    if (loop && delay_s_ <= StabilityFigures::kMostPeriods * loop->period_s) {
      figures.linear_computed = true;
      figures.stiffness_linear = plant::largest_stable_stiffness(*loop);
    }
    if (loop) {
      figures.stiffness_passive =
          plant::passive_stiffness(*loop, s.device_of(0).dynamics->damping_N_s_m);
    }
    bracket(figures.stiffness_linear > 0 ? figures.stiffness_linear : kFirst);
    // The tolerance is larger for a body: a run takes a hundred times as long and has a delay of
    // its own.
    const double tolerance = s.wall ? settings_.tolerance : 20 * settings_.tolerance;
    while (below_ > 0 && above_ > 0 && above_ - below_ > tolerance * below_) {
      const double middle = std::sqrt(below_ * above_);
      (stable(middle) ? below_ : above_) = middle;
    }
    figures.stiffness_max = below_;
    figures.left_m = left_m_;
    figures.unstable_from = unstable_from_;
    const auto& encoder = s.device_of(0).encoder;
    if (encoder && encoder->at == plant::Encoder::At::tip && s.device_of(0).friction) {
      figures.encoder_bound = 2 * s.device_of(0).friction->force_N / encoder->resolution;
    }
    if (!s.wall) {
      figures.young_modulus_Pa = s.object.material.young_modulus_pa * below_ / own_N_m_;
    }
    figures.delay_s = delay_s_;
    figures.runs = runs_;
    figures.undecided_N_m = undecided_;
    figures.stuck = stuck_;
    return figures;
  }

 private:
  bool stable(double stiffness) {
    ++runs_;
    if (progress_) progress_(fmt::format("run {}: {:.5g} N/m", runs_, stiffness));
    const Trial trial = scene_.has_body() ? try_body(scene_, stiffness / own_N_m_)
                                          : try_wall(scene_, stiffness, settings_.trial);
    if (!trial.decided) {
      undecided_ = std::max(undecided_, stiffness);
    } else if (!trial.stable && (unstable_from_ == 0 || stiffness < unstable_from_)) {
      unstable_from_ = stiffness;
    }
    if (delay_s_ == 0) delay_s_ = trial.delay_s;
    if (trial.stable) {
      left_m_ = trial.amplitude_m;
      stuck_ = !trial.moved;
    }
    return trial.stable;
  }

  void bracket(double guess) {
    double at = std::clamp(guess, kSoftest, settings_.largest_N_m);
    double stride = 1.02;  // the guess is a good one more often than not
    if (stable(at)) {
      below_ = at;
      while (above_ == 0 && at < settings_.largest_N_m) {
        at = std::min(settings_.largest_N_m, at * stride);
        stride = std::max(stride, kStride);
        (stable(at) ? below_ : above_) = at;
      }
      return;
    }
    above_ = at;
    while (below_ == 0 && at > kSoftest && undecided_ == 0) {
      at = std::max(kSoftest, at / stride);
      stride = std::max(stride, kStride);
      (stable(at) ? below_ : above_) = at;
    }
  }

  const Scene& scene_;
  SearchSettings settings_;
  const Progress& progress_;
  double below_ = 0;    // the stiffest that was stable
  double above_ = 0;    // the softest that was not
  double own_N_m_ = 0;  // of the scenario's own body
  double left_m_ = 0;   // of the last one that was stable
  double delay_s_ = 0;
  double unstable_from_ = 0;  // the least of the trials
  double undecided_ = 0;
  bool stuck_ = false;  // the last one that was stable
  int runs_ = 0;
};

}  // namespace

StabilityFigures find_stability(const Scene& scene, const SearchSettings& settings,
                                const Progress& progress) {
  require_loop(scene.scenario());
  return Search(scene, settings, progress).find();
}

std::vector<StabilityFigures> stability_map(const Scene& scene, const SearchSettings& settings,
                                            int count, const Progress& progress) {
  require_loop(scene.scenario());
  if (!scene.scenario().wall) {
    throw InputError("wall",
                     "a map is over a wall's damping: expected [wall] in place of [object]");
  }
  std::vector<StabilityFigures> map;
  const StabilityFigures undamped = find_stability(damped(scene, 0), settings, progress);
  map.push_back(undamped);
  // Finds the limit of the linear loop by doubling and bisection.
  const auto linear = [&](double damping) {
    const auto loop = wall_loop(damped(scene, damping).scenario(), 0, undamped.delay_s,
                                scene.scenario().wall->direction());
    return loop ? plant::largest_stable_stiffness(*loop) : 0;
  };
  double some = 1e-3;
  while (linear(some) > 0 && some < 1e6) some *= 2;
  double none = some;
  some *= 0.5;
  for (int i = 0; i < 12; ++i) {
    const double middle = 0.5 * (some + none);
    (linear(middle) > 0 ? some : none) = middle;
  }
  // The bound of passivity ends where the wall is damped as much as the device. At that end the
  // remaining stiffness is too small for a trial.
  std::vector<double> dampings = {scene.scenario().device_of(0).dynamics->damping_N_s_m};
  for (int i = 1; i < count; ++i) dampings.push_back(kLastDamping * some * i / (count - 1));
  std::ranges::sort(dampings);
  for (const double damping : dampings) {
    if (damping > 0 && damping < some) {
      map.push_back(find_stability(damped(scene, damping), settings, progress));
    }
  }
  return map;
}

void StabilityFigures::report(config::Figures& f) const {
  const auto stiffness = [&f](std::string_view key, double value, std::string_view help) {
    f.quantity(key, value > 0 ? std::optional(value) : std::nullopt, "N/m", help);
  };
  stiffness("stiffness_max", stiffness_max,
            "the stiffest wall with which runs of the platform were stable; null where none was");
  f.quantity("left_m", left_m, "m",
             "half of peak to peak of what the device swings on by at that stiffness");
  stiffness(
      "unstable_from", unstable_from,
      "the softest with which one was not; null up to 10 MN/m, or 1000 times the scenario's own "
      "body");
  stiffness("stiffness_linear", stiffness_linear,
            "by the exact eigenvalues of device, hand, period, delay and wall, without steps, "
            "friction and limits; null where no stiffness is stable, and where it was not "
            "computed");
  f.truth("linear_computed", linear_computed,
          "false for coupled axes, and for a delay of more than 64 periods");
  f.quantity("stiffness_passive", stiffness_passive, "N/m",
             "(b − |B|)/(T/2 + L): a softer wall is passive, whoever holds the device (Colgate & "
             "Schenkel 1997)");
  stiffness("stiffness_encoder", encoder_bound,
            "2·f_c/Δ, with friction and an encoder: a softer wall comes to rest between its steps "
            "(Abbott & Okamura 2005)");
  f.mean_time("delay_us", delay_s * 1e12,
              "L: from the latch of the position to the force at the motor, mean");
  f.mean_time("period_us", period_s * 1e12, "T");
  f.quantity(
      "young_modulus_Pa", young_modulus_Pa > 0 ? std::optional(young_modulus_Pa) : std::nullopt,
      "Pa",
      "of the body that has stiffness_max at its contact, those of its regions in proportion; "
      "null for a wall");
  f.quantity("wall_damping_N_s_m", damping_N_s_m, "N·s/m", "B");
  f.count("runs", runs, "of the platform");
  f.truth("stuck", stuck,
          "friction held the device in the run at `stiffness_max`, which then says nothing of the "
          "edge: lean harder, with `--push`");
  stiffness("undecided_N_m", undecided_N_m,
            "at this stiffness and below the device swings more slowly than a run is long; null "
            "where no run was needed there");
}

}  // namespace hvp::app
