#include "vp/fpga/dma_engine.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "models/time/picoseconds.h"
#include "vp/bus/host_memory.h"

namespace hvp::vp {

namespace {

constexpr std::size_t kEngineStackBytes = 1 << 18;
constexpr std::uint32_t kToHost = 1;

std::span<std::uint8_t> bytes_of(std::span<std::uint32_t> words) {
  return {reinterpret_cast<std::uint8_t*>(words.data()), 4 * words.size()};
}

}  // namespace

DmaEngine::DmaEngine(const sc_core::sc_module_name& name, const MasterSettings& settings,
                     bool untimed, RegisterBank& bank, ListOwner& owner, Ledger& ledger)
    : sc_module(name),
      to_memory("to_memory"),
      settings_(settings),
      latency_(untimed || !settings.dma ? 0 : to_picoseconds(settings.dma->engine_latency_s)),
      bank_(bank),
      owner_(owner),
      ledger_(ledger),
      work_("work") {
  payload_.set_extension(&extension_);
  payload_.set_byte_enable_ptr(nullptr);
  payload_.set_dmi_allowed(false);
  if (settings_.dma) {
    descriptors_.resize(kMaxDescriptors * kDescriptorWords);
    // Of values an outside host may have longer ones.
    const std::size_t of_values = std::min(4 * bank.memory(Aperture::value).size(),
                                           static_cast<std::size_t>(settings_.dma->segment_bytes));
    segment_.resize(std::max(
        {4 * bank.memory(Aperture::b).size(), 4 * bank.memory(Aperture::u).size(), of_values}));
  }
  SC_HAS_PROCESS(DmaEngine);
  SC_THREAD(run);
  set_stack_size(kEngineStackBytes);
}

DmaEngine::~DmaEngine() { payload_.clear_extension(&extension_); }

void DmaEngine::ring(const Tag& tag) {
  hold(rung_tag_, tag);
  rung_ = true;
  rung_for_values_ = false;
  rung_at_ = now_ps();
  work_.notify(sc_core::SC_ZERO_TIME);
}

void DmaEngine::solved(const Tag& tag, const BoardError& error) {
  tag_ = tag;
  solve_error_ = error;
  solved_ = true;
  solved_at_ = now_ps();
  work_.notify(sc_core::SC_ZERO_TIME);
}

void DmaEngine::send_message(const Tag& tag) {
  hold(message_tag_, tag);
  message_ = true;
  message_at_ = now_ps();
  work_.notify(sc_core::SC_ZERO_TIME);
}

// Spans of a transaction that is under way go nowhere from here on.
void DmaEngine::abort() {
  ++generation_;
  rung_ = false;
  solved_ = false;
  message_ = false;
  for (Tag* held : {&rung_tag_, &tag_, &message_tag_, &posted_tag_}) let_go(*held);
  work_.notify(sc_core::SC_ZERO_TIME);
}

void DmaEngine::hold(Tag& held, const Tag& tag) {
  let_go(held);
  held = tag;
  ledger_.hold(held);
}

void DmaEngine::let_go(Tag& held) {
  ledger_.unhold(held);
  held = Tag{};
}

void DmaEngine::run() {
  for (;;) {
    if (message_) {
      post_message();
    } else if (rung_) {
      rung_ = false;
      rung_for_values_ ? run_values() : run_list();
    } else {
      wait(work_);
    }
  }
}

void DmaEngine::post_message() {
  message_ = false;
  posted_tag_ = std::exchange(message_tag_, Tag{});
  if (now_ps() > message_at_) {
    ledger_.extend(posted_tag_, Part::fpga, Phase::dma_engine, message_at_, now_ps());
  }
  std::array<std::uint8_t, kMessageBytes> data{};
  transport(MasterPurpose::message, kMessageAddress, data, posted_tag_);
  let_go(posted_tag_);
}

// A reset gives the list up wherever it is: nothing of the board is touched after that.
void DmaEngine::run_list() {
  const std::uint64_t generation = generation_;
  const auto given_up = [this, generation] { return generation != generation_; };
  const std::uint32_t to_board = bank_.get(field::kDmaCountToBoard);
  const std::uint32_t to_host = bank_.get(field::kDmaCountToHost);
  tag_ = std::exchange(rung_tag_, Tag{});
  ++lists_;
  moved_ = {};
  whole_ = true;
  solved_ = false;
  let_latency_pass(rung_at_);
  BoardError error;
  if (!given_up() && settings_.dma->prefetches_descriptors) {
    error = fetch(list_address(), 0, to_board + to_host);
  }
  if (!given_up() && error.code == ErrorCode::none) error = move(Way::to_board, 0, to_board);
  if (!given_up() && error.code == ErrorCode::none) {
    owner_.solve_listed(tag_);
    while (!solved_ && !given_up()) {
      if (message_) {
        post_message();
      } else {
        wait(work_);
      }
    }
    if (given_up()) return;
    solved_ = false;
    error = solve_error_;
    let_latency_pass(solved_at_);
    if (!given_up()) be_late();
    if (!given_up() && error.code == ErrorCode::none) {
      error = move(Way::to_host, to_board, to_host);
    }
  }
  if (given_up()) return;
  const bool recorded = write_record(error);
  if (given_up()) return;
  if (!recorded && error.code == ErrorCode::none) error = {ErrorCode::dma_failed, kRecordFailed};
  owner_.list_ended(error, whole_, tag_);
  let_go(tag_);
}

// The span includes the time since the engine's last span in which a message kept it from its work.
void DmaEngine::let_latency_pass(Picoseconds since) {
  const std::uint64_t generation = generation_;
  if (latency_ > 0) wait(to_sc_time(latency_));
  if (generation == generation_ && now_ps() > since) {
    ledger_.extend(tag_, Part::fpga, Phase::dma_engine, since, now_ps());
  }
}

// U waits before it leaves the board.
void DmaEngine::be_late() {
  const Fault* fault =
      faults_ == nullptr ? nullptr : faults_->strike(FaultKind::late_dma, tag_.frame);
  if (fault == nullptr) return;
  const std::uint64_t generation = generation_;
  const Picoseconds since = now_ps();
  const Picoseconds end = since + fault->delay_ps();
  while (now_ps() < end && generation == generation_) wait(to_sc_time(end - now_ps()), work_);
  if (generation != generation_) return;
  ledger_.extend(tag_, Part::fpga, Phase::dma_engine, since, now_ps());
}

// The number of last bytes that a fault cuts off a segment of U.
std::uint32_t DmaEngine::missing(std::uint32_t bytes) {
  const Fault* fault =
      faults_ == nullptr ? nullptr : faults_->strike(FaultKind::truncated_dma, tag_.frame);
  return fault == nullptr ? 0 : std::min(bytes, static_cast<std::uint32_t>(fault->bytes));
}

std::uint64_t DmaEngine::list_address() const {
  return address_of(bank_.get(Register::dma_list_low), bank_.get(Register::dma_list_high));
}

// Of a list, `count` descriptors from `first` on.
BoardError DmaEngine::fetch(std::uint64_t list, std::uint32_t first, std::uint32_t count) {
  if (count == 0) return {};
  const std::span<std::uint32_t> words =
      std::span(descriptors_)
          .subspan(first % kMaxDescriptors * kDescriptorWords, count * kDescriptorWords);
  const bool there =
      transport(MasterPurpose::descriptors, list + std::uint64_t{first} * kDescriptorBytes,
                bytes_of(words), tag_, Phase::descriptor);
  if (there) return {};
  return {ErrorCode::dma_failed, kListFailed};
}

BoardError DmaEngine::move(Way way, std::uint32_t first, std::uint32_t count) {
  const std::uint64_t generation = generation_;
  for (std::uint32_t place = first; place < first + count; ++place) {
    if (!settings_.dma->prefetches_descriptors) {
      const BoardError error = fetch(list_address(), place, 1);
      if (error.code != ErrorCode::none || generation != generation_) return error;
    }
    const std::optional<Descriptor> descriptor = parse(way, place);
    if (!descriptor) return {ErrorCode::bad_descriptor, place};
    const bool moved = move_segment(way, *descriptor);
    if (generation != generation_) return {};
    if (!moved) return {ErrorCode::dma_failed, place};
  }
  return {};
}

Aperture DmaEngine::aperture_of(Way way) {
  switch (way) {
    case Way::to_board:
      return Aperture::b;
    case Way::to_host:
      return Aperture::u;
    case Way::values:
      break;
  }
  return Aperture::value;
}

std::uint8_t* DmaEngine::on_board(Way way, std::uint32_t offset) {
  const Aperture aperture = aperture_of(way);
  return reinterpret_cast<std::uint8_t*>(bank_.memory(aperture).data()) +
         (offset - kApertures[static_cast<std::size_t>(aperture)].offset);
}

bool DmaEngine::move_segment(Way way, const Descriptor& d) {
  const std::uint64_t generation = generation_;
  const std::span<std::uint8_t> data = std::span(segment_).first(d.bytes);
  std::uint8_t* const words = on_board(way, d.offset);
  if (way == Way::to_board) {
    if (!transport(MasterPurpose::b, d.address, data, tag_)) return false;
    if (generation != generation_) return false;
    std::memcpy(words, data.data(), data.size());
    moved_.to_board += d.bytes;
  } else {
    std::memcpy(data.data(), words, data.size());
    const std::uint32_t sent = d.bytes - missing(d.bytes);
    whole_ = whole_ && sent == d.bytes;
    if (sent > 0 && !transport(MasterPurpose::u, d.address, data.first(sent), tag_)) {
      return false;
    }
    moved_.to_host += sent;
  }
  return true;
}

std::optional<DmaEngine::Descriptor> DmaEngine::parse(Way way, std::uint32_t place) const {
  const std::span<const std::uint32_t> words =
      std::span(descriptors_).subspan(place % kMaxDescriptors * kDescriptorWords, kDescriptorWords);
  const Descriptor d{words[1], address_of(words[2], words[3]), words[4]};
  const bool reserved = words[0] != (way == Way::to_host ? kToHost : 0) || words[5] != 0 ||
                        words[6] != 0 || words[7] != 0;
  const bool aligned = d.bytes % 4 == 0 && d.address % 4 == 0 && d.offset % 4 == 0;
  const bool wraps = d.address + d.bytes < d.address;
  if (reserved || !aligned || d.bytes == 0 || wraps) return std::nullopt;
  const Aperture aperture = aperture_of(way);
  const std::uint32_t base = kApertures[static_cast<std::size_t>(aperture)].offset;
  const std::uint64_t size = 4 * std::uint64_t{bank_.memory(aperture).size()};
  if (d.offset < base || d.offset - base > size || d.bytes > size - (d.offset - base)) {
    return std::nullopt;
  }
  return d;
}

bool DmaEngine::write_record(const BoardError& error) {
  const std::uint64_t address =
      address_of(bank_.get(Register::dma_record_low), bank_.get(Register::dma_record_high));
  CompletionRecord record = owner_.completion(error, moved_);
  return transport(MasterPurpose::record, address, bytes_of(record), tag_);
}

bool DmaEngine::transport(MasterPurpose purpose, std::uint64_t address,
                          std::span<std::uint8_t> data, Tag& tag, std::optional<Phase> phase) {
  if (to_memory.size() == 0) return false;
  const bool read = purpose == MasterPurpose::descriptors || purpose == MasterPurpose::b ||
                    purpose == MasterPurpose::values;
  const Picoseconds began = now_ps();
  const std::int64_t frame = tag.frame;
  for (MasterObserver* const observer : observers_) {
    observer->begins({began, began, frame, purpose, read, address, data, false});
  }
  extension_.tag = &tag;
  extension_.phase = phase;
  payload_.set_command(read ? tlm::TLM_READ_COMMAND : tlm::TLM_WRITE_COMMAND);
  payload_.set_address(address);
  payload_.set_data_ptr(data.data());
  payload_.set_data_length(static_cast<unsigned>(data.size()));
  payload_.set_streaming_width(static_cast<unsigned>(data.size()));
  payload_.set_response_status(tlm::TLM_INCOMPLETE_RESPONSE);
  sc_core::sc_time delay = sc_core::SC_ZERO_TIME;
  to_memory->b_transport(payload_, delay);
  if (delay > sc_core::SC_ZERO_TIME) wait(delay);
  const bool answered = payload_.is_response_ok();
  for (MasterObserver* const observer : observers_) {
    observer->transferred({began, now_ps(), frame, purpose, read, address, data, answered});
  }
  return answered;
}

const char* name(MasterPurpose purpose) {
  switch (purpose) {
    case MasterPurpose::descriptors:
      return "descriptors";
    case MasterPurpose::b:
      return "b";
    case MasterPurpose::u:
      return "U";
    case MasterPurpose::record:
      return "record";
    case MasterPurpose::message:
      return "message";
    case MasterPurpose::values:
      return "values";
  }
  return "";
}

}  // namespace hvp::vp
