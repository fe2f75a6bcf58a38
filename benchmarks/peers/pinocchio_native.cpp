// Pinocchio's RNEA with its templates compiled here, for this processor, instead of taken from the wheel.
// The model comes as a list of bodies, so that nothing of the wheel's library is linked.
#include <pinocchio/multibody.hpp>
#include <pinocchio/algorithm/rnea.hpp>

#include <sstream>
#include <string>

namespace {
pinocchio::JointModel joint_model(const std::string& kind, const Eigen::Vector3d& axis) {
  if (kind == "JointModelRX") return pinocchio::JointModelRX();
  if (kind == "JointModelRY") return pinocchio::JointModelRY();
  if (kind == "JointModelRZ") return pinocchio::JointModelRZ();
  if (kind == "JointModelPX") return pinocchio::JointModelPX();
  if (kind == "JointModelPY") return pinocchio::JointModelPY();
  if (kind == "JointModelPZ") return pinocchio::JointModelPZ();
  if (kind == "JointModelRevoluteUnaligned") return pinocchio::JointModelRevoluteUnaligned(axis);
  return pinocchio::JointModelPrismaticUnaligned(axis);
}

void read(std::istream& in, double* values, int count) {
  for (int k = 0; k < count; k++) in >> values[k];
}
}  // namespace

extern "C" {
// One body a line: parent, kind of joint, axis, placement (rotation by rows, then translation), mass, centre of mass,
// inertia about it. Gravity comes first.
void* make(const char* text) {
  std::istringstream in(text);
  auto* model = new pinocchio::Model();
  Eigen::Vector3d gravity, axis, p, com;
  Eigen::Matrix<double, 3, 3, Eigen::RowMajor> R, inertia;
  read(in, gravity.data(), 3);
  model->gravity.linear(gravity);
  std::size_t parent;
  std::string kind;
  double mass;
  while (in >> parent >> kind) {
    read(in, axis.data(), 3);
    read(in, R.data(), 9);
    read(in, p.data(), 3);
    read(in, &mass, 1);
    read(in, com.data(), 3);
    read(in, inertia.data(), 9);
    const auto joint = model->addJoint(parent, joint_model(kind, axis), pinocchio::SE3(R, p),
                                       "joint_" + std::to_string(model->njoints));
    model->appendBodyToJoint(joint, pinocchio::Inertia(mass, com, Eigen::Matrix3d(inertia)));
  }
  return model;
}

void run(const void* handle, long states, int threads, const double* q, const double* v, const double* a, double* tau) {
  const auto& model = *static_cast<const pinocchio::Model*>(handle);
  const int n = model.nv;
#pragma omp parallel num_threads(threads)
  {
    pinocchio::Data data(model);
    using Row = Eigen::Map<const Eigen::VectorXd>;
#pragma omp for schedule(static)
    for (long k = 0; k < states; k++)
      Eigen::Map<Eigen::VectorXd>(tau + k * n, n) =
          pinocchio::rnea(model, data, Row(q + k * n, n), Row(v + k * n, n), Row(a + k * n, n));
  }
}
}
