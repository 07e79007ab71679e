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
  if (given(field::kControlReset) || given(field::kControlLoadDone)) return Step::set_up;
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
                        between(offset, Register::dma_list_low, Register::dma_record_high);
  const bool matrix = in(Aperture::row_begin, offset) || in(Aperture::column, offset) ||
                      in(Aperture::value, offset);
  return settings || matrix ? Step::set_up : Step::other;
}

void JobFrames::before(Step step) {
  const bool is_open = tag_.frame >= 0;
  if (step == Step::set_up) {
    if (is_open) close();
    woke_ = -1;  // for this
    return;
  }
  const bool next_job = step != Step::other && (!is_open || started_);
  if (next_job) {
    if (is_open) close();
    open();
  }
  if (tag_.frame < 0) {
    woke_ = -1;  // it waited for a matrix
    return;
  }
  if (const auto waited = follow_the_board()) account_for_host(*waited);
  account_for_host(Phase::driver);
  started_ = started_ || step == Step::start;
}

void JobFrames::open() {
  born_ = woke_ > born_ ? woke_ : now_ps();
  if (!session_.begun) {
    session_.begin = born_;
    session_.begun = true;
    ledger_.begin();
  }
  tag_ = {next_++, kBirth};
  heard_ = {};
  started_ = false;
  followed_ = false;
  Frame& frame = ledger_.open(tag_.frame, born_);
  frame.time = born_ - session_.begin;
}

// A frame has a span at least. Where the host made no access after its job's end, as one that finds
// everything in its own memory, the frame ends when the host heard of it.
void JobFrames::close() {
  follow_the_board();
  // The host has gone on without it, whatever its driver calls that.
  if (started_ && !followed_) ledger_.frame(tag_.frame).status = HVP_ERROR_TIMEOUT;
  if (tag_.cause == kBirth) {
    ledger_.extend(tag_, Part::host, Phase::driver, now_ps(), now_ps());
  }
  ledger_.force_at_motor(tag_);
  ledger_.work_done(tag_.frame, last_end());
  ledger_.close(tag_.frame);
  tag_ = {};
}

void JobFrames::finish() {
  if (tag_.frame >= 0) {
    follow_the_board();
    if (followed_) close();
  }
  ledger_.finish();
}

Picoseconds JobFrames::last_end() const {
  const Frame& frame = ledger_.frame(tag_.frame);
  return tag_.cause == kBirth ? frame.born : frame.spans[static_cast<std::size_t>(tag_.cause)].end;
}

// Once a job: whether the host could know of its end, and how. From there the frame waited for the
// board, not for the host's looks or sleep before.
std::optional<Phase> JobFrames::follow_the_board() {
  if (!started_ || followed_) return std::nullopt;
  if (heard_.frame == tag_.frame) {
    followed_ = true;
    tag_.cause = heard_.cause;
    return Phase::interrupt;
  }
  if (job_end_ != nullptr && job_end_->tag.frame == tag_.frame && job_end_->time <= now_ps()) {
    followed_ = true;
    tag_.cause = job_end_->tag.cause;
    return Phase::polling;
  }
  return std::nullopt;
}

void JobFrames::account_for_host(Phase phase) {
  const Picoseconds since = last_end();
  if (now_ps() > since) ledger_.extend(tag_, Part::host, phase, since, now_ps());
}

}  // namespace hvp::vp
