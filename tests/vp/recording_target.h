#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <systemc>
#include <vector>

#include <tlm_utils/simple_target_socket.h>

#include "vp/frame/frame_tag.h"

namespace hvp::test {

// Memory that answers at once, or asks for `wait_states`, and keeps when it was reached and for
// whom.
class RecordingTarget : public sc_core::sc_module {
 public:
  struct Access {
    vp::Picoseconds time;
    std::uint64_t address;
    std::size_t bytes;
    bool read;
    vp::Tag tag;
  };

  explicit RecordingTarget(const sc_core::sc_module_name& name)
      : sc_module(name), from_bus("from_bus") {
    from_bus.register_b_transport(this, &RecordingTarget::b_transport);
  }
  tlm_utils::simple_target_socket<RecordingTarget> from_bus;
  vp::Picoseconds wait_states = 0;
  std::vector<Access> accesses;
  std::array<unsigned char, 8'192> bytes{};

  std::vector<vp::Picoseconds> times() const {
    std::vector<vp::Picoseconds> times;
    for (const Access& a : accesses) times.push_back(a.time);
    return times;
  }

 private:
  void b_transport(tlm::tlm_generic_payload& transaction, sc_core::sc_time& delay) {
    vp::Tag none;
    const std::size_t length = transaction.get_data_length();
    accesses.push_back({vp::now_ps(), transaction.get_address(), length, transaction.is_read(),
                        vp::tag_of(transaction, none)});
    unsigned char* at = bytes.data() + transaction.get_address();
    if (transaction.is_write()) {
      std::memcpy(at, transaction.get_data_ptr(), length);
    } else {
      std::memcpy(transaction.get_data_ptr(), at, length);
    }
    transaction.set_response_status(tlm::TLM_OK_RESPONSE);
    delay += vp::to_sc_time(wait_states);
  }
};

}  // namespace hvp::test
