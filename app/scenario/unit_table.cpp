#include "app/scenario/unit_table.h"

#include <array>
#include <stdexcept>

namespace hvp::scenario {
namespace {

using config::Dimension;

constexpr auto kWrite = Unit::Use::read_and_write;
constexpr auto kRead = Unit::Use::read;
constexpr auto kSpelling = Unit::Use::spelling;

// The micro sign exists twice in Unicode: U+00B5 and the Greek letter U+03BC.
constexpr Unit kTime[] = {
    {"s", "1", 0, kWrite},           {"ms", "1", -3, kWrite},         {"us", "1", -6, kWrite},
    {"\u00b5s", "1", -6, kSpelling}, {"\u03bcs", "1", -6, kSpelling}, {"ns", "1", -9, kWrite},
    {"ps", "1", -12, kWrite},        {"min", "60", 0, kRead},
};
constexpr Unit kFrequency[] = {
    {"Hz", "1", 0, kWrite},
    {"kHz", "1", 3, kWrite},
    {"MHz", "1", 6, kWrite},
    {"GHz", "1", 9, kWrite},
};
constexpr Unit kRate[] = {{"1/s", "1", 0, kWrite}, {"1/ms", "1", 3, kRead}};
constexpr Unit kLength[] = {
    {"m", "1", 0, kWrite},           {"km", "1", 3, kWrite},  {"cm", "1", -2, kRead},
    {"mm", "1", -3, kWrite},         {"um", "1", -6, kWrite}, {"\u00b5m", "1", -6, kSpelling},
    {"\u03bcm", "1", -6, kSpelling}, {"nm", "1", -9, kWrite},
};
constexpr Unit kMass[] = {
    {"kg", "1", 0, kWrite},
    {"g", "1", -3, kWrite},
    {"mg", "1", -6, kWrite},
};
constexpr Unit kVelocity[] = {
    {"m/s", "1", 0, kWrite},   {"cm/s", "1", -2, kRead},          {"mm/s", "1", -3, kWrite},
    {"um/s", "1", -6, kWrite}, {"\u00b5m/s", "1", -6, kSpelling}, {"\u03bcm/s", "1", -6, kSpelling},
};
// The standard acceleration of gravity, 9.80665 m/s² (3rd CGPM, 1901).
constexpr Unit kAcceleration[] = {
    {"m/s2", "1", 0, kWrite},   {"m/s\u00b2", "1", 0, kSpelling},   {"m/s^2", "1", 0, kSpelling},
    {"mm/s2", "1", -3, kWrite}, {"mm/s\u00b2", "1", -3, kSpelling}, {"mm/s^2", "1", -3, kSpelling},
    {"g", "980665", -5, kRead},
};
constexpr Unit kForce[] = {
    {"N", "1", 0, kWrite},   {"kN", "1", 3, kWrite},          {"mN", "1", -3, kWrite},
    {"uN", "1", -6, kWrite}, {"\u00b5N", "1", -6, kSpelling}, {"\u03bcN", "1", -6, kSpelling},
};
constexpr Unit kStiffness[] = {
    {"N/m", "1", 0, kWrite},
    {"kN/m", "1", 3, kWrite},
    {"N/mm", "1", 3, kRead},
};
constexpr Unit kDamping[] = {
    {"N s/m", "1", 0, kWrite},
    {"N\u00b7s/m", "1", 0, kSpelling},
    {"Ns/m", "1", 0, kSpelling},
    {"mN s/m", "1", -3, kWrite},
};
constexpr Unit kPressure[] = {
    {"Pa", "1", 0, kWrite},
    {"kPa", "1", 3, kWrite},
    {"MPa", "1", 6, kWrite},
    {"GPa", "1", 9, kWrite},
};
constexpr Unit kDensity[] = {
    {"kg/m3", "1", 0, kWrite}, {"kg/m\u00b3", "1", 0, kSpelling}, {"kg/m^3", "1", 0, kSpelling},
    {"g/cm3", "1", 3, kRead},  {"g/cm\u00b3", "1", 3, kSpelling}, {"g/cm^3", "1", 3, kSpelling},
};
// π/180, the digits by Machin's formula.
constexpr Unit kAngle[] = {
    {"rad", "1", 0, kWrite},
    {"mrad", "1", -3, kRead},
    {"deg", "17453292519943295769236907684886127134428718885417", -51, kRead},
    {"\u00b0", "17453292519943295769236907684886127134428718885417", -51, kSpelling},
};
constexpr Unit kInertia[] = {
    {"kg m2", "1", 0, kWrite},
    {"kg m\u00b2", "1", 0, kSpelling},
    {"kg m^2", "1", 0, kSpelling},
    {"g cm2", "1", -7, kRead},
};
constexpr Unit kCurrent[] = {{"A", "1", 0, kWrite}, {"mA", "1", -3, kWrite}};
constexpr Unit kVoltage[] = {{"V", "1", 0, kWrite}, {"mV", "1", -3, kWrite}};
constexpr Unit kTransconductance[] = {{"A/V", "1", 0, kWrite}, {"mA/V", "1", -3, kWrite}};
constexpr Unit kTorqueConstant[] = {
    {"N m/A", "1", 0, kWrite},
    {"N\u00b7m/A", "1", 0, kSpelling},
    {"mN m/A", "1", -3, kWrite},
};
constexpr Unit kThroughput[] = {
    {"flop/s", "1", 0, kWrite},  {"kflop/s", "1", 3, kWrite},  {"Mflop/s", "1", 6, kWrite},
    {"Gflop/s", "1", 9, kWrite}, {"Tflop/s", "1", 12, kWrite},
};
constexpr Unit kDataSize[] = {
    {"B", "1", 0, kWrite},           {"kB", "1", 3, kWrite},    {"MB", "1", 6, kWrite},
    {"GB", "1", 9, kWrite},          {"KiB", "1024", 0, kRead}, {"MiB", "1048576", 0, kRead},
    {"GiB", "1073741824", 0, kRead},
};

constexpr std::array<DimensionUnits, 21> kDimensions = {{
    {Dimension::dimensionless, "a number", "0.5", {}},
    {Dimension::time, "a time", "2 ms", kTime},
    {Dimension::frequency, "a frequency", "100 MHz", kFrequency},
    {Dimension::rate, "a rate", "0.1 1/s", kRate},
    {Dimension::length, "a length", "50 mm", kLength},
    {Dimension::mass, "a mass", "100 g", kMass},
    {Dimension::velocity, "a velocity", "20 mm/s", kVelocity},
    {Dimension::acceleration, "an acceleration", "9.81 m/s2", kAcceleration},
    {Dimension::force, "a force", "5 N", kForce},
    {Dimension::stiffness, "a stiffness", "375 N/m", kStiffness},
    {Dimension::damping, "a damping", "4.5 N s/m", kDamping},
    {Dimension::pressure, "a pressure", "10 kPa", kPressure},
    {Dimension::density, "a density", "1000 kg/m3", kDensity},
    {Dimension::angle, "an angle", "30 deg", kAngle},
    {Dimension::inertia, "a moment of inertia", "0.001 kg m2", kInertia},
    {Dimension::current, "a current", "2.4 A", kCurrent},
    {Dimension::voltage, "a voltage", "10 V", kVoltage},
    {Dimension::transconductance, "a current for a voltage", "0.5 A/V", kTransconductance},
    {Dimension::torque_constant, "a torque for a current", "23.4 mN m/A", kTorqueConstant},
    {Dimension::throughput, "a throughput", "298 Mflop/s", kThroughput},
    {Dimension::data_size, "a data size", "64 B", kDataSize},
}};

}  // namespace

const DimensionUnits& units_table(Dimension dimension) {
  for (const DimensionUnits& entry : kDimensions) {
    if (entry.dimension == dimension) return entry;
  }
  throw std::logic_error("a dimension without units");
}

std::span<const DimensionUnits> all_dimensions() { return kDimensions; }

}  // namespace hvp::scenario
