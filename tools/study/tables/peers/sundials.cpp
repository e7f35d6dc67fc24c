// CVODE (Adams with fixed-point iteration, BDF with dense numeric Jacobian) on derivatives, IDA on residuals:
// SUNDIALS 6.4. IDA is the successor of DASSL.
#include <cvode/cvode.h>
#include <ida/ida.h>
#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#include <memory>

#include "study/tables/peers/families.h"

namespace sinew::study {
namespace {

using multibody::Equations;
using multibody::Vector;

/// A SUNDIALS object and how it is freed.
template <class T, class Free>
auto owned(T* object, Free free) {
  return std::unique_ptr<T, Free>(object, free);
}

struct Problem {
  Equations equations;
  Vector y, yp, r;
  long evaluations = 0;

  Problem(const multibody::Model& model, multibody::Formulation formulation)
      : equations(model, formulation, multibody::Tangent::kNumeric),
        y(2 * model.size()),
        yp(2 * model.size()),
        r(2 * model.size()) {}
};

Eigen::Map<Vector> view(N_Vector v) {
  return {N_VGetArrayPointer(v), N_VGetLength(v)};
}

int derivative(realtype t, N_Vector y, N_Vector yp, void* user) {
  Problem& p = *static_cast<Problem*>(user);
  ++p.evaluations;
  p.y = view(y);
  if (!p.equations.derivative(t, p.y, p.yp)) return 1;  // recoverable: try a shorter step
  view(yp) = p.yp;
  return 0;
}

int residual(realtype t, N_Vector y, N_Vector yp, N_Vector r, void* user) {
  Problem& p = *static_cast<Problem*>(user);
  ++p.evaluations;
  p.y = view(y);
  p.yp = view(yp);
  if (!p.equations.residual(t, p.y, p.yp, p.r)) return 1;
  view(r) = p.r;
  return 0;
}

constexpr long kMaxSteps = 1000000;

/// Lets the equations choose other independent coordinates where the present ones serve badly; the state
/// stays.
void offer(Problem& p, double t, N_Vector y) {
  if (!p.equations.poorly_chosen()) return;
  Vector state = view(y);
  p.equations.accept(t, state);
}

void sample(Problem& p, double t, N_Vector y, Trajectory& out) {
  Vector state = view(y);
  p.equations.close(state);
  out.t.push_back(t);
  out.y.push_back(state);
}

std::string cvode(const StudyCase& c, int method, double tolerance, Trajectory& out, SimulationRun& m,
                  double& seconds) {
  const multibody::Model model(c.mechanism);
  Problem problem(model, derivatives_of(c));
  Vector y0;
  if (std::string why = problem.equations.start(y0); !why.empty()) return why;
  SUNContext context;
  SUNContext_Create(nullptr, &context);
  const auto guard = owned(&context, [](SUNContext* x) { SUNContext_Free(x); });
  const auto y = owned(N_VNew_Serial(y0.size(), context), [](N_Vector x) { N_VDestroy(x); });
  view(y.get()) = y0;
  void* memory = CVodeCreate(method, context);
  const auto integrator = owned(&memory, [](void** x) { CVodeFree(x); });
  CVodeInit(memory, derivative, 0, y.get());
  CVodeSStolerances(memory, tolerance, tolerance);
  CVodeSetUserData(memory, &problem);
  CVodeSetMaxNumSteps(memory, kMaxSteps);
  CVodeSetErrFile(memory, nullptr);
  if (model.shortest_profile > 0) CVodeSetMaxStep(memory, model.shortest_profile);
  const auto matrix =
      owned(SUNDenseMatrix(y0.size(), y0.size(), context), [](SUNMatrix x) { SUNMatDestroy(x); });
  const auto linear =
      owned(SUNLinSol_Dense(y.get(), matrix.get(), context), [](SUNLinearSolver x) { SUNLinSolFree(x); });
  const auto fixed =
      owned(SUNNonlinSol_FixedPoint(y.get(), 0, context), [](SUNNonlinearSolver x) { SUNNonlinSolFree(x); });
  if (method == CV_ADAMS)
    CVodeSetNonlinearSolver(memory, fixed.get());
  else
    CVodeSetLinearSolver(memory, linear.get(), matrix.get());
  const auto inside = owned(N_VNew_Serial(y0.size(), context), [](N_Vector x) { N_VDestroy(x); });
  sample(problem, 0, y.get(), out);
  realtype reached = 0;
  for (std::size_t i = 1; i < c.reference.t.size(); ++i) {
    const double t = c.reference.t[i], begin = cpu_seconds();
    while (reached < t) {
      const int flag = CVode(memory, c.reference.t.back(), y.get(), &reached, CV_ONE_STEP);
      if (flag < 0) return "CVODE stopped with " + std::string(CVodeGetReturnFlagName(flag));
      offer(problem, reached, y.get());
    }
    seconds += cpu_seconds() - begin;
    CVodeGetDky(memory, t, 0, inside.get());
    sample(problem, t, inside.get(), out);
  }
  CVodeGetNumSteps(memory, &m.steps);
  if (method == CV_BDF) CVodeGetNumJacEvals(memory, &m.tangents);
  m.evaluations = problem.evaluations;
  return {};
}

std::string ida(const StudyCase& c, double tolerance, Trajectory& out, SimulationRun& m, double& seconds) {
  const multibody::Model model(c.mechanism);
  Problem problem(model, multibody::Formulation::kRr);
  Vector y0;
  if (std::string why = problem.equations.start(y0); !why.empty()) return why;
  Vector yp0(y0.size());
  if (!problem.equations.derivative(0, y0, yp0)) return "the start cannot be evaluated";
  SUNContext context;
  SUNContext_Create(nullptr, &context);
  const auto guard = owned(&context, [](SUNContext* x) { SUNContext_Free(x); });
  const auto y = owned(N_VNew_Serial(y0.size(), context), [](N_Vector x) { N_VDestroy(x); });
  const auto yp = owned(N_VNew_Serial(y0.size(), context), [](N_Vector x) { N_VDestroy(x); });
  view(y.get()) = y0;
  view(yp.get()) = yp0;
  void* memory = IDACreate(context);
  const auto integrator = owned(&memory, [](void** x) { IDAFree(x); });
  IDAInit(memory, residual, 0, y.get(), yp.get());
  IDASStolerances(memory, tolerance, tolerance);
  IDASetUserData(memory, &problem);
  IDASetMaxNumSteps(memory, kMaxSteps);
  IDASetErrFile(memory, nullptr);
  if (model.shortest_profile > 0) IDASetMaxStep(memory, model.shortest_profile);
  const auto matrix =
      owned(SUNDenseMatrix(y0.size(), y0.size(), context), [](SUNMatrix x) { SUNMatDestroy(x); });
  const auto linear =
      owned(SUNLinSol_Dense(y.get(), matrix.get(), context), [](SUNLinearSolver x) { SUNLinSolFree(x); });
  IDASetLinearSolver(memory, linear.get(), matrix.get());
  const auto inside = owned(N_VNew_Serial(y0.size(), context), [](N_Vector x) { N_VDestroy(x); });
  sample(problem, 0, y.get(), out);
  realtype reached = 0;
  for (std::size_t i = 1; i < c.reference.t.size(); ++i) {
    const double t = c.reference.t[i], begin = cpu_seconds();
    while (reached < t) {
      const int flag = IDASolve(memory, c.reference.t.back(), &reached, y.get(), yp.get(), IDA_ONE_STEP);
      if (flag < 0) return "IDA stopped with " + std::string(IDAGetReturnFlagName(flag));
      offer(problem, reached, y.get());
    }
    seconds += cpu_seconds() - begin;
    IDAGetDky(memory, t, 0, inside.get());
    sample(problem, t, inside.get(), out);
  }
  IDAGetNumSteps(memory, &m.steps);
  IDAGetNumJacEvals(memory, &m.tangents);
  m.evaluations = problem.evaluations;
  return {};
}

Peer cvode_peer(const std::string& name, int method) {
  return {name, method == CV_BDF, [name, method](const StudyCase& c, double tolerance, int repeats) {
            return measure_peer(name, c, tolerance, repeats,
                                [&](Trajectory& out, SimulationRun& m, double& seconds) {
                                  return cvode(c, method, tolerance, out, m, seconds);
                                });
          }};
}

}  // namespace

std::vector<Peer> sundials_peers() {
  const std::string name = "SUNDIALS · IDA, RR";
  return {cvode_peer("SUNDIALS · CVODE Adams", CV_ADAMS),
          cvode_peer("SUNDIALS · CVODE BDF", CV_BDF),
          {name, true, [name](const StudyCase& c, double tolerance, int repeats) {
             return measure_peer(name, c, tolerance, repeats,
                                 [&](Trajectory& out, SimulationRun& m, double& seconds) {
                                   return ida(c, tolerance, out, m, seconds);
                                 });
           }}};
}

}  // namespace sinew::study
