#include "vp/fpga/engine/phase_engine.h"

#include <algorithm>
#include <cstddef>
#include <deque>
#include <vector>

#include "models/index.h"
#include "vp/fpga/engine/cycle_engine.h"

namespace hvp::vp::engine {

namespace {

// A partition on its way through its rows.
class RowStream {
 public:
  RowStream(const accel::Architecture& architecture, const Partition& partition)
      : partition_(partition),
        room_(at(architecture.result_queue)),
        depth_(architecture.memory_read_clocks + architecture.multiplier_clocks +
               architecture.adder_tree_clocks) {
    for (std::size_t row = 0; row < partition.row.size(); ++row) {
      std::int64_t clocks = 0;
      for (int p = partition.first_package[row]; p < partition.first_package[row + 1]; ++p) {
        clocks += partition.clocks[at(p)];
      }
      served_.push_back(clocks);
    }
    if (!served_.empty()) ready_ = served_.front();
  }

  bool has(std::int64_t clock) const { return !waiting_.empty() && waiting_.front().at <= clock; }
  int node() const { return waiting_.front().node; }
  // Its place is free at the next clock.
  void take() {
    waiting_.pop_front();
    ++taken_;
  }
  // Lets the last package of a row go when the banks have served it and there is room for the row.
  void move(std::int64_t clock) {
    const bool room = next_ - taken_ < room_;
    if (next_ == served_.size() || clock < ready_ || !room) return;
    waiting_.push_back({clock + depth_, partition_.row[next_]});
    if (++next_ < served_.size()) ready_ = clock + served_[next_];
  }
  std::size_t taken() const { return taken_; }

 private:
  struct Row {
    std::int64_t at = 0;  // from which it can be taken
    int node = 0;
  };

  const Partition& partition_;
  std::size_t room_;
  int depth_;
  std::vector<std::int64_t> served_;  // clocks that each row's packages take
  std::deque<Row> waiting_;
  std::int64_t ready_ = 0;  // when the next row's last package has been served
  std::size_t next_ = 0;
  std::size_t taken_ = 0;
};

// `first`: the partition that is first in turn, before and after.
std::int64_t product_clocks(const accel::Architecture& architecture, const Layout& layout,
                            std::size_t& first) {
  std::vector<RowStream> stream;
  for (const Partition& p : layout.partitions()) stream.emplace_back(architecture, p);
  std::vector<std::uint8_t> bank(at(architecture.nodes_per_clock));
  int left = layout.nodes();
  std::int64_t clock = 0;
  while (left > 0) {
    ++clock;
    for (RowStream& s : stream) s.move(clock);
    std::ranges::fill(bank, std::uint8_t{0});
    int lanes = architecture.nodes_per_clock;
    const std::size_t turn = first;
    bool passed_over = false;
    for (std::size_t i = 0; i < stream.size() && lanes > 0; ++i) {
      const std::size_t block = (turn + i) % stream.size();
      if (!stream[block].has(clock)) continue;
      std::uint8_t& taken = bank[at(stream[block].node() % architecture.nodes_per_clock)];
      if (taken != 0) {
        if (!passed_over) first = block;
        passed_over = true;
        continue;
      }
      taken = 1;
      stream[block].take();
      --lanes;
      --left;
      if (!passed_over) first = (block + 1) % stream.size();
    }
  }
  return clock + architecture.vector_clocks();
}

ProductClocks products_of(const accel::Architecture& architecture, const Layout& layout) {
  ProductClocks products;
  std::vector<int> number_of_turn(layout.partitions().size(), -1);
  std::size_t first = 0;
  while (number_of_turn[first] < 0) {
    number_of_turn[first] = static_cast<int>(products.clocks.size());
    products.clocks.push_back(product_clocks(architecture, layout, first));
  }
  products.repeats_from = at(number_of_turn[first]);
  return products;
}

// Groups of L nodes through the lanes, which stand still while a write takes more than a clock.
std::int64_t pass_clocks(const accel::Architecture& architecture, int nodes, bool reads,
                         bool writes) {
  const int lanes = architecture.nodes_per_clock;
  const int ports = architecture.direction_accesses();
  const auto accesses = [&](int first, int each) {
    const int count = std::min(lanes, nodes - first);
    return each * ((count + architecture.direction_banks - 1) / architecture.direction_banks);
  };
  const int to_write = architecture.phase_clocks() - architecture.adder_tree_clocks - 1;
  std::deque<std::int64_t> entered;  // moves of the lanes at which groups entered, to be written
  int next = 0;
  int next_written = 0;
  int reading = 0;
  int writing = 0;
  std::int64_t moves = 0;
  std::int64_t last_entered = 0;
  std::int64_t clock = 0;
  while (next < nodes || moves < last_entered + architecture.phase_clocks() - 1) {
    ++clock;
    int free = ports;
    const int written = std::min(free, writing);
    writing -= written;
    free -= written;
    if (writing > 0) continue;
    ++moves;
    if (!entered.empty() && entered.front() + to_write == moves) {
      entered.pop_front();
      writing = accesses(next_written, architecture.direction_write_accesses());
      next_written += lanes;
      const int now = std::min(free, writing);
      writing -= now;
      free -= now;
    }
    if (next >= nodes) continue;
    if (reads) {
      const int needed = accesses(next, 1);
      if (reading == 0) reading = needed;
      if (reading > free && needed <= ports) continue;
      reading -= std::min(free, reading);
      if (reading > 0) continue;
    }
    if (writes) entered.push_back(moves);
    last_entered = moves;
    next += lanes;
  }
  return clock + 1;
}

}  // namespace

PhaseClocks phase_clocks(const accel::Architecture& architecture, const Layout& layout) {
  PhaseClocks clocks;
  clocks.products = products_of(architecture, layout);
  clocks.vectors = pass_clocks(architecture, layout.nodes(), false, false);
  clocks.writing_direction = pass_clocks(architecture, layout.nodes(), false, true);
  clocks.reading_direction = pass_clocks(architecture, layout.nodes(), true, false);
  clocks.moving_direction = pass_clocks(architecture, layout.nodes(), true, true);
  for (const Partition& p : layout.partitions()) {
    for (const std::uint8_t served : p.clocks) clocks.bank_stalls += served - 1;
  }
  return clocks;
}

namespace {

struct EnginePhase {
  std::int64_t clocks = 0;
  unsigned units = 0;  // a bit a unit
};

constexpr unsigned bit(PhaseEngine::Unit unit) { return 1U << static_cast<unsigned>(unit); }
constexpr unsigned kVectors = bit(PhaseEngine::Unit::vectors);
constexpr unsigned kVectorsAndDirection = kVectors | bit(PhaseEngine::Unit::direction);
constexpr unsigned kProduct = kVectorsAndDirection | bit(PhaseEngine::Unit::matrix);
constexpr unsigned kDivider = bit(PhaseEngine::Unit::divider);

}  // namespace

PhaseEngine::PhaseEngine(const sc_core::sc_module_name& name,
                         const accel::Architecture& architecture)
    : sc_module(name),
      architecture_(architecture),
      period_(static_cast<double>(architecture.clock_period_ps()), sc_core::SC_PS),
      over_("over"),
      done_("done") {
  require_supported(architecture);
  SC_HAS_PROCESS(PhaseEngine);
  SC_METHOD(advance);
  sensitive << over_;
  dont_initialize();
}

void PhaseEngine::load(const fixed::QuantisedMatrix& matrix, const fixed::Settings& settings) {
  require_supported(settings);
  layout_.emplace(architecture_, matrix.row_begin, matrix.column);
  phases_ = phase_clocks(architecture_, *layout_);
  copied_ = sc_core::SC_ZERO_TIME;
  product_ = 0;
}

void PhaseEngine::copy_x() {
  copied_ = sc_core::sc_time_stamp() + static_cast<double>(phases_.writing_direction) * period_;
}

void PhaseEngine::start_solve(const fixed::Settings& settings, const fixed::Report& report) {
  require_supported(settings);
  settings_ = settings;
  report_ = report;
  loop_ = 0;
  free_at_ = {};
  held_ = {};
  state_clocks_ = {};
  // The copy may end between two of the job's clocks; they begin with its end.
  const sc_core::sc_time& now = sc_core::sc_time_stamp();
  const sc_core::sc_time wait = copied_ > now ? copied_ - now : sc_core::SC_ZERO_TIME;
  const auto period = period_.value();
  clock_ = static_cast<std::int64_t>((wait.value() + period - 1) / period);
  hold(settings.start == fixed::Start::extrapolated ? State::guess : State::start_product, wait);
}

void PhaseEngine::abort() {
  over_.cancel();
  state_ = State::idle;
  copied_ = sc_core::SC_ZERO_TIME;
  product_ = 0;
}

// The residual is formed anew in this iteration. Once nothing is left to do it never is.
bool PhaseEngine::replaces() const {
  const int every = settings_.replace_residual_every;
  return every > 0 && loop_ <= report_.iterations && loop_ % every == 0;
}

State PhaseEngine::next() const {
  switch (state_) {
    case State::guess:
      return State::start_product;
    case State::start_product:
      return State::start_residual;
    case State::start_residual:
      return State::first_direction;
    case State::first_direction:
    case State::direction: {
      const bool ends =
          loop_ == settings_.iterations || (report_.reached && loop_ == report_.iterations);
      return ends ? State::idle : State::product;
    }
    case State::product:
      // dᵀA·d came out at or below zero.
      return report_.breakdowns > 0 && loop_ > report_.iterations ? State::idle : State::alpha;
    case State::alpha:
      return State::update;
    case State::update:
      return replaces() ? State::anew_product : State::beta;
    case State::anew_product:
      return State::anew_residual;
    case State::anew_residual:
      return State::beta;
    case State::beta:
      return State::direction;
    case State::copy:
    case State::idle:
      break;
  }
  return State::idle;
}

void PhaseEngine::advance() {
  const State following = next();
  if (following == State::idle) {
    state_ = State::idle;
    copy_x();
    done_.notify(sc_core::SC_ZERO_TIME);
    return;
  }
  if (following == State::product) ++loop_;
  hold(following);
}

void PhaseEngine::hold(State state, const sc_core::sc_time& after) {
  const auto phase = [&]() -> EnginePhase {
    const std::int64_t division = architecture_.division(settings_);
    switch (state) {
      case State::guess:
      case State::first_direction:
        return {phases_.writing_direction, kVectorsAndDirection};
      case State::start_residual:
        return {phases_.vectors, kVectors};
      case State::product:
      case State::start_product:
      case State::anew_product:
        return {phases_.products.clocks[product_], kProduct};
      case State::alpha:
      case State::beta:
        return {division, kDivider};
      case State::update:
        return {replaces() ? phases_.moving_direction : phases_.reading_direction,
                kVectorsAndDirection};
      case State::anew_residual:
      case State::direction:
        return {phases_.moving_direction, kVectorsAndDirection};
      case State::copy:
      case State::idle:
        break;
    }
    return {};
  }();
  state_ = state;
  if (phase.units == kProduct) product_ = phases_.products.after(product_);
  std::int64_t begin = clock_;  // what it needs is there
  for (std::size_t u = 0; u < free_at_.size(); ++u) {
    if ((phase.units >> u & 1U) != 0) begin = std::max(begin, free_at_[u]);
  }
  const std::int64_t end = begin + phase.clocks;
  for (std::size_t u = 0; u < free_at_.size(); ++u) {
    if ((phase.units >> u & 1U) == 0) continue;
    free_at_[u] = end;
    held_[u] += phase.clocks;
  }
  if (phase_begun) phase_begun(state);
  over_.notify(after + static_cast<double>(end - clock_) * period_);
  state_clocks_[static_cast<std::size_t>(state)] += end - clock_;
  clock_ = end;
}

}  // namespace hvp::vp::engine
