// The names of the columns of a table, read from layout.json as by the Python function of
// include/pliant/io/README.md.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace layout_names_detail {

inline std::string replaced(std::string text, char mark, const std::string& by) {
  const std::size_t place = text.find(mark);
  return place == std::string::npos ? text : text.replace(place, 1, by);
}

inline void add_names(const nlohmann::json& layout, const nlohmann::json& entries, const std::string& owner,
                      std::vector<std::string>& names) {
  for (const nlohmann::json& entry : entries) {
    if (entry.contains("each")) {
      for (const nlohmann::json& one : layout.at(entry.at("each").get<std::string>()))
        add_names(
            layout,
            layout.at("kinds").at(one.at(1).get<std::size_t>()).at(entry.at("columns").get<std::string>()),
            one.at(0), names);
      continue;
    }
    const bool is_series = entry.contains("count");
    for (int i = 0; i < (is_series ? entry.at("count").get<int>() : 1); ++i) {
      const std::string name = entry.at("name");
      names.push_back(replaced(is_series ? replaced(name, '#', std::to_string(i)) : name, '*', owner));
    }
  }
}

}  // namespace layout_names_detail

/// Returns the names of all columns of a table. text: contents of layout.json.
inline std::vector<std::string> layout_names(const std::string& text, const char* table) {
  const nlohmann::json layout = nlohmann::json::parse(text);
  std::vector<std::string> names;
  layout_names_detail::add_names(layout, layout.at("tables").at(table), "*", names);
  return names;
}
