#pragma once

#include <array>
#include <memory>

#include "models/host/gliding_contact.h"
#include "tests/vp/small_scene.h"
#include "vp/host/soft_body.h"
#include "vp/platform.h"

namespace hvp::test {

// A small scene whose contact is a proxy.
struct GlidingScene {
  static constexpr double kFriction = 0.3;

  explicit GlidingScene(const SmallScene::Options& options)
      : scene(options),
        tables(scene.body, scene.computation.matrix(), options.dynamics.has_value(),
               scene.computation.linear(), settings(), radii()),
        contacts(scene.body.mesh(), SmallScene::floor(), settings()) {
    if (tables.free_displacement.empty()) scene.computation.expect_to_go_on();
  }

  // Runs the scene. One platform a process.
  void run() {
    platform = std::make_unique<vp::Platform>(scene.settings, soft(), nullptr);
    platform->add_observer(log);
    platform->run();
  }

  vp::SoftBody soft() { return {scene.body, scene.computation, contacts, &tables}; }

  SmallScene scene;
  host::GlideTables tables;
  collision::ContactSearch contacts;
  FrameLog log;
  std::unique_ptr<vp::Platform> platform;

 private:
  static std::array<double, 1> radii() { return {3e-3}; }
  static collision::ContactSettings settings() {
    collision::ContactSettings c;
    c.kind = collision::ContactKind::proxy;
    c.friction = kFriction;
    return c;
  }
};

}  // namespace hvp::test
