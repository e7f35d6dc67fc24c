#include "sinew/animation/side_names.h"

#include <algorithm>

#include "sinew/animation/clip_event.h"

namespace sinew {
namespace {

// Of ASCII alone: the same on every machine and under every locale.
bool is_lower(char c) {
  return c >= 'a' && c <= 'z';
}
bool is_upper(char c) {
  return c >= 'A' && c <= 'Z';
}
bool is_letter(char c) {
  return is_lower(c) || is_upper(c);
}
char lower(char c) {
  return is_upper(c) ? static_cast<char>(c - 'A' + 'a') : c;
}
char upper(char c) {
  return is_lower(c) ? static_cast<char>(c - 'a' + 'A') : c;
}

/// Where the word that begins at `begin` ends: at what is no letter, before a capital that follows a small
/// letter, and before the last capital of several that a small letter follows (LHip).
std::size_t end_of_word(std::string_view name, std::size_t begin) {
  std::size_t end = begin + 1;
  while (end < name.size() && is_letter(name[end])) {
    const bool small_follows = end + 1 < name.size() && is_lower(name[end + 1]);
    if (is_upper(name[end]) && (is_lower(name[end - 1]) || small_follows)) break;
    ++end;
  }
  return end;
}

/// `text` in the capitals of `model`, which is as long as it at least one letter.
void append_like(std::string_view model, std::string_view text, std::string& out) {
  const bool first = is_upper(model[0]), others = first && model.size() > 1 && is_upper(model[1]);
  for (std::size_t i = 0; i < text.size(); ++i) out += (i == 0 ? first : others) ? upper(text[i]) : text[i];
}

/// Appends a word with its side exchanged.
void append_mirrored(std::string_view word, std::string& out) {
  constexpr std::array<std::string_view, 2> kLong = {"left", "right"}, kShort = {"l", "r"};
  std::string small;
  std::transform(word.begin(), word.end(), std::back_inserter(small), lower);
  for (std::size_t side = 0; side < 2; ++side) {
    if (small == kShort[side]) return append_like(word, kShort[1 - side], out);
    if (!small.starts_with(kLong[side])) continue;
    append_like(word, kLong[1 - side], out);
    out += word.substr(kLong[side].size());
    return;
  }
  out += word;
}

int find(std::span<const std::string> names, std::string_view name) {
  const auto at = std::find(names.begin(), names.end(), name);
  return at == names.end() ? -1 : static_cast<int>(at - names.begin());
}

}  // namespace

std::string mirrored_name(std::string_view name) {
  std::string out;
  for (std::size_t i = 0; i < name.size();) {
    if (!is_letter(name[i])) {
      out += name[i++];
      continue;
    }
    const std::size_t end = end_of_word(name, i);
    append_mirrored(name.substr(i, end - i), out);
    i = end;
  }
  return out;
}

int find_mirrored(std::span<const std::string> names, int index) {
  const std::string& name = names[std::size_t(index)];
  std::string other = mirrored_name(name);
  if (other == name && !name.empty()) {
    constexpr std::string_view kFrom = "lrLR", kTo = "rlRL";
    if (const std::size_t at = kFrom.find(name[0]); at != std::string_view::npos) other[0] = kTo[at];
  }
  return other == name ? -1 : find(names, other);
}

std::uint32_t EventMirror::operator()(std::uint32_t name) const {
  const auto at = std::lower_bound(pairs.begin(), pairs.end(), name,
                                   [](const auto& pair, std::uint32_t n) { return pair[0] < n; });
  return at != pairs.end() && (*at)[0] == name ? (*at)[1] : name;
}

EventMirror mirror_events(std::span<const std::string> names) {
  EventMirror mirror;
  for (int i = 0; i < static_cast<int>(names.size()); ++i)
    if (const int other = find_mirrored(names, i); other >= 0)
      mirror.pairs.push_back({event_name(names[std::size_t(i)]), event_name(names[std::size_t(other)])});
  std::sort(mirror.pairs.begin(), mirror.pairs.end());
  return mirror;
}

}  // namespace sinew
