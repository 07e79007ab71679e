#include "vp/device/daq_board.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

namespace hvp::vp {

DaqBoard::DaqBoard(const sc_core::sc_module_name& name, const plant::DeviceSettings& settings,
                   std::vector<plant::Device*> devices, const Session& session, Ledger& ledger,
                   Picoseconds delay)
    : sc_module(name),
      from_bus("from_bus"),
      encoder_(settings.encoder),
      limits_(settings.limits),
      adc_(settings.adc),
      kinematics_(settings.kinematics ? plant::make_kinematics(*settings.kinematics) : nullptr),
      stage_(settings.dac, settings.amplifier, settings.motor, kinematics_.get()),
      devices_(std::move(devices)),
      session_(session),
      ledger_(ledger),
      sampling_(to_picoseconds(settings.daq.sampling_delay)),
      output_(to_picoseconds(settings.daq.output_delay)),
      delay_(delay),
      latched_(read_bytes(settings, devices_.size()) / 4),
      tips_(devices_.size(), Eigen::Vector3d::Zero()),
      moving_(std::ranges::any_of(devices_, [](const auto* d) { return d->has_mass(); })) {
  from_bus.register_b_transport(this, &DaqBoard::b_transport);
}

void DaqBoard::b_transport(tlm::tlm_generic_payload& transaction, sc_core::sc_time& /*delay*/) {
  Tag none;
  Tag& tag = tag_of(transaction, none);
  const std::uint64_t address = transaction.get_address();
  const unsigned bytes = transaction.get_data_length();
  transaction.set_response_status(tlm::TLM_OK_RESPONSE);

  if (transaction.is_write() && address == kLatch && bytes == 4) {
    latch(tag);
  } else if (transaction.is_read() && address == kPosition && bytes == 4 * latched_.size()) {
    std::memcpy(transaction.get_data_ptr(), latched_.data(), bytes);
  } else if (transaction.is_write() && address == kForce && bytes == 12 * devices_.size()) {
    put_out(transaction.get_data_ptr(), tag);
  } else {
    transaction.set_response_status(tlm::TLM_ADDRESS_ERROR_RESPONSE);
  }
}

void DaqBoard::latch(Tag& tag) {
  const Picoseconds start = now_ps();
  DeviceRecord* record = records(tag);
  if (tag.frame >= 0) ledger_.frame(tag.frame).latched = start;
  for (std::size_t d = 0; d < devices_.size(); ++d) {
    tips_[d] = devices_[d]->at(start - session_.begin).position;
    plant::Encoder::Reading reading{tips_[d], false};
    if (encoder_) reading = encoder_->read(tips_[d], kinematics_.get());
    for (std::size_t i = 0; i < 3; ++i) {
      const plant::Counts counts =
          plant::kPosition.to_counts(reading.position[static_cast<Eigen::Index>(i)]);
      latched_[3 * d + i] = counts.value;
      reading.wrong = reading.wrong || counts.saturated;
    }
    if (record == nullptr && !adc_) continue;
    const plant::PlantState plant = devices_[d]->plant();
    const Eigen::Vector3d current =
        adc_ ? read_currents(plant) : Eigen::Vector3d(Eigen::Vector3d::Zero());
    for (std::size_t i = 0; adc_ && i < 3; ++i) {
      latched_[3 * (devices_.size() + d) + i] =
          plant::kCurrent.to_counts(current[static_cast<Eigen::Index>(i)]).value;
    }
    if (record == nullptr) continue;
    record[d].plant = plant;
    record[d].read_wrong = reading.wrong;
    record[d].read_current = current;
  }
  wait(to_sc_time(sampling_));
  ledger_.extend(tag, Part::daq, Phase::sample, start, now_ps());
}

DeviceRecord* DaqBoard::records(const Tag& tag) {
  if (!moving_ || tag.frame < 0) return nullptr;
  std::vector<DeviceRecord>& records = ledger_.frame(tag.frame).devices;
  records.resize(devices_.size());
  return records.data();
}

Eigen::Vector3d DaqBoard::read_currents(const plant::PlantState& plant) const {
  return stage_.currents(plant.motor_force, plant.tip.position).unaryExpr([this](double current) {
    return adc_->read(current);
  });
}

plant::Drive DaqBoard::driven(const Eigen::Vector3d& force, const Eigen::Vector3d& tip) const {
  plant::Drive drive = stage_.drive(force, tip);
  if (!limits_) return drive;
  const double limit = limits_->force_N;
  const double asked = force.norm();
  const bool clamped = asked > limit;
  if (clamped) drive = stage_.drive(force * (limit / asked), tip);
  // A converter that rounds to its nearest step may round beyond the limit: the largest part of the
  // force that it does not.
  constexpr double kRounding = 1e-9;
  constexpr int kShares = 64;
  for (int part = kShares - 1; part >= 0 && drive.force.norm() > (1 + kRounding) * limit; --part) {
    const double share = static_cast<double>(part) / kShares;
    drive = stage_.drive(force * (share * std::min(1.0, limit / asked)), tip);
  }
  drive.current_saturated = drive.current_saturated || clamped;
  return drive;
}

// The converter works on while the host does; nobody waits for it, so that no event is due.
void DaqBoard::put_out(const unsigned char* words, const Tag& tag) {
  const Picoseconds start = now_ps();
  const Picoseconds settled = start + output_;
  const Picoseconds there = settled + delay_;
  DeviceRecord* record = records(tag);
  for (std::size_t d = 0; d < devices_.size(); ++d) {
    std::array<std::int32_t, 3> counts{};
    std::memcpy(counts.data(), words, sizeof(counts));
    words += sizeof(counts);
    const Eigen::Vector3d force(plant::kForce.to_value(counts[0]),
                                plant::kForce.to_value(counts[1]),
                                plant::kForce.to_value(counts[2]));
    const plant::Drive drive = driven(force, tips_[d]);
    devices_[d]->drive(there - session_.begin, drive.force, force);
    if (record != nullptr) record[d].drive = drive;
  }
  Tag output = tag;
  ledger_.extend(output, Part::daq, Phase::convert, start, settled);
  if (delay_ > 0) ledger_.extend(output, Part::host, Phase::delay, settled, there);
  ledger_.extend(output, Part::device, Phase::motor, there, there);
  ledger_.force_at_motor(output);
}

}  // namespace hvp::vp
