#pragma once

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "models/collision/contact_search.h"
#include "models/fem/body.h"
#include "models/fem/newmark.h"
#include "models/fem/structured_box.h"
#include "models/host/frame_computation.h"
#include "vp/platform.h"

namespace hvp::test {

// A cube of 6 cm, 4 × 4 × 4 nodes, held at its floor: 48 active nodes. The probe stands over the
// node at (2 cm, 2 cm) of the top, 44 of the active ones.
struct SmallScene {
  struct Options {
    std::optional<fem::Dynamics> dynamics;
    fixed::Settings solver;
    std::optional<host::Refinement> refinement = std::nullopt;
    double patch_radius = 0;
    double hand_over_s = collision::ContactSettings{}.hand_over_s;
    double period_s = 2e-3;
    host::SolvedBy solved_by = host::SolvedBy::board;
    host::Effort effort = host::Effort::computed;
  };

  static constexpr double kEdge = 0.06;
  static constexpr int kUnknowns = 3 * 48;
  static constexpr int kTopNode = 1 + 4 * (1 + 4 * 3);  // (1, 1, 3) of the mesh

  explicit SmallScene(const Options& options)
      : body(fem::structured_box({kEdge, kEdge, kEdge}, {3, 3, 3}), fem::Material{}, floor(),
             fem::AnchorTreatment::removed),
        computation(body, fem::ContactDiagonal::average, options.dynamics, options.solver,
                    options.period_s, options.refinement, options.solved_by, options.effort),
        contacts(body.mesh(), floor(), contact_settings(options)) {
    if (computation.has_board()) settings.solver = computation.board().settings();
    settings.period = to_picoseconds(options.period_s);
    settings.budget = settings.period;
    settings.frames = 10;
    settings.probes.front().interpolation = plant::Interpolation::linear;
    hover();
  }
  SmallScene() : SmallScene(Options{}) {}

  // The probe stays 1 cm above the body.
  void hover() {
    settings.probes.front().start = above(10e-3);
    settings.probes.front().motion = {stroke(plant::Stroke::hold, above(10e-3), 1)};
  }
  // The probe is 2 mm inside from the beginning, so that the first pass finds it.
  void touch() {
    settings.probes.front().start = above(-2e-3);
    settings.probes.front().motion = {stroke(plant::Stroke::hold, above(-2e-3), 1)};
  }
  // From inside one node's reach to another's within `seconds`.
  void slide(double seconds) {
    settings.probes.front().start = above(-2e-3);
    settings.probes.front().motion = {
        stroke(plant::Stroke::slide, above(-2e-3, kEdge / 3), seconds)};
  }

  static Eigen::Vector3d above(double height, double along = 0) {
    return {kEdge / 3 + along, kEdge / 3, kEdge + height};
  }
  static plant::Segment stroke(plant::Stroke phase, const Eigen::Vector3d& to, double seconds) {
    plant::Segment segment;
    segment.phase = phase;
    segment.to = to;
    segment.duration = seconds;
    return segment;
  }
  static std::vector<int> floor() {
    std::vector<int> nodes;
    for (int i = 0; i < 16; ++i) nodes.push_back(i);
    return nodes;
  }

  fem::Body body;
  host::FrameComputation computation;
  collision::ContactSearch contacts;
  vp::PlatformSettings settings;

 private:
  static collision::ContactSettings contact_settings(const Options& options) {
    collision::ContactSettings c;
    c.kind = collision::ContactKind::node;
    c.patch_radius = options.patch_radius;
    c.hand_over_s = options.hand_over_s;
    return c;
  }
};

// Keeps every closed frame.
class FrameLog : public vp::FrameObserver {
 public:
  void closed(const vp::Frame& frame, const vp::CriticalPath& path) override {
    frames.push_back(frame);
    paths.push_back(path.spans());
  }
  std::vector<vp::Frame> frames;
  std::vector<std::vector<vp::SpanId>> paths;
};

// A scene's run, done.
struct Simulated {
  explicit Simulated(SmallScene& s)
      : scene(s), platform(s.settings, s.body, s.computation, s.contacts) {
    platform.add_observer(log);
    platform.run();
  }
  SmallScene& scene;
  FrameLog log;
  vp::Platform platform;
};

}  // namespace hvp::test
