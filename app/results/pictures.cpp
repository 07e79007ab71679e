#include "app/results/pictures.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <string_view>
#include <system_error>

#include <fmt/format.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "app/results/launched_program.h"
#include "app/results/part_files.h"

namespace hvp::results {

namespace {

// Xlib tries the abstract name first and the file second.
bool listens(const std::string& socket_path, bool abstract) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const std::size_t start = abstract ? 1 : 0;
  if (start + socket_path.size() >= sizeof(address.sun_path)) return false;
  std::memcpy(address.sun_path + start, socket_path.data(), socket_path.size());
  const auto size =
      static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + start + socket_path.size());
  const int descriptor = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (descriptor < 0) return false;
  const bool connected =
      connect(descriptor, reinterpret_cast<const sockaddr*>(&address), size) == 0;
  close(descriptor);
  return connected;
}

}  // namespace

bool local_display_answers(const std::string& display) {
  std::string_view name = display;
  if (name.starts_with("unix:")) name.remove_prefix(4);
  if (!name.starts_with(':')) return false;
  name.remove_prefix(1);
  name = name.substr(0, name.find('.'));
  if (name.empty() ||
      !std::all_of(name.begin(), name.end(), [](unsigned char c) { return std::isdigit(c) != 0; }))
    return false;
  const std::string socket_path = "/tmp/.X11-unix/X" + std::string(name);
  return listens(socket_path, true) || listens(socket_path, false);
}

namespace {

constexpr std::array<const char*, 3> kPictures = {"deformation.png", "latency.png", "loop.png"};

// hvp-draw's own exit status for results that cannot be drawn on any display.
constexpr int kBadResults = 2;

std::filesystem::path find_program(const char* name) {
  const char* path = std::getenv("PATH");
  if (path == nullptr) return {};
  for (std::string_view rest = path; !rest.empty();) {
    const std::size_t colon = rest.find(':');
    std::filesystem::path candidate = std::filesystem::path(rest.substr(0, colon)) / name;
    if (candidate.is_absolute() && access(candidate.c_str(), X_OK) == 0) return candidate;
    rest = colon == std::string_view::npos ? std::string_view() : rest.substr(colon + 1);
  }
  return {};
}

std::string first_line(const std::string& text) { return text.substr(0, text.find('\n')); }

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    lines.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return lines;
}

// A request to hvp-draw.
struct Order {
  std::vector<std::string> arguments;
  std::vector<std::filesystem::path> pictures;  // all files that it may write
  std::string lost;                             // the message where it has written none

  PictureOutcome not_drawn(const std::string& cause) const {
    return {false, {}, fmt::format("{}: {}", cause, lost)};
  }
  PictureOutcome interrupted_pictures() const { return not_drawn("interrupted"); }
};

struct Attempt {
  PictureOutcome outcome;
  bool worth_another_display = false;
};

Attempt draw_on(const std::string& display, const Order& order, const PictureTools& tools,
                bool software_rendering) {
  LaunchedProgram::Options options;
  options.environment = {{"DISPLAY", display}};
  // Xvfb has no graphics card; without this Mesa looks for one and may find it.
  if (software_rendering) options.environment.emplace_back("LIBGL_ALWAYS_SOFTWARE", "1");
  LaunchedProgram child(tools.draw_program, order.arguments, options);
  const LaunchedProgram::Result result = child.wait(tools.time_limit);
  if (result.exit_status == 0) return {{true, lines_of(result.output), {}}, false};

  if (result.interrupted) return {order.interrupted_pictures(), false};
  std::string cause;
  if (result.timed_out)
    cause = fmt::format("hvp-draw took longer than {} s",
                        static_cast<double>(tools.time_limit.count()) / 1000.0);
  else if (result.signal != 0)
    cause = fmt::format("hvp-draw crashed ({})", strsignal(result.signal));
  else if (const std::string line = first_line(result.errors); !line.empty())
    cause = line;
  else
    cause = fmt::format("hvp-draw failed with status {}", result.exit_status);
  return {order.not_drawn(cause), result.exit_status != kBadResults};
}

PictureOutcome draw_under_xvfb(const Order& order, const PictureTools& tools) {
  LaunchedProgram::Options options;
  options.report_pipe = true;
  // Xvfb picks a free display number and reports it. The pictures are drawn off screen, so the
  // screen itself may be small.
  LaunchedProgram server(tools.xvfb,
                         {"-displayfd", std::to_string(LaunchedProgram::kReportDescriptor),
                          "-screen", "0", "640x480x24", "-nolisten", "tcp"},
                         options);
  const auto number = server.report_line(std::chrono::seconds(20));
  if (interrupted() != 0) return order.interrupted_pictures();
  if (!number) {
    // The server's own words, when it has ended; a live one is ended here.
    const std::string words = first_line(server.wait(std::chrono::milliseconds(500)).errors);
    return order.not_drawn("Xvfb did not start" + (words.empty() ? words : " (" + words + ")"));
  }
  return draw_on(":" + *number, order, tools, true).outcome;
}

PictureOutcome carry_out(const Order& order, const PictureTools& tools) {
  // Pictures of an earlier run beside this run's numbers would be wrong ones.
  for (const std::filesystem::path& picture : order.pictures) {
    std::error_code ignored;
    std::filesystem::remove(picture, ignored);
  }
  if (access(tools.draw_program.c_str(), X_OK) != 0)
    return order.not_drawn(fmt::format("{} is not there", tools.draw_program.filename().string()));
  if (interrupted() != 0) return order.interrupted_pictures();
  try {
    std::optional<PictureOutcome> failed;
    if (local_display_answers(tools.display)) {
      const Attempt attempt = draw_on(tools.display, order, tools, false);
      if (attempt.outcome.drawn || !attempt.worth_another_display) return attempt.outcome;
      failed = attempt.outcome;
    }
    if (!tools.xvfb.empty()) return draw_under_xvfb(order, tools);
    return failed ? *failed : order.not_drawn("no display and Xvfb is not installed");
  } catch (const std::system_error& error) {
    return order.not_drawn(error.what());
  }
}

}  // namespace

PictureTools PictureTools::of_this_process() {
  PictureTools tools;
  std::error_code ignored;
  tools.draw_program =
      std::filesystem::read_symlink("/proc/self/exe", ignored).replace_filename("hvp-draw");
  if (const char* display = std::getenv("DISPLAY")) tools.display = display;
  tools.xvfb = find_program("Xvfb");
  return tools;
}

PictureOutcome draw_pictures(const std::filesystem::path& run_directory) {
  return draw_pictures(run_directory, PictureTools::of_this_process());
}

PictureOutcome draw_pictures(const std::filesystem::path& run_directory,
                             const PictureTools& tools) {
  Order order{{run_directory.string()}, {}, "deformation.png and latency.png were not drawn"};
  for (const char* name : kPictures) order.pictures.push_back(run_directory / name);
  return carry_out(order, tools);
}

PictureOutcome draw_stability_map(const std::filesystem::path& csv,
                                  const std::filesystem::path& png) {
  return draw_stability_map(csv, png, PictureTools::of_this_process());
}

PictureOutcome draw_stability_map(const std::filesystem::path& csv,
                                  const std::filesystem::path& png, const PictureTools& tools) {
  return carry_out({{"--stability-map", csv.string(), png.string()},
                    {png},
                    png.filename().string() + " was not drawn"},
                   tools);
}

PictureOutcome draw_fit(const std::filesystem::path& csv, const std::filesystem::path& png,
                        const FitPictureLabels& labels) {
  return draw_fit(csv, png, labels, PictureTools::of_this_process());
}

PictureOutcome draw_fit(const std::filesystem::path& csv, const std::filesystem::path& png,
                        const FitPictureLabels& labels, const PictureTools& tools) {
  return carry_out({{"--fit", csv.string(), png.string(), labels.x, labels.y, labels.unit},
                    {png},
                    png.filename().string() + " was not drawn"},
                   tools);
}

}  // namespace hvp::results
