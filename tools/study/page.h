// Pieces of an HTML page. What goes in is plain text, but for SVG.
#pragma once

#include <string>
#include <vector>

#include "study/canvas.h"

namespace sinew::study {

/// Rows of cells; the first cell of each is its name. May have more than one head.
class Table {
 public:
  void head(const std::vector<std::string>& cells);
  void row(const std::vector<std::string>& cells);
  std::string html() const;

 private:
  std::string rows_;
};

std::string paragraph(const std::string& text);
/// A picture; `narrow` is shown instead on a phone, where there is one. Else what is too wide can be moved.
std::string figure(const std::string& svg, const std::string& narrow = {});
/// A name of a legend with its colour; the page's script hides and shows the line of that name.
std::string key_entry(const std::string& label, const Colour& colour);

}  // namespace sinew::study
