#pragma once

#include <span>
#include <string>

#include "models/accel/architecture.h"
#include "models/fixed/settings.h"
#include "vp/fpga/rtl/engine_model.h"

// The sizes of engine.sv: its parameters are fixed when it is translated.
namespace hvp::vp::rtl {

// Those that this build has, the thesis' first. Made by CMakeLists.txt.
std::span<const EngineSize* const> engine_sizes();

// What a matrix asks of the memories.
struct Room {
  int nodes = 0;
  int packages = 0;  // of the partition that has most
};

// Throws InputError with the key of accel::Architecture or fixed::Settings for what engine.sv does
// not have in any size.
void require_buildable(const accel::Architecture& architecture);
void require_buildable(const fixed::Settings& settings);
// For what they do not have together, with a key of the architecture.
void require_buildable(const accel::Architecture& architecture, const fixed::Settings& settings);
// The same with the key "nodes" or "partitions".
void require_buildable(const Room& room);

// What engine.sv has for the method.
Preconditioner preconditioner(fixed::Method method);

// The size for such an engine, which may not be in this build: it has neither a name nor make().
EngineSize wanted_size(const accel::Architecture& architecture, const fixed::Settings& settings,
                       const Room& room);
// The first size of this build that serves as the one that is wanted; null: there is none.
const EngineSize* find_size(const EngineSize& wanted);

// The parameters as CMakeLists.txt takes them, "MatrixBits 12 VectorBits 16 …".
std::string parameters(const EngineSize& size);
// A name that no other size has, for files and identifiers.
std::string identifier(const EngineSize& size);

}  // namespace hvp::vp::rtl
