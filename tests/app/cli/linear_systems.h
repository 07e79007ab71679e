#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/app/cli/program.h"
#include "tests/app/scratch_directory.h"

// Systems for `hvp solve`, as files.
namespace hvp::cli {

struct Entry {
  int row;  // from 1; the lower triangle
  int column;
  double value;
};

std::string matrix_file(int rows, const std::vector<Entry>& lower);
std::string vector_file(const std::vector<double>& values);

// n masses between springs of stiffness `stiffness`, held at both ends: tridiagonal.
std::vector<Entry> chain(int n, double stiffness = 1);

std::vector<double> product(int rows, const std::vector<Entry>& lower,
                            const std::vector<double>& x);

// The numbers of a Matrix Market array.
std::vector<double> read_vector(const std::filesystem::path& file);

// A folder with A.mtx and b.mtx, and `hvp solve` in it.
class SystemFolder {
 public:
  SystemFolder(int rows, const std::vector<Entry>& lower, const std::vector<double>& b);
  // One of tests/data/matrix_market, with b = A·x.
  explicit SystemFolder(const std::string& name);

  Ended solve(const std::vector<std::string>& more = {}) const;
  // What a solve prints that ends with 0; each of `sets` follows a --set.
  nlohmann::json result(const std::vector<std::string>& sets = {}) const;
  std::vector<double> solution() const { return read_vector(path() / "solution.mtx"); }
  const std::filesystem::path& path() const { return place_.path(); }

 private:
  ScratchDirectory place_;
};

}  // namespace hvp::cli
