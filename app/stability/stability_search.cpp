#include "app/stability/stability_search.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "app/run/watches.h"
#include "app/scene/unit_contacts.h"
#include "models/config/input_error.h"

namespace hvp::app {

namespace {

constexpr double kFirst = 100;         // N/m; where to begin without a better guess
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

// True where a device that swings further may have another edge: something in the loop is not
// linear.
bool amplitude_matters(const Scenario& s) {
  const plant::DeviceSettings& device = s.device_of(0);
  return device.friction || device.encoder || device.limits || device.amplifier ||
         s.host.passivity || s.host.virtual_coupling;
}

// Steps of a half from a tenth of a newton, which a fingertip feels, to what no device here gives.
constexpr double kLeastPush = 0.1;
constexpr double kPushStep = 1.5;
constexpr int kPushes = 16;

class Search {
 public:
  Search(const Scene& scene, const SearchSettings& settings, const Progress& progress)
      : scene_(scene), settings_(settings), progress_(progress) {}

  StabilityFigures find() {
    const Scenario& s = scene_.scenario();
    figures_.period_s = s.budget.period_s;
    if (s.wall) {
      figures_.damping_N_s_m = s.wall->damping_N_s_m;
      find_wall(s);
    } else {
      find_body(s);
    }
    const auto& encoder = s.device_of(0).encoder;
    if (encoder && encoder->at == plant::Encoder::At::tip && s.device_of(0).friction) {
      figures_.encoder_bound = 2 * s.device_of(0).friction->force_N / encoder->resolution;
    }
    take_least();
    return figures_;
  }

 private:
  void find_body(const Scenario& s) {
    const double own_N_m = contact_stiffness(scene_).value_or(0);
    if (own_N_m == 0) throw InputError("probe.motion", "the probe never presses on the body");
    EdgeSearch search([&](double stiffness) { return try_body(scene_, stiffness / own_N_m); },
                      kStiffest * own_N_m, progress_, "");
    search.begin(own_N_m);
    take_delay(s, search.delay_s());
    // The tolerance is larger for a body: a run takes a hundred times as long and has a delay of
    // its own.
    figures_.edges.push_back(search.find(guess(), 20 * settings_.tolerance));
    figures_.delay_s = search.delay_s();
    figures_.young_modulus_Pa =
        s.object.material.young_modulus_pa * figures_.edges.front().stiffness_max / own_N_m;
  }

  void find_wall(const Scenario& s) {
    std::vector<double> pushes = {settings_.trial.push_N};
    const bool all = settings_.all_amplitudes && amplitude_matters(s);
    if (all) {
      pushes.clear();
      for (int step = 0; step < kPushes; ++step) {
        pushes.push_back(kLeastPush * std::pow(kPushStep, step));
      }
    }
    for (const double push : pushes) {
      TrialSettings trial = settings_.trial;
      trial.push_N = push;
      EdgeSearch search([&, trial](double k) { return try_wall(scene_, k, trial); },
                        settings_.largest_N_m, progress_,
                        all ? fmt::format("pushed with {:.3g} N, ", push) : std::string());
      // A first run gives the delay with which the eigenvalues predict the result.
      const bool held = search.begin(kFirst);
      if (figures_.delay_s == 0) take_delay(s, search.delay_s());
      if (all && !held) {
        figures_.beyond_device_N = push;
        break;
      }
      StabilityEdge edge = search.find(guess(), settings_.tolerance);
      if (all && !edge.stuck) edge = search.look_below(settings_.tolerance);
      edge.push_N = push;
      edge.clamped = !held;
      figures_.edges.push_back(edge);
    }
    if (all) {
      const std::vector<StabilityEdge>& edges = figures_.edges;
      figures_.falling = figures_.beyond_device_N == 0 && edges.size() > 1 && !edges.back().stuck &&
                         edges.back().stiffness_max < edges[edges.size() - 2].stiffness_max;
      find_own_motion();
    }
  }

  void find_own_motion() {
    EdgeSearch search([&](double stiffness) { return try_motion(scene_, stiffness); },
                      settings_.largest_N_m, progress_, "the scenario's own motion, ");
    try {
      search.find(guess(), settings_.tolerance);
      const StabilityEdge edge = search.look_below(settings_.tolerance);
      // A probe that never comes to the wall says nothing of it.
      if (search.pressed()) figures_.edges.push_back(edge);
    } catch (const InputError&) {
      // Nobody rests long enough to tell: the pushes alone say it.
    }
  }

  void take_delay(const Scenario& s, double delay_s) {
    figures_.delay_s = delay_s;
    const std::optional<plant::WallLoop> loop = wall_loop(
        s, 0, delay_s, s.wall ? s.wall->direction() : Eigen::Vector3d(Eigen::Vector3d::UnitZ()));
    if (loop && delay_s <= StabilityFigures::kMostPeriods * loop->period_s) {
      figures_.linear_computed = true;
      figures_.stiffness_linear = plant::largest_stable_stiffness(*loop);
    }
    if (loop) {
      figures_.stiffness_passive =
          plant::passive_stiffness(*loop, s.device_of(0).dynamics->damping_N_s_m);
    }
  }

  double guess() const {
    return figures_.stiffness_linear > 0 ? figures_.stiffness_linear : kFirst;
  }

  void take_least() {
    const auto later = [](const StabilityEdge& edge) {
      return std::pair(edge.stuck, edge.stiffness_max);
    };
    const auto least = std::ranges::min_element(figures_.edges, {}, later);
    if (least != figures_.edges.end()) figures_.least = *least;
  }

  const Scene& scene_;
  SearchSettings settings_;
  const Progress& progress_;
  StabilityFigures figures_;
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

int StabilityFigures::runs() const {
  int sum = 0;
  for (const StabilityEdge& edge : edges) sum += edge.runs;
  return sum;
}

void StabilityFigures::report(config::Figures& f) const {
  const auto stiffness = [&f](std::string_view key, double value, std::string_view help) {
    f.quantity(key, value > 0 ? std::optional(value) : std::nullopt, "N/m", help);
  };
  stiffness("stiffness_max", least.stiffness_max,
            "the stiffest wall with which runs of the platform were stable; null where none was");
  f.quantity("left_m", least.left_m, "m",
             "half of peak to peak of what the device swings on by at that stiffness");
  stiffness(
      "unstable_from", least.unstable_from,
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
  f.count("runs", runs(), "of the platform");
  f.list(
      "edges",
      "the stiffest wall for each amplitude that was tried; `stiffness_max` is the least of those "
      "that friction does not hold",
      edges);
  f.quantity(
      "beyond_device_N", beyond_device_N > 0 ? std::optional(beyond_device_N) : std::nullopt, "N",
      "the least push of the ladder at which a force is clamped even in a soft wall: the ladder "
      "ends there");
  f.truth("falling", falling,
          "the last push of the ladder had a lower edge than the one before: a harder one, with "
          "`--push`, may have a lower one still");
  f.truth("stuck", least.stuck,
          "friction held the device in the run at `stiffness_max`, which then says nothing of the "
          "edge: lean harder, with `--push`");
  stiffness("undecided_N_m", least.undecided_N_m,
            "at this stiffness and below the device swings more slowly than a run is long; null "
            "where no run was needed there");
}

}  // namespace hvp::app
