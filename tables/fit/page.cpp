#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "tables/fit/twins.h"
#include "tables/pages.h"
#include "tables/text.h"

namespace hvp::tables {

namespace {

constexpr const char* kHead = R"(# Do the intervals hold?

<!-- Made by `./hvp tables fit-coverage > docs/fit-coverage.md`: do not edit. -->

Code: `tables/fit/twins.h`. The fits: [fit.md](fit.md).

<!-- not run: writes into the checkout, minutes -->
```sh
./hvp tables fit-coverage > docs/fit-coverage.md
```

The log of each twin is made by another part of the program than the one that is fitted: the plant's exact motion, the
platform's own body and its direct solver, the platform's own distribution. {} logs each, which differ in their noise
(with an encoder in their motion). *Covers*: how many of the 95 % intervals contain the truth. *Error*: the estimates'
root mean square distance from the truth, over the intervals' mean half width, which is 1/1.96 = 0.51 for intervals that
are neither too wide nor too narrow.
)";

}  // namespace

std::vector<Coverage> coverage_of(const Twin& twin, int seeds) {
  std::vector<Coverage> counts(twin.truth.size());
  for (std::size_t i = 0; i < counts.size(); ++i) {
    counts[i].parameter = twin.truth[i].first;
    counts[i].truth = twin.truth[i].second;
  }
  for (int seed = 1; seed <= seeds; ++seed) {
    const fit::Fit fitted = twin.fit(seed);
    for (Coverage& c : counts) {
      for (const fit::Estimate& e : fitted.parameters) {
        if (e.name != c.parameter) continue;
        c.covered += (e.low <= c.truth && c.truth <= e.high ? 1.0 : 0.0) / seeds;
        c.identifiable += (e.identifiable ? 1.0 : 0.0) / seeds;
        c.mean_square += (e.value - c.truth) * (e.value - c.truth) / seeds;
        c.half_width += 0.5 * (e.high - e.low) / seeds;
      }
    }
  }
  return counts;
}

std::string fit_coverage_page(int seeds) {
  std::string text = fmt::format(fmt::runtime(kHead), seeds);
  for (const Twin& twin : twins()) {
    text += fmt::format("\n## {}: {}\n\n", twin.model, twin.log);
    MarkdownTable table({"parameter", "truth", "half width", "covers", "error", "identifiable"});
    for (const Coverage& c : coverage_of(twin, seeds)) {
      table.add({c.parameter, fmt::format("{:.3g}", c.truth), scientific(c.half_width),
                 fmt::format("{:.1f} %", 100 * c.covered),
                 fmt::format("{:.2f}", std::sqrt(c.mean_square) / c.half_width),
                 fmt::format("{:.0f} %", 100 * c.identifiable)});
    }
    text += table.text();
  }
  return text;
}

}  // namespace hvp::tables
