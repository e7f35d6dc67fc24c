#include "godot.h"

#include <cstring>
#include <deque>

namespace godot {

using namespace gdnative;

namespace {

const AnyFunction* core = nullptr;    // of the core table
const AnyFunction* script = nullptr;  // of NativeScript's
void* library = nullptr;
constexpr std::int64_t kNoSuchFile = 7;  // of Godot's errors

/// A function of the core table.
template <class F>
F* in_core(Entry<F> entry) {
  return entry.in(core);
}

template <class Bytes, class T>
Bytes bytes_of(const T& value) {
  static_assert(sizeof(Bytes) == sizeof(T));
  Bytes bytes;
  std::memcpy(&bytes, &value, sizeof bytes);
  return bytes;
}

std::string to_utf8(String words) {
  CharString utf8 = in_core(string_utf8)(&words);
  const std::string copy = in_core(char_string_get_data)(&utf8);
  in_core(char_string_destroy)(&utf8);
  in_core(string_destroy)(&words);
  return copy;
}

const char* name_of(VariantType type) {
  switch (type) {
    case kNil:
      return "null";
    case kBool:
      return "bool";
    case kInt:
      return "int";
    case kReal:
      return "float";
    case kString:
      return "String";
    case kVector3:
      return "Vector3";
    default:
      return "another type";
  }
}

}  // namespace

void use(const CoreTable& table, void* handle) {
  core = functions_of(table);
  script = functions_of(*native_script_of(table));
  library = handle;
}

void error(const char* method, const std::string& what) {
  in_core(print_error)(what.c_str(), method, "sinew", 0);
}

// ---- Values ----

Value::Value() {
  in_core(variant_new_nil)(&variant_);
}
Value::Value(bool value) {
  in_core(variant_new_bool)(&variant_, value);
}
Value::Value(std::int64_t value) {
  in_core(variant_new_int)(&variant_, value);
}
Value::Value(double value) {
  in_core(variant_new_real)(&variant_, value);
}
Value::Value(const char* words) {
  const Words string(words);
  in_core(variant_new_string)(&variant_, &string.raw);
}
Value::Value(const Vector& value) {
  const auto bytes = bytes_of<Vector3>(value);
  in_core(variant_new_vector3)(&variant_, &bytes);
}
Value::Value(const Transform& value) {
  const auto bytes = bytes_of<gdnative::Transform>(value);
  in_core(variant_new_transform)(&variant_, &bytes);
}
Value::Value(Value&& other) noexcept : variant_(other.release()) {}
Value::~Value() {
  in_core(variant_destroy)(&variant_);
}

Variant Value::release() {
  const Variant handed_over = variant_;
  in_core(variant_new_nil)(&variant_);
  return handed_over;
}

Words::Words(const std::string& utf8) {
  in_core(string_new)(&raw);
  in_core(string_parse_utf8)(&raw, utf8.c_str());
}
Words::~Words() {
  in_core(string_destroy)(&raw);
}

// ---- Arguments ----

bool Call::is(int i, VariantType type) const {
  return has(i) && in_core(variant_get_type)(arguments[i]) == type;
}

bool Call::expect(int i, const char* name, std::initializer_list<VariantType> types) {
  std::string wanted;
  for (const VariantType type : types) {
    if (is(i, type)) return true;
    wanted += std::string(wanted.empty() ? "" : " or ") + name_of(type);
  }
  const char* const there = has(i) ? name_of(in_core(variant_get_type)(arguments[i])) : "missing";
  if (good) error(method, std::string(name) + " must be " + wanted + ", and is " + there);
  return good = false;
}

double Call::real(int i, const char* name, std::optional<double> otherwise) {
  if (!has(i) && otherwise) return *otherwise;
  return expect(i, name, {kReal, kInt}) ? in_core(variant_as_real)(arguments[i]) : 0;
}

std::int64_t Call::whole(int i, const char* name, std::optional<std::int64_t> otherwise) {
  if (!has(i) && otherwise) return *otherwise;
  return expect(i, name, {kInt, kBool}) ? in_core(variant_as_int)(arguments[i]) : 0;
}

std::string Call::words(int i, const char* name) {
  return expect(i, name, {kString}) ? to_utf8(in_core(variant_as_string)(arguments[i])) : "";
}

Vector Call::vector(int i, const char* name) {
  if (!expect(i, name, {kVector3})) return {};
  return bytes_of<Vector>(in_core(variant_as_vector3)(arguments[i]));
}

// ---- Calls of Godot ----

void Method::call(Object* self, std::initializer_list<const void*> arguments, void* result) {
  if (!found_) found_ = in_core(method_bind_get_method)(of_, name_);
  if (!found_) return error(name_, std::string("this Godot has no such method of ") + of_);
  std::vector<const void*> list(arguments);
  in_core(method_bind_ptrcall)(found_, self, list.data(), result);
}

Object* parent_of(Object* node) {
  static Method get_parent{"Node", "get_parent"};
  Object* parent = nullptr;
  get_parent.call(node, {}, &parent);
  return parent;
}

Transform global_transform_of(Object* spatial) {
  static Method get_global_transform{"Spatial", "get_global_transform"};
  Transform place{1, 0, 0, 0, 1, 0, 0, 0, 1};
  get_global_transform.call(spatial, {}, &place);
  return place;
}

void emit(Object* self, const char* signal, std::initializer_list<const Value*> values) {
  static MethodBind* const emit_signal = in_core(method_bind_get_method)("Object", "emit_signal");
  const Value name(signal);
  std::vector<const Variant*> arguments{name.raw()};
  for (const Value* value : values) arguments.push_back(value->raw());
  CallError unused{};
  Variant result =
      in_core(method_bind_call)(emit_signal, self, arguments.data(), int(arguments.size()), &unused);
  in_core(variant_destroy)(&result);
}

std::optional<std::vector<std::uint8_t>> read_file(const std::string& path, const char* method) {
  static Method open{"_File", "open"}, get_len{"_File", "get_len"}, get_buffer{"_File", "get_buffer"};
  Object* const file = in_core(get_class_constructor)("_File")();
  const Words name(path);
  const std::int64_t to_read = 1;
  std::int64_t code = 0, size = 0;
  open.call(file, {&name.raw, &to_read}, &code);
  std::optional<std::vector<std::uint8_t>> result;
  if (code != 0) {
    error(method, path + (code == kNoSuchFile ? ": no such file" : ": it cannot be opened"));
  } else {
    ByteArray bytes;
    in_core(pool_byte_array_new)(&bytes);
    get_len.call(file, {}, &size);
    get_buffer.call(file, {&size}, &bytes);
    ByteArrayRead* const access = in_core(pool_byte_array_read)(&bytes);
    const std::uint8_t* const first = in_core(pool_byte_array_read_access_ptr)(access);
    result.emplace(first, first + in_core(pool_byte_array_size)(&bytes));
    in_core(pool_byte_array_read_access_destroy)(access);
    in_core(pool_byte_array_destroy)(&bytes);
  }
  in_core(object_destroy)(file);
  return result;
}

// ---- Registration ----

void register_class(const char* name, const char* base, void* (*create)(Object*, void*),
                    void (*destroy)(Object*, void*, void*)) {
  gdnative::register_class.in(script)(library, name, base, {create, nullptr, nullptr},
                                      {destroy, nullptr, nullptr});
}

void register_method(const char* of, const char* name,
                     Variant (*call)(Object*, void*, void*, int, Variant**)) {
  gdnative::register_method.in(script)(library, of, name, {0}, {call, const_cast<char*>(name), nullptr});
}

void register_property(const char* of, const char* name, const Value& otherwise,
                       void (*set)(Object*, void*, void*, Variant*), Variant (*get)(Object*, void*, void*)) {
  const Words none("");
  PropertyAttributes attributes{
      0, in_core(variant_get_type)(otherwise.raw()), 0, none.raw, kPropertyUsage, *otherwise.raw()};
  gdnative::register_property.in(script)(library, of, name, &attributes,
                                         {set, const_cast<char*>(name), nullptr}, {get, nullptr, nullptr});
}

void register_signal(const char* of, const char* name, std::initializer_list<Argument> arguments) {
  const Words its_name(name), none("");
  const Value nothing;
  std::vector<SignalArgument> list;
  std::deque<Words> names;  // until the call
  for (const Argument& argument : arguments)
    list.push_back(
        {names.emplace_back(argument.name).raw, argument.type, 0, none.raw, kPropertyUsage, *nothing.raw()});
  const Signal signal{its_name.raw, int(list.size()), list.data(), 0, nullptr};
  gdnative::register_signal.in(script)(library, of, &signal);
}

}  // namespace godot
