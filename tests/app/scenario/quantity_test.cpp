#include "app/scenario/quantity.h"

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <stdexcept>

#include <gtest/gtest.h>

#include "models/config/input_error.h"

namespace hvp::scenario::quantity_test {
namespace {

using config::Dimension;

std::uint64_t bits(double value) { return std::bit_cast<std::uint64_t>(value); }

std::string error_of(std::string_view text, Dimension dimension) {
  try {
    parse_quantity(text, dimension);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

// The compiler rounds a decimal literal to the nearest double; so must the parser.
TEST(ParseQuantity, IsTheNearestDouble) {
  EXPECT_EQ(parse_quantity("850 ns", Dimension::time), 850e-9);
  EXPECT_EQ(parse_quantity("8.5e2 ns", Dimension::time), 8.5e-7);
  EXPECT_EQ(parse_quantity("2 ms", Dimension::time), 2e-3);
  EXPECT_EQ(parse_quantity("1e-3 s", Dimension::time), 1e-3);
  EXPECT_EQ(parse_quantity("7 ps", Dimension::time), 7e-12);
  EXPECT_EQ(parse_quantity("0.1 min", Dimension::time), 6.0);
  EXPECT_EQ(parse_quantity("33 MHz", Dimension::frequency), 33e6);
  EXPECT_EQ(parse_quantity("33.333333 MHz", Dimension::frequency), 33.333333e6);
  EXPECT_EQ(parse_quantity("0.1 1/s", Dimension::rate), 0.1);
  EXPECT_EQ(parse_quantity("20 um", Dimension::length), 20e-6);
  EXPECT_EQ(parse_quantity("20 \u00b5m", Dimension::length), 20e-6);
  EXPECT_EQ(parse_quantity("20 \u03bcm", Dimension::length), 20e-6);
  EXPECT_EQ(parse_quantity("2.54 cm", Dimension::length), 2.54e-2);
  EXPECT_EQ(parse_quantity("100 g", Dimension::mass), 0.1);
  EXPECT_EQ(parse_quantity("3 mm/s", Dimension::velocity), 3e-3);
  EXPECT_EQ(parse_quantity("9.81 m/s2", Dimension::acceleration), 9.81);
  EXPECT_EQ(parse_quantity("9.81 m/s\u00b2", Dimension::acceleration), 9.81);
  EXPECT_EQ(parse_quantity("9.81 m/s^2", Dimension::acceleration), 9.81);
  EXPECT_EQ(parse_quantity("1 g", Dimension::acceleration), 9.80665);
  EXPECT_EQ(parse_quantity("0.3 g", Dimension::acceleration), 2.941995);
  EXPECT_EQ(parse_quantity("5 N", Dimension::force), 5.0);
  EXPECT_EQ(parse_quantity("10 kPa", Dimension::pressure), 10e3);
  EXPECT_EQ(parse_quantity("1000 kg/m3", Dimension::density), 1000.0);
  EXPECT_EQ(parse_quantity("1.1 g/cm3", Dimension::density), 1100.0);
  EXPECT_EQ(parse_quantity("298 Mflop/s", Dimension::throughput), 298e6);
  EXPECT_EQ(parse_quantity("64 B", Dimension::data_size), 64.0);
  EXPECT_EQ(parse_quantity("1.5 KiB", Dimension::data_size), 1536.0);
  EXPECT_EQ(parse_quantity("3 MiB", Dimension::data_size), 3145728.0);
  EXPECT_EQ(parse_quantity("0.45", Dimension::dimensionless), 0.45);
}

// π, π/6 and π/4 to the last bit, which number · (π/180) in doubles does not give in general.
TEST(ParseQuantity, RoundsDegreesOnce) {
  EXPECT_EQ(parse_quantity("180 deg", Dimension::angle), 3.14159265358979323846);
  EXPECT_EQ(parse_quantity("30 deg", Dimension::angle), 0.52359877559829887308);
  EXPECT_EQ(parse_quantity("45\u00b0", Dimension::angle), 0.78539816339744830962);
}

TEST(ParseQuantity, TakesBlanksAndSigns) {
  EXPECT_EQ(parse_quantity("  850ns ", Dimension::time), 850e-9);
  EXPECT_EQ(parse_quantity("+5\tN", Dimension::force), 5.0);
  EXPECT_EQ(bits(parse_quantity("-0 N", Dimension::force)), bits(-0.0));
  EXPECT_EQ(parse_quantity(".5 N", Dimension::force), 0.5);
  EXPECT_EQ(parse_quantity("5. N", Dimension::force), 5.0);
  EXPECT_EQ(parse_quantity("0e99999999999 N", Dimension::force), 0.0);
}

TEST(ParseQuantity, SaysWhatWasExpected) {
  EXPECT_EQ(error_of("2", Dimension::time),
            "missing unit: expected a time such as \"2 ms\", found \"2\"");
  EXPECT_EQ(error_of("10 kPa", Dimension::time),
            "wrong unit: expected a time such as \"2 ms\", found the pressure \"10 kPa\"");
  EXPECT_EQ(error_of("10 Hz", Dimension::rate),
            "wrong unit: expected a rate such as \"0.1 1/s\", found the frequency \"10 Hz\"");
  EXPECT_EQ(error_of("2 mss", Dimension::time),
            "unknown unit \"mss\": expected a time such as \"2 ms\", found \"2 mss\"; "
            "did you mean \"ms\"?");
  EXPECT_EQ(error_of("33 mhz", Dimension::frequency),
            "unknown unit \"mhz\": expected a frequency such as \"100 MHz\", found \"33 mhz\"; "
            "did you mean \"MHz\"?");
  EXPECT_EQ(error_of("5 parsecs", Dimension::length),
            "unknown unit \"parsecs\": expected a length such as \"50 mm\", found \"5 parsecs\"");
  EXPECT_EQ(error_of("soon", Dimension::time), "expected a time such as \"2 ms\", found \"soon\"");
  EXPECT_EQ(error_of("", Dimension::mass), "expected a mass such as \"100 g\", found \"\"");
  EXPECT_EQ(error_of("-inf m/s2", Dimension::acceleration),
            "not a finite value: expected an acceleration such as \"9.81 m/s2\", "
            "found \"-inf m/s2\"");
  EXPECT_EQ(error_of("nan s", Dimension::time),
            "not a finite value: expected a time such as \"2 ms\", found \"nan s\"");
  EXPECT_EQ(error_of("1e400 s", Dimension::time),
            "too large or too small for double precision: expected a time such as \"2 ms\", "
            "found \"1e400 s\"");
  EXPECT_EQ(error_of("1e-400 s", Dimension::time),
            "too large or too small for double precision: expected a time such as \"2 ms\", "
            "found \"1e-400 s\"");
  EXPECT_EQ(error_of("1,5 N", Dimension::force),
            "unknown unit \",5 N\": expected a force such as \"5 N\", found \"1,5 N\"");
  EXPECT_EQ(error_of("5 %", Dimension::dimensionless),
            "a unit where there is none: expected a number such as 0.5, found \"5 %\"");
  EXPECT_EQ(error_of(std::string(300, '1') + " s", Dimension::time),
            "expected a time such as \"2 ms\", found a text of 302 characters");
}

TEST(FormatQuantity, ChoosesASensibleUnit) {
  EXPECT_EQ(format_quantity(2e-3, Dimension::time), "2 ms");
  EXPECT_EQ(format_quantity(850e-9, Dimension::time), "850 ns");
  EXPECT_EQ(format_quantity(0.0, Dimension::time), "0 s");
  EXPECT_EQ(format_quantity(120.0, Dimension::time), "120 s");
  EXPECT_EQ(format_quantity(0.05, Dimension::length), "50 mm");
  EXPECT_EQ(format_quantity(-1.25e-3, Dimension::length), "-1.25 mm");
  EXPECT_EQ(format_quantity(33e6, Dimension::frequency), "33 MHz");
  EXPECT_EQ(format_quantity(1000.0, Dimension::density), "1000 kg/m3");
  EXPECT_EQ(format_quantity(9.81, Dimension::acceleration), "9.81 m/s2");
  EXPECT_EQ(format_quantity(0.1, Dimension::rate), "0.1 1/s");
  EXPECT_EQ(format_quantity(0.1, Dimension::mass), "100 g");
  EXPECT_EQ(format_quantity(0.52359877559829887308, Dimension::angle), "30 deg");
  EXPECT_EQ(format_quantity(8192.0, Dimension::data_size), "8 KiB");
  EXPECT_EQ(format_quantity(2e6, Dimension::data_size), "2 MB");
  EXPECT_EQ(format_quantity(298e6, Dimension::throughput), "298 Mflop/s");
  EXPECT_EQ(format_quantity(1e-15, Dimension::time), "0.001 ps");
  EXPECT_EQ(format_quantity(1e-30, Dimension::time), "1e-18 ps");
  EXPECT_EQ(format_quantity(1e30, Dimension::frequency), "1e21 GHz");
  EXPECT_EQ(format_quantity(0.45, Dimension::dimensionless), "0.45");
}

TEST(FormatQuantity, RefusesWhatHasNoText) {
  EXPECT_THROW(format_quantity(std::numeric_limits<double>::quiet_NaN(), Dimension::time),
               std::invalid_argument);
  EXPECT_THROW(format_quantity(std::numeric_limits<double>::infinity(), Dimension::time),
               std::invalid_argument);
}

// parse(format(x)) == x bit for bit: 20 000 doubles of every dimension, of any bits and of the
// few digits people write, the smallest and largest among them.
TEST(FormatQuantity, ReadsBackToTheLastBit) {
  std::mt19937_64 random(1);  // its sequence is fixed by the standard
  for (const DimensionUnits& entry : all_dimensions()) {
    const auto expect_same = [&](double value) {
      const std::string text = format_quantity(value, entry.dimension);
      ASSERT_EQ(bits(parse_quantity(text, entry.dimension)), bits(value)) << text;
    };
    using Limits = std::numeric_limits<double>;
    for (const double value : {0.0, -0.0, Limits::denorm_min(), Limits::min(), Limits::max(),
                               -Limits::max(), std::nextafter(1.0, 2.0), 1e22, 1e23}) {
      expect_same(value);
    }
    for (int i = 0; i < 10000; ++i) {
      const auto any = std::bit_cast<double>(random());
      if (std::isfinite(any)) expect_same(any);
      const auto mantissa = static_cast<double>(random() % 100000);
      expect_same(mantissa * std::pow(10.0, static_cast<double>(random() % 30) - 15.0));
    }
  }
}

// Every spelling in the table is a different unit or says that it is another spelling, and one of
// a dimension's units is the SI unit itself.
TEST(Units, AreUniqueWithinADimension) {
  for (const DimensionUnits& entry : all_dimensions()) {
    if (entry.units.empty()) continue;
    EXPECT_EQ(entry.units.front().factor, "1");
    EXPECT_EQ(entry.units.front().exponent, 0);
    EXPECT_NO_THROW(parse_quantity(entry.example, entry.dimension));
    for (std::size_t i = 0; i < entry.units.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) EXPECT_NE(entry.units[i].name, entry.units[j].name);
    }
  }
}

}  // namespace
}  // namespace hvp::scenario::quantity_test
