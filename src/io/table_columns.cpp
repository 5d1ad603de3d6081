#include <pliant/io/table_columns.h>

#include <utility>

namespace pliant {

ColumnGroup table_group(std::vector<Column> columns) {
  return {ColumnGroup::Each::table, "", [columns = std::move(columns)](std::size_t) { return columns; }};
}

std::size_t owner_count(const Model& model, ColumnGroup::Each each) {
  if (each == ColumnGroup::Each::table) return 1;
  return each == ColumnGroup::Each::part ? model.parts().size() : model.joints().size();
}

const std::string& owner_name(const Model& model, ColumnGroup::Each each, std::size_t owner) {
  return each == ColumnGroup::Each::part ? model.parts()[owner].part->name()
                                         : model.joints()[owner].joint->name();
}

std::string with_owner(std::string pattern, const std::string& owner) {
  const std::size_t place = pattern.find('*');
  if (place != std::string::npos) pattern.replace(place, 1, owner);
  return pattern;
}

std::vector<Column> all_columns(const TableColumns& table, const Model& model) {
  std::vector<Column> all;
  for (const ColumnGroup& group : table)
    for (std::size_t i = 0; i < owner_count(model, group.each); ++i)
      for (Column& column : group.columns(i)) {
        if (group.each != ColumnGroup::Each::table)
          column.name = with_owner(std::move(column.name), owner_name(model, group.each, i));
        all.push_back(std::move(column));
      }
  return all;
}

}  // namespace pliant
