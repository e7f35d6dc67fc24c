#include "sinew/behaviour/balance_plan.h"

#include <algorithm>
#include <cmath>

#include "sinew/skeleton/portable_math.h"

namespace sinew {

void Pendulum::advance(const Vec2& pressed, double frequency, double h) {
  const double grows = portable::expm1(frequency * h), dies = portable::expm1(-frequency * h);
  const double c = 1 + (grows + dies) / 2, s = (grows - dies) / 2;
  const Vec2 off = place - pressed;
  place = pressed + c * off + (s / frequency) * velocity;
  velocity = s * frequency * off + c * velocity;
  acceleration = frequency * frequency * (place - pressed);
}

Vec2 press(const Pendulum& body, double frequency, const Vec2& goal, const Sole& sole,
           const BalanceLaw& law) {
  const Vec2 capture = body.capture_point(frequency);
  return sole.nearest(capture + law.gain / frequency * (capture - goal), law.margin);
}

Vec2 capture_point_after(const Vec2& now, double frequency, double seconds, const Sole& stance) {
  const Vec2 edge = stance.nearest(now, 0);
  return edge + portable::exp(frequency * seconds) * (now - edge);
}

int stepping_foot(const Feet& feet, const Vec2& capture_point, const Vec2& middle, const BalanceLaw& law) {
  const Vec2 ahead(portable::cos(feet.yaw), portable::sin(feet.yaw)), left(-ahead.y(), ahead.x());
  const Vec2 falls = capture_point - middle;
  if (std::abs(portable::atan2(std::abs(falls.dot(left)), std::abs(falls.dot(ahead)))) > law.sideways)
    return falls.dot(left) > 0 ? 0 : 1;
  const double lead = (feet.place[0] - feet.place[1]).dot(falls.normalized());
  if (std::abs(lead) > law.margin) return lead < 0 ? 0 : 1;
  return falls.dot(left) > 0 ? 0 : 1;
}

Vec2 within_reach(const Feet& feet, int swing, const Vec2& wanted, const BalanceLaw& law) {
  const Vec2 ahead(portable::cos(feet.yaw), portable::sin(feet.yaw)), left(-ahead.y(), ahead.x());
  const Vec2 stance = feet.place[static_cast<std::size_t>(1 - swing)];
  const double side = swing == 0 ? 1 : -1;
  Vec2 from_stance = wanted - stance;
  const double across = std::max(side * from_stance.dot(left), law.apart);
  from_stance = from_stance.dot(ahead) * ahead + side * across * left;
  const double length = from_stance.norm();
  return stance + std::min(1.0, law.longest_step / length) * from_stance;
}

bool out_of_reach(double beyond, double frequency, int steps_left, const BalanceLaw& law) {
  const double dies = portable::exp(-frequency * law.step_time);
  double reach = 0, share = 1;
  for (int n = 0; n < steps_left; ++n) {
    share *= dies;
    reach += share * law.longest_step;
  }
  return beyond > reach;
}

}  // namespace sinew
