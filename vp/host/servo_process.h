#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <exception>
#include <span>
#include <systemc>
#include <vector>

#include "driver/hvp_driver.h"
#include "models/collision/contact_search.h"
#include "models/collision/hand_over.h"
#include "models/fem/body.h"
#include "models/fixed/settings.h"
#include "models/host/costs.h"
#include "models/host/frame_computation.h"
#include "vp/host/board_access.h"
#include "vp/host/dispatcher.h"
#include "vp/host/exchange.h"
#include "vp/ledger.h"
#include "vp/session.h"
#include "vp/verdict.h"

namespace hvp::vp {

// What a frame came to, without any simulated time: for references, pictures and progress.
struct SolvedFrame {
  std::int64_t number;
  Picoseconds time;                      // since the servo loop began, of the frame's birth
  Eigen::Vector3d tip;                   // as read, m
  int contact_node;                      // mesh node, or −1
  std::span<const int> contact;          // active nodes that follow the tip
  Eigen::Vector3d contact_displacement;  // m
  std::span<const double> displacement;  // active nodes, m
  Eigen::Vector3d force;                 // on the body, N
};

class FrameObserver {
 public:
  virtual ~FrameObserver() = default;
  virtual void solved(const SolvedFrame& frame) = 0;
};

struct ServoSettings {
  Picoseconds period = 2'000'000'000;
  std::int64_t frames = 1000;
  host::Host costs;
  bool untimed = false;
  fixed::Settings solver;
};

// What went wrong in the servo loop that is not in the ledger.
struct ServoCounts {
  std::int64_t saturations = 0;  // in the board's solves
  std::int64_t breakdowns = 0;
  std::int64_t clamped_words = 0;  // right-hand sides and forces that did not fit
  std::int64_t driver_errors = 0;  // frames whose solve failed; the last force was held
  std::int64_t contact_changes = 0;
  std::uint32_t flags = 0;  // stability::Flags of all solves
  hvp_status last_error = HVP_OK;
};

// The servo process (thesis §6.2.2), step by step as in Fig. 6.2: read the position, fetch the
// contact node, form the modified force vector, send it, solve, receive U, form the force, write
// it, and Newmark's update after that. Each step waits for what it costs and adds its span. The
// process reaches the solver through the driver alone.
class ServoProcess : public sc_core::sc_module {
 public:
  ServoProcess(const sc_core::sc_module_name& name, const ServoSettings& settings,
               const fem::Body& body, host::FrameComputation& computation,
               const collision::ContactSearch& contacts, BoardAccess& access,
               Dispatcher& dispatcher, Exchange& exchange, Ledger& ledger, Verdict& verdict,
               Session& session);
  ~ServoProcess() override;

  void add_observer(FrameObserver& observer) { observers_.push_back(&observer); }
  // When the loop begins: other processes of the host start with it.
  sc_core::sc_event& begun() { return begun_; }
  const ServoCounts& counts() const { return counts_; }
  // What the servo loop, or somebody whom it calls, threw; null where it ran to its end.
  std::exception_ptr failure() const { return failure_; }
  // How long set-up took, loading K included.
  Picoseconds set_up_time() const { return set_up_time_; }

 private:
  void run();
  void serve();
  bool set_up();
  void release(std::int64_t number);
  void frame(std::int64_t number);
  Eigen::Vector3d read_position();
  void take_contact(const ContactReport& report, Frame& frame);
  void take_over(Picoseconds now, const Eigen::Vector3d& tip);
  hvp_status move_contact(std::span<const int> nodes);
  hvp_status find_displacement(const Eigen::Vector3d& u_c, std::uint32_t& flags);
  hvp_status refine(const Eigen::Vector3d& u_c, host::RefinedSolve& refined);
  void judge_refinement(host::RefinedSolve& refined, std::uint32_t& flags);
  hvp_status solve();
  void write_force(const Eigen::Vector3d& force);
  void spend(Phase phase, double seconds, double operations = 0);
  void note(hvp_status status);

  ServoSettings settings_;
  const fem::Body& body_;
  host::FrameComputation& computation_;
  const collision::ContactSearch& contacts_;
  BoardAccess& access_;
  Dispatcher& dispatcher_;
  Exchange& exchange_;
  Ledger& ledger_;
  Verdict& verdict_;
  Session& session_;
  std::vector<FrameObserver*> observers_;
  sc_core::sc_event begun_;

  hvp_device device_{};
  std::vector<std::uint32_t> scratch_;
  std::vector<std::int32_t> b_;
  std::vector<std::int32_t> u_;
  std::vector<std::int32_t> row_;
  std::vector<int> next_contact_;
  collision::Contact contact_;
  collision::HandOver hand_over_;
  Eigen::Vector3d held_force_ = Eigen::Vector3d::Zero();
  // For the mean force since the last report of the collision process.
  Eigen::Vector3d force_sum_ = Eigen::Vector3d::Zero();
  std::int64_t force_frames_ = 0;
  Picoseconds last_report_ = -1;
  int frames_without_words_ = 0;  // in a row, with a contact that is displaced
  ServoCounts counts_;
  std::exception_ptr failure_;
  Picoseconds set_up_time_ = 0;
};

}  // namespace hvp::vp
