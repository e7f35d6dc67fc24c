#include "import/text.h"

namespace sinew::import {

bool is_utf8(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  for (std::size_t i = 0; i < text.size();) {
    const unsigned first = byte(i++);
    if (first < 0x80) continue;
    if (first < 0xC2 || first > 0xF4) return false;
    const std::size_t more = first < 0xE0 ? 1 : (first < 0xF0 ? 2 : 3);
    if (i + more > text.size()) return false;
    const unsigned second = byte(i);
    if ((first == 0xE0 && second < 0xA0) || (first == 0xF0 && second < 0x90)) return false;  // overlong
    if ((first == 0xED && second > 0x9F) || (first == 0xF4 && second > 0x8F)) return false;  // no character
    for (std::size_t k = 0; k < more; ++k)
      if ((byte(i++) & 0xC0) != 0x80) return false;
  }
  return true;
}

std::string clean_text(std::string_view text) {
  const bool utf8 = is_utf8(text);
  std::string clean;
  clean.reserve(text.size());
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < ' ' || byte == 0x7F) {
      clean += ' ';
    } else if (utf8 || byte < 0x80) {
      clean += c;
    } else {
      clean += static_cast<char>(0xC0 | byte >> 6);
      clean += static_cast<char>(0x80 | (byte & 0x3F));
    }
  }
  return clean;
}

std::string html_text(std::string_view text) {
  std::string out;
  for (const char c : text) switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      case '\'':
        out += "&#39;";
        break;
      default:
        out += c;
    }
  return out;
}

}  // namespace sinew::import
