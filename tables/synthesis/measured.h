#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "models/accel/architecture.h"
#include "models/accel/structures.h"

namespace hvp::tables {

// What yosys made of a block of an engine, or of the whole engine, and where it was placed and
// routed, the clock that it allows: a line of tables/synthesis/measured.csv.
struct SynthesisedBlock {
  std::string name;  // a unit of accel::logic(), or "engine"
  int count = 1;
  int cells = 0;  // look-up tables, those of carry chains included
  int registers = 0;
  int memories = 0;     // EBR
  int distributed = 0;  // memories in look-up tables, 16 words of four bits each
  int multipliers = 0;
  double clock_mhz = 0;  // 0: not placed
  std::string path;
  double half_clock_ns = 0;  // of the longest path between the two clocks; 0: none
  std::string half_path;

  // What paths between the two clocks allow, which have half a period; 0: there are none.
  double between_mhz() const { return half_clock_ns > 0 ? 500 / half_clock_ns : 0; }
  // What all paths allow.
  double slowest_mhz() const {
    return half_clock_ns > 0 ? std::min(clock_mhz, between_mhz()) : clock_mhz;
  }
};

// An engine of tables/synthesis/engines.csv, as engine.sv is built with these parameters: with as
// many nodes and packages as their numbers have places for. It has a stop test and the solution
// before x, whether a scenario uses them or not.
struct SynthesisedEngine {
  std::string name;
  bool calibrates = false;  // the model of its logic is fitted to it, too
  accel::Architecture architecture;
  accel::WordLengths words;
  accel::SystemSize size;
  std::vector<SynthesisedBlock> blocks;

  const SynthesisedBlock* block(std::string_view wanted) const;
  const SynthesisedBlock& whole() const;  // throws std::runtime_error where there is none
};

// Reads both files of `folder`; throws InputError where they are not as they should be.
std::vector<SynthesisedEngine> synthesised_engines(const std::string& folder);

// For a unit of accel::logic(), the look-up tables of the engines that calibrate it over those that
// are counted; 0 where no engine has it.
double fitted_coefficient(const std::vector<SynthesisedEngine>& engines, std::string_view unit);

}  // namespace hvp::tables
