#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "models/config/input_error.h"
#include "models/files/csv.h"

namespace hvp::files::csv_table_test {
namespace {

using ::testing::ElementsAre;

using Rows = std::vector<std::vector<std::string>>;

Rows rows_of(const std::string& text) {
  std::istringstream in(text);
  CsvTable table(in, "t.csv");
  Rows rows;
  while (table.next()) {
    rows.emplace_back();
    for (std::size_t i = 0; i < table.columns().size(); ++i) {
      rows.back().emplace_back(table.text(i));
    }
  }
  return rows;
}

std::string refusal(const std::string& text) {
  try {
    rows_of(text);
  } catch (const InputError& error) {
    return error.what();
  }
  return "taken";
}

const Rows kRows = {{"1", "2.5"}, {"3", ""}};

TEST(CsvTable, IsReadRowByRow) {
  EXPECT_EQ(rows_of("a,b\n1,2.5\n3,\n"), kRows);
  EXPECT_EQ(rows_of("a,b\n1,2.5\n3,"), kRows);
}

TEST(CsvTable, IsTheSameFromEveryProgram) {
  EXPECT_EQ(rows_of("\xEF\xBB\xBF"
                    "a,b\r\n1,2.5\r\n3,\r\n"),
            kRows);
  EXPECT_EQ(rows_of("a;b\n1;2.5\n3;\n"), kRows);
  EXPECT_EQ(rows_of("a\tb\n1\t2.5\n3\t\n"), kRows);
  EXPECT_EQ(rows_of("# made by a rig\na,b\n\n1,2.5\n# a pause\n  \n3,\n\n"), kRows);
  EXPECT_EQ(rows_of(" a , b ,\n 1 , 2.5 ,\n3,,\n"), kRows);
  EXPECT_EQ(rows_of("\"a\",\"b\"\n\"1\",\"2.5\"\n3,\"\"\n"), kRows);
}

TEST(CsvTable, HasATitleAboveTheHeader) {
  std::istringstream in("# the title\n# more\na,\"b \"\"c\"\"\"\n");
  const CsvTable table(in, "t.csv");
  EXPECT_EQ(table.title(), "the title");
  EXPECT_EQ(table.header_line(), 3U);
  EXPECT_THAT(table.columns(), ElementsAre("a", "b \"c\""));
  EXPECT_EQ(table.column("a"), 0U);
  EXPECT_FALSE(table.find("b"));
}

TEST(CsvTable, GivesNumbers) {
  std::istringstream in("n,x\n3,\n");
  CsvTable table(in, "t.csv");
  ASSERT_TRUE(table.next());
  EXPECT_EQ(table.number<long>(0), 3);
  EXPECT_TRUE(std::isnan(table.number_or_nan(1)));
  EXPECT_FALSE(table.next());
}

TEST(CsvTable, RefusesWithTheLine) {
  EXPECT_EQ(refusal("a,b\n1,2\n\n1\n"), "t.csv:4: 1 fields, the header has 2");
  EXPECT_EQ(refusal("a,b\n1,2,3\n"), "t.csv:2: 3 fields, the header has 2");
  EXPECT_EQ(refusal("a,b\n1,2,,\n"), "t.csv:2: 4 fields, the header has 2");
  EXPECT_EQ(refusal("\xFF\xFEt"), "t.csv: is UTF-16: expected UTF-8 or ASCII");
  EXPECT_EQ(refusal("a\n" + std::string(LineReader::kLongestLine + 70000, '1')),
            "t.csv:2: a line of more than 1048576 bytes: expected rows of a table");
}

TEST(CsvTable, ShowsWhatWouldDisturbATerminal) {
  std::istringstream in("n\x1b\n3\x07\n");
  CsvTable table(in, "t.csv");
  ASSERT_TRUE(table.next());
  try {
    table.number<double>(0);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "t.csv:2: n\\u001b is '3\\u0007', expected a number");
  }
}

TEST(LineReader, GivesLinesOfAnyLengthAcrossItsBuffer) {
  std::string text;
  std::vector<std::size_t> lengths;
  for (std::size_t length = 0; length < 200000; length = 3 * length + 1) {
    lengths.push_back(length);
    text += std::string(length, 'x') + '\n';
  }
  std::istringstream in(text);
  LineReader reader(in);
  for (const std::size_t length : lengths) {
    ASSERT_TRUE(reader.next());
    EXPECT_EQ(reader.line(), std::string(length, 'x'));
  }
  EXPECT_EQ(reader.number(), lengths.size());
  EXPECT_FALSE(reader.next());
  EXPECT_FALSE(reader.next());
}

}  // namespace
}  // namespace hvp::files::csv_table_test
