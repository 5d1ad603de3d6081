// Function body of store_jets().
#pragma once

#include <algorithm>
#include <array>

#include <pliant/local/solid/four_nodes.h>
#include <pliant/math/header_only.h>
#include <pliant/part/store_jets.h>

namespace pliant {

PLIANT_INLINE void store_jets(const Part& part, const VecX<double>& q_s, const VecMax<double>& q_s_dot,
                              const std::vector<Material<Pack>>& packs, const JetArrays& to,
                              Counters& counters) {
  const auto n_s = static_cast<std::size_t>(q_s.size());
  const bool moving = (q_s_dot.array() != 0).any();
  const ParameterValues<double> values = part.parameters().expand<double>(VecMax<double>(q_s), q_s_dot);
  constexpr int kBlock = 8;
  std::array<Jet<Pack>, kBlock> jets;
  const auto n_packs = static_cast<int>(packs.size());
  for (int first = 0; first < n_packs; first += kBlock) {
    const int count = std::min(kBlock, n_packs - first);
    JetBatch<Pack> batch{jets.data(), count, 0, moving ? Level::rates : Level::jacobian};
    part.jets(values, packs.data() + first, batch);
    for (int i = 0; i < count; ++i) {
      const FourNodes<> four((first + i) * Eigen::Index{Pack::kLanes}, to.n);
      const Jet<Pack>& jet = jets[static_cast<std::size_t>(i)];
      four.store(to.s, to.n, jet.s);
      if (moving) {
        four.store(to.s1, to.n, jet.s1);
        four.store(to.s2, to.n, jet.s2);
      }
      for (std::size_t k = 0; k < n_s; ++k)
        four.store(to.J + 3 * to.n * static_cast<Eigen::Index>(k), to.n, jet.J[k]);
    }
  }
  counters.jacobian_points += to.n;
  counters.rate_points += moving ? to.n : 0;
}

}  // namespace pliant
