#include "vp/host/board_solver.h"

#include <algorithm>

#include "models/stability/flag.h"
#include "vp/host/driver_config.h"

namespace hvp::vp {

namespace {
bool contains(std::span<const int> ascending, int node) {
  return std::binary_search(ascending.begin(), ascending.end(), node);
}
}  // namespace

std::size_t renewed_entries(const host::FrameComputation& computation) {
  const bool renewed = computation.has_board() && computation.renewals() != nullptr;
  return renewed ? computation.board().matrix().value.size() : 0;
}

BoardSolver::BoardSolver(const fixed::Settings& settings, host::FrameComputation& computation,
                         const DriverPort& port, const Work& work, bool reject_saturated,
                         HostMemory* memory)
    : settings_(settings),
      computation_(computation),
      port_(port),
      work_(work),
      reject_saturated_(reject_saturated),
      phase_(computation.refined() != nullptr ? Phase::refinement : Phase::form_rhs),
      b_(computation.displacement().size()),
      u_(computation.displacement().size()) {
  scratch_.resize(std::max<std::size_t>(HVP_MIN_SCRATCH_WORDS, b_.size()));
  const Transfer& transfer = port.transfer();
  if (memory == nullptr || transfer.method != Transfer::Method::dma) return;
  dma_.emplace(*memory, transfer.engine(),
               DmaBytes::of(transfer, settings, b_.size(), renewed_entries(computation)));
}

hvp_status BoardSolver::set_up_piece(bool& done) {
  bool complete = true;
  const hvp_status status = make(next_, complete);
  done = status == HVP_OK && next_ == Piece::guess;
  if (status != HVP_OK || done) {
    next_ = Piece::open;
  } else if (complete) {
    next_ = static_cast<Piece>(static_cast<int>(next_) + 1);
  }
  return status;
}

hvp_status BoardSolver::make(Piece piece, bool& complete) {
  switch (piece) {
    case Piece::open:
      seen_ = {};
      return open();
    case Piece::configure:
      return configure();
    case Piece::begin_load: {
      const fixed::QuantisedMatrix& k = computation_.board().matrix();
      matrix_ = {static_cast<std::uint32_t>(k.block_rows()),
                 static_cast<std::uint32_t>(k.column.size()), k.row_begin.data(), k.column.data(),
                 k.value.data()};
      revision_ = computation_.revision();
      return hvp_begin_load(&device_, &load_, &matrix_);
    }
    case Piece::load:
      return hvp_continue_load(&device_, &load_, &complete);
    case Piece::end_load: {
      const hvp_status status = hvp_end_load(&device_, &load_);
      if (status == HVP_OK && observer_ != nullptr) observer_->loaded(matrix_);
      return status;
    }
    case Piece::guess:
      // Whatever the board had been told of a contact went with its matrix.
      computation_.set_contact({});
      return write_guess();
  }
  return HVP_ERROR_STATE;
}

hvp_status BoardSolver::open() {
  const hvp_status status = hvp_open(&device_, &port_.bus(), scratch_.data(), scratch_.size());
  return status == HVP_OK && dma_ ? hvp_use_dma(&device_, &dma_->dma()) : status;
}

hvp_status BoardSolver::configure() {
  hvp_solver_config config = driver_config(settings_);
  config.reject_saturated = reject_saturated_;
  config.one_a_word = !port_.transfer().packed;
  const hvp_status status = hvp_configure(&device_, &config);
  if (status == HVP_OK && observer_ != nullptr) observer_->configured(config);
  return status;
}

// The board's next job starts from the last solution that was used.
hvp_status BoardSolver::write_guess() {
  guess_is_stale_ = false;
  if (settings_.start == fixed::Start::zero) return HVP_OK;
  computation_.board().scaling().displacement_words(computation_.displacement(), u_);
  const hvp_status status = hvp_write_initial_guess(&device_, u_.data(), u_.size());
  if (status == HVP_OK && observer_ != nullptr) observer_->guessed(u_);
  return status;
}

// Nodes that were let go get their rows back before others are taken, so that the board's matrix
// is K but for the rows and columns of `nodes`.
hvp_status BoardSolver::move_contact(std::span<const int> nodes) {
  const std::span<const int> present = computation_.contact();
  hvp_status status = HVP_OK;
  for (const int node : present) {
    if (contains(nodes, node) || status != HVP_OK) continue;
    status = restore_node(node, nodes);
  }
  for (const int node : nodes) {
    if (contains(present, node) || status != HVP_OK) continue;
    status = hvp_constrain_node(&device_, static_cast<std::uint32_t>(node),
                                computation_.board().diagonal_word());
    if (status != HVP_OK || observer_ == nullptr) continue;
    observer_->constrained(static_cast<std::uint32_t>(node), computation_.board().diagonal_word());
  }
  computation_.set_contact(nodes);
  return status;
}

// The board must be told zeros towards nodes that are still cleared there: those that stay in
// contact, and those whose turn comes later, which bring the blocks back by symmetry.
hvp_status BoardSolver::restore_node(int node, std::span<const int> nodes) {
  const fixed::QuantisedMatrix& k = computation_.board().matrix();
  const std::span<const std::int32_t> row = k.row(node);
  row_.assign(row.begin(), row.end());
  const auto first = static_cast<std::size_t>(k.row_begin[static_cast<std::size_t>(node)]);
  for (std::size_t i = 0; i < row_.size() / 9; ++i) {
    const int other = k.column[first + i];
    if (contains(computation_.contact(), other) && (contains(nodes, other) || other > node)) {
      std::fill_n(row_.begin() + static_cast<std::ptrdiff_t>(9 * i), 9, 0);
    }
  }
  const auto number = static_cast<std::uint32_t>(node);
  const hvp_status status =
      hvp_restore_node(&device_, number, row_.data(), static_cast<std::uint32_t>(row_.size() / 9));
  if (status == HVP_OK && observer_ != nullptr) observer_->restored(number, row_);
  return status;
}

// Forms the board's next system, in the time that this takes the host.
bool BoardSolver::next() {
  host::FrameMethod& method = computation_.method();
  const bool more = method.next(b_);
  const double operations = method.next_operations();
  if (operations > 0) work_.spend(phase_, 0, operations);
  return more;
}

hvp_status BoardSolver::begin(std::uint32_t& flags) {
  computation_.begin();
  return start_first(flags);
}

hvp_status BoardSolver::go_on(double way, std::uint32_t& flags) {
  computation_.go_on(way);
  return start_first(flags);
}

hvp_status BoardSolver::start_first(std::uint32_t& flags) {
  const std::int64_t counted = computation_.method().clamped();
  waits_for_board_ = next();
  flags |= computation_.method().flags().bits();
  clamped_words_ += computation_.method().clamped() - counted;
  const hvp_status status = waits_for_board_ ? start() : HVP_OK;
  if (status != HVP_OK) computation_.method().abandon();
  return status;
}

// One pass, or as many as the method makes: each needs the one before.
hvp_status BoardSolver::end(std::uint32_t& flags) {
  host::FrameMethod& method = computation_.method();
  const std::int64_t counted = method.clamped();
  while (waits_for_board_) {
    hvp_status status = receive();
    if (status == HVP_OK) {
      method.accept(u_, stability::Flags(hvp_last_flags(&device_)));
      waits_for_board_ = next();
      if (waits_for_board_) status = start();
    }
    if (status != HVP_OK) {
      method.abandon();
      return status;
    }
  }
  flags |= method.flags().bits();
  clamped_words_ += method.clamped() - counted;
  return HVP_OK;
}

// The remaining residual is known when the next frame's product is formed, after the force.
void BoardSolver::finish(std::uint32_t& flags) {
  host::FrameMethod& method = computation_.method();
  method.finish();
  const double operations = method.finish_operations();
  if (operations > 0) work_.spend(phase_, 0, operations);
  flags |= method.flags().bits();
}

// The board has its pattern and its contact; the values alone go there.
hvp_status BoardSolver::renew() {
  if (revision_ == computation_.revision()) return HVP_OK;
  const std::span<const std::int32_t> values = computation_.board().matrix().value;
  work_.spend(Phase::load_values, work_.costs().driver_s(values.size()));
  const auto timeout_ns = static_cast<std::uint64_t>(1e9 * work_.costs().timeout_s);
  const hvp_status status = hvp_update_values(&device_, values.data(), values.size(), timeout_ns);
  if (status != HVP_OK) return status;
  revision_ = computation_.revision();
  if (observer_ != nullptr) observer_->renewed(values);
  return HVP_OK;
}

hvp_status BoardSolver::start() {
  work_.spend(Phase::driver, work_.costs().driver_s(b_.size()));
  if (guess_is_stale_) {
    const hvp_status status = write_guess();
    if (status != HVP_OK) return status;
  }
  if (observer_ != nullptr) observer_->started(b_);
  const hvp_status status = hvp_write_rhs(&device_, b_.data(), b_.size());
  return status == HVP_OK ? hvp_start(&device_) : status;
}

hvp_status BoardSolver::receive() {
  hvp_status status = wait();
  // The job left a U that is not to be used, nor to be started from.
  if (status == HVP_ERROR_SATURATED) guess_is_stale_ = true;
  if (status != HVP_OK) return status;
  work_.spend(Phase::driver, work_.costs().driver_s(u_.size()));
  status = read();
  if (status == HVP_OK && observer_ != nullptr) observer_->solved(u_, hvp_last_flags(&device_));
  return status;
}

// STATUS that nobody answered is read again.
hvp_status BoardSolver::wait() {
  const Picoseconds end = work_.now() + to_picoseconds(work_.costs().timeout_s);
  hvp_status status = HVP_OK;
  int tries = 0;
  do {
    const Picoseconds left = std::max<Picoseconds>(0, end - work_.now());
    status = hvp_wait(&device_, static_cast<std::uint64_t>(left / 1000));
  } while (status == HVP_ERROR_BUS && try_again(status, tries, 0));
  const hvp_statistics now = hvp_statistics_of(&device_);
  mended_.lost_interrupts += static_cast<int>(now.lost_interrupts - seen_.lost_interrupts);
  note_unacknowledged(static_cast<int>(now.lost_acknowledgements - seen_.lost_acknowledgements));
  seen_ = now;
  return status;
}

// The driver does not know frames. The first that a wait finds is the acknowledgement of the job
// before, whose DONE still stands; each further one, the repetition that was lost again. With DMA
// the bridge tells of the job's own.
void BoardSolver::note_unacknowledged(int lost) {
  const std::int64_t frame = work_.tag().frame;
  const std::int64_t before = std::exchange(acknowledged_frame_, frame);
  if (lost == 0) return;
  mended_.lost_acknowledgements += lost;
  if (dma_ || lost > 1 || before == frame) mended_.unacknowledged_here = frame;
  if (!dma_ && before != frame) mended_.unacknowledged_before = before;
}

// The board still has U when it did not arrive whole.
hvp_status BoardSolver::read() {
  for (int tries = 0;;) {
    const Picoseconds began = work_.now();
    const hvp_status status = hvp_read_solution(&device_, u_.data(), u_.size());
    if (status != HVP_ERROR_BUS && status != HVP_ERROR_DATA) return status;
    if (!try_again(status, tries, work_.now() - began)) return status;
  }
}

bool BoardSolver::try_again(hvp_status status, int& tries, Picoseconds took) {
  if (tries == work_.costs().recovery.retries || work_.now() + took > deadline_) return false;
  ++tries;
  ++(status == HVP_ERROR_DATA ? mended_.damaged : mended_.aborted);
  return true;
}

}  // namespace hvp::vp
