#include "app/scenario/syntax.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "app/scenario/toml_parser.h"

namespace hvp::scenario {
namespace {

constexpr int kDeepest = 32;

// Finds the first bracket or dot that exceeds kDeepest, and control characters, which TOML has
// nowhere, by a scan that knows strings and comments and nothing else. On text that is not TOML it
// may lose its place, but never before the parser has stopped with an error of its own.
class PreliminaryScan {
 public:
  explicit PreliminaryScan(std::string_view text) : text_(text) {}

  void run() {
    refuse_control_characters();
    while (at_ < text_.size()) {
      const char c = text_[at_];
      if (c == '#') {
        at_ = std::min(text_.find('\n', at_), text_.size());
        continue;
      }
      if (c == '"' || c == '\'') {
        skip_string(c);
        continue;
      }
      count(c);
      ++at_;
    }
  }

 private:
  void refuse_control_characters() {
    for (at_ = 0; at_ < text_.size(); ++at_) {
      const auto c = static_cast<unsigned char>(text_[at_]);
      const bool line_end = c == '\r' && text_.substr(at_ + 1, 1) == "\n";
      if ((c >= 0x20U && c != 0x7FU) || c == '\t' || c == '\n' || line_end) continue;
      fail(fmt::format("control character U+{:04X}", static_cast<unsigned>(c)));
    }
    at_ = 0;
  }

  void count(char c) {
    switch (c) {
      case '[':
      case '{':
        dots_ = 0;
        if (++depth_ > kDeepest)
          fail(fmt::format("tables and lists nested more than {} deep", kDeepest));
        break;
      case ']':
      case '}':
        depth_ = std::max(0, depth_ - 1);
        break;
      case '.':
        if (++dots_ >= kDeepest) fail(fmt::format("keys more than {} deep", kDeepest));
        break;
      case '=':
      case ',':
      case '\n':
        dots_ = 0;
        break;
      default:
        break;
    }
  }

  [[noreturn]] void fail(std::string message) const {
    const auto before = text_.substr(0, at_);
    const auto line_begin = before.rfind('\n');
    const std::size_t column =
        at_ - (line_begin == std::string_view::npos ? 0 : line_begin + 1) + 1;
    throw SyntaxError{1 + static_cast<int>(std::count(before.begin(), before.end(), '\n')),
                      static_cast<int>(column), std::move(message)};
  }

  void skip_string(char quote) {
    const std::string triple(3, quote);
    if (text_.substr(at_, 3) != triple) {
      for (++at_; at_ < text_.size(); ++at_) {
        if (text_[at_] == '\n') return;
        if (text_[at_] == '\\' && quote == '"') {
          ++at_;
        } else if (text_[at_] == quote) {
          ++at_;
          return;
        }
      }
      return;
    }
    for (at_ += 3; at_ < text_.size(); ++at_) {
      if (text_[at_] == '\\' && quote == '"') {
        ++at_;
      } else if (text_.substr(at_, 3) == triple) {
        at_ += 3;
        // One or two quotes may stand before the closing three.
        for (int extra = 0; extra < 2 && text_.substr(at_, 1) == triple.substr(0, 1); ++extra) {
          ++at_;
        }
        return;
      }
    }
  }

  std::string_view text_;
  std::size_t at_ = 0;
  int depth_ = 0;
  int dots_ = 0;
};

int line_of(const toml::source_region& region) {
  return std::max(1, static_cast<int>(region.begin.line));
}

Node convert(const toml::node& source, int line) {
  Node node;
  node.origin.line = line;
  if (const toml::table* table = source.as_table()) {
    for (const auto& [key, member] : *table) {
      node.add(key.str(), convert(member, line_of(key.source())));
    }
  } else if (const toml::array* array = source.as_array()) {
    node.kind = Node::Kind::array;
    for (const toml::node& member : *array) {
      node.members.push_back(convert(member, line_of(member.source())));
    }
  } else if (const auto* text = source.as_string()) {
    node.kind = Node::Kind::text;
    node.text = text->get();
  } else if (const auto* integer = source.as_integer()) {
    node.kind = Node::Kind::integer;
    node.integer = integer->get();
  } else if (const auto* number = source.as_floating_point()) {
    node.kind = Node::Kind::number;
    node.number = number->get();
  } else if (const auto* boolean = source.as_boolean()) {
    node.kind = Node::Kind::boolean;
    node.boolean = boolean->get();
  } else {
    node.kind = Node::Kind::date;
  }
  return node;
}

}  // namespace

Node parse_toml(std::string_view text) {
  PreliminaryScan(text).run();
  try {
    const toml::table table = toml::parse(text);
    return convert(table, 1);
  } catch (const toml::parse_error& error) {
    throw SyntaxError{line_of(error.source()),
                      std::max(1, static_cast<int>(error.source().begin.column)),
                      std::string(error.description())};
  } catch (const TomlAssertion&) {
    throw SyntaxError{1, 1, "not TOML, in a way that the parser cannot place"};
  }
}

}  // namespace hvp::scenario
