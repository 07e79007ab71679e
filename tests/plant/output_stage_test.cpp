#include "models/plant/output_stage.h"

#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <optional>

#include <gtest/gtest.h>

#include "models/config/input_error.h"
#include "models/plant/linkages.h"

namespace hvp::plant::output_stage_test {
namespace {

using Eigen::Vector3d;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
const Vector3d kForce{0.123456789, -1.7, 0.3};
const Vector3d kTip{0.01, -0.03, 0.02};
// 1 N is 1 A is 2 V on every axis.
const Motor kDirect{.torque_constant_N_m_A = 0.1, .transmission = Vector3d::Ones(), .lever = 0.1};

double along_x(const OutputStage& stage, double force) {
  return stage.drive({force, 0, 0}, kTip).force.x();
}

TEST(Dac, StepsAsItsDataSheetSays) {
  const Dac dac;
  EXPECT_EQ(dac.step(), 20.0 / 4096);
  EXPECT_EQ(dac.largest(), 10 - 20.0 / 4096);
  EXPECT_EQ(dac.nearest(0).volts, 0);
  EXPECT_EQ(dac.nearest(1.4 * dac.step()).volts, dac.step());
  EXPECT_EQ(dac.nearest(-1.6 * dac.step()).volts, -2 * dac.step());
}

TEST(Dac, RoundsToTheNearestStepAlikeBothWays) {
  for (const int bits : {2, 8, 12, 16, 32}) {
    Dac dac;
    dac.bits = bits;
    double last = -kInfinity;
    for (double volts = -dac.largest(); volts < dac.largest(); volts += 0.0137) {
      const BipolarConverter::Voltage found = dac.nearest(volts);
      EXPECT_LE(std::abs(found.volts - volts), dac.step() / 2);
      EXPECT_FALSE(found.saturated);
      EXPECT_GE(found.volts, last);
      EXPECT_EQ(dac.nearest(-volts).volts, -found.volts);
      last = found.volts;
    }
  }
}

TEST(Dac, ClampsAtItsLargestStepAndSaysSo) {
  const Dac dac;
  EXPECT_FALSE(dac.nearest(dac.largest()).saturated);
  for (const double volts : {10.0, 1e300, kInfinity}) {
    EXPECT_EQ(dac.nearest(volts).volts, dac.largest());
    EXPECT_EQ(dac.nearest(-volts).volts, -dac.largest());
    EXPECT_TRUE(dac.nearest(volts).saturated);
  }
  EXPECT_EQ(dac.nearest(kNan).volts, 0);
  EXPECT_TRUE(dac.nearest(kNan).saturated);
}

TEST(Adc, ReadsACurrentInSteps) {
  const Adc adc;
  const double step = 20.0 / 16384 * 2;
  EXPECT_EQ(adc.read(0), 0);
  EXPECT_NEAR(adc.read(1.5), 1.5, step / 2);
  EXPECT_EQ(adc.read(3 * step), 3 * step);
  EXPECT_EQ(adc.read(100), 20 - step);
}

TEST(OutputStage, ChangesNoBitWithoutEffects) {
  const SerialArm arm({}, Vector3d::Zero());
  const Amplifier strong{.current_limit_A = 1e6};
  for (const Kinematics* kinematics :
       {static_cast<const Kinematics*>(nullptr), static_cast<const Kinematics*>(&arm)}) {
    EXPECT_EQ(OutputStage({}, {}, {}, kinematics).drive(kForce, kTip).force, kForce);
    EXPECT_EQ(OutputStage({}, {}, Motor{}, kinematics).drive(kForce, kTip).force, kForce);
    const Drive drive = OutputStage({}, strong, Motor{}, kinematics).drive(kForce, kTip);
    EXPECT_EQ(drive.force, kForce);
    EXPECT_EQ(drive.current, drive.commanded_current);
    EXPECT_GT(drive.current.norm(), 0);
    EXPECT_FALSE(drive.dac_saturated || drive.current_saturated || drive.singular);
  }
}

TEST(OutputStage, GivesTheForceInStepsOfTheConverter) {
  const OutputStage stage(Dac{}, Amplifier{}, kDirect, nullptr);
  const double step = 20.0 / 4096 * 0.5;  // 2.44 mN
  double last = -kInfinity;
  for (double force = -2.3; force < 2.3; force += 0.000917) {
    const double found = along_x(stage, force);
    EXPECT_LE(std::abs(found - force), step / 2 * (1 + 1e-12));
    EXPECT_GE(found, last);
    EXPECT_EQ(along_x(stage, -force), -found);
    EXPECT_NEAR(found / step, std::round(found / step), 1e-9);
    last = found;
  }
  EXPECT_EQ(along_x(stage, 0), 0);
}

TEST(OutputStage, ClampsAtTheAmplifiersLimit) {
  const OutputStage stage({}, Amplifier{}, kDirect, nullptr);
  EXPECT_EQ(along_x(stage, 2.4), 2.4);
  for (const double force : {2.5, 1e9, kInfinity}) {
    const Drive drive = stage.drive({force, -force, 1}, kTip);
    EXPECT_EQ(drive.current, Vector3d(2.4, -2.4, drive.commanded_current.z()));
    EXPECT_NEAR(drive.force.x(), 2.4, 1e-12);
    EXPECT_NEAR(drive.force.y(), -2.4, 1e-12);
    EXPECT_NEAR(drive.force.z(), 1, 1e-12);
    EXPECT_TRUE(drive.current_saturated);
    EXPECT_FALSE(drive.dac_saturated);
  }
}

TEST(OutputStage, ClampsAtTheConvertersRange) {
  const Amplifier strong{.current_limit_A = 100};
  const OutputStage stage(Dac{}, strong, kDirect, nullptr);
  const Drive drive = stage.drive({50, 0, 0}, kTip);
  EXPECT_EQ(drive.current.x(), Dac{}.largest() * 0.5);
  EXPECT_NEAR(drive.commanded_current.x(), 50, 1e-12);
  EXPECT_TRUE(drive.dac_saturated);
  EXPECT_FALSE(drive.current_saturated);
}

// 2.4 A make 2.4·0.0234·11.2 N·m at the shoulder, which is 2.93 N at 215 mm.
TEST(OutputStage, MotorsOfAPhantomReachThreeNewtonsAtTheAmplifiersLimit) {
  const SerialArm arm({}, Vector3d::Zero());
  const OutputStage stage({}, Amplifier{}, Motor{}, &arm);
  const Drive drive = stage.drive({0, 0, 100}, Vector3d::Zero());
  EXPECT_NEAR(drive.force.z(), 2.4 * 0.0234 * 11.2 / 0.215, 1e-12);
  EXPECT_NEAR(drive.force.x(), 0, 1e-12);
  const OutputStage levers({}, Amplifier{}, Motor{}, nullptr);
  EXPECT_NEAR(levers.drive({0, 0, 100}, kTip).force.z(), 2.4 * 0.0234 * 11.2 / 0.215, 1e-12);
}

// What the motors exert is what their currents make: Jᵀ·F = k·n·I, wherever the tip is.
TEST(OutputStage, ForceAtTheTipIsThatOfTheCurrents) {
  const SerialArm arm({}, Vector3d::Zero());
  const Motor motor;
  const OutputStage stage(Dac{}, Amplifier{}, motor, &arm);
  for (const double scale : {0.1, 1.0, 10.0}) {
    for (const Vector3d& tip : {kTip, Vector3d(-0.05, 0.04, 0.06), Vector3d(0.05, 0.1, -0.05)}) {
      const Drive drive = stage.drive(scale * kForce, tip);
      const Vector3d torque = arm.jacobian(*arm.joints(tip)).transpose() * drive.force;
      const Vector3d made =
          motor.torque_constant_N_m_A * motor.transmission.cwiseProduct(drive.current);
      EXPECT_LT((torque - made).norm(), 1e-12);
      EXPECT_EQ(drive.current_saturated, scale > 5);
    }
  }
}

TEST(OutputStage, SwitchesTheMotorsOffAtASingularPose) {
  const SerialArm arm({}, {0.215, 0, -0.170});  // the shoulder at the origin
  const OutputStage stage(Dac{}, Amplifier{}, Motor{}, &arm);
  for (const Vector3d& tip :
       {Vector3d(0, 0, 0.3), Vector3d(0.385, 0, 0), Vector3d(1, 0, 0), Vector3d(kNan, 0, 0)}) {
    const Drive drive = stage.drive(kForce, tip);
    EXPECT_TRUE(drive.singular);
    EXPECT_EQ(drive.force, Vector3d::Zero());
    EXPECT_EQ(drive.current, Vector3d::Zero());
  }
}

TEST(OutputStage, NeverGivesANan) {
  const SerialArm arm({}, Vector3d::Zero());
  for (const double odd : {kNan, kInfinity, -kInfinity, 1e308}) {
    for (const Kinematics* kinematics :
         {static_cast<const Kinematics*>(nullptr), static_cast<const Kinematics*>(&arm)}) {
      for (const std::optional<Dac>& dac : {std::optional<Dac>(), std::optional<Dac>(Dac{})}) {
        const Vector3d force{odd, 1, -odd};
        const Drive drive = OutputStage(dac, Amplifier{}, Motor{}, kinematics).drive(force, kTip);
        EXPECT_TRUE(drive.force.allFinite());
        EXPECT_TRUE(drive.current.allFinite());
        EXPECT_TRUE(drive.commanded_current.allFinite());
        EXPECT_TRUE(OutputStage({}, {}, {}, kinematics).drive(force, kTip).force.allFinite());
      }
    }
  }
}

TEST(OutputStage, WantsAnAmplifierBehindAConverterAndAMotorBehindThat) {
  EXPECT_THROW(OutputStage(Dac{}, {}, Motor{}, nullptr), InputError);
  EXPECT_THROW(OutputStage({}, Amplifier{}, {}, nullptr), InputError);
  EXPECT_NO_THROW(OutputStage({}, {}, Motor{}, nullptr));
}

TEST(Amplifier, HasNoLagWithoutABandwidth) {
  EXPECT_EQ(Amplifier{}.lag_rate(), 0);
  EXPECT_NEAR(Amplifier{.bandwidth_Hz = 100}.lag_rate(), 628.3185307179586, 1e-9);
}

}  // namespace
}  // namespace hvp::plant::output_stage_test
