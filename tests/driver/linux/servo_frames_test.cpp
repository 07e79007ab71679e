#include "driver/linux/guest/servo_frames.h"

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "driver/linux/hvp_ioctl.h"

// What hvp-servo reads comes from outside: a file that is not what servo_frames.h describes is
// refused, whatever it is.
namespace {

using Words = std::vector<std::uint32_t>;

class ServoFrames : public testing::Test {
 protected:
  ServoFrames() {
    std::string name = (std::filesystem::temp_directory_path() / "servo-XXXXXX").string();
    const int descriptor = mkstemp(name.data());
    EXPECT_GE(descriptor, 0);
    close(descriptor);
    path_ = name;
  }
  ~ServoFrames() override {
    servo_close_frames(&frames_);
    std::filesystem::remove(path_);
  }

  void write(const Words& words, std::size_t bytes_more = 0) {
    std::ofstream file(path_, std::ios::binary | std::ios::trunc);
    for (const std::uint32_t word : words) {
      for (unsigned k = 0; k < 4; ++k) file.put(static_cast<char>(word >> 8 * k));
    }
    for (std::size_t k = 0; k < bytes_more; ++k) file.put(0);
  }
  bool open() {
    servo_close_frames(&frames_);
    return servo_open_frames(&frames_, path_.c_str());
  }
  bool opens(const Words& words) {
    write(words);
    return open();
  }

  std::filesystem::path path_;
  servo_frames frames_{};
};

// Two nodes, two diagonal blocks; a frame with a constraint and a row, and one with b alone.
Words good() {
  Words words = {SERVO_FRAMES_MAGIC, 1, 2, 2, 2, 2'000'000, 0, 0};
  const Words config = {1,  2,  60, 0x12345678, 0x3ff00000, 7,  11, HVP_IOC_C_DYNAMIC_SCALING,
                        1,  2,  3,  12,         16,         32, 64, 15,
                        24, 13, 1,  2};
  words.insert(words.end(), config.begin(), config.end());
  for (const std::uint32_t w : {0U, 1U, 2U, 0U, 1U}) words.push_back(w);
  for (std::uint32_t k = 0; k < 18; ++k) words.push_back(100 + k);
  for (const std::uint32_t w : {2U, 0U, 1U, 0xffffffffU, 1U, 0U, 1U}) words.push_back(w);
  for (std::uint32_t k = 0; k < 9; ++k) words.push_back(200 + k);
  for (std::uint32_t k = 0; k < 6; ++k) words.push_back(300 + k);
  words.push_back(0);
  for (std::uint32_t k = 0; k < 6; ++k) words.push_back(400 + k);
  return words;
}

TEST_F(ServoFrames, AreTakenAsTheyWereWritten) {
  ASSERT_TRUE(opens(good()));
  EXPECT_EQ(frames_.frames, 2U);
  EXPECT_EQ(frames_.period_ns, 2'000'000U);
  EXPECT_EQ(frames_.config.method, HVP_METHOD_JACOBI_PCG);
  EXPECT_EQ(frames_.config.stop_residual, 0x3ff0000012345678U);
  EXPECT_TRUE(frames_.config.dynamic_scaling);
  EXPECT_FALSE(frames_.config.one_a_word);
  EXPECT_EQ(frames_.config.coefficient_bits, 15U);
  EXPECT_EQ(frames_.config.shift_rounding, HVP_ROUND_TRUNCATION);
  EXPECT_EQ(frames_.matrix.row_begin[2], 2);
  EXPECT_EQ(frames_.matrix.column[1], 1);
  EXPECT_EQ(frames_.matrix.value[17], 117);

  ASSERT_EQ(servo_take_updates(&frames_), 2U);
  const servo_update constraint = servo_take_update(&frames_);
  EXPECT_EQ(constraint.kind, static_cast<std::uint32_t>(SERVO_CONSTRAIN));
  EXPECT_EQ(constraint.node, 1U);
  EXPECT_EQ(constraint.diagonal, -1);
  const servo_update row = servo_take_update(&frames_);
  EXPECT_EQ(row.kind, static_cast<std::uint32_t>(SERVO_RESTORE));
  ASSERT_EQ(row.blocks, 1U);
  EXPECT_EQ(row.values[8], 208);
  EXPECT_EQ(servo_take_rhs(&frames_)[5], 305);
  ASSERT_EQ(servo_take_updates(&frames_), 0U);
  EXPECT_EQ(servo_take_rhs(&frames_)[0], 400);
}

TEST_F(ServoFrames, ThatEndEarlyOrLateAreRefused) {
  const Words whole = good();
  for (std::size_t n = 0; n < whole.size(); ++n) {
    EXPECT_FALSE(opens(Words(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(n)))) << n;
  }
  Words more = whole;
  more.push_back(0);
  EXPECT_FALSE(opens(more));
  write(whole, 1);
  EXPECT_FALSE(open());
}

TEST_F(ServoFrames, OfAnotherKindAreRefused) {
  struct Change {
    std::size_t at;
    std::uint32_t value;
  };
  const std::size_t updates = 8 + 20 + 5 + 18;
  for (const Change change :
       {Change{0, 0x55505648}, Change{1, 2}, Change{2, 65536}, Change{3, 0x80000000},
        Change{4, 0xffffffff}, Change{5, 0}, Change{6, 1}, Change{updates, 0xffffffff},
        Change{updates + 1, 2}, Change{updates + 6, 0xffffffff}}) {
    Words words = good();
    words.at(change.at) = change.value;
    EXPECT_FALSE(opens(words)) << change.at;
  }
  servo_close_frames(&frames_);
  EXPECT_FALSE(servo_open_frames(&frames_, "/nonexistent"));
  EXPECT_FALSE(servo_open_frames(&frames_, "/"));
  EXPECT_FALSE(servo_open_frames(&frames_, "/dev/zero"));
}

// Whatever was changed, what is taken lies within the file: the sanitizers look.
TEST_F(ServoFrames, WithAnyWordChangedAreRefusedOrTaken) {
  std::mt19937 draw(7);
  int taken = 0;
  for (int k = 0; k < 300; ++k) {
    Words words = good();
    const std::size_t at = draw() % words.size();
    words.at(at) = static_cast<std::uint32_t>(draw() % 2 == 0 ? draw() : draw() % 8);
    if (!opens(words)) continue;
    ++taken;
    for (std::uint32_t f = 0; f < frames_.frames; ++f) {
      for (std::uint32_t left = servo_take_updates(&frames_); left > 0; --left) {
        const servo_update update = servo_take_update(&frames_);
        if (update.blocks > 0) {
          EXPECT_NE(update.values[9 * update.blocks - 1], 0x7fffffff);
        }
      }
      const std::int32_t* b = servo_take_rhs(&frames_);
      if (frames_.matrix.nodes > 0) {
        EXPECT_NE(b[3 * frames_.matrix.nodes - 1], 0x7fffffff);
      }
    }
    EXPECT_EQ(frames_.at, frames_.count);
  }
  EXPECT_GT(taken, 50);
}

TEST_F(ServoFrames, AreAnsweredInWordsOfTheFile) {
  ASSERT_TRUE(opens(good()));
  const servo_record record = {.due = 0x100000002,
                               .woken = 3,
                               .started = 4,
                               .ended = 5,
                               .read = 6,
                               .status = HVP_OK,
                               .flags = 8};
  const std::array<std::int32_t, 2> u = {-2, 9};
  FILE* file = std::fopen(path_.c_str(), "wb");
  ASSERT_NE(file, nullptr);
  EXPECT_TRUE(servo_write_head(file, &frames_));
  EXPECT_TRUE(servo_write_frame(file, &record, u.data(), u.size()));
  std::fclose(file);
  std::ifstream in(path_, std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  ASSERT_EQ(bytes.size(), 4U * (4 + 12 + 2));
  EXPECT_EQ(bytes.substr(0, 4), "HVPU");
  EXPECT_EQ(bytes.substr(16, 8), std::string("\x02\0\0\0\x01\0\0\0", 8));
  EXPECT_EQ(bytes.substr(4 * 16), std::string("\xfe\xff\xff\xff\x09\0\0\0", 8));
}

}  // namespace
