#include "vp/fpga/rtl/rtl_engine.h"

#include <cmath>
#include <stdexcept>
#include <string>

#include "models/config/input_error.h"
#include "models/index.h"

namespace hvp::vp::rtl {

namespace {

constexpr int kMantissaBits = 53;  // of a double
// A run that has not ended by then has no end.
constexpr std::int64_t kHangs = 200'000'000;

std::uint32_t place(int partition, int row, int package) {
  return static_cast<std::uint32_t>(partition) << 16U | static_cast<std::uint32_t>(row) << 14U |
         static_cast<std::uint32_t>(package);
}

}  // namespace

RtlEngine::RtlEngine(const EngineSize& size, const accel::Architecture& architecture, int seed)
    : size_((require_fitting(size, architecture), size)),
      architecture_(architecture),
      model_(size.make(seed)),
      ports_(model_->ports),
      memories_(*model_, size) {
  reset();
}

// Several edges, so that the memories' output registers show the first words.
void RtlEngine::reset() {
  ports_.reset = true;
  for (int i = 0; i < 2; ++i) model_->tick();
  ports_.reset = false;
  for (int i = 0; i < 3; ++i) model_->tick();
}

void RtlEngine::abort() {
  tell('a', idle() || copying_ ? 0 : clocks_);
  copying_ = false;
  reset();
}

void RtlEngine::tell(char what, std::int64_t first, std::int64_t second, std::int64_t third) const {
  if (!record) return;
  record(what, static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(second),
         static_cast<std::uint32_t>(third));
}

// Once the solve is over.
void RtlEngine::record_solve() {
  if (idle()) tell('s', clocks_, ports_.iterations_made, ports_.clamped);
}

void RtlEngine::write(Space space, std::uint32_t address, std::int64_t word) {
  end_copy();
  ports_.host_write = true;
  ports_.host_space = space;
  ports_.host_address = address;
  ports_.host_word = static_cast<std::uint32_t>(word);
  model_->tick();
  ports_.host_write = false;
  tell('w', static_cast<int>(space), address, word);
}

void RtlEngine::load(const fixed::QuantisedMatrix& matrix, const fixed::Settings& settings) {
  require_fitting(size_, settings);
  abort();
  const engine::Layout layout(architecture_, matrix.row_begin, matrix.column);
  nodes_ = matrix.block_rows();
  if (nodes_ > 1 << size_.node_bits) {
    throw InputError("nodes", std::to_string(nodes_) + " nodes; the RTL engine \"" + size_.name +
                                  "\" has memories for " + std::to_string(1 << size_.node_bits));
  }
  settings_ = settings;
  has_inverse_ = false;
  set_all(settings);
  set(0, nodes_);
  packages_.clear();
  std::vector<std::int32_t> words(3 * at(size_.package));
  for (int p = 0; p < size_.partitions; ++p) {
    const engine::Partition& partition = layout.partitions()[at(p)];
    if (partition.packages() > 1 << size_.package_bits) {
      throw InputError("partitions", "a partition of " + std::to_string(partition.packages()) +
                                         " packages; the RTL engine \"" + size_.name +
                                         "\" has memories for " +
                                         std::to_string(1 << size_.package_bits));
    }
    packages_.push_back(partition.packages());
    write(Space::packages, place(p, 0, 0), partition.packages());
    for (int k = 0; k < partition.packages(); ++k) {
      const int row = partition.owner[at(k)];
      const std::span<const std::int32_t> blocks = matrix.row(row);
      const int first = (k - layout.place(row).first_package) * size_.package;
      for (int c = 0; c < size_.package; ++c) {
        const int column = first + c;
        for (int r = 0; r < 3; ++r) {
          const bool used = c < partition.columns[at(k)];
          words[at(r * size_.package + c)] =
              used ? blocks[at(9 * (column / 3) + 3 * r + column % 3)] : 0;
        }
      }
      write_package(partition, p, k, words);
    }
  }
  write_places(layout, matrix);
  const std::vector<std::int32_t> zeros(3 * at(nodes_), 0);
  write_vector(Space::b, zeros);
  // No clocks of the engine: the cycle-accurate one has no such copy.
  const std::function<void()> watcher = std::exchange(watcher_, {});
  write_x(zeros);
  end_copy();
  watcher_ = watcher;
  has_solved_ = false;
  if (expects_flips_) clear_q();
}

void RtlEngine::write_places(const engine::Layout& layout, const fixed::QuantisedMatrix& matrix) {
  for (int node = 0; node < nodes_; ++node) {
    const engine::RowPlace& row = layout.place(node);
    const auto blocks = static_cast<int>(matrix.row(node).size() / 9);
    if (blocks > EngineSize::kBlocksOfARow || row.packages > EngineSize::kPackagesOfARow) {
      throw InputError("nodes", "a row of " + std::to_string(blocks) + " blocks in " +
                                    std::to_string(row.packages) +
                                    " packages; the RTL matrix editor takes 64 in 255");
    }
    const auto number = static_cast<std::uint32_t>(node);
    write(Space::place, static_cast<std::uint32_t>(row.packages) << 16U | number,
          std::int64_t{blocks} << 24 | std::int64_t{row.partition} << 16 | row.first_package);
    write(Space::contact, number, matrix.is_contact[at(node)]);
  }
}

std::int64_t RtlEngine::constrain(int node, std::int32_t diagonal) {
  return edit(node, false, diagonal);
}

std::int64_t RtlEngine::restore(int node, std::span<const std::int32_t> row) {
  for (std::size_t block = 0; block < row.size() / 9; ++block) {
    const auto address = static_cast<std::uint32_t>(block << 4U);
    for (std::uint32_t e = 0; e < 9; ++e) write(Space::staged, address | e, row[9 * block + e]);
    write(Space::staged, address | 15U, 0);
  }
  return edit(node, true, 0);
}

std::int64_t RtlEngine::invert(std::int64_t most) {
  has_inverse_ = true;
  if (!settings_.preconditioned()) return 1;
  end_copy();
  ports_.invert = true;
  model_->tick();
  ports_.invert = false;
  const std::int64_t clocks = run_order(most);
  tell('i', clocks);
  return clocks;
}

void RtlEngine::require_inverse(const fixed::Settings& settings) {
  if (settings.method != settings_.method) has_inverse_ = false;
  settings_ = settings;
  set_all(settings);
  if (!has_inverse_) invert();
}

std::int64_t RtlEngine::run_order(std::int64_t most) {
  std::int64_t clocks = 0;
  while (ports_.editing && clocks < most) {
    tick();
    if (++clocks == kHangs) throw std::logic_error("the RTL engine's matrix editor has no end");
  }
  return clocks;
}

std::int64_t RtlEngine::edit(int node, bool restores, std::int32_t diagonal) {
  require_inverse(settings_);
  set(10, node);
  set(11, restores ? 1 : 0);
  set(12, diagonal);
  for (int i = 0; i < 3; ++i) model_->tick();
  ports_.edit = true;
  model_->tick();
  ports_.edit = false;
  const std::int64_t clocks = run_order();
  tell('e', clocks);
  return clocks;
}

void RtlEngine::write_package(const engine::Partition& partition, int number, int package,
                              std::span<const std::int32_t> words) {
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < size_.package; ++c) {
      write(Space::column, static_cast<std::uint32_t>(c), words[at(r * size_.package + c)]);
    }
    write(Space::matrix, place(number, r, package), 0);
  }
  const int nodes = static_cast<int>(partition.node.size()) / partition.packages();
  for (int n = 0; n < nodes; ++n) {
    write(Space::node, static_cast<std::uint32_t>(n), partition.node[at(package * nodes + n)]);
  }
  const std::int64_t last = partition.last[at(package)];
  const std::int64_t phase = partition.phase[at(package)];
  write(Space::index, place(number, 0, package),
        last << (size_.node_bits + 2) | phase << size_.node_bits | partition.owner[at(package)]);
}

void RtlEngine::write_vector(Space space, std::span<const std::int32_t> words) {
  for (std::size_t i = 0; i < words.size(); ++i) {
    write(space, static_cast<std::uint32_t>(i / 3 << 2U | i % 3), words[i]);
  }
}

void RtlEngine::write_b(std::span<const std::int32_t> words) { write_vector(Space::b, words); }

void RtlEngine::write_x(std::span<const std::int32_t> words) {
  end_copy();
  write_vector(Space::x, words);
  start_copy();
}

void RtlEngine::read_x(std::span<std::int32_t> words) {
  end_copy();
  for (std::size_t node = 0; node < words.size() / 3; ++node) {
    ports_.host_address = static_cast<std::uint32_t>(node << 2U);
    model_->tick();
    model_->tick();
    for (std::size_t c = 0; c < 3; ++c) {
      ports_.host_address = static_cast<std::uint32_t>(node << 2U | c);
      model_->settle();
      words[3 * node + c] = ports_.host_read;
      tell('x', ports_.host_address, ports_.host_read);
    }
  }
}

void RtlEngine::forget_previous() {
  end_copy();
  ports_.forget_previous = true;
  model_->tick();
  ports_.forget_previous = false;
  tell('f', 0);
}

void RtlEngine::start_copy() {
  end_copy();
  ports_.copy = true;
  model_->tick();
  ports_.copy = false;
  copy_clocks_ = 0;
  copying_ = true;
}

void RtlEngine::run_copy_until(std::int64_t clocks) {
  if (!copying_) return;
  while (!idle() && copy_clocks_ < clocks) {
    tick();
    if (++copy_clocks_ == kHangs) throw std::logic_error("the RTL engine's copy of x has no end");
  }
  copying_ = !idle();
  if (!copying_) tell('c', copy_clocks_);
}

void RtlEngine::end_copy() { run_copy_until(kHangs); }

void RtlEngine::set_all(const fixed::Settings& s) {
  const auto rounding = [](fixed::Rounding r) { return static_cast<int>(r); };
  set(1, s.iterations);
  set(2, s.replace_residual_every);
  set(3, s.rhs_shift());
  set(4, s.headroom_bits);
  set(5, s.scaling_threshold);
  set(6, s.scaling_step);
  set(7, (s.start == fixed::Start::zero ? 1 : 0) | (s.start == fixed::Start::extrapolated ? 2 : 0) |
             (s.dynamic_scaling ? 4 : 0) | (s.scaling_down ? 8 : 0) |
             (s.preconditioned() ? 16 : 0));
  set(8, rounding(s.shift_rounding));
  set(9, rounding(s.division_rounding));
  int exponent = 0;
  const double fraction = std::frexp(s.stop_residual * s.stop_residual, &exponent);
  const auto mantissa = static_cast<std::int64_t>(std::ldexp(fraction, kMantissaBits));
  set(13, mantissa & 0xffffffff);
  set(14, mantissa >> 32);
  set(15, exponent - kMantissaBits);
}

void RtlEngine::start_solve(const fixed::Settings& settings) {
  require_fitting(size_, settings);
  end_copy();
  require_inverse(settings);
  clocks_ = 0;
  state_clocks_ = {};
  has_solved_ = true;
  ports_.go = true;
  model_->tick();
  ports_.go = false;
  record_solve();
}

void RtlEngine::tick() {
  model_->tick();
  if (watcher_) watcher_();
}

void RtlEngine::solve_clock() {
  ++state_clocks_[at(ports_.state)];
  tick();
  if (++clocks_ == kHangs) throw std::logic_error("the RTL engine's solve has no end");
  record_solve();
}

bool RtlEngine::run_iteration(std::int64_t most) {
  while (!idle() && clocks_ < most) {
    solve_clock();
    if (ports_.iteration_made) return true;
  }
  return false;
}

void RtlEngine::run_until(std::int64_t clocks) {
  while (!idle() && clocks_ < clocks) solve_clock();
}

fixed::Report RtlEngine::report() const {
  using stability::Flag;
  fixed::Report report;
  report.iterations = ports_.iterations_made;
  report.reached = ports_.reached;
  report.replacements = ports_.replacements;
  report.saturations = ports_.clamped;
  if (report.saturations > 0) report.flags.raise(Flag::saturation);
  if (ports_.scalar_overflow) report.flags.raise(Flag::scalar_overflow);
  if (ports_.breakdown) {
    report.breakdowns = 1;
    report.flags.raise(Flag::negative_curvature);
  }
  return report;
}

}  // namespace hvp::vp::rtl
