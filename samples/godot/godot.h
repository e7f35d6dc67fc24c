// Godot's values, errors, methods and signals in C++, over the table of gdnative.h: no more than the two
// classes of this library need.
#pragma once

#include <array>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <vector>

#include "gdnative.h"

namespace godot {

using gdnative::Object;

/// In Godot's axes: Y up.
using Vector = std::array<float, 3>;
/// Three rows of a matrix, then the origin: what Godot's Transform holds.
using Transform = std::array<float, 12>;

/// From gdnative.h's tables, once, before anything else here.
void use(const gdnative::CoreTable& core, void* library);

/// Godot's error print, by the name of the method that is at fault.
void error(const char* method, const std::string& what);

/// One value of Godot's.
class Value {
 public:
  Value();
  Value(bool value);
  Value(int value) : Value(std::int64_t(value)) {}
  Value(std::int64_t value);
  Value(double value);
  Value(const char* words);
  Value(const Vector& value);
  Value(const Transform& value);
  Value(Value&& other) noexcept;
  Value(const Value&) = delete;
  Value& operator=(const Value&) = delete;
  ~Value();
  const gdnative::Variant* raw() const { return &variant_; }
  /// For Godot, who destroys it.
  gdnative::Variant release();

 private:
  gdnative::Variant variant_;
};

/// A call of one of this library's methods: its arguments, by number. One that is missing or of another type
/// is told to Godot's error print, and `good` is false from then on.
struct Call {
  const char* method;
  int count;
  const gdnative::Variant* const* arguments;
  bool good = true;

  bool has(int i) const { return i < count; }
  bool is(int i, gdnative::VariantType type) const;
  double real(int i, const char* name, std::optional<double> otherwise = {});
  std::int64_t whole(int i, const char* name, std::optional<std::int64_t> otherwise = {});
  std::string words(int i, const char* name);
  Vector vector(int i, const char* name);

 private:
  bool expect(int i, const char* name, std::initializer_list<gdnative::VariantType> types);
};

/// A method of a class of Godot's own, found once by name.
class Method {
 public:
  Method(const char* of, const char* name) : of_(of), name_(name) {}
  /// Arguments and result are memory of the exact types of Godot's: int64_t, double, bool, Object*,
  /// Transform, String.
  void call(Object* self, std::initializer_list<const void*> arguments, void* result = nullptr);

 private:
  const char* of_;
  const char* name_;
  gdnative::MethodBind* found_ = nullptr;
};

/// A string of Godot's, for as long as it is called with.
class Words {
 public:
  explicit Words(const std::string& utf8);
  Words(const Words&) = delete;
  Words& operator=(const Words&) = delete;
  ~Words();
  gdnative::String raw;
};

Object* parent_of(Object* node);
/// A Spatial's place in the scene.
Transform global_transform_of(Object* spatial);
void emit(Object* self, const char* signal, std::initializer_list<const Value*> values);
/// A file's bytes, wherever Godot finds it (res:// of an exported game, too); nothing, and told, if it does
/// not.
std::optional<std::vector<std::uint8_t>> read_file(const std::string& path, const char* method);

// ---- What the library registers ----

struct Argument {
  const char* name;
  gdnative::VariantType type;
};
void register_signal(const char* of, const char* name, std::initializer_list<Argument> arguments);
void register_class(const char* name, const char* base, void* (*create)(Object*, void*),
                    void (*destroy)(Object*, void*, void*));
void register_method(const char* of, const char* name,
                     gdnative::Variant (*call)(Object*, void*, void*, int, gdnative::Variant**));
void register_property(const char* of, const char* name, const Value& otherwise,
                       void (*set)(Object*, void*, void*, gdnative::Variant*),
                       gdnative::Variant (*get)(Object*, void*, void*));

/// A class T with T(Object* self) as `name`, a script for nodes of class `base`.
template <class T>
struct Class {
  const char* name;
  Class(const char* its_name, const char* base) : name(its_name) {
    register_class(
        name, base, [](Object* self, void*) -> void* { return new T(self); },
        [](Object*, void*, void* instance) { delete static_cast<T*>(instance); });
  }
  /// Value (T::*)(Call&).
  template <auto kMethod>
  Class& method(const char* its_name) {
    register_method(name, its_name,
                    [](Object*, void* data, void* instance, int count, gdnative::Variant** arguments) {
                      Call call{static_cast<const char*>(data), count, arguments};
                      return (static_cast<T*>(instance)->*kMethod)(call).release();
                    });
    return *this;
  }
  /// void (T::*)(Call&) with one argument, and Value (T::*)() const.
  template <auto kSet, auto kGet>
  Class& property(const char* its_name, const Value& otherwise) {
    register_property(
        name, its_name, otherwise,
        [](Object*, void* data, void* instance, gdnative::Variant* value) {
          Call call{static_cast<const char*>(data), 1, &value};
          (static_cast<T*>(instance)->*kSet)(call);
        },
        [](Object*, void*, void* instance) { return (static_cast<T*>(instance)->*kGet)().release(); });
    return *this;
  }
};

}  // namespace godot
