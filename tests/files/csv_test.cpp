#include "models/files/csv.h"

#include <gmock/gmock.h>

namespace hvp::files {
namespace {

using ::testing::ElementsAre;

TEST(CsvCells, ALineHasOneMoreThanCommas) {
  EXPECT_THAT(csv_cells("frame,latency_us"), ElementsAre("frame", "latency_us"));
  EXPECT_THAT(csv_cells("one"), ElementsAre("one"));
  EXPECT_THAT(csv_cells(""), ElementsAre(""));
  EXPECT_THAT(csv_cells(",1,,"), ElementsAre("", "1", "", ""));
}

TEST(CsvCells, StopsWhereNoMoreAreWanted) {
  EXPECT_THAT(csv_cells("a,b,c", 2), ElementsAre("a", "b"));
  EXPECT_THAT(csv_cells("a,b,c", 7), ElementsAre("a", "b", "c"));
}

TEST(CsvCells, LeavesSpacesAndQuotesToTheReader) {
  EXPECT_THAT(csv_cells(" a ,\"b\"\r"), ElementsAre(" a ", "\"b\"\r"));
}

}  // namespace
}  // namespace hvp::files
