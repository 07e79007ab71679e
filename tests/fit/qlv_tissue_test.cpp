#include "models/fit/qlv_tissue.h"

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "models/config/input_error.h"
#include "models/fit/twins.h"
#include "tests/fit/fung_in_frames.h"

namespace hvp::fit::qlv_tissue_test {
namespace {

// Like the meat of real records.
const std::vector<double> kValues = {120, 600, 0.6, 0.32, 0.19, 3.9, 0.66e-3, 0.012};
constexpr Specimen kSpecimen{.area_m2 = 1e-4, .height_m = 0.013, .poisson_ratio = 0.45};

PressedLog record() { return pressed(press({}, {}, kValues)); }

double rms_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(sum / static_cast<double>(a.size()));
}

std::vector<double> force_of(const QlvTissue& tissue, const Specimen& specimen,
                             const PressedLog& log, double frame_s) {
  return qlv_tissue_force(tissue, specimen, log, kValues[6], kValues[7], frame_s);
}

// The recursion over frames is the fit's integral, which is exact between samples.
TEST(QlvTissue, TheFitsOwnForceInFramesIsTheFit) {
  const PressedLog log = record();
  const std::vector<double> expected = qlv_force({}, log, kValues);
  const std::vector<double> found = fung_in_frames(log, kValues, 100);
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_NEAR(found[i], expected[i], 2e-6);
}

TEST(QlvTissue, NoOtherModulusAndExponentAreCloser) {
  const PressedLog log = record();
  const std::vector<double> fitted = qlv_force({}, log, kValues);
  const QlvTissue tissue = qlv_tissue({}, log, kValues, kSpecimen);
  const double frame = log.step / 8;
  const double left = rms_difference(force_of(tissue, kSpecimen, log, frame), fitted);
  EXPECT_NEAR(left, tissue.deviation_n, 1e-9);
  EXPECT_LT(left, 0.02 * log.force_range());
  for (const double factor : {0.97, 1.03}) {
    QlvTissue other = tissue;
    other.exponent *= factor;
    EXPECT_GT(rms_difference(force_of(other, kSpecimen, log, frame), fitted), left);
    other = tissue;
    other.young_modulus_pa *= factor;
    EXPECT_GT(rms_difference(force_of(other, kSpecimen, log, frame), fitted), left);
  }
  // It does not depend on the frames.
  EXPECT_LT(rms_difference(force_of(tissue, kSpecimen, log, frame),
                           force_of(tissue, kSpecimen, log, 1e-3)),
            1e-3 * log.force_range());
  // Without the exponential it is another thing.
  QlvTissue other = tissue;
  other.exponent = 0;
  EXPECT_GT(rms_difference(force_of(other, kSpecimen, log, frame), fitted), 5 * left);
}

TEST(QlvTissue, RelaxationIsTheFitsOwn) {
  const QlvTissue tissue = qlv_tissue({}, record(), kValues, kSpecimen);
  ASSERT_EQ(tissue.prony.size(), 2U);
  EXPECT_EQ(tissue.prony[0].share, 0.6);
  EXPECT_EQ(tissue.prony[0].time_s, 0.32);
  EXPECT_EQ(tissue.prony[1].share, 0.19);
  EXPECT_EQ(tissue.prony[1].time_s, 3.9);
}

// c and q belong to the specimen: with every length doubled the same material has 2c and q/2.
TEST(QlvTissue, TheSameMaterialInASpecimenOfTwiceTheSize) {
  const PressedLog small = record();
  PressedLog large = small;
  for (double& depth : large.depth) depth *= 2;
  std::vector<double> values = kValues;
  values[0] *= 2;
  values[1] /= 2;
  values[6] *= 2;
  const QlvTissue one = qlv_tissue({}, small, kValues, kSpecimen);
  const QlvTissue two = qlv_tissue({}, large, values, {4 * 1e-4, 2 * 0.013, 0.45});
  EXPECT_NEAR(two.exponent, one.exponent, 1e-4 * one.exponent);
  EXPECT_NEAR(two.young_modulus_pa, one.young_modulus_pa, 1e-4 * one.young_modulus_pa);
  EXPECT_NEAR(two.deviation_n, 4 * one.deviation_n, 1e-4 * two.deviation_n);
}

// Where the indenter's face is not known, neither is E; b and what is left do not depend on it.
TEST(QlvTissue, TheAreaIsAFactorOfTheModulus) {
  const PressedLog log = record();
  const QlvTissue one = qlv_tissue({}, log, kValues, kSpecimen);
  const QlvTissue other = qlv_tissue({}, log, kValues, {3e-4, 0.013, 0.45});
  EXPECT_NEAR(other.young_modulus_pa, one.young_modulus_pa / 3, 1e-6 * one.young_modulus_pa);
  EXPECT_NEAR(other.exponent, one.exponent, 1e-5 * one.exponent);
  // A higher specimen is strained less, so that its material has to stiffen more.
  EXPECT_GT(qlv_tissue({}, log, kValues, {1e-4, 0.026, 0.45}).exponent, 2 * one.exponent);
}

TEST(QlvTissue, ResultIsWhatTheScenarioWouldSay) {
  std::string text;
  for (const ScenarioWord& word :
       scenario_words({.young_modulus_pa = 8012.25,
       .poisson_ratio = 0.45,
       .exponent = 3,
       .prony = {{.share = 0.6, .time_s = 0.32}, {.share = 0.19, .time_s = 4}},
       .deviation_n = 0})) {
    text += word.key + " = " + word.value + "\n";
  }
  EXPECT_EQ(text,
            "object.material.young_modulus = \"8012.25 Pa\"\n"
            "object.material.poisson_ratio = 0.45\n"
            "object.model.kind = \"fung\"\n"
            "object.model.exponent = 3.0\n"
            "object.model.prony = [{ share = 0.6, time = \"0.32 s\" }, { share = 0.19, time = \"4 "
            "s\" }]\n");
}

void expect_refused(const QlvSettings& settings, const Specimen& specimen, const std::string& key) {
  const std::vector<double> values =
      settings.elastic == Elastic::fung ? kValues
                                        : std::vector<double>{4e5, 2.2, 0.6, 0.32, 0.19, 3.9, 0, 0};
  try {
    qlv_tissue(settings, record(), values, specimen);
    ADD_FAILURE() << key;
  } catch (const InputError& error) {
    EXPECT_EQ(error.key(), key) << error.what();
  }
}

TEST(QlvTissue, RefusesWhatIsNoSpecimen) {
  expect_refused({}, {0, 0.013, 0.45}, "area");
  expect_refused({}, {1e-4, -0.013, 0.45}, "height");
  expect_refused({}, {1e-4, 0.003, 0.45}, "height");
  expect_refused({}, {1e-4, 0.013, 0.5}, "poisson_ratio");
  expect_refused({.elastic = Elastic::power}, kSpecimen, "elastic");
}

}  // namespace
}  // namespace hvp::fit::qlv_tissue_test
