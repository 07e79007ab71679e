#pragma once

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace hvp::test {

// A waveform as a viewer reads it: value changes by full name, as (time, value).
struct ValueChanges {
  using Changes = std::vector<std::pair<std::int64_t, double>>;

  // The last value at a time.
  double at(const std::string& name, std::int64_t time) const {
    double value = std::nan("");
    for (const auto& [when, what] : changes.at(name)) {
      if (when <= time) value = what;
    }
    return value;
  }

  std::string timescale;
  std::map<std::string, Changes> changes;
};

// Of words with 32 or 64 bits the first one is the sign. In a VCD file it also stands for those
// that are left out.
inline double signed_value(const std::string& bits) {
  std::uint64_t value =
      bits[0] == '1' && (bits.size() == 32 || bits.size() == 64) ? ~std::uint64_t{0} : 0;
  for (const char bit : bits) value = value << 1U | (bit == '1' ? 1U : 0U);
  return static_cast<double>(static_cast<std::int64_t>(value));
}

// A VCD file, IEEE 1364 section 18.
inline ValueChanges read_vcd(const std::filesystem::path& path) {
  ValueChanges read;
  std::map<std::string, std::string> names;
  std::ifstream in(path);
  std::string token;
  std::vector<std::string> scope;
  while (in >> token) {
    if (token == "$timescale") {
      std::getline(in, read.timescale, '$');
    } else if (token == "$scope") {
      std::string kind, name;
      in >> kind >> name;
      scope.push_back(name);
    } else if (token == "$upscope") {
      scope.pop_back();
    } else if (token == "$var") {
      std::string type, width, id, name;
      in >> type >> width >> id >> name;
      std::string full;
      for (const std::string& part : scope) full += part + ".";
      names[id] = full + name;
      read.changes[full + name];
    } else if (token == "$enddefinitions") {
      break;
    }
  }
  std::int64_t time = 0;
  const auto add = [&](const std::string& id, double value) {
    if (names.contains(id)) read.changes[names[id]].emplace_back(time, value);
  };
  while (in >> token) {
    std::string id;
    if (token[0] == '#') {
      time = std::stoll(token.substr(1));
    } else if (token[0] == 'b') {
      in >> id;
      add(id, signed_value(token.substr(1)));
    } else if (token[0] == 'r') {
      in >> id;
      add(id, std::stod(token.substr(1)));
    } else if (token[0] == '0' || token[0] == '1') {
      add(token.substr(1), token[0] - '0');
    }
  }
  return read;
}

}  // namespace hvp::test
