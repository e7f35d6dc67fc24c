// Damaged, hostile and nonsensical files of every format, made on the spot.
#pragma once

#include <ostream>
#include <string>
#include <vector>

namespace sinew::import::test {

struct Malformed {
  std::string name;
  std::string file;  ///< name it is written under
  std::string content;
  std::string cause;  ///< regular expression that the message must match
};

/// Keeps the content out of test names.
inline void PrintTo(const Malformed& one, std::ostream* out) {
  *out << one.file;
}

/// All must be refused.
const std::vector<Malformed>& malformed_inputs();

}  // namespace sinew::import::test
