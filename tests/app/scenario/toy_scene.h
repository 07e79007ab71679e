#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "models/config/declaration.h"
#include "models/config/input_error.h"

// A small scenario that uses every feature of a declaration once.
namespace hvp::scenario::toy {

inline const Eigen::Vector3d kTop{0.0, 0.0, 0.05};

struct Solver {
  enum class Method { cg, pcg };
  Method method = Method::pcg;
  int iterations = 60;
  double tolerance = 0.0;
  bool warm_start = true;

  void declare(config::Visitor& v) {
    v.choice("method", method, {{"cg", Method::cg}, {"pcg", Method::pcg}},
             {"the iteration", "thesis chapter 4"});
    v.integer("iterations", iterations, {1, 500}, {"iterations a solve", "thesis section 6.2.4"});
    v.quantity("tolerance", tolerance, config::Dimension::dimensionless,
               {.min = 0.0, .max = 1.0, .max_open = true}, {"stop early", "off"});
    v.boolean("warm_start", warm_start, {"start from the last solution", "thesis section 4.4"});
  }
  void check() const {
    if (method == Method::cg && iterations > 400) {
      throw InputError("iterations", "CG takes at most 400, found " + std::to_string(iterations));
    }
  }
  bool operator==(const Solver&) const = default;
};

struct Budget {
  double period = 2e-3;

  void declare(config::Visitor& v) {
    v.quantity("period", period, config::Dimension::time, config::above(0.0),
               {"the servo loop's period", "thesis section 6.2"});
  }
  bool operator==(const Budget&) const = default;
};

struct Jitter {
  double sigma = 10e-6;
  std::int64_t seed = 1;

  void declare(config::Visitor& v) {
    v.quantity("sigma", sigma, config::Dimension::time, config::at_least(0.0),
               {"spread of a cost", "assumed | not measured"});
    v.integer("seed", seed, {}, {"of the random numbers", "arbitrary"});
  }
  bool operator==(const Jitter&) const = default;
};

struct Host {
  double copy_rate = 298e6;
  std::optional<Jitter> jitter;

  void declare(config::Visitor& v) {
    // The sub-table comes first, as TOML would not have it.
    v.effect("jitter", jitter, {"costs that vary", ""});
    v.quantity("copy_rate", copy_rate, config::Dimension::throughput, config::above(0.0),
               {"of the processor", "thesis table 6.1"});
  }
  bool operator==(const Host&) const = default;
};

struct Shape {
  double radius = 1e-2;

  void declare(config::Visitor& v) {
    v.quantity("radius", radius, config::Dimension::length, config::above(0.0),
               {"of the patch", "assumed"});
  }
  bool operator==(const Shape&) const = default;
};

struct Contact {
  Eigen::Vector3d at = kTop;
  double depth = 0.0;
  Shape shape;

  void declare(config::Visitor& v) {
    v.vector("at", at, config::Dimension::length, {}, {"where", "the top"});
    v.quantity("depth", depth, config::Dimension::length, config::at_least(0.0),
               {"how deep", {}, true});
    v.table("shape", shape, {"the patch", ""});
  }
  void check() const {
    if (at.norm() == 0.0) throw InputError("at", "lies at the centre");
  }
  bool operator==(const Contact& o) const {
    return at == o.at && depth == o.depth && shape == o.shape;
  }
};

struct Object {
  config::File surface;
  double density = 1000.0;
  double young = 10e3;
  Eigen::Vector3d gravity{0.0, 0.0, -9.81};
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();

  void declare(config::Visitor& v) {
    v.file("surface", surface, {"a closed surface", "none: a sphere"});
    v.quantity("density", density, config::Dimension::density, config::above(0.0),
               {"of the body", "water"});
    v.quantity("young", young, config::Dimension::pressure, config::between(1.0, 1e12),
               {"Young's modulus", "thesis section 6.2.4"});
    v.vector("gravity", gravity, config::Dimension::acceleration, {}, {"body force", ""});
    v.vector("axis", axis, config::Dimension::dimensionless, config::between(-1.0, 1.0),
             {"of the anchors", ""});
  }
  bool operator==(const Object& o) const {
    return surface == o.surface && density == o.density && young == o.young &&
           gravity == o.gravity && axis == o.axis;
  }
};

struct Scene {
  std::string title;
  Budget budget;
  Solver solver;
  Host host;
  Object object;
  std::vector<Contact> contacts;

  void declare(config::Visitor& v) {
    v.text("title", title, {"one line", {}, true});
    v.table("budget", budget, {"what must hold", ""});
    v.table("solver", solver, {"the iterative solver", ""});
    v.table("host", host, {"the host PC", ""});
    v.table("object", object, {"the soft body", ""});
    v.list("contacts", contacts, {"where it is touched", ""});
  }
  void check() const {
    if (host.jitter && host.jitter->sigma > budget.period) {
      throw InputError("host.jitter.sigma", "exceeds the period");
    }
  }
  bool operator==(const Scene&) const = default;
};

}  // namespace hvp::scenario::toy
