// Which effects a scene file can declare. Adding one means one row in effect_registry.cpp (see
// runtime/sinew/effects/README.md).
#pragma once

#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "scene/reader.h"
#include "scene/scene.h"

namespace sinew::scene {

/// Joint by name or role; fails where there is none.
int joint_of(const Skeleton& skeleton, const std::string& name, const std::string& where);
/// Character by name or number; fails where there is none.
int character_named(const Scene& scene, const json& name, const std::string& where);

/// A name that the `effects` of a scene may hold. Either a module of runtime/sinew/effects or a term that the
/// solver has built in.
struct EffectRow {
  const char* name;
  const char* what;  ///< in a line
  /// Module: the objects that an entry with settings asks for, its makers already bound to them.
  SceneEffect (*read)(const json& entry, const std::string& where, const Scene& scene) = nullptr;
  /// Built in: takes it out of a scene whose list does not name it; puts it in where it is named.
  void (*leave_out)(Scene& scene) = nullptr;
  void (*put_in)(Scene& scene) = nullptr;
};

std::span<const EffectRow> effect_registry();

/// Applies the list `effects` of a scene file: what it does not name does not act. Without a list everything
/// that is built in acts, but self collision only where a character asks for it.
void declare_effects(const Reader& in, std::span<const EffectRow> registry, Scene& scene);

/// Reads an effect's settings, member by member, from a scene's entry.
class SettingsReader {
 public:
  explicit SettingsReader(const Reader& in) : in_(in) {}
  void operator()(const char* key, double& value) const { value = in_.number(key, value); }
  void operator()(const char* key, bool& value) const { value = in_.flag(key, value); }
  void operator()(const char* key, Vec3<double>& value) const { value = in_.vector(key, value); }
  void operator()(const char* key, std::string& value) const { value = in_.text(key, value); }
  void operator()(const char* key, std::vector<std::string>& value) const { value = in_.texts(key); }

 private:
  const Reader& in_;
};

/// Lists the keys of an effect's settings.
struct KeyCollector {
  std::vector<const char*>& keys;
  template <class Value>
  void operator()(const char* key, const Value& /*value*/) const {
    keys.push_back(key);
  }
};

/// Turns the names under `joints`, which may be roles, into a skeleton's.
struct JointNames {
  const Skeleton& skeleton;
  const std::string& where;
  template <class Value>
  void operator()(const char* /*key*/, Value& value) const {
    if constexpr (std::is_same_v<Value, std::vector<std::string>>)
      for (std::string& name : value) name = skeleton.joints[joint_of(skeleton, name, where)].name;
  }
};

/// On whom an entry acts: `characters` (names or numbers; all) and `props` (true).
SceneEffect effect_targets(const Reader& in, const Scene& scene);

/// A row for an effect class of the runtime, whose settings say by visit() what they hold.
template <template <class> class E>
EffectRow effect_row(const char* name, const char* what) {
  using Settings = typename E<float>::Settings;
  EffectRow row{name, what};
  row.read = [](const json& entry, const std::string& where, const Scene& scene) {
    Settings settings;
    std::vector<const char*> keys{"effect", "characters", "props"};
    settings.visit(KeyCollector{keys});
    const Reader in(entry, where, keys);
    settings.visit(SettingsReader(in));
    SceneEffect effect = effect_targets(in, scene);
    for (const int c : effect.characters) {
      Settings named = settings;
      named.visit(JointNames{scene.characters[c].asset->skeleton, where});  // all must be there
    }
    if (in.has("joints")) effect.props.clear();
    const auto make = [settings, where]<class T>(const Skeleton& skeleton) {
      Settings named = settings;
      named.visit(JointNames{skeleton, where});
      return std::unique_ptr<Effect<T>>(std::make_unique<E<T>>(named));
    };
    effect.make_float = [make](const Skeleton& s) { return make.template operator()<float>(s); };
    effect.make_double = [make](const Skeleton& s) { return make.template operator()<double>(s); };
    return effect;
  };
  return row;
}

}  // namespace sinew::scene
