#include "render/figure.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>

#include "fixtures/humanoid.h"
#include "render/shapes.h"

namespace sinew::render::fixtures {

std::shared_ptr<Asset> bare_humanoid() {
  auto asset = std::make_shared<Asset>();
  asset->skeleton = sinew::fixtures::humanoid();
  return asset;
}

std::shared_ptr<Asset> skinned_humanoid() {
  auto asset = bare_humanoid();
  const Skeleton& s = asset->skeleton;
  std::vector<Transform<float>> bind;
  for (const Joint& joint : s.joints) {
    const Transform<float> local = joint.rest.cast<float>();
    bind.push_back(joint.parent < 0 ? local : bind[static_cast<std::size_t>(joint.parent)] * local);
    asset->inverse_bind.push_back(bind.back().inverse());
  }
  Mesh skin;
  for (const Collider& c : s.colliders) {
    Geometry capsule;
    append_capsule(bind[static_cast<std::size_t>(c.joint)] * c.local.cast<float>(), 1.1f * float(c.size.x()),
                   float(c.size.z()), kClay, 0, capsule);
    const auto first = static_cast<std::uint32_t>(skin.positions.size() / 3);
    for (const Vertex& v : capsule.vertices) {
      skin.positions.insert(skin.positions.end(), v.position, v.position + 3);
      skin.normals.insert(skin.normals.end(), v.normal, v.normal + 3);
      for (int k = 0; k < 4; ++k) {
        skin.joints.push_back(static_cast<std::uint16_t>(c.joint));
        skin.weights.push_back(k == 0 ? 1.f : 0.f);
      }
    }
    for (const std::uint32_t i : capsule.indices) skin.indices.push_back(first + i);
  }
  asset->meshes.push_back(std::move(skin));
  return asset;
}

scene::Recording swinging(const std::shared_ptr<const Asset>& asset, double seconds) {
  const Skeleton& s = asset->skeleton;
  scene::Recording rec;
  rec.title = "swing";
  rec.frame_rate = 30;
  rec.characters = {asset};
  const int count = static_cast<int>(std::lround(seconds * rec.frame_rate));
  for (int n = 0; n <= count; ++n) {
    const double t = n / rec.frame_rate;
    scene::CharacterFrame c;
    for (const Joint& joint : s.joints) {
      Transform<float> local = joint.rest.cast<float>();
      if (joint.name.find("arm") != std::string::npos)
        local.rotation = local.rotation *
                         Quat<float>(Eigen::AngleAxisf(0.6f * float(std::sin(5 * t)), Vec3<float>::UnitY()));
      c.model.push_back(joint.parent < 0 ? local : c.model[static_cast<std::size_t>(joint.parent)] * local);
    }
    const float load = count > 0 ? float(n) / float(count) : 0;
    c.load.assign(s.joints.size(), load);
    c.effort = c.load;
    c.torque.assign(s.joints.size(), 100 * load);
    c.limit.assign(s.joints.size(), 100);
    c.unknown_dofs = load < 0.5f ? 0 : 12;
    c.total_dofs = s.dof_total();
    c.microseconds = 20;
    c.most_loaded_joint = 2;
    scene::Frame frame;
    frame.time = t;
    frame.characters = {std::move(c)};
    frame.caption = "A caption under the picture";
    rec.frames.push_back(std::move(frame));
  }
  return rec;
}

namespace {

/// One directory for each case of this process; all are removed at its end.
std::filesystem::path own_directory() {
  struct Root {
    std::filesystem::path path = testing::TempDir() + "sinew_render_" + std::to_string(getpid());
    Root() = default;
    ~Root() {
      std::error_code ignored;
      std::filesystem::remove_all(path, ignored);
    }
    Root(const Root&) = delete;
    Root& operator=(const Root&) = delete;
  };
  static const Root root;
  std::filesystem::path directory = root.path / testing::UnitTest::GetInstance()->current_test_info()->name();
  std::filesystem::create_directories(directory);
  return directory;
}

}  // namespace

std::string own_file(const std::string& name) {
  return (own_directory() / name).string();
}

std::string own_files() {
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(own_directory()))
    names.insert(entry.path().filename().string());
  std::string text;
  for (const std::string& name : names) text += name + "\n";
  return text;
}

Options small_options(int width, int height) {
  Options o;
  o.width = width;
  o.height = height;
  o.overlay = false;
  return o;
}

Image picture(const scene::Recording& recording, const Options& options) {
  const std::string path = own_file("picture.png");
  const convert::Error error = render_recording(recording, options, path, {});
  EXPECT_FALSE(error) << error.message;
  std::ifstream file(path, std::ios::binary);
  const std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>(file), {}};
  std::filesystem::remove(path);
  Image image;
  EXPECT_TRUE(decode_image(bytes, image.width, image.height, image.pixels));
  for (std::size_t i = 0; i + 2 < image.pixels.size(); i += 4)
    std::swap(image.pixels[i], image.pixels[i + 2]);
  return image;
}

double brightness(const Image& image, double left, double top, double right, double bottom) {
  double sum = 0, count = 0;
  for (int y = int(top * image.height); y < int(bottom * image.height); ++y)
    for (int x = int(left * image.width); x < int(right * image.width); ++x) {
      const std::uint8_t* p = &image.pixels[(std::size_t(y) * std::size_t(image.width) + std::size_t(x)) * 4];
      sum += (p[0] + p[1] + p[2]) / 3.0;
      ++count;
    }
  return sum / count;
}

}  // namespace sinew::render::fixtures
