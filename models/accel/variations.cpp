#include "models/accel/variations.h"

#include <initializer_list>
#include <string_view>
#include <utility>

namespace hvp::accel {

namespace {

class Collector {
 public:
  explicit Collector(const Design& design) : design_(design) {}

  // A number of the architecture, from 1 to what a scenario may say at most.
  void number(std::string_view key, int Architecture::*member, int most,
              std::initializer_list<int> values) {
    for (const int value : values) {
      if (value < 1 || value > most || value == design_.architecture.*member) continue;
      Variation& v = add(std::string("accelerator.").append(key),
                         std::to_string(design_.architecture.*member), std::to_string(value));
      v.design.architecture.*member = value;
    }
  }

  // A number of the solver: it changes the words.
  void word(std::string_view key, int fixed::Settings::*member, std::initializer_list<int> values) {
    for (const int value : values) {
      if (value == design_.solver.*member) continue;
      Variation& v = add(std::string("solver.").append(key), std::to_string(design_.solver.*member),
                         std::to_string(value));
      v.design.solver.*member = value;
      v.numbers = true;
    }
  }

  template <class Enum>
  using Names = std::initializer_list<std::pair<std::string_view, Enum>>;

  template <class Enum>
  void choice(std::string_view key, Enum Architecture::*member, Names<Enum> values) {
    for (const auto& [name, value] : values) {
      if (value == design_.architecture.*member) continue;
      Variation& v = add(std::string("accelerator.").append(key),
                         name_of(values, design_.architecture.*member), std::string(name));
      v.design.architecture.*member = value;
    }
  }

  template <class Enum>
  void rule(std::string_view key, Enum fixed::Settings::*member, Names<Enum> values) {
    for (const auto& [name, value] : values) {
      if (value == design_.solver.*member) continue;
      Variation& v = add(std::string("solver.").append(key),
                         name_of(values, design_.solver.*member), std::string(name));
      v.design.solver.*member = value;
      v.numbers = true;
    }
  }

  std::vector<Variation> take() { return std::move(variations_); }

 private:
  template <class Enum>
  static std::string name_of(Names<Enum> names, Enum wanted) {
    for (const auto& [name, value] : names) {
      if (value == wanted) return std::string(name);
    }
    return {};
  }

  Variation& add(std::string key, std::string from, std::string to) {
    variations_.push_back({std::move(key), std::move(from), std::move(to), false, design_});
    return variations_.back();
  }

  const Design& design_;
  std::vector<Variation> variations_;
};

}  // namespace

std::vector<Variation> variations(const Design& design) {
  using fixed::Method;
  const Architecture& a = design.architecture;
  Collector c(design);
  c.number("partitions", &Architecture::partitions, 256,
           {a.partitions / 2, a.partitions - 1, a.partitions + 1, 2 * a.partitions});
  c.number("nodes_per_clock", &Architecture::nodes_per_clock, 64,
           {a.nodes_per_clock / 2, 2 * a.nodes_per_clock});
  c.number("package", &Architecture::package, 64, {a.package / 2, 2 * a.package});
  c.number("rows_in_parallel", &Architecture::rows_in_parallel, 3, {1, 3});
  c.number("pipeline_clocks", &Architecture::pipeline_clocks, 1000, {2 * a.pipeline_clocks});
  c.choice("absolute_value_register", &Architecture::absolute_value_register,
           {{"false", false}, {"true", true}});
  c.choice("direction_memory", &Architecture::direction_memory,
           {{"double-pumped", DirectionMemory::double_pumped},
            {"two-copies", DirectionMemory::two_copies},
            {"stall", DirectionMemory::stall}});
  c.choice("matrix_storage", &Architecture::matrix_storage,
           {{"full", MatrixStorage::full}, {"symmetric", MatrixStorage::symmetric}});
  c.number("direction_banks", &Architecture::direction_banks, 64, {2 * a.direction_banks});
  c.rule("method", &fixed::Settings::method,
         {{"cg", Method::cg},
          {"jacobi-pcg", Method::jacobi_pcg},
          {"block-jacobi-pcg", Method::block_jacobi_pcg},
          {"chronopoulos-gear", Method::chronopoulos_gear},
          {"pipelined-cg", Method::pipelined_cg}});
  c.word("matrix_bits", &fixed::Settings::matrix_bits, {12, 16, 18});
  c.word("vector_bits", &fixed::Settings::vector_bits, {16, 18, 24});
  c.word("iterations", &fixed::Settings::iterations, {(design.solver.iterations + 1) / 2});
  return c.take();
}

}  // namespace hvp::accel
