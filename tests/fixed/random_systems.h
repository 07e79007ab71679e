#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "models/fixed/quantised_matrix.h"
#include "models/fixed/settings.h"
#include "tests/fixed/elastic_box.h"

namespace hvp::fixed::test {

// Any settings that Settings::check() lets pass, with as many iterations as a test has time for.
Settings random_settings(Random& random);

// What the settings decide, in one line for a failing test.
std::string describe(const Settings& settings);

// A symmetric matrix of words: definite or not, full or nearly empty, with rows of very different
// length, of up to `most_nodes` nodes, none included.
QuantisedMatrix random_matrix(Random& random, int bits, int most_nodes);

// Words of random size, a few of them beyond `bits` bits.
std::vector<std::int32_t> random_words(Random& random, int count, int bits);

}  // namespace hvp::fixed::test
