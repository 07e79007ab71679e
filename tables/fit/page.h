#pragma once

#include <string>

namespace hvp::tables {

// How often the 95 % intervals of every model's parameters cover the truth, over so many seeds of
// noise: Markdown.
std::string fit_coverage_page(int seeds);

}  // namespace hvp::tables
