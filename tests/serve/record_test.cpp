// A client over the socket, recorded and replayed.
#include "app/record/record.h"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

#include <gtest/gtest.h>

#include "driver/user/hvp_client.h"
#include "tests/serve/served_program.h"

namespace hvp::serve::record_test {
namespace {

using nlohmann::json;
using test::ServedProgram;

constexpr std::array<std::int32_t, 2> kRowBegin = {0, 1};
constexpr std::array<std::int32_t, 1> kColumn = {0};
constexpr std::array<std::int32_t, 9> kValue = {64, 0, 0, 0, 32, 0, 0, 0, 16};

void load_one_node(struct hvp_client* client) {
  hvp_solver_config config{};
  config.method = HVP_METHOD_JACOBI_PCG;
  config.iterations = 4;
  config.matrix_bits = 12;
  config.vector_bits = 16;
  config.coefficient_bits = 16;
  config.dynamic_scaling = true;
  ASSERT_EQ(hvp_client_configure(client, &config), HVP_OK);
  const hvp_matrix k = {1, 1, kRowBegin.data(), kColumn.data(), kValue.data()};
  ASSERT_EQ(hvp_client_load_matrix(client, &k), HVP_OK);
}

void solve_jobs(const std::filesystem::path& socket, int jobs) {
  struct hvp_client* client = nullptr;
  ASSERT_EQ(hvp_client_open(&client, ("vfio-user:" + socket.string()).c_str()), HVP_OK);
  load_one_node(client);
  const std::array<std::int32_t, 3> b = {640, 640, 640};
  for (int job = 0; job < jobs; ++job) {
    std::array<std::int32_t, 3> u{};
    ASSERT_EQ(hvp_client_solve(client, b.data(), u.data(), u.size(), 60'000'000'000), HVP_OK);
    EXPECT_EQ(u, (std::array<std::int32_t, 3>{10, 20, 40}));
  }
  EXPECT_EQ(hvp_client_close(client), HVP_OK);
}

json replay(const std::filesystem::path& folder, const std::string& file) {
  const cli::Ended ended = cli::hvp(folder, {"replay", file, "--times", "--json"});
  EXPECT_EQ(ended.status, 0) << ended.out << ended.err;
  return json::parse(ended.out, nullptr, false);
}

// The words after "hvp serve"; transfers of the board's own in two jobs: list, b, U and record.
struct Way {
  std::vector<std::string> words;
  int transfers;

  friend void PrintTo(const Way& way, std::ostream* out) {
    *out << (way.words.empty() ? "bursts" : cli::slug(way.words.back()));
  }
};

class ServedRecord : public testing::TestWithParam<Way> {};

TEST_P(ServedRecord, ReplaysToThePicosecond) {
  std::vector<std::string> words = {"--record", "a.bin", "--once"};
  words.insert(words.end(), GetParam().words.begin(), GetParam().words.end());
  ServedProgram served(words);
  solve_jobs(served.socket(), 2);
  EXPECT_EQ(served.program().wait().status, 0);
  EXPECT_FALSE(std::filesystem::exists(served.folder() / "a.bin.part"));
  const json figures = replay(served.folder(), "a.bin");
  EXPECT_EQ(figures["host"], "a client of hvp serve");
  EXPECT_EQ(figures["cut"], "");
  EXPECT_EQ(figures["compared"]["transfers"]["compared"], GetParam().transfers);
  EXPECT_GT(figures["compared"]["interrupts"]["compared"], 1);
}

INSTANTIATE_TEST_SUITE_P(Ways, ServedRecord,
                         testing::Values(Way{{}, 0}, Way{{"--set", "transfer.method=dma"}, 8},
                                         Way{{"--set", "transfer.method=dma", "--set",
                                              "transfer.notification=msi"},
                                             8}));

TEST(ServedStop, EndsAtTheFirstPointAsLinuxDoes) {
  ServedProgram served({"--stop-at", "job 1", "--stop-at", "message 9"});
  struct hvp_client* client = nullptr;
  ASSERT_EQ(hvp_client_open(&client, ("vfio-user:" + served.socket().string()).c_str()), HVP_OK);
  load_one_node(client);
  const std::array<std::int32_t, 3> b = {640, 640, 640};
  std::array<std::int32_t, 3> u{};
  EXPECT_EQ(hvp_client_solve(client, b.data(), u.data(), u.size(), 60'000'000'000), HVP_OK);
  EXPECT_NE(hvp_client_solve(client, b.data(), u.data(), u.size(), 60'000'000'000), HVP_OK);
  hvp_client_close(client);
  const cli::Ended ended = served.program().wait();
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_NE(ended.out.find("\nstopped: job 1 begins at "), std::string::npos) << ended.out;
  EXPECT_NE(ended.out.find(" us, in job 1\n"), std::string::npos) << ended.out;
  EXPECT_NE(ended.err.find("--stop-at message 9: it never came"), std::string::npos) << ended.err;
}

TEST(ServedStop, AWrongWordIsNamed) {
  const hvp::ScratchDirectory place;
  cli::write(place.path() / "s.toml", cli::kSmallScene);
  const cli::Ended ended =
      cli::hvp(place.path(), {"serve", "s.toml", "--vfio-user", "b", "--stop-at", "jub 1"});
  EXPECT_EQ(ended.status, 2);
  EXPECT_NE(ended.err.find("--stop-at \"jub 1\": expected \"write to REGISTER\""),
            std::string::npos)
      << ended.err;
}

TEST(ServedTrace, OfNoAccessIsEmpty) {
  ServedProgram served({"--trace-registers", "--once", "--out", "o"});
  served.expect_service();
  const cli::Ended ended = served.program().wait();
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_EQ(cli::lines(cli::read(served.folder() / "o/registers.log")).size(), 1U);
  EXPECT_TRUE(std::filesystem::exists(served.folder() / "o/registers.vcd"));
  EXPECT_EQ(ended.err.find("Warning"), std::string::npos) << ended.err;
}

TEST(KilledServer, HasRecordedWhatItsClientSaw) {
  ServedProgram served({"--record", "a.bin"});
  solve_jobs(served.socket(), 1);
  served.program().kill();
  served.program().wait();
  const record::Record recorded = record::read_record(served.folder() / "a.bin.part");
  EXPECT_NE(recorded.cut(), "");
  const json figures = replay(served.folder(), "a.bin.part");
  EXPECT_NE(figures["cut"], "");
  const auto ends =
      std::ranges::count(recorded.entries(), record::Kind::ended, &record::Entry::kind);
  EXPECT_EQ(figures["compared"]["accesses"]["compared"], ends);
  EXPECT_GT(ends, 20);
}

}  // namespace
}  // namespace hvp::serve::record_test
