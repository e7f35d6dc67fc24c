#include "graph/located_json.h"

#include <set>

#include "import/plain_words.h"

namespace sinew::graph_tools {
namespace {

std::string escaped(const std::string& key) {
  std::string out;
  for (const char c : key) {
    if (c == '~')
      out += "~0";
    else if (c == '/')
      out += "~1";
    else
      out += c;
  }
  return out;
}

/// Counts the lines that have been read.
class CountingIterator {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;

  CountingIterator(const char* at, int* line) : at_(at), line_(line) {}
  reference operator*() const { return *at_; }
  CountingIterator& operator++() {
    if (*at_ == '\n') ++*line_;
    ++at_;
    return *this;
  }
  bool operator==(const CountingIterator& b) const { return at_ == b.at_; }
  bool operator!=(const CountingIterator& b) const { return at_ != b.at_; }

 private:
  const char* at_;
  int* line_;
};

/// Notes the line of everything; the value itself is parsed the ordinary way.
class LineNotes : public nlohmann::json_sax<Json> {
 public:
  LineNotes(std::map<std::string, int>& lines, const int& line) : lines_(lines), line_(line) {}

  bool null() override { return value(); }
  bool boolean(bool) override { return value(); }
  bool number_integer(number_integer_t) override { return value(); }
  bool number_unsigned(number_unsigned_t) override { return value(); }
  bool number_float(number_float_t, const string_t&) override { return value(); }
  bool string(string_t&) override { return value(); }
  bool binary(binary_t&) override { return value(); }
  bool start_object(std::size_t) override {
    open({false, 0, {}, {}});
    return true;
  }
  bool key(string_t& name) override {
    Level& level = levels_.back();
    if (!level.keys.insert(name).second) throw Fault(line_, "'" + name + "' stands twice");
    level.key = name;
    lines_[path()] = line_;
    return true;
  }
  bool end_object() override { return close(); }
  bool start_array(std::size_t) override {
    open({true, 0, {}, {}});
    return true;
  }
  bool end_array() override { return close(); }
  bool parse_error(std::size_t, const std::string&, const nlohmann::detail::exception& e) override {
    std::string what = import::plain_words(e);  // "line 1, column 2: syntax …"
    if (const auto colon = what.find(": "); colon != std::string::npos) what.erase(0, colon + 2);
    throw Fault(line_, "is no JSON: " + what);
  }

 private:
  struct Level {
    bool array;
    int index;
    std::string key;
    std::set<std::string> keys;
  };
  std::string path() const {
    std::string out;
    for (const Level& level : levels_)
      out += "/" + (level.array ? std::to_string(level.index) : escaped(level.key));
    return out;
  }
  void note() {
    if (levels_.empty() || levels_.back().array) lines_.emplace(path(), line_);
  }
  void open(const Level& level) {
    note();
    if (levels_.size() >= 64) throw Fault(line_, "is nested too deep");
    levels_.push_back(level);
  }
  bool value() {
    note();
    return next();
  }
  bool close() {
    levels_.pop_back();
    return next();
  }
  bool next() {
    if (!levels_.empty() && levels_.back().array) ++levels_.back().index;
    return true;
  }

  std::map<std::string, int>& lines_;
  const int& line_;
  std::vector<Level> levels_;
};

}  // namespace

int LocatedJson::line(std::string pointer) const {
  while (true) {
    if (const auto found = lines.find(pointer); found != lines.end()) return found->second;
    const auto slash = pointer.rfind('/');
    if (slash == std::string::npos) return 1;
    pointer.resize(slash);
  }
}

LocatedJson parse_located(const std::string& text) {
  LocatedJson out;
  int line = 1;
  LineNotes notes(out.lines, line);
  const CountingIterator begin(text.data(), &line), end(text.data() + text.size(), &line);
  Json::sax_parse(begin, end, &notes, nlohmann::detail::input_format_t::json, true, true);
  out.value = Json::parse(text, nullptr, true, true);
  return out;
}

}  // namespace sinew::graph_tools
