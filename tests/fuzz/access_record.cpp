// The reader of recorded accesses on arbitrary bytes, and what is made of a record that it takes.
// What must hold: nothing but InputError is thrown, of one line that names the file and a byte;
// what was read is within the file and makes the same file again; a record is like itself.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "app/record/comparison.h"
#include "app/record/record.h"
#include "models/config/input_error.h"

namespace {

using namespace hvp::record;

void require(bool holds) {
  if (!holds) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  try {
    const Record record = parse_record(bytes, "a.bin");
    std::string again = compose_head(record.layer(), record.scenario());
    for (const Entry& entry : record.entries()) {
      require(entry.at == again.size());
      again += compose(entry);
    }
    require(bytes.starts_with(again));
    require(again.size() == bytes.size() || !record.cut().empty());
    const Comparison comparison = compare(record, record);
    require(comparison.alike() && !comparison.first_of_time);
  } catch (const hvp::InputError& error) {
    const std::string_view line = error.what();
    require(line.starts_with("a.bin: byte ") && line.size() < 1000);
    require(line.find('\n') == std::string_view::npos);
  }
  return 0;
}
