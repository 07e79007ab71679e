#pragma once

#include <string>

#include "models/config/input_error.h"

namespace hvp::app {

// Runs a part's step; what it throws names the part's own key, which is completed here.
template <class Step>
auto within(const std::string& table, const Step& step) {
  try {
    return step();
  } catch (const InputError& e) {
    throw InputError(e.key().empty() ? table : table + "." + e.key(), e.what());
  }
}

}  // namespace hvp::app
