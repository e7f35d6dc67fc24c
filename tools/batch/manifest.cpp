#include "batch/manifest.h"

#include <map>
#include <set>

#include "batch/digest.h"
#include "batch/sources.h"
#include "cli/files.h"
#include "import/plain_words.h"

namespace sinew::batch {
namespace {

namespace fs = std::filesystem;
using convert::Error;
using nlohmann::json;

struct Fault : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A job of the manifest: what its units have in common.
struct JobEntry {
  std::string kind, name, ending;
  std::vector<std::string> inputs, arguments;
  double seconds = 0;  ///< of one unit; 0: not known
};

/// What a unit takes where the manifest does not say it, s: on a core of 2020, for files of this size in MB.
/// It only decides how many units a shard gets.
double estimate(const std::string& kind, double megabytes) {
  if (kind == "convert") return 0.2 + 0.2 * megabytes;
  return kind == "render" ? 15 : 60;
}

std::string text_of(const json& value, const std::string& where) {
  if (!value.is_string() || value.get<std::string>().empty()) throw Fault(where + " is not a text");
  return value;
}

double positive(const json& value, const std::string& where) {
  if (!value.is_number() || !(value.get<double>() > 0) || value.get<double>() > 1e6)
    throw Fault(where + " is not a number of seconds above 0");
  return value;
}

std::vector<std::string> texts(const json& value, const std::string& where) {
  if (value.is_string()) return {text_of(value, where)};
  if (!value.is_array() || value.empty()) throw Fault(where + " is neither a text nor a list of texts");
  std::vector<std::string> all;
  for (const json& item : value) all.push_back(text_of(item, where + "[" + std::to_string(all.size()) + "]"));
  return all;
}

/// Arguments that name a file beside the manifest become its absolute path.
std::vector<std::string> arguments_of(const json& value, const std::string& where, const fs::path& folder) {
  static const std::set<std::string> kOurs = {"-o",       "--output",    "--json",  "-q",        "--quiet",
                                              "--report", "--telemetry", "--watch", "--dry-run", "-j",
                                              "--jobs",   "--help",      "-h"};
  std::vector<std::string> all = texts(value, where);
  for (std::string& argument : all) {
    if (kOurs.count(argument.substr(0, argument.find('='))) > 0)
      throw Fault(where + ": " + argument + " is not for batches");
    std::error_code code;
    if (fs::is_regular_file(folder / argument, code))
      argument = fs::absolute(folder / argument).lexically_normal();
  }
  return all;
}

/// A path within the result, not above it.
std::string place(const json& value, const std::string& where) {
  const fs::path path = fs::path(text_of(value, where)).lexically_normal();
  if (path.is_absolute() || path.begin()->string() == "..")
    throw Fault(where + " is not a place below the result");
  return path.string();
}

JobEntry read_job(const json& job, const std::string& where, const fs::path& folder) {
  if (!job.is_object()) throw Fault(where + " is not an object");
  JobEntry out;
  for (const char* kind : {"convert", "render", "study"})
    if (job.contains(kind)) {
      if (!out.kind.empty()) throw Fault(where + " has both '" + out.kind + "' and '" + kind + "'");
      out.kind = out.name = kind;
      out.inputs = texts(job[kind], where + "." + kind);
    }
  if (out.kind.empty()) throw Fault(where + " has neither 'convert' nor 'render' nor 'study'");
  out.ending = out.kind == "convert" ? ".sinew" : out.kind == "render" ? ".mp4" : "";
  for (const auto& [key, value] : job.items()) {
    const std::string here = where + "." + key;
    if (key == "name")
      out.name = place(value, here);
    else if (key == "arguments")
      out.arguments = arguments_of(value, here, folder);
    else if (key == "seconds")
      out.seconds = positive(value, here);
    else if (key == "ending" && out.kind == "render")
      out.ending = text_of(value, here);
    else if (key != out.kind)
      throw Fault(where + ": unknown key '" + key + "'");
  }
  if (out.ending.find('/') != std::string::npos) throw Fault(where + ".ending is not an ending");
  return out;
}

/// Studies: the words after `sinew study`, parted by blanks.
void add_studies(const JobEntry& job, std::vector<Unit>& out) {
  for (const std::string& words : job.inputs) {
    Unit unit{words, job.kind, "", job.seconds > 0 ? job.seconds : estimate(job.kind, 0), "", "", {}};
    for (char& c : unit.name)
      if (c == ' ' || c == '/') c = '_';
    unit.name = job.name + "/" + unit.name;
    std::istringstream in(words);
    for (std::string word; in >> word;) unit.arguments.push_back(word);
    unit.arguments.insert(unit.arguments.end(), job.arguments.begin(), job.arguments.end());
    out.push_back(std::move(unit));
  }
}

void add_files(const JobEntry& job, const fs::path& folder, std::vector<Unit>& out) {
  std::set<std::string> endings = source_endings();
  if (job.kind == "render") endings.insert(".sinew");
  std::map<fs::path, fs::path> found, names;
  for (const std::string& input : job.inputs) {
    const fs::path path = fs::absolute(folder / input).lexically_normal();
    std::error_code code;
    if (!fs::exists(path, code)) throw Fault(path.string() + ": no such file or folder");
    if (const Error error = find_sources(path, endings, found)) throw Fault(error.message);
  }
  if (found.empty()) throw Fault(job.inputs[0] + ": no file to " + job.kind + " in it");
  if (const Error error = name_outputs(found, job.ending, names)) throw Fault(error.message);
  for (const auto& [source, name] : names) {
    std::error_code code;
    const double megabytes = 1e-6 * static_cast<double>(fs::file_size(source, code));
    out.push_back({job.name + "/" + name.generic_string(), job.kind, "",
                   job.seconds > 0 ? job.seconds : estimate(job.kind, code ? 0 : megabytes), source.string(),
                   job.ending, job.arguments});
  }
}

/// Adds what a JSON file (a scene, a glTF) names beside itself, and what these name.
void add_named(const fs::path& path, Digest& digest, std::set<fs::path>& seen, int depth) {
  if (!seen.insert(path).second) return;
  digest.add(path.filename().string());
  digest.add_file(path);
  const std::string ending = lower(path.extension().string());
  if ((ending != ".json" && ending != ".gltf") || depth > 4) return;
  json file;
  if (cli::read_json(path.string(), file)) return;
  const json flat = file.flatten();
  for (const auto& [pointer, value] : flat.items()) {
    if (!value.is_string() || value.get<std::string>().size() > 1000) continue;
    const fs::path named = path.parent_path() / value.get<std::string>();
    std::error_code code;
    if (fs::is_regular_file(named, code)) add_named(named.lexically_normal(), digest, seen, depth + 1);
  }
}

void read(const json& file, const fs::path& folder, Manifest& out) {
  if (!file.is_object() || !file.contains("jobs") || !file["jobs"].is_array() || file["jobs"].empty())
    throw Fault("it has no list of 'jobs'");
  for (const auto& [key, value] : file.items()) {
    if (key == "shard_seconds")
      out.shard_seconds = positive(value, key);
    else if (key != "jobs")
      throw Fault("unknown key '" + key + "'");
  }
  for (std::size_t k = 0; k < file["jobs"].size(); ++k) {
    const JobEntry job = read_job(file["jobs"][k], "jobs[" + std::to_string(k) + "]", folder);
    if (job.kind == "study")
      add_studies(job, out.units);
    else
      add_files(job, folder, out.units);
  }
}

}  // namespace

Error read_manifest(const fs::path& path, const std::string& program, Manifest& out) {
  json file;
  if (Error error = cli::read_json(path.string(), file)) return error;
  out = {};
  try {
    read(file, fs::absolute(path).parent_path(), out);
  } catch (const std::exception& e) {
    return {path.string() + ": " + import::plain_words(e)};
  }
  std::set<std::string> names;
  for (Unit& unit : out.units) {
    if (!names.insert(unit.name).second)
      return {path.string() + ": two jobs make '" + unit.name + "': give one of them a 'name'"};
    unit.key = key_of(unit, program);
  }
  return {};
}

std::string key_of(const Unit& unit, const std::string& program) {
  Digest digest;
  for (const std::string& part : {program, unit.kind, unit.ending}) digest.add(part);
  for (const std::string& argument : unit.arguments) {
    std::error_code code;
    const bool is_file = fs::path(argument).is_absolute() && fs::is_regular_file(argument, code);
    digest.add(is_file ? "file" : argument);
    if (is_file) digest.add_file(argument);
  }
  std::set<fs::path> seen;
  if (!unit.input.empty()) {
    add_named(unit.input, digest, seen, 0);
    digest.add_file(convert::clip_data_beside(unit.input));
  }
  return digest.text();
}

json unit_json(const Unit& unit) {
  return {{"name", unit.name},          {"kind", unit.kind},   {"key", unit.key},
          {"seconds", unit.seconds},    {"input", unit.input}, {"ending", unit.ending},
          {"arguments", unit.arguments}};
}

bool read_unit(const json& line, Unit& out) {
  try {
    out = {line.at("name"),
           line.at("kind"),
           line.at("key"),
           line.at("seconds"),
           line.at("input"),
           line.at("ending"),
           line.at("arguments").get<std::vector<std::string>>()};
  } catch (const json::exception&) {
    return false;
  }
  return out.key.size() == 16;
}

std::string program_digest() {
  std::error_code unknown;
  const fs::path here = fs::read_symlink("/proc/self/exe", unknown).parent_path();
  Digest digest;
  digest.add_file("/proc/self/exe");
  for (const char* beside : {"sinew-render", "sinew-study"}) digest.add_file(here / beside);
  return digest.text();
}

}  // namespace sinew::batch
