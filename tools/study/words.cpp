#include "study/words.h"

#include <fmt/format.h>

#include <cmath>

#include "import/text.h"

namespace sinew::study {
namespace {

/// To so many significant digits.
double rounded(double value, int digits) {
  const double unit = std::pow(10, std::floor(std::log10(value)) - digits + 1);
  return std::round(value / unit) * unit;
}

/// 12300 → "12,300"
std::string grouped(double whole) {
  std::string text = fmt::format("{:.0f}", whole);
  if (text.size() > 4)
    for (int at = static_cast<int>(text.size()) - 3; at > 0; at -= 3)
      text.insert(static_cast<std::size_t>(at), ",");
  return text;
}

}  // namespace

std::string number(double value) {
  if (!(value >= 0) || std::isinf(value)) return "–";
  if (value == 0) return "0";
  if (value < 9.95) {
    const double two = rounded(value, 2);
    const int decimals = std::max(0, 1 - static_cast<int>(std::floor(std::log10(two) + 1e-9)));
    std::string text = fmt::format("{:.{}f}", two, decimals);
    if (text.find('.') != std::string::npos) text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.') text.pop_back();
    return text;
  }
  return grouped(value < 1000 ? std::round(value) : rounded(value, 3));
}

std::string duration(double microseconds) {
  if (!(microseconds >= 0) || std::isinf(microseconds)) return "–";
  return microseconds < 1995 ? number(microseconds) + " µs" : number(microseconds / 1000) + " ms";
}

std::string length(double metres) {
  if (!(metres >= 0) || std::isinf(metres)) return "–";
  constexpr struct {
    double size, from;
    const char* name;
  } kUnits[] = {{1, 0.995, "m"},
                {1e-2, 0.995e-2, "cm"},
                {1e-3, 0.995e-4, "mm"},
                {1e-6, 0.995e-7, "µm"},
                {1e-9, 0, "nm"}};
  for (const auto& unit : kUnits)
    if (metres >= unit.from) {
      const double in_units = metres / unit.size;
      return (in_units >= 100 ? grouped(rounded(in_units, 2)) : number(in_units)) + " " + unit.name;
    }
  return {};
}

std::string rate(double h) {
  return number(1 / h) + " Hz";
}

std::string escaped(const std::string& text) {
  return import::html_text(text);
}

}  // namespace sinew::study
