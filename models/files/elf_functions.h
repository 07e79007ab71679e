#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace hvp::files {

// A function of a program, as the file has it: [begin, end) is where it lies before it is loaded.
struct Function {
  std::uint64_t begin;
  std::uint64_t end;
  std::string name;  // mangled where it is C++
};

// The functions of a 64-bit ELF program with its symbols (ELF-64 Object File Format, version 1.5),
// static ones among them, by address. Empty for another file, and for one that was stripped.
std::vector<Function> functions_of(const std::filesystem::path& program);

// The one that has this address; null: none.
const Function* function_at(const std::vector<Function>& functions, std::uint64_t address);

}  // namespace hvp::files
