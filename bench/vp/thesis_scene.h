#pragma once

#include <array>
#include <cstdlib>
#include <ctime>
#include <vector>

#include <sys/wait.h>
#include <unistd.h>

#include "models/collision/contact_search.h"
#include "models/fem/body.h"
#include "models/host/frame_computation.h"
#include "models/mesh/generate.h"
#include "models/mesh/region.h"
#include "vp/platform.h"

// The scene of the benchmarks of the whole platform, and a function that runs a measurement in a
// process of its own, because SystemC elaborates once in a process.
namespace hvp::bench {

inline mesh::TetMesh sphere() {
  mesh::MeshSettings settings;
  settings.nodes = 500;
  return mesh::generate(settings);
}

// The values of [dynamics] and [solver] in scenarios/thesis.toml that differ from the defaults.
inline fem::Dynamics dynamics() {
  fem::Dynamics d;
  d.newmark_gamma = 0.6;
  d.newmark_beta = 0.605;
  return d;
}
inline fixed::Settings solver() {
  fixed::Settings s;
  s.displacement_range = 40e-3;
  return s;
}

// The sphere of scenarios/thesis.toml: dynamic, with 60 iterations and the probe in contact.
struct ThesisScene {
  explicit ThesisScene(host::Effort effort_asked = host::Effort::computed) : effort(effort_asked) {
    settings.solver = computation.board().settings();
    settings.probes.front().start = {0, 0, 48e-3};
    plant::Segment press;
    press.phase = plant::Stroke::press;
    press.to = {0, 0, 45e-3};
    press.duration = 0.5;
    settings.probes.front().motion = {press};
  }
  host::Effort effort;
  mesh::TetMesh mesh = sphere();
  std::vector<int> anchored = mesh::select_nodes(mesh::Region{}, mesh);
  fem::Body body{mesh, fem::Material{}, anchored, fem::AnchorTreatment::removed};
  host::FrameComputation computation{
      body,         fem::ContactDiagonal::average, dynamics(), solver(), 2e-3,
      std::nullopt, host::SolvedBy::board,         effort};
  collision::ContactSearch contacts{mesh, anchored, {}};
  vp::PlatformSettings settings;
};

inline double processor_time() {
  std::timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

// Runs `measure` in a child process and returns its result, which is copied byte by byte.
template <class Result, class Measure>
Result in_a_child(const Measure& measure) {
  std::array<int, 2> ends{};
  if (pipe(ends.data()) != 0) std::abort();
  const pid_t child = fork();
  if (child == 0) {
    const Result result = measure();
    const bool written = write(ends[1], &result, sizeof(result)) == sizeof(result);
    _exit(written ? 0 : 1);
  }
  close(ends[1]);
  Result result;
  const bool whole = read(ends[0], &result, sizeof(result)) == sizeof(result);
  close(ends[0]);
  int status = 1;
  waitpid(child, &status, 0);
  if (!whole || status != 0) std::abort();
  return result;
}

}  // namespace hvp::bench
