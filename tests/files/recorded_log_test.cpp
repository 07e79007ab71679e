// Records of tissue under an indenter, where their folder is given; log_table_test.cpp has the same
// header on data of its own.
#include <cstdlib>
#include <filesystem>

#include <gmock/gmock.h>

#include "models/files/log_table.h"

namespace hvp::files::recorded_log_test {
namespace {

TEST(RecordedLog, IsReadWithoutAWarning) {
  const char* const data = std::getenv("HVP_DATA");
  if (data == nullptr) GTEST_SKIP() << "HVP_DATA names no folder of measurements";
  int records = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator(std::filesystem::path(data) / "tissue-indentation")) {
    if (entry.path().extension() != ".csv") continue;
    ++records;
    const Log log = read_log(entry.path(), {.quantities = {"force", "travel"}});
    EXPECT_THAT(log.warnings, testing::IsEmpty());
    EXPECT_THAT(log.left_aside, testing::ElementsAre("gap_mm"));
    EXPECT_TRUE(log.spacing.even);
    EXPECT_NEAR(log.spacing.period, 0.1, 1e-6);
    EXPECT_EQ(log.spacing.stretches.size(), 1U);
    EXPECT_GT(log.column("travel", "m").values.back(), 1e-3);
  }
  EXPECT_GE(records, 6);
}

}  // namespace
}  // namespace hvp::files::recorded_log_test
