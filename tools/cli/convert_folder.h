// `sinew convert` of a folder, or of many files that are characters of their own.
#pragma once

#include <string>
#include <vector>

#include "convert/convert.h"

namespace sinew::cli {

struct FolderConversion {
  std::vector<std::string> inputs;   ///< folders, searched whole, and files
  std::string output;                ///< directory, made where it is missing
  std::vector<std::string> options;  ///< arguments that every conversion gets
  int jobs = 1;                      ///< processes at once
  bool dry_run = false;              ///< says what would be done
  bool again = false;                ///< also what is up to date
  bool watch = false;                ///< goes on, and converts what changes, until it is ended
  std::string report_file;           ///< JSON, or a page with pictures (.html)
  bool json = false;                 ///< the report on standard output
};

/// Converts every source by a process of its own; a folder's structure is that of the output. What was made
/// from the same bytes (of the source, what it refers to and what stands beside it), options and program is
/// left as it is: records of that are in OUTPUT/.sinew. Files are written whole or not, so this may be killed
/// at any moment and run twice at once. Prints a line for each source, and progress.
///
/// `failed`: how many could not be converted; all others are. An error is of the whole: no source, no
/// directory.
convert::Error convert_folder(const FolderConversion& what, int& failed);

}  // namespace sinew::cli
