// The kernel for AVX2: eight words at once.
#include <immintrin.h>

#include "models/fixed/fast/lane_passes.h"

namespace hvp::fixed::fast {

namespace {

struct Avx2 {
  using Word = __m256i;
  static constexpr std::size_t kWords = 8;

  struct Left {
    explicit Left(std::uint32_t places) : n(_mm256_set1_epi32(static_cast<int>(places))) {}
    Word n;
  };
  struct SignedShift {
    explicit SignedShift(const RightShift& s)
        : n(_mm256_set1_epi32(static_cast<int>(s.right))),
          odd(_mm256_set1_epi32(static_cast<int>(s.odd))),
          bias(_mm256_set1_epi32(static_cast<int>(s.bias))),
          below_zero(_mm256_set1_epi32(static_cast<int>(s.below_zero))) {}
    Word n, odd, bias, below_zero;
  };
  // The shift that is left once the lowest 16 bits are dropped.
  struct SplitShift {
    explicit SplitShift(const RightShift& s)
        : n(_mm256_set1_epi32(static_cast<int>(s.right) - 16)),
          bias(_mm256_set1_epi32(static_cast<int>(s.bias >> 16))) {}
    Word n, bias;
  };
  struct LongShift {
    explicit LongShift(const RightShift& s)
        : n(_mm256_set1_epi64x(s.right)),
          odd(_mm256_set1_epi64x(s.odd)),
          bias(_mm256_set1_epi64x(static_cast<long long>(s.bias))) {}
    Word n, odd, bias;
  };
  struct Wrap {
    explicit Wrap(int bits) : unused(_mm256_set1_epi32(32 - bits)) {}
    Word unused;
  };

  static Word load(const std::int32_t* p) {
    return _mm256_load_si256(reinterpret_cast<const Word*>(p));
  }
  static void store(std::int32_t* p, Word w) { _mm256_store_si256(reinterpret_cast<Word*>(p), w); }
  static Word all(std::int32_t w) { return _mm256_set1_epi32(w); }
  static Word size(Word w) { return _mm256_abs_epi32(w); }
  // If the sign is zero, so is the size.
  static Word with_sign(Word size, Word sign) {
    const Word negative = _mm256_srai_epi32(sign, 31);
    return _mm256_sub_epi32(_mm256_xor_si256(size, negative), negative);
  }
  static Word sign_of_product(Word a, Word b) { return _mm256_xor_si256(a, b); }
  static Word sum(Word a, Word b) { return _mm256_add_epi32(a, b); }
  static Word shifted(Word w, const Left& s) { return _mm256_sllv_epi32(w, s.n); }
  template <bool kEven>
  static Word shifted(Word w, const SignedShift& s) {
    const Word below = _mm256_and_si256(_mm256_srai_epi32(w, 31), s.below_zero);
    Word up = _mm256_add_epi32(_mm256_add_epi32(w, s.bias), below);
    if constexpr (kEven) {
      up = _mm256_add_epi32(up, _mm256_and_si256(_mm256_srlv_epi32(w, s.n), s.odd));
    }
    return _mm256_srav_epi32(up, s.n);
  }
  // The low halves meet; the high half of b is no number, so it meets zero.
  template <bool kEven>
  static Word narrow_product(Word a, Word b, const SignedShift& s) {
    const Word low = _mm256_and_si256(b, _mm256_set1_epi32(0xFFFF));
    return shifted<kEven>(_mm256_madd_epi16(a, low), s);
  }
  // (high · b · 2^16 + low · b + bias) >> n, where the bias has no bits below 2^16.
  static Word split_product(Word a, Word b, const SplitShift& s) {
    const Word low = _mm256_mulhi_epu16(a, b);
    const Word high = _mm256_madd_epi16(a, _mm256_slli_epi32(b, 16));
    return _mm256_srlv_epi32(_mm256_add_epi32(_mm256_add_epi32(high, s.bias), low), s.n);
  }
  template <bool kEven>
  static Word product(Word a, Word b, const LongShift& s) {
    const Word even = shifted<kEven>(_mm256_mul_epu32(a, b), s);
    const Word odd =
        shifted<kEven>(_mm256_mul_epu32(_mm256_srli_epi64(a, 32), _mm256_srli_epi64(b, 32)), s);
    return _mm256_or_si256(even, _mm256_slli_epi64(odd, 32));
  }
  template <bool kEven>
  static Word shifted(Word size, const LongShift& s) {
    Word up = _mm256_add_epi64(size, s.bias);
    if constexpr (kEven) {
      up = _mm256_add_epi64(up, _mm256_and_si256(_mm256_srlv_epi64(size, s.n), s.odd));
    }
    return _mm256_srlv_epi64(up, s.n);
  }
  static Word clamped(Word w, Word lowest, Word highest) {
    return _mm256_min_epi32(_mm256_max_epi32(w, lowest), highest);
  }
  static Word wrapped(Word w, const Wrap& s) {
    return _mm256_srav_epi32(_mm256_sllv_epi32(w, s.unused), s.unused);
  }
  static Word larger_size(Word a, Word b) { return _mm256_max_epu32(a, b); }
  static std::uint64_t largest(Word w) {
    alignas(32) std::uint32_t part[kWords];
    _mm256_store_si256(reinterpret_cast<Word*>(part), w);
    std::uint64_t result = 0;
    for (const std::uint32_t one : part) result = one > result ? one : result;
    return result;
  }

  // Lanes of 64 bits each.
  static Int128 sum_of_lanes(Word w) {
    alignas(32) long long part[kWords / 2];
    _mm256_store_si256(reinterpret_cast<Word*>(part), w);
    Int128 total = 0;
    for (const long long one : part) total += one;
    return total;
  }

  struct Counter {
    void add_different(Word a, Word b) {
      same = _mm256_sub_epi32(same, _mm256_cmpeq_epi32(a, b));
      ++words;
    }
    std::int64_t sum() const {
      alignas(32) std::int32_t part[kWords];
      _mm256_store_si256(reinterpret_cast<Word*>(part), same);
      std::int64_t result = words * static_cast<std::int64_t>(kWords);
      for (const std::int32_t one : part) result -= one;
      return result;
    }
    Word same = _mm256_setzero_si256();
    std::int64_t words = 0;
  };
  struct Accumulator {
    void add(Word a, Word b) {
      even = _mm256_add_epi64(even, _mm256_mul_epi32(a, b));
      odd = _mm256_add_epi64(odd,
                             _mm256_mul_epi32(_mm256_srli_epi64(a, 32), _mm256_srli_epi64(b, 32)));
    }
    Int128 sum() const { return sum_of_lanes(even) + sum_of_lanes(odd); }
    Word even = _mm256_setzero_si256();
    Word odd = _mm256_setzero_si256();
  };
};

constexpr std::size_t kHalf = kSliceNodes / 2;

// Four nodes at once. Of two registers the packing takes turns in lanes of 128 bits.
void to_short(const std::int32_t* in, std::int16_t* out, std::size_t size) {
  const __m256i first_nodes = _mm256_set_epi32(0, 5, 4, 3, 0, 2, 1, 0);
  const __m256i last_nodes = _mm256_set_epi32(0, 7, 6, 5, 0, 4, 3, 2);
  for (std::size_t i = 0; i < size; i += 3 * kHalf) {
    const __m256i first = _mm256_permutevar8x32_epi32(
        _mm256_loadu_si256(reinterpret_cast<const __m256i*>(in + i)), first_nodes);
    const __m256i last = _mm256_permutevar8x32_epi32(
        _mm256_loadu_si256(reinterpret_cast<const __m256i*>(in + i + 4)), last_nodes);
    const __m256i words = _mm256_permute4x64_epi64(_mm256_packs_epi32(first, last), 0xD8);
    _mm256_store_si256(reinterpret_cast<__m256i*>(out), words);
    out += kHalf * kRowWords;
  }
}

// The three rows' sums of four nodes, two words a row.
struct Rows {
  __m256i row0 = _mm256_setzero_si256();
  __m256i row1 = _mm256_setzero_si256();
  __m256i row2 = _mm256_setzero_si256();

  void add(__m256i v, const std::int16_t* value) {
    row0 = _mm256_add_epi32(row0, _mm256_madd_epi16(v, load(value)));
    row1 = _mm256_add_epi32(row1, _mm256_madd_epi16(v, load(value + kRowStep)));
    row2 = _mm256_add_epi32(row2, _mm256_madd_epi16(v, load(value + 2 * kRowStep)));
  }
  static __m256i load(const std::int16_t* p) {
    return _mm256_load_si256(reinterpret_cast<const __m256i*>(p));
  }
};

// Every two sums of a row to one, in the even words.
__m256i row_sums(__m256i row) { return _mm256_add_epi32(row, _mm256_srli_epi64(row, 32)); }

// The three rows of four nodes next to each other. Returns what is larger, words of `largest` or
// magnitudes of these.
__m256i store_rows(__m256i row0, __m256i row1, __m256i row2, std::int32_t* out, __m256i largest) {
  const __m256i two = _mm256_blend_epi32(row0, _mm256_slli_epi64(row1, 32), 0xAA);
  const __m256i first = _mm256_blend_epi32(
      _mm256_permutevar8x32_epi32(two, _mm256_set_epi32(5, 4, 0, 3, 2, 0, 1, 0)),
      _mm256_permutevar8x32_epi32(row2, _mm256_set_epi32(0, 0, 2, 0, 0, 0, 0, 0)), 0x24);
  const __m256i last = _mm256_blend_epi32(
      _mm256_permutevar8x32_epi32(two, _mm256_set_epi32(0, 0, 0, 0, 0, 7, 6, 0)),
      _mm256_permutevar8x32_epi32(row2, _mm256_set_epi32(4, 4, 4, 4, 6, 0, 0, 4)), 0xF9);
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(out), first);
  _mm_storeu_si128(reinterpret_cast<__m128i*>(out + 8), _mm256_castsi256_si128(last));
  largest = _mm256_max_epu32(largest, _mm256_abs_epi32(first));
  return _mm256_max_epu32(largest, _mm256_abs_epi32(last));
}

// (x, y, z) of four nodes times what stands in their even words.
__m256i inner_products(__m256i nodes, __m256i row0, __m256i row1, __m256i row2) {
  const __m256i x_z = _mm256_srai_epi32(_mm256_slli_epi32(nodes, 16), 16);
  const __m256i y = _mm256_srai_epi32(nodes, 16);
  const __m256i z = _mm256_srli_epi64(x_z, 32);
  return _mm256_add_epi64(_mm256_add_epi64(_mm256_mul_epi32(x_z, row0), _mm256_mul_epi32(y, row1)),
                          _mm256_mul_epi32(z, row2));
}

// The figures of a product so far.
struct Seen {
  __m256i largest = _mm256_setzero_si256();
  __m256i dot = _mm256_setzero_si256();
};

__m128i two_nodes(const std::int16_t* first, const std::int16_t* second) {
  return _mm_castpd_si128(
      _mm_loadh_pd(_mm_castsi128_pd(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(first))),
                   reinterpret_cast<const double*>(second)));
}

// The words of the vector that four blocks are multiplied by. One load for each node: on many
// processors that is faster than the instruction that gathers four.
template <typename Index>
__m256i gather(const std::int16_t* vector, const Index* column) {
  const FourNodes<Avx2> node(column);
  return _mm256_inserti128_si256(
      _mm256_castsi128_si256(
          two_nodes(vector + kRowWords * node.place[0], vector + kRowWords * node.place[1])),
      two_nodes(vector + kRowWords * node.place[2], vector + kRowWords * node.place[3]), 1);
}

// (x, y, z) of one step and the z of the next.
__m256i with_next_z(__m256i one, __m256i next) {
  return _mm256_blend_epi16(one, _mm256_slli_epi64(next, 16), 0x88);
}

// Four nodes of a slice; `own` is what their diagonal blocks meet. What the other four need is in
// the first cache then.
template <typename Index>
void multiply_half(std::size_t steps, const std::int16_t* value, const Index* column,
                   const std::int16_t* own, const std::int16_t* vector, std::int32_t* out,
                   Seen& seen) {
  Rows rows;
  const __m256i nodes = Rows::load(own);
  __m256i v0 = nodes;
  while (steps >= kQuadSteps) {
    const __m256i v1 = gather(vector, column + kSliceNodes);
    const __m256i v2 = gather(vector, column + 2 * kSliceNodes);
    const __m256i v3 = gather(vector, column + 3 * kSliceNodes);
    rows.add(with_next_z(v0, v1), value);
    rows.add(with_next_z(v2, v3), value + kPairedStep);
    rows.add(_mm256_blend_epi32(v1, _mm256_slli_epi64(v3, 32), 0xAA), value + 2 * kPairedStep);
    column += kQuadSteps * kSliceNodes;
    value += kQuadWords;
    steps -= kQuadSteps;
    if (steps > 0) v0 = gather(vector, column);
  }
  while (steps > 0) {
    rows.add(v0, value);
    column += kSliceNodes;
    value += kPairedStep;
    --steps;
    if (steps > 0) v0 = gather(vector, column);
  }
  const __m256i row0 = row_sums(rows.row0);
  const __m256i row1 = row_sums(rows.row1);
  const __m256i row2 = row_sums(rows.row2);
  seen.dot = _mm256_add_epi64(seen.dot, inner_products(nodes, row0, row1, row2));
  seen.largest = store_rows(row0, row1, row2, out, seen.largest);
}

template <typename Index>
Found multiply_pairs(const PairedSlices& a, const Index* column, const std::int16_t* vector,
                     std::int32_t* out) {
  const std::int16_t* value = a.value;
  Seen seen;
  for (std::size_t slice = 0; slice < a.slices; ++slice) {
    const auto steps = static_cast<std::size_t>(a.slice_begin[slice + 1] - a.slice_begin[slice]);
    const std::int16_t* const own = vector + kRowStep * slice;
    multiply_half(steps, value, column, own, vector, out, seen);
    multiply_half(steps, value + kHalf * kRowWords, column + kHalf, own + kHalf * kRowWords, vector,
                  out + 3 * kHalf, seen);
    column += kSliceNodes * steps;
    value += kQuadWords * (steps / kQuadSteps) + kPairedStep * (steps % kQuadSteps);
    out += 3 * kSliceNodes;
  }
  return {
      .largest = Avx2::largest(seen.largest), .overflows = 0, .dot = Avx2::sum_of_lanes(seen.dot)};
}

Found multiply_paired(const PairedSlices& a, const std::int16_t* vector, std::int32_t* out) {
  if (a.short_node != nullptr) return multiply_pairs(a, a.short_node, vector, out);
  return multiply_pairs(a, a.long_node, vector, out);
}

void multiply_wide(const WideSlices& a, const std::int32_t* vector, std::int64_t* out) {
  const std::int32_t* value = a.value;
  const std::uint32_t* first = a.first;
  for (std::size_t slice = 0; slice < a.slices; ++slice) {
    __m256i sum[6];  // [row][half of the nodes]
    for (__m256i& s : sum) s = _mm256_setzero_si256();
    for (int step = a.slice_begin[slice]; step < a.slice_begin[slice + 1]; ++step) {
      for (std::size_t i = 0; i < 6; ++i) {
        const std::size_t c = i / 2;
        const std::size_t half = i % 2;
        const __m256i v = _mm256_cvtepi32_epi64(_mm_i32gather_epi32(
            vector + c, _mm_load_si128(reinterpret_cast<const __m128i*>(first + kHalf * half)),
            sizeof(std::int32_t)));
        for (std::size_t r = 0; r < 3; ++r) {
          const __m256i w = _mm256_cvtepi32_epi64(_mm_load_si128(
              reinterpret_cast<const __m128i*>(value + kSliceNodes * (3 * r + c) + kHalf * half)));
          sum[2 * r + half] = _mm256_add_epi64(sum[2 * r + half], _mm256_mul_epi32(v, w));
        }
      }
      first += kSliceNodes;
      value += kWideStep;
    }
    alignas(32) long long row[3][kSliceNodes];
    for (std::size_t i = 0; i < 6; ++i) {
      _mm256_store_si256(reinterpret_cast<__m256i*>(row[i / 2] + kHalf * (i % 2)), sum[i]);
    }
    for (std::size_t i = 0; i < 3 * kSliceNodes; ++i) *out++ = row[i % 3][i / 3];
  }
}

}  // namespace

const Passes& avx2_passes() {
  using P = LanePasses<Avx2>;
  static constexpr Passes kPasses = {.lanes = kHalf,
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
