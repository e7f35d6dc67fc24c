#include "import/link_meshes.h"

#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <stdexcept>
#include <utility>
#include <vector>

#include "import/broker.h"
#include "import/readers.h"
#include "import/sandbox.h"
#include "import/serialize.h"

namespace sinew::import {
namespace {

namespace fs = std::filesystem;

constexpr int kMostLevelsUp = 8;  ///< that a package is looked for above the URDF

/// Where a mesh may be: a file of that name in the directory or below.
struct Place {
  fs::path directory;
  std::string name;
};

/// "package://NAME/rest" → NAME, rest; NAME is empty for other names.
std::pair<std::string, std::string> split_package(const std::string& file) {
  for (const std::string scheme : {"package://", "model://"}) {
    if (file.rfind(scheme, 0) != 0) continue;
    const std::size_t slash = file.find('/', scheme.size());
    if (slash == std::string::npos) return {file.substr(scheme.size()), ""};
    return {file.substr(scheme.size(), slash - scheme.size()), file.substr(slash + 1)};
  }
  return {"", file};
}

std::vector<Place> places_in_package(const fs::path& beside, const std::string& package,
                                     const std::string& rest, const Packages& packages) {
  if (const auto known = packages.find(package); known != packages.end()) return {{known->second, rest}};
  std::vector<Place> places;
  fs::path directory = beside;
  for (int level = 0; level < kMostLevelsUp; ++level, directory = directory.parent_path()) {
    if (directory.filename() == package) places.push_back({directory, rest});
    places.push_back({directory / package, rest});
    if (directory == directory.parent_path()) break;
  }
  places.push_back({beside, rest});
  return places;
}

std::vector<Place> places_of(const fs::path& beside, const std::string& file, const Packages& packages) {
  const auto& [package, rest] = split_package(file);
  if (!package.empty() && package != "." && package != "..")
    return places_in_package(beside, package, rest, packages);
  const std::string scheme = "file://", up = "../";
  if (rest.rfind(scheme, 0) == 0)
    return {{beside, fs::path(rest.substr(scheme.size())).lexically_relative(beside).string()}};
  if (rest.rfind(up, 0) == 0) return {{beside.parent_path(), rest.substr(up.size())}};
  return {{beside, rest}};
}

/// What is in a file, by its content; where that does not say it, by its name.
std::string format_of(const std::string& content, const std::string& name) {
  const std::string format = detect_format(content);
  if (format == "dae" || format == "gltf" || format == "glb") return format;
  std::string ending = fs::path(name).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (format.empty() && (ending == ".stl" || ending == ".obj")) return ending.substr(1);
  throw std::runtime_error("not an STL, OBJ, COLLADA or glTF file");
}

/// A mesh file and what became of it.
struct Part {
  bool found = false;
  std::string fault;  ///< why it cannot be used; empty where it can
  std::string format;
  SourceScene scene;
};

Part read_place(const Place& place, const ReadLimits& limits) {
  Part part;
  const int file = open_below(place.directory, place.name, limits.max_file_bytes);
  part.found = file >= 0;
  if (!part.found) return part;
  try {
    const std::string content = read_whole(file, limits.max_file_bytes);
    part.format = format_of(content, place.name);
    const fs::path path = place.directory / place.name;
    const auto broker = [&](const std::string& name) {
      return open_beside(path, name, limits.max_file_bytes);
    };
    const auto work = [&](const OpenFile& open_file) {
      check_shape(content, part.format, limits);
      return to_bytes(read_part(content, part.format, open_file, limits));
    };
    std::string answer;
    if (run_sandboxed(limits, broker, work, answer, part.fault) &&
        from_bytes(answer, part.scene, part.fault) && part.scene.meshes.empty())
      part.fault = "it has no triangles";
  } catch (const std::exception& e) {
    part.fault = e.what();
  }
  part.fault = one_line(part.fault);
  return part;
}

class LinkMeshes {
 public:
  LinkMeshes(const std::string& urdf, const Packages& packages, const ReadLimits& limits, SourceScene& scene)
      : packages_(packages), limits_(limits), scene_(scene) {
    std::error_code failed;
    beside_ = fs::weakly_canonical(urdf, failed).parent_path();
  }

  void run() {
    for (const SourceUrdfLink& link : scene_.links) {
      SourceNode node;
      node.name = node.original_name = link.name;
      node.parent = link.parent;
      node.local = matrix_of(link.origin);
      scene_.nodes.push_back(node);
    }
    for (std::size_t i = 0; i < scene_.links.size(); ++i)
      for (const SourceUrdfLink::MeshReference& mesh : scene_.links[i].meshes)
        if (!mesh.collision) add(mesh, static_cast<int>(i));
    if (missing_ > 0)
      scene_.notes.push_back(std::to_string(missing_) + (missing_ == 1 ? " mesh" : " meshes") +
                             " not found, the first '" + first_missing_ + "'" + hint());
  }

 private:
  static Eigen::Matrix4d matrix_of(const Transform<double>& x) {
    Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
    m.block<3, 3>(0, 0) = x.rotation.toRotationMatrix();
    m.block<3, 1>(0, 3) = x.translation;
    return m;
  }

  std::string hint() const {
    const std::string package = split_package(first_missing_).first;
    return package.empty() ? "" : "; say where its package is (--package " + package + "=DIRECTORY)";
  }

  const Part& part_of(const std::string& file) {
    const auto [entry, is_new] = parts_.try_emplace(file);
    Part& part = entry->second;
    if (!is_new) return part;
    for (const Place& place : places_of(beside_, file, packages_)) {
      scene_.files.push_back((place.directory / place.name).lexically_relative(beside_).string());
      part = read_place(place, limits_);
      if (part.found) break;
    }
    if (!part.found) {
      if (missing_++ == 0) first_missing_ = file;
    } else if (!part.fault.empty()) {
      scene_.notes.push_back("mesh '" + file + "' left out: " + part.fault);
    }
    for (const std::string& note : part.scene.notes) scene_.notes.push_back("mesh '" + file + "': " + note);
    return part;
  }

  void add(const SourceUrdfLink::MeshReference& mesh, int link) {
    const Part& part = part_of(mesh.file);
    if (!part.found || !part.fault.empty()) return;
    Eigen::Matrix4d place = matrix_of(mesh.origin);
    for (int k = 0; k < 3; ++k) place.col(k) *= mesh.scale[k];
    const int first = static_cast<int>(scene_.nodes.size());
    for (SourceNode node : part.scene.nodes) {
      node.name = scene_.links[static_cast<std::size_t>(link)].name + "/" + node.name;
      node.is_bone = false;
      if (node.parent < 0) node.local = place * node.local;
      node.parent = node.parent < 0 ? link : first + node.parent;
      scene_.nodes.push_back(std::move(node));
    }
    for (SourceMesh copy : part.scene.meshes) {
      copy.node += first;
      copy.bones.clear();
      copy.material = material_of(part, mesh, copy.material);
      scene_.meshes.push_back(std::move(copy));
    }
  }

  /// The part's own material, or one of the colour that the URDF gives.
  int material_of(const Part& part, const SourceUrdfLink::MeshReference& mesh, int own) {
    SourceMaterial material;
    const bool has_own =
        own >= 0 && part.format != "stl" &&
        part.scene.materials[static_cast<std::size_t>(own)].name != "DefaultMaterial";  // assimp's
    if (has_own)
      material = part.scene.materials[static_cast<std::size_t>(own)];
    else
      material.base_color = mesh.color;
    const auto same =
        std::find_if(scene_.materials.begin(), scene_.materials.end(), [&](const SourceMaterial& m) {
          return m.name == material.name && m.base_color == material.base_color &&
                 m.texture == material.texture;
        });
    if (same == scene_.materials.end()) {
      scene_.materials.push_back(std::move(material));
      return static_cast<int>(scene_.materials.size()) - 1;
    }
    return static_cast<int>(same - scene_.materials.begin());
  }

  fs::path beside_;
  const Packages& packages_;
  const ReadLimits& limits_;
  SourceScene& scene_;
  std::map<std::string, Part> parts_;
  int missing_ = 0;
  std::string first_missing_;
};

}  // namespace

void read_link_meshes(const std::string& urdf, const Packages& packages, const ReadLimits& limits,
                      SourceScene& scene) {
  LinkMeshes(urdf, packages, limits, scene).run();
  std::sort(scene.files.begin(), scene.files.end());
}

}  // namespace sinew::import
