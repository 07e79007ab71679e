#include "app/board/program_place.h"

#include <array>
#include <cstdlib>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <cxxabi.h>
#include <dlfcn.h>
#include <execinfo.h>
#include <link.h>

#include "models/files/elf_functions.h"

namespace hvp::app {

namespace {

constexpr std::size_t kShown = 3;

// "a::b(int)" as "a::b"; a name of C as it is.
std::string readable(const std::string& name) {
  int status = 0;
  const std::unique_ptr<char, decltype(&std::free)> text(
      abi::__cxa_demangle(name.c_str(), nullptr, nullptr, &status), &std::free);
  if (status != 0) return name;
  const std::string_view whole = text.get();
  return std::string(whole.substr(0, whole.rfind('(')));
}

// The library's functions that a program, or its driver, calls.
bool is_entry(std::string_view name) {
  return name.starts_with("hvp_board_") || name.find("3hvp3app8BoardBus") != std::string_view::npos;
}

// The mangled name of the function that this address returns to; empty: there is none.
std::string name_at(std::uintptr_t address) {
  const std::uintptr_t call = address - 1;
  Dl_info info{};
  link_map* map = nullptr;
  void* const where = reinterpret_cast<void*>(call);  // NOLINT
  if (dladdr1(where, &info, reinterpret_cast<void**>(&map), RTLD_DL_LINKMAP) == 0) return {};
  const bool own = map == nullptr || map->l_name == nullptr || *map->l_name == '\0';
  // Read once, when a first finding is named.
  static std::map<std::string, std::vector<files::Function>> known;
  const std::string file = own ? "/proc/self/exe" : map->l_name;
  const auto entry = known.find(file);
  const std::vector<files::Function>& functions =
      entry != known.end() ? entry->second : known[file] = files::functions_of(file);
  const files::Function* const function =
      files::function_at(functions, call - (map == nullptr ? 0 : map->l_addr));
  if (function != nullptr) return function->name;
  return info.dli_sname == nullptr ? "" : info.dli_sname;
}

}  // namespace

vp::HostPlace own_stack() {
  vp::HostPlace place{};
  std::array<void*, std::tuple_size_v<vp::HostPlace>> addresses{};
  const int found = backtrace(addresses.data(), static_cast<int>(addresses.size()));
  for (int i = 0; i < found; ++i) {
    const auto at = static_cast<std::size_t>(i);
    place.at(at) = reinterpret_cast<std::uintptr_t>(addresses.at(at));
  }
  return place;
}

void name_place(const vp::HostPlace& place, vp::DriverFinding& finding) {
  bool entered = false;
  std::size_t shown = 0;
  for (const std::uintptr_t address : place) {
    if (address == 0 || shown == kShown) return;
    const std::string name = name_at(address);
    if (is_entry(name)) {
      entered = true;
      continue;
    }
    if (!entered || name.empty()) continue;
    if (shown++ == 0) finding.program_counter = address - 1;
    if (!finding.function.empty()) finding.function += " < ";
    finding.function += readable(name);
  }
}

}  // namespace hvp::app
