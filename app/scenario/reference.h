#pragma once

#include <string>

#include "app/scenario/outline.h"

namespace hvp::scenario {

// The reference page in Markdown: a section a TOML table, a row a key with its type or
// dimension, range, default, help and the source of the default. Effects are marked as such.
std::string reference_page(const Outline& outline);

// The sections of the tables alone.
std::string reference_tables(const Outline& outline);

// From the declaration itself; docs/scenario-reference.md is this of the whole scenario.
template <class Root>
std::string reference_page(const Root& root) {
  return reference_page(describe(root));
}

}  // namespace hvp::scenario
