#include "models/host/recovery.h"

#include <algorithm>

namespace hvp::host {

namespace {
constexpr int kLongestBackOff = 1 << 20;  // frames

std::vector<std::pair<std::string_view, Guard>> guard_names() {
  return {{"with-faults", Guard::with_faults}, {"always", Guard::always}, {"never", Guard::never}};
}
}  // namespace

void Recovery::declare(config::Visitor& v) {
  v.choice("bus_errors", bus_errors, guard_names(),
           {"whether the driver asks the bridge, twice a frame, for aborted accesses and damaged "
            "words; with-faults: where the scenario has [[fault]]",
            "a frame without faults is the thesis'"});
  v.choice("hold_saturated", hold_saturated, guard_names(),
           {"whether the force of a solve that saturated is held back and the last one kept",
            "a frame without faults is the thesis'"});
  v.integer("retries", retries, {0, 16},
            {"how often a frame repeats an access to STATUS or U that failed, while there is time",
             "assumed: what is wrong twice will stay so"});
  v.integer("attempts", attempts, {1, 64},
            {"set-ups of the board in a row that may fail before it is given up", "assumed"});
  v.integer("back_off", back_off_frames, {1, 10'000},
            {"frames between the first set-up that fails and the next; doubled each time",
             "assumed: with 8 attempts a quarter of a second at 500 Hz"});
}

int Recovery::back_off(int failed) const {
  std::int64_t frames = back_off_frames;
  for (int i = 1; i < failed && frames < kLongestBackOff; ++i) frames *= 2;
  return static_cast<int>(std::min<std::int64_t>(frames, kLongestBackOff));
}

}  // namespace hvp::host
