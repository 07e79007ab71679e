#include "tests/app/cli/linear_systems.h"

#include <cmath>
#include <sstream>

#include <gtest/gtest.h>

#include "models/index.h"

namespace hvp::cli {

namespace {

std::string number(double value) {
  std::ostringstream text;
  text.precision(17);
  text << value;
  return text.str();
}

// Lines that are no comment.
std::vector<std::string> content(const std::filesystem::path& file) {
  std::vector<std::string> result;
  for (const std::string& line : lines(read(file))) {
    if (!line.starts_with("%")) result.push_back(line);
  }
  return result;
}

}  // namespace

std::string matrix_file(int rows, const std::vector<Entry>& lower) {
  std::string text = "%%MatrixMarket matrix coordinate real symmetric\n" + std::to_string(rows) +
                     " " + std::to_string(rows) + " " + std::to_string(lower.size()) + "\n";
  for (const Entry& e : lower) {
    text += std::to_string(e.row) + " " + std::to_string(e.column) + " " + number(e.value) + "\n";
  }
  return text;
}

std::string vector_file(const std::vector<double>& values) {
  std::string text =
      "%%MatrixMarket matrix array real general\n" + std::to_string(values.size()) + " 1\n";
  for (const double value : values) text += number(value) + "\n";
  return text;
}

std::vector<Entry> chain(int n, double stiffness) {
  std::vector<Entry> lower;
  for (int i = 1; i <= n; ++i) {
    lower.push_back({i, i, 2 * stiffness});
    if (i < n) lower.push_back({i + 1, i, -stiffness});
  }
  return lower;
}

std::vector<double> product(int rows, const std::vector<Entry>& lower,
                            const std::vector<double>& x) {
  std::vector<double> b(at(rows), 0.0);
  for (const Entry& e : lower) {
    b[at(e.row - 1)] += e.value * x[at(e.column - 1)];
    if (e.row != e.column) b[at(e.column - 1)] += e.value * x[at(e.row - 1)];
  }
  return b;
}

std::vector<double> read_vector(const std::filesystem::path& file) {
  const std::vector<std::string> text = content(file);
  std::vector<double> values;
  for (std::size_t i = 1; i < text.size(); ++i) values.push_back(std::stod(text[i]));
  return values;
}

SystemFolder::SystemFolder(int rows, const std::vector<Entry>& lower,
                           const std::vector<double>& b) {
  write(path() / "A.mtx", matrix_file(rows, lower));
  write(path() / "b.mtx", vector_file(b));
}

SystemFolder::SystemFolder(const std::string& name) {
  const std::vector<std::string> text =
      content(std::filesystem::path(HVP_TEST_DATA) / "matrix_market" / (name + ".mtx"));
  int rows = 0;
  std::istringstream(text.at(0)) >> rows;
  std::vector<Entry> lower;
  for (std::size_t i = 1; i < text.size(); ++i) {
    Entry e{};
    std::istringstream(text[i]) >> e.row >> e.column >> e.value;
    lower.push_back(e);
  }
  std::vector<double> x(at(rows));
  for (int i = 0; i < rows; ++i) x[at(i)] = 1 + 0.5 * std::sin(i);
  write(path() / "A.mtx", matrix_file(rows, lower));
  write(path() / "b.mtx", vector_file(product(rows, lower, x)));
}

Ended SystemFolder::solve(const std::vector<std::string>& more) const {
  std::vector<std::string> arguments = {"solve", "--matrix", "A.mtx", "--rhs", "b.mtx"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return hvp(path(), arguments);
}

nlohmann::json SystemFolder::result(const std::vector<std::string>& sets) const {
  std::vector<std::string> arguments;
  for (const std::string& set : sets) {
    arguments.emplace_back("--set");
    arguments.push_back(set);
  }
  const Ended ended = solve(arguments);
  EXPECT_EQ(ended.status, 0) << ended.err;
  return nlohmann::json::parse(ended.out);
}

}  // namespace hvp::cli
