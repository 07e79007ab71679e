#include "app/linux/board_device.h"

#include <algorithm>
#include <array>
#include <stdexcept>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "app/linux/calendar.h"
#include "app/linux/guest_error.h"
#include "vp/bus/host_memory.h"

namespace hvp::guest {

using vhost::Request;

namespace {

// The time after which a level that stays up is reported again. Time has to advance in between, as
// it does for a processor that enters its handler again.
constexpr vp::Picoseconds kLineAgain = 1'000'000;

using Space = vp::OutsideHost::Space;

bool of_configuration(const pci::Command& command) {
  return command.operation == pci::Operation::config_read ||
         command.operation == pci::Operation::config_write;
}

// Where the command goes; empty: nothing is there.
std::optional<Space> space_of(const pci::Command& command) {
  if (of_configuration(command)) return Space::configuration;
  if (command.data.empty()) return std::nullopt;
  if (command.bar == vp::ConfigSpace::kMessageTableBar) return Space::message_table;
  return command.bar == 0 ? std::optional(Space::bar) : std::nullopt;
}

}  // namespace

BoardDevice::BoardDevice(vp::OutsideHost& host, vp::HostMemory* memory, const Mappings& told,
                         Calendar& calendar, Stream stream)
    : host_(host), memory_(memory), told_(told), calendar_(calendar), stream_(std::move(stream)) {
  host_.listen(*this);
  host_.show_bus_errors();
}

BoardDevice::~BoardDevice() { unshare_memory(); }

void BoardDevice::serve() {
  std::array<std::uint8_t, vhost::kHeaderBytes> head{};
  std::vector<Descriptor> descriptors;
  stream_.receive(head, &descriptors);
  const vhost::Header header = vhost::parse_header(head);
  std::array<std::uint8_t, vhost::kLongestPayload> room{};
  const std::span<std::uint8_t> payload = std::span(room).first(header.size);
  stream_.receive(payload, &descriptors);
  const std::uint64_t number = answer(header, payload, descriptors);
  const auto request = static_cast<Request>(header.request);
  const bool asks = request == Request::get_features || request == Request::get_protocol_features ||
                    request == Request::get_ring_base;
  if (asks || header.needs_reply) stream_.send(vhost::compose_reply(header.request, number));
}

std::uint64_t BoardDevice::answer(const vhost::Header& header,
                                  std::span<const std::uint8_t> payload,
                                  std::vector<Descriptor>& descriptors) {
  switch (static_cast<Request>(header.request)) {
    case Request::get_features:
      return vhost::kFeatures |
             (told_.check != nullptr || told_.order != nullptr ? vhost::kDmaFeature : 0) |
             (told_.order != nullptr ? vhost::kBarrierFeature : 0);
    case Request::get_protocol_features:
      return vhost::kProtocolFeatures;
    case Request::set_features:
      accept(vhost::parse_number(payload));
      return 0;
    case Request::translation:
      take(vhost::parse_translation(payload));
      return 0;
    case Request::set_protocol_features:
    case Request::set_owner:
    case Request::reset_owner:
    case Request::set_ring_kick:  // in band, both
    case Request::set_ring_call:
    case Request::set_ring_error:
      return 0;
    case Request::set_memory_table:
      share_memory(payload, descriptors);
      return 0;
    case Request::set_ring_size: {
      const vhost::RingState state = vhost::parse_ring_state(payload);
      ring(state.ring).set_size(state.number);
      return 0;
    }
    case Request::set_ring_base: {
      const vhost::RingState state = vhost::parse_ring_state(payload);
      ring(state.ring).set_base(state.number);
      return 0;
    }
    case Request::get_ring_base:
      return std::uint64_t{ring(vhost::parse_ring_state(payload).ring).next()} << 32U |
             vhost::parse_ring_state(payload).ring;
    case Request::set_ring_addresses: {
      const vhost::RingAddresses addresses = vhost::parse_ring_addresses(payload);
      ring(addresses.ring)
          .set_addresses(guest_memory_.from_user(addresses.descriptors),
                         guest_memory_.from_user(addresses.used),
                         guest_memory_.from_user(addresses.available));
      return 0;
    }
    case Request::set_ring_enable: {
      const vhost::RingState state = vhost::parse_ring_state(payload);
      ring(state.ring).enable(state.number != 0);
      return 0;
    }
    case Request::set_back_channel:
      if (descriptors.empty()) throw GuestError("vhost-user: a back channel without a descriptor");
      back_channel_ = stream_.beside(std::move(descriptors.front()));
      return 0;
    case Request::ring_kick:
      kicked(vhost::parse_ring_state(payload).ring);
      return 0;
  }
  throw GuestError(fmt::format("vhost-user: a request {} that is not answered", header.request));
}

void BoardDevice::accept(std::uint64_t features) {
  if (told_.check != nullptr) told_.check->accepted((features & vhost::kDmaFeature) != 0);
  if (told_.order == nullptr) return;
  const bool tells =
      (features & vhost::kDmaFeature) != 0 && (features & vhost::kBarrierFeature) != 0;
  if (tells) return;
  told_.order = nullptr;
  spdlog::warn(
      "guest.memory_order: the kernel tells of no barriers, and its stores are in order; expected "
      "one with driver/linux/kernel/patches/virt-pci-4-barrier.patch");
}

void BoardDevice::take(const vhost::Translation& message) const {
  using Kind = vhost::Translation::Kind;
  if (told_.check == nullptr && told_.order == nullptr) {
    throw GuestError("vhost-user: a mapping that nobody asked for");
  }
  if (told_.check != nullptr) told_.check->take(message);
  if (told_.order == nullptr) return;
  switch (message.kind) {
    case Kind::map:
      told_.order->map(message.address, message.bytes);
      return;
    case Kind::unmap:
      told_.order->unmap(message.address);
      return;
    case Kind::sync_for_device:
      told_.order->sync(message.address, message.bytes);
      return;
    case Kind::sync_for_cpu:
      return;
    case Kind::unbound:
      told_.order->unmap_all(0, ~std::uint64_t{0});
      return;
    case Kind::barrier:
      told_.order->barrier();
      return;
  }
}

Virtqueue& BoardDevice::ring(std::uint32_t number) {
  if (number < kRings) return rings_[number];
  throw GuestError(fmt::format("vhost-user: ring {}, expected 0 or 1", number));
}

void BoardDevice::share_memory(std::span<const std::uint8_t> payload,
                               std::vector<Descriptor>& descriptors) {
  const std::vector<vhost::Region> regions = vhost::parse_memory_table(payload);
  if (regions.size() != descriptors.size()) {
    throw GuestError(fmt::format("vhost-user: {} regions of memory with {} descriptors",
                                 regions.size(), descriptors.size()));
  }
  if (!operations_.empty()) throw GuestError("vhost-user: memory changes during an access");
  unshare_memory();
  for (std::size_t i = 0; i < regions.size(); ++i) {
    mappings_.emplace_back(descriptors[i].number(), regions[i].offset, regions[i].size);
    guest_memory_.add(regions[i], mappings_.back().bytes());
    if (memory_ == nullptr) continue;
    try {
      memory_->map(regions[i].guest, mappings_.back().bytes());
    } catch (const std::invalid_argument& e) {
      throw GuestError(fmt::format("the guest's memory at {:#x}: {}", regions[i].guest, e.what()));
    }
  }
}

void BoardDevice::unshare_memory() {
  if (memory_ != nullptr) memory_->unmap(0, ~std::uint64_t{0});
  guest_memory_.clear();
  mappings_.clear();
}

void BoardDevice::kicked(std::uint32_t number) {
  if (&ring(number) == &rings_[kCommands]) {
    take_commands();
    hold();
  } else if (line_up_ && line_told_) {
    // The handler has finished and the level is still up: a new edge follows as soon as the
    // handler's writes have arrived.
    line_told_ = false;
    line_again_ = vp::now_ps() + kLineAgain;
  }
  tell();
}

void BoardDevice::take_commands() {
  while (auto chain = rings_[kCommands].pop(guest_memory_)) {
    Operation operation{.chain = std::move(*chain), .command = {}};
    operation.command = pci::parse(operation.chain.sent, operation.chain.room_bytes, vp::kBarBytes);
    // The kernel waits for the others, and reclaims their entries then.
    if (!operation.command.reads() && !of_configuration(operation.command)) {
      unreclaimed_ += static_cast<std::uint32_t>(operation.chain.entries);
    }
    if (!of_configuration(operation.command)) stalled_for_ += host_.stall();
    operations_.push_back(std::move(operation));
  }
  if (unreclaimed_ >= rings_[kCommands].size() && !counts_.overrun) {
    counts_.overrun = true;
    spdlog::warn(
        "the guest writes {} times without a pause: its kernel loses what does not go "
        "into its ring (docs/linux.md)",
        unreclaimed_);
  }
}

// Advances simulated time until the outstanding reads have their answers, while the guest waits in
// its access.
void BoardDevice::hold() {
  advance();
  const vp::Picoseconds latest = to_ps(calendar_.latest(now_ns()));
  while (awaits_an_answer() || operations_.size() > kMostPosted) {
    if (!run_until(latest)) continue;
    if (awaits_an_answer()) ++counts_.polled;
    break;
  }
  // A timer of the guest's ends this as it ends a poll.
  if (stalled_for_ > 0) {
    const vp::Picoseconds until = std::min(latest, vp::now_ps() + stalled_for_);
    stalled_for_ = 0;
    host_.stands_still(until);
    while (vp::now_ps() < until) run_until(until);
    host_.stood_still();
  }
  while (!whole_ns()) {
    host_.run_until(to_ps(now_ns()));
    advance();
  }
  if (now_ns() > calendar_.told()) calendar_.run(now_ns());
  if (unreclaimed_ > rings_[kCommands].size() / 2) give_back();
}

bool BoardDevice::run_until(vp::Picoseconds time) {
  const bool reached = host_.run_until(time);
  advance();
  return reached;
}

void BoardDevice::advance() {
  begin();
  finish();
}

void BoardDevice::begin() {
  for (Operation& operation : operations_) {
    if (operation.begun) continue;
    operation.begun = true;
    const bool reads = operation.command.reads();
    const std::optional<Space> space = space_of(operation.command);
    if (!space) {
      operation.ended = true;
      continue;
    }
    const vp::Command command = reads ? vp::Command::read : vp::Command::write;
    if (space == Space::bar) {
      ++(reads ? counts_.reads : counts_.writes);
      operation.number =
          recent_.begin(vp::now_ps(), command, operation.command.address, operation.command.data);
    }
    host_.post(
        {command, *space, operation.command.address, operation.command.data, [this, &operation] {
           operation.ended = true;
           if (space_of(operation.command) != Space::bar) return;
           recent_.end(operation.number, vp::now_ps(), operation.command.data);
         }});
  }
}

// Returns operations in order. An answer is returned at once. A write is returned when the guest
// waits, as its kernel takes a microsecond for each one that it finds while polling for an answer.
void BoardDevice::finish() {
  while (!operations_.empty() && operations_.front().ended) {
    const Operation& done = operations_.front();
    if (done.command.reads()) {
      rings_[kCommands].push(guest_memory_, done.chain.head, fill(done.chain, done.command.data));
    } else {
      written_.push_back(done.chain.head);
    }
    operations_.pop_front();
  }
}

bool BoardDevice::awaits_an_answer() const {
  return std::ranges::any_of(operations_, [](const Operation& o) {
    return o.command.reads() || of_configuration(o.command);
  });
}

void BoardDevice::give_back() {
  for (const std::uint16_t head : written_) rings_[kCommands].push(guest_memory_, head, 0);
  written_.clear();
  call(kCommands);
}

bool BoardDevice::settle() {
  advance();
  bool told = tell();
  if (!written_.empty() && !awaits_an_answer()) {
    give_back();
    told = true;
  }
  unreclaimed_ = 0;
  for (const Operation& operation : operations_) {
    unreclaimed_ += static_cast<std::uint32_t>(operation.chain.entries);
  }
  return told;
}

void BoardDevice::message(const vp::ConfigSpace::Message& message) {
  untold_.push_back(pci::compose_message(message.address, message.data));
}

void BoardDevice::line(bool up) {
  line_up_ = up;
  line_told_ = false;
  line_again_ = 0;
}

std::optional<vp::Picoseconds> BoardDevice::due() const {
  if (!line_up_ || line_told_ || !host_.idle()) return std::nullopt;
  return line_again_;
}

bool BoardDevice::tell() {
  if (const auto at = due(); at && *at <= vp::now_ps()) {
    line_told_ = true;
    if (line_again_ > 0) host_.handler_left_line_up();
    untold_.push_back(pci::compose_line());
  }
  bool told = false;
  while (!untold_.empty()) {
    const auto chain = rings_[kInterrupts].pop(guest_memory_);
    if (!chain) break;  // its kernel is not through with those before
    const pci::Interrupt bytes = untold_.front();
    untold_.pop_front();
    rings_[kInterrupts].push(guest_memory_, chain->head, fill(*chain, bytes));
    ++counts_.interrupts;
    told = true;
  }
  if (told) call(kInterrupts);
  return told;
}

// The guest receives the call at the current time, for which it asks, and answers.
void BoardDevice::call(std::uint32_t number) {
  if (!back_channel_) throw GuestError("the guest's kernel has no back channel for interrupts");
  back_channel_.send(vhost::compose_call(number));
  for (;;) {
    const std::array sources = {back_channel_.number(), calendar_.number()};
    if (stream_.wait_readable(sources) == 0) break;
    calendar_.serve(now_ns());
  }
  vhost::NumberMessage answer{};
  back_channel_.receive(answer);
}

}  // namespace hvp::guest
