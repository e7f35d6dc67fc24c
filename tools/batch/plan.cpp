#include "batch/plan.h"

#include <cstdio>
#include <fstream>

#include "batch/digest.h"
#include "cli/files.h"
#include "sinew/skeleton/version.h"

namespace sinew::batch {
namespace {

namespace fs = std::filesystem;
using convert::Error;
using nlohmann::json;

fs::path shard_file(const fs::path& directory, int shard) {
  return directory / "shards" / (std::to_string(shard) + ".jsonl");
}

/// Units in the manifest's order, cut where a shard is full. Their text, a shard each.
std::vector<std::string> cut(const Manifest& manifest) {
  std::vector<std::string> shards;
  double filled = 0;
  for (const Unit& unit : manifest.units) {
    const bool full = filled > 0 && filled + unit.seconds > manifest.shard_seconds;
    if (shards.empty() || full) {
      shards.emplace_back();
      filled = 0;
    }
    shards.back() += cli::json_text(unit_json(unit)) + "\n";
    filled += unit.seconds;
  }
  return shards;
}

}  // namespace

Error write_plan(const Manifest& manifest, const std::string& program, const fs::path& directory, Plan& out) {
  const std::vector<std::string> shards = cut(manifest);
  Digest digest;
  double seconds = 0;
  for (const std::string& shard : shards) digest.add(shard);
  for (const Unit& unit : manifest.units) seconds += unit.seconds;
  out = {directory, program, digest.text(), static_cast<int>(shards.size()), manifest.units.size(), seconds};
  std::error_code code;
  if (fs::exists(directory / "plan.json", code)) {
    Plan there;
    if (Error error = open_plan(directory, there)) return error;
    if (there.digest == out.digest && there.program == program) return {};
    return {directory.string() + ": holds another plan; plans do not change: take another directory"};
  }
  fs::create_directories(directory / "shards", code);
  if (code) return {directory.string() + ": cannot be made: " + code.message()};
  for (int k = 1; k <= out.shards; ++k)
    if (Error error =
            cli::write_atomically(shard_file(directory, k).string(), shards[static_cast<std::size_t>(k - 1)]))
      return error;
  const json head = {{"format", "sinew-batch"}, {"version", 1},          {"sinew", version()},
                     {"program", program},      {"digest", out.digest},  {"shards", out.shards},
                     {"units", out.units},      {"seconds", out.seconds}};
  return cli::write_atomically((directory / "plan.json").string(), cli::json_text(head, 1) + "\n");
}

Error open_plan(const fs::path& directory, Plan& out) {
  const std::string path = (directory / "plan.json").string();
  json head;
  if (Error error = cli::read_json(path, head)) return {error.message + " (`sinew batch plan` makes one)"};
  try {
    if (head.at("format") != "sinew-batch" || head.at("version") != 1)
      return {path + ": is no plan of this version"};
    out = {directory,         head.at("program"), head.at("digest"),
           head.at("shards"), head.at("units"),   head.at("seconds")};
  } catch (const json::exception&) {
    return {path + ": is no plan"};
  }
  return {};
}

Error read_shard(const Plan& plan, int shard, std::vector<Unit>& out) {
  const std::string path = shard_file(plan.directory, shard).string();
  std::ifstream file(path);
  if (!file) return {path + ": file cannot be opened"};
  for (std::string line; std::getline(file, line);) {
    const json read = json::parse(line, nullptr, false);
    if (read.is_discarded() || !read_unit(read, out.emplace_back())) return {path + ": is damaged"};
  }
  return {};
}

std::vector<int> shards_of_part(const Plan& plan, int k, int n) {
  std::vector<int> all;
  for (int shard = k; shard <= plan.shards; shard += n) all.push_back(shard);
  return all;
}

bool read_part(const std::string& text, int& k, int& n) {
  char rest = 0;
  return std::sscanf(text.c_str(), "%d/%d%c", &k, &n, &rest) == 2 && k >= 1 && k <= n && n <= 1000000;
}

}  // namespace sinew::batch
