#pragma once

#include <utility>
#include <vector>

#include "models/tissue/law.h"
#include "models/tissue/prony.h"

namespace hvp::tissue {

// What a body's elements are made of, besides Lamé's constants and the density.
struct Constitution {
  LawKind law = LawKind::linear;
  Parameters parameters = {};
  std::vector<PronyTerm> prony = {};  // relaxation of the law's forces; empty: none

  // A law alone is one.
  // NOLINTNEXTLINE(google-explicit-constructor)
  Constitution(LawKind kind, const Parameters& p = {}, std::vector<PronyTerm> terms = {})
      : law(kind), parameters(p), prony(std::move(terms)) {}
};

}  // namespace hvp::tissue
