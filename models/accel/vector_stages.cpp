#include <algorithm>
#include <bit>
#include <cstddef>
#include <limits>

#include "models/accel/bits.h"
#include "models/accel/engine_paths.h"
#include "models/accel/multipliers.h"

namespace hvp::accel {

namespace {

VectorStage stage(std::string_view name, std::initializer_list<Step> steps) {
  VectorStage s{name, {}, static_cast<int>(steps.size())};
  std::ranges::copy(steps, s.steps.begin());
  return s;
}

// Thesis Fig. 5.10: the multiplexer chooses what shares the multiplier. Then the parts of the
// product are added.
void multiply(VectorStages& stages, std::string_view name, const Architecture& a,
              const MultiplierMode& multiplier, int magnitude, int bits, int other_bits) {
  const Step choose{Operation::multiplexer, 2};
  const Step absolute{Operation::absolute_value, magnitude};
  const Step product{Operation::multiplier, magnitude};
  if (a.absolute_value_register) {
    stages.push_back(stage(name, {choose, absolute}));
    stages.push_back(stage(name, {product}));
  } else {
    stages.push_back(stage(name, {choose, absolute, product}));
  }
  for (int parts = multipliers_a_product(multiplier, bits, other_bits); parts > 1;
       parts = ceil_div(parts, 2)) {
    stages.push_back(stage("parts of a product", {{Operation::adder, bits + other_bits}}));
  }
}

void round_and_clamp(VectorStages& stages, int bits) {
  stages.push_back(stage("rounding", {{Operation::adder, bits}}));
  stages.push_back(stage("saturation", {{Operation::saturation, bits}}));
}

void append(const VectorStage& s, PathBuilder& path) {
  for (int i = 0; i < s.count; ++i) {
    const Step& step = s.steps[static_cast<std::size_t>(i)];
    switch (step.operation) {
      case Operation::multiplexer:
        path.multiplexer(step.size);
        break;
      case Operation::shifter:
        path.shifter(step.size);
        break;
      case Operation::saturation:  // are all the dropped bits the sign's?
        path.gates(step.size).multiplexer(2);
        break;
      case Operation::absolute_value:
        path.absolute_value(step.size);
        break;
      case Operation::adder:
        path.adder(step.size);
        break;
      case Operation::multiplier:
        path.multiplier(step.size);
        break;
    }
  }
}

// Named by the stage that is longest in it.
const Path& rank(const VectorStages& stages, std::size_t first, std::size_t end,
                 PathBuilder& path) {
  std::string_view name = stages[first].name;
  if (end - first > 1) {
    double longest = 0;
    for (std::size_t i = first; i < end; ++i) {
      path.begin({}).from_register();
      append(stages[i], path);
      const double delay = path.to_register().delay_s();
      if (delay > longest) name = stages[i].name;
      longest = std::max(longest, delay);
    }
  }
  path.begin(name).from_register();
  for (std::size_t i = first; i < end; ++i) append(stages[i], path);
  return path.to_register();
}

// The ends of ranks that are filled up to `limit`; in `next` the least limit that would change
// them.
void fill(const VectorStages& stages, double limit, PathBuilder& path,
          std::vector<std::size_t>& ends, double& next) {
  ends.clear();
  next = std::numeric_limits<double>::infinity();
  std::size_t first = 0;
  for (std::size_t i = 1; i < stages.size(); ++i) {
    const double longer = rank(stages, first, i + 1, path).delay_s();
    if (longer <= limit) continue;
    next = std::min(next, longer);
    ends.push_back(i);
    first = i;
  }
  ends.push_back(stages.size());
}

}  // namespace

int magnitude_bits(const MultiplierMode& multiplier, const WordLengths& words) {
  const int port = multiplier.other_bits;
  const int pieces = ceil_div(kProductBits - 1, port - 1);
  return std::max(ceil_div(kProductBits, pieces), std::min(words.vector_bits, port));
}

VectorStages product_stages(const Architecture& a, const WordLengths& w,
                            const MultiplierMode& multiplier) {
  VectorStages stages;
  const int sum_bits = w.matrix_bits + w.vector_bits + kRowGrowthBits;
  // Bits are dropped, and rounded, where the words are wider than the thesis'.
  if (w.matrix_bits + w.vector_bits + fixed::Settings::kGrowthBits > kProductBits) {
    stages.push_back(stage("rounding of A d", {{Operation::adder, sum_bits}}));
  }
  stages.push_back(stage("saturation of A d", {{Operation::saturation, sum_bits}}));
  multiply(stages, "inner product d'(A d)", a, multiplier, magnitude_bits(multiplier, w),
           kProductBits, w.vector_bits);
  stages.push_back(stage("accumulator of d'(A d)", {{Operation::adder, w.scalar_bits}}));
  return stages;
}

VectorStages update_stages(const Architecture& a, const WordLengths& w,
                           const MultiplierMode& multiplier) {
  VectorStages stages;
  const int magnitude = magnitude_bits(multiplier, w);
  const int scaled = w.coefficient_bits + kProductBits;
  const int residual = w.preconditioned() ? kProductBits : w.vector_bits;
  for (int parts = multipliers_a_product(multiplier, kProductBits, w.coefficient_bits); parts > 1;
       parts = ceil_div(parts, 2)) {
    stages.push_back(stage("parts of a product", {{Operation::adder, scaled}}));
  }
  stages.push_back(stage("alignment", {{Operation::shifter, scaled}}));
  round_and_clamp(stages, scaled);
  stages.push_back(stage("update of r", {{Operation::adder, kProductBits + 1}}));
  stages.push_back(stage("saturation", {{Operation::saturation, kProductBits + 1}}));
  if (w.preconditioned()) {
    multiply(stages, "preconditioner z = P^-1 r", a, multiplier, magnitude, kProductBits,
             kProductBits);
    if (w.method == fixed::Method::block_jacobi_pcg) {
      for (int i = 0; i < 2; ++i) {
        stages.push_back(stage("row of P^-1", {{Operation::adder, 2 * kProductBits}}));
      }
    }
    stages.push_back(stage("alignment of z", {{Operation::shifter, 2 * kProductBits}}));
    round_and_clamp(stages, 2 * kProductBits);
  }
  multiply(stages, w.preconditioned() ? "inner product r'z" : "inner product r'r", a, multiplier,
           magnitude, residual, residual);
  return stages;
}

void each_rank(const VectorStages& stages, int ranks, PathBuilder& path,
               const std::function<void(const Path&)>& take) {
  std::vector<std::size_t> ends;
  double limit = 0;
  double next = 0;
  fill(stages, limit, path, ends, next);
  while (ends.size() > static_cast<std::size_t>(ranks)) {
    limit = next;
    fill(stages, limit, path, ends, next);
  }
  std::size_t first = 0;
  for (const std::size_t end : ends) {
    take(rank(stages, first, end, path));
    first = end;
  }
}

}  // namespace hvp::accel
