#include "app/results/latency_json.h"

#include <nlohmann/json.hpp>

namespace hvp::results {

using nlohmann::ordered_json;

namespace {

void append(ordered_json& to, const ordered_json& from) {
  for (const auto& [key, value] : from.items()) to[key] = value;
}

ordered_json histogram_json(const std::vector<statistics::Histogram::Part>& parts) {
  ordered_json list = ordered_json::array();
  for (const statistics::Histogram::Part& part : parts) {
    list.push_back(
        {{"from_us", us(part.from)}, {"below_us", us(part.below)}, {"frames", part.count}});
  }
  return list;
}

ordered_json path_json(const std::vector<PathShare>& lines) {
  ordered_json list = ordered_json::array();
  for (const PathShare& s : lines) {
    ordered_json j = {{"part", s.part}};
    if (!s.phase.empty()) {
      j["phase"] = s.phase;
      j["frames"] = s.frames;
    }
    append(j, spread_json(s.time));
    j["share"] = s.share;
    if (!s.histogram.empty()) j["histogram"] = histogram_json(s.histogram);
    list.push_back(std::move(j));
  }
  return list;
}

}  // namespace

ordered_json spread_json(const Spread& s) {
  return {{"p50_us", us(s.p50)},
          {"p99_us", us(s.p99)},
          {"worst_us", us(s.worst)},
          {"mean_us", s.mean / 1e6}};
}

ordered_json octaves_json(const std::vector<statistics::Histogram::Octave>& octaves,
                          const char* counted) {
  ordered_json list = ordered_json::array();
  for (const statistics::Histogram::Octave& octave : octaves) {
    list.push_back({{"from_us", us(octave.from)}, {counted, octave.count}});
  }
  return list;
}

ordered_json latency_json(const LatencyFigures& f) {
  ordered_json j;
  j["best_us"] = us(f.best);
  j["mean_us"] = f.mean / 1e6;
  j["percentiles"] = {{"p50_us", us(f.p50)},
                      {"p90_us", us(f.p90)},
                      {"p99_us", us(f.p99)},
                      {"p99_9_us", us(f.p99_9)},
                      {"worst_us", us(f.worst)}};
  j["histogram"] = histogram_json(f.histogram);
  j["by_part"] = path_json(f.by_part);
  j["by_phase"] = path_json(f.by_phase);
  j["by_transaction"] = ordered_json::array();
  for (const TransactionTimes& t : f.by_transaction) {
    ordered_json line = {{"transaction", t.phase}, {"count", t.count}};
    append(line, spread_json(t.time));
    line["octaves"] = octaves_json(t.octaves, "count");
    j["by_transaction"].push_back(std::move(line));
  }
  return j;
}

}  // namespace hvp::results
