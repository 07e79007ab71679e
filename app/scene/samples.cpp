#include "app/scene/samples.h"

#include <algorithm>
#include <string>

#include <fmt/format.h>

#include "app/scenario/message.h"
#include "models/config/input_error.h"
#include "models/files/latencies.h"

namespace hvp::app {

namespace {

constexpr std::size_t kMostSamples = 1'000'000;

Samples samples_of(const files::Latencies& latencies, const std::string& name) {
  Samples samples;
  for (const files::Latencies::Entry& entry : latencies.entries) {
    if (entry.count == 0) continue;
    samples.times_s.push_back(entry.seconds);
    samples.counts.push_back(entry.count);
  }
  if (latencies.overflows > 0) {
    if (!latencies.longest) {
      throw InputError(
          fmt::format("{}: {} latencies are beyond the histogram, and no line "
                      "'# Max Latencies:' says how long they were",
                      name, latencies.overflows));
    }
    samples.times_s.push_back(*latencies.longest);
    samples.counts.push_back(latencies.overflows);
  }
  if (samples.times_s.empty()) throw InputError(name + ": all counts are zero");
  if (samples.times_s.size() > kMostSamples)
    throw InputError(name + ": more than a million samples");
  if (std::ranges::all_of(samples.counts, [](std::int64_t count) { return count == 1; })) {
    samples.counts.clear();
  }
  return samples;
}

}  // namespace

Samples read_samples(const std::filesystem::path& file) {
  try {
    return samples_of(files::read_latencies_file(file), file.filename().string());
  } catch (const InputError& error) {
    throw InputError("samples", scenario::one_line(error.what()));
  }
}

}  // namespace hvp::app
