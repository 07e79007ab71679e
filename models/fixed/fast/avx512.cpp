// The kernel for AVX-512 with VNNI: sixteen words at once, and two products of 16-bit words added
// to a 32-bit sum by one instruction.
#include <immintrin.h>

#include "models/fixed/fast/lane_passes.h"

namespace hvp::fixed::fast {

namespace {

struct Avx512 {
  using Word = __m512i;
  static constexpr std::size_t kWords = 16;
  static constexpr __mmask16 kOdd = 0xAAAA;

  struct Left {
    explicit Left(std::uint32_t places) : n(_mm512_set1_epi32(static_cast<int>(places))) {}
    Word n;
  };
  struct SignedShift {
    explicit SignedShift(const RightShift& s)
        : n(_mm512_set1_epi32(static_cast<int>(s.right))),
          odd(_mm512_set1_epi32(static_cast<int>(s.odd))),
          bias(_mm512_set1_epi32(static_cast<int>(s.bias))),
          below_zero(_mm512_set1_epi32(static_cast<int>(s.below_zero))) {}
    Word n, odd, bias, below_zero;
  };
  // The shift that is left once the lowest 16 bits are dropped.
  struct SplitShift {
    explicit SplitShift(const RightShift& s)
        : n(_mm512_set1_epi32(static_cast<int>(s.right) - 16)),
          bias(_mm512_set1_epi32(static_cast<int>(s.bias >> 16))) {}
    Word n, bias;
  };
  struct LongShift {
    explicit LongShift(const RightShift& s)
        : n(_mm512_set1_epi64(s.right)),
          odd(_mm512_set1_epi64(s.odd)),
          bias(_mm512_set1_epi64(static_cast<long long>(s.bias))) {}
    Word n, odd, bias;
  };
  struct Wrap {
    explicit Wrap(int bits) : unused(_mm512_set1_epi32(32 - bits)) {}
    Word unused;
  };

  static Word load(const std::int32_t* p) { return _mm512_load_si512(p); }
  static void store(std::int32_t* p, Word w) { _mm512_store_si512(p, w); }
  static Word all(std::int32_t w) { return _mm512_set1_epi32(w); }
  static Word size(Word w) { return _mm512_abs_epi32(w); }
  static Word with_sign(Word size, Word sign) {
    return _mm512_mask_sub_epi32(size, _mm512_movepi32_mask(sign), _mm512_setzero_si512(), size);
  }
  static Word sign_of_product(Word a, Word b) { return _mm512_xor_si512(a, b); }
  static Word sum(Word a, Word b) { return _mm512_add_epi32(a, b); }
  static Word shifted(Word w, const Left& s) { return _mm512_sllv_epi32(w, s.n); }
  // `up` is w with its bias.
  template <bool kEven>
  static Word shifted(Word w, Word up, __mmask16 negative, const SignedShift& s) {
    up = _mm512_mask_add_epi32(up, negative, up, s.below_zero);
    if constexpr (kEven) {
      up = _mm512_add_epi32(up, _mm512_and_si512(_mm512_srlv_epi32(w, s.n), s.odd));
    }
    return _mm512_srav_epi32(up, s.n);
  }
  template <bool kEven>
  static Word shifted(Word w, const SignedShift& s) {
    return shifted<kEven>(w, _mm512_add_epi32(w, s.bias), _mm512_movepi32_mask(w), s);
  }
  // The low halves meet; the high half of b is no number, so it meets zero. A product of zero may
  // take either sign's bias.
  template <bool kEven>
  static Word narrow_product(Word a, Word b, const SignedShift& s) {
    const Word low = _mm512_and_si512(b, _mm512_set1_epi32(0xFFFF));
    const __mmask16 negative = _mm512_movepi32_mask(_mm512_xor_si512(a, b));
    const Word product = kEven ? _mm512_madd_epi16(a, low) : Word{};
    return shifted<kEven>(product, _mm512_dpwssd_epi32(s.bias, a, low), negative, s);
  }
  // (high · b · 2^16 + low · b + bias) >> n, where the bias has no bits below 2^16.
  static Word split_product(Word a, Word b, const SplitShift& s) {
    const Word low = _mm512_mulhi_epu16(a, b);
    const Word high = _mm512_dpwssd_epi32(s.bias, a, _mm512_slli_epi32(b, 16));
    return _mm512_srlv_epi32(_mm512_add_epi32(high, low), s.n);
  }
  template <bool kEven>
  static Word product(Word a, Word b, const LongShift& s) {
    const Word even = shifted<kEven>(_mm512_mul_epu32(a, b), s);
    const Word odd =
        shifted<kEven>(_mm512_mul_epu32(_mm512_srli_epi64(a, 32), _mm512_srli_epi64(b, 32)), s);
    return _mm512_or_si512(even, _mm512_slli_epi64(odd, 32));
  }
  template <bool kEven>
  static Word shifted(Word size, const LongShift& s) {
    Word up = _mm512_add_epi64(size, s.bias);
    if constexpr (kEven) {
      up = _mm512_add_epi64(up, _mm512_and_si512(_mm512_srlv_epi64(size, s.n), s.odd));
    }
    return _mm512_srlv_epi64(up, s.n);
  }
  static Word clamped(Word w, Word lowest, Word highest) {
    return _mm512_min_epi32(_mm512_max_epi32(w, lowest), highest);
  }
  static Word wrapped(Word w, const Wrap& s) {
    return _mm512_srav_epi32(_mm512_sllv_epi32(w, s.unused), s.unused);
  }
  static Word larger_size(Word a, Word b) { return _mm512_max_epu32(a, b); }
  static std::uint64_t largest(Word w) { return _mm512_reduce_max_epu32(w); }

  // Lanes of 64 bits each; by halves, so that their sums fit as many.
  static Int128 sum_of_lanes(Word w) {
    const Word low = _mm512_and_si512(w, _mm512_set1_epi64(0xFFFFFFFF));
    return Int128{_mm512_reduce_add_epi64(_mm512_srai_epi64(w, 32))} * (Int128{1} << 32) +
           _mm512_reduce_add_epi64(low);
  }

  struct Counter {
    void add_different(Word a, Word b) {
      count = _mm512_mask_sub_epi32(count, _mm512_cmpneq_epi32_mask(a, b), count,
                                    _mm512_set1_epi32(-1));
    }
    std::int64_t sum() const { return _mm512_reduce_add_epi32(count); }
    Word count = _mm512_setzero_si512();
  };
  struct Accumulator {
    void add(Word a, Word b) {
      even = _mm512_add_epi64(even, _mm512_mul_epi32(a, b));
      odd = _mm512_add_epi64(odd,
                             _mm512_mul_epi32(_mm512_srli_epi64(a, 32), _mm512_srli_epi64(b, 32)));
    }
    Int128 sum() const { return sum_of_lanes(even) + sum_of_lanes(odd); }
    Word even = _mm512_setzero_si512();
    Word odd = _mm512_setzero_si512();
  };
};

// Every two sums of a row to one, in the even words.
__m512i row_sums(__m512i row) { return _mm512_add_epi32(row, _mm512_srli_epi64(row, 32)); }

// The three rows of eight nodes next to each other. Returns what is larger, words of `largest` or
// magnitudes of these.
__m512i store_rows(__m512i row0, __m512i row1, __m512i row2, std::int32_t* out, __m512i largest) {
  // Word 3·n + r of the result is word 2·n of row r; 16 stands for the second operand.
  const __m512i first_two = _mm512_set_epi32(10, 0, 24, 8, 0, 22, 6, 0, 20, 4, 0, 18, 2, 0, 16, 0);
  const __m512i first_third = _mm512_set_epi32(0, 8, 0, 0, 6, 0, 0, 4, 0, 0, 2, 0, 0, 0, 0, 0);
  const __m512i last_two = _mm512_set_epi32(0, 0, 0, 0, 0, 0, 0, 0, 0, 30, 14, 0, 28, 12, 0, 26);
  const __m512i last_third = _mm512_set_epi32(0, 0, 0, 0, 0, 0, 0, 0, 14, 0, 0, 12, 0, 0, 10, 0);
  const __m512i first = _mm512_mask_permutexvar_epi32(
      _mm512_permutex2var_epi32(row0, first_two, row1), 0x4924, first_third, row2);
  const __m512i last = _mm512_mask_permutexvar_epi32(
      _mm512_permutex2var_epi32(row0, last_two, row1), 0x92, last_third, row2);
  _mm512_storeu_si512(out, first);
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(out + 16), _mm512_castsi512_si256(last));
  constexpr __mmask16 kLastWords = 0xFF;
  largest = _mm512_max_epu32(largest, _mm512_abs_epi32(first));
  return _mm512_mask_max_epu32(largest, kLastWords, largest, _mm512_abs_epi32(last));
}

// (x, y, z) of eight nodes times what stands in their even words.
__m512i inner_products(__m512i nodes, __m512i row0, __m512i row1, __m512i row2) {
  const __m512i x_z = _mm512_srai_epi32(_mm512_slli_epi32(nodes, 16), 16);
  const __m512i y = _mm512_srai_epi32(nodes, 16);
  const __m512i z = _mm512_srli_epi64(x_z, 32);
  return _mm512_add_epi64(_mm512_add_epi64(_mm512_mul_epi32(x_z, row0), _mm512_mul_epi32(y, row1)),
                          _mm512_mul_epi32(z, row2));
}

// Eight nodes at once.
void to_short(const std::int32_t* in, std::int16_t* out, std::size_t size) {
  const __m512i spread = _mm512_set_epi16(0, 23, 22, 21, 0, 20, 19, 18, 0, 17, 16, 15, 0, 14, 13,
                                          12, 0, 11, 10, 9, 0, 8, 7, 6, 0, 5, 4, 3, 0, 2, 1, 0);
  for (std::size_t i = 0; i < size; i += 3 * kSliceNodes) {
    const __m256i first = _mm512_cvtepi32_epi16(_mm512_loadu_si512(in + i));
    const __m128i last = _mm256_cvtepi32_epi16(
        _mm256_loadu_si256(reinterpret_cast<const __m256i*>(in + i + Avx512::kWords)));
    const __m512i words = _mm512_inserti32x4(_mm512_castsi256_si512(first), last, 2);
    _mm512_store_si512(out, _mm512_permutexvar_epi16(spread, words));
    out += kRowStep;
  }
}

// The three rows' sums of eight nodes, two words a row.
struct Rows {
  __m512i row0 = _mm512_setzero_si512();
  __m512i row1 = _mm512_setzero_si512();
  __m512i row2 = _mm512_setzero_si512();

  void add(__m512i v, const std::int16_t* value) {
    row0 = _mm512_dpwssd_epi32(row0, v, _mm512_load_si512(value));
    row1 = _mm512_dpwssd_epi32(row1, v, _mm512_load_si512(value + kRowStep));
    row2 = _mm512_dpwssd_epi32(row2, v, _mm512_load_si512(value + 2 * kRowStep));
  }
};

// The words of one node, in the lanes of `lanes` of the others'.
__m256i with_node(__m256i others, __mmask8 lanes, const std::int16_t* node) {
  return _mm256_mask_broadcastq_epi64(others, lanes,
                                      _mm_loadl_epi64(reinterpret_cast<const __m128i*>(node)));
}

template <typename Index>
__m256i four_nodes(const std::int16_t* vector, const Index* column) {
  const FourNodes<Avx512> node(column);
  __m256i words = _mm256_castsi128_si256(
      _mm_loadl_epi64(reinterpret_cast<const __m128i*>(vector + kRowWords * node.place[0])));
  words = with_node(words, 2, vector + kRowWords * node.place[1]);
  words = with_node(words, 4, vector + kRowWords * node.place[2]);
  return with_node(words, 8, vector + kRowWords * node.place[3]);
}

// The words of the vector that eight blocks are multiplied by. One load for each node: the
// instruction that gathers eight takes 13 cycles on Zen 4, this 7.
template <typename Index>
__m512i gather(const std::int16_t* vector, const Index* column) {
  return _mm512_inserti64x4(_mm512_castsi256_si512(four_nodes(vector, column)),
                            four_nodes(vector, column + 4), 1);
}

// (x, y, z) of one step and the z of the next.
__m512i with_next_z(__m512i one, __m512i next) {
  return _mm512_mask_mov_epi16(one, 0x88888888, _mm512_slli_epi64(next, 16));
}

template <typename Index>
Found multiply_pairs(const PairedSlices& a, const Index* column, const std::int16_t* vector,
                     std::int32_t* out) {
  const std::int16_t* value = a.value;
  __m512i largest = _mm512_setzero_si512();
  __m512i dot = _mm512_setzero_si512();
  for (std::size_t slice = 0; slice < a.slices; ++slice) {
    Rows rows;
    auto steps = static_cast<std::size_t>(a.slice_begin[slice + 1] - a.slice_begin[slice]);
    const __m512i own = _mm512_load_si512(vector + kRowStep * slice);  // for the diagonal blocks
    __m512i v0 = own;
    while (steps >= kQuadSteps) {
      const __m512i v1 = gather(vector, column + kSliceNodes);
      const __m512i v2 = gather(vector, column + 2 * kSliceNodes);
      const __m512i v3 = gather(vector, column + 3 * kSliceNodes);
      rows.add(with_next_z(v0, v1), value);
      rows.add(with_next_z(v2, v3), value + kPairedStep);
      rows.add(_mm512_mask_mov_epi32(v1, Avx512::kOdd, _mm512_slli_epi64(v3, 32)),
               value + 2 * kPairedStep);
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
    const __m512i row0 = row_sums(rows.row0);
    const __m512i row1 = row_sums(rows.row1);
    const __m512i row2 = row_sums(rows.row2);
    dot = _mm512_add_epi64(dot, inner_products(own, row0, row1, row2));
    largest = store_rows(row0, row1, row2, out + 3 * kSliceNodes * slice, largest);
  }
  return {.largest = Avx512::largest(largest), .overflows = 0, .dot = Avx512::sum_of_lanes(dot)};
}

Found multiply_paired(const PairedSlices& a, const std::int16_t* vector, std::int32_t* out) {
  if (a.short_node != nullptr) return multiply_pairs(a, a.short_node, vector, out);
  return multiply_pairs(a, a.long_node, vector, out);
}

void multiply_wide(const WideSlices& a, const std::int32_t* vector, std::int64_t* out) {
  const std::int32_t* value = a.value;
  const std::uint32_t* first = a.first;
  for (std::size_t slice = 0; slice < a.slices; ++slice) {
    __m512i sum[3] = {_mm512_setzero_si512(), _mm512_setzero_si512(), _mm512_setzero_si512()};
    for (int step = a.slice_begin[slice]; step < a.slice_begin[slice + 1]; ++step) {
      const __m256i index = _mm256_load_si256(reinterpret_cast<const __m256i*>(first));
      for (std::size_t c = 0; c < 3; ++c) {
        const __m512i v =
            _mm512_cvtepi32_epi64(_mm256_i32gather_epi32(vector + c, index, sizeof(std::int32_t)));
        for (std::size_t r = 0; r < 3; ++r) {
          const __m512i w = _mm512_cvtepi32_epi64(_mm256_load_si256(
              reinterpret_cast<const __m256i*>(value + kSliceNodes * (3 * r + c))));
          sum[r] = _mm512_add_epi64(sum[r], _mm512_mul_epi32(v, w));
        }
      }
      first += kSliceNodes;
      value += kWideStep;
    }
    alignas(64) long long row[3][kSliceNodes];
    for (std::size_t r = 0; r < 3; ++r) _mm512_store_si512(row[r], sum[r]);
    for (std::size_t i = 0; i < 3 * kSliceNodes; ++i) *out++ = row[i % 3][i / 3];
  }
}

}  // namespace

const Passes& avx512_passes() {
  using P = LanePasses<Avx512>;
  static constexpr Passes kPasses = {.lanes = kSliceNodes,
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
