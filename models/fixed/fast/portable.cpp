// The kernel for every machine: one word at a time, left to the compiler.
#include "models/fixed/fast/lane_passes.h"

namespace hvp::fixed::fast {

namespace {

struct OneWord {
  using Word = std::int32_t;
  static constexpr std::size_t kWords = 1;

  struct Left {
    explicit Left(std::uint32_t places) : n(places) {}
    std::uint32_t n;
  };
  struct SignedShift {
    explicit SignedShift(const RightShift& s)
        : n(s.right),
          odd(static_cast<std::int32_t>(s.odd)),
          bias(static_cast<std::int32_t>(s.bias)),
          below_zero(static_cast<std::int32_t>(s.below_zero)) {}
    std::uint32_t n;
    std::int32_t odd, bias, below_zero;
  };
  struct SplitShift {
    explicit SplitShift(const RightShift& s) : n(s.right), bias(s.bias) {}
    std::uint32_t n;
    std::uint64_t bias;
  };
  struct LongShift {
    explicit LongShift(const RightShift& s) : n(s.right), odd(s.odd), bias(s.bias) {}
    std::uint32_t n;
    std::uint64_t odd, bias;
  };
  struct Wrap {
    explicit Wrap(int bits) : unused(32U - static_cast<unsigned>(bits)) {}
    unsigned unused;
  };

  static Word load(const std::int32_t* p) { return *p; }
  static void store(std::int32_t* p, Word w) { *p = w; }
  static Word all(std::int32_t w) { return w; }
  static Word size(Word w) { return with_sign(w, w); }
  static Word with_sign(Word size, Word sign) {
    const std::int32_t negative = sign >> 31;
    return static_cast<Word>(static_cast<std::uint32_t>(size ^ negative) -
                             static_cast<std::uint32_t>(negative));
  }
  static Word sign_of_product(Word a, Word b) { return a ^ b; }
  static Word sum(Word a, Word b) { return a + b; }
  static Word shifted(Word w, Left s) {
    return static_cast<Word>(static_cast<std::uint32_t>(w) << s.n);
  }
  template <bool kEven>
  static Word shifted(Word w, SignedShift s) {
    const std::int32_t own = kEven ? (w >> s.n) & s.odd : 0;
    return (w + s.bias + (w < 0 ? s.below_zero : 0) + own) >> s.n;
  }
  template <bool kEven>
  static Word narrow_product(Word a, Word b, SignedShift s) {
    return shifted<kEven>(a * b, s);
  }
  static Word split_product(Word a, Word b, SplitShift s) {
    const std::uint64_t u =
        std::uint64_t{static_cast<std::uint32_t>(a)} * static_cast<std::uint32_t>(b);
    return static_cast<Word>((u + s.bias) >> s.n);
  }
  template <bool kEven>
  static Word product(Word a, Word b, LongShift s) {
    const std::uint64_t u =
        std::uint64_t{static_cast<std::uint32_t>(a)} * static_cast<std::uint32_t>(b);
    return static_cast<Word>((u + s.bias + (kEven ? (u >> s.n) & s.odd : 0)) >> s.n);
  }
  static Word clamped(Word w, Word lowest, Word highest) {
    const Word raised = w < lowest ? lowest : w;
    return raised > highest ? highest : raised;
  }
  static Word wrapped(Word w, Wrap s) {
    return static_cast<Word>(static_cast<std::uint32_t>(w) << s.unused) >> s.unused;
  }
  static Word larger_size(Word a, Word b) {
    const auto x = static_cast<std::uint32_t>(a);
    const auto y = static_cast<std::uint32_t>(b);
    return static_cast<Word>(x > y ? x : y);
  }
  static std::uint64_t largest(Word w) { return static_cast<std::uint32_t>(w); }

  struct Counter {
    void add_different(Word a, Word b) { count += a != b ? 1 : 0; }
    std::int64_t sum() const { return count; }
    std::int64_t count = 0;
  };
  struct Accumulator {
    void add(Word a, Word b) { total += std::int64_t{a} * b; }
    Int128 sum() const { return total; }
    std::int64_t total = 0;
  };
};

void to_short(const std::int32_t* in, std::int16_t* out, std::size_t size) {
  for (std::size_t node = 0; node < size / 3; ++node) {
    for (std::size_t c = 0; c < 3; ++c) {
      out[kRowWords * node + c] = static_cast<std::int16_t>(in[3 * node + c]);
    }
  }
}

// Adds a block whose word of row r and column c is value[kRowStep · r + place[c]].
void add_block(const std::int16_t* value, const std::size_t (&place)[3], const std::int16_t* vector,
               std::int32_t* sum) {
  for (std::size_t r = 0; r < 3; ++r) {
    const std::int16_t* const row = value + kRowStep * r;
    sum[r] += row[place[0]] * vector[0] + row[place[1]] * vector[1] + row[place[2]] * vector[2];
  }
}

template <typename Index>
Found multiply_pairs(const PairedSlices& a, const Index* column, const std::int16_t* vector,
                     std::int32_t* out) {
  constexpr std::size_t kAlone[3] = {0, 1, 2};
  const std::int16_t* value = a.value;
  Found found;
  for (std::size_t slice = 0; slice < a.slices; ++slice) {
    std::int32_t sum[3 * kSliceNodes] = {};
    const auto add_step = [&](const std::size_t(&place)[3]) {
      for (std::size_t node = 0; node < kSliceNodes; ++node) {
        add_block(value + kRowWords * node, place, vector + kRowWords * *column++, sum + 3 * node);
      }
    };
    auto steps = static_cast<std::size_t>(a.slice_begin[slice + 1] - a.slice_begin[slice]);
    for (; steps >= kQuadSteps; steps -= kQuadSteps) {
      for (const auto& place : kQuadWord) add_step(place);
      value += kQuadWords;
    }
    for (; steps > 0; --steps) {
      add_step(kAlone);
      value += kPairedStep;
    }
    const std::int16_t* const own = vector + kRowStep * slice;
    std::int64_t dot = 0;
    for (std::size_t i = 0; i < 3 * kSliceNodes; ++i) {
      const auto size = static_cast<std::uint32_t>(OneWord::size(sum[i]));
      found.largest = size > found.largest ? size : found.largest;
      dot += std::int64_t{own[i + i / 3]} * sum[i];
      *out++ = sum[i];
    }
    found.dot += dot;
  }
  return found;
}

Found multiply_paired(const PairedSlices& a, const std::int16_t* vector, std::int32_t* out) {
  if (a.short_node != nullptr) return multiply_pairs(a, a.short_node, vector, out);
  return multiply_pairs(a, a.long_node, vector, out);
}

void multiply_wide(const WideSlices& a, const std::int32_t* vector, std::int64_t* out) {
  const std::int32_t* value = a.value;
  const std::uint32_t* first = a.first;
  for (std::size_t slice = 0; slice < a.slices; ++slice) {
    std::int64_t sum[3 * kSliceNodes] = {};
    for (int step = a.slice_begin[slice]; step < a.slice_begin[slice + 1]; ++step) {
      for (std::size_t node = 0; node < kSliceNodes; ++node) {
        const std::int32_t* const v = vector + *first++;
        for (std::size_t e = 0; e < 9; ++e) {
          sum[3 * node + e / 3] += std::int64_t{value[kSliceNodes * e + node]} * v[e % 3];
        }
      }
      value += kWideStep;
    }
    for (const std::int64_t one : sum) *out++ = one;
  }
}

}  // namespace

const Passes& portable_passes() {
  using P = LanePasses<OneWord>;
  static constexpr Passes kPasses = {.lanes = OneWord::kWords,
                                     .combine = P::combine,
                                     .combine_both = P::combine_both,
                                     .multiply_entries = P::multiply_entries,
                                     .inner_product = P::inner_product,
                                     .to_short = to_short,
                                     .multiply_paired = multiply_paired,
                                     .multiply_wide = multiply_wide};
  return kPasses;
}

}  // namespace hvp::fixed::fast
