#include "vp/function/job_frames.h"

#include <algorithm>
#include <cstring>

namespace hvp::vp {

namespace {

bool in(Aperture aperture, std::uint64_t offset) {
  const ApertureInfo& info = kApertures[static_cast<std::size_t>(aperture)];
  return offset >= info.offset && offset - info.offset < info.size;
}

bool between(std::uint64_t offset, Register first, Register last) {
  return offset >= offset_of(first) && offset <= offset_of(last);
}

Step step_of_command(std::uint32_t commands) {
  const auto given = [commands](Field command) { return (commands & command.mask()) != 0; };
  for (const Field command : {field::kControlReset, field::kControlLoadDone,
                              field::kControlUpdateValues, field::kControlFetchValues}) {
    if (given(command)) return Step::set_up;
  }
  if (given(field::kControlStart) || given(field::kControlRunList)) return Step::start;
  return given(field::kControlUpdateNode) ? Step::prepare : Step::other;
}

}  // namespace

Step step_of(Command command, std::uint64_t offset, std::span<const std::uint8_t> data) {
  if (command == Command::read) return Step::other;
  if (offset == offset_of(Register::control)) {
    std::uint32_t commands = 0;
    std::memcpy(&commands, data.data(), std::min(data.size(), sizeof commands));
    return step_of_command(commands);
  }
  if (in(Aperture::b, offset) || in(Aperture::row, offset)) return Step::prepare;
  if (between(offset, Register::update_node, Register::update_blocks)) return Step::prepare;
  const bool settings = between(offset, Register::method, Register::packing) ||
                        between(offset, Register::dma_list_low, Register::dma_values_count);
  const bool matrix = in(Aperture::row_begin, offset) || in(Aperture::column, offset) ||
                      in(Aperture::value, offset);
  return settings || matrix ? Step::set_up : Step::other;
}

bool JobFrames::Ahead::follow(Step step) {
  if (step == Step::set_up) is_open = false;
  const bool begins = (step == Step::prepare || step == Step::start) && (!is_open || started);
  if (begins) {
    is_open = true;
    started = false;
    ++next;
  }
  if (step == Step::start) started = true;
  return begins;
}

Step JobFrames::step_now(Command command, std::uint64_t offset,
                         std::span<const std::uint8_t> data) const {
  const Step step = step_of(command, offset, data);
  return step != Step::set_up && refuses_a_job() ? Step::other : step;
}

void JobFrames::before(Command command, std::uint64_t offset, std::span<const std::uint8_t> data) {
  const Step step = step_now(command, offset, data);
  acknowledges_ = command == Command::write && offset == offset_of(Register::interrupt_status);
  if (acknowledges_ && lost_acknowledgement_ && tag_.frame >= 0) {
    ledger_.frame(tag_.frame).status = HVP_OK;
    lost_acknowledgement_ = false;
  }
  const bool is_open = tag_.frame >= 0;
  if (step == Step::set_up) {
    if (is_open) close(true);
    woke_ = -1;  // for this
    return;
  }
  if (ahead().follow(step)) {
    if (is_open) close(false);
    open();
  }
  if (tag_.frame < 0) {
    woke_ = -1;  // it waited for a matrix
    return;
  }
  if (const auto waited = follow_the_board()) account_for_host(*waited, now_ps());
  account_for_host(Phase::driver, now_ps());
  if (step != Step::start) return;
  started_ = true;
  std::uint32_t commands = 0;
  std::memcpy(&commands, data.data(), std::min(data.size(), sizeof commands));
  listed_ = (commands & field::kControlRunList.mask()) != 0;
}

void JobFrames::open() {
  born_ = woke_ > born_ && woke_ >= ended_ ? woke_ : now_ps();
  if (!session_.begun) {
    session_.begin = born_;
    session_.begun = true;
    ledger_.begin();
  }
  tag_ = {next_++, kBirth};
  heard_ = {};
  started_ = false;
  followed_ = false;
  listed_ = false;
  busy_ = false;
  lost_acknowledgement_ = false;
  Frame& frame = ledger_.open(tag_.frame, born_);
  frame.time = born_ - session_.begin;
}

// What is known of the job's end without a further access.
void JobFrames::settle() {
  if (heard()) {
    follow_the_board();
  } else if (listed_ && ended() && ran_ >= job_end_->time) {
    if (const auto waited = follow_the_board()) account_for_host(*waited, ran_);
  }
}

// A frame has a span at least. Where the host made no access after its job's end, as one that finds
// everything in its own memory, the frame ends when the host heard of it.
void JobFrames::close(bool may_have_given_up) {
  if (!(may_have_given_up && busy_)) settle();
  // The host has gone on without it, whatever its driver calls that.
  if (started_ && !followed_) {
    told(HVP_ERROR_TIMEOUT);
    account_for_host(Phase::driver, now_ps());
  }
  if (tag_.cause == kBirth) {
    ledger_.extend(tag_, Part::host, Phase::driver, now_ps(), now_ps());
  }
  ledger_.force_at_motor(tag_);
  ended_ = last_end();
  ledger_.work_done(tag_.frame, ended_);
  ledger_.close(tag_.frame);
  tag_ = {};
}

void JobFrames::looked() {
  if (tag_.frame < 0 || !listed_ || heard()) return;
  if (const auto waited = follow_the_board()) account_for_host(*waited, now_ps());
}

void JobFrames::answered(std::uint64_t offset, std::span<const std::uint8_t> data) {
  constexpr std::uint64_t kAt = offset_of(Register::status);
  if (tag_.frame < 0 || offset > kAt || offset + data.size() < kAt + 4) return;
  std::uint32_t status = 0;
  std::memcpy(&status, &data[kAt - offset], sizeof status);
  busy_ = started_ && status != ~std::uint32_t{0} && (status & field::kStatusBusy.mask()) != 0;
  if (status == ~std::uint32_t{0}) {
    told(HVP_ERROR_BUS);
  } else if ((status & field::kStatusError.mask()) != 0) {
    told(hvp_status_of_board((status & field::kStatusErrorCode.mask()) >>
                             field::kStatusErrorCode.low));
  } else if (started_ && (status & field::kStatusDone.mask()) != 0 &&
             (status & field::kStatusBusy.mask()) == 0 && !ended()) {
    told(HVP_ERROR_STALE_RESULT);  // the board never saw the start
  }
}

void JobFrames::told_by_bus(hvp_status status) {
  lost_acknowledgement_ =
      acknowledges_ && tag_.frame >= 0 && followed_ && ledger_.frame(tag_.frame).status == HVP_OK;
  told(status);
}

void JobFrames::told(hvp_status status) {
  if (tag_.frame < 0) return;
  Frame& frame = ledger_.frame(tag_.frame);
  if (frame.status == HVP_OK) frame.status = status;
}

void JobFrames::board_was_reset() {
  if (tag_.frame >= 0) close(true);
}

void JobFrames::finish(bool given_up) {
  if (tag_.frame >= 0 && (!stopped_ || tag_.frame == known_)) {
    if (!busy_) settle();
    const bool failed = ledger_.frame(tag_.frame).status != HVP_OK;
    if (followed_ || (started_ && (given_up || failed))) close(true);
  }
  ledger_.finish();
}

Picoseconds JobFrames::last_end() const { return ledger_.end_of(tag_); }

// Once a job: whether the host could know of its end, and how. From there the frame waited for the
// board, not for the host's looks or sleep before.
std::optional<Phase> JobFrames::follow_the_board() {
  if (!started_ || followed_) return std::nullopt;
  if (!heard() && !(ended() && job_end_->time <= now_ps())) return std::nullopt;
  followed_ = true;
  if (ended()) told(job_end_->status);
  tag_.cause = heard() ? heard_.cause : job_end_->tag.cause;
  return heard() ? Phase::interrupt : Phase::polling;
}

void JobFrames::account_for_host(Phase phase, Picoseconds until) {
  const Picoseconds since = last_end();
  if (until > since) ledger_.extend(tag_, Part::host, phase, since, until);
}

}  // namespace hvp::vp
