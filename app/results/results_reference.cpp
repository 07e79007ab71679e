#include "app/results/results_reference.h"

#include <map>
#include <vector>

#include <fmt/format.h>

#include "app/results/figure_list.h"
#include "app/results/frames_csv.h"
#include "app/results/outcome.h"

namespace hvp::results {

namespace {

constexpr std::string_view kHead = "| key | unit | what it is |\n|---|---|---|\n";

std::string cell(std::string_view text) {
  std::string result;
  for (const char c : text) result += c == '|' ? std::string("\\|") : std::string(1, c);
  return result;
}

// "deadline" of "deadline.worst_us", "faults[]" of "faults[].kind"; empty for a key of no table.
std::string_view table_of(std::string_view key) {
  const std::size_t end = key.find('.');
  return end == std::string_view::npos ? std::string_view() : key.substr(0, end);
}

// The keys of no table come first; tables in the order in which they begin.
std::string summary_section(const std::vector<ListedFigure>& figures) {
  std::vector<std::string_view> order = {""};
  std::map<std::string_view, std::string> sections = {{"", std::string(kHead)}};
  for (const ListedFigure& figure : figures) {
    const std::string_view table = table_of(figure.key);
    const bool heads = !table.empty() && figure.key == fmt::format("{}.*", table);
    const auto [at, is_new] = sections.try_emplace(table);
    if (is_new) order.push_back(table);
    if (is_new || heads) {
      at->second += fmt::format("\n### `{}`\n\n{}\n\n{}", table, heads ? figure.help : "", kHead);
    }
    if (heads) continue;
    at->second += fmt::format("| `{}` | {} | {} |\n", figure.key, figure.unit, cell(figure.help));
  }
  std::string text;
  for (const std::string_view table : order) text += sections[table];
  return text;
}

}  // namespace

std::string results_reference_page() {
  std::string text =
      "# Results reference\n\n"
      "Written from the declarations of the figures; do not edit. What the files are for stands in "
      "[results.md](results.md).\n\n"
      "## summary.json\n\n"
      "`a[].b` stands for `b` of each entry of the list `a`, `a.<item>.b` for `b` of any table in "
      "`a`, and `a.*` for all of the table `a`. Numbers are in SI units unless the key says "
      "otherwise. A line that says \"with\" is of a key that is left out elsewhere.\n\n";
  text += summary_section(declared_figures<Outcome>());
  text += "\n## frames.csv\n\n| column | what it is |\n|---|---|\n";
  for (const FrameColumn& column : frame_columns()) {
    text += fmt::format("| `{}` | {} |\n", column.name, cell(column.help));
  }
  ProbeColumns all{std::vector<plant::Trajectory>(2), true, true, plant::Hand{}};
  text +=
      "\nBehind these, with `[device.dynamics]` and for each further `[[probe]]`; names of a "
      "further "
      "probe begin with `probe1_`, `probe2_`, …\n\n| column | what it is |\n|---|---|\n";
  for (std::size_t i = 0; i < 2; ++i) {
    for (const FrameColumn& column : probe_columns(all, i)) {
      if (i == 1 && column.name.starts_with("probe1_tip")) break;
      text += fmt::format("| `{}` | {} |\n", column.name, cell(column.help));
    }
  }
  return text;
}

}  // namespace hvp::results
