#pragma once

#include <string>

#include "app/scenario/outline.h"

namespace hvp::scenario {

// The reference page in Markdown: a section for each TOML table, a row for each key with its type
// or dimension, range, default, help and the default's source. Effects are marked.
std::string reference_page(const Outline& outline);

// The sections of the tables, without the page's introduction.
std::string reference_tables(const Outline& outline);

// The reference page of a declared struct. docs/scenario-reference.md is that of the whole
// scenario.
template <class Root>
std::string reference_page(const Root& root) {
  return reference_page(describe(root));
}

}  // namespace hvp::scenario
