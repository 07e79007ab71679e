#include "app/results/driver_findings.h"

#include <optional>

#include <fmt/format.h>

namespace hvp::results {

std::string finding_text(const vp::DriverFinding& finding) {
  std::string text = fmt::format(
      "{}: {} ({}, at {}.{:03} ns, access {}{})", vp::name(finding.rule), finding.what,
      finding.job < 0 ? std::string("before any job") : fmt::format("job {}", finding.job),
      finding.first / 1000, finding.first % 1000, finding.access,
      finding.function.empty() ? std::string() : ", in " + finding.function);
  if (finding.count > 1) text += fmt::format(", {} times", finding.count);
  return text;
}

std::vector<std::string> report_lines(const vp::DriverReport& report) {
  if (report.accesses == 0) return {"not measured: the board was not accessed"};
  if (report.findings.empty()) {
    return {fmt::format("broke no rule; accesses to the board: {}", report.accesses)};
  }
  std::vector<std::string> lines;
  for (const vp::DriverFinding& one : report.findings) lines.push_back(finding_text(one));
  return lines;
}

void report_driver_findings(config::Figures& f, const vp::DriverReport& report) {
  f.count("driver_accesses", report.accesses, "to the BAR, at which the driver was watched");
  f.list("driver_findings",
         "One entry for each rule that the driver broke ([driver-rules.md](driver-rules.md)).",
         report.findings, [&](const vp::DriverFinding& one) {
           f.text("rule", vp::name(one.rule), "its name");
           f.count("count", one.count, "how often");
           f.text("what", one.what, "the first time");
           f.time("first_us", one.first, "when, from power-up");
           f.count("job", one.job >= 0 ? std::optional(one.job) : std::nullopt,
                   "the frame, or null before any");
           f.count("access", one.access, "the number of accesses to the BAR until then");
         });
}

}  // namespace hvp::results
