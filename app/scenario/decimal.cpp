#include "app/scenario/decimal.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <vector>

namespace hvp::scenario {
namespace {

constexpr int kExponentLimit = 100000;

bool is_digit(char c) { return c >= '0' && c <= '9'; }

}  // namespace

std::optional<Decimal> read_decimal(std::string_view text, std::size_t& length) {
  Decimal result;
  std::size_t i = 0;
  if (i < text.size() && (text[i] == '+' || text[i] == '-')) result.negative = text[i++] == '-';
  bool point = false;
  for (; i < text.size(); ++i) {
    if (is_digit(text[i])) {
      result.digits += text[i];
      if (point) --result.exponent;
    } else if (text[i] == '.' && !point) {
      point = true;
    } else {
      break;
    }
  }
  if (result.digits.empty()) return std::nullopt;
  length = i;
  if (i < text.size() && (text[i] == 'e' || text[i] == 'E')) {
    ++i;
    bool negative = false;
    if (i < text.size() && (text[i] == '+' || text[i] == '-')) negative = text[i++] == '-';
    int exponent = 0;
    const std::size_t first = i;
    for (; i < text.size() && is_digit(text[i]); ++i) {
      exponent = std::min(kExponentLimit, 10 * exponent + (text[i] - '0'));
    }
    if (i > first) {
      length = i;
      result.exponent += negative ? -exponent : exponent;
    }
  }
  return result;
}

Decimal multiply(const Decimal& number, std::string_view factor) {
  if (factor == "1") return number;
  // Long multiplication, least significant digit first.
  std::vector<int> product(number.digits.size() + factor.size(), 0);
  for (std::size_t i = 0; i < number.digits.size(); ++i) {
    const int a = number.digits[number.digits.size() - 1 - i] - '0';
    int carry = 0;
    for (std::size_t j = 0; j < factor.size(); ++j) {
      const int b = factor[factor.size() - 1 - j] - '0';
      const int sum = product[i + j] + a * b + carry;
      product[i + j] = sum % 10;
      carry = sum / 10;
    }
    product[i + factor.size()] += carry;
  }
  Decimal result{number.negative, {}, number.exponent};
  for (auto digit = product.rbegin(); digit != product.rend(); ++digit) {
    result.digits += static_cast<char>('0' + *digit);
  }
  return result;
}

std::optional<double> nearest_double(const Decimal& number) {
  const bool zero = number.digits.find_first_not_of('0') == std::string::npos;
  if (zero) return number.negative ? -0.0 : 0.0;
  const std::string text =
      (number.negative ? "-" : "") + number.digits + "e" + std::to_string(number.exponent);
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || value == 0.0) {
    return std::nullopt;
  }
  return value;
}

Decimal shortest_decimal(double value) {
  std::array<char, 64> buffer{};
  const auto [end, error] = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value,
                                          std::chars_format::scientific);
  std::size_t length = 0;
  Decimal result = read_decimal({buffer.data(), end}, length).value_or(Decimal{});
  while (result.digits.size() > 1 && result.digits.back() == '0') {
    result.digits.pop_back();
    ++result.exponent;
  }
  return result;
}

std::string decimal_text(const Decimal& number) {
  std::string text = number.negative ? "-" : "";
  const std::string& digits = number.digits;
  if (digits == "0") return text + "0";
  const int count = static_cast<int>(digits.size());
  const int point = count + number.exponent;  // digits before the decimal point
  if (number.exponent >= 0 && point <= 9) {
    return text + digits + std::string(static_cast<std::size_t>(number.exponent), '0');
  }
  if (number.exponent < 0 && point > 0) {
    const auto whole = static_cast<std::size_t>(point);
    return text + digits.substr(0, whole) + "." + digits.substr(whole);
  }
  if (point <= 0 && point > -4) {
    return text + "0." + std::string(static_cast<std::size_t>(-point), '0') + digits;
  }
  text += digits.front();
  if (count > 1) text += "." + digits.substr(1);
  return text + "e" + std::to_string(point - 1);
}

}  // namespace hvp::scenario
