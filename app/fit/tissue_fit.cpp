#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "app/fit/fit_request.h"
#include "app/scene/scene.h"
#include "models/config/declaration.h"
#include "models/config/input_error.h"
#include "models/fit/qlv_problem.h"
#include "models/fit/qlv_tissue.h"
#include "models/fit/tissue_frames.h"
#include "models/fit/tissue_problem.h"
#include "models/fit/tissue_proxy_frames.h"
#include "models/fit/tissue_scenario.h"

namespace hvp::app {

namespace {

// The contact at which a log was measured.
struct ContactSettings {
  int node = -1;
  Eigen::Vector3d direction = {0, 0, -1};
  std::string log;

  void declare(config::Visitor& v) {
    v.integer("node", node, {-1, 100'000'000},
              {"of the mesh, as `hvp run` writes it into frames.csv; -1: the outermost one",
               "-1: what an indenter meets first"});
    v.vector("direction", direction, config::Dimension::dimensionless, {},
             {"of the displacement, into the body", "downwards"});
    v.text("log", log, {"the file of this contact; empty: the command's own"});
  }
};

struct TissueFitSettings {
  std::vector<ContactSettings> contacts = {{}};
  bool frames = false;

  void declare(config::Visitor& v) {
    v.boolean(
        "frames", frames,
        {"the log is a frames.csv of `hvp run`: where it touched, its way and its force are in it",
         "a machine's log has none of them"});
    v.one_or_more("contact", contacts,
                  {"where the logs were taken; two contacts give Poisson's ratio"});
  }
};

// The outermost mesh node against the direction that is not anchored.
int outermost(const fit::TissueBody& body, const Eigen::Vector3d& direction) {
  int best = -1;
  double height = 0;
  for (int node = 0; node < static_cast<int>(body.mesh.nodes.size()); ++node) {
    if (std::binary_search(body.anchored.begin(), body.anchored.end(), node)) continue;
    const double at = -direction.dot(body.mesh.nodes[static_cast<std::size_t>(node)]);
    if (best < 0 || at > height) {
      best = node;
      height = at;
    }
  }
  return best;
}

fit::TissueBody body_of(const FitRequest& request) {
  if (!request.scenario) {
    throw InputError("--scenario: expected the scenario whose body the log is of");
  }
  const Scenario& s = *request.scenario;
  if (s.wall) throw InputError("--scenario: expected one with a body, found a wall");
  if (!s.object.regions.empty()) {
    throw InputError(
        "--scenario: expected a body of one material, which the fit finds: found "
        "[[object.region]]");
  }
  if (s.object.elements != fem::Elements::linear) {
    throw InputError(
        "--scenario: tissue is fitted with linear elements: expected "
        "object.elements = \"linear\"");
  }
  if (s.contact.search.kind == collision::ContactKind::patch) {
    throw InputError(
        "--scenario: tissue is fitted under a node or a proxy: expected another contact.kind than "
        "\"patch\"");
  }
  const std::unique_ptr<fem::Body> made = make_body(s, {});
  fit::TissueBody body;
  body.mesh = made->mesh();
  body.anchored = made->anchored();
  body.density_kg_m3 = made->material().density_kg_m3;
  body.dynamics = s.dynamics;
  body.period_s = s.budget.period_s;
  body.velocity_of_way = s.contact.search.hand_over_s > 0;
  return body;
}

bool touches_by_proxy(const FitRequest& request) {
  return request.scenario->contact.search.kind == collision::ContactKind::proxy;
}

// What the frames of a run with a proxy do not tell, or tell otherwise.
void expect_one_proxy_alone(const Scenario& s) {
  const auto refuse = [](const char* found) {
    throw InputError(fmt::format(
        "--scenario: frames of a proxy are fitted as of one probe that acts on the body alone: "
        "found {}",
        found));
  };
  if (s.probes.size() > 1) refuse("several [[probe]]");
  if (s.host.virtual_coupling) refuse("[host.virtual_coupling], whose tool touches the body");
  if (s.host.passivity) refuse("[host.passivity], which adds to the force");
  const std::unique_ptr<fem::Body> made = make_body(s, {});
  if (std::ranges::any_of(made->load(), [](double newton) { return newton != 0; })) {
    refuse("loads on the body");
  }
}

std::vector<double> displacement_of(const files::Log& log) {
  for (const char* name : {"travel", "depth"}) {
    if (log.find(name) != nullptr) return log.column(name, "m").values;
  }
  return log.column("displacement", "m").values;
}

std::vector<FittedSetting> settings_of(const fit::TissueBody& body, const fit::Fit& fit) {
  std::vector<FittedSetting> settings;
  for (const fit::ScenarioWord& word : fit::scenario_words(body, fit.parameters)) {
    const std::size_t dot = word.key.rfind('.');
    std::string parameter;
    for (const fit::TissueKey& key : fit::tissue_keys()) {
      if (key.key == word.key) parameter = key.parameter;
    }
    settings.push_back({word.key.substr(0, dot), word.key.substr(dot + 1), word.value, parameter});
  }
  return settings;
}

// Reads a vector for each sample from the columns of its components.
std::vector<Eigen::Vector3d> vectors_of(const files::Log& log, const std::string& name,
                                        const char* unit) {
  std::vector<Eigen::Vector3d> vectors(log.time.size());
  Eigen::Index k = 0;
  for (const char* axis : {"x", "y", "z"}) {
    const std::vector<double>& values = log.column(name + axis, unit).values;
    for (std::size_t i = 0; i < vectors.size(); ++i) vectors[i][k] = values[i];
    ++k;
  }
  return vectors;
}

// Reads the touches in the frames.csv of a run, whose columns have the platform's names.
fit::FrameTouches touches_of_run(const FitRequest& request, const fit::TissueBody& body,
                                 const Eigen::Vector3d& direction, files::Log& log) {
  FitRequest asked = request;
  asked.reading.columns = {"time_us=born_us", "node_counts=contact_node"};
  asked.reading.count_size = 1;
  for (const char* axis : {"x", "y", "z"}) {
    asked.reading.columns.push_back(fmt::format("tip{}_m={}_m", axis, axis));
    asked.reading.columns.push_back(fmt::format("force{}_N=f{}_N", axis, axis));
  }
  log = asked.read({"node", "tipx", "tipy", "tipz", "forcex", "forcey", "forcez"});
  const bool proxy = touches_by_proxy(request);
  const bool by_proxy = std::ranges::find(log.left_aside, "foot_x_m") != log.left_aside.end();
  if (proxy != by_proxy) {
    const auto contact = [](bool is_proxy) { return is_proxy ? "a proxy" : "a node"; };
    throw InputError(
        fmt::format("{}:1: {} column foot_x_m, so that the contact is {}, and that of --scenario "
                    "is {}: expected the scenario of the run",
                    log.file, by_proxy ? "has a" : "has no", contact(by_proxy), contact(proxy)));
  }
  fit::GlidingFrames frames;
  frames.time = log.time;
  frames.tip = vectors_of(log, "tip", "m");
  frames.force = vectors_of(log, "force", "N");
  for (const double node : log.find("node")->values) {
    frames.contact_node.push_back(static_cast<int>(node));
  }
  if (!proxy) {
    return fit::touches_of_frames(body, frames, direction, request.scenario->contact.search);
  }
  expect_one_proxy_alone(*request.scenario);
  asked.reading.columns = {"time_us=born_us", "slides_counts=slides"};
  for (const char* axis : {"x", "y", "z"}) {
    asked.reading.columns.push_back(fmt::format("foot{}_m=foot_{}_m", axis, axis));
  }
  const files::Log feet = asked.read({"slides", "footx", "footy", "footz"});
  frames.foot = vectors_of(feet, "foot", "m");
  for (const double slides : feet.find("slides")->values) frames.slides.push_back(slides != 0);
  return fit::touches_of_frames(
      body, frames, direction,
      {request.scenario->probes.front().radius, request.scenario->contact.search.friction});
}

}  // namespace

FitOutcome fit_tissue(const FitRequest& request) {
  const auto settings = model_settings<TissueFitSettings>(request.overrides);
  const fit::TissueBody body = body_of(request);
  std::vector<fit::TissueLog> touches;
  files::Log log;
  std::vector<std::string> warnings;
  for (const ContactSettings& contact : settings.contacts) {
    FitRequest of_contact = request;
    if (!contact.log.empty()) of_contact.log = contact.log;
    if (settings.frames) {
      fit::FrameTouches found = touches_of_run(of_contact, body, contact.direction, log);
      for (fit::TissueLog& touch : found.logs) touches.push_back(std::move(touch));
      for (std::string& w : found.warnings) warnings.push_back(std::move(w));
      continue;
    }
    log = of_contact.read({"force", "displacement", "travel", "depth"});
    const int node = contact.node >= 0 ? contact.node : outermost(body, contact.direction);
    if (node >= static_cast<int>(body.mesh.nodes.size())) {
      throw InputError(fmt::format("--set contact.node={}: the mesh has {} nodes", node,
                                   body.mesh.nodes.size()));
    }
    fit::TissueLog touch{
        {node}, contact.direction, log.time, displacement_of(log), log.column("force", "N").values};
    if (touches_by_proxy(request)) {
      touch.proxy = press_at_node(body, node, contact.direction, touch.displacement,
                                  request.scenario->probes.front().radius);
    }
    touches.push_back(std::move(touch));
  }
  const fit::TissueProblem problem(body, touches);
  // With thousands of unknowns an evaluation takes a good part of a second, and the valley in E, ν
  // and damping is flat: smaller changes are invisible in every interval.
  constexpr double kTolerance = 1e-8;
  fit::Options options = request.options;
  options.tolerance = kTolerance;
  for (const std::string& w : problem.warnings()) warnings.push_back(w);
  FitOutcome outcome;
  outcome.figures = figures_of("tissue", log, problem.unit(), fit::fit(problem, options), warnings);
  const fit::Fit& fit = outcome.figures.fit;
  if (const auto locks = fit::locking_warning(body, fit.parameters)) {
    outcome.figures.warnings.push_back(*locks);
  }
  outcome.settings_of = [body](const fit::Fit& of) { return settings_of(body, of); };
  outcome.settings = outcome.settings_of(fit);
  outcome.plot = {"time (s)", "force", "N", {}, {}, {}};
  double from = 0;
  for (std::size_t s = 0; s < touches.size(); ++s) {
    outcome.plot.part();
    for (std::size_t i = 0; i < fit.residuals[s].size(); ++i) {
      outcome.plot.add(from + touches[s].time[i] - touches[s].time.front(), touches[s].force[i],
                       fit.residuals[s][i]);
    }
    from += touches[s].time.back() - touches[s].time.front();
  }
  return outcome;
}

namespace {

struct QlvFitSettings : fit::QlvSettings {
  void declare(config::Visitor& v) {
    v.choice("elastic", elastic, {{"fung", fit::Elastic::fung}, {"power", fit::Elastic::power}},
             {"the elastic force over depth: Fung's exponential, or a power law"});
    v.integer("exponentials", exponentials, {1, 3}, {"of the reduced relaxation"});
    v.effect("specimen", specimen,
             {"makes a material of the fit: what is strained, as a column with free sides, "
              "docs/tissue.md"});
  }

  struct Specimen : fit::Specimen {
    void declare(config::Visitor& v) {
      v.quantity("area", area_m2, config::Dimension::dimensionless, config::between(1e-12, 1e2),
                 {"of the indenter's face, m²; the material's E goes with its inverse"});
      v.quantity("height", height_m, config::Dimension::length, config::between(1e-6, 1e2),
                 {"of the tissue below the indenter"});
      v.quantity("poisson_ratio", poisson_ratio, config::Dimension::dimensionless,
                 config::between(0, 0.4999), {"of the tissue, which the log does not tell"});
    }
  };
  std::optional<Specimen> specimen;
};

// The material that a fit is, where the specimen is known.
fit::QlvTissue material_of(const QlvFitSettings& settings, const fit::PressedLog& log,
                           const fit::Fit& fit) {
  std::vector<double> values;
  for (const fit::Estimate& parameter : fit.parameters) values.push_back(parameter.value);
  return within("specimen",
                [&] { return fit::qlv_tissue(settings, log, values, *settings.specimen); });
}

// The tables of a scenario that the fit's material is, and how far its forces are from the fit's.
void add_material(const QlvFitSettings& settings, const fit::PressedLog& log, FitOutcome& outcome) {
  for (const auto& [key, value] : {std::pair{"area", settings.specimen->area_m2},
                                   std::pair{"height", settings.specimen->height_m}}) {
    if (value > 0) continue;
    throw InputError(fmt::format(
        "--set specimen.{}: not stated; expected a size above 0, of the indenter's face and of the "
        "tissue below it",
        key));
  }
  outcome.settings_of = [settings, log](const fit::Fit& of) {
    std::vector<FittedSetting> all;
    for (const fit::ScenarioWord& word : fit::scenario_words(material_of(settings, log, of))) {
      const std::size_t dot = word.key.rfind('.');
      all.push_back({word.key.substr(0, dot), word.key.substr(dot + 1), word.value, ""});
    }
    return all;
  };
  outcome.settings = outcome.settings_of(outcome.figures.fit);
  const fit::QlvTissue tissue = material_of(settings, log, outcome.figures.fit);
  outcome.figures.warnings.push_back(fmt::format(
      "the material's forces as a column are {:.3g} N (rms) from the fit's: an exponent of strain "
      "is none of depth",
      tissue.deviation_n));
}

const files::LogColumn& travel_of(const files::Log& log) {
  for (const char* name : {"travel", "displacement", "depth", "position"}) {
    if (const files::LogColumn* column = log.find(name)) return log.column(column->quantity, "m");
  }
  return log.column("travel", "m");
}

}  // namespace

FitOutcome fit_qlv(const FitRequest& request) {
  const auto settings = model_settings<QlvFitSettings>(request.overrides);
  const files::Log log = request.read({"force", "travel", "displacement", "depth", "position"});
  const fit::QlvProblem problem(settings,
                                {log.time, travel_of(log).values, log.column("force", "N").values});
  FitOutcome outcome;
  outcome.figures = figures_of("qlv", log, problem.unit(), fit::fit(problem, request.options),
                               problem.warnings());
  if (settings.specimen) {
    add_material(settings, problem.log(), outcome);
  } else {
    outcome.figures.warnings.emplace_back(
        "c and q are the specimen's: with --set specimen.area and specimen.height they become a "
        "material, of which a scenario takes the tables");
  }
  outcome.plot = {"time (s)", "force", "N", {}, {}, {}};
  const fit::PressedLog& pressed = problem.log();
  const std::vector<double>& left = outcome.figures.fit.residuals.front();
  for (std::size_t i = 0; i < left.size(); ++i) {
    outcome.plot.add(pressed.time[i], pressed.force[i], left[i]);
  }
  return outcome;
}

}  // namespace hvp::app
