// hvp-draw RUN_DIRECTORY: draws deformation.png, latency.png and, of a closed loop, loop.png from
// the results of a run, into the run's directory.
// hvp-draw --stability-map IN.csv OUT.png: draws the largest stable stiffness of a wall
// over its damping.
// hvp-draw --fit IN.csv OUT.png X_LABEL Y_LABEL UNIT: draws a log and a model of it.
// Needs an X display with OpenGL; `hvp` starts one where there is none.
//
// Exit status: 0 drawn; 2 the results are missing or damaged (one line on stderr, no picture
// written); 3 anything else.

#include <cstdio>
#include <exception>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "app/draw/deformation_step.h"
#include "app/draw/picture_window.h"
#include "app/draw/pictures.h"
#include "app/draw/run_files.h"
#include "app/draw/series_files.h"
#include "app/draw/vtk_errors.h"
#include "app/results/part_files.h"
#include "models/config/input_error.h"

namespace hvp::draw {
namespace {

void draw_pictures(const std::filesystem::path& run) {
  // All input is read and checked before anything is drawn, and everything is drawn before
  // anything is written.
  const std::vector<FrameRow> frames = read_frames(run / "frames.csv");
  const Deadline deadline = read_deadline(run / "summary.json");
  const std::optional<LoopSeries> loop = read_loop(run / "frames.csv");
  const Caption caption = read_caption(run / "summary.json");
  std::optional<DeformationStep> step;
  // A run with timing only has no deformation.
  if (std::filesystem::exists(run / "deformation.pvd")) step = read_deepest_step(run);

  PictureWindow window;
  std::vector<std::pair<std::string, std::string>> pictures;
  if (step) {
    draw_deformation(window, *step, caption);
    pictures.emplace_back("deformation.png", window.take_png());
  }
  draw_latency(window, frames, deadline, caption);
  pictures.emplace_back("latency.png", window.take_png());
  if (loop) {
    draw_loop(window, *loop, caption);
    pictures.emplace_back("loop.png", window.take_png());
  }

  for (const auto& [name, bytes] : pictures) {
    results::write_through_part_file(run / name, bytes);
    fmt::print("{}\n", name);
  }
}

void draw_map_file(const std::filesystem::path& csv, const std::filesystem::path& png) {
  const StabilityMap map = read_stability_map(csv);
  PictureWindow window;
  draw_stability_map(window, map);
  results::write_through_part_file(png, window.take_png());
  fmt::print("{}\n", png.filename().string());
}

void draw_fit_file(const std::filesystem::path& csv, const std::filesystem::path& png,
                   const FitLabels& labels) {
  const FitSeries series = read_fit(csv);
  PictureWindow window;
  draw_fit(window, series, labels);
  results::write_through_part_file(png, window.take_png());
  fmt::print("{}\n", png.filename().string());
}

}  // namespace
}  // namespace hvp::draw

// Mesa's driver is unloaded with a few bytes still allocated, which would fail every picture of
// a build with AddressSanitizer. ASAN_OPTIONS still has the last word.
#ifdef __SANITIZE_ADDRESS__
extern "C" const char* __asan_default_options() { return "detect_leaks=0"; }
#endif

int main(int argc, char** argv) {
  const bool of_map = argc == 4 && std::string_view(argv[1]) == "--stability-map";
  const bool of_fit = argc == 7 && std::string_view(argv[1]) == "--fit";
  if (argc != 2 && !of_map && !of_fit) {
    fmt::print(stderr,
               "usage: hvp-draw RUN_DIRECTORY | --stability-map IN.csv OUT.png | "
               "--fit IN.csv OUT.png X_LABEL Y_LABEL UNIT\n");
    return 2;
  }
  hvp::results::end_cleanly_when_interrupted();
  hvp::draw::VtkErrors::capture();
  try {
    if (of_map) {
      hvp::draw::draw_map_file(argv[2], argv[3]);
    } else if (of_fit) {
      hvp::draw::draw_fit_file(argv[2], argv[3], {argv[4], argv[5], argv[6]});
    } else {
      hvp::draw::draw_pictures(argv[1]);
    }
    return 0;
  } catch (const hvp::InputError& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 2;
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 3;
  }
}
