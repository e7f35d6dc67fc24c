// Throws balls at a playing character, hears what touches what, looks where the way ahead ends, and draws
// what the world has inside at the moment in which most is solved for. Usage: debug_draw ASSET.sinew
// [OUT.svg]
#include <sinew/animation/sampling_job.h>
#include <sinew/character/contact_events.h>
#include <sinew/character/debug_draw.h>
#include <sinew/character/queries.h>
#include <sinew/character/world.h>
#include <sinew/io/asset.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <sstream>

namespace {

constexpr int kFrames = 90, kWidth = 900, kHeight = 700;
constexpr double kPixels = 280;  // by m

/// Lines, triangles and words as one picture, seen from the front, a little from the left and above.
class Svg final : public sinew::DebugRenderer {
 public:
  using Place = sinew::Vec3<double>;

  void line(const Place& from, const Place& to, sinew::DebugColor color) override {
    const std::array<double, 2> a = seen(from), b = seen(to);
    lines_ << "<line x1='" << a[0] << "' y1='" << a[1] << "' x2='" << b[0] << "' y2='" << b[1] << "' stroke='"
           << rgb(color) << "'/>\n";
    ++count_;
  }
  void triangle(const Place& a, const Place& b, const Place& c, sinew::DebugColor color) override {
    triangles_ << "<polygon points='";
    for (const Place& corner : {a, b, c}) triangles_ << seen(corner)[0] << ',' << seen(corner)[1] << ' ';
    triangles_ << "' fill='" << rgb(color) << "' fill-opacity='" << color.a / 255.0 << "'/>\n";
    ++count_;
  }
  void text(const Place& at, const char* words, sinew::DebugColor color) override {
    texts_ << "<text x='" << seen(at)[0] << "' y='" << seen(at)[1] << "' fill='" << rgb(color)
           << "' text-anchor='middle'>" << words << "</text>\n";
    ++count_;
  }

  int count() const { return count_; }
  std::string picture() const {
    std::ostringstream out;
    out << "<svg xmlns='http://www.w3.org/2000/svg' width='" << kWidth << "' height='" << kHeight
        << "' font-family='sans-serif' font-size='14'>\n<rect width='100%' height='100%' fill='#202428'/>\n"
        << triangles_.str() << lines_.str() << texts_.str() << "</svg>\n";
    return out.str();
  }

 private:
  /// Pixels: X is forward, Y left, Z up.
  static std::array<double, 2> seen(const Place& p) {
    constexpr double yaw = 0.6, pitch = 0.25;
    const double right = std::cos(yaw) * p.y() - std::sin(yaw) * p.x();
    const double ahead = std::cos(yaw) * p.x() + std::sin(yaw) * p.y();
    const double up = std::cos(pitch) * p.z() - std::sin(pitch) * ahead;
    return {kWidth / 2.0 + kPixels * right, kHeight * 0.85 - kPixels * up};
  }
  static std::string rgb(sinew::DebugColor c) {
    return "rgb(" + std::to_string(c.r) + ',' + std::to_string(c.g) + ',' + std::to_string(c.b) + ')';
  }

  std::ostringstream lines_, triangles_, texts_;
  int count_ = 0;
};

int fail(const char* what, const char* why) {
  std::fprintf(stderr, "debug_draw: %s: %s\n", what, why);
  return 1;
}

const char* name(const sinew::BodyRef& body, const sinew::Asset& asset) {
  switch (body.kind) {
    case sinew::BodyKind::kGround:
      return "the ground";
    case sinew::BodyKind::kCharacter:
      return asset.skeleton.joints[static_cast<std::size_t>(body.joint)].name.c_str();
    case sinew::BodyKind::kProp:
      return "a ball";
    default:
      return "the wall";
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: debug_draw ASSET.sinew [OUT.svg]\n");
    return 2;
  }
  sinew::Asset asset;
  if (sinew::Status s = sinew::load_asset(argv[1], asset); !s) return fail(argv[1], s.reason);
  if (asset.clips.empty()) return fail(argv[1], "the asset has no clip");
  sinew::Status status;
  sinew::World<float> world({});
  sinew::Character<float> hero = world.character(world.add_character(asset.skeleton, {}, status));
  if (!status) return fail(argv[1], status.reason);
  sinew::Collider wall;
  wall.shape = sinew::Shape::kBox;
  wall.size = {0.1, 1, 0.6};
  wall.local.translation = {3.5, 0, 0.6};
  status = world.add_obstacle(wall);
  for (int n = 0; n < 3 && status; ++n) {
    sinew::PropSettings ball;
    ball.mass = 5;
    ball.pose.translation = {1.2 + 0.6 * n, 0.1 * (n - 1), 1.5 + 0.3 * n};
    ball.velocity = {-5, 0, 0};
    (void)world.add_prop(ball, status);
  }
  if (!status) return fail("world", status.reason);

  // Set-up of what the host wants to hear.
  std::vector<sinew::ContactEvent> room(64);
  sinew::ContactRing ring(room);
  status = sinew::report_contacts(world, &ring);
  if (!status) return fail("contacts", status.reason);

  std::vector<sinew::JointJet<float>> jets(asset.skeleton.joints.size());
  std::string picture;
  int most = -1, hits = 0, drawn = 0;
  for (int frame = 0; frame < kFrames && status; ++frame) {
    status = sinew::SamplingJob<float>{&asset.clips.front(), frame / 60.0, jets}.Run();
    if (status) status = hero.set_target(jets);
    if (status && frame == 0) status = hero.reset();
    if (status) status = world.step(1 / 60.f);
    for (sinew::ContactEvent e; ring.take(e);) {
      if (e.phase != sinew::ContactPhase::kBegin || !e.solved || !(e.impulse > 1)) continue;
      ++hits;
      std::printf("%5.2f s  %s on %s: %.1f N·s\n", frame / 60.0, name(e.a, asset), name(e.b, asset),
                  e.impulse);
    }
    if (hero.report().unknown_dofs <= most) continue;
    most = hero.report().unknown_dofs;
    Svg svg;
    sinew::draw(world, {}, svg);
    picture = svg.picture();
    drawn = svg.count();
  }
  if (!status) return fail("world", status.reason);

  // How far it could walk: a ball of half its width, ahead from its middle, that does not meet itself.
  sinew::Cast ahead;
  ahead.from = hero.position();
  ahead.from.z() = 0.8;
  ahead.motion = {5, 0, 0};
  ahead.radius = 0.25;
  ahead.filter.without_character = 0;
  std::array<sinew::QueryHit, 1> hit;
  int met = 0;
  status = sinew::cast(world, ahead, hit, met);
  if (!status) return fail("query", status.reason);
  if (met > 0) std::printf("%s is %.2f m ahead\n", name(hit[0].body, asset), hit[0].distance);

  const char* path = argc > 2 ? argv[2] : "debug_draw.svg";
  if (!(std::ofstream(path) << picture)) return fail(path, "cannot be written");
  std::printf("%d begins of contact; %d unknowns at most; %d lines, triangles and words in %s\n", hits, most,
              drawn, path);
  // What the scene is for: a hit that makes it solve, and something ahead.
  return hits > 0 && most > 0 && met > 0 ? 0 : 1;
}
