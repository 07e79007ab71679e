#pragma once

#include <string>
#include <vector>

// Helpers to write Markdown for the pages of figures in docs/.
namespace hvp::tables {

// Writes two significant digits, as in the thesis' tables: 3.7e-2. Zero is 0.
std::string scientific(double value);

// A table in Markdown: the column heads, a line of dashes and the rows.
class MarkdownTable {
 public:
  explicit MarkdownTable(std::vector<std::string> heads);
  void add(std::vector<std::string> row);
  std::string text() const;

 private:
  std::size_t columns_;
  std::vector<std::vector<std::string>> rows_;
};

}  // namespace hvp::tables
