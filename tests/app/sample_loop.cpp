#include "tests/app/sample_loop.h"

#include <cmath>
#include <fstream>
#include <string>
#include <vector>

#include <fmt/format.h>

namespace hvp::sample {
namespace {

std::string header(const std::string& prefix) {
  std::string columns;
  for (const char* quantity : {"tip_{}_m", "intended_{}_m", "motor_{}_N", "hand_{}_N"})
    for (const char* axis : {"x", "y", "z"})
      columns += "," + prefix + fmt::format(fmt::runtime(quantity), axis);
  return columns + "," + prefix + "stored_J," + prefix + "port_J," + prefix + "fed_in";
}

std::string row(const LoopShape& shape, int probe, std::size_t frame, std::size_t frames) {
  const double share = static_cast<double>(frame) / static_cast<double>(frames);
  const double z = 0.02 * std::sin(6.0 * share) + 0.005 * probe;
  const double motor = 1.0 + (frame % 2 == 0 ? shape.swing_N : -shape.swing_N);
  const std::string intended =
      shape.held ? fmt::format("0,{},{}", 0.002 * share, z - 0.001) : std::string(",,");
  const double absorbed = shape.absorbed_J * share;
  return fmt::format(",0,{},{},{},0,0,{},0,0,{},{},{},{}", 0.002 * share, z, intended, motor,
                     shape.held ? -1.0 : 0.0, 0.001 * share, absorbed, absorbed < 0 ? 1 : 0);
}

}  // namespace

void add_loop(const std::filesystem::path& directory, const LoopShape& shape) {
  std::vector<std::string> lines;
  std::ifstream in(directory / "frames.csv");
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  in.close();
  for (int probe = 0; probe < shape.probes; ++probe) {
    lines.front() += header(probe == 0 ? std::string() : fmt::format("probe{}_", probe));
    for (std::size_t i = 1; i < lines.size(); ++i)
      lines[i] += row(shape, probe, i - 1, lines.size() - 1);
  }
  std::ofstream out(directory / "frames.csv", std::ios::binary);
  for (const std::string& line : lines) out << line << '\n';
}

}  // namespace hvp::sample
