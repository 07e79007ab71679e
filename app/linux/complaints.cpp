#include "app/linux/complaints.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "models/config/input_error.h"

namespace hvp::guest {

namespace {

// The kernel's own line before a module of nobody's tree starts.
constexpr std::string_view kLoading = "hvp: loading out-of-tree module";

// Drops "[   12.345678] " and, with it, what differs between two complaints of the same.
std::string_view without_time(std::string_view line) {
  if (!line.starts_with('[')) return line;
  const std::size_t end = line.find("] ");
  return end == std::string_view::npos ? line : line.substr(end + 2);
}

bool contains(std::string_view text, std::string_view part) {
  return text.find(part) != std::string_view::npos;
}

// What any kernel says when it finds itself in the wrong.
bool of_any_kernel(std::string_view text) {
  return text.starts_with("WARNING: ") || text.starts_with("BUG: ");
}

}  // namespace

const std::vector<Check>& kernel_checks() {
  static const std::vector<Check> kChecks = {
      {"kasan", {"BUG: KASAN: ", "unreferenced object 0x"}},
      {"lockdep",
       {"WARNING: possible ", "-unsafe lock order detected", "WARNING: inconsistent lock state",
        "WARNING: bad unlock balance", "WARNING: suspicious RCU usage", "WARNING: held lock freed",
        "WARNING: Nested lock", "BUG: sleeping function called", "BUG: spinlock ",
        "INFO: trying to register non-static", "INFO: task ",
        "DMA-API: ", "ODEBUG: ", "list_add corruption", "list_del corruption"}},
  };
  return kChecks;
}

Checks parse_checks(std::string_view text) {
  constexpr std::string_view kDma = "dma";
  constexpr std::string_view kDriver = "driver";
  Checks found;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const std::string_view word = text.substr(begin, end - begin);
    const auto& all = kernel_checks();
    if (word == kDma) {
      found.dma = true;
    } else if (word == kDriver) {
      found.driver = true;
    } else if (std::ranges::find(all, word, &Check::word) != all.end()) {
      found.of_kernel.emplace_back(word);
    } else {
      std::vector<std::string_view> known = {kDriver, kDma};
      for (const Check& check : all) known.push_back(check.word);
      throw InputError(fmt::format("--check {}: expected words of {}, with commas between them",
                                   text, fmt::join(known, ", ")));
    }
    begin = end + 1;
  }
  std::vector<std::string>& words = found.of_kernel;
  std::ranges::sort(words);
  words.erase(std::unique(words.begin(), words.end()), words.end());
  return found;
}

void Complaints::read(std::string_view line) {
  if (words_.empty()) return;
  if (!loaded_) {
    loaded_ = contains(line, kLoading);
    return;
  }
  const std::string_view text = without_time(line);
  for (const Check& check : kernel_checks()) {
    if (std::ranges::find(words_, check.word) == words_.end()) continue;
    for (const std::string_view sign : check.signs) {
      if (contains(text, sign)) return add(check.word, text);
    }
  }
  if (of_any_kernel(text)) add("kernel", text);
}

void Complaints::add(std::string_view check, std::string_view text) {
  for (Complaint& known : found_) {
    if (known.check == check && known.text == text) {
      ++known.count;
      return;
    }
  }
  found_.push_back({std::string(check), std::string(text), 1});
}

}  // namespace hvp::guest
