// Pinocchio behind the interface of loops.h. The model is built in code, from the numbers of a Chain.
#include "loops.h"

#include <pinocchio/algorithm/aba-derivatives.hpp>
#include <pinocchio/algorithm/aba.hpp>
#include <pinocchio/algorithm/crba.hpp>
#include <pinocchio/algorithm/rnea-derivatives.hpp>
#include <pinocchio/algorithm/rnea.hpp>
#include <pinocchio/multibody.hpp>

namespace {

using Vector = Eigen::Map<const Eigen::VectorXd>;
using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

struct Arm {
  pinocchio::Model model;
  pinocchio::Data data;
  explicit Arm(const pinocchio::Model &m) : model(m), data(m) {}
};

void write(const Eigen::VectorXd &x, double *to) {
  Eigen::Map<Eigen::VectorXd>(to, x.size()) = x;
}

template <typename Derived> void write(const Eigen::MatrixBase<Derived> &x, double *to) {
  Eigen::Map<Matrix>(to, x.rows(), x.cols()) = x;
}

// of a symmetric matrix Pinocchio computes the upper half
void write_symmetric(const Eigen::MatrixXd &x, double *to) {
  Eigen::Map<Matrix>(to, x.rows(), x.cols()) = x.selfadjointView<Eigen::Upper>();
}

// Call once(model, data, vector, to) for every sample; vector(k) is its k-th input, to[k] the place
// of its k-th result.
template <typename Once>
void each(void *self, size_t count, const double *const *in, double *const *out, size_t results,
          const size_t *sizes, Once once) {
  auto &[model, data] = *static_cast<Arm *>(self);
  const Eigen::Index n = model.nv;
  double *to[4];
  for (size_t i = 0; i < count; ++i) {
    for (size_t k = 0; k < results; ++k) to[k] = out[k] + i * sizes[k];
    once(model, data, [&](size_t k) { return Vector(in[k] + i * n, n); }, to);
  }
}

}  // namespace

extern "C" {

void *arm_new(int n, const int *parents, const int *revolute, const double *R, const double *p,
              const double *mass, const double *com, const double *inertia, const double *gravity) {
  using namespace pinocchio;
  using Rows = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>;
  using Point = Eigen::Map<const Eigen::Vector3d>;
  Model model;
  for (int i = 0; i < n; ++i) {
    const SE3 placement(Rows(R + 9 * i), Point(p + 3 * i));
    const JointIndex parent = parents[i] + 1;
    const std::string name = "joint" + std::to_string(i + 1);
    const JointIndex joint = revolute[i] ? model.addJoint(parent, JointModelRZ(), placement, name)
                                         : model.addJoint(parent, JointModelPZ(), placement, name);
    model.appendBodyToJoint(
        joint, Inertia(mass[i], Point(com + 3 * i), Eigen::Matrix3d(Rows(inertia + 9 * i))));
  }
  model.gravity.linear() = Point(gravity);
  return new Arm(model);
}

void tau_loop(void *self, size_t count, const double *const *in, double *const *out) {
  const size_t n = static_cast<Arm *>(self)->model.nv, sizes[] = {n};
  each(self, count, in, out, 1, sizes, [](auto &model, auto &data, auto x, double **to) {
    write(pinocchio::rnea(model, data, x(0), x(1), x(2)), to[0]);
  });
}

void bias_loop(void *self, size_t count, const double *const *in, double *const *out) {
  const size_t n = static_cast<Arm *>(self)->model.nv, sizes[] = {n};
  each(self, count, in, out, 1, sizes, [](auto &model, auto &data, auto x, double **to) {
    write(pinocchio::nonLinearEffects(model, data, x(0), x(1)), to[0]);
  });
}

void gravity_vector_loop(void *self, size_t count, const double *const *in, double *const *out) {
  const size_t n = static_cast<Arm *>(self)->model.nv, sizes[] = {n};
  each(self, count, in, out, 1, sizes, [](auto &model, auto &data, auto x, double **to) {
    write(pinocchio::computeGeneralizedGravity(model, data, x(0)), to[0]);
  });
}

void inertia_matrix_loop(void *self, size_t count, const double *const *in, double *const *out) {
  const size_t n = static_cast<Arm *>(self)->model.nv, sizes[] = {n * n};
  each(self, count, in, out, 1, sizes, [](auto &model, auto &data, auto x, double **to) {
    write_symmetric(pinocchio::crba(model, data, x(0)), to[0]);
  });
}

void coriolis_matrix_loop(void *self, size_t count, const double *const *in, double *const *out) {
  const size_t n = static_cast<Arm *>(self)->model.nv, sizes[] = {n * n};
  each(self, count, in, out, 1, sizes, [](auto &model, auto &data, auto x, double **to) {
    write(pinocchio::computeCoriolisMatrix(model, data, x(0), x(1)), to[0]);
  });
}

void forward_dynamics_loop(void *self, size_t count, const double *const *in, double *const *out) {
  const size_t n = static_cast<Arm *>(self)->model.nv, sizes[] = {n};
  each(self, count, in, out, 1, sizes, [](auto &model, auto &data, auto x, double **to) {
    write(pinocchio::aba(model, data, x(0), x(1), x(2)), to[0]);
  });
}

void tau_derivatives_loop(void *self, size_t count, const double *const *in, double *const *out) {
  const size_t n = static_cast<Arm *>(self)->model.nv, sizes[] = {n * n, n * n, n * n};
  each(self, count, in, out, 3, sizes, [](auto &model, auto &data, auto x, double **to) {
    pinocchio::computeRNEADerivatives(model, data, x(0), x(1), x(2));
    write(data.dtau_dq, to[0]);
    write(data.dtau_dv, to[1]);
    write_symmetric(data.M, to[2]);
  });
}

void forward_dynamics_derivatives_loop(void *self, size_t count, const double *const *in,
                                       double *const *out) {
  const size_t n = static_cast<Arm *>(self)->model.nv, sizes[] = {n * n, n * n, n * n};
  each(self, count, in, out, 3, sizes, [](auto &model, auto &data, auto x, double **to) {
    pinocchio::computeABADerivatives(model, data, x(0), x(1), x(2));
    write(data.ddq_dq, to[0]);
    write(data.ddq_dv, to[1]);
    write_symmetric(data.Minv, to[2]);
  });
}

}  // extern "C"
