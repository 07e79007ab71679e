#include "app/results/flag_json.h"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace hvp::results {

namespace {
template <class Visit>
void for_each_flag(stability::Flags flags, const Visit& visit) {
  for (unsigned i = 0; i < static_cast<unsigned>(stability::Flag::count); ++i) {
    const auto flag = static_cast<stability::Flag>(i);
    if (flags.has(flag)) visit(stability::describe(flag));
  }
}
}  // namespace

std::vector<std::string> flag_names(stability::Flags flags) {
  std::vector<std::string> names;
  for_each_flag(flags, [&names](const stability::Description& d) { names.emplace_back(d.name); });
  return names;
}

stability::Flags flags_named(const std::vector<std::string>& names) {
  stability::Flags flags;
  for (unsigned i = 0; i < static_cast<unsigned>(stability::Flag::count); ++i) {
    const auto flag = static_cast<stability::Flag>(i);
    if (std::ranges::find(names, stability::describe(flag).name) != names.end()) flags.raise(flag);
  }
  return flags;
}

nlohmann::ordered_json remedies_json(stability::Flags flags) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for_each_flag(flags, [&list](const stability::Description& d) {
    list.push_back({{"flag", d.name}, {"meaning", d.meaning}, {"remedy", d.remedy}});
  });
  return list;
}

}  // namespace hvp::results
