// The runtime asset file (.sinew): one skeleton, its clips, masks and meshes.
//
// FlatBuffers (schema: sinew/io/sinew.fbs), little-endian on every machine, verified before anything is read,
// then checked semantically (see validate(Skeleton), validate(Clip)). A broken file gives an error, never a
// crash.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "sinew/animation/clip.h"
#include "sinew/animation/joint_mask.h"
#include "sinew/animation/morph_job.h"
#include "sinew/skeleton/skeleton.h"

namespace sinew {

/// Triangle mesh in model space at the bind pose. Skinned when `joints` is not empty.
struct Mesh {
  std::string name;                    ///< as in the source file; may be empty
  std::vector<float> positions;        ///< [vertex][3], m
  std::vector<float> normals;          ///< [vertex][3], unit
  std::vector<float> uvs;              ///< [vertex][2] or empty; origin top left
  std::vector<std::uint32_t> indices;  ///< triangles, counter-clockwise seen from outside
  std::vector<std::uint16_t> joints;   ///< [vertex][4] skeleton joint of each influence
  std::vector<float> weights;          ///< [vertex][4], sum 1
  int material = -1;                   ///< index into Asset::materials; -1: none
  std::vector<MorphTarget> morphs;     ///< move vertices at the bind pose: MorphJob, then skinning
  std::vector<int> morph_curves;       ///< [morph] slot of Asset::curve_slots: the target's name and weight
};

/// What a mesh looks like.
struct Material {
  std::string name;                             ///< as in the source file; may be empty
  float base_color[4] = {0.8f, 0.8f, 0.8f, 1};  ///< linear RGBA
  std::vector<std::uint8_t> texture;            ///< PNG or JPEG file bytes, or empty
};

/// All that a .sinew file holds. What is read is valid; what is made by hand, `write_asset` checks.
struct Asset {
  Skeleton skeleton;                           ///< one character
  std::vector<Clip> clips;                     ///< of that skeleton's joints
  std::vector<Mesh> meshes;                    ///< its skin; may be empty
  std::vector<Material> materials;             ///< of the meshes
  std::vector<Transform<float>> inverse_bind;  ///< [joint] model space at bind → joint; empty without meshes
  std::vector<CurveSlot> curve_slots;          ///< what Clip::curves move
  std::vector<std::string> event_names;        ///< all whose event_name() is in Clip::events
  std::vector<JointMask> masks;                ///< [joint] each
  std::string report_json;                     ///< what the converter decided, as JSON text

  int find_clip(const std::string& name) const;   ///< index, or -1
  int find_curve(const std::string& name) const;  ///< slot, or -1
  int find_mask(const std::string& name) const;   ///< index, or -1
};

/// Reads a file image. On error `out` is left as it was. Cost: one pass over the bytes.
Status read_asset(std::span<const std::uint8_t> bytes, Asset& out);

/// Maps the file and reads it.
Status load_asset(const char* path, Asset& out);

/// What is at fault in what clips say beside their motion: names that repeat or share a number, events
/// without a name, curves without a slot, masks of another size. `Status::index`: clip, slot, name or mask.
Status validate_names(const Asset& asset);

/// File image of an asset; the same asset always gives the same bytes. Events whose name validate_names()
/// misses are left out, and so are convex colliders.
std::vector<std::uint8_t> write_asset(const Asset& asset);

/// Bytes that a clip takes of such an image, its name and all its tables included.
std::size_t file_bytes(const Clip& clip, const Skeleton& skeleton);

}  // namespace sinew
