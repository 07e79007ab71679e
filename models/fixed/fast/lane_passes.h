#pragma once

#include <cstddef>
#include <cstdint>

#include "models/fixed/fast/passes.h"

namespace hvp::fixed::fast {

// The passes over vectors, written once for every set of vector instructions: `Lanes` (lanes_*.h)
// has the words and the operations. Every name here depends on Lanes, so that nothing compiled
// with more instructions than the baseline can stand in for something else.
template <typename Lanes>
struct LanePasses {
  using Word = typename Lanes::Word;

  static Found combine(const Terms& t) {
    if (t.wraps) return t.nearest_even ? combine<true, true>(t) : combine<true, false>(t);
    return t.nearest_even ? combine<false, true>(t) : combine<false, false>(t);
  }

  static Found multiply_entries(const Products& p) {
    const typename Lanes::LongShift shift(p.shift);
    typename Lanes::Accumulator dot;
    Word largest = Lanes::all(0);
    for (std::size_t i = 0; i < p.size; i += Lanes::kWords) {
      const Word in = Lanes::load(p.in + i);
      const Word size =
          Lanes::template product<true>(Lanes::size(in), Lanes::load(p.factor + i), shift);
      const Word out = Lanes::with_sign(size, in);
      Lanes::store(p.out + i, out);
      largest = Lanes::larger_size(largest, size);
      dot.add(in, out);
    }
    return {.largest = Lanes::largest(largest), .overflows = 0, .dot = dot.sum()};
  }

  static Found inner_product(const std::int32_t* a, const std::int32_t* b, std::size_t size) {
    typename Lanes::Accumulator dot;
    Word largest = Lanes::all(0);
    for (std::size_t i = 0; i < size; i += Lanes::kWords) {
      const Word second = Lanes::load(b + i);
      dot.add(Lanes::load(a + i), second);
      largest = Lanes::larger_size(largest, Lanes::size(second));
    }
    return {.largest = Lanes::largest(largest), .overflows = 0, .dot = dot.sum()};
  }

  static void to_short(const std::int32_t* in, std::int16_t* out, std::size_t size) {
    for (std::size_t i = 0; i < size; i += Lanes::kWords) {
      Lanes::store_short(out + i, Lanes::load(in + i));
    }
  }

 private:
  template <bool kWraps, bool kEven>
  static Found combine(const Terms& t) {
    if (t.a_right.right != 0) {
      return t.short_product ? combine<kWraps, kEven, true, true>(t)
                             : combine<kWraps, kEven, true, false>(t);
    }
    return t.short_product ? combine<kWraps, kEven, false, true>(t)
                           : combine<kWraps, kEven, false, false>(t);
  }

  template <bool kWraps, bool kEven, bool kRight, bool kShort>
  static Found combine(const Terms& t) {
    const typename Lanes::Left left(t.a_left);
    const typename Lanes::ShortShift a_shift(t.a_right);
    const typename Lanes::ShortShift b_short(t.b_right);
    const typename Lanes::LongShift b_long(t.b_right);
    const typename Lanes::Wrap wrap(t.bits);
    const auto limit = static_cast<std::int32_t>((std::uint32_t{1} << (t.bits - 1)) - 1);
    const Word highest = Lanes::all(limit);
    const Word lowest = Lanes::all(-limit);
    const Word factor = Lanes::all(t.factor);
    const Word factor_size = Lanes::size(factor);
    typename Lanes::Counter overflows;
    typename Lanes::Accumulator squares;
    Word largest = Lanes::all(0);
    for (std::size_t i = 0; i < t.size; i += Lanes::kWords) {
      Word a = Lanes::load(t.a + i);
      if constexpr (kRight) {
        a = Lanes::with_sign(Lanes::template shifted<kEven>(Lanes::size(a), a_shift), a);
      } else {
        a = Lanes::shifted(a, left);
      }
      const Word b = Lanes::load(t.b + i);
      Word change;
      if constexpr (kShort) {
        const Word product = Lanes::short_product(b, factor);
        change = Lanes::with_sign(Lanes::template shifted<kEven>(Lanes::size(product), b_short),
                                  product);
      } else {
        change =
            Lanes::with_sign(Lanes::template product<kEven>(Lanes::size(b), factor_size, b_long),
                             Lanes::sign_of_product(b, factor));
      }
      const Word sum = Lanes::sum(a, change);
      Word out = Lanes::clamped(sum, lowest, highest);
      overflows.add_different(sum, out);
      if constexpr (kWraps) out = Lanes::wrapped(sum, wrap);
      Lanes::store(t.out + i, out);
      largest = Lanes::larger_size(largest, Lanes::size(out));
      if (t.square) squares.add(out, out);
    }
    return {.largest = Lanes::largest(largest),
            .overflows = overflows.sum(),
            .dot = t.square ? squares.sum() : 0};
  }
};

}  // namespace hvp::fixed::fast
