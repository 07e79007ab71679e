#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

namespace hvp::results {

struct PictureOutcome {
  bool drawn = false;
  std::vector<std::string> files;  // names of the pictures, without the folder
  std::string reason;              // one line; empty when drawn
};

// The programs and the display that drawing needs.
struct PictureTools {
  std::filesystem::path draw_program;           // hvp-draw
  std::string display;                          // an X display such as ":0"; empty: none
  std::filesystem::path xvfb;                   // the virtual X server; empty: not installed
  std::chrono::milliseconds time_limit{60000};  // for each start of hvp-draw

  // hvp-draw beside the running executable, $DISPLAY, and Xvfb from $PATH.
  static PictureTools of_this_process();
};

// Draws deformation.png, latency.png and, of a closed loop, loop.png of a finished run into its
// directory, after removing those of an earlier run. A child process draws: loading the renderer is
// slow and a lost display aborts it. It uses the local X display where that answers, else (or when
// that cannot draw) an Xvfb of its own. Never throws for what the child does: a crash, a time-out
// or a missing display becomes the reason, and the run's other results stay as they are.
PictureOutcome draw_pictures(const std::filesystem::path& run_directory);
PictureOutcome draw_pictures(const std::filesystem::path& run_directory, const PictureTools& tools);

// Draws the largest stiffness with which a wall's loop is stable over the wall's damping, from a
// file as draw::read_stability_map() expects it (app/draw/series_files.h), in the same way and with
// the same failures.
PictureOutcome draw_stability_map(const std::filesystem::path& csv,
                                  const std::filesystem::path& png);
PictureOutcome draw_stability_map(const std::filesystem::path& csv,
                                  const std::filesystem::path& png, const PictureTools& tools);

// The axes' labels and the unit of a fit's values.
struct FitPictureLabels {
  std::string x;
  std::string y;
  std::string unit;
};
// Draws a log and the model of it, from a file as draw::read_fit() expects it
// (app/draw/series_files.h), in the same way and with the same failures.
PictureOutcome draw_fit(const std::filesystem::path& csv, const std::filesystem::path& png,
                        const FitPictureLabels& labels);
PictureOutcome draw_fit(const std::filesystem::path& csv, const std::filesystem::path& png,
                        const FitPictureLabels& labels, const PictureTools& tools);

// True if an X server listens at a local display (":0", ":0.0", "unix:1"). A display of another
// machine counts as not reachable: OpenGL through it is too old for VTK.
bool local_display_answers(const std::string& display);

}  // namespace hvp::results
