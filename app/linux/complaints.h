#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace hvp::guest {

// A check that a kernel can be built with: a word of `hvp linux --check`, the name of its settings
// in driver/linux/kernel, and what the kernel's complaints about it contain.
struct Check {
  std::string_view word;
  std::vector<std::string_view> signs;
};

// All of a kernel's, by word. A further one is a further entry, and its settings WORD.config.
const std::vector<Check>& kernel_checks();

// The words of --check.
struct Checks {
  std::vector<std::string> of_kernel;  // each once, sorted
  bool dma = false;
  bool driver = false;
};
// Splits "kasan,driver". Throws InputError for a word that is none.
Checks parse_checks(std::string_view text);

// What a kernel with checks complains of, in the words of its console. Lines before the module
// comes on are the kernel's own affair.
class Complaints {
 public:
  // With no words it finds nothing.
  explicit Complaints(std::vector<std::string> words) : words_(std::move(words)) {}

  void read(std::string_view line);

  struct Complaint {
    std::string check;  // a word
    std::string text;   // the line, without its time
    std::int64_t count = 0;
  };
  const std::vector<std::string>& words() const { return words_; }
  // In the order in which they first came.
  const std::vector<Complaint>& found() const { return found_; }

 private:
  void add(std::string_view check, std::string_view text);

  std::vector<std::string> words_;
  std::vector<Complaint> found_;
  bool loaded_ = false;
};

}  // namespace hvp::guest
