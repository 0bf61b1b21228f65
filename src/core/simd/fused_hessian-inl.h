// Part of vector_kernels.cpp, once for each instruction set: no include guard. Responses of the smallest
// filters, those of octave 0, with 32 registers of 16 lanes: column differences stay in registers, and what
// is needed of them at some offset is put together from two neighbouring vectors. Nothing is read but whole
// lines of the integral image, each once; to store the differences and read them again, at offsets that no
// alignment suits, takes twice as long.

/// The newest vectors of column differences, oldest first.
template <int kVectors>
struct Window {
  U32 vectors[kVectors];

  HWY_INLINE void push(U32 next) {
    for (int i = 0; i + 1 < kVectors; ++i) {
      vectors[i] = vectors[i + 1];
    }
    vectors[kVectors - 1] = next;
  }

  /// Sixteen of them, from this column on.
  template <int kOffset>
  HWY_INLINE U32 at() const {
    constexpr int kVector = kOffset / 16;
    if constexpr (kOffset % 16 == 0) {
      return vectors[kVector];
    } else {
      return U32{_mm512_alignr_epi32(vectors[kVector + 1].raw, vectors[kVector].raw, kOffset % 16)};
    }
  }
};

/// Vectors that reach to this column and 15 beyond.
constexpr int reaching(int column) { return (column + 15) / 16 + 1; }

/// One row of responses at pixels half, half + 1, ...: then every offset into the columns is known, and the
/// response at pixel half + i reads columns from i on.
template <int kLobe>
class FusedRow {
 public:
  HWY_INLINE FusedRow(const FilterRows& rows, float threshold)
      : rows_(rows),
        norm_(hn::Set(kFloat, responseNorm(BoxFilter{kLobe}))),
        weight_(hn::Set(kFloat, kMixedWeight)),
        least_(hn::Set(kFloat, threshold)) {}

  HWY_INLINE void begin() {
    for (int i = 0; i + 1 < kXx; ++i) {
      xx_.push(differenceXx(rows_, 16 * i));
    }
    for (int i = 0; i + 1 < kYy; ++i) {
      yy_.push(differenceYy(rows_, 16 * i));
    }
  }

  /// Dxx Dyy of the next sixteen pixels, from the i-th on.
  HWY_INLINE Float nextBound(int i) {
    xx_.push(differenceXx(rows_, i + 16 * (kXx - 1)));
    yy_.push(differenceYy(rows_, i + 16 * (kYy - 1)));
    const U32 sum_xx = hn::Sub(hn::Sub(xx_.template at<3 * kLobe>(), xx_.template at<0>()),
                               timesThree(hn::Sub(xx_.template at<2 * kLobe>(), xx_.template at<kLobe>())));
    const U32 sum_yy = hn::Sub(yy_.template at<(5 * kLobe - 1) / 2>(), yy_.template at<(kLobe + 1) / 2>());
    return hn::Mul(scaled(sum_xx, norm_), scaled(sum_yy, norm_));
  }

  HWY_INLINE bool mayReach(Float bound) const { return !hn::AllFalse(kFloat, hn::Ge(bound, least_)); }

  HWY_INLINE Float response(Float bound, int i) const {
    const int x = kHalf + i;
    const U32 sum_xy = hn::Sub(hn::Sub(differenceXy(rows_, x), differenceXy(rows_, x - kLobe)),
                               hn::Sub(differenceXy(rows_, x + kLobe + 1), differenceXy(rows_, x + 1)));
    return combined(bound, scaled(sum_xy, norm_));
  }

  HWY_INLINE Float combined(Float bound, Float dxy) const {
    return hn::Sub(bound, hn::Mul(hn::Mul(weight_, dxy), dxy));
  }

 private:
  static constexpr int kHalf = (3 * kLobe - 1) / 2;
  static constexpr int kXx = reaching(3 * kLobe);
  static constexpr int kYy = reaching((5 * kLobe - 1) / 2);

  const FilterRows& rows_;
  Float norm_;
  Float weight_;
  Float least_;
  Window<kXx> xx_;
  Window<kYy> yy_;
};

template <int kLobe>
int fusedRowAbove(const FilterRows& rows, int count, float threshold, float* HWY_RESTRICT responses) {
  const Float below = hn::Set(kFloat, kBelowThreshold);
  FusedRow<kLobe> row(rows, threshold);
  row.begin();
  int total = 0;
  int i = 0;
  for (; i + 16 <= count; i += 16) {
    const Float bound = row.nextBound(i);
    if (!row.mayReach(bound)) {
      hn::StoreU(below, kFloat, responses + i);
      continue;
    }
    hn::StoreU(row.response(bound, i), kFloat, responses + i);
    total += 16;
  }
  if (i == count) {
    return total;
  }
  const Float bound = row.nextBound(i);
  const bool computed = row.mayReach(bound);
  hn::BlendedStore(computed ? row.response(bound, i) : below,
                   hn::FirstN(kFloat, static_cast<std::size_t>(count - i)), kFloat, responses + i);
  return computed ? total + count - i : total;
}
