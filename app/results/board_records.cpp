#include "app/results/board_records.h"

#include <algorithm>
#include <array>
#include <boost/crc.hpp>
#include <cstring>
#include <fstream>
#include <ios>
#include <stdexcept>
#include <system_error>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "app/results/number_text.h"
#include "driver/linux/guest/servo_frames.h"
#include "driver/linux/hvp_ioctl.h"

namespace hvp::results {

RegisterLog::RegisterLog(const std::filesystem::path& path) : stream_(path) {
  stream_.write("# time_us access register bytes first_word outcome\n");
}

void RegisterLog::access(vp::Picoseconds time, vp::Command command, const vp::RegisterBank& bank,
                         const vp::AccessResult& outcome, std::uint64_t offset,
                         std::span<const std::uint8_t> data) {
  std::uint32_t word = 0;
  std::memcpy(&word, data.data(), std::min(data.size(), sizeof(word)));
  stream_.write(fmt::format("{} {} {} {} {:#010x} {}\n", microseconds(time),
                            command == vp::Command::read ? "read" : "write", bank.name_at(offset),
                            data.size(), word, vp::name(outcome.access)));
}

DmaLog::DmaLog(const std::filesystem::path& path) : stream_(path) {
  stream_.write("# began_us ended_us job access what address bytes crc32 outcome\n");
}

void DmaLog::transferred(const vp::MasterAccess& access) {
  boost::crc_32_type checksum;
  checksum.process_bytes(access.data.data(), access.data.size());
  stream_.write(fmt::format("{} {} {} {} {} {:#x} {} {:#010x} {}\n", microseconds(access.began),
                            microseconds(access.ended), access.frame,
                            access.read ? "read" : "write", vp::name(access.purpose),
                            access.address, access.data.size(), checksum.checksum(),
                            access.answered ? "ok" : "refused"));
}

void trace_dma(vp::DmaEngine* engine, vp::MasterObserver& lanes,
               const std::filesystem::path& folder, std::optional<DmaLog>& log) {
  if (engine == nullptr) {
    spdlog::warn("--trace-dma: the board moves nothing by itself (transfer.method)");
    return;
  }
  engine->observe(lanes);
  if (!folder.empty()) engine->observe(log.emplace(folder / "dma.log"));
}

namespace {

// The tracer does not say whether the disk took all: a whole file ends with its last line's end.
bool ends_with_a_line(std::fstream& file) {
  file.seekg(-1, std::ios::end);
  return file.get() == '\n';
}

// The line behind "$date".
void blank_date(std::fstream& file) {
  file.seekg(0);
  std::string line;
  while (std::getline(file, line) && !line.starts_with("$date")) {
  }
  const std::streampos begin = file.tellg();
  if (!std::getline(file, line) || line.starts_with('$')) return;
  file.seekp(begin);
  file << std::string(line.size(), ' ');
}

// An FST file is a row of sections: a byte that says what it is, and the length of the rest in
// eight bytes, the most significant one first. A whole file ends with a section.
bool ends_with_a_section(std::fstream& file) {
  file.seekg(0, std::ios::end);
  const auto size = static_cast<std::uint64_t>(file.tellg());
  std::uint64_t position = 0;
  while (position < size) {
    std::array<unsigned char, 9> head{};
    file.seekg(static_cast<std::streamoff>(position));
    file.read(reinterpret_cast<char*>(head.data()), head.size());
    if (!file) return false;
    std::uint64_t length = 0;
    for (std::size_t i = 1; i < head.size(); ++i) length = length << 8U | head.at(i);
    if (length == 0 || length > size - position - 1) return false;
    position += 1 + length;
  }
  return position > 0;
}

// In the file's first section.
void blank_fst_date(std::fstream& file) {
  constexpr std::streamoff kDate = 202;
  constexpr std::size_t kDateBytes = 119;
  file.seekp(kDate);
  file << std::string(kDateBytes, '\0');
}

std::string_view suffix(WaveformFormat format) {
  return format == WaveformFormat::vcd ? "vcd" : "fst";
}

}  // namespace

WaveformFile::WaveformFile(const std::filesystem::path& folder, std::string_view name,
                           WaveformFormat format)
    : format_(format),
      part_(folder / fmt::format("{}.part.{}", name, suffix(format))),
      path_(folder / fmt::format("{}.{}", name, suffix(format))) {}

WaveformFile::~WaveformFile() {
  if (finished_) return;
  std::error_code ignored;
  std::filesystem::remove(part_.path(), ignored);
}

std::string WaveformFile::tracer_file() const {
  std::filesystem::path file = part_.path();
  return file.replace_extension().string();
}

void WaveformFile::finish() {
  {
    std::fstream file(part_.path(), std::ios::binary | std::ios::in | std::ios::out);
    if (format_ == WaveformFormat::fst) {
      if (file && ends_with_a_section(file)) {
        blank_fst_date(file);
      } else {
        file.setstate(std::ios::failbit);
      }
    } else if (file && ends_with_a_line(file)) {
      blank_date(file);
    }
    file.close();
    if (!file) throw std::runtime_error(fmt::format("cannot write {}", path_.string()));
  }
  std::filesystem::rename(part_.path(), path_);
  finished_ = true;
}

namespace {

constexpr std::size_t kWordBytes = 4;
// Offsets of the number of frames in each file's head, which is written last.
constexpr std::size_t kCountInFrames = 4 * kWordBytes;
constexpr std::size_t kCountInSolutions = 3 * kWordBytes;
constexpr std::uint64_t kPicosecondsPerNanosecond = 1000;

void put(std::string& bytes, std::uint32_t word) {
  for (unsigned shift = 0; shift < 32; shift += 8) {
    bytes += static_cast<char>(static_cast<unsigned char>(word >> shift));
  }
}

void put_long(std::string& bytes, std::uint64_t number) {
  put(bytes, static_cast<std::uint32_t>(number));
  put(bytes, static_cast<std::uint32_t>(number >> 32U));
}

void put_all(std::string& bytes, std::span<const std::int32_t> elements) {
  for (const std::int32_t element : elements) put(bytes, static_cast<std::uint32_t>(element));
}

std::string bytes_of(std::uint32_t word) {
  std::string bytes;
  put(bytes, word);
  return bytes;
}

std::uint32_t flags_of(const hvp_solver_config& c) {
  std::uint32_t flags = 0;
  const auto add = [&flags](bool there, std::uint32_t flag) { flags |= there ? flag : 0U; };
  add(c.dynamic_scaling, HVP_IOC_C_DYNAMIC_SCALING);
  add(c.scaling_up_only, HVP_IOC_C_SCALING_UP_ONLY);
  add(c.fixed_coefficients, HVP_IOC_C_FIXED_COEFFICIENTS);
  add(c.one_a_word, HVP_IOC_C_ONE_A_WORD);
  add(c.wrap_overflow, HVP_IOC_C_WRAP_OVERFLOW);
  add(c.reject_saturated, HVP_IOC_C_REJECT_SATURATED);
  return flags;
}

}  // namespace

JobRecord::JobRecord(const std::filesystem::path& folder, vp::Picoseconds period)
    : frames_(folder / "jobs.hvpf"),
      solutions_(folder / "jobs.hvpu"),
      period_ns_(static_cast<std::uint64_t>(period) / kPicosecondsPerNanosecond) {}

void JobRecord::end(std::string_view why) {
  if (!ended_) ended_ = why;
}

void JobRecord::configured(const hvp_solver_config& c) {
  if (!config_.empty()) return end("the board was set up again");
  put(config_, c.method);
  put(config_, c.start);
  put(config_, c.iterations);
  put_long(config_, c.stop_residual);
  for (const std::uint32_t word :
       {c.replace_every, c.static_shift, flags_of(c), c.headroom_bits, c.scaling_threshold,
        c.scaling_step, c.matrix_bits, c.vector_bits, c.rhs_bits, c.scalar_bits, c.coefficient_bits,
        c.alpha_fraction, c.beta_fraction}) {
    put(config_, word);
  }
  put(config_, c.division_rounding);
  put(config_, c.shift_rounding);
}

void JobRecord::loaded(const hvp_matrix& matrix) {
  if (ended_ || loaded_) return end("the board was set up again");
  loaded_ = true;
  std::string head;
  for (const std::uint32_t word :
       {static_cast<std::uint32_t>(SERVO_FRAMES_MAGIC), static_cast<std::uint32_t>(SERVO_VERSION),
        matrix.nodes, matrix.blocks, 0U}) {
    put(head, word);
  }
  put_long(head, period_ns_);
  put(head, 0);
  head += config_;
  put_all(head, {matrix.row_begin, matrix.nodes + std::size_t{1}});
  put_all(head, {matrix.column, matrix.blocks});
  put_all(head, {matrix.value, std::size_t{9} * matrix.blocks});
  frames_.write(head);

  head.clear();
  for (const std::uint32_t word : {static_cast<std::uint32_t>(SERVO_OUTPUT_MAGIC),
                                   static_cast<std::uint32_t>(SERVO_VERSION), matrix.nodes, 0U}) {
    put(head, word);
  }
  solutions_.write(head);
}

void JobRecord::guessed(std::span<const std::int32_t> u) {
  const bool zero = std::ranges::all_of(u, [](std::int32_t word) { return word == 0; });
  if (!zero || jobs_ > 0) end("the host gave the board a U to start from");
}

void JobRecord::constrained(std::uint32_t node, std::int32_t diagonal) {
  if (ended_) return;
  ++change_count_;
  put(changes_, SERVO_CONSTRAIN);
  put(changes_, node);
  put(changes_, static_cast<std::uint32_t>(diagonal));
}

void JobRecord::restored(std::uint32_t node, std::span<const std::int32_t> values) {
  if (ended_) return;
  ++change_count_;
  put(changes_, SERVO_RESTORE);
  put(changes_, node);
  put(changes_, static_cast<std::uint32_t>(values.size() / 9));
  put_all(changes_, values);
}

void JobRecord::renewed(std::span<const std::int32_t> /*values*/) {
  end("all values of the matrix were renewed");
}

void JobRecord::started(std::span<const std::int32_t> b) {
  if (!job_.empty()) end("a job failed");
  if (ended_) return;
  put(job_, change_count_);
  job_ += changes_;
  put_all(job_, b);
  changes_.clear();
  change_count_ = 0;
}

void JobRecord::solved(std::span<const std::int32_t> u, std::uint32_t flags) {
  if (ended_ || job_.empty()) return;
  frames_.write(job_);
  job_.clear();
  solution_.clear();
  for (int time = 0; time < 5; ++time) put_long(solution_, 0);
  put(solution_, HVP_OK);
  put(solution_, flags);
  put_all(solution_, u);
  solutions_.write(solution_);
  ++jobs_;
}

void JobRecord::finish() {
  if (!job_.empty()) end("a job failed");
  if (jobs_ == 0) end("no job was solved");
  const std::string count = bytes_of(jobs_);
  frames_.overwrite(kCountInFrames, count);
  solutions_.overwrite(kCountInSolutions, count);
  frames_.finish();
  solutions_.finish();
}

}  // namespace hvp::results
