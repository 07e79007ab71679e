#include <algorithm>
#include <iterator>

#include <fmt/format.h>

#include "app/results/number_text.h"
#include "app/results/report.h"
#include "app/results/report_sections.h"

namespace hvp::results {

namespace {

using Out = std::back_insert_iterator<std::string>;

void path_line(Out out, std::string_view what, const PathShare& s) {
  fmt::format_to(out, "  {:<22} {:>10} {:>11} {:>11}  {:>5.1f} %", what, readable_time(s.time.p50),
                 readable_time(s.time.p99), readable_time(s.time.worst), 100 * s.share);
}

}  // namespace

std::string parts_text(const LatencyFigures& f) {
  std::string text;
  const Out out = std::back_inserter(text);
  fmt::format_to(out, "\n{:<24} {:>10} {:>11} {:>11}  {:>7}\n", "Every frame  by part", "median",
                 "99 %", "worst", "of mean");
  std::vector<PathShare> parts = f.by_part;
  std::stable_sort(parts.begin(), parts.end(), [](const PathShare& a, const PathShare& b) {
    return a.time.mean > b.time.mean;
  });
  for (const PathShare& part : parts) {
    path_line(out, part.part, part);
    text += '\n';
  }
  return text;
}

std::string details_text(const LatencyFigures& f) {
  std::string text;
  const Out out = std::back_inserter(text);
  fmt::format_to(out, "\n{:<24} {:>10} {:>11} {:>11}  {:>7} {:>9}\n", "Every frame  by phase",
                 "median", "99 %", "worst", "of mean", "frames");
  for (const PathShare& phase : f.by_phase) {
    path_line(out, fmt::format("{} {}", phase.part, phase.phase), phase);
    fmt::format_to(out, " {:>9}\n", phase.frames);
  }
  if (f.by_transaction.empty()) return text;
  fmt::format_to(out, "\n{:<24} {:>10} {:>11} {:>11}  {:>10} {:>6}\n", "Bus          each",
                 "median", "99 %", "worst", "mean", "count");
  for (const TransactionTimes& t : f.by_transaction) {
    fmt::format_to(out, "  {:<22} {:>10} {:>11} {:>11}  {:>10} {:>6}\n", t.phase,
                   readable_time(t.time.p50), readable_time(t.time.p99),
                   readable_time(t.time.worst),
                   readable_time(static_cast<vp::Picoseconds>(t.time.mean)), t.count);
  }
  return text;
}

}  // namespace hvp::results
