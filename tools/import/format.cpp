// What kind of file it is, and a first look at its shape, before any parser runs.
#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <stdexcept>

#include "import/readers.h"

namespace sinew::import {
namespace {

constexpr int kMaxTextNesting = 2000;  ///< brackets or tags; real files need about ten and one per node

std::string start_of(const std::string& content) {
  std::size_t at = content.rfind("\xEF\xBB\xBF", 0) == 0 ? 3 : 0;
  while (at < content.size() && std::isspace(static_cast<unsigned char>(content[at]))) ++at;
  return content.substr(at, 4096);
}

void check_bvh(const std::string& content, const ReadLimits& limits) {
  int depth = 0, joints = 0;
  for (std::size_t at = 0; at < content.size(); ++at) {
    if (content[at] == '{' && ++depth > limits.max_depth)
      throw std::runtime_error("joints are nested more than " + std::to_string(limits.max_depth) + " deep");
    if (content[at] == '}') --depth;
    if (content.compare(at, 5, "JOINT") == 0 && ++joints > limits.max_nodes)
      throw std::runtime_error("too many joints");
    if (content.compare(at, 6, "MOTION") == 0) break;
  }
  const std::size_t frames = content.find("Frames:");
  if (frames == std::string::npos) throw std::runtime_error("it has no MOTION section with frames");
  const double count = std::strtod(content.c_str() + frames + 7, nullptr);
  if (!(count >= 1) || count > double(content.size()))
    throw std::runtime_error("its number of frames is impossible");
  const std::size_t time = content.find("Frame Time:");
  const double step = time == std::string::npos ? 0 : std::strtod(content.c_str() + time + 11, nullptr);
  if (!(step > 0 && step < 1e6)) throw std::runtime_error("its frame time is not a positive number");
}

bool is_space(char c) {
  return std::isspace(static_cast<unsigned char>(c));
}

/// assimp 5.2.5 turns in place for ever, taking memory, where an index in a <p> is no number.
void check_index_lists(const std::string& content) {
  for (std::size_t at = content.find("<p"); at != std::string::npos; at = content.find("<p", at)) {
    at += 2;
    if (at == content.size() || (content[at] != '>' && !is_space(content[at]))) continue;
    at = std::min(content.find('>', at), content.size() - 1);
    while (++at < content.size() && content[at] != '<')
      if (!std::isdigit(static_cast<unsigned char>(content[at])) && !is_space(content[at]))
        throw std::runtime_error("a list of indices holds something that is no number");
  }
}

void check_xml_nesting(const std::string& content) {
  int depth = 0;
  std::size_t at = content.find('<');
  while (at != std::string::npos && at + 1 < content.size()) {
    const char next = content[at + 1];
    const bool comment = content.compare(at, 4, "<!--") == 0;
    const std::size_t end = comment ? content.find("-->", at + 4) : content.find('>', at);
    if (end == std::string::npos) return;  // the parser's own message says more
    if (next == '/') {
      --depth;
    } else if (next != '!' && next != '?' && content[end - 1] != '/' && ++depth > kMaxTextNesting) {
      throw std::runtime_error("its XML is nested too deeply");
    }
    at = content.find('<', end);
  }
}

}  // namespace

std::string detect_format(const std::string& content) {
  if (content.rfind("glTF", 0) == 0) return "glb";
  if (content.rfind("Kaydara FBX Binary", 0) == 0) return "fbx";
  const std::string start = start_of(content);
  if (start.rfind("; FBX", 0) == 0) return "fbx";
  if (start.rfind("HIERARCHY", 0) == 0) return "bvh";
  if (start[0] == '{' && content.find("\"asset\"") != std::string::npos) return "gltf";
  if (start[0] == '<') {
    if (start.find("<COLLADA") != std::string::npos) return "dae";
    if (content.find("<robot") != std::string::npos) return "urdf";
  }
  return {};
}

void check_json_nesting(std::string_view text) {
  int depth = 0;
  bool quoted = false;
  for (std::size_t at = 0; at < text.size(); ++at) {
    const char c = text[at];
    if (quoted) {
      if (c == '\\') ++at;
      if (c == '"') quoted = false;
    } else if (c == '"') {
      quoted = true;
    } else if ((c == '{' || c == '[') && ++depth > kMaxTextNesting) {
      throw std::runtime_error("its JSON is nested too deeply");
    } else if (c == '}' || c == ']') {
      --depth;
    }
  }
}

void check_shape(const std::string& content, const std::string& format, const ReadLimits& limits) {
  if (format == "bvh") check_bvh(content, limits);
  if (format == "gltf") check_json_nesting(content);
  if (format == "urdf" || format == "dae") check_xml_nesting(content);
  if (format == "dae") check_index_lists(content);
}

}  // namespace sinew::import
