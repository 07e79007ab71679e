#include "models/plant/plant.h"

#include <map>
#include <string>

#include <gtest/gtest.h>

#include "models/config/effects.h"
#include "models/config/input_error.h"

namespace hvp::plant::plant_test {
namespace {

// Reads a choice, and notes the ranges and whether each key says what it is and where its default
// is from.
class Reader : public config::QuietVisitor {
 public:
  explicit Reader(std::string choice) : choice_(std::move(choice)) {}
  void quantity(std::string_view name, double&, config::Dimension, config::Range range,
                config::Note note) override {
    ranges[std::string(name)] = range;
    expect_told(name, note);
  }
  void vector(std::string_view name, Eigen::Vector3d&, config::Dimension, config::Range range,
              config::Note note) override {
    ranges[std::string(name)] = range;
    expect_told(name, note);
  }
  void choice_index(std::string_view name, std::size_t& index,
                    const std::vector<std::string_view>& names, config::Note note) override {
    expect_told(name, note);
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (names[i] == choice_) index = i;
    }
  }
  std::map<std::string, config::Range> ranges;

 private:
  static void expect_told(std::string_view name, const config::Note& note) {
    EXPECT_FALSE(note.help.empty()) << name;
    EXPECT_FALSE(note.source.empty()) << name;
  }
  std::string choice_;
};

std::string blamed(const auto& part) {
  try {
    part.check();
  } catch (const InputError& e) {
    return e.key();
  }
  return "none";
}

TEST(Hand, ANamedModelFillsItsValues) {
  Hand hand;
  hand.lets_go_s = 0.7;
  Reader arm("arm");
  arm.visit(hand);
  EXPECT_EQ(hand.mass_kg, 1.5);
  EXPECT_EQ(hand.stiffness_N_m, 49);
  EXPECT_EQ(hand.damping_N_s_m, 7.9);
  EXPECT_EQ(hand.grip_stiffness_N_m, 375);
  EXPECT_EQ(hand.grip_damping_N_s_m, 4.5);
  EXPECT_EQ(hand.lets_go_s, 0.7);

  hand = {};
  Reader spring("spring-damper");
  spring.visit(hand);
  EXPECT_EQ(hand.mass_kg, 0);
  EXPECT_EQ(hand.stiffness_N_m, 375);
  EXPECT_EQ(hand.damping_N_s_m, 4.5);

  hand.stiffness_N_m = 200;
  Reader custom("custom");
  custom.visit(hand);
  EXPECT_EQ(hand.stiffness_N_m, 200) << "its own";
}

TEST(Hand, RefusesAGripOnNothing) {
  EXPECT_EQ(blamed(Hand{}), "none");
  EXPECT_EQ(blamed(Hand::of(Hand::Model::arm)), "none");
  EXPECT_EQ(blamed(Hand{.grip_stiffness_N_m = 100}), "mass");
  EXPECT_EQ(blamed(Hand{.mass_kg = 1, .grip_damping_N_s_m = 1}), "grip_damping");
}

TEST(Friction, RefusesLessOfItWhereTheDeviceStands) {
  EXPECT_EQ(blamed(Friction{0.2}), "none");
  EXPECT_EQ(blamed(Friction{0.2, 0.2}), "none");
  EXPECT_EQ(blamed(Friction{0.2, 0.1}), "static_force");
}

TEST(Plant, EveryKeyHasARangeThatKeepsAMass) {
  Reader keys("custom");
  DeviceDynamics dynamics;
  keys.visit(dynamics);
  EXPECT_GT(keys.ranges.at("mass").min, 0);
  EXPECT_GT(keys.ranges.at("mass_factor").min, 0);
  Gravity gravity;
  keys.visit(gravity);
  EXPECT_EQ(keys.ranges.at("compensated").max, 1);
  Friction friction;
  keys.visit(friction);
  EXPECT_EQ(keys.ranges.at("static_force").min, 0);
}

TEST(Plant, ItsAxesHaveTheirMassAndWeight) {
  Plant plant;
  plant.dynamics = {0.2, 1, {1, 2, 0.5}};
  plant.gravity = Gravity{.acceleration = {1, 0, -10}, .compensated = 0.75};
  plant.hand = Hand::of(Hand::Model::arm);
  EXPECT_EQ(plant.axis(1).mass, 0.4);
  EXPECT_EQ(plant.axis(2).mass, 0.1);
  EXPECT_EQ(plant.axis(0).hand_mass, 1.5);
  EXPECT_LT((plant.weight() - Eigen::Vector3d(0.05, 0, -0.25)).norm(), 1e-15);
}

}  // namespace
}  // namespace hvp::plant::plant_test
