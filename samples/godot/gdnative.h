// What this library uses of GDNative, the C interface of Godot 3 for native code. Debian has no headers of
// it.
//
// Godot hands over tables of function pointers. Their order is fixed by modules/gdnative/gdnative_api.json of
// Godot's sources: a table never changes, what is new comes in a further table that `next` leads to. The
// places below are those of Godot 3.2.3; why_not() says whether a table is the one that is described here.
//
// Godot's values are bytes without alignment, of these sizes: as such they are passed, also by value, so none
// of them may have members of another type.
#pragma once

#include <cstddef>
#include <cstdint>

namespace gdnative {

using Object = void;      ///< of any class of Godot's
using MethodBind = void;  ///< a method of such a class

struct Variant {
  std::uint8_t bytes[24];
};
struct String {
  std::uint8_t bytes[sizeof(void*)];
};
struct CharString {
  std::uint8_t bytes[sizeof(void*)];
};
struct ByteArray {
  std::uint8_t bytes[sizeof(void*)];
};
struct ByteArrayRead;  ///< Godot's own
/// x, y, z: float.
struct Vector3 {
  std::uint8_t bytes[12];
};
/// Three rows of a matrix, then the origin: float.
struct Transform {
  std::uint8_t bytes[48];
};

enum VariantType : int { kNil = 0, kBool = 1, kInt = 2, kReal = 3, kString = 4, kVector3 = 7, kObject = 17 };

struct CallError {
  int error;  ///< 0: none
  int argument;
  int expected;
};

struct Version {
  unsigned major, minor;
};

/// What every table begins with.
struct Table {
  unsigned type;  ///< kCore or kNativeScript; there are others
  Version version;
  const Table* next;
};
enum TableType : unsigned { kCore = 0, kNativeScript = 1 };

/// The core table of version 1.0: these members, then the functions.
struct CoreTable {
  Table table;
  unsigned extension_count;
  const Table* const* extensions;
};

/// What the library's first function, godot_gdnative_init, is given.
struct InitOptions {
  bool in_editor;
  std::uint64_t core_api_hash, editor_api_hash, no_api_hash;
  void (*report_version_mismatch)(const Object* library, const char* what, Version wanted, Version there);
  void (*report_loading_error)(const Object* library, const char* what);
  Object* library;
  const CoreTable* core;
  const String* path;
};

/// The first function of a table; its others follow.
using AnyFunction = void (*)();
inline const AnyFunction* functions_of(const CoreTable& core) {
  return reinterpret_cast<const AnyFunction*>(&core + 1);
}
inline const AnyFunction* functions_of(const Table& extension) {
  return reinterpret_cast<const AnyFunction*>(&extension + 1);
}

/// A function of a table: its type, and its place among the table's functions.
template <class F>
struct Entry {
  int place;
  F* in(const AnyFunction* functions) const { return reinterpret_cast<F*>(functions[place]); }
};

// ---- The core table ----

inline constexpr Entry<void(ByteArray*)> pool_byte_array_new{155};
inline constexpr Entry<ByteArrayRead*(const ByteArray*)> pool_byte_array_read{165};
inline constexpr Entry<int(const ByteArray*)> pool_byte_array_size{169};
inline constexpr Entry<void(ByteArray*)> pool_byte_array_destroy{170};
inline constexpr Entry<const std::uint8_t*(const ByteArrayRead*)> pool_byte_array_read_access_ptr{268};
inline constexpr Entry<void(ByteArrayRead*)> pool_byte_array_read_access_destroy{270};
inline constexpr Entry<VariantType(const Variant*)> variant_get_type{507};
inline constexpr Entry<void(Variant*)> variant_new_nil{509};
inline constexpr Entry<void(Variant*, bool)> variant_new_bool{510};
inline constexpr Entry<void(Variant*, std::int64_t)> variant_new_int{512};
inline constexpr Entry<void(Variant*, double)> variant_new_real{513};
inline constexpr Entry<void(Variant*, const String*)> variant_new_string{514};
inline constexpr Entry<void(Variant*, const Vector3*)> variant_new_vector3{517};
inline constexpr Entry<void(Variant*, const Transform*)> variant_new_transform{523};
inline constexpr Entry<bool(const Variant*)> variant_as_bool{537};
inline constexpr Entry<std::int64_t(const Variant*)> variant_as_int{539};
inline constexpr Entry<double(const Variant*)> variant_as_real{540};
inline constexpr Entry<String(const Variant*)> variant_as_string{541};
inline constexpr Entry<Vector3(const Variant*)> variant_as_vector3{544};
inline constexpr Entry<void(Variant*)> variant_destroy{570};
inline constexpr Entry<const char*(const CharString*)> char_string_get_data{572};
inline constexpr Entry<void(CharString*)> char_string_destroy{573};
inline constexpr Entry<void(String*)> string_new{574};
inline constexpr Entry<CharString(const String*)> string_utf8{678};
inline constexpr Entry<bool(String*, const char*)> string_parse_utf8{679};
inline constexpr Entry<void(String*)> string_destroy{721};
inline constexpr Entry<void(Object*)> object_destroy{730};
inline constexpr Entry<MethodBind*(const char* of, const char* method)> method_bind_get_method{732};
inline constexpr Entry<void(MethodBind*, Object*, const void** arguments, void* result)> method_bind_ptrcall{
    733};
inline constexpr Entry<Variant(MethodBind*, Object*, const Variant** arguments, int count, CallError*)>
    method_bind_call{734};
inline constexpr Entry<Object* (*(const char* of))()> get_class_constructor{735};
inline constexpr Entry<void(const char* what, const char* function, const char* file, int line)> print_error{
    741};

// ---- The table of NativeScript: classes that scripts and scenes use ----

struct CreateFunction {
  void* (*create)(Object* self, void* data);
  void* data;
  void (*free)(void* data);
};
struct DestroyFunction {
  void (*destroy)(Object* self, void* data, void* instance);
  void* data;
  void (*free)(void* data);
};
struct MethodAttributes {
  int rpc;  ///< 0: not to be called over a network
};
struct MethodFunction {
  Variant (*call)(Object* self, void* data, void* instance, int count, Variant** arguments);
  void* data;
  void (*free)(void* data);
};
struct PropertyAttributes {
  int rpc;
  int type;  ///< VariantType
  int hint;  ///< 0: none
  String hint_string;
  int usage;  ///< kPropertyUsage
  Variant default_value;
};
enum { kPropertyUsage = 1 | 2 | 4 };  ///< saved, shown in the editor, sent
struct SetFunction {
  void (*set)(Object* self, void* data, void* instance, Variant* value);
  void* data;
  void (*free)(void* data);
};
struct GetFunction {
  Variant (*get)(Object* self, void* data, void* instance);
  void* data;
  void (*free)(void* data);
};
struct SignalArgument {
  String name;
  int type;  ///< VariantType
  int hint;
  String hint_string;
  int usage;
  Variant default_value;
};
struct Signal {
  String name;
  int count;
  SignalArgument* arguments;
  int default_count;
  Variant* defaults;
};

inline constexpr Entry<void(void* library, const char* name, const char* base, CreateFunction,
                            DestroyFunction)>
    register_class{0};
inline constexpr Entry<void(void* library, const char* of, const char* name, MethodAttributes,
                            MethodFunction)>
    register_method{2};
inline constexpr Entry<void(void* library, const char* of, const char* name, PropertyAttributes*, SetFunction,
                            GetFunction)>
    register_property{3};
inline constexpr Entry<void(void* library, const char* of, const Signal*)> register_signal{4};

// ---- Is it the table that is described? ----

/// The table of NativeScript 1, or null.
inline const Table* native_script_of(const CoreTable& core) {
  for (unsigned i = 0; i < core.extension_count; ++i)
    if (core.extensions[i]->type == kNativeScript) return core.extensions[i];
  return nullptr;
}

/// Null, or why nothing of it can be called: it is another Godot's than those from 3.2 on.
inline const char* why_not(const CoreTable* core) {
  if (!core || core->table.type != kCore) return "no core table was handed over";
  if (core->table.version.major != 1 || core->table.version.minor != 0)
    return "the core table is not of version 1.0, the only one that gdnative.h describes";
  const Table* last = core->table.next;
  while (last && !(last->version.major == 1 && last->version.minor == 2)) last = last->next;
  if (!last) return "there is no core table 1.2: Godot 3.2 or a later 3 is needed";
  if (core->extension_count == 0 || core->extension_count > 64)
    return "the core table has an absurd number of extensions";
  const Table* script = native_script_of(*core);
  if (!script || script->version.major != 1 || script->version.minor != 0)
    return "there is no table of NativeScript 1.0";
  return nullptr;
}

}  // namespace gdnative
