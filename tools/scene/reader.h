// Checked access to the JSON of scene files. Faults are thrown as "what (where)" and caught by load_scene.
#pragma once

#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "sinew/skeleton/transform.h"

namespace sinew::scene {

using nlohmann::json;

[[noreturn]] inline void fail(const std::string& where, const std::string& what) {
  throw std::runtime_error(what + " (" + where + ")");
}

/// An object whose keys must all be known; remembers where it stands for messages.
class Reader {
 public:
  Reader(const json& value, std::string where, const std::vector<const char*>& keys)
      : value_(value), where_(std::move(where)) {
    if (!value.is_object()) fail(where_, "expected an object");
    const std::set<std::string> known(keys.begin(), keys.end());
    std::string list;
    for (const std::string& key : known) list += (list.empty() ? "" : ", ") + key;
    for (const auto& [key, v] : value.items())
      if (!known.count(key)) fail(where_, "unknown key '" + key + "', known are: " + list);
  }
  bool has(const char* key) const { return value_.contains(key); }
  const json& at(const char* key) const {
    if (!has(key)) fail(where_, std::string("'") + key + "' is missing");
    return value_[key];
  }
  double number(const char* key, double otherwise) const {
    return has(key) ? number_of(value_[key], inside(key)) : otherwise;
  }
  double positive(const char* key, double otherwise) const {
    const double v = number(key, otherwise);
    if (!(v > 0)) fail(inside(key), "must be positive");
    return v;
  }
  int count(const char* key, int otherwise, int least, int most) const {
    const double v = number(key, otherwise);
    if (v != std::floor(v) || v < least || v > most)
      fail(inside(key),
           "must be a whole number from " + std::to_string(least) + " to " + std::to_string(most));
    return static_cast<int>(v);
  }
  double time(const char* key, double otherwise) const {
    const double v = number(key, otherwise);
    if (v < 0) fail(inside(key), "must not be negative");
    return v;
  }
  std::string text(const char* key, const std::string& otherwise) const {
    if (!has(key)) return otherwise;
    if (!value_[key].is_string()) fail(inside(key), "expected a text");
    return value_[key].get<std::string>();
  }
  std::vector<std::string> texts(const char* key) const {
    std::vector<std::string> out;
    const json& values = list(key);
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (!values[i].is_string()) fail(item(key, i), "expected a text");
      out.push_back(values[i].get<std::string>());
    }
    return out;
  }
  bool flag(const char* key, bool otherwise) const {
    if (!has(key)) return otherwise;
    if (!value_[key].is_boolean()) fail(inside(key), "expected true or false");
    return value_[key].get<bool>();
  }
  Vec3<double> vector(const char* key, const Vec3<double>& otherwise) const {
    return has(key) ? vector_of(value_[key], inside(key)) : otherwise;
  }
  const json& list(const char* key) const {
    static const json none = json::array();
    if (!has(key)) return none;
    if (!value_[key].is_array()) fail(inside(key), "expected a list");
    return value_[key];
  }
  std::string inside(const char* key) const { return where_.empty() ? key : where_ + "." + key; }
  std::string item(const char* key, std::size_t i) const {
    return inside(key) + "[" + std::to_string(i) + "]";
  }

  static double number_of(const json& v, const std::string& where) {
    if (!v.is_number()) fail(where, "expected a number");
    const double x = v.get<double>();
    if (!std::isfinite(x)) fail(where, "is not finite");
    return x;
  }
  static Vec3<double> vector_of(const json& v, const std::string& where) {
    if (!v.is_array() || v.size() != 3) fail(where, "expected three numbers");
    return {number_of(v[0], where), number_of(v[1], where), number_of(v[2], where)};
  }

 private:
  const json& value_;
  std::string where_;
};

}  // namespace sinew::scene
