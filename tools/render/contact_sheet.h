// Many pictures on one.
#pragma once

#include <string>
#include <vector>

#include "convert/convert.h"

namespace sinew::render {

struct SheetEntry {
  std::string title;    ///< below the picture, shortened to its width
  std::string picture;  ///< PNG or JPEG
  std::string fault;    ///< shown where there is no picture
};

/// Writes OUT.png, and OUT_2.png, … for every hundred more: rows of pictures fitted into squares of 240
/// pixels. The files' names, in `written`.
convert::Error write_contact_sheets(const std::vector<SheetEntry>& entries, const std::string& output,
                                    std::vector<std::string>& written);

}  // namespace sinew::render
