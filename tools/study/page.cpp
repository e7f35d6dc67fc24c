#include "study/page.h"

#include <fmt/format.h>

#include "study/words.h"

namespace sinew::study {
namespace {

std::string cells_of(const std::vector<std::string>& cells, const char* kind) {
  std::string html = "<tr>";
  for (const std::string& cell : cells) html += fmt::format("<{0}>{1}</{0}>", kind, escaped(cell));
  return html + "</tr>\n";
}

}  // namespace

void Table::head(const std::vector<std::string>& cells) {
  rows_ += cells_of(cells, "th");
}

void Table::row(const std::vector<std::string>& cells) {
  rows_ += cells_of(cells, "td");
}

std::string Table::html() const {
  return "<div class='scrolls'><table>\n" + rows_ + "</table></div>\n";
}

std::string paragraph(const std::string& text) {
  return "<p>" + escaped(text) + "</p>\n";
}

std::string figure(const std::string& svg, const std::string& narrow) {
  if (narrow.empty()) return "<figure class='scrolls'>" + svg + "</figure>\n";
  return "<figure class='on-desks'>" + svg + "</figure>\n<figure class='on-phones'>" + narrow + "</figure>\n";
}

std::string key_entry(const std::string& label, const Colour& colour) {
  return fmt::format(
      "<span data-key=\"{0}\"><i style='background: rgb({1:.0f}, {2:.0f}, {3:.0f})'></i>{0}</span> ",
      escaped(label), 255 * colour.red, 255 * colour.green, 255 * colour.blue);
}

}  // namespace sinew::study
