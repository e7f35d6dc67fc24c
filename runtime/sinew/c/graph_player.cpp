#include "sinew/c/graph_player.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "sinew/character/physics_values.h"
#include "sinew/character/queries.h"
#include "sinew/graph/graph_physics.h"

namespace sinew::c {
namespace {

/// What a ray begins in (a wall at the foot, a roof) is passed by.
bool below_in_world(const PlayerGround& ground, const Vec3<float>& point, GroundHit<float>& hit) {
  Cast ray;
  ray.from = point.cast<double>();
  ray.motion = {0, 0, -ground.reach};
  ray.filter.layers = ground.layers;
  ray.filter.characters = ray.filter.props = ray.filter.particles = false;
  std::array<QueryHit, 8> hits;
  int count = 0;
  if (!cast(*ground.world, ray, hits, count)) return false;
  const auto met =
      std::find_if(hits.begin(), hits.begin() + count, [](const QueryHit& h) { return h.distance > 0; });
  if (met == hits.begin() + count) return false;
  hit.point = met->position.cast<float>();
  hit.normal = met->normal.cast<float>().normalized();
  return true;
}

/// An answer that is none is taken for none.
bool below_by_host(const PlayerGround& ground, const Vec3<float>& point, GroundHit<float>& hit) {
  sinew_ground_hit answer{{point.x(), point.y(), point.z()}, {0, 0, 1}, -1};
  if (ground.below(ground.context, point.data(), &answer) == 0) return false;
  const Vec3<float> at(answer.point), normal(answer.normal);
  const float length = normal.norm();
  if (!at.allFinite() || !(std::abs(length - 1) < 0.1f)) return false;
  if (answer.body < -1 || answer.body >= static_cast<int>(ground.grounds.count)) return false;
  hit.point = at;
  hit.normal = normal / length;
  hit.ground = answer.body;
  return true;
}

}  // namespace

GraphGround<float> PlayerGround::for_graph() const {
  if (kind == SINEW_GROUND_LEVEL) return {};
  const auto ask = [](const void* self, const Vec3<float>& point, GroundHit<float>& hit) {
    const auto& ground = *static_cast<const PlayerGround*>(self);
    return ground.kind == SINEW_GROUND_WORLD ? below_in_world(ground, point, hit)
                                             : below_by_host(ground, point, hit);
  };
  return {ask, this, grounds.all()};
}

GraphPlayer::GraphPlayer(std::shared_ptr<const BoundGraph> bound,
                         std::shared_ptr<GraphScratch<float>> scratch, const PlayerSettings& settings,
                         World<float>& world, int character)
    : bound_(std::move(bound)),
      scratch_(std::move(scratch)),
      block_(bound_->graph.state_bytes<float>()),
      jets_(std::size_t(bound_->graph.joint_count())),
      physical_(bound_->feels ? jets_.size() : 0),
      loads_(settings.physics && !bound_->graph.physics().empty() ? jets_.size() : 0),
      curves_(std::size_t(bound_->graph.curve_count()), TimeJet<float>(0.f)),
      hits_(std::size_t(settings.events)),
      events_{hits_} {
  static_cast<void>(start_graph<float>(bound_->graph, block_));  // its size is right
  const std::vector<Transform<float>>& rest = bound_->graph.rest();
  for (std::size_t j = 0; j < jets_.size(); ++j) {
    jets_[j] = {};
    jets_[j].rotation = rest[j].rotation;
    jets_[j].translation = rest[j].translation;
  }
  if (bound_->spends) timer_.emplace(world, character);
  parameters().put({settings.place[0], settings.place[1], 0}, settings.heading);
}

void GraphPlayer::feel(const Character<float>& character) {
  if (loads_.empty()) return;
  static_cast<void>(set_physics<float>(bound_->graph, block_, physics_values<float>(character, loads_)));
}

Status GraphPlayer::play(const Character<float>& character, float h) {
  if (!physical_.empty()) physical_motion<float>(character, physical_);
  events_ = {hits_};
  GraphStepJob<float> job{&bound_->graph, block_, h, scratch_.get(), jets_, &events_, curves_};
  job.physical = physical_;
  if (timer_) job.muscles = {FadeTimer<float>::answer, &*timer_};
  job.ground = ground.for_graph();
  return job.Run();
}

}  // namespace sinew::c
