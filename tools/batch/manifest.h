// What is wanted of a batch, as a file: the schema is in README.md.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "convert/convert.h"

namespace sinew::batch {

/// One process of `sinew`: what it makes depends on `key` alone.
struct Unit {
  std::string name;                    ///< of its output in the merged result, a relative path
  std::string kind;                    ///< "convert", "render" or "study"
  std::string key;                     ///< digest of the program, the arguments and all input
  double seconds = 0;                  ///< estimate
  std::string input;                   ///< absolute path; empty: a study
  std::string ending;                  ///< of the output (".sinew"); empty: a directory
  std::vector<std::string> arguments;  ///< without input and output
};

struct Manifest {
  std::vector<Unit> units;
  double shard_seconds = 60;
};

/// Reads a manifest and finds all its inputs. `program`: digest of the programs that will run.
convert::Error read_manifest(const std::filesystem::path& path, const std::string& program, Manifest& out);

/// The key of a unit as its input is now.
std::string key_of(const Unit& unit, const std::string& program);

nlohmann::json unit_json(const Unit& unit);
/// False: the line is not of this program.
bool read_unit(const nlohmann::json& line, Unit& out);

/// Digest of `sinew` and, where it stands beside it, of `sinew-study`: nodes with other programs are refused.
std::string program_digest();

}  // namespace sinew::batch
