#include "perennial/core/drivers/cameleon_status_parser.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <vector>

namespace perennial {
namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes bytesOf(const CameleonStatus& status) {
  const CameleonStatusBytes frame = encode(status);
  return Bytes(frame.begin(), frame.end());
}

Bytes operator+(Bytes left, const Bytes& right) {
  left.insert(left.end(), right.begin(), right.end());
  return left;
}

std::vector<CameleonStatus> parse(CameleonStatusParser& parser, const Bytes& bytes) {
  std::vector<CameleonStatus> found;
  for (const std::uint8_t byte : bytes) {
    if (const auto status = parser.push(byte)) {
      found.push_back(*status);
    }
  }
  return found;
}

/// Any odometer readings, and values that a robot may have for the rest.
CameleonStatus randomStatus(std::mt19937& random) {
  std::uniform_int_distribution<std::int32_t> any(std::numeric_limits<std::int32_t>::min());
  std::uniform_int_distribution<std::int32_t> near_zero(-5000, 5000);
  std::uniform_int_distribution<std::int32_t> angle(-90, 90);
  std::uniform_int_distribution<std::int32_t> percent(0, 100);
  const bool new_robot = random() % 2 == 0;
  return {random() % 8 != 0,
          new_robot ? near_zero(random) : any(random),
          new_robot ? near_zero(random) : any(random),
          angle(random),
          angle(random),
          angle(random),
          percent(random)};
}

const CameleonStatus kStatus{true, 1000, -1000, 1, 2, 3, 90};
const CameleonStatus kNext{true, 1020, -980, 1, 2, 3, 90};

TEST(CameleonStatusParser, readsFrames) {
  CameleonStatusParser parser;
  EXPECT_EQ(parse(parser, bytesOf(kStatus) + bytesOf(kNext)), (std::vector<CameleonStatus>{kStatus, kNext}));
  EXPECT_EQ(parser.counters().frames, 2u);
  EXPECT_EQ(parser.counters().bad_frames, 0u);
  EXPECT_EQ(parser.counters().stray_bytes, 0u);
}

TEST(CameleonStatusParser, findsTheHeaderAfterItsOwnFirstBytes) {
  for (const Bytes& stray :
       std::vector<Bytes>{{0xF0}, {0xF0, 0xF0}, {0xF0, 0xAF}, {0xF0, 0xAF, 0xF0}, {0xAF, 0xFA}}) {
    CameleonStatusParser parser;
    EXPECT_EQ(parse(parser, stray + bytesOf(kStatus)), std::vector<CameleonStatus>{kStatus});
    EXPECT_EQ(parser.counters().stray_bytes, stray.size());
  }
}

TEST(CameleonStatusParser, dropsAndCountsBadFrames) {
  for (const auto& [index, value] : std::vector<std::pair<std::size_t, std::uint8_t>>{
           {3, 6}, {4, 1}, {7, 2}, {16, 0x40}, {20, 0x80}, {24, 0x7F}, {30, 1}, {31, 0xF0}}) {
    Bytes bad = bytesOf(kStatus);
    bad[index] = value;
    CameleonStatusParser parser;
    EXPECT_EQ(parse(parser, bad + bytesOf(kNext)), std::vector<CameleonStatus>{kNext}) << "byte " << index;
    EXPECT_EQ(parser.counters().bad_frames, 1u);
    EXPECT_EQ(parser.counters().stray_bytes, kCameleonStatusSize);
  }
}

TEST(CameleonStatusParser, findsTheFrameAfterOneThatLostItsEnd) {
  std::mt19937 random(1);
  for (int round = 0; round < 200; ++round) {
    const CameleonStatus first = randomStatus(random);
    const CameleonStatus second = randomStatus(random);
    for (std::size_t kept = 1; kept < kCameleonStatusSize; ++kept) {
      Bytes half = bytesOf(first);
      half.resize(kept);
      CameleonStatusParser parser;
      ASSERT_EQ(parse(parser, half + bytesOf(second)), std::vector<CameleonStatus>{second})
          << "round " << round << ", " << kept << " bytes kept";
    }
  }
}

TEST(CameleonStatusParser, findsTheNextFrameAfterAnyNoise) {
  std::mt19937 random(2);
  const Bytes alphabet = {0xF0, 0xAF, 0xFA, 0x07, 0x00, 0x01};
  for (int round = 0; round < 20000; ++round) {
    Bytes noise(random() % 80);
    for (std::uint8_t& byte : noise) {
      // Half of the noise is made of the bytes that frames begin with: the worst kind.
      byte = round % 2 == 0 ? static_cast<std::uint8_t>(random()) : alphabet[random() % alphabet.size()];
    }
    const CameleonStatus status = randomStatus(random);
    CameleonStatusParser parser;
    const std::vector<CameleonStatus> found = parse(parser, noise + bytesOf(status));
    ASSERT_FALSE(found.empty()) << "round " << round;
    ASSERT_EQ(found.back(), status) << "round " << round;
    ASSERT_EQ(parser.counters().stray_bytes + kCameleonStatusSize * parser.counters().frames,
              noise.size() + kCameleonStatusSize);
  }
}

TEST(CameleonStatusParser, losesOnlyTheFramesThatLostBytes) {
  // Every way of splitting a stream in three parts and losing the middle one.
  std::mt19937 random(3);
  const std::size_t frames = 4;
  Bytes stream;
  std::vector<CameleonStatus> sent;
  for (std::size_t i = 0; i < frames; ++i) {
    sent.push_back(randomStatus(random));
    stream = stream + bytesOf(sent.back());
  }
  for (std::size_t first = 0; first <= stream.size(); ++first) {
    for (std::size_t second = first; second <= stream.size(); ++second) {
      const auto at = [&](std::size_t index) { return stream.begin() + static_cast<std::ptrdiff_t>(index); };
      std::vector<CameleonStatus> expected;
      for (std::size_t i = 0; i < frames; ++i) {
        if (first == second || (i + 1) * kCameleonStatusSize <= first || i * kCameleonStatusSize >= second) {
          expected.push_back(sent[i]);
        }
      }
      CameleonStatusParser parser;
      const std::vector<CameleonStatus> found =
          parse(parser, Bytes(stream.begin(), at(first)) + Bytes(at(second), stream.end()));
      // The halves on both sides may fit together to a frame that was never sent, which nothing in the
      // protocol tells from a good one; but it must not cost an untouched one.
      std::size_t next = 0;
      for (const CameleonStatus& status : found) {
        next += next < expected.size() && status == expected[next] ? 1 : 0;
      }
      ASSERT_EQ(next, expected.size()) << "lost " << first << " to " << second;
      ASSERT_LE(found.size(), expected.size() + 1) << "lost " << first << " to " << second;
    }
  }
}

TEST(CameleonStatusParser, forgetsABegunFrameWhenReset) {
  Bytes half = bytesOf(kStatus);
  half.resize(20);
  CameleonStatusParser parser;
  parse(parser, half);
  parser.reset();
  EXPECT_EQ(parser.counters().stray_bytes, 20u);
  EXPECT_EQ(parse(parser, bytesOf(kNext)), std::vector<CameleonStatus>{kNext});
}

}  // namespace
}  // namespace perennial
