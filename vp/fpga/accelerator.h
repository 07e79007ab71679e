#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <systemc>
#include <tlm>
#include <utility>

#include <tlm_utils/simple_target_socket.h>

#include "models/accel/architecture.h"
#include "models/accel/cycles.h"
#include "models/fixed/solver.h"
#include "vp/fault/fault_plan.h"
#include "vp/fidelity.h"
#include "vp/fpga/board_registers.h"
#include "vp/fpga/dma_engine.h"
#include "vp/fpga/job_timing.h"
#include "vp/fpga/register_bank.h"
#include "vp/frame/frame_tag.h"
#include "vp/frame/ledger.h"

namespace hvp::vp {

// The end of a job as the host can observe it, and the tag that ends there.
struct JobEnd {
  Tag tag;
  Picoseconds time = -1;
  // What the board's words about the job mean to a driver.
  hvp_status status = HVP_OK;
};

// The clocks of a solve and the work that they were for.
struct EngineSolve : SolveClocks {
  accel::SolveWork work;
};

// The solver board (thesis chapter 5, §6.2.1) behind its register bank. The words of a job are
// those of fixed::Solver. Its number of iterations is known only after its computation, so it is
// computed when it starts; U, the results and the interrupt appear after its last clock, and a
// reset before discards them. docs/registers.md describes the board as software sees it.
//
// A JobTiming determines the duration of a job: the closed form, an engine phase by phase, or an
// engine with every clock, which computes the words too; words that differ from the solver's are an
// internal fault.
//
// With timing only, a job makes all its iterations and no words, and U does not change. Throws
// InputError with the key "numbers" for this at the cycle-accurate level, where the engine makes
// the words.
class Accelerator : public sc_core::sc_module, private ListOwner {
 public:
  // `master` are the board's functions as bus master.
  Accelerator(const sc_core::sc_module_name& name, const accel::Architecture& architecture,
              Timing level, Ledger& ledger, AccessObserver* observer = nullptr,
              Numbers numbers = Numbers::fixed, const MasterSettings& master = {});
  // Throws InputError with the key "method" if the level does not support it.
  static void require_supported(Timing level, const fixed::Settings& settings);

  tlm_utils::simple_target_socket<Accelerator> from_bus;
  sc_core::sc_port<InterruptIf, 1, sc_core::SC_ZERO_OR_MORE_BOUND> interrupt;

  // Null if the board is not a bus master. Its socket to_memory is the board's.
  DmaEngine* dma() { return dma_.get(); }
  // The end of the last job, for a host that polls.
  const JobEnd& job_end() const { return job_end_; }
  // `enabled` is asked when an interrupt is to be raised and returns whether the host takes it as a
  // message; if not, the board raises the line.
  void messages_if(std::function<bool()> enabled) { messages_enabled_ = std::move(enabled); }
  // Returns to the state after power-on without a request by software.
  void power_on();
  // Makes the board's own faults happen as planned, and lets what comes from the bus pass `wire`,
  // from now on. `link` is the board's; null on PCI. Keeps a reference to the plan.
  using Transport = std::function<void(tlm::tlm_generic_payload&, sc_core::sc_time&)>;
  void inject(FaultPlan& plan, Transport wire, const link::Pcie* link);
  // The end of that wire at the board.
  Transport behind();

  const RegisterBank& bank() const { return bank_; }
  // The state of the interrupt line, as a reference for a tracer.
  const bool& line_up() const { return line_up_; }
  std::int64_t illegal_accesses() const { return illegal_accesses_; }
  // The sums over all jobs.
  std::int64_t saturations() const { return saturations_; }
  std::int64_t wraps() const { return wraps_; }
  std::int64_t breakdowns() const { return breakdowns_; }
  // The cycle-accurate engine; null at other levels.
  const engine::CycleEngine* engine() const { return timing_->engine(); }
  // From now on; only the level rtl has such a port.
  void record_port(const EnginePortSink& record) { timing_->record_port(record); }
  // What the level rtl has compared; empty at other levels.
  std::optional<rtl::Compared> compared() const { return timing_->compared(); }
  std::string difference() const { return timing_->difference(); }
  // A waveform of the RTL engine, as JobTiming says.
  bool open_rtl_waveform(const std::string& path, const engine::TraceWindow& window) {
    return timing_->open_rtl_waveform(path, window);
  }
  void close_rtl_waveform() { timing_->close_rtl_waveform(); }
  // The frame whose job or update was commanded last, -1 before the first.
  std::int64_t frame() const { return frame_; }
  // The finished job that took most clocks, at the levels with an engine.
  const std::optional<EngineSolve>& longest_solve() const { return longest_solve_; }
  // The last finished job's.
  const fixed::Report& report() const { return report_; }

 private:
  enum class Running { nothing, solve, load, update };

  void b_transport(tlm::tlm_generic_payload& transaction, sc_core::sc_time& delay);
  void answer(tlm::tlm_generic_payload& transaction, sc_core::sc_time& delay);
  void control(std::uint32_t commands);
  bool may_start();
  void start();
  void run_list();
  BoardError check_list() const;
  // ListOwner
  void solve_listed(const Tag& tag) override;
  CompletionRecord completion(const BoardError& error, const ListBytes& moved) const override;
  void list_ended(const BoardError& error, bool whole, const Tag& tag) override;
  void values_fetched(const BoardError& error, const Tag& tag) override;
  void forget_matrix();
  void load_done();
  bool may_renew(fixed::Settings& settings);
  void update_values();
  void fetch_values();
  void renew(const fixed::Settings& settings, const Tag& tag);
  void update_node();
  void reset();
  void finish();

  void begin(Running what, const Tag& tag);
  void end_after(std::optional<std::int64_t> clocks);
  void begin_solve(const Tag& tag);
  void end_job(const BoardError& error, bool whole = true);
  void take_engine_words();
  bool one_a_word() const { return bank_.get(field::kPackingMode) != 0; }
  bool load_memories(const fixed::Settings& settings);
  void give_x();
  bool change_row(int node);
  void hold_access(std::int64_t clocks);
  bool strikes(FaultKind kind) {
    return faults_ != nullptr && faults_->strike(kind, frame_) != nullptr;
  }
  // Bits that flip (accelerator_flip.cpp).
  void plan_flips();
  void expect_flips();
  void await_flip();
  // The memories are filled anew.
  void forget_flips() {
    flipped_ = nullptr;
    unread_flip_.reset();
  }
  bool complete(engine::Flip& flip, const Fault& fault);
  void make_flips();
  void flip_bit(const engine::Flip& flip);
  void note_read(std::uint64_t offset, std::size_t bytes);
  void note_wrong(double error);
  void take_flipped_words();
  bool supported(const fixed::Settings& settings);
  void form_guess(fixed::Start start);
  void require_solver(const fixed::Settings& settings);
  void compute();
  void publish();
  void raise(BoardError error);
  void mirror_status();
  // `tag` is the work for which the line goes up, if it does.
  void drive_interrupt_line(const Tag& tag);

  accel::Architecture architecture_;
  Picoseconds clock_period_;  // 0: untimed
  Timing level_;
  Numbers numbers_;
  Ledger& ledger_;
  AccessObserver* observer_;
  FaultPlan* faults_ = nullptr;
  Transport wire_;
  struct PlannedFlip {
    Picoseconds time = 0;
    const Fault* fault = nullptr;
    engine::Flip flip;
  };
  struct PlannedFlips {
    std::deque<PlannedFlip> next;  // the next one first
    sc_core::sc_event due{"flip_due"};
  };
  std::unique_ptr<PlannedFlips> planned_flips_;  // null before the first flip
  // A word of U that has flipped behind its job and has not been read since.
  struct UnreadFlip {
    std::uint64_t offset = 0;
    double error = 0;
  };
  std::optional<UnreadFlip> unread_flip_;
  const Fault* flipped_ = nullptr;  // the newest one since the memories were filled

  RegisterBank bank_;
  fixed::QuantisedMatrix matrix_;
  fixed::Settings loaded_settings_;  // as the matrix was loaded
  // The solver's start is always U, because form_guess() has formed it.
  fixed::Settings solver_settings_;
  std::unique_ptr<fixed::Solver> solver_;  // for these settings and the loaded matrix
  std::vector<std::int32_t> row_;          // the row of a node that is restored

  // The current job's settings, vectors and results.
  fixed::Settings settings_;
  std::vector<std::int32_t> b_;
  std::vector<std::int32_t> u_;
  fixed::Report result_;
  bool fault_ = false;

  // For StartMode::extrapolated: U before the last job, if that job had this mode too and U was not
  // written since.
  std::vector<std::int32_t> previous_u_;
  bool has_previous_u_ = false;

  fixed::Report report_;  // the last finished job's

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
  // The tag of the transaction that gives a command, and the time for which the transaction is
  // stalled.
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
