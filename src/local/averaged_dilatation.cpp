#include <pliant/local/averaged_dilatation.h>

#include <cstring>
#include <map>
#include <stdexcept>

namespace pliant {

template <class Element>
AveragedLinearSolid<Element>::AveragedLinearSolid(const Nodes& rest, const Eigen::MatrixXi& elements,
                                                  const Elasticity& material)
    : whole_(rest, elements, LinearLaw(material)),
      shear_(rest, elements, LinearLaw(0, material.mu())),
      corners_(elements, static_cast<int>(rest.rows())),
      lambda_(material.lambda()) {
  if (lambda_ < 0)
    throw std::invalid_argument("averaged dilatation is for Poisson's ratios from 0 to 0.4999, not below 0");
  Vec3<Pack> X[N];
  for (int pack = 0; pack < corners_.n_packs(); ++pack) {
    corners_.gather(rest.data(), pack, X);
    Vec3<Pack> b[N];
    for (Vec3<Pack>& of_corner : b) of_corner.setConstant(Pack(0.0));
    for (const TetrahedronPoint& at : Element::rule)
      Element::push(at, scaled(Pack(at.weight), cofactors(Element::gradient(at, X))), b);
    for (const Vec3<Pack>& of_corner : b)
      for (int r = 0; r < 3; ++r) gradients_.push_back(of_corner[r]);
  }
  volume_.assign(static_cast<std::size_t>(kNodal ? corners_.n_nodes() : corners_.n_elements()), 0.0);
  for (int e = 0; e < corners_.n_elements(); ++e)
    if (kNodal)
      for (int a = 0; a < N; ++a)
        volume_[static_cast<std::size_t>(corners_.node(e, a))] += whole_.volume(e) / N;
    else
      volume_[static_cast<std::size_t>(e)] = whole_.volume(e);
}

template <class Element>
Pack AveragedLinearSolid<Element>::spread(const VecX<double>& x, int pack) const {
  Vec3<Pack> d[N];
  corners_.gather(x.data(), pack, d);
  const Pack* b = gradients(pack);
  Pack sum(0.0);
  for (int a = 0; a < N; ++a)
    for (int r = 0; r < 3; ++r) sum += b[3 * a + r] * d[a][r];
  return sum;
}

template <class Element>
void AveragedLinearSolid<Element>::pressures(const VecX<double>& x, double* spreads, double* pressure,
                                             ThreadPool* pool) const {
  for_ranges(pool, corners_.n_packs(), ElementCorners<N>::kPacks, [&](int first, int last) {
    for (int pack = first; pack < last; ++pack) {
      const Pack q = spread(x, pack);
      std::memcpy(spreads + static_cast<std::ptrdiff_t>(pack) * Pack::kLanes, &q, sizeof q);
    }
  });
  for_ranges(pool, static_cast<int>(volume_.size()), ElementCorners<N>::kNodes, [&](int first, int last) {
    for (int c = first; c < last; ++c) {
      double q = 0;
      if constexpr (kNodal)
        corners_.for_elements(c, [&](int e) { q += spreads[e] / N; });
      else
        q = spreads[c];
      // A node without elements has no patch.
      pressure[c] =
          volume_[static_cast<std::size_t>(c)] > 0 ? lambda_ * q / volume_[static_cast<std::size_t>(c)] : 0;
    }
  });
}

template <class Element>
void AveragedLinearSolid<Element>::add_force(const VecX<double>& x, VecX<double>& f, Buffer& buffer,
                                             ThreadPool* pool) const {
  const std::size_t pushes = corners_.buffer_size(),
                    spreads = static_cast<std::size_t>(corners_.n_packs()) * Pack::kLanes;
  buffer.numbers.resize(std::max(buffer.numbers.size(), pushes + spreads + volume_.size()));
  shear_.add_force(x, f, buffer, pool);
  double* pressure = buffer.numbers.data() + pushes + spreads;
  pressures(x, buffer.numbers.data() + pushes, pressure, pool);
  for_ranges(pool, corners_.n_packs(), ElementCorners<N>::kPacks, [&](int first, int last) {
    for (int pack = first; pack < last; ++pack) {
      Pack p(0.0);
      for (int lane = 0; lane < Pack::kLanes; ++lane) {
        const int e = std::min(pack * Pack::kLanes + lane, corners_.n_elements() - 1);
        if constexpr (kNodal) {
          double sum = 0;
          for (int a = 0; a < N; ++a) sum += pressure[corners_.node(e, a)];
          p.set(lane, sum / N);
        } else {
          p.set(lane, pressure[e]);
        }
      }
      const Pack* b = gradients(pack);
      Vec3<Pack> push[N];
      for (int a = 0; a < N; ++a)
        for (int r = 0; r < 3; ++r) push[a][r] = p * b[3 * a + r];
      ElementCorners<N>::put(push, pack, buffer.numbers.data());
    }
  });
  corners_.subtract_sums(buffer.numbers.data(), f.data(), pool);
}

template <class Element>
double AveragedLinearSolid<Element>::energy(const VecX<double>& x) const {
  std::vector<double> spreads(static_cast<std::size_t>(corners_.n_packs()) * Pack::kLanes),
      pressure(volume_.size());
  pressures(x, spreads.data(), pressure.data(), nullptr);
  double twice = 0;
  for (std::size_t c = 0; c < volume_.size(); ++c)
    if (lambda_ != 0) twice += volume_[c] * pressure[c] * pressure[c] / lambda_;
  return shear_.energy(x) + twice / 2;
}

template <class Element>
void AveragedLinearSolid<Element>::add_stiffness(const VecX<double>& x,
                                                 std::vector<Eigen::Triplet<double>>& K) const {
  shear_.add_stiffness(x, K);
  const int n = corners_.n_nodes();
  for (std::size_t c = 0; c < volume_.size(); ++c) {
    std::map<int, double> b;  // over coordinates
    auto add = [&](int e, double share) {
      for (int a = 0; a < N; ++a)
        for (int r = 0; r < 3; ++r)
          b[r * n + corners_.node(e, a)] += share * gradients(e / Pack::kLanes)[3 * a + r][e % Pack::kLanes];
    };
    if constexpr (kNodal)
      corners_.for_elements(static_cast<int>(c), [&](int e) { add(e, 1.0 / N); });
    else
      add(static_cast<int>(c), 1);
    for (const auto& [i, b_i] : b)
      for (const auto& [j, b_j] : b) K.emplace_back(i, j, lambda_ * b_i * b_j / volume_[c]);
  }
}

template <class Element>
double AveragedLinearSolid<Element>::frequency_bound(const VecX<double>& x, const VecX<double>& M) const {
  return whole_.frequency_bound(x, M);
}

template class AveragedLinearSolid<LinearTetrahedron>;
template class AveragedLinearSolid<QuadraticTetrahedron>;

}  // namespace pliant
