#include "sinew/character/sensor.h"

#include <algorithm>
#include <array>
#include <utility>

namespace sinew {
namespace {

bool comes_before(const BodyRef& a, const BodyRef& b) {
  return a.kind != b.kind ? a.kind < b.kind : a.index < b.index;
}

}  // namespace

template <class T>
Sensor<T>::Sensor(std::size_t bodies) : capacity_(bodies) {
  inside_.reserve(bodies);
  found_.reserve(bodies);
  events_.reserve(2 * bodies);  // all leave, as many come
  shape.filter.ground = shape.filter.obstacles = false;
}

template <class T>
void Sensor<T>::take(const BodyRef& body) {
  const BodyRef whole{body.kind, body.index, 0};
  const auto at = std::lower_bound(found_.begin(), found_.end(), whole, comes_before);
  if (at != found_.end() && *at == whole) return;
  if (found_.size() < capacity_)
    found_.insert(at, whole);
  else if (left_out_ == 0 || last_left_ != whole) {  // colliders of one body come one after the other
    ++left_out_;
    last_left_ = whole;
  }
}

template <class T>
Status Sensor<T>::update(const World<T>& world) {
  // Asked of every collider that is met, and takes none: nothing pushes another out of the room for hits.
  struct Asked {
    Sensor* sensor;
    const QueryFilter* host;
  } asked{this, &shape.filter};
  Cast query = shape;
  query.filter.context = &asked;
  query.filter.accept = [](void* context, const BodyRef& body) {
    const auto& of = *static_cast<const Asked*>(context);
    if (!of.host->accept || of.host->accept(of.host->context, body)) of.sensor->take(body);
    return false;
  };
  found_.clear();
  const int left_out_before = std::exchange(left_out_, 0);
  std::array<QueryHit, 1> room;
  int count = 0;
  if (const Status status = overlap(world, query, room, count); !status) {
    left_out_ = left_out_before;
    return status;
  }
  events_.clear();
  for (const BodyRef& body : inside_)
    if (!std::binary_search(found_.begin(), found_.end(), body, comes_before))
      events_.push_back({ContactPhase::kEnd, body});
  for (const BodyRef& body : found_)
    if (!std::binary_search(inside_.begin(), inside_.end(), body, comes_before))
      events_.push_back({ContactPhase::kBegin, body});
  std::swap(inside_, found_);
  return {};
}

template class Sensor<float>;
template class Sensor<double>;

}  // namespace sinew
