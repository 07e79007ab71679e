// Both Matrix Market readers on arbitrary bytes. What must hold: they throw nothing but an
// InputError of one printable line, memory stays in proportion to the file, and what they accept
// reads back from what is written as the same bits.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "models/config/input_error.h"
#include "models/sparse/matrix_market.h"

namespace {

using hvp::sparse::read_matrix_market;
using hvp::sparse::read_matrix_market_vector;
using hvp::sparse::write_matrix_market;

void require(bool holds) {
  if (!holds) std::abort();
}

template <class Read>
void survive(const Read& read) {
  try {
    read();
  } catch (const hvp::InputError& error) {
    const std::string_view line = error.what();
    require(!line.empty() && line.size() < 400);
    require(std::none_of(line.begin(), line.end(),
                         [](char c) { return static_cast<unsigned char>(c) < 0x20; }));
  }
}

void read_matrix(const std::string& text) {
  std::istringstream file(text);
  const hvp::sparse::SquareMatrix read = read_matrix_market(file, "x");
  require(read.rows > 0 && read.matrix.rows() >= read.rows && read.matrix.rows() < read.rows + 3);
  // An entry takes six bytes and touches two blocks of nine doubles.
  require(read.matrix.value.size() <= 9 * text.size());
  std::stringstream again;
  write_matrix_market(again, read.matrix);
  const hvp::sparse::SquareMatrix second = read_matrix_market(again, "again");
  require(second.matrix.row_begin == read.matrix.row_begin);
  require(second.matrix.column == read.matrix.column);
  require(second.matrix.value == read.matrix.value);
}

void read_vector(const std::string& text) {
  std::istringstream file(text);
  const std::vector<double> read = read_matrix_market_vector(file, "x");
  std::stringstream again;
  write_matrix_market(again, read);
  require(read_matrix_market_vector(again, "again") == read);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(data, data + size);
  survive([&text] { read_matrix(text); });
  survive([&text] { read_vector(text); });
  return 0;
}
