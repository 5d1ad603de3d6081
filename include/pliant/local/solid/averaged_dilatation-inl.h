// Function bodies of averaged_dilatation.h.
#pragma once

#include <algorithm>
#include <cstring>
#include <map>
#include <stdexcept>
#include <string>

#include <pliant/local/solid/averaged_dilatation.h>

namespace pliant {

template <class Element>
AveragedLinearSolid<Element>::AveragedLinearSolid(const Nodes& rest, const Eigen::MatrixXi& elements,
                                                  const Elasticity& material)
    : full_(rest, elements, LinearLaw(material)),
      shear_(rest, elements, LinearLaw(0, material.mu())),
      corners_(elements, static_cast<int>(rest.rows())),
      lambda_(material.lambda()) {
  if (lambda_ < 0)
    throw std::invalid_argument("Poisson's ratio is " + std::to_string(material.nu_P()) +
                                "; averaged dilatation needs a value from 0 to 0.4999");
  Vec3<Pack> X[N];
  for (int pack = 0; pack < corners_.n_packs(); ++pack) {
    corners_.gather(rest.data(), pack, X);
    Vec3<Pack> b[N];
    for (Vec3<Pack>& gradient : b) gradient.setConstant(Pack(0.0));
    for (const TetrahedronPoint& at : Element::rule)
      Element::add_nodal_forces(at, scaled(Pack(at.weight), cofactors(Element::gradient(at, X))), b);
    for (Vec3<Pack>& gradient : b)
      for (int r = 0; r < 3; ++r) {
        for (int lane = 0; lane < Pack::kLanes; ++lane)
          if (pack * Pack::kLanes + lane >= corners_.n_elements()) gradient[r].set(lane, 0);
        gradients_.push_back(gradient[r]);
      }
  }
  volume_.assign(static_cast<std::size_t>(kNodal ? corners_.n_nodes() : corners_.n_elements()), 0.0);
  for (int e = 0; e < corners_.n_elements(); ++e)
    if (kNodal)
      for (int a = 0; a < N; ++a)
        volume_[static_cast<std::size_t>(corners_.node(e, a))] += full_.volume(e) / N;
    else
      volume_[static_cast<std::size_t>(e)] = full_.volume(e);
}

template <class Element>
Pack AveragedLinearSolid<Element>::volume_change(const Coordinates& x, int pack) const {
  Vec3<Pack> d[N];
  corners_.gather(x.data(), pack, d);
  const Pack* b = gradients(pack);
  Pack sum(0.0);
  for (int a = 0; a < N; ++a)
    for (int r = 0; r < 3; ++r) sum += b[3 * a + r] * d[a][r];
  return sum;
}

template <class Element>
void AveragedLinearSolid<Element>::compute_pressures(const Coordinates& x, double* sums, double* pressure,
                                                     ThreadPool* pool) const {
  auto set_pressure = [&](int c, double change) {
    const double V = volume_[static_cast<std::size_t>(c)];
    pressure[c] = V > 0 ? lambda_ * change / V : 0;  // a node without elements has no patch
  };
  if constexpr (kNodal)
    corners_.template sum<1>(
        sums, pool,
        [&](int pack, Pack(*terms)[1]) {
          const Pack share = volume_change(x, pack) * Pack(1.0 / N);
          for (int a = 0; a < N; ++a) terms[a][0] = share;
        },
        [&](int node, const double* change) { set_pressure(node, *change); });
  else
    for_blocks(corners_.n_packs(), ElementCorners<N>::kPacks, pool, [&](int first, int last) {
      for (int pack = first; pack < last; ++pack) {
        const Pack change = volume_change(x, pack);
        for (int lane = 0; lane < Pack::kLanes; ++lane) {
          const int e = pack * Pack::kLanes + lane;
          if (e < corners_.n_elements()) set_pressure(e, change[lane]);
        }
      }
    });
}

template <class Element>
void AveragedLinearSolid<Element>::add_force(const Coordinates& x, VecX<double>& f, Buffer& buffer,
                                             ThreadPool* pool) const {
  // The buffer contains the sums at nodes, then the pressures of patches.
  const std::size_t sums = corners_.buffer_size();
  buffer.numbers.resize(std::max(buffer.numbers.size(), sums + volume_.size()));
  shear_.add_force(x, f, buffer, pool);
  double* pressure = buffer.numbers.data() + sums;
  compute_pressures(x, buffer.numbers.data(), pressure, pool);
  corners_.subtract_sums(buffer.numbers.data(), f.data(), pool, [&](int pack, Pack(*terms)[3]) {
    double p[Pack::kLanes];
    for (int lane = 0; lane < Pack::kLanes; ++lane) {
      const int e = std::min(pack * Pack::kLanes + lane, corners_.n_elements() - 1);
      if constexpr (kNodal) {
        p[lane] = 0;
        for (int a = 0; a < N; ++a) p[lane] += pressure[corners_.node(e, a)] / N;
      } else {
        p[lane] = pressure[e];
      }
    }
    Pack element_pressure;
    std::memcpy(&element_pressure, p, sizeof p);
    const Pack* b = gradients(pack);
    for (int a = 0; a < N; ++a)
      for (int r = 0; r < 3; ++r) terms[a][r] = element_pressure * b[3 * a + r];
  });
}

template <class Element>
double AveragedLinearSolid<Element>::energy(const Coordinates& x) const {
  std::vector<double> sums(corners_.buffer_size(1)), pressure(volume_.size());
  compute_pressures(x, sums.data(), pressure.data(), nullptr);
  double twice_E = 0;
  for (std::size_t c = 0; c < volume_.size(); ++c)
    if (lambda_ != 0) twice_E += volume_[c] * pressure[c] * pressure[c] / lambda_;
  return shear_.energy(x) + twice_E / 2;
}

template <class Element>
void AveragedLinearSolid<Element>::add_stiffness(const Coordinates& x,
                                                 std::vector<Eigen::Triplet<double>>& K) const {
  shear_.add_stiffness(x, K);
  const int n = corners_.n_nodes();
  std::vector<std::vector<int>> patches(volume_.size());
  for (int e = 0; e < corners_.n_elements(); ++e)
    if (kNodal)
      for (int a = 0; a < N; ++a) patches[static_cast<std::size_t>(corners_.node(e, a))].push_back(e);
    else
      patches[static_cast<std::size_t>(e)].push_back(e);
  for (std::size_t c = 0; c < volume_.size(); ++c) {
    std::map<int, double> b;  // coordinate -> derivative of the patch's volume change
    for (int e : patches[c])
      for (int a = 0; a < N; ++a)
        for (int r = 0; r < 3; ++r)
          b[r * n + corners_.node(e, a)] +=
              gradients(e / Pack::kLanes)[3 * a + r][e % Pack::kLanes] / (kNodal ? N : 1);
    for (const auto& [i, b_i] : b)
      for (const auto& [j, b_j] : b) K.emplace_back(i, j, lambda_ * b_i * b_j / volume_[c]);
  }
}

template <class Element>
double AveragedLinearSolid<Element>::frequency_bound(const Coordinates& x, const VecX<double>& M) const {
  return full_.frequency_bound(x, M);
}

}  // namespace pliant
