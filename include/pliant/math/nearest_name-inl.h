// Edit distance: the optimal string alignment distance, by dynamic programming over three rows.
#pragma once

#include <pliant/math/nearest_name.h>

#include <algorithm>
#include <numeric>

#include <pliant/math/header_only.h>

namespace pliant {

namespace detail {

inline char lower_case(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

}  // namespace detail

PLIANT_INLINE int edit_distance(std::string_view a, std::string_view b) {
  std::vector<int> before(b.size() + 1), row(b.size() + 1), next(b.size() + 1);
  std::iota(row.begin(), row.end(), 0);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    next[0] = static_cast<int>(i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const bool same = detail::lower_case(a[i - 1]) == detail::lower_case(b[j - 1]);
      next[j] = std::min({row[j] + 1, next[j - 1] + 1, row[j - 1] + (same ? 0 : 1)});
      const bool swapped = i > 1 && j > 1 && detail::lower_case(a[i - 1]) == detail::lower_case(b[j - 2]) &&
                           detail::lower_case(a[i - 2]) == detail::lower_case(b[j - 1]);
      if (swapped) next[j] = std::min(next[j], before[j - 2] + 1);
    }
    before.swap(row);
    row.swap(next);
  }
  return row[b.size()];
}

PLIANT_INLINE std::string nearest_name(std::string_view wrong, const std::vector<std::string>& names) {
  int best = wrong.size() <= 2 ? 2 : 3;
  std::string nearest;
  for (const std::string& name : names) {
    const std::size_t difference =
        name.size() > wrong.size() ? name.size() - wrong.size() : wrong.size() - name.size();
    if (difference >= static_cast<std::size_t>(best)) continue;
    const int distance = edit_distance(wrong, name);
    if (distance < best) {
      best = distance;
      nearest = name;
    }
  }
  return nearest;
}

PLIANT_INLINE std::string did_you_mean(std::string_view wrong, const std::vector<std::string>& names) {
  const std::string name = nearest_name(wrong, names);
  return name.empty() ? "" : "; did you mean \"" + name + "\"?";
}

}  // namespace pliant
