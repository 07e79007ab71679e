#include "models/files/elf_functions.h"

#include <algorithm>
#include <cstring>
#include <fstream>
#include <iterator>

#include <elf.h>

namespace hvp::files {

namespace {

// The value at an offset of a file's bytes; all zeros beyond its end.
template <class Value>
Value value_at(const std::string& bytes, std::uint64_t offset) {
  Value value{};
  if (offset <= bytes.size() && sizeof value <= bytes.size() - offset) {
    std::memcpy(&value, bytes.data() + offset, sizeof value);
  }
  return value;
}

}  // namespace

std::vector<Function> functions_of(const std::filesystem::path& program) {
  std::ifstream file(program, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  std::vector<Function> functions;
  const auto head = value_at<Elf64_Ehdr>(bytes, 0);
  if (std::memcmp(head.e_ident, ELFMAG, SELFMAG) != 0 || head.e_ident[EI_CLASS] != ELFCLASS64) {
    return functions;
  }
  for (std::uint64_t i = 0; i < head.e_shnum; ++i) {
    const auto table = value_at<Elf64_Shdr>(bytes, head.e_shoff + i * sizeof(Elf64_Shdr));
    if (table.sh_type != SHT_SYMTAB) continue;
    const auto names = value_at<Elf64_Shdr>(bytes, head.e_shoff + table.sh_link * sizeof table);
    for (std::uint64_t at = 0; at + sizeof(Elf64_Sym) <= table.sh_size; at += sizeof(Elf64_Sym)) {
      const auto symbol = value_at<Elf64_Sym>(bytes, table.sh_offset + at);
      const std::uint64_t name = names.sh_offset + symbol.st_name;
      if (ELF64_ST_TYPE(symbol.st_info) != STT_FUNC || symbol.st_size == 0) continue;
      if (name >= bytes.size()) continue;
      functions.push_back(
          {symbol.st_value, symbol.st_value + symbol.st_size, std::string(bytes.c_str() + name)});
    }
  }
  std::ranges::sort(functions, {}, &Function::begin);
  return functions;
}

const Function* function_at(const std::vector<Function>& functions, std::uint64_t address) {
  const auto after = std::ranges::upper_bound(functions, address, {}, &Function::begin);
  if (after == functions.begin()) return nullptr;
  const Function& found = *std::prev(after);
  return address < found.end ? &found : nullptr;
}

}  // namespace hvp::files
