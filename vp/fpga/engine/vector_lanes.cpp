#include "vp/fpga/engine/vector_lanes.h"

#include <algorithm>
#include <span>

#include "models/fixed/reference_preconditioner.h"
#include "models/index.h"

namespace hvp::vp::engine {

namespace {

void track(std::uint64_t& largest, std::int64_t value) {
  largest = std::max(largest, fixed::magnitude(value));
}

// Two words' product fits into 64 bits; only the sum does not.
std::int64_t product(std::int32_t a, std::int32_t b) { return std::int64_t{a} * b; }

// The bits of an aligner's word, as engine.sv has them (engine_types.sv, direction_bits).
int aligned_bits(const fixed::Settings& s) {
  constexpr int kBeyond = 2;
  if (!s.preconditioned()) return s.vector_bits + kBeyond;
  const int scale = fixed::ReferencePreconditioner::scale_bits(s);
  const int longest = std::min(scale + 1, fixed::Settings::kProductBits - 1);
  return fixed::Settings::kProductBits + std::max(0, s.product_shift() + longest - scale) + kBeyond;
}

}  // namespace

void VectorLanes::load(int nodes) {
  for (auto* memory : {&memories_.x, &memories_.previous, &memories_.b, &memories_.r, &memories_.z,
                       &memories_.q}) {
    memory->assign(3 * at(nodes), 0);
  }
  memories_.inverse.assign(9 * at(nodes), 0);
  before_.reserve(3 * at(nodes));
}

void VectorLanes::configure(const fixed::Settings& settings, int inverse_shift) {
  settings_ = settings;
  inverse_shift_ = inverse_shift;
  if (cuts_terms_) term_limit_ = (std::int64_t{1} << aligned_bits(settings)) - 1;
}

void VectorLanes::begin(const VectorCommand& command) {
  now_ = command;
  status_ = {};
  status_.number = command.number;
  const auto shifter = [this](int exponent) {
    return WordShifter(exponent, settings_.shift_rounding);
  };
  x_shift_ = shifter(now_.x_shift);
  r_shift_ = shifter(now_.r_shift);
  change_shift_ = shifter(now_.change_shift);
  z_shift_ = shifter(now_.z_shift);
  d_shift_ = shifter(now_.d_shift);
  product_shift_ = shifter(-settings_.product_shift());
  preconditioner_shift_ = shifter(-inverse_shift_);
}

LaneWords VectorLanes::words(int first_node, const std::int32_t* direction) {
  const std::size_t first = 3 * at(first_node);
  VectorMemories& m = memories_;
  const std::int32_t mantissa = now_.pass == Pass::direction ? now_.beta : now_.alpha;
  return {&m.x[first],           &m.b[first],        &m.r[first], &m.z[first],
          &m.q[first],           &m.previous[first], direction,   direction,
          &m.inverse[3 * first], &m.z[first],        mantissa,    mantissa};
}

void VectorLanes::write(int first_node, int nodes, const LaneWords& from, std::int32_t* written) {
  const std::size_t first = 3 * at(first_node);
  const std::size_t count = 3 * at(nodes);
  switch (now_.pass) {
    case Pass::guess:
      write_guess(first, count, from, written);
      break;
    case Pass::residual:
      write_residual(first, count, from, written);
      break;
    case Pass::update:
      write_update(first, count, from, written);
      break;
    case Pass::first_direction:
    case Pass::direction:
      write_direction(count, from, written);
      break;
    case Pass::none:
    case Pass::copy:
    case Pass::product:
      break;
  }
}

// The guess of fixed::extrapolate. The memory of the solution before has x by now.
void VectorLanes::write_guess(std::size_t first, std::size_t count, const LaneWords& from,
                              std::int32_t* written) {
  const std::span<std::int32_t> x = std::span(memories_.x).subspan(first, count);
  std::copy_n(from.x, count, x.begin());
  before_.assign(now_.alone ? from.x : from.previous,
                 (now_.alone ? from.x : from.previous) + count);
  report_.saturations += fixed::extrapolate(x, before_, settings_.vector_bits);
  std::ranges::copy(x, written);
}

void VectorLanes::write_residual(std::size_t first, std::size_t count, const LaneWords& from,
                                 std::int32_t* written) {
  fixed::ReferenceMachine& counted = now_.first ? machine_ : silent_;
  const int bits = settings_.residual_bits();
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t word = first + i;
    const std::int32_t b = counted.write(from.b[i], bits);
    const std::int64_t full = (std::int64_t{b} << settings_.rhs_shift()) -
                              (std::int64_t{from.q[i]} << settings_.product_shift());
    memories_.r[word] = clamped(r_shift_(full), bits);
    if (now_.zero) memories_.x[word] = 0;
    if (now_.exchange) {
      written[i] = from.x[i];
      memories_.x[word] = from.kept_d[i];
    }
  }
  precondition(first, count, from);
}

// x += α·d, r −= α·q
void VectorLanes::write_update(std::size_t first, std::size_t count, const LaneWords& from,
                               std::int32_t* written) {
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t word = first + i;
    const std::int64_t change = x_shift_(product(from.of_d, from.d[i]));
    const std::int32_t x = clamped(from.x[i] + change, settings_.vector_bits);
    if (now_.exchange) {
      written[i] = x;
      memories_.x[word] = from.kept_d[i];
      continue;
    }
    memories_.x[word] = x;
    const std::int64_t kept = cut(r_shift_(from.r[i]));
    memories_.r[word] = clamped(kept - cut(change_shift_(product(from.of_q, from.q[i]))),
                                settings_.residual_bits());
  }
  if (!now_.exchange) precondition(first, count, from);
}

// z = P⁻¹·r, a node's three rows at once, and the sums of both.
void VectorLanes::precondition(std::size_t first, std::size_t count, const LaneWords& from) {
  fixed::Int128 squares = 0;
  for (std::size_t i = first; i < first + count; ++i) {
    const std::int32_t r = memories_.r[i];
    squares += product(r, r);
    track(status_.largest_r, r);
  }
  status_.squares += squares;
  if (!settings_.preconditioned()) {
    status_.dot = status_.squares;
    status_.largest_z = status_.largest_r;
    return;
  }
  for (std::size_t row = 0; row < count; ++row) {
    const std::int32_t* const inverse = &from.inverse[3 * row];
    const std::int32_t* const r = &memories_.r[first + row / 3 * 3];
    const std::int64_t sum =
        product(inverse[0], r[0]) + product(inverse[1], r[1]) + product(inverse[2], r[2]);
    // Beyond its word it is by a flipped bit of P⁻¹ only, which the lanes do not count.
    const std::int32_t z = silent_.write(preconditioner_shift_(sum), fixed::Settings::kProductBits);
    from.new_z[row] = z;
    status_.dot += product(z, memories_.r[first + row]);
    track(status_.largest_z, z);
  }
}

// d = z + β·d
void VectorLanes::write_direction(std::size_t count, const LaneWords& from, std::int32_t* written) {
  const std::int32_t* const z = settings_.preconditioned() ? from.z : from.r;
  for (std::size_t i = 0; i < count; ++i) {
    std::int64_t sum = cut(z_shift_(z[i]));
    if (now_.pass == Pass::direction) sum += cut(d_shift_(product(from.of_d, from.d[i])));
    written[i] = clamped(sum, settings_.vector_bits);
    track(status_.largest_d, written[i]);
  }
}

std::array<std::int32_t, 3> VectorLanes::round_product(int node,
                                                       const std::array<std::int64_t, 3>& sum,
                                                       const std::array<std::int32_t, 3>& own) {
  std::array<std::int32_t, 3> words{};
  for (std::size_t c = 0; c < 3; ++c) {
    const std::int32_t q =
        clamped(product_shift_(now_.zero ? 0 : sum[c]), fixed::Settings::kProductBits);
    words[c] = q;
    status_.dot += product(q, own[c]);
    track(status_.largest_q, q);
    if (!now_.compare) continue;
    // Beyond the system there are nodes by a flip of an index word only.
    const std::size_t word = 3 * at(node) + c;
    const std::int32_t b =
        silent_.write(word < memories_.b.size() ? memories_.b[word] : 0, settings_.residual_bits());
    status_.squares += product(b, b);
    track(status_.widest, (std::int64_t{b} << settings_.rhs_shift()) -
                              (std::int64_t{q} << settings_.product_shift()));
  }
  return words;
}

VectorLanes::RowPart VectorLanes::round_row(int node, const std::array<std::int64_t, 3>& sum,
                                            const std::array<std::int32_t, 3>& own,
                                            std::array<std::int32_t, 3>& q) {
  const RowPart others{status_.dot, status_.squares, status_.widest};
  status_.dot = 0;
  status_.squares = 0;
  status_.widest = 0;
  q = round_product(node, sum, own);
  const RowPart part{status_.dot, status_.squares, status_.widest};
  status_.dot = others.dot;
  status_.squares = others.squares;
  status_.widest = others.widest;
  return part;
}

}  // namespace hvp::vp::engine
