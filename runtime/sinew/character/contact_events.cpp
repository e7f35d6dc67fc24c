#include "sinew/character/contact_events.h"

#include <algorithm>

#include "sinew/character/contact_reporter.h"
#include "sinew/character/world_impl.h"

namespace sinew {
namespace {

template <class T>
bool moved_by_unknowns(const CharacterState<T>& s, int body) {
  for (int i = body; i >= 0; i = s.tree.parent[i])
    for (int dof = s.tree.first_dof[i]; dof < s.tree.first_dof[i + 1]; ++dof)
      if (s.unknown[dof]) return true;
  return false;
}

template <class T>
TouchPoint touch_point(const LoggedContact<T>& c) {
  TouchPoint p;
  p.position = c.point;
  p.normal = c.normal.template cast<double>();
  p.friction = c.friction.template cast<double>();
  p.impulse = double(c.impulse);
  p.force = double(c.force);
  p.depth = double(c.depth);
  return p;
}

}  // namespace

bool ContactRing::take(ContactEvent& out) {
  if (size_ == 0) return false;
  out = buffer_[first_];
  first_ = first_ + 1 == buffer_.size() ? 0 : first_ + 1;
  --size_;
  return true;
}

void ContactRing::put(const ContactEvent& event) {
  if (size_ == buffer_.size()) {
    ++dropped_;
    return;
  }
  const std::size_t at = first_ + size_;
  buffer_[at < buffer_.size() ? at : at - buffer_.size()] = event;
  ++size_;
}

template <class T>
void fill_event(std::span<LoggedContact<T>> points, ContactEvent& out) {
  if (!points.empty() && points.back().id != 0)  // what is solved for needs no guess
    while (points.front().id == 0) points = points.subspan(1);
  std::sort(points.begin(), points.end(), [](const LoggedContact<T>& a, const LoggedContact<T>& b) {
    return a.impulse != b.impulse ? a.impulse > b.impulse : a.id < b.id;
  });
  out.solved = points.empty() || points.front().id != 0;
  out.points = static_cast<int>(points.size());
  Vec3<double> pushed = Vec3<double>::Zero(), all = Vec3<double>::Zero();
  for (const LoggedContact<T>& c : points) {
    if (out.kept < ContactEvent::kMostPoints)
      out.point[static_cast<std::size_t>(out.kept++)] = touch_point<T>(c);
    out.impulse += double(c.impulse);
    pushed += double(c.impulse) * c.normal.template cast<double>();
    all += c.normal.template cast<double>();
  }
  const Vec3<double>& mean = pushed.norm() > 0 ? pushed : all;
  if (mean.norm() > 0) out.normal = mean.normalized();
}

template <class T>
void ContactReporter<T>::reserve(int contacts, int islands, int colliders) {
  const std::size_t most = static_cast<std::size_t>(contacts) + static_cast<std::size_t>(colliders);
  if (most > contacts_.size()) contacts_.resize(most);
  for (auto* v : {&touching_, &touched_})
    if (most > v->capacity()) v->reserve(most);
  counts_.reserve(static_cast<std::size_t>(islands));
}

template <class T>
std::size_t ContactReporter<T>::bytes() const {
  return sizeof *this + logs_.size() * sizeof(ContactLog<T>) +
         contacts_.capacity() * sizeof(LoggedContact<T>) +
         (touching_.capacity() + touched_.capacity()) * sizeof(TouchingPair) +
         counts_.capacity() * sizeof(int);
}

/// Closes the gaps between the islands' contacts.
template <class T>
void ContactReporter<T>::gather(std::span<const int> first) {
  count_ = 0;
  for (std::size_t i = 0; i < counts_.size(); ++i) {
    const auto from = contacts_.begin() + first[i];
    std::copy(from, from + counts_[i], contacts_.begin() + static_cast<std::ptrdiff_t>(count_));
    count_ += static_cast<std::size_t>(counts_[i]);
  }
}

/// Of each collider that the animation leads on to the ground, the lowest point.
template <class T>
void ContactReporter<T>::add_animated(CharacterState<T>& s, int n, const WorldSettings& world) {
  if (!s.settings.ground_contact || s.passive()) return;
  const double reach = settings_.animated_reach * double(s.tree.scale.length);
  for (std::size_t k = 0; k + 1 < s.first_point.size(); ++k) {
    const int body = s.colliders[k].joint;
    const Transform<T>& joint = s.model()[body];
    LoggedContact<T> lowest;
    double height = reach;
    for (int p = s.first_point[k]; p < s.first_point[k + 1]; ++p) {
      if (!s.points[p].meets_plane()) continue;
      Vec3<double> at = (joint * s.points[p].local).template cast<double>();
      at.z() -= double(s.points[p].radius);
      if (!(at.z() - world.ground_height < height)) continue;
      height = at.z() - world.ground_height;
      lowest.point = at;
    }
    if (!(height < reach) || moved_by_unknowns(s, body) || count_ == contacts_.size()) continue;
    lowest.pair = {{n, body}, {-1, -1}};
    lowest.depth = T(std::max(-height, 0.0));
    contacts_[count_++] = lowest;
  }
}

/// Whether a pair that was not found in this step sleeps as it is.
template <class T>
bool ContactReporter<T>::touches_still(const TouchingPair& pair,
                                       std::span<const std::unique_ptr<CharacterState<T>>> states) const {
  const auto sleeps = [&](int tree) {
    return tree < 0 || (states[tree]->levels.asleep && !states[tree]->parked);
  };
  return sleeps(pair.a.tree) && sleeps(pair.b.tree);
}

template <class T>
Status report_contacts(World<T>& world, ContactRing* ring, const ContactReportSettings& settings) {
  auto& impl = WorldInternals<T>::of(world);
  if (!impl.plan.contacts)
    return Status::error(Code::kInvalidArgument, "the world declares no Contacts: there are none to report");
  if (!(settings.animated_reach >= 0 && settings.animated_reach < 1e3))
    return Status::error(Code::kInvalidArgument, "animated_reach must be ≥ 0 and below a kilometre");
  impl.reporter.reset();
  if (!ring) return {};
  impl.reporter = std::make_unique<ContactReporter<T>>(*ring, settings, impl.workers.size());
  impl.reserve();
  if (!impl.over_cap()) return {};
  impl.reporter.reset();
  return Status::error(Code::kOutOfRange, "WorldSettings::memory_cap leaves no room for it");
}

template class ContactReporter<float>;
template class ContactReporter<double>;
template void fill_event<float>(std::span<LoggedContact<float>>, ContactEvent&);
template void fill_event<double>(std::span<LoggedContact<double>>, ContactEvent&);
template Status report_contacts<float>(World<float>&, ContactRing*, const ContactReportSettings&);
template Status report_contacts<double>(World<double>&, ContactRing*, const ContactReportSettings&);

}  // namespace sinew
