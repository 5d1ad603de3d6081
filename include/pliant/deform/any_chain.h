// AnyChain: a chain of global deformations composed at run time, for scenes. AnyChain and Chain (chain.h) use
// the same kernels, so that their results are bitwise equal.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <pliant/deform/chain.h>

namespace pliant {

/// The interface of one link. One virtual call processes all jets of a batch. info(), inverse(), acts() and
/// apply() have the arguments and results of link_info and link_inverse (chain.h), link_acts and apply_link
/// (link.h).
class AnyLink {
 public:
  virtual ~AnyLink() = default;
  virtual LinkInfo info() const = 0;
  virtual bool acts(const LinkParameters<double>&) const = 0;
  virtual bool acts(const LinkParameters<Dual<1>>&) const = 0;
  virtual void apply(const HalfHeight<double>&, const LinkParameters<double>&, JetBatch<Pack>&) const = 0;
  virtual void apply(const HalfHeight<Dual<1>>&, const LinkParameters<Dual<1>>&,
                     JetBatch<Dual<1, Pack>>&) const = 0;
  virtual Vec3<double> inverse(const Vec3<double>& p, double h, const double* b) const = 0;
};

/// Implements AnyLink for the deformation Deform.
template <class Deform>
class AnyLinkOf final : public AnyLink {
 public:
  LinkInfo info() const override { return link_info<Deform>(); }
  bool acts(const LinkParameters<double>& parameters) const override { return link_acts<Deform>(parameters); }
  bool acts(const LinkParameters<Dual<1>>& parameters) const override {
    return link_acts<Deform>(parameters);
  }
  void apply(const HalfHeight<double>& half, const LinkParameters<double>& parameters,
             JetBatch<Pack>& batch) const override {
    apply_link<Deform>(half, parameters, batch);
  }
  void apply(const HalfHeight<Dual<1>>& half, const LinkParameters<Dual<1>>& parameters,
             JetBatch<Dual<1, Pack>>& batch) const override {
    apply_link<Deform>(half, parameters, batch);
  }
  Vec3<double> inverse(const Vec3<double>& p, double h, const double* b) const override {
    return link_inverse<Deform>(p, h, b);
  }
};

/// A chain of links of any type. Its functions have the same arguments and results as the functions of Chain
/// (chain.h).
class AnyChain {
 public:
  AnyChain() = default;
  explicit AnyChain(std::vector<std::shared_ptr<const AnyLink>> links) : links_(std::move(links)) {}

  std::vector<LinkInfo> links() const {
    std::vector<LinkInfo> all;
    for (const auto& link : links_) all.push_back(link->info());
    return all;
  }

  template <class P>
  bool acts(LinkParameters<P> all) const {
    for (const auto& link : links_) {
      if (link->acts(all)) return true;
      const int n = link->info().n_parameters;
      all.b += n;
      all.b_dot += n;
      all.dynamic += n;
    }
    return false;
  }

  template <class P, class S>
  void apply(const HalfHeight<P>& half, LinkParameters<P> all, JetBatch<S>& batch) const {
    for (const auto& link : links_) {
      link->apply(half, all, batch);
      const int n = link->info().n_parameters;
      all.b += n;
      all.b_dot += n;
      all.dynamic += n;
    }
  }

  Vec3<double> inverse(Vec3<double> p, double h, const double* b) const {
    for (const auto& link : links_) b += link->info().n_parameters;
    for (auto link = links_.rbegin(); link != links_.rend(); ++link) {
      b -= (*link)->info().n_parameters;
      p = (*link)->inverse(p, h, b);
    }
    return p;
  }

 private:
  std::vector<std::shared_ptr<const AnyLink>> links_;
};

}  // namespace pliant
