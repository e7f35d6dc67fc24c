#include "sinew/multibody/integrator.h"

#include <cstdio>

#include "sinew/multibody/dassl.h"
#include "sinew/multibody/fixed_bdf.h"
#include "sinew/multibody/ndf.h"
#include "sinew/multibody/shampine_gordon.h"

namespace sinew::multibody {

std::unique_ptr<Integrator> start(Method method, System& system, double t0, const Vector& y0, double end,
                                  const IntegratorSettings& settings) {
  switch (method) {
    case Method::kDe:
      return std::make_unique<ShampineGordon>(system, t0, y0, settings);
    case Method::kOde15s:
    case Method::kOde15sR:
      return std::make_unique<Ndf>(system, t0, y0, end, settings);
    case Method::kDassl:
      return std::make_unique<Dassl>(system, t0, y0, end, Dassl::Variant::kPublished, settings);
    case Method::kDasslStrict:
      return std::make_unique<Dassl>(system, t0, y0, end, Dassl::Variant::kStrict, settings);
    case Method::kBdf1:
    case Method::kBdf2:
      break;
  }
  return std::make_unique<FixedBdf>(system, t0, y0, method == Method::kBdf1 ? 1 : 2, settings);
}

double worst_component(const Vector& x, const Vector& scale, const IntegratorSettings& s) {
  return (x.array().abs() / (s.atol + s.rtol * scale.array().abs())).maxCoeff();
}

std::string stopped(double t, const char* reason) {
  char buffer[160];
  std::snprintf(buffer, sizeof buffer, "stopped at t = %.9g s: %s", t, reason);
  return buffer;
}

}  // namespace sinew::multibody
