#include "scene/effect_registry.h"

#include <algorithm>
#include <numeric>

#include "sinew/effects/buoyancy.h"
#include "sinew/effects/force_field.h"
#include "sinew/effects/joint_spring.h"
#include "sinew/effects/wind.h"

namespace sinew::scene {
namespace {

/// Edits every character's skeleton, each in a copy of its asset.
template <class Edit>
void edit_skeletons(Scene& scene, Edit edit) {
  for (SceneCharacter& c : scene.characters) {
    auto copy = std::make_shared<Asset>(*c.asset);
    edit(copy->skeleton);
    c.asset = copy;
  }
}

template <class Edit>
void edit_dofs(Scene& scene, Edit edit) {
  edit_skeletons(scene, [&](Skeleton& s) {
    for (Joint& joint : s.joints)
      for (DofLimits& dof : joint.dofs) edit(dof);
  });
}

void without_muscles(Scene& scene) {
  for (SceneCharacter& c : scene.characters) c.strength = {{0, 0}};
}

void without_joint_limits(Scene& scene) {
  edit_skeletons(scene, [](Skeleton& s) {
    for (Joint& joint : s.joints) {
      joint.swing_limit = -1;
      for (DofLimits& dof : joint.dofs) {
        dof.lower = DofLimits().lower;
        dof.upper = DofLimits().upper;
      }
    }
  });
}

void without_joint_damping(Scene& scene) {
  edit_dofs(scene, [](DofLimits& dof) { dof.damping = dof.dry_friction = 0; });
}

void without_friction(Scene& scene) {
  edit_skeletons(scene, [](Skeleton& s) {
    for (Collider& c : s.colliders) c.friction = 0;
  });
  for (SceneProp& p : scene.props) p.settings.friction = 0;
  for (Collider& o : scene.obstacles) o.friction = 0;
}

void without_contact(Scene& scene) {
  scene.world.body_contact = false;
  scene.obstacles.clear();
}

void self_collision(Scene& scene, bool on) {
  for (SceneCharacter& c : scene.characters) c.settings.self_collision = on;
}

EffectRow built_in(const char* name, const char* what, void (*leave_out)(Scene&),
                   void (*put_in)(Scene&) = nullptr) {
  EffectRow row{name, what};
  row.leave_out = leave_out;
  row.put_in = put_in;
  return row;
}

std::string names_of(std::span<const EffectRow> registry) {
  std::string names = "standard";
  for (const EffectRow& row : registry) names += std::string(", ") + row.name;
  return names;
}

}  // namespace

std::span<const EffectRow> effect_registry() {
  static const EffectRow rows[] = {
      built_in("gravity", "weight", [](Scene& s) { s.world.gravity.setZero(); }),
      built_in("muscles", "joints pull towards the animation", without_muscles),
      built_in("joint_limits", "ranges, cones and twists", without_joint_limits),
      built_in("joint_damping", "the skeleton's damping and dry friction", without_joint_damping),
      built_in("ground", "a floor at the world's ground height", [](Scene& s) { s.world.ground = false; }),
      built_in("support", "the floor bears what a driven root would",
               [](Scene& s) { s.world.ground_support = false; }),
      built_in("friction", "of contacts", without_friction),
      built_in("restitution", "bounce of contacts", [](Scene& s) { s.restitution = false; }),
      built_in("continuous_detection", "what is fast does not pass what is thin",
               [](Scene& s) { s.continuous_detection = false; }),
      built_in("contact", "between characters, props and obstacles", without_contact),
      built_in(
          "self_collision", "within each character", [](Scene& s) { self_collision(s, false); },
          [](Scene& s) { self_collision(s, true); }),
      built_in("loops", "the scene's loops", [](Scene& s) { s.loops.clear(); }),
      built_in("particles", "the scene's strands, cloth and soft tissue",
               [](Scene& s) { s.particles.clear(); }),
      built_in("impulses", "the scene's pushes", [](Scene& s) { s.pushes.clear(); }),
      effect_row<Wind>("wind", "moving or still air drags on colliders"),
      effect_row<Buoyancy>("buoyancy", "water lifts colliders and drags on them"),
      effect_row<JointSpring>("joint_spring", "passive springs and dampers of joints"),
      effect_row<ForceField>("force_field", "a pull towards a place, or a blast away from it"),
  };
  return rows;
}

SceneEffect effect_targets(const Reader& in, const Scene& scene) {
  SceneEffect effect;
  const json& characters = in.list("characters");
  for (std::size_t i = 0; i < characters.size(); ++i)
    effect.characters.push_back(character_named(scene, characters[i], in.item("characters", i)));
  if (!in.has("characters")) {
    effect.characters.resize(scene.characters.size());
    std::iota(effect.characters.begin(), effect.characters.end(), 0);
  }
  if (in.flag("props", true)) {
    effect.props.resize(scene.props.size());
    std::iota(effect.props.begin(), effect.props.end(), 0);
  }
  return effect;
}

void declare_effects(const Reader& in, std::span<const EffectRow> registry, Scene& scene) {
  if (!in.has("effects")) return;
  const json& list = in.list("effects");
  std::vector<bool> named(registry.size(), false);
  for (std::size_t i = 0; i < list.size(); ++i) {
    const std::string where = in.item("effects", i);
    const json entry = list[i].is_string() ? json{{"effect", list[i]}} : list[i];
    if (!entry.is_object() || !entry.contains("effect") || !entry["effect"].is_string())
      fail(where, "expected an effect's name, or an object with 'effect' and its settings");
    const std::string name = entry["effect"];
    bool known = name == "standard";
    for (std::size_t r = 0; r < registry.size(); ++r) {
      const EffectRow& row = registry[r];
      const bool standard = name == "standard" && row.leave_out && !row.put_in;
      if (name != row.name && !standard) continue;
      known = named[r] = true;
      if (row.put_in) row.put_in(scene);
      if (row.read) {
        scene.effects.push_back(row.read(entry, where, scene));
        scene.effects.back().name = name;
      } else if (entry.size() > 1) {
        fail(where, "'" + name + "' has no settings");
      }
    }
    if (!known) fail(where, "unknown effect " + list[i].dump() + ", known are: " + names_of(registry));
  }
  for (std::size_t r = 0; r < registry.size(); ++r)
    if (registry[r].leave_out && !named[r]) registry[r].leave_out(scene);
}

}  // namespace sinew::scene
