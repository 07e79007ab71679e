#include "app/scenario/writer.h"

#include <bit>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "tests/app/scenario/read_toy.h"

namespace hvp::scenario::writer_test {
namespace {

using toy::read_scene;
using toy::Scene;

TEST(Writer, WritesEveryKeyWithItsUnit) {
  Scene scene;
  scene.title = "a \"scene\"\n";
  EXPECT_EQ(resolved(scene), R"(# Every parameter of the scenario with the value it has.
title = "a \"scene\"\n"
contacts = []

[budget]
period = "2 ms"

[solver]
method = "pcg"
iterations = 60
tolerance = 0.0
warm_start = true

[host]
copy_rate = "298 Mflop/s"

# [host.jitter] is not in this scenario

[object]
surface = ""
density = "1000 kg/m3"
young = "10 kPa"
gravity = ["0 m/s2", "0 m/s2", "-9.81 m/s2"]
axis = [0.0, 0.0, 1.0]
)");
}

TEST(Writer, WritesEffectsAndLists) {
  Scene scene;
  scene.host.jitter.emplace();
  scene.contacts.resize(2);
  const std::string text = resolved(scene);
  EXPECT_NE(text.find("\n[host.jitter]\nsigma = \"10 us\"\nseed = 1\n"), std::string::npos) << text;
  EXPECT_NE(text.find("\n[[contacts]]\nat = [\"0 m\", \"0 m\", \"50 mm\"]\ndepth = \"0 m\"\n\n"
                      "[contacts.shape]\nradius = \"10 mm\"\n\n[[contacts]]\n"),
            std::string::npos)
      << text;
}

Scene any_scene(std::mt19937_64& random) {
  const auto real = [&random] {
    while (true) {
      const auto value = std::bit_cast<double>(random());
      if (std::isfinite(value)) return value;
    }
  };
  const auto positive = [&real] {
    while (true) {
      const double value = std::abs(real());
      if (value > 0.0) return value;
    }
  };
  const auto fraction = [&random] { return static_cast<double>(random() >> 11U) * 0x1p-53; };
  const auto chance = [&random] { return random() % 2 == 0; };
  Scene scene;
  for (std::uint64_t i = random() % 20; i > 0; --i) {
    scene.title += static_cast<char>(random() % 128);
  }
  scene.title += "\u00b5\u65e5";
  scene.budget.period = 1e300;
  scene.solver.method = toy::Solver::Method::pcg;
  scene.solver.iterations = 1 + static_cast<int>(random() % 500);
  scene.solver.tolerance = fraction();
  scene.solver.warm_start = chance();
  scene.host.copy_rate = positive();
  if (chance()) scene.host.jitter = toy::Jitter{fraction(), std::bit_cast<std::int64_t>(random())};
  scene.object.density = positive();
  scene.object.young = 1.0 + 1e9 * fraction();
  scene.object.gravity = {real(), real(), real()};
  scene.object.axis = {fraction(), -fraction(), fraction() * 1e-300};
  scene.contacts.resize(random() % 4);
  for (toy::Contact& contact : scene.contacts) {
    contact.at = {fraction(), real(), -0.0};
    contact.depth = fraction();
    contact.shape.radius = positive();
  }
  return scene;
}

TEST(Writer, ReadsBackAsTheSameStructAndTheSameBytes) {
  std::mt19937_64 random(7);  // its sequence is fixed by the standard
  for (int i = 0; i < 500; ++i) {
    const Scene scene = any_scene(random);
    const std::string text = resolved(scene);
    const Scene again = read_scene(text);
    ASSERT_EQ(again, scene) << text;
    ASSERT_EQ(resolved(again), text);
  }
}

// A list that the struct starts with must not come back where the scenario emptied it.
TEST(Writer, KeepsAnEmptyListEmpty) {
  Scene scene;
  scene.contacts.resize(3);
  read(Document::parse(resolved(Scene{}), "x.toml"), scene);
  EXPECT_TRUE(scene.contacts.empty());
}

}  // namespace
}  // namespace hvp::scenario::writer_test
