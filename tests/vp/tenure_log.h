#pragma once

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "vp/frame/ledger.h"

namespace hvp::test {

// Keeps every tenure.
class TenureLog : public vp::TenureSink {
 public:
  void take(const vp::Tenure& tenure) override { tenures.push_back(tenure); }

  std::vector<vp::Tenure> of(vp::Resource resource) const {
    std::vector<vp::Tenure> found;
    std::ranges::copy_if(tenures, std::back_inserter(found),
                         [resource](const vp::Tenure& t) { return t.resource == resource; });
    return found;
  }
  vp::Picoseconds busy(vp::Resource resource) const {
    vp::Picoseconds sum = 0;
    for (const vp::Tenure& t : of(resource)) sum += t.end - t.start;
    return sum;
  }
  // One user at a time, in the order of time.
  void expect_no_overlap() const {
    for (int r = 0; r <= static_cast<int>(vp::Resource::link_to_host); ++r) {
      const std::vector<vp::Tenure> all = of(static_cast<vp::Resource>(r));
      for (std::size_t i = 0; i < all.size(); ++i) {
        EXPECT_LT(all[i].start, all[i].end) << all[i].what;
        if (i == 0) continue;
        EXPECT_LE(all[i - 1].end, all[i].start) << name(all[i].resource) << ", " << all[i].what;
      }
    }
  }

  std::vector<vp::Tenure> tenures;
};

}  // namespace hvp::test
