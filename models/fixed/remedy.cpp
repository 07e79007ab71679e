#include "models/fixed/remedy.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <utility>

#include "models/config/effects.h"
#include "models/fixed/word.h"

namespace hvp::fixed {

namespace {

using stability::Flag;

// One change: alters the plan and returns true, or leaves it and returns false where it is in
// force or used up.
using Change = bool (*)(Plan& plan, const Extent& extent);

constexpr double kMostHeadroom = 16;

// What the matrix has grown to, with a fiftieth for what it grows to with other words, in two
// digits.
double wanted_headroom(const Extent& extent) {
  constexpr double kReserveOfGrowth = 1.02;
  if (!(extent.growth > 0)) return 0;
  return std::max(1.0, std::ceil(10 * kReserveOfGrowth * extent.growth) / 10);
}

// By steps where what the matrix grows to is not known, or was not enough.
bool more_headroom(Plan& plan, const Extent& extent) {
  if (!(plan.headroom > 0) || plan.headroom >= kMostHeadroom) return false;
  const double wanted = wanted_headroom(extent);
  plan.headroom = std::min(wanted > plan.headroom ? wanted : 2 * plan.headroom, kMostHeadroom);
  return true;
}

// Headroom that is not used costs its logarithm in bits of every word.
bool less_headroom(Plan& plan, const Extent& extent) {
  constexpr double kDefault = 1.25;
  const double wanted = wanted_headroom(extent);
  const double less = wanted > 0 ? wanted : std::max(kDefault, plan.headroom / 2);
  if (!(plan.headroom >= 2 * less)) return false;
  plan.headroom = less;
  return true;
}

// The matrix at rest leads away from a body that is deformed too far, and one that is not renewed
// often enough from a body that moves fast.
bool renewed_more_often(Plan& plan, const Extent& extent) {
  if (!extent.renewable || plan.renew_every <= 1) return false;
  plan.renew_every = plan.renew_every > 10 ? 10 : 1;
  return true;
}

bool renewed_matrix(Plan& plan, const Extent& extent) {
  if (!extent.renewable || plan.renew_every > 0) return false;
  plan.renew_every = 50;
  plan.headroom = 1.25;
  return true;
}

bool saturate_instead_of_wrapping(Plan& plan, const Extent& /*extent*/) {
  return std::exchange(plan.settings.overflow, Overflow::saturate) != Overflow::saturate;
}

bool wide_scalars(Plan& plan, const Extent& /*extent*/) {
  return std::exchange(plan.settings.scalar_bits, 128) != 128;
}

bool dynamic_scaling(Plan& plan, const Extent& /*extent*/) {
  const bool was_on = std::exchange(plan.settings.dynamic_scaling, true);
  const bool was_down = std::exchange(plan.settings.scaling_down, true);
  return !was_on || !was_down;
}

// The coefficients' exponents are then found in every iteration.
bool coefficients_with_their_own_shift(Plan& plan, const Extent& /*extent*/) {
  return std::exchange(plan.settings.coefficient_format, CoefficientFormat::own_shift) !=
         CoefficientFormat::own_shift;
}

bool static_scale_of_the_norm(Plan& plan, const Extent& /*extent*/) {
  if (plan.settings.preconditioned()) return false;  // it has none
  return std::exchange(plan.settings.static_scale, StaticScale::matrix_norm) !=
         StaticScale::matrix_norm;
}

bool diagonal_scaling(Plan& plan, const Extent& /*extent*/) {
  return std::exchange(plan.settings.matrix_scaling, MatrixScaling::diagonal) !=
         MatrixScaling::diagonal;
}

bool jacobi(Plan& plan, const Extent& /*extent*/) {
  if (plan.settings.preconditioned()) return false;
  plan.settings.method = Method::jacobi_pcg;
  return true;
}

// Twice what was seen: a solution on its way may be larger than where it ends.
constexpr double kReserve = 2;

// Two digits, so that what is printed is what was tried.
double wanted_range(const Extent& extent) {
  const double wanted = kReserve * extent.largest_displacement;
  if (!(wanted > 0)) return 0;
  const double digit = std::pow(10.0, std::floor(std::log10(wanted)) - 1);
  // A value that has two digits but for its last bit keeps them.
  return std::ceil(wanted / digit - 1e-9) * digit;
}

bool wider_range(Plan& plan, const Extent& extent) {
  const double wanted = wanted_range(extent);
  if (!(wanted > plan.settings.displacement_range)) return false;
  plan.settings.displacement_range = wanted;
  return true;
}

bool narrower_range(Plan& plan, const Extent& extent) {
  // Less than four bits of the word gained are not worth a change.
  constexpr double kWorthIt = 16;
  const double wanted = wanted_range(extent);
  if (!(wanted > 0) || plan.settings.displacement_range < kWorthIt * wanted) return false;
  plan.settings.displacement_range = wanted;
  return true;
}

// The vectors stay four bits wider than the matrix, as the thesis' 12 and 16 are: what the matrix
// holds more of, the vectors have to carry.
bool wider_matrix(Plan& plan, const Extent& /*extent*/) {
  constexpr int kWidest = 24;
  Settings& s = plan.settings;
  if (s.matrix_bits >= kWidest) return false;
  s.matrix_bits = std::min(s.matrix_bits + 4, kWidest);
  s.vector_bits = std::max(s.vector_bits, s.matrix_bits + 4);
  if (!s.preconditioned()) s.static_scale = StaticScale::matrix_norm;
  if (s.vector_bits > 24) s.scalar_bits = 128;
  return true;
}

bool wider_vectors(Plan& plan, const Extent& /*extent*/) {
  constexpr int kWidest = 32;
  Settings& s = plan.settings;
  if (s.vector_bits >= kWidest) return false;
  s.vector_bits = std::min(s.vector_bits + 4, kWidest);
  if (s.vector_bits > 24) s.scalar_bits = 128;
  return true;
}

constexpr int kFewPasses = 4;
constexpr int kManyPasses = 6;

// Passes and iterations are tried in two stages, with wider words between them: a matrix that is
// rounded too far cannot be made good by time.
template <int kMost>
bool more_passes(Plan& plan, const Extent& extent) {
  if (plan.passes >= std::min(kMost, extent.most_passes)) return false;
  ++plan.passes;
  return true;
}

// Increments of a matrix that is not the tangent come nearer by a factor a pass, whatever the
// words.
bool second_increment(Plan& plan, const Extent& extent) {
  if (!extent.renewable || plan.passes > 1 || extent.most_passes < 2) return false;
  plan.passes = 2;
  return true;
}

bool many_increments(Plan& plan, const Extent& extent) {
  constexpr int kMost = 16;  // that a scenario may ask for
  if (!extent.renewable || plan.passes >= kMost || extent.most_passes < kManyPasses) return false;
  plan.passes = std::min(kMost, 2 * plan.passes);
  return true;
}

template <int kMost>
bool more_iterations(Plan& plan, const Extent& /*extent*/) {
  int& iterations = plan.settings.iterations;
  if (2 * iterations > kMost) return false;
  iterations *= 2;
  return true;
}

constexpr int kFewIterations = 320;
constexpr int kManyIterations = 1280;

// The changes for a refinement whose passes do not come closer. Refinement widens the unit of the
// pass after one that saturated, and solves again what the board has solved too coarsely.
constexpr std::array<Change, 8> kForRefinement = {less_headroom,
                                                  more_passes<kFewPasses>,
                                                  renewed_matrix,
                                                  more_iterations<kFewIterations>,
                                                  wider_matrix,
                                                  more_passes<kManyPasses>,
                                                  more_iterations<kManyIterations>,
                                                  many_increments};

std::vector<Change> changes_for(Flag flag) {
  switch (flag) {
    case Flag::wrapped:
      return {saturate_instead_of_wrapping};
    case Flag::range_exceeded:
      return {wider_range, static_scale_of_the_norm};
    case Flag::scalar_overflow:
      return {wide_scalars};
    case Flag::zero_diagonal:
    case Flag::negative_curvature:
      return {diagonal_scaling, wider_matrix};
    case Flag::saturation:
    case Flag::divergence:
      return {less_headroom,
              second_increment,
              dynamic_scaling,
              coefficients_with_their_own_shift,
              static_scale_of_the_norm,
              wider_range,
              jacobi,
              wider_matrix};
    case Flag::stagnation:
      return {dynamic_scaling, coefficients_with_their_own_shift, jacobi, more_passes<kManyPasses>,
              wider_vectors};
    case Flag::matrix_rounding:
      return {diagonal_scaling, more_passes<kFewPasses>, wider_matrix, more_passes<kManyPasses>};
    case Flag::not_converged:
      return {less_headroom,
              narrower_range,
              jacobi,
              more_passes<kFewPasses>,
              renewed_matrix,
              more_iterations<kFewIterations>,
              wider_matrix,
              more_passes<kManyPasses>,
              more_iterations<kManyIterations>,
              wider_vectors,
              many_increments,
              renewed_more_often};
    case Flag::matrix_word_beyond_scale:
      return {more_headroom};
    case Flag::limit_cycle:
      return {jacobi, narrower_range, more_passes<kFewPasses>, wider_vectors};
    case Flag::locking:
    case Flag::poor_elements:
    case Flag::solver_timeout:
    case Flag::force_step:
    case Flag::force_ringing:
    case Flag::force_clamped:
    case Flag::contact_missed:
    case Flag::active_port:
    case Flag::force_saturated:
    case Flag::device_at_its_limit:
    case Flag::low_gain_margin:
    case Flag::beyond_linearity:
    case Flag::inverted_element:
    case Flag::no_start:
    case Flag::energy_overflow:
    case Flag::proxy_at_rim:
    case Flag::contact_doubtful:
    case Flag::unstable_step:
    case Flag::bus_error:
    case Flag::board_error:
    case Flag::count:
      return {};
  }
  return {};
}

bool of_a_refined_solve(Flag flag, const Plan& plan) {
  const bool of_a_pass =
      flag == Flag::saturation || flag == Flag::divergence || flag == Flag::stagnation;
  return plan.passes > 1 && of_a_pass;
}

// A cause before what follows from it.
constexpr std::array<Flag, 12> kCauses = {Flag::matrix_word_beyond_scale,
                                          Flag::wrapped,
                                          Flag::range_exceeded,
                                          Flag::scalar_overflow,
                                          Flag::zero_diagonal,
                                          Flag::negative_curvature,
                                          Flag::saturation,
                                          Flag::divergence,
                                          Flag::matrix_rounding,
                                          Flag::stagnation,
                                          Flag::not_converged,
                                          Flag::limit_cycle};

// Every parameter of the settings as "name = value", in the order of declaration.
class Listing : public config::QuietVisitor {
 public:
  std::vector<std::string> lines;

  using config::QuietVisitor::integer;
  void quantity(std::string_view name, double& value, config::Dimension dimension, config::Range,
                config::Note) override {
    std::array<char, 32> digits{};
    const bool length = dimension == config::Dimension::length;
    std::snprintf(digits.data(), digits.size(), length ? "%.3g" : "%.2g",
                  length ? 1e3 * value : value);
    add(name, length ? "\"" + std::string(digits.data()) + " mm\"" : digits.data());
  }
  void integer(std::string_view name, std::int64_t& value, config::IntegerRange,
               config::Note) override {
    add(name, std::to_string(value));
  }
  void boolean(std::string_view name, bool& value, config::Note) override {
    add(name, value ? "true" : "false");
  }
  void choice_index(std::string_view name, std::size_t& index,
                    const std::vector<std::string_view>& names, config::Note) override {
    add(name, "\"" + std::string(names[index]) + "\"");
  }

 private:
  void add(std::string_view name, const std::string& value) {
    lines.push_back("solver." + std::string(name) + " = " + value);
  }
};

std::vector<std::string> listing(Plan plan) {
  Listing list;
  list.visit(plan.settings);
  list.lines.push_back("refinement.passes = " + std::to_string(plan.passes));
  if (plan.renew_every > 0) {
    list.lines.push_back("object.model.matrix.renew_every = " + std::to_string(plan.renew_every));
  }
  if (plan.headroom > 0) {
    std::array<char, 32> digits{};
    std::snprintf(digits.data(), digits.size(), "%.3g", plan.headroom);
    list.lines.push_back("object.model.matrix.headroom = " + std::string(digits.data()));
  }
  return list.lines;
}

}  // namespace

std::optional<Remedy> next_remedy(stability::Flags flags, const Plan& plan, const Extent& extent) {
  for (const Flag flag : kCauses) {
    if (!flags.has(flag)) continue;
    std::vector<Change> changes = changes_for(flag);
    if (of_a_refined_solve(flag, plan))
      changes.assign(kForRefinement.begin(), kForRefinement.end());
    for (const Change change : changes) {
      Plan changed = plan;
      if (!change(changed, extent)) continue;
      return Remedy{.flag = flag, .plan = changed, .change = difference(plan, changed)};
    }
  }
  return std::nullopt;
}

std::vector<std::string> changes(const Plan& from, const Plan& to) {
  const std::vector<std::string> before = listing(from);
  const std::vector<std::string> after = listing(to);
  std::vector<std::string> lines;
  for (const std::string& line : after) {
    if (std::ranges::find(before, line) == before.end()) lines.push_back(line);
  }
  return lines;
}

std::string difference(const Plan& from, const Plan& to) {
  std::string text;
  for (const std::string& line : changes(from, to)) text += (text.empty() ? "" : ", ") + line;
  return text;
}

Search follow_remedies(const Plan& plan, const Trial& first, const Extent& extent,
                       const Attempt& attempt, int most) {
  Search search{.plan = plan, .last = first, .remedies = {}, .attempts = 0};
  while (!search.last.cured() && !search.last.refused && search.attempts < most) {
    std::optional<Remedy> remedy = next_remedy(search.last.flags, search.plan, extent);
    if (!remedy) break;
    search.plan = remedy->plan;
    search.remedies.push_back(std::move(*remedy));
    search.last = attempt(search.plan);
    ++search.attempts;
  }
  return search;
}

void take_back(const Plan& original, const Attempt& attempt, Search& search) {
  using TakeBack = void (*)(Plan&, const Plan&);
  constexpr std::array<TakeBack, 13> kOneByOne = {
      [](Plan& p, const Plan& o) {
        p.renew_every = o.renew_every;
        p.headroom = o.headroom;
      },
      [](Plan& p, const Plan& o) { p.headroom = o.renew_every > 0 ? o.headroom : p.headroom; },
      [](Plan& p, const Plan& o) { p.settings.matrix_bits = o.settings.matrix_bits; },
      [](Plan& p, const Plan& o) { p.settings.vector_bits = o.settings.vector_bits; },
      [](Plan& p, const Plan& o) { p.settings.scalar_bits = o.settings.scalar_bits; },
      [](Plan& p, const Plan& o) { p.passes = o.passes; },
      [](Plan& p, const Plan& o) { p.settings.iterations = o.settings.iterations; },
      [](Plan& p, const Plan& o) { p.settings.method = o.settings.method; },
      [](Plan& p, const Plan& o) { p.settings.static_scale = o.settings.static_scale; },
      [](Plan& p, const Plan& o) {
        p.settings.dynamic_scaling = o.settings.dynamic_scaling;
        p.settings.scaling_down = o.settings.scaling_down;
      },
      [](Plan& p, const Plan& o) { p.settings.coefficient_format = o.settings.coefficient_format; },
      [](Plan& p, const Plan& o) { p.settings.matrix_scaling = o.settings.matrix_scaling; },
      [](Plan& p, const Plan& o) { p.settings.displacement_range = o.settings.displacement_range; },
  };
  if (!search.last.cured()) return;
  for (const TakeBack change : kOneByOne) {
    Plan simpler = search.plan;
    change(simpler, original);
    if (simpler == search.plan || simpler == original) continue;
    const Trial trial = attempt(simpler);
    ++search.attempts;
    if (!trial.cured()) continue;
    search.plan = simpler;
    search.last = trial;
  }
}

void save_time(int least_iterations, const Attempt& attempt, Search& search) {
  if (!search.last.cured()) return;
  const Plan& plan = search.plan;
  std::vector<Plan> plans;
  for (int passes = 1; passes <= plan.passes; ++passes) {
    for (int n = least_iterations; n <= plan.settings.iterations; n *= 2) {
      if (passes * n >= plan.passes * plan.settings.iterations) break;
      plans.push_back(plan);
      plans.back().passes = passes;
      plans.back().settings.iterations = n;
    }
  }
  std::ranges::stable_sort(plans, {},
                           [](const Plan& p) { return p.passes * p.settings.iterations; });
  for (const Plan& faster : plans) {
    const Trial trial = attempt(faster);
    ++search.attempts;
    if (!trial.cured()) continue;
    search.plan = faster;
    search.last = trial;
    return;
  }
}

}  // namespace hvp::fixed
