#include "models/fem/renewal.h"

namespace hvp::fem {

void MatrixRenewal::declare(config::Visitor& v) {
  v.integer("renew_every", every, {0, 1'000'000},
            {"solved frames from one renewal to the next; 0: never",
             "the matrix at rest serves up to 20 degrees of turn, docs/tissue.md"});
  v.quantity("headroom", headroom, config::Dimension::dimensionless, config::between(1, 64),
             {"largest entry that a board's words have room for, over that of the body at rest; "
              "the scale of the words stays as it is",
              "neo-Hookean tangents at an indentation of 20 %; 1.7 at 40 %, docs/tissue.md"});
}

}  // namespace hvp::fem
