#include "vp/frame/frame.h"

#include <algorithm>

#include "vp/frame/tenure.h"

namespace hvp::vp {

bool Frame::in_contact() const {
  return std::ranges::any_of(touches,
                             [](const collision::Touch& t) { return t.contact.present(); });
}

std::string_view name(Part part) { return kPartNames.at(static_cast<std::size_t>(part)); }

std::string_view name(Resource resource) {
  switch (resource) {
    case Resource::core_0:
      return "core 0";
    case Resource::core_1:
      return "core 1";
    case Resource::bus:
      return "bus";
    case Resource::link_to_board:
      return "link to board";
    case Resource::link_to_host:
      return "link to host";
  }
  return "";
}

std::string_view name(Phase phase) {
  switch (phase) {
    case Phase::release:
      return "release";
    case Phase::wake_up:
      return "wake-up";
    case Phase::blocked:
      return "blocked";
    case Phase::context_switch:
      return "context switch";
    case Phase::sample:
      return "sample";
    case Phase::bus_read:
      return "read";
    case Phase::bus_write:
      return "write";
    case Phase::block_read:
      return "block read";
    case Phase::block_write:
      return "block write";
    case Phase::arbitration:
      return "arbitration";
    case Phase::posting:
      return "posting";
    case Phase::dma_read:
      return "dma read";
    case Phase::dma_write:
      return "dma write";
    case Phase::descriptor:
      return "descriptor";
    case Phase::message:
      return "message";
    case Phase::dma_engine:
      return "dma engine";
    case Phase::to_memory:
      return "to memory";
    case Phase::contact_lookup:
      return "contact lookup";
    case Phase::hold:
      return "hold";
    case Phase::node_update:
      return "node update";
    case Phase::form_rhs:
      return "form rhs";
    case Phase::solve:
      return "solve";
    case Phase::interrupt:
      return "interrupt";
    case Phase::pipeline:
      return "pipeline";
    case Phase::wait:
      return "wait";
    case Phase::polling:
      return "polling";
    case Phase::driver:
      return "driver";
    case Phase::force:
      return "force";
    case Phase::convert:
      return "convert";
    case Phase::motor:
      return "motor";
    case Phase::update:
      return "update";
    case Phase::recovery:
      return "recovery";
    case Phase::bridge_status:
      return "bridge status";
    case Phase::refinement:
      return "refinement";
  }
  return "";
}

}  // namespace hvp::vp
