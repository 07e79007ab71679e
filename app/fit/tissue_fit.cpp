#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "app/fit/fit_request.h"
#include "app/fit/model_settings.h"
#include "app/scene/scene.h"
#include "models/config/declaration.h"
#include "models/config/input_error.h"
#include "models/fit/tissue_problem.h"

namespace hvp::app {

namespace {

// Where a log was taken.
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

struct Settings {
  std::vector<ContactSettings> contacts = {{}};

  void declare(config::Visitor& v) {
    v.one_or_more("contact", contacts,
                  {"where the logs were taken; two contacts give Poisson's ratio"});
  }
};

// The mesh node that is furthest against the direction, and not anchored.
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
  const std::unique_ptr<fem::Body> made = make_body(s, {});
  fit::TissueBody body;
  body.mesh = made->mesh();
  body.anchored = made->anchored();
  body.density_kg_m3 = made->material().density_kg_m3;
  body.dynamics = s.dynamics;
  body.period_s = s.budget.period_s;
  return body;
}

// Displacement of the contact along its direction: as logged, or from a position along the axis
// that the direction has, from where the node is at rest.
std::vector<double> displacement_of(const files::Log& log, const fit::TissueBody& body,
                                    const ContactSettings& contact, int node) {
  for (const char* name : {"displacement", "travel", "depth"}) {
    if (log.find(name) != nullptr) return log.column(name, "m").values;
  }
  std::vector<double> values = log.column("position", "m").values;
  Eigen::Index axis = 0;
  contact.direction.cwiseAbs().maxCoeff(&axis);
  const double sign = contact.direction[axis] < 0 ? -1 : 1;
  const double rest = body.mesh.nodes[static_cast<std::size_t>(node)][axis];
  for (double& v : values) v = std::max(0.0, sign * (v - rest));
  return values;
}

std::vector<FittedSetting> settings_of(const fit::Fit& fit) {
  std::vector<FittedSetting> settings;
  const auto add = [&](const char* table, const char* key, const char* name, const char* unit) {
    for (const fit::Estimate& e : fit.parameters) {
      if (e.name != name) continue;
      settings.push_back({table, key,
                          *unit == '\0' ? fmt::format("{}", e.value) : toml_quantity(e.value, unit),
                          name});
    }
  };
  add("object.material", "young_modulus", "young_modulus", "Pa");
  add("object.material", "poisson_ratio", "poisson_ratio", "");
  add("dynamics", "rayleigh_mass", "mass_damping", "1/s");
  add("dynamics", "rayleigh_stiffness", "stiffness_damping", "s");
  return settings;
}

}  // namespace

FitOutcome fit_tissue(const FitRequest& request) {
  const auto settings = model_settings<Settings>(request.overrides);
  const fit::TissueBody body = body_of(request);
  std::vector<fit::TissueLog> touches;
  std::vector<files::Log> logs;
  for (const ContactSettings& contact : settings.contacts) {
    FitRequest of_contact = request;
    if (!contact.log.empty()) of_contact.log = contact.log;
    logs.push_back(of_contact.read({"force", "displacement", "travel", "depth", "position"}));
    const int node = contact.node >= 0 ? contact.node : outermost(body, contact.direction);
    if (node >= static_cast<int>(body.mesh.nodes.size())) {
      throw InputError(fmt::format("--set contact[{}].node={}: the mesh has {} nodes",
                                   touches.size(), node, body.mesh.nodes.size()));
    }
    touches.push_back({{node},
                       contact.direction,
                       logs.back().time,
                       displacement_of(logs.back(), body, contact, node),
                       logs.back().column("force", "N").values});
  }
  const fit::TissueProblem problem(body, touches);
  FitOutcome outcome;
  outcome.figures = figures_of("tissue", logs.front(), problem.unit(),
                               fit::fit(problem, request.options), problem.warnings());
  outcome.settings = settings_of(outcome.figures.fit);
  outcome.plot = {"time (s)", "force", "N", {}, {}, {}};
  double from = 0;
  for (std::size_t s = 0; s < touches.size(); ++s) {
    const std::vector<double>& left = outcome.figures.fit.residuals[s];
    for (std::size_t i = 0; i < left.size(); ++i) {
      outcome.plot.add(from + touches[s].time[i], touches[s].force[i], left[i]);
    }
    from += touches[s].time.back();
    outcome.plot.part();
  }
  return outcome;
}

}  // namespace hvp::app
