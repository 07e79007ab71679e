#include "bench/fixed/bodies.h"

#include <array>
#include <cmath>
#include <map>

#include "tests/fixed/elastic_box.h"

namespace hvp::fixed::bench {

const sparse::BlockMatrix& stiffness(int nodes) {
  // Cells; the nodes of one face are held.
  static const std::map<int, std::array<int, 3>> boxes = {
      {500, {7, 8, 7}},      {1000, {10, 9, 9}},    {2000, {20, 9, 9}},   {5000, {20, 15, 15}},
      {10000, {24, 20, 19}}, {20000, {32, 24, 24}}, {50000, {48, 31, 32}}};
  static std::map<int, sparse::BlockMatrix> formed;
  const auto hit = formed.find(nodes);
  if (hit != formed.end()) return hit->second;
  const auto [x, y, z] = boxes.at(nodes);
  test::Body body = test::make_body({.cells_x = x, .cells_y = y, .cells_z = z});
  return formed.emplace(nodes, std::move(body.stiffness)).first->second;
}

Settings settings(Method method) {
  Settings s;
  s.method = method;
  s.iterations = kIterations;
  s.start = Start::zero;
  return s;
}

std::vector<std::int32_t> right_hand_side(const Settings& settings, int rows) {
  test::Random random(1);
  std::vector<std::int32_t> b;
  b.reserve(static_cast<std::size_t>(rows));
  for (int i = 0; i < rows; ++i) {
    b.push_back(
        static_cast<std::int32_t>(std::ldexp(random.symmetric(), 19 - settings.rhs_shift())));
  }
  return b;
}

}  // namespace hvp::fixed::bench
