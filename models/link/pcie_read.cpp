// Reads whose requests are not all answered in the same time.
#include <algorithm>
#include <cstddef>
#include <vector>

#include "models/link/pcie.h"

namespace hvp::link {

namespace {

class SameTime : public CompleterTimes {
 public:
  explicit SameTime(std::int64_t ps) : ps_(ps) {}
  std::int64_t ps(std::int64_t /*request*/) const override { return ps_; }

 private:
  std::int64_t ps_;
};

}  // namespace

// From the first request's start until the last completion is back. A request waits for the one
// before it, for a tag and for a credit; a completion for the ones before it.
std::int64_t Pcie::request_by_request_ps(std::int64_t bytes, const CompleterTimes& times) const {
  const std::int64_t n = requests(bytes);
  const std::int64_t request = tlp_ps(read_header_bytes());
  std::vector<std::int64_t> starts;
  std::vector<std::int64_t> ends;
  std::int64_t wire_free = 0;
  for (std::int64_t k = 0; k < n; ++k) {
    std::int64_t start = k == 0 ? 0 : starts.back() + request;
    if (k >= outstanding_reads) {
      start = std::max(start, ends[static_cast<std::size_t>(k - outstanding_reads)]);
    }
    if (k >= nonposted_header_credits) {
      start = std::max(start, starts[static_cast<std::size_t>(k - nonposted_header_credits)] +
                                  request_loop_ps());
    }
    const std::int64_t payload =
        std::min<std::int64_t>(max_read_request_bytes, bytes - k * max_read_request_bytes);
    const std::int64_t ready = start + request + link_ps() + times.ps(k);
    wire_free = std::max(ready, wire_free) + tlp_ps(completion_wire_bytes(payload));
    starts.push_back(start);
    ends.push_back(wire_free + link_ps());
  }
  return ends.back();
}

// The formula of equal times, and by how much these differ from them: so that equal times are the
// formula's to the picosecond.
std::int64_t Pcie::read_ps(PcieSide requester, std::int64_t bytes,
                           const CompleterTimes& times) const {
  return read_ps(requester, bytes) + request_by_request_ps(bytes, times) -
         request_by_request_ps(bytes, SameTime(completer_ps(requester)));
}

}  // namespace hvp::link
