// Folds of the deformation.
#include <pliant/part/mesh/folds.h>

#include <stdexcept>

#include <Eigen/LU>

namespace pliant {

double min_volume_ratio(const Part& part, const ParameterValues<double>& values) {
  if (part.parameters().all_links().empty()) return 1;
  constexpr int round = 32;  // number of samples along v; along u there are 2 tall + 1 samples
  const int tall = part.shape().mesh() == MeshPattern::torus ? round / 2 : round / 4;
  Eigen::Matrix3Xd e(3, (2 * tall + 1) * round);
  Eigen::Index column = 0;
  for (int i = -tall; i <= tall; ++i)
    for (int j = 0; j < round; ++j)
      e.col(column++) =
          part.shape().e(material_at(2 * kPi * i / round, 2 * kPi * j / round), values.b.data());
  double min_ratio = kInfinity;
  for (const Mat3<double>& F : part.chain_gradient(e, values)) {
    const double ratio = F.determinant();
    if (!(ratio >= min_ratio)) min_ratio = ratio;
  }
  return min_ratio;
}

bool folds(const Part& part, const ParameterValues<double>& values) {
  return !(min_volume_ratio(part, values) >= -1e-12);
}

void throw_if_folded(const Part& part, const ParameterValues<double>& values, const char* which) {
  if (folds(part, values)) throw_folded(part, which);
}

void throw_folded(const Part& part, const char* which) {
  throw std::invalid_argument("part '" + part.name() + "': its " + which +
                              " shape folds over (the deformation turns some of the solid inside out); "
                              "reduce the bend or the taper, or make the body slimmer");
}

}  // namespace pliant
