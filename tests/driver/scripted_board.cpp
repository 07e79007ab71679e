#include "tests/driver/scripted_board.h"

#include <algorithm>
#include <array>
#include <bit>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "vp/fpga/register_bank.h"

namespace hvp::test {

using vp::Aperture;
using vp::Command;
using vp::ErrorCode;
using vp::Register;
namespace field = vp::field;

ScriptedBoard::ScriptedBoard(const vp::Capacity& capacity) : bank_(capacity) {
  bank_.strap(Register::capability_dma, 16);
  bank_.on_write(Register::control,
                 [this](std::uint32_t written, std::uint32_t) { control(written); });
  bank_.on_write(Register::interrupt_status, [this](std::uint32_t, std::uint32_t) {
    if (bank_.get(field::kInterruptStatusError) == 0) {
      bank_.set(Register::error, 0);
      bank_.set(Register::error_detail, 0);
    }
    mirror_interrupts();
  });
  const auto forget_values = [this] { bank_.set(field::kStatusMatrixLoaded, 0); };
  const auto forget_matrix = [this, forget_values] {
    forget_values();
    bank_.set(field::kStatusPatternLoaded, 0);
  };
  for (const Register reg :
       {Register::nodes, Register::blocks, Register::format, Register::packing, Register::method}) {
    bank_.on_write(reg, [this, reg, forget_matrix](std::uint32_t, std::uint32_t before) {
      if (bank_.get(reg) != before) forget_matrix();
    });
  }
  for (const Aperture memory : {Aperture::row_begin, Aperture::column}) {
    bank_.on_memory_write(memory, forget_matrix);
  }
  bank_.on_memory_write(Aperture::value, forget_values);
}

void ScriptedBoard::mirror_interrupts() {
  bank_.set(field::kStatusDone, bank_.get(field::kInterruptStatusDone));
  bank_.set(field::kStatusError, bank_.get(field::kInterruptStatusError));
  bank_.set(field::kStatusErrorCode, bank_.get(field::kErrorCode));
}

void ScriptedBoard::raise(ErrorCode code, std::uint32_t detail) {
  if (bank_.get(field::kInterruptStatusError) == 0) {
    bank_.set(field::kErrorCode, static_cast<std::uint32_t>(code));
    bank_.set(Register::error_detail, detail);
    bank_.set(field::kInterruptStatusError, 1);
  }
  mirror_interrupts();
}

void ScriptedBoard::control(std::uint32_t written) {
  if ((written & field::kControlReset.mask()) != 0) {
    running_ = Running::nothing;
    list_ = false;
    fetches_ = false;
    bank_.reset();
    return;
  }
  if (bank_.get(field::kInterruptStatusError) != 0) return;
  const bool loaded = bank_.get(field::kStatusMatrixLoaded) != 0;
  if ((written & field::kControlLoadDone.mask()) != 0) {
    begin(Running::load, load_ns);
  } else if ((written & field::kControlUpdateValues.mask()) != 0) {
    if (bank_.get(field::kStatusPatternLoaded) == 0) return raise(ErrorCode::not_loaded, 0);
    begin(Running::update, load_ns);
  } else if ((written & field::kControlFetchValues.mask()) != 0) {
    if (bank_.get(field::kStatusPatternLoaded) == 0) return raise(ErrorCode::not_loaded, 0);
    bank_.set(field::kStatusMatrixLoaded, 0);
    fetches_ = true;
    begin(Running::update, load_ns);
  } else if ((written & (field::kControlStart.mask() | field::kControlRunList.mask())) != 0) {
    if (!loaded) return raise(ErrorCode::not_loaded, 0);
    list_ = (written & field::kControlStart.mask()) == 0;
    if (list_) {
      bank_.set(field::kInterruptStatusDone, 0);
      mirror_interrupts();
    }
    bank_.set(Register::job, bank_.get(Register::job) + 1);
    begin(Running::job, job_ns);
  } else if ((written & field::kControlUpdateNode.mask()) != 0) {
    if (!loaded) return raise(ErrorCode::not_loaded, 0);
    update_node();
  }
}

void ScriptedBoard::begin(Running what, std::uint64_t duration) {
  running_ = what;
  end_ = now_ + duration;
  bank_.set(field::kStatusBusy, 1);
}

void ScriptedBoard::end() {
  const Running what = running_;
  running_ = Running::nothing;
  bank_.set(field::kStatusBusy, 0);
  if (list_) bring_b();
  if (std::exchange(fetches_, false)) bring_values();
  if (end_with != ErrorCode::none) {
    raise(end_with, 0x1234);
    if (list_) take_out_u();
    list_ = false;
    return;
  }
  if (what == Running::load) {
    check_matrix();
  } else if (what == Running::update) {
    bank_.set(field::kStatusMatrixLoaded, 1);
    bank_.set(field::kInterruptStatusDone, 1);
  } else {
    bank_.set(Register::result_job, bank_.get(Register::job));
    bank_.set(Register::result_iterations, bank_.get(Register::iterations));
    bank_.set(Register::result_cycles_low, static_cast<std::uint32_t>(job_ns / 10));
    solve(bank_);
    bank_.set(field::kStatusFlags, bank_.get(Register::result_flags));
    bank_.set(field::kInterruptStatusDone, 1);
  }
  mirror_interrupts();
  if (list_) take_out_u();
  list_ = false;
}

namespace {
// Word of the scripted memory that an address in two registers or words means.
std::size_t memory_word(std::uint32_t low, std::uint32_t high) {
  const std::uint64_t address = std::uint64_t{high} << 32 | low;
  return static_cast<std::size_t>((address - ScriptedBoard::kMemoryAddress) / 4);
}

// A word that the processor sees so has its bytes in this order for the board, which takes the
// first for the least significant one; and the reverse. A processor of the other byte order than
// this machine's is played by turning what the board fetches and places.
std::uint32_t turned(std::uint32_t word) {
#ifdef HVP_PLAY_THE_OTHER_BYTE_ORDER
  constexpr bool kTurned = std::endian::native == std::endian::little;
#else
  constexpr bool kTurned = std::endian::native == std::endian::big;
#endif
  return kTurned ? __builtin_bswap32(word) : word;
}
}  // namespace

std::uint32_t ScriptedBoard::fetched(std::size_t word) const { return turned(memory_.at(word)); }

void ScriptedBoard::place(std::size_t word, std::uint32_t value) {
  memory_.at(word) = turned(value);
}

// Whether a list, or its record, lies where there is no memory: fuzzed registers.
bool ScriptedBoard::unreachable() const {
  const std::size_t words =
      8 * std::size_t{bank_.get(field::kDmaCountToBoard) + bank_.get(field::kDmaCountToHost)};
  const std::size_t list =
      memory_word(bank_.get(Register::dma_list_low), bank_.get(Register::dma_list_high));
  const std::size_t record =
      memory_word(bank_.get(Register::dma_record_low), bank_.get(Register::dma_record_high));
  return list >= memory_.size() || words > memory_.size() - list || record >= memory_.size() ||
         memory_.size() - record < 8;
}

ScriptedBoard::Descriptor ScriptedBoard::descriptor(std::size_t list, std::uint32_t i) const {
  const std::size_t first = list + 8 * std::size_t{i};
  return {.bytes = fetched(first + 1),
          .word = memory_word(fetched(first + 2), fetched(first + 3)),
          .offset = fetched(first + 4)};
}

void ScriptedBoard::bring_b() {
  if (unreachable()) {
    raise(ErrorCode::dma_failed, 0xfffffffe);
    return;
  }
  const std::size_t list =
      memory_word(bank_.get(Register::dma_list_low), bank_.get(Register::dma_list_high));
  to_board_ = 0;
  for (std::uint32_t i = 0; i < bank_.get(field::kDmaCountToBoard); ++i) {
    const Descriptor d = descriptor(list, i);
    bring(Aperture::b, d);
    to_board_ += d.bytes;
  }
}

void ScriptedBoard::bring(Aperture aperture, const Descriptor& d) {
  const std::size_t to = (d.offset - vp::kApertures[static_cast<std::size_t>(aperture)].offset) / 4;
  for (std::size_t k = 0; k < d.bytes / 4; ++k) {
    bank_.memory(aperture)[to + k] = fetched(d.word + k);
  }
}

void ScriptedBoard::bring_values() {
  const std::size_t list =
      memory_word(bank_.get(Register::dma_values_low), bank_.get(Register::dma_values_high));
  const std::uint32_t count = bank_.get(field::kDmaValuesCountCount);
  if (list >= memory_.size() || 8 * std::size_t{count} > memory_.size() - list) {
    raise(ErrorCode::dma_failed, 0xfffffffe);
    return;
  }
  for (std::uint32_t i = 0; i < count; ++i) bring(Aperture::value, descriptor(list, i));
}

void ScriptedBoard::take_out_u() {
  if (unreachable()) return;
  const std::size_t list =
      memory_word(bank_.get(Register::dma_list_low), bank_.get(Register::dma_list_high)) +
      8 * std::size_t{bank_.get(field::kDmaCountToBoard)};
  to_host_ = 0;
  const bool failed = bank_.get(field::kInterruptStatusError) != 0;
  for (std::uint32_t i = 0; !failed && i < bank_.get(field::kDmaCountToHost); ++i) {
    const Descriptor d = descriptor(list, i);
    const std::size_t from =
        (d.offset - vp::kApertures[static_cast<std::size_t>(Aperture::u)].offset) / 4;
    const std::uint32_t bytes = d.bytes - std::min(d.bytes, short_by);
    for (std::size_t k = 0; k < bytes / 4; ++k) {
      posted_.push_back({d.word + k, bank_.memory(Aperture::u)[from + k]});
    }
    to_host_ += bytes;
  }
  const std::size_t record =
      memory_word(bank_.get(Register::dma_record_low), bank_.get(Register::dma_record_high));
  const std::array<std::uint32_t, 8> words = {bank_.get(Register::status),
                                              to_board_,
                                              to_host_,
                                              bank_.get(Register::result_iterations),
                                              bank_.get(Register::result_flags),
                                              bank_.get(Register::result_cycles_low),
                                              bank_.get(Register::result_cycles_high),
                                              bank_.get(Register::job) + job_offset};
  for (std::size_t k = 0; !loses_record && k < words.size(); ++k) {
    posted_.push_back({record + k, words[k]});
  }
  deliver_at_ = now_ + posted_ns;
  if (posted_ns == 0) deliver();
}

void ScriptedBoard::deliver() {
  for (const Posted& write : posted_) place(write.word, write.value);
  posted_.clear();
}

void ScriptedBoard::check_matrix() {
  const std::uint32_t nodes = bank_.get(Register::nodes);
  const std::uint32_t blocks = bank_.get(Register::blocks);
  const auto begin = bank_.memory(Aperture::row_begin);
  const auto column = bank_.memory(Aperture::column);
  if (nodes == 0 || nodes >= begin.size()) return raise(ErrorCode::bad_size, nodes);
  if (blocks == 0 || blocks > column.size()) return raise(ErrorCode::bad_size, blocks);
  for (std::uint32_t row = 0; row < nodes; ++row) {
    if (begin[row] >= begin[row + 1] || begin[row + 1] > blocks) {
      return raise(ErrorCode::bad_matrix, row);
    }
    const auto columns = column.subspan(begin[row], begin[row + 1] - begin[row]);
    if (!std::is_sorted(columns.begin(), columns.end()) ||
        !std::binary_search(columns.begin(), columns.end(), row)) {
      return raise(ErrorCode::bad_matrix, row);
    }
  }
  bank_.set(field::kStatusMatrixLoaded, 1);
  bank_.set(field::kStatusPatternLoaded, 1);
  bank_.set(field::kInterruptStatusDone, 1);
}

void ScriptedBoard::update_node() {
  const std::uint32_t node = bank_.get(Register::update_node);
  if (node >= bank_.get(Register::nodes)) return raise(ErrorCode::bad_node, node);
  const auto begin = bank_.memory(Aperture::row_begin);
  const auto column = bank_.memory(Aperture::column);
  const auto value = bank_.memory(Aperture::value);
  const auto staged = bank_.memory(Aperture::row);
  const unsigned bits = bank_.get(field::kFormatMatrixBits);
  const bool constrain =
      bank_.get(Register::update_kind) == static_cast<std::uint32_t>(vp::UpdateKind::constrain);
  const auto diagonal = static_cast<std::int32_t>(bank_.get(Register::update_diagonal));
  const std::uint32_t row_blocks = begin[node + 1] - begin[node];
  if (!constrain && bank_.get(Register::update_blocks) != row_blocks) {
    return raise(ErrorCode::bad_row, row_blocks);
  }
  for (std::uint32_t j = 0; j < row_blocks; ++j) {
    const std::uint32_t k = begin[node] + j;
    const std::uint32_t other = column[k];
    const auto of_other = column.subspan(begin[other], begin[other + 1] - begin[other]);
    const auto mirror = static_cast<std::uint32_t>(
        begin[other] +
        (std::lower_bound(of_other.begin(), of_other.end(), node) - of_other.begin()));
    for (std::uint32_t e = 0; e < 9; ++e) {
      std::int32_t entry = constrain ? 0 : vp::packed_element(staged, 9 * j + e, bits);
      if (constrain && other == node && e % 4 == 0) entry = diagonal;
      vp::set_packed_element(value, 9 * std::size_t{k} + e, bits, entry);
      if (other == node) continue;
      vp::set_packed_element(value, 9 * std::size_t{mirror} + 3 * (e % 3) + e / 3, bits, entry);
    }
  }
}

void ScriptedBoard::advance(std::uint64_t ns) {
  now_ += ns;
  if (running_ != Running::nothing && !hangs && now_ >= end_) end();
  if (!posted_.empty() && now_ >= deliver_at_) deliver();
}

bool ScriptedBoard::line_is_up() const {
  return (bank_.get(Register::interrupt_status) & bank_.get(Register::interrupt_enable)) != 0;
}

int ScriptedBoard::wait_interrupt(std::uint64_t timeout_ns) {
  log_.emplace_back("wait");
  if (bus_fails) return HVP_INTERRUPT_BUS_FAILED;
  if (gives_up_with < 0) return gives_up_with;
  if (spurious_interrupts > 0) {
    --spurious_interrupts;
    return HVP_INTERRUPT;
  }
  if (!loses_interrupts && line_is_up()) return HVP_INTERRUPT;
  if (!loses_interrupts && !hangs && running_ != Running::nothing && end_ <= now_ + timeout_ns) {
    advance(end_ - now_);
    if (line_is_up()) return HVP_INTERRUPT;
  }
  advance(timeout_ns);
  return HVP_INTERRUPT_TIMED_OUT;
}

void ScriptedBoard::transfer(Command command, std::uint32_t offset, std::uint32_t* words,
                             std::size_t count) {
  advance(kAccessNs);
  // The answer to a read pushes what the board has written before.
  if (command == Command::read) deliver();
  const std::string name = bank_.name_at(offset);
  if (count != 1) {
    log_.push_back(
        fmt::format("{} {} x{}", command == Command::read ? "read" : "write", name, count));
  } else if (command == Command::read) {
    log_.push_back("read " + name);
  } else {
    log_.push_back(fmt::format("write {} 0x{:x}", name, *words));
  }
  if (dead) {
    if (command == Command::read) std::fill_n(words, count, ~std::uint32_t{0});
    return;
  }
  auto* const bytes = reinterpret_cast<std::uint8_t*>(words);
  const vp::AccessResult outcome = command == Command::read
                                       ? bank_.read(offset, std::span(bytes, 4 * count))
                                       : bank_.write(offset, std::span(bytes, 4 * count));
  if (outcome.ok()) return;
  refused_.push_back(bank_.describe(outcome, command));
  raise(ErrorCode::illegal_access, static_cast<std::uint32_t>(outcome.offset));
}

hvp_bus ScriptedBoard::bus() {
  hvp_bus bus{};
  bus.context = this;
  bus.read32 = [](void* context, std::uint32_t offset) {
    std::uint32_t word = 0;
    static_cast<ScriptedBoard*>(context)->transfer(Command::read, offset, &word, 1);
    return word;
  };
  bus.write32 = [](void* context, std::uint32_t offset, std::uint32_t value) {
    static_cast<ScriptedBoard*>(context)->transfer(Command::write, offset, &value, 1);
  };
  bus.read_block = [](void* context, std::uint32_t offset, std::uint32_t* words,
                      std::size_t count) {
    static_cast<ScriptedBoard*>(context)->transfer(Command::read, offset, words, count);
  };
  bus.write_block = [](void* context, std::uint32_t offset, const std::uint32_t* words,
                       std::size_t count) {
    std::vector<std::uint32_t> copy(words, words + count);
    static_cast<ScriptedBoard*>(context)->transfer(Command::write, offset, copy.data(), count);
  };
  bus.wait_interrupt = [](void* context, std::uint64_t timeout_ns) {
    return static_cast<ScriptedBoard*>(context)->wait_interrupt(timeout_ns);
  };
  bus.pause = [](void* context) {
    auto& board = *static_cast<ScriptedBoard*>(context);
    board.log_.emplace_back("pause");
    board.advance(10 * kAccessNs);
  };
  bus.now_ns = [](void* context) { return static_cast<ScriptedBoard*>(context)->now_; };
  return bus;
}

std::vector<std::string> ScriptedBoard::take_log() {
  std::vector<std::string> taken;
  taken.swap(log_);
  return taken;
}

}  // namespace hvp::test
