#pragma once

#include <cstdint>
#include <vector>

#include "models/fixed/quantised_matrix.h"
#include "tests/fixed/elastic_box.h"

namespace hvp::test {

// A symmetric matrix of words with a random pattern: `nodes` block rows of up to about `neighbours`
// blocks each, and a diagonal that makes it positive definite, or nearly so. Each node whose number
// is a multiple of `alone` has no neighbours; with zero there is none of them.
fixed::QuantisedMatrix random_matrix(int nodes, int neighbours, int bits,
                                     fixed::test::Random& random, int alone = 0);

}  // namespace hvp::test
