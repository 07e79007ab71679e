// What a user sees of a board that fails: exit status, the report's block, the result files.
#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "models/files/csv.h"
#include "tests/app/cli/program.h"
#include "tests/app/scratch_directory.h"

namespace hvp::cli::fault_test {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

// The small scene with a time-out that a frame has room for, and `faults`.
struct Faulty {
  explicit Faulty(const std::string& faults) {
    write(place.path() / "s.toml", std::string(kSmallScene) + faults);
    ended = hvp(place.path(), {"run", "s.toml", "--out", "a", "--set", "output.pictures=false",
                               "--set", "host.timeout=1 ms"});
  }
  json summary() const { return json::parse(read(place.path() / "a/summary.json")); }

  ScratchDirectory place;
  Ended ended;
};

TEST(Faults, AreInTheReportTheSummaryAndTheFrames) {
  const Faulty run("\n[[fault]]\nkind = \"stuck-busy\"\nframe = 5\n");
  EXPECT_EQ(run.ended.status, 1) << run.ended.err;
  EXPECT_THAT(run.ended.out, HasSubstr("1 injected, 0 unnoticed"));
  EXPECT_THAT(run.ended.out, HasSubstr("ERROR HVP_ERROR_TIMEOUT once, first in frame 5"));
  EXPECT_THAT(run.ended.out, Not(HasSubstr("PASS")));
  const json s = run.summary();
  EXPECT_EQ(s.at("driver").at("errors").at("HVP_ERROR_TIMEOUT").at("count"), 1);
  EXPECT_EQ(s.at("driver").at("held_frames"), 1);
  EXPECT_EQ(s.at("driver").at("recoveries"), 1);
  EXPECT_EQ(s.at("faults").at(0).at("noticed"), 1);
  const std::vector<std::string> frames = lines(read(run.place.path() / "a/frames.csv"));
  EXPECT_THAT(frames.at(0), HasSubstr(",status"));
  EXPECT_THAT(frames.at(6), HasSubstr(",HVP_ERROR_TIMEOUT"));
  EXPECT_THAT(frames.at(7), HasSubstr(",HVP_OK"));
  EXPECT_THAT(read(run.place.path() / "a/trace.json"), HasSubstr("recovery"));
}

// Every force is in time and of its frame, as far as anybody could tell.
TEST(Faults, OneThatNobodyNoticedIsListedAndIsNoPass) {
  const Faulty run(
      "\n[[fault]]\nkind = \"corrupted-word\"\nframe = 5\naccess = \"solution\"\nbits = 2\n");
  EXPECT_THAT(run.ended.out, HasSubstr("UNNOTICED 1"));
  EXPECT_THAT(run.ended.out, Not(HasSubstr("PASS")));
  EXPECT_EQ(run.summary().at("faults").at(0).at("unnoticed"), 1);
}

TEST(Faults, ABoardThatIsGoneForGoodEndsWithAnErrorAndTheRunsResults) {
  const Faulty run(
      "\n[[fault]]\nkind = \"device-gone\"\nframe = 5\n\n[host.recovery]\nattempts = 2\n");
  EXPECT_EQ(run.ended.status, 1) << run.ended.err;
  EXPECT_THAT(run.ended.out, HasSubstr("ERROR the board was given up in frame 6"));
  EXPECT_EQ(run.summary().at("driver").at("given_up_frame"), 6);
}

TEST(Faults, WhatCannotHappenIsRefused) {
  const Faulty no_dma("\n[[fault]]\nkind = \"late-dma\"\ndelay = \"1 ms\"\nframe = 5\n");
  EXPECT_EQ(no_dma.ended.status, 2);
  EXPECT_THAT(no_dma.ended.err, HasSubstr("transfer.method"));
  const Faulty both("\n[[fault]]\nkind = \"stuck-busy\"\nframe = 5\nrate = 0.5\n");
  EXPECT_EQ(both.ended.status, 2);
  EXPECT_THAT(both.ended.err, HasSubstr("either frame or rate"));
}

TEST(Faults, ABitThatNoEngineHasIsRefused) {
  const auto error = [](const std::string& level, const std::string& keys) {
    const Faulty run("\n[fidelity]\naccelerator = \"" + level +
                     "\"\n\n[[fault]]\nkind = \"flip\"\nframe = 5\n" + keys);
    EXPECT_EQ(run.ended.status, 2);
    EXPECT_EQ(std::ranges::count(run.ended.err, '\n'), 1) << run.ended.err;
    return run.ended.err;
  };
  EXPECT_THAT(error("loosely-timed", "place = \"x\"\n"),
              HasSubstr("expected fidelity.accelerator = \"cycle-accurate\" or \"rtl\""));
  EXPECT_THAT(error("cycle-accurate", ""), HasSubstr("place"));
  EXPECT_THAT(error("cycle-accurate", "place = \"s\"\n"), HasSubstr("\"previous\""));
  EXPECT_THAT(error("cycle-accurate", "place = \"x\"\nbit = 16\n"),
              HasSubstr("bit: 16: expected less than 16"));
  EXPECT_THAT(error("cycle-accurate", "place = \"d\"\npartition = 5\n"),
              HasSubstr("partition: 5: expected less than 5"));
  EXPECT_THAT(error("cycle-accurate", "place = \"nodes\"\ncolumn = 4\n"),
              HasSubstr("column: 4: expected less than 4"));
  EXPECT_THAT(error("cycle-accurate", "place = \"loops\"\nnode = 4\n"), HasSubstr("node"));
  EXPECT_THAT(error("cycle-accurate", "place = \"d\"\ncopy = 1\n"),
              HasSubstr("copy: 1: expected less than 1"));
  EXPECT_THAT(error("cycle-accurate", "place = \"d_exponent\"\nbit = 16\n"),
              HasSubstr("bit: 16: expected less than 16"));
  EXPECT_THAT(error("cycle-accurate", "place = \"inverse\"\n"),
              HasSubstr("expected solver.method = \"jacobi-pcg\""));
}

TEST(Faults, AFlipThatTheLevelRtlDoesNotCompareIsRefused) {
  const Faulty exponent(
      "\n[fidelity]\naccelerator = \"rtl\"\n\n"
      "[[fault]]\nkind = \"flip\"\nframe = 5\nplace = \"r_exponent\"\n");
  EXPECT_EQ(exponent.ended.status, 2);
  if (exponent.ended.err.find("Verilator") != std::string::npos) GTEST_SKIP() << exponent.ended.err;
  EXPECT_THAT(exponent.ended.err, HasSubstr("place: r_exponent is not compared at the level rtl"));
}

TEST(Faults, ABitThatTheMeshDoesNotHaveIsNamedByItsIndex) {
  const Faulty run(
      "\n[fidelity]\naccelerator = \"cycle-accurate\"\n\n[[fault]]\nkind = \"flip\"\nframe = 5\n"
      "place = \"x\"\nnode = 100000\n");
  EXPECT_THAT(run.ended.out,
              HasSubstr("did not happen: the engine has no such bit: node is 100000"));
}

TEST(Faults, AFlippedBitIsInTheReportAndInItsFrame) {
  const Faulty run(
      "\n[fidelity]\naccelerator = \"cycle-accurate\"\n\n[[fault]]\nkind = \"flip\"\nframe = 5\n"
      "place = \"matrix\"\npartition = 1\npackage = 2\nrow = 0\ncolumn = 0\nbit = 10\nclock = 9\n");
  EXPECT_THAT(run.ended.out, Not(HasSubstr("PASS")));
  EXPECT_EQ(run.summary().at("verdict"), "held, with wrong solutions");
  EXPECT_THAT(run.ended.out,
              HasSubstr("matrix partition 1 package 2 row 0 column 0 bit 10 at clock 9"));
  const json flips = run.summary().at("flips");
  EXPECT_EQ(flips.at("made"), 1);
  EXPECT_EQ(flips.at("first"), "matrix partition 1 package 2 row 0 column 0 bit 10 at clock 9");
  EXPECT_GT(flips.at("wrong_solutions"), 0);
  EXPECT_GT(flips.at("worst_error"), 0);
  const std::vector<std::string> frames = lines(read(run.place.path() / "a/frames.csv"));
  EXPECT_THAT(frames.at(0), HasSubstr(",status,flips"));
  EXPECT_THAT(frames.at(6), HasSubstr(",HVP_OK,1"));
  EXPECT_THAT(frames.at(7), HasSubstr(",HVP_OK,0"));
}

TEST(Faults, AnAccessThatTheDriverDoesNotMakeIsRefused) {
  const std::string by_dma = "\n[transfer]\nmethod = \"dma\"\nnotification = \"msi\"\n";
  for (const char* access : {"status", "acknowledge"}) {
    const Faulty run(by_dma + "\n[[fault]]\nkind = \"master-abort\"\nframe = 5\naccess = \"" +
                     access + "\"\n");
    EXPECT_EQ(run.ended.status, 2);
    EXPECT_THAT(run.ended.err, HasSubstr("only for transfer.notification = \"intx\""));
  }
  // The doorbell is what starts a job.
  const Faulty doorbell(by_dma +
                        "\n[[fault]]\nkind = \"master-abort\"\nframe = 5\naccess = \"start\"\n");
  EXPECT_EQ(doorbell.ended.status, 1) << doorbell.ended.err;
  EXPECT_EQ(doorbell.summary().at("faults").at(0).at("noticed"), 1);
}

TEST(Faults, ALostAcknowledgementOfADmaFrameIsRepeated) {
  const Faulty run(
      "\n[transfer]\nmethod = \"dma\"\nnotification = \"intx\"\n"
      "\n[[fault]]\nkind = \"master-abort\"\nframe = 5\naccess = \"acknowledge\"\n");
  EXPECT_EQ(run.ended.status, 0) << run.ended.err;
  const json s = run.summary();
  EXPECT_EQ(s.at("driver").at("lost_acknowledgements"), 1);
  EXPECT_EQ(s.at("driver").at("held_frames"), 0);
  EXPECT_EQ(s.at("faults").at(0).at("noticed"), 1);
}

// The force of a frame that failed is not its own, however early it is there.
TEST(Faults, AHeldForceIsNotInTime) {
  const Faulty run("\n[[fault]]\nkind = \"master-abort\"\nframe = 5\naccess = \"start\"\n");
  const std::vector<std::string> frames = lines(read(run.place.path() / "a/frames.csv"));
  const auto in_time = [&](std::size_t line) { return files::csv_cells(frames.at(line)).at(5); };
  EXPECT_EQ(in_time(5), "1");
  EXPECT_EQ(in_time(6), "0");
}

}  // namespace
}  // namespace hvp::cli::fault_test
