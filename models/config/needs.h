#pragma once

#include <string_view>

#include "models/config/declaration.h"

// What effects need of other parts, by the keys of a scenario.
namespace hvp::config {

inline Need need_timed_bus(std::string_view why) {
  return {"fidelity.bus", {"loosely-timed", "approximately-timed"}, why};
}

inline Need need_bus_cycles() { return {"fidelity.bus", {"approximately-timed"}}; }

inline Need need_timed_host() {
  return {"fidelity.host", {"loosely-timed"}, "the host takes no time"};
}

// Another effect.
inline Need need_table(std::string_view path) { return {path, {kPresent}}; }

inline Need need_board(std::string_view why = "there is no board") {
  return {"host.solver", {"board"}, why};
}

inline Need need_numbers() { return {"fidelity.numbers", {"fixed"}, "nobody computes numbers"}; }

}  // namespace hvp::config
