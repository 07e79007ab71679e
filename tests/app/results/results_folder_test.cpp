#include "app/results/results_folder.h"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/app/scratch_directory.h"

namespace hvp::results::results_folder_test {
namespace {

std::vector<std::string> names(const std::filesystem::path& folder) {
  std::vector<std::string> found;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    found.push_back(entry.path().filename().string());
  }
  return found;
}

TEST(ResultsFolder, LosesEarlierResultsButTheNamedOnesAndNothingOfTheUsers) {
  using ::testing::UnorderedElementsAre;
  const ScratchDirectory place;
  for (const char* name :
       {"frames.csv", "summary.json", "engine.vcd", "engine.fst", "engine.part.fst", "notes.txt"}) {
    std::ofstream(place.path() / name) << "text";
  }
  remove_earlier_results(place.path(), {"engine.vcd", "engine.fst"});
  EXPECT_THAT(names(place.path()), UnorderedElementsAre("engine.vcd", "engine.fst", "notes.txt"));
  remove_earlier_results(place.path());
  EXPECT_THAT(names(place.path()), UnorderedElementsAre("notes.txt"));
}

}  // namespace
}  // namespace hvp::results::results_folder_test
