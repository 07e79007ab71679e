#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

#include "models/fixed/fast/passes.h"

namespace hvp::fixed::fast {

// The nodes in four columns of the paired layout. Short numbers are read by one load, because loads
// limit a product's speed.
template <typename Lanes>
struct FourNodes {
  explicit FourNodes(const std::uint16_t* column) {
    std::uint64_t all = 0;
    std::memcpy(&all, column, sizeof(all));
    for (std::size_t i = 0; i < 4; ++i) place[i] = all >> 16 * i & 0xFFFF;
  }
  explicit FourNodes(const std::uint32_t* column) {
    for (std::size_t i = 0; i < 4; ++i) place[i] = column[i];
  }
  std::size_t place[4] = {};
};

// The passes over vectors, written once for every set of vector instructions. `Lanes` has the words
// and the operations: OneWord in portable.cpp, Avx2 in avx2.cpp and Avx512 in avx512.cpp.
// Every name here depends on Lanes, so that the linker cannot take a function that was compiled
// with more instructions than the baseline for another kernel's.
template <typename Lanes>
struct LanePasses {
  using Word = typename Lanes::Word;

  static Found combine(const Terms& t) {
    if (t.fits)
      return t.nearest_even ? combine<Cut::never, true>(t) : combine<Cut::never, false>(t);
    if (t.wraps) return t.nearest_even ? combine<Cut::wrap, true>(t) : combine<Cut::wrap, false>(t);
    return t.nearest_even ? combine<Cut::clamp, true>(t) : combine<Cut::clamp, false>(t);
  }

  static FoundBoth combine_both(const Terms& first, const Terms& second) {
    if (second.nearest_even) return combine_both<true>(first, second);
    return combine_both<false>(first, second);
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

 private:
  enum class Cut { never, clamp, wrap };
  enum class Move { none, left, right };
  // The width in which factor · b is formed: 32 bits, 32 bits after the upper half of b, or 64
  // bits.
  enum class Width { narrow, split, wide };

  template <bool kEven>
  static FoundBoth combine_both(const Terms& first, const Terms& second) {
    if (second.a_right.right != 0) return combine_both<kEven, Move::right>(first, second);
    if (second.a_left != 0) return combine_both<kEven, Move::left>(first, second);
    return combine_both<kEven, Move::none>(first, second);
  }

  template <bool kEven, Move kMove>
  static FoundBoth combine_both(const Terms& first, const Terms& second) {
    const typename Lanes::Left left(second.a_left);
    const typename Lanes::SignedShift a_shift(second.a_right);
    const typename Lanes::SignedShift first_shift(first.b_right);
    const typename Lanes::SignedShift second_shift(second.b_right);
    const Word first_factor = Lanes::all(first.factor);
    const Word second_factor = Lanes::all(second.factor);
    Word first_largest = Lanes::all(0);
    Word second_largest = Lanes::all(0);
    for (std::size_t i = 0; i < first.size; i += Lanes::kWords) {
      const Word b = Lanes::load(first.b + i);
      const Word one = Lanes::sum(Lanes::load(first.a + i), Lanes::template narrow_product<kEven>(
                                                                b, first_factor, first_shift));
      Word a = Lanes::load(second.a + i);
      if constexpr (kMove == Move::left) a = Lanes::shifted(a, left);
      if constexpr (kMove == Move::right) a = Lanes::template shifted<kEven>(a, a_shift);
      const Word other =
          Lanes::sum(a, Lanes::template narrow_product<kEven>(b, second_factor, second_shift));
      Lanes::store(first.out + i, one);
      Lanes::store(second.out + i, other);
      first_largest = Lanes::larger_size(first_largest, Lanes::size(one));
      second_largest = Lanes::larger_size(second_largest, Lanes::size(other));
    }
    return {.first = {.largest = Lanes::largest(first_largest)},
            .second = {.largest = Lanes::largest(second_largest)}};
  }

  template <Cut kCut, bool kEven>
  static Found combine(const Terms& t) {
    if (t.a_right.right != 0) return combine<kCut, kEven, Move::right>(t);
    if (t.a_left != 0) return combine<kCut, kEven, Move::left>(t);
    return combine<kCut, kEven, Move::none>(t);
  }

  template <Cut kCut, bool kEven, Move kMove>
  static Found combine(const Terms& t) {
    if (t.short_product) return combine<kCut, kEven, kMove, Width::narrow>(t);
    if constexpr (!kEven) {
      if (t.split_product) return combine<kCut, kEven, kMove, Width::split>(t);
    }
    return combine<kCut, kEven, kMove, Width::wide>(t);
  }

  template <Cut kCut, bool kEven, Move kMove, Width kWidth>
  static Found combine(const Terms& t) {
    const typename Lanes::Left left(t.a_left);
    const typename Lanes::SignedShift a_shift(t.a_right);
    const typename Lanes::SignedShift b_signed(t.b_right);
    const typename Lanes::SplitShift b_split(t.b_right);
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
      if constexpr (kMove == Move::left) a = Lanes::shifted(a, left);
      if constexpr (kMove == Move::right) a = Lanes::template shifted<kEven>(a, a_shift);
      const Word b = Lanes::load(t.b + i);
      Word change;
      if constexpr (kWidth == Width::narrow) {
        change = Lanes::template narrow_product<kEven>(b, factor, b_signed);
      } else if constexpr (kWidth == Width::split) {
        change = Lanes::with_sign(Lanes::split_product(Lanes::size(b), factor_size, b_split),
                                  Lanes::sign_of_product(b, factor));
      } else {
        change =
            Lanes::with_sign(Lanes::template product<kEven>(Lanes::size(b), factor_size, b_long),
                             Lanes::sign_of_product(b, factor));
      }
      const Word sum = Lanes::sum(a, change);
      Word out = sum;
      if constexpr (kCut != Cut::never) {
        out = Lanes::clamped(sum, lowest, highest);
        overflows.add_different(sum, out);
        if constexpr (kCut == Cut::wrap) out = Lanes::wrapped(sum, wrap);
      }
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
