#include "vp/fpga/rtl/fst_file.h"

#include <algorithm>
#include <cstddef>
#include <stdexcept>

namespace hvp::vp::rtl {

namespace {
// Codes are counted in words of 32 bits.
std::uint32_t words(int bits) { return bits == ShownSignal::kReal || bits == 64 ? 2 : 1; }
}  // namespace

void FstFile::open(const std::string& path) {
  VerilatedFst* const trace = fst_.spTrace();
  trace->addInitCb(&FstFile::declare, this);
  trace->addFullCb(&FstFile::write_all, this);
  trace->addChgCb(&FstFile::write_changes, this);
  fst_.set_time_unit("1ps");
  fst_.set_time_resolution("1ps");
  fst_.open(path.c_str());
  if (!fst_.isOpen()) throw std::runtime_error("cannot write " + path);
}

// Verilator separates scopes by spaces.
void FstFile::declare(void* self, VerilatedFst* trace, std::uint32_t code) {
  auto& file = *static_cast<FstFile*>(self);
  file.code_.clear();
  for (const ShownSignal& signal : file.shown_) {
    std::string name = signal.name;
    std::ranges::replace(name, '.', ' ');
    // Verilator keeps what was written last at its code, a real or 64 bits as one object of 8
    // bytes.
    if (words(signal.bits) == 2) code += code % 2;
    file.code_.push_back(code);
    constexpr int kUnnamedType = -1;
    const auto wire = [&](auto declares, auto... range) {
      (trace->*declares)(code, name.c_str(), kUnnamedType, FST_VD_IMPLICIT, FST_VT_VCD_WIRE, false,
                         -1, range...);
    };
    switch (signal.bits) {
      case ShownSignal::kReal:
        trace->declDouble(code, name.c_str(), kUnnamedType, FST_VD_IMPLICIT, FST_VT_VCD_REAL, false,
                          -1);
        break;
      case 1:
        wire(&VerilatedFst::declBit);
        break;
      case 64:
        wire(&VerilatedFst::declQuad, 63, 0);
        break;
      default:
        wire(&VerilatedFst::declBus, signal.bits - 1, 0);
    }
    code += words(signal.bits);
  }
}

// Verilator's buffer has four functions that write a value, and four that write it if it is new.
template <auto kReal, auto kBit, auto kQuad, auto kBus>
void FstFile::write(Buffer* buffer) const {
  for (std::size_t i = 0; i < shown_.size(); ++i) {
    const ShownSignal& s = shown_[i];
    std::uint32_t* const old = buffer->oldp(code_[i]);
    switch (s.bits) {
      case ShownSignal::kReal:
        (buffer->*kReal)(old, s.real);
        break;
      case 1:
        (buffer->*kBit)(old, s.integer != 0 ? 1 : 0);
        break;
      case 64:
        (buffer->*kQuad)(old, static_cast<std::uint64_t>(s.integer), 64);
        break;
      default:
        (buffer->*kBus)(old, static_cast<std::uint32_t>(s.integer), s.bits);
    }
  }
}

void FstFile::write_all(void* self, Buffer* buffer) {
  static_cast<const FstFile*>(self)
      ->write<&Buffer::fullDouble, &Buffer::fullBit, &Buffer::fullQData, &Buffer::fullIData>(
          buffer);
}

void FstFile::write_changes(void* self, Buffer* buffer) {
  static_cast<const FstFile*>(self)
      ->write<&Buffer::chgDouble, &Buffer::chgBit, &Buffer::chgQData, &Buffer::chgIData>(buffer);
}

}  // namespace hvp::vp::rtl
