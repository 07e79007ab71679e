// A job by accesses of the program's, recorded and made again.
#include <algorithm>
#include <systemc>

#include <gmock/gmock.h>
#include <sys/stat.h>

#include "tests/app/record/recorded_program.h"

namespace hvp::record::replay_test {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::StartsWith;

class Replay : public test::RecordedProgram {
 protected:
  void record_a_job(const std::vector<const char*>& overrides = {}) {
    open(overrides);
    hvp_device device{};
    load(device);
    solve(device);
    close();
  }
  std::ptrdiff_t recorded_accesses() const {
    const Record record = recorded();
    return std::ranges::count(record.entries(), Kind::ended, &Entry::kind);
  }
};

TEST_F(Replay, OnTheSameBoardEqualsToThePicosecond) {
  record_a_job();
  const json figures = this->figures(0, {"--times"});
  EXPECT_EQ(figures["first"], json());
  EXPECT_EQ(figures["first_of_time"], json());
  for (const char* kind : {"accesses", "interrupts", "transfers"}) {
    const json& tally = figures["compared"][kind];
    EXPECT_EQ(tally["compared"], tally["recorded"]);
    EXPECT_EQ(tally["compared"], tally["replayed"]);
    EXPECT_EQ(tally["differ"], 0);
    EXPECT_EQ(tally["other_times"], 0);
  }
  EXPECT_EQ(figures["compared"]["accesses"]["recorded"], recorded_accesses());
  // The line goes up and down for the check of the matrix and for the job.
  EXPECT_EQ(figures["compared"]["interrupts"]["recorded"], 4);
  EXPECT_EQ(figures["compared"]["transfers"]["recorded"], 0);
}

// Asked for between two jobs, and at a stop: what it strikes and when is the same.
TEST_F(Replay, OfFaultsThatTheProgramAskedFor) {
  open();
  hvp_device device{};
  load(device);
  ASSERT_TRUE(hvp_board_inject(board, "kind=lost-interrupt", why.data(), why.size()));
  solve(device);
  const auto break_the_start = [](void* context, const hvp_board_stop* /*stop*/) {
    auto* const broken = static_cast<hvp_board*>(context);
    EXPECT_TRUE(hvp_board_inject(broken, "kind=master-abort,access=start", nullptr, 0));
  };
  ASSERT_TRUE(hvp_board_stop_at(board, "job 1", break_the_start, board, why.data(), why.size()));
  EXPECT_FALSE(hvp_board_inject(board, "kind=lost", why.data(), why.size()));
  solve(device, HVP_ERROR_BUS);
  close();
  EXPECT_EQ(std::ranges::count(recorded().entries(), Kind::fault, &Entry::kind), 2);
  const json figures = this->figures(0, {"--times"});
  EXPECT_EQ(figures["compared"]["accesses"]["compared"], recorded_accesses());
}

TEST_F(Replay, NamesAFaultThatTheBoardCannotHave) {
  open({"transfer.method=dma"});
  hvp_device device{};
  load(device);
  ASSERT_TRUE(hvp_board_inject(board, "kind=late-dma,delay=1 ms", why.data(), why.size()))
      << why.data();
  close();
  const cli::Ended refused = replay({"--set", "transfer.method=programmed-io"});
  EXPECT_EQ(refused.status, 2) << refused.out;
  EXPECT_THAT(refused.err, HasSubstr("a.bin: byte "));
  EXPECT_THAT(refused.err, HasSubstr(": the fault that was asked for: "));
  EXPECT_THAT(refused.err, HasSubstr("late-dma needs a DMA engine"));
}

TEST_F(Replay, OfARecordThatWasWrittenThroughALink) {
  std::filesystem::create_directory(place.path() / "there");
  std::filesystem::create_symlink("there/b.bin", place.path() / "a.bin");
  record_a_job();
  EXPECT_TRUE(std::filesystem::is_symlink(place.path() / "a.bin"));
  EXPECT_TRUE(std::filesystem::is_regular_file(place.path() / "there/b.bin"));
  figures(0, {"--times"});
}

TEST_F(Replay, NoRecordThroughALinkToItself) {
  std::filesystem::create_symlink("a.bin", place.path() / "a.bin");
  const std::string file = (place.path() / "a.bin").string();
  const hvp_board_options options = {nullptr, 0, nullptr, false, file.c_str()};
  EXPECT_EQ(hvp_board_open(cli::scenario("thesis.toml").c_str(), &options, why.data(), why.size()),
            nullptr);
  EXPECT_THAT(why.data(), HasSubstr("a.bin: is a link that leads nowhere ("));
}

TEST_F(Replay, WithPollingToo) {
  record_a_job({"transfer.notification=polling"});
  EXPECT_EQ(figures(0, {"--times"})["compared"]["interrupts"]["recorded"], 0);
}

TEST_F(Replay, OnASlowerBusHasTheSameWordsAtOtherTimes) {
  record_a_job({"bus.kind=pci-64/66"});
  const std::vector<std::string> slower = {"--set", "bus.kind=pci-32/33"};
  const json figures = this->figures(0, slower);
  EXPECT_EQ(figures["first"], json());
  EXPECT_GT(figures["compared"]["accesses"]["other_times"], 0);
  EXPECT_NE(figures["first_of_time"], json());
  EXPECT_EQ(replay({"--set", "bus.kind=pci-32/33", "--times"}).status, 1);
}

TEST_F(Replay, AWordThatAFaultAltersIsTheFirst) {
  record_a_job();
  const std::vector<std::string> faulty = {"--set", "fault[0].kind=master-abort",
                                           "--set", "fault[0].access=status",
                                           "--set", "fault[0].frame=0"};
  const json figures = this->figures(1, faulty);
  EXPECT_EQ(figures["first"]["what"], "access");
  EXPECT_EQ(figures["first"]["place"], "STATUS");
  EXPECT_EQ(figures["first"]["recorded"]["word"], "0x0000001a");
  EXPECT_EQ(figures["first"]["replayed"]["word"], "0xffffffff");
  EXPECT_EQ(figures["first"]["recorded"]["begin_us"], figures["first"]["replayed"]["begin_us"]);
  EXPECT_EQ(figures["compared"]["accesses"]["differ"], 1);
  const cli::Ended ended = replay(faulty);
  EXPECT_THAT(ended.out, HasSubstr(", STATUS\n  recorded  read STATUS: 0x0000001a, from "));
  EXPECT_THAT(ended.out, HasSubstr("\n  replayed  read STATUS: 0xffffffff, from "));
}

TEST_F(Replay, AnInterruptThatDoesNotComeIsTheFirst) {
  record_a_job();
  const json first =
      figures(1, {"--set", "fault[0].kind=lost-interrupt", "--set", "fault[0].frame=0"})["first"];
  EXPECT_EQ(first["what"], "interrupt");
  EXPECT_EQ(first["number"], 2);
  EXPECT_EQ(first["recorded"]["what"], "INTA# up");
  EXPECT_EQ(first["replayed"]["what"], "none");
}

// 100 MHz and 50 MHz, in kHz.
TEST_F(Replay, AnotherClockIsTheFirstWordThatDiffers) {
  record_a_job();
  const json figures = this->figures(1, {"--set", "accelerator.clock=50 MHz"});
  EXPECT_EQ(figures["first"]["what"], "access");
  EXPECT_EQ(figures["first"]["place"], "CAPABILITY_CLOCK");
  EXPECT_EQ(figures["first"]["recorded"]["word"], "0x000186a0");
  EXPECT_EQ(figures["first"]["replayed"]["word"], "0x0000c350");
  EXPECT_EQ(figures["compared"]["accesses"]["differ"], 1);
  EXPECT_EQ(figures["compared"]["interrupts"]["differ"], 0);
}

// What the solver finds is in the words of its memory.
TEST_F(Replay, AWordOfUThatDiffersIsNamed) {
  record_a_job();
  const json first = figures(1, {"--set", "fault[0].kind=corrupted-word", "--set",
                                 "fault[0].access=solution", "--set", "fault[0].frame=0"})["first"];
  EXPECT_EQ(first["what"], "access");
  EXPECT_EQ(first["recorded"]["what"], "read 2 words from U[+0x0]");
  EXPECT_THAT(std::string(first["place"]), StartsWith("U[+0x"));
  EXPECT_NE(first["recorded"]["word"], first["replayed"]["word"]);
}

TEST_F(Replay, ANewDriverIsComparedWithTheOld) {
  record_a_job();
  std::filesystem::copy_file(place.path() / "a.bin", place.path() / "b.bin");
  EXPECT_EQ(figures(0, {"--against", "b.bin", "--times"})["first"], json());
  const cli::Ended both = replay({"s.toml", "--against", "b.bin"});
  EXPECT_EQ(both.status, 2);
}

// True: with a recorder.
class Recording : public test::RecordedProgram, public testing::WithParamInterface<bool> {};

TEST_P(Recording, TakesNoSimulatedTimeAndAddsNoModule) {
  open({}, GetParam());
  hvp_device device{};
  load(device);
  solve(device);
  // What the board in a program has taken for this job since its record began.
  EXPECT_EQ(hvp_board_now_ps(board), 26'390'000U);
  std::vector<std::string> modules;
  for (const sc_core::sc_object* object : sc_core::sc_get_top_level_objects()) {
    if (dynamic_cast<const sc_core::sc_module*>(object) != nullptr) {
      modules.emplace_back(object->name());
    }
  }
  EXPECT_EQ(modules, (std::vector<std::string>{"bus", "accelerator", "daq", "host"}));
  close();
  EXPECT_EQ(cli::names(place.path()).size(), GetParam() ? 1U : 0U);
}

INSTANTIATE_TEST_SUITE_P(OrNot, Recording, testing::Bool());

TEST_F(Replay, ACutRecordIsReadUpToTheCut) {
  record_a_job();
  const std::string whole = cli::read(place.path() / "a.bin");
  const Record record = recorded();
  const Entry& half = record.entries()[record.entries().size() / 2];
  cli::write(place.path() / "a.bin", whole.substr(0, half.at + 5));
  const cli::Ended ended = replay({"--times"});
  EXPECT_EQ(ended.status, 0) << ended.out;
  EXPECT_EQ(ended.err, "warning: a.bin: byte " + std::to_string(half.at) +
                           ": the file ends within an entry: read until there\n");
}

// Nothing that was compared is nothing that is alike.
TEST_F(Replay, ARecordWithoutAnAccessIsRefused) {
  record_a_job();
  const std::string whole = cli::read(place.path() / "a.bin");
  const Record record = recorded();
  const auto first = std::ranges::find(record.entries(), Kind::ended, &Entry::kind);
  ASSERT_GT(first - record.entries().begin(), 0);
  cli::write(place.path() / "a.bin", whole.substr(0, first->at));
  const cli::Ended ended = replay();
  EXPECT_EQ(ended.status, 2);
  EXPECT_NE(ended.err.find("a.bin: no access was recorded: expected at least one\n"),
            std::string::npos)
      << ended.err;
}

TEST_F(Replay, APipeIsNoPlaceForARecord) {
  const std::filesystem::path pipe = place.path() / "a.bin";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  const std::string scenario = cli::scenario("thesis.toml").string();
  const hvp_board_options options = {nullptr, 0, nullptr, false, pipe.c_str()};
  EXPECT_EQ(hvp_board_open(scenario.c_str(), &options, why.data(), why.size()), nullptr);
  EXPECT_NE(std::string(why.data()).find("no regular file"), std::string::npos) << why.data();
  EXPECT_TRUE(std::filesystem::is_fifo(pipe));
}

TEST_F(Replay, WhatIsNoRecordIsRefusedInALine) {
  cli::write(place.path() / "a.bin", "no record of anything at all, but long enough");
  const cli::Ended ended = replay();
  EXPECT_EQ(ended.status, 2);
  EXPECT_EQ(ended.out, "");
  EXPECT_EQ(ended.err, "a.bin: byte 0: no record of accesses: expected HVPRECRD\n");
  EXPECT_EQ(cli::hvp(place.path(), {"replay", "nowhere.bin"}).status, 2);
}

}  // namespace
}  // namespace hvp::record::replay_test
