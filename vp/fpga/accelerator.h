#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <systemc>
#include <utility>

#include <tlm_utils/simple_target_socket.h>

#include "models/accel/architecture.h"
#include "models/accel/cycles.h"
#include "models/fixed/solver.h"
#include "vp/fault/fault_plan.h"
#include "vp/fidelity.h"
#include "vp/fpga/board_matrix.h"
#include "vp/fpga/dma_engine.h"
#include "vp/fpga/register_bank.h"
#include "vp/fpga/timing/job_timing.h"
#include "vp/frame/frame_tag.h"
#include "vp/frame/ledger.h"

namespace hvp::vp {

// Sees every access of the board's BAR, legal or not, when it happens.
class AccessObserver {
 public:
  virtual ~AccessObserver() = default;
  // `data` is what was written or read.
  virtual void access(Picoseconds time, Command command, const RegisterBank& bank,
                      const AccessResult& outcome, std::uint64_t offset,
                      std::span<const std::uint8_t> data) = 0;
};

// When a job had ended, as far as the host can see, and the tag that ends there.
struct JobEnd {
  Tag tag;
  Picoseconds time = -1;
};

// A solve as an engine took it.
struct EngineSolve : SolveClocks {
  accel::SolveWork work;
};

// The solver board (thesis chapter 5, §6.2.1) behind its register bank. The words of a job are
// those of fixed::Solver. How many iterations it makes is known only when it has been computed, so
// that this happens when it starts; U, the results and the interrupt appear when its last clock is
// over, and a reset before that discards them. docs/registers.md is what software sees.
//
// How long a job takes is up to a JobTiming: the closed form, an engine phase by phase, or one of
// every clock, which does the work beside; words of its that are not the solver's are an internal
// fault.
//
// Timing only, a job makes all its iterations and no words: U stays as it was. Throws InputError
// with the key "numbers" where the engine makes the words, cycle-accurate.
class Accelerator : public sc_core::sc_module, private ListOwner {
 public:
  // `master`: whether the board is one, and what for.
  Accelerator(const sc_core::sc_module_name& name, const accel::Architecture& architecture,
              Timing level, Ledger& ledger, AccessObserver* observer = nullptr,
              Numbers numbers = Numbers::fixed, const MasterSettings& master = {});
  // Throws InputError with the key "method" where a level does not have it.
  static void require_supported(Timing level, const fixed::Settings& settings);

  tlm_utils::simple_target_socket<Accelerator> from_bus;
  sc_core::sc_port<InterruptIf, 1, sc_core::SC_ZERO_OR_MORE_BOUND> interrupt;

  // Null where the board is no master; its socket to_memory is the board's.
  DmaEngine* dma() { return dma_.get(); }
  // Of the last job that ended, for a host that finds out by looking.
  const JobEnd& job_end() const { return job_end_; }
  // A board whose host decides whether its interrupts are messages: asked when one is to be raised.
  // Where not, the line is.
  void messages_if(std::function<bool()> enabled) { messages_enabled_ = std::move(enabled); }
  // As after power-on, by itself: no software asked for it.
  void power_on();
  // Faults of the board's own happen as the plan says, from now on.
  void inject(FaultPlan& plan);

  const RegisterBank& bank() const { return bank_; }
  // The interrupt request; a reference, for whoever traces it.
  const bool& line_up() const { return line_up_; }
  std::int64_t illegal_accesses() const { return illegal_accesses_; }
  // Of all jobs.
  std::int64_t saturations() const { return saturations_; }
  std::int64_t wraps() const { return wraps_; }
  std::int64_t breakdowns() const { return breakdowns_; }
  // Cycle-accurate; null elsewhere.
  const engine::CycleEngine* engine() const { return timing_->engine(); }
  // The frame whose job or update was commanded last, -1 before the first.
  std::int64_t frame() const { return frame_; }
  // At the levels that have an engine: of all finished jobs the one that took most clocks.
  const std::optional<EngineSolve>& longest_solve() const { return longest_solve_; }
  // Of the last finished job.
  const fixed::Report& report() const { return report_; }

 private:
  enum class Running { nothing, solve, load };

  void b_transport(tlm::tlm_generic_payload& transaction, sc_core::sc_time& delay);
  void control(std::uint32_t commands);
  bool may_start();
  void start();
  void run_list();
  BoardError check_list() const;
  // ListOwner
  void solve_listed(const Tag& tag) override;
  CompletionRecord completion(const BoardError& error, const ListBytes& moved) const override;
  void list_ended(const BoardError& error, const Tag& tag) override;
  void load_done();
  void update_node();
  void reset();
  void finish();

  void begin(Running what, const Tag& tag);
  void end_after(std::optional<std::int64_t> clocks);
  void begin_solve(const Tag& tag);
  void end_job(const BoardError& error);
  void take_engine_words();
  bool one_a_word() const { return bank_.get(field::kPackingMode) != 0; }
  bool load_memories(const fixed::Settings& settings);
  void give_x();
  bool change_row(int node);
  void hold_access(std::int64_t clocks);
  bool strikes(FaultKind kind) {
    return faults_ != nullptr && faults_->strike(kind, frame_) != nullptr;
  }
  bool supported(const fixed::Settings& settings);
  void form_guess(fixed::Start start);
  void require_solver(const fixed::Settings& settings);
  void compute();
  void publish();
  void raise(BoardError error);
  void mirror_status();
  // `tag`: the work that the line goes up for, if it does.
  void drive_interrupt_line(const Tag& tag);

  Picoseconds clock_period_;  // 0: untimed
  Timing level_;
  Numbers numbers_;
  Ledger& ledger_;
  AccessObserver* observer_;
  FaultPlan* faults_ = nullptr;

  RegisterBank bank_;
  fixed::QuantisedMatrix matrix_;
  fixed::Method loaded_method_ = fixed::Method::cg;
  // The solver never starts from zero or forms a guess itself: form_guess() has done it.
  fixed::Settings solver_settings_;
  std::unique_ptr<fixed::Solver> solver_;  // for these settings and the loaded matrix
  std::vector<std::int32_t> row_;          // of a node that gets it back

  // Of the job that runs.
  fixed::Settings settings_;
  std::vector<std::int32_t> b_;
  std::vector<std::int32_t> u_;
  fixed::Report result_;
  bool fault_ = false;

  // For StartMode::extrapolated: U before the last job, where that had this mode too and nobody
  // has written to U since.
  std::vector<std::int32_t> previous_u_;
  bool has_previous_u_ = false;

  fixed::Report report_;  // of the last finished job

  std::unique_ptr<JobTiming> timing_;
  std::vector<std::int32_t> written_x_;
  std::optional<EngineSolve> longest_solve_;

  std::unique_ptr<DmaEngine> dma_;
  bool listed_ = false;  // the job is a list's
  JobEnd job_end_;

  Running running_ = Running::nothing;
  sc_core::sc_event done_;
  std::int64_t clocks_ = 0;
  Picoseconds started_ = 0;
  Tag job_tag_;
  std::int64_t frame_ = -1;
  // The transaction that gives a command: whose frame it is, and how long it is held up.
  Tag* commanding_tag_ = nullptr;
  Picoseconds wait_states_ = 0;
  bool line_up_ = false;
  std::function<bool()> messages_enabled_;
  std::int64_t illegal_accesses_ = 0;
  std::int64_t saturations_ = 0;
  std::int64_t wraps_ = 0;
  std::int64_t breakdowns_ = 0;
};

}  // namespace hvp::vp
