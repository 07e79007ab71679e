#include "models/files/csv.h"

#include <gmock/gmock.h>

namespace hvp::files::csv_test {
namespace {

using ::testing::ElementsAre;

TEST(CsvCells, ALineHasOneMoreThanCommas) {
  EXPECT_THAT(csv_cells("frame,latency_us"), ElementsAre("frame", "latency_us"));
  EXPECT_THAT(csv_cells("one"), ElementsAre("one"));
  EXPECT_THAT(csv_cells(""), ElementsAre(""));
  EXPECT_THAT(csv_cells(",1,,"), ElementsAre("", "1", "", ""));
}

TEST(CsvCells, HaveNoBlanksAround) {
  EXPECT_THAT(csv_cells(" a ,\t1.5 ,\r"), ElementsAre("a", "1.5", ""));
  EXPECT_THAT(csv_cells(" a\t b\t\r", '\t'), ElementsAre("a", "b", ""));
  EXPECT_THAT(csv_cells("1,5;2", ';'), ElementsAre("1,5", "2"));
}

TEST(CsvCells, InQuotesMayHaveTheDelimiter) {
  EXPECT_THAT(csv_cells("\"a,b\",c"), ElementsAre("a,b", "c"));
  EXPECT_THAT(csv_cells("1, \" a \" ,\"\""), ElementsAre("1", "a", ""));
  EXPECT_THAT(csv_cells("\"a\"\",\",b"), ElementsAre("a\"\",", "b"));
}

TEST(CsvCells, WithAQuoteThatIsNotClosedEndAtTheDelimiter) {
  EXPECT_THAT(csv_cells("\"a,b"), ElementsAre("\"a", "b"));
  EXPECT_THAT(csv_cells("\"a\"b,c"), ElementsAre("\"a\"b", "c"));
  EXPECT_THAT(csv_cells("a\",\""), ElementsAre("a\"", "\""));
}

TEST(CsvDelimiter, IsWhatTheHeaderHasOutsideQuotes) {
  EXPECT_EQ(csv_delimiter("a,b"), ',');
  EXPECT_EQ(csv_delimiter("a"), ',');
  EXPECT_EQ(csv_delimiter("a;b, c"), ';');
  EXPECT_EQ(csv_delimiter("a\tb;c"), '\t');
  EXPECT_EQ(csv_delimiter("\"a;b\",c"), ',');
}

}  // namespace
}  // namespace hvp::files::csv_test
