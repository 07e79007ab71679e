#pragma once

#include <string>
#include <vector>

// Markdown, as the pages of figures in docs/ are written.
namespace hvp::tables {

// Two significant digits, as the thesis prints its tables: 3.7e-2. Zero is 0.
std::string scientific(double value);

// Rows of cells, the first of them the heads of the columns, with a line of dashes below it.
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
